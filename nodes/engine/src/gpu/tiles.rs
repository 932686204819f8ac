//! Plans on images in memory: upload, run, read back, in tiles where the device is too small. While it computes one tile, the
//! next is uploaded and the one before read back.

use super::device::count;
use super::executor::Executor;
use super::prepared::Prepared;
use super::staging::{self, Staged, Upload};
use super::timing::read_buffer;
use super::transfer::{Part, parts};
use crate::cpu::{Control, bind_inputs};
use crate::error::{Error, Result};
use crate::image::{Image, Rect};
use crate::kernel::WORKGROUP;
use crate::plan::{Plan, Support};
use crate::program::{Program, Texture};
use std::collections::VecDeque;

/// The smallest tile side worth computing; below it the halo would be nearly everything.
const LEAST_TILE: u32 = 32;

/// Factor on the work of the whole picture that tiles may be, where they are made smaller only to be less work each:
/// what lies around them is computed anew for each.
const MOST_WORK: f64 = 2.0;

/// Tiles that are on their way at once: one that the device computes, and one that goes there or comes back.
const IN_FLIGHT: usize = 2;

/// One tile: its program, and which part of the picture it computes.
struct Tile {
    region: Rect,
    program: Program,
}

/// A tile that was submitted, and whose results are not read back yet.
struct Flight {
    parts: Vec<Part>,
    staged: Option<Staged>,
    readback: wgpu::Buffer,
    submission: wgpu::SubmissionIndex,
}

impl Executor {
    /// Computes `region` (level 0) of every output of `plan` from images in memory; the counterpart
    /// of [`CpuExecutor::run`](crate::cpu::CpuExecutor::run), with the same rules for its inputs.
    ///
    /// Result of a run. What exceeds the limits of the device, or those of [`Executor::set_limits`], is computed in
    /// tiles. Cancelling and progress take effect between tiles. Everything made for a run stays for
    /// the next one of the same shape, which then only uploads, submits once a tile and reads back.
    ///
    /// # Errors
    /// As the CPU executor; [`Error::Geometry`] when the picture exceeds the device's limit and
    /// cannot be cut, because the plan reads all of it for every pixel or its halo is too wide;
    /// [`Error::Memory`] and [`Error::Device`] for what the device reports. After the loss of the
    /// device every call fails, and the executor must be made anew.
    pub fn run_images(
        &mut self,
        plan: &Plan,
        inputs: &[(&str, &Image)],
        region: Rect,
        control: Control<'_>,
    ) -> Result<Vec<Image>> {
        self.device.check()?;
        let tiles = self.cut(plan, region)?;
        bind_inputs(plan, inputs, &plan.windows(region))?;
        let mut results = Vec::with_capacity(plan.outputs().len());
        for port in plan.outputs() {
            let desc = plan.desc(port.image);
            results.push(Image::with_window(plan.region_at(region, desc.level), desc.channels)?);
        }
        // Any of the buffers then does for any of the tiles.
        self.largest = tiles.iter().map(|tile| staging::bytes_of(&tile.program)).max().unwrap_or(0);
        let mut flights = VecDeque::with_capacity(IN_FLIGHT);
        let mut landed = 0;
        let mut land = |executor: &mut Self, flight: Flight, results: &mut [Image]| {
            executor.land(flight, results)?;
            landed += 1;
            if let Some(progress) = control.progress {
                progress(landed as f32 / tiles.len() as f32);
            }
            Ok::<(), Error>(())
        };
        for tile in &tiles {
            control.check()?;
            let flight = match self.submit(plan, inputs, tile) {
                Err(Error::Memory(_)) if !(self.warm.is_empty() && flights.is_empty()) => {
                    for flight in flights.drain(..) {
                        land(self, flight, &mut results)?;
                    }
                    self.purge();
                    self.submit(plan, inputs, tile)?
                }
                flight => flight?,
            };
            flights.push_back(flight);
            if flights.len() == IN_FLIGHT
                && let Some(flight) = flights.pop_front()
            {
                land(self, flight, &mut results)?;
            }
        }
        for flight in flights {
            land(self, flight, &mut results)?;
        }
        control.check()?;
        Ok(results)
    }

    /// The tiles of `region`: one if it fits, else as few as the limits allow. That of the work of a dispatch gives way where
    /// smaller tiles would make too much of it in all.
    fn cut(&self, plan: &Plan, region: Rect) -> Result<Vec<Tile>> {
        let whole = Program::lower_as(plan, region, self.precision)?;
        let side = whole.textures.iter().map(|t| t.window.width().max(t.window.height())).max().unwrap_or(0);
        let global = plan.support() == Support::Global;
        if global && side > self.max_side {
            return Err(Error::Geometry(format!(
                "the graphics device takes at most {0}x{0} pixels, {side} are needed, and this filter cannot be \
                 cut into tiles because every pixel depends on the whole picture: use a smaller picture or the CPU",
                self.max_side
            )));
        }
        let fits = global || self.allows(plan, &whole, region, 1);
        let work: f64 = whole.operations(plan).sum();
        let is_little = self.is_little(plan, &whole);
        let mut best = fits.then(|| vec![Tile { region, program: whole }]);
        if let Some(tiles) = best.take_if(|_| global || is_little) {
            return Ok(tiles);
        }
        let mut size = [region.width(), region.height()];
        loop {
            let longer = usize::from(size[1] > size[0]);
            size[longer] = size[longer].div_ceil(2).next_multiple_of(WORKGROUP);
            if size[longer] < LEAST_TILE {
                if let Some(tiles) = best {
                    return Ok(tiles);
                }
                let memory = match self.budget {
                    u64::MAX => String::new(),
                    budget => format!(" and {} MiB", budget >> 20),
                };
                return Err(Error::Geometry(format!(
                    "the graphics device may use at most {0}x{0} pixels{memory}, too little even for a small tile with \
                     the pixels around it that this filter reads: use the CPU",
                    self.max_side
                )));
            }
            let Some(tiles) = self.tiles_of(plan, region, size)? else { continue };
            let together: f64 = tiles.iter().flat_map(|tile| tile.program.operations(plan)).sum();
            if let Some(best) = best.take_if(|_| together > MOST_WORK * work) {
                return Ok(best);
            }
            if tiles.iter().all(|tile| self.is_little(plan, &tile.program)) {
                return Ok(tiles);
            }
            best = Some(tiles);
        }
    }

    /// The tiles of `region` of at most `size`, or `None` if one of them exceeds the limits.
    fn tiles_of(&self, plan: &Plan, region: Rect, size: [u32; 2]) -> Result<Option<Vec<Tile>>> {
        let mut tiles = Vec::new();
        for y0 in (region.y0..region.y1).step_by(size[1] as usize) {
            for x0 in (region.x0..region.x1).step_by(size[0] as usize) {
                let (x1, y1) = (x0 + size[0] as i32, y0 + size[1] as i32);
                let tile = Rect { x0, y0, x1: x1.min(region.x1), y1: y1.min(region.y1) };
                let program = Program::lower_as(plan, tile, self.precision)?;
                if !self.allows(plan, &program, tile, IN_FLIGHT as u64) {
                    return Ok(None);
                }
                tiles.push(Tile { region: tile, program });
            }
        }
        // The largest first: the others then fit into its textures.
        let area = |t: &Texture| u64::from(t.window.width()) * u64::from(t.window.height());
        tiles.sort_by_key(|t| std::cmp::Reverse(t.program.textures.iter().map(area).sum::<u64>()));
        Ok(Some(tiles))
    }

    /// True where the limits allow a program for `region`, of so many in flight at once.
    fn allows(&self, plan: &Plan, program: &Program, region: Rect, in_flight: u64) -> bool {
        let fits_side = |t: &Texture| t.window.width() <= self.max_side && t.window.height() <= self.max_side;
        let textures: u64 = program.textures.iter().map(Texture::bytes).sum();
        let staged = staging::bytes_of(program);
        let readback: u64 = parts(plan, program, region).iter().map(|p| p.bytes()).sum();
        let largest = self.device.raw().limits().max_buffer_size;
        program.textures.iter().all(fits_side)
            && textures + in_flight * (staged + readback) <= self.budget
            && staged <= largest
            && readback <= largest
    }

    /// True where no dispatch is more work than one should be.
    fn is_little(&self, plan: &Plan, program: &Program) -> bool {
        program.operations(plan).all(|operations| operations <= self.work)
    }

    /// Uploads what a tile needs and submits its dispatches, in several submissions if they are much work.
    fn submit(&mut self, plan: &Plan, inputs: &[(&str, &Image)], tile: &Tile) -> Result<Flight> {
        let parts = parts(plan, &tile.program, tile.region);
        let readback = self.readback(parts.iter().map(Part::bytes).sum())?;
        let mut warm = self.warmed(&tile.program)?;
        let staged = self.stage(inputs, &tile.program, &mut warm)?;
        let views: Vec<_> = parts.iter().map(|part| warm.own_output(&part.name)).collect::<Result<_>>()?;
        let device = &self.device;
        let encoder = || {
            let label = Some("isophote");
            device.raw.create_command_encoder(&wgpu::CommandEncoderDescriptor { label })
        };
        let (mut first, mut work, mut commands) = (0, 0.0, encoder());
        if let Some(staged) = &staged {
            staged.copy(&mut commands);
        }
        for (index, operations) in tile.program.operations(plan).enumerate() {
            if index > first && work + operations > self.work {
                warm.encode_some(&mut commands, first..index)?;
                let full = std::mem::replace(&mut commands, encoder());
                device.guarded("running a part of the plan", |_| device.queue.submit([full.finish()]))?;
                count(&device.counters.submissions);
                (first, work) = (index, 0.0);
            }
            work += operations;
        }
        warm.encode_some(&mut commands, first..tile.program.dispatches.len())?;
        let submission = device.guarded("running the plan", |_| {
            for (part, view) in parts.iter().zip(&views) {
                part.copy(view.texture(), &readback, &mut commands);
            }
            device.queue.submit([commands.finish()])
        })?;
        count(&device.counters.submissions);
        self.keep(warm);
        Ok(Flight { parts, staged, readback, submission })
    }

    /// Waits for a tile and stores its results.
    fn land(&mut self, flight: Flight, results: &mut [Image]) -> Result<()> {
        let Flight { parts, staged, readback, submission } = flight;
        self.uploads.extend(staged.map(Staged::map));
        let surplus = self.uploads.len().saturating_sub(IN_FLIGHT);
        self.uploads.drain(..surplus);
        let size = parts.iter().map(Part::bytes).sum();
        read_buffer(&self.device, &readback, size, Some(submission), |bytes| {
            for (part, image) in parts.iter().zip(results) {
                part.store(bytes, image);
            }
        })?;
        self.readbacks.push(readback);
        let surplus = self.readbacks.len().saturating_sub(IN_FLIGHT);
        self.readbacks.drain(..surplus);
        Ok(())
    }

    /// A buffer of at least `size` bytes to read results back.
    fn readback(&mut self, size: u64) -> Result<wgpu::Buffer> {
        if let Some(index) = self.readbacks.iter().position(|buffer| buffer.size() >= size) {
            return Ok(self.readbacks.remove(index));
        }
        let buffer = self.device.guarded("the buffer to read results back", |raw| {
            raw.create_buffer(&wgpu::BufferDescriptor {
                label: Some("isophote readback"),
                size,
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            })
        })?;
        count(&self.device.counters.buffers);
        Ok(buffer)
    }

    /// A program made ready earlier that `program` fits, or a new one.
    fn warmed(&mut self, program: &Program) -> Result<Prepared> {
        if let Some(index) = self.warm.iter().rposition(|prepared| prepared.fits(program)) {
            let mut prepared = self.warm.remove(index);
            prepared.repack(program)?;
            return Ok(prepared);
        }
        self.prepare(program)
    }

    /// Keeps a program for later, and as many of those used before it as the budget allows.
    fn keep(&mut self, prepared: Prepared) {
        self.warm.push(prepared);
        let mut bytes: u64 = self.readbacks.iter().map(wgpu::Buffer::size).sum();
        bytes += self.uploads.iter().map(Upload::size).sum::<u64>();
        let mut kept = 0;
        for prepared in self.warm.iter().rev() {
            bytes += prepared.bytes();
            if kept > 0 && bytes > self.budget {
                break;
            }
            kept += 1;
        }
        let surplus = self.warm.len() - kept;
        self.warm.drain(..surplus);
    }

    /// Writes the inputs of a program to memory that the device copies from.
    fn stage(
        &mut self,
        inputs: &[(&str, &Image)],
        program: &Program,
        prepared: &mut Prepared,
    ) -> Result<Option<Staged>> {
        let size = staging::bytes_of(program);
        if size == 0 {
            return Ok(None);
        }
        let buffer = self.upload(size.max(self.largest))?;
        Staged::write(&self.device, buffer, inputs, program, prepared).map(Some)
    }

    /// A mapped buffer of at least `size` bytes.
    fn upload(&mut self, size: u64) -> Result<wgpu::Buffer> {
        while let Some(index) = self.uploads.iter().position(|upload| upload.size() >= size) {
            if let Some(buffer) = self.uploads.remove(index).mapped() {
                return Ok(buffer);
            }
        }
        let buffer = self.device.guarded("the buffer to upload images", |raw| {
            raw.create_buffer(&wgpu::BufferDescriptor {
                label: Some("isophote upload"),
                size,
                usage: wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::MAP_WRITE,
                mapped_at_creation: true,
            })
        })?;
        count(&self.device.counters.buffers);
        Ok(buffer)
    }
}
