//! A program: a plan lowered to textures, bindings, uniform bytes and dispatch sizes.
//!
//! This is the plan as plain data, ready for any graphics API: no device, queue or driver handle
//! appears in it. The `gpu` executor runs it with wgpu; a host may run it with whatever it has.
//!
//! Bindings of every pass, all in group 0: 0 is the `Grid` uniform (below), 1 the kernel's own
//! uniform block if it has parameters, from 2 on the sampled textures in order, then the storage
//! textures in order. Textures are read by integer loads only and never filtered, but for those that a shader of
//! [`Precision::Fast`] names, which it reads through a sampler at binding 15 ([`SAMPLER_BINDING`]): linear in both
//! directions, clamped to the edge.
//!
//! Passes are fused where what lies between them need not exist: those that compute each pixel from the same pixel of what
//! another pass has computed run in the dispatch of that one, as do, where precision may be traded for speed, the rows and
//! the columns of small windows.

mod format;
mod fused;
mod fusion;
mod shader;

pub use format::{Format, Precision};
use shader::Reading;
pub use shader::Shader;

use crate::error::{Error, Result};
use crate::image::Rect;
use crate::kernel::MAX_INPUTS;
pub use crate::kernel::SAMPLER_BINDING;
use crate::plan::{Class, ImageId, Pass, Plan, Port, Support};
use fused::{Fused, Link, padded};
use fusion::{Fusion, Lead, external, fusions, reaches};
use std::sync::Arc;

/// Purpose of a texture of a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Role {
    /// The host binds its own texture here. It must show the picture's window named by `window`.
    Input(String),
    /// A result; the host's own texture or one it allocates.
    Output(String),
    /// Scratch memory; contents do not survive the program, and images of one level and format share it.
    Transient,
}

/// One physical texture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texture {
    /// Purpose.
    pub role: Role,
    /// Format of its texels. Inputs may have any other of as many channels that is read as floats.
    pub format: Format,
    /// Format of its texels.
    pub class: Class,
    /// Part of the picture (at its pyramid level) that the texture holds, in pixels. That of a transient one begins
    /// at (0, 0) and is as large as the largest image in each direction; where an image lies is in the passes' grids.
    pub window: Rect,
}

/// The uniform block at binding 0: where the textures of a pass lie in the picture.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Grid {
    /// Absolute position of texel (0, 0) of the outputs.
    pub origin: [i32; 2],
    /// Texels to write.
    pub size: [i32; 2],
    /// Size of the whole picture at the outputs' level.
    pub full: [i32; 2],
    /// Distance to which the first of several kernels reads around a pixel that a window of the others holds; else zero.
    pub halo: [i32; 2],
    /// Per input: absolute position of texel (0, 0), and the whole picture's size at its level.
    pub inputs: [[i32; 4]; MAX_INPUTS],
}

/// One dispatch.
#[derive(Clone, Debug)]
pub struct Dispatch {
    /// Shader to run.
    pub shader: Arc<Shader>,
    /// Uniform at binding 0.
    pub grid: Grid,
    /// Uniform at binding 1; empty for a kernel without parameters.
    pub params: Vec<u8>,
    /// Sampled textures, indices into [`Program::textures`], from binding 2.
    pub inputs: Vec<u32>,
    /// Storage textures (write only), from the binding after the inputs.
    pub outputs: Vec<u32>,
    /// Workgroups in x, y, z.
    pub workgroups: [u32; 3],
}

/// A plan lowered for one region.
#[derive(Clone, Debug, Default)]
pub struct Program {
    /// All textures; inputs and outputs first, in the plan's order.
    pub textures: Vec<Texture>,
    /// All dispatches in order. Between two there must be a barrier wherever one reads what the
    /// other wrote (wgpu and WebGPU place it by themselves).
    pub dispatches: Vec<Dispatch>,
    /// Passes of the plan, dispatch by dispatch.
    origins: Vec<Origin>,
}

/// Passes of a plan that a dispatch does.
#[derive(Clone, Debug)]
struct Origin {
    /// The passes.
    passes: Vec<usize>,
    /// Their kernels.
    kernels: Vec<&'static str>,
    /// Their supports where windows depend on them.
    supports: Option<Vec<Vec<Support>>>,
    /// Their beginning.
    lead: Lead,
}

impl Program {
    /// Lowers `plan` for `region` (level 0), exactly.
    ///
    /// # Errors
    /// As [`Program::lower_as`].
    pub fn lower(plan: &Plan, region: Rect) -> Result<Self> {
        Self::lower_as(plan, region, Precision::Exact)
    }

    /// Lowers `plan` for `region` (level 0). Transient images with disjoint lives share a texture.
    ///
    /// # Errors
    /// [`Error::Geometry`] for a region outside the picture, [`Error::Input`] for a plan whose output
    /// is one of its inputs.
    pub fn lower_as(plan: &Plan, region: Rect, precision: Precision) -> Result<Self> {
        plan.check_region(region)?;
        // The windows of the whole picture are whole, however far the passes read.
        let [width, height] = plan.size();
        let is_whole = region == Rect::of_size(width, height);
        let fusions = fusions(plan, precision.fuses_windows());
        let mut lowering = Lowering::new(plan, plan.windows(region), precision);
        fusions.iter().for_each(|fusion| lowering.align(fusion));
        lowering.add_ports()?;
        let ending = last_uses(plan, &fusions);
        let mut program = Self::default();
        for (fusion, ending) in fusions.into_iter().zip(ending) {
            if lowering.windows[fusion.outputs[0].index()].is_empty() {
                continue;
            }
            let passes: Vec<&Pass> = fusion.passes.iter().map(|index| &plan.passes()[*index]).collect();
            lowering.make_room(&fusion.outputs);
            program.dispatches.push(lowering.dispatch(&fusion, &passes));
            lowering.release(&ending);
            program.origins.push(Origin {
                kernels: passes.iter().map(|pass| pass.kernel.shader).collect(),
                supports: (!is_whole).then(|| passes.iter().map(|pass| pass.supports.clone()).collect()),
                passes: fusion.passes,
                lead: fusion.lead,
            });
        }
        program.textures = lowering.textures;
        program.keep_inputs(plan);
        Ok(program)
    }

    /// Asks for inputs as the caller has them, but for those that a sampler reads.
    fn keep_inputs(&mut self, plan: &Plan) {
        let filtered = |dispatch: &Dispatch| {
            let inputs = dispatch.shader.filtered.iter().filter_map(|at| dispatch.inputs.get(*at).copied());
            inputs.collect::<Vec<u32>>()
        };
        let filtered: Vec<u32> = self.dispatches.iter().flat_map(filtered).collect();
        for (index, texture) in (0..).zip(&mut self.textures) {
            let Role::Input(name) = &texture.role else { continue };
            let port = plan.inputs().iter().find(|port| port.name == *name);
            if let Some(port) = port.filter(|_| !filtered.contains(&index)) {
                texture.format = Format::exact(plan.desc(port.image).channels);
            }
        }
    }

    /// Takes over the uniform bytes of a plan that was edited in place, without allocating.
    ///
    /// Returns false, with nothing changed, when the plan must be lowered again: its passes are
    /// others, or the program is for a part of the picture and a pass now reads less or farther.
    pub fn repack(&mut self, plan: &Plan) -> bool {
        if !self.origins.iter().all(|origin| origin.is_of(plan)) {
            return false;
        }
        for (dispatch, origin) in self.dispatches.iter_mut().zip(&self.origins) {
            if let Some([_, halo]) = reaches(plan, &origin.passes, origin.lead) {
                dispatch.grid.halo = [halo as i32; 2];
            }
            let mut at = 0;
            for index in &origin.passes {
                let params = &plan.passes()[*index].params;
                dispatch.params[at..at + params.len()].copy_from_slice(params);
                at += padded(params.len());
            }
        }
        true
    }

    /// Bytes that all dispatches read from and write to textures, each texel of a texture once.
    pub fn bytes_moved(&self) -> u64 {
        let bytes = |dispatch: &Dispatch| {
            let texels = dispatch.grid.size.map(|side| side.max(0) as u64).iter().product::<u64>();
            let read = dispatch.inputs.iter().enumerate();
            // What a shader knows by two names is read once.
            let read = read.filter(|(place, at)| !dispatch.inputs[..*place].contains(at));
            let read = read.map(|(_, at)| self.textures[*at as usize].bytes());
            let written = dispatch.outputs.iter().map(|at| self.textures[*at as usize].format.texel());
            read.sum::<u64>() + written.map(|texel| u64::from(texel) * texels).sum::<u64>()
        };
        self.dispatches.iter().map(bytes).sum()
    }

    /// By dispatch: its operations on a plan that it was lowered from, fused multiply-adds or others of like cost.
    pub fn operations(&self, plan: &Plan) -> impl Iterator<Item = f64> {
        self.dispatches.iter().zip(&self.origins).map(|(dispatch, origin)| {
            let pixels: f64 = dispatch.grid.size.iter().map(|side| f64::from(*side)).product();
            let passes = origin.passes.iter().filter_map(|index| plan.passes().get(*index));
            pixels * passes.map(|pass| (pass.kernel.cost)(&pass.params)).sum::<f64>()
        })
    }

    /// Index of the input texture of this name.
    pub fn input(&self, name: &str) -> Option<usize> {
        self.textures.iter().position(|t| matches!(&t.role, Role::Input(n) if n == name))
    }

    /// Index of the output texture of this name.
    pub fn output(&self, name: &str) -> Option<usize> {
        self.textures.iter().position(|t| matches!(&t.role, Role::Output(n) if n == name))
    }
}

impl Texture {
    /// Bytes of all its texels.
    pub fn bytes(&self) -> u64 {
        u64::from(self.window.width()) * u64::from(self.window.height()) * u64::from(self.format.texel())
    }
}

impl Origin {
    /// True where a plan still has these passes, which read as far as they did.
    fn is_of(&self, plan: &Plan) -> bool {
        let supports = |at: usize| self.supports.as_ref().map(|supports| &supports[at]);
        if self.lead != Lead::Single && reaches(plan, &self.passes, self.lead).is_none() {
            return false;
        }
        self.passes.iter().enumerate().all(|(at, index)| {
            plan.passes().get(*index).is_some_and(|pass| {
                pass.kernel.shader == self.kernels[at] && supports(at).is_none_or(|s| *s == pass.supports)
            })
        })
    }
}

/// By dispatch: the images that it or a pass in it reads or writes for the last time.
fn last_uses(plan: &Plan, fusions: &[Fusion]) -> Vec<Vec<ImageId>> {
    let mut living: Vec<bool> = vec![false; plan.images().len()];
    plan.outputs().iter().for_each(|port| living[port.image.index()] = true);
    let mut ending: Vec<Vec<ImageId>> = Vec::with_capacity(fusions.len());
    for fusion in fusions.iter().rev() {
        let images = fusion.passes.iter().map(|index| &plan.passes()[*index]);
        let images = images.flat_map(|pass| pass.inputs.iter().chain(&pass.outputs).copied());
        ending.push(images.filter(|image| !std::mem::replace(&mut living[image.index()], true)).collect());
    }
    ending.reverse();
    ending
}

/// A plan on its way to a program.
struct Lowering<'p> {
    plan: &'p Plan,
    windows: Vec<Rect>,
    precision: Precision,
    textures: Vec<Texture>,
    /// By texture: the level of its images.
    levels: Vec<i8>,
    /// By virtual image: its texture, once it has one.
    places: Vec<Option<u32>>,
    /// Transient textures whose images are needed no longer.
    free: Vec<u32>,
}

impl<'p> Lowering<'p> {
    fn new(plan: &'p Plan, windows: Vec<Rect>, precision: Precision) -> Self {
        Self {
            plan,
            windows,
            precision,
            textures: Vec::new(),
            levels: Vec::new(),
            places: vec![None; plan.images().len()],
            free: Vec::new(),
        }
    }

    /// Gives all images that a dispatch stores the window of the largest: what follows from a pixel can be computed
    /// wherever the pixel is.
    fn align(&mut self, fusion: &Fusion) {
        let windows = fusion.outputs.iter().map(|image| self.windows[image.index()]);
        let all = windows.fold(Rect::default(), |all, window| all.union(&window));
        fusion.outputs.iter().for_each(|image| self.windows[image.index()] = all);
    }

    /// Gives textures to what enters and leaves.
    fn add_ports(&mut self) -> Result<()> {
        for port in self.plan.inputs() {
            self.add_port(port, Role::Input(port.name.clone()));
        }
        for port in self.plan.outputs() {
            if self.places[port.image.index()].is_some() {
                return Err(Error::Input(format!(
                    "output '{}' is an input or another output passed on unchanged",
                    port.name
                )));
            }
            self.add_port(port, Role::Output(port.name.clone()));
        }
        Ok(())
    }

    fn add_port(&mut self, port: &Port, role: Role) {
        if !self.windows[port.image.index()].is_empty() {
            let texture = self.texture(port.image, role, self.windows[port.image.index()]);
            self.places[port.image.index()] = Some(self.push(port.image, texture));
        }
    }

    fn texture(&self, image: ImageId, role: Role, window: Rect) -> Texture {
        let desc = self.plan.desc(image);
        Texture { role, format: Format::of(desc, self.precision), class: desc.class, window }
    }

    fn push(&mut self, image: ImageId, texture: Texture) -> u32 {
        self.textures.push(texture);
        self.levels.push(self.plan.desc(image).level);
        self.textures.len() as u32 - 1
    }

    /// Gives textures to the transient images that a dispatch writes: free ones of their level and format, which grow
    /// where an image is larger, or new ones. The size does not choose, so that tiles of all sizes connect their
    /// passes alike and one prepared program runs them all.
    fn make_room(&mut self, outputs: &[ImageId]) {
        for output in outputs {
            if self.places[output.index()].is_some() {
                continue;
            }
            let window = self.windows[output.index()];
            let wanted =
                self.texture(*output, Role::Transient, Rect::of_size(window.width(), window.height()));
            let fits = |free: &u32| {
                let texture = &self.textures[*free as usize];
                (texture.format, texture.class) == (wanted.format, wanted.class)
                    && self.levels[*free as usize] == self.plan.desc(*output).level
            };
            let place = match self.free.iter().position(fits) {
                Some(at) => {
                    let place = self.free.swap_remove(at);
                    let window = &mut self.textures[place as usize].window;
                    window.x1 = window.x1.max(wanted.window.x1);
                    window.y1 = window.y1.max(wanted.window.y1);
                    place
                }
                None => self.push(*output, wanted),
            };
            self.places[output.index()] = Some(place);
        }
    }

    /// Frees the transient textures of images that are needed no longer.
    fn release(&mut self, ending: &[ImageId]) {
        let ended = ending.iter().filter_map(|id| self.places[id.index()]);
        self.free.extend(ended.filter(|place| self.textures[*place as usize].role == Role::Transient));
    }

    /// The dispatch of passes that are fused; mostly of one.
    fn dispatch(&self, fusion: &Fusion, passes: &[&Pass]) -> Dispatch {
        let out = fusion.outputs[0];
        let window = self.windows[out.index()];
        let full = self.plan.level_size(self.plan.desc(out).level);
        let read: Vec<ImageId> = external(self.plan, &fusion.passes).collect();
        let mut inputs = [[0; 4]; MAX_INPUTS];
        for (place, image) in inputs.iter_mut().zip(&read) {
            let w = self.windows[image.index()];
            let [fw, fh] = self.plan.level_size(self.plan.desc(*image).level);
            *place = [w.x0, w.y0, fw, fh];
        }
        let size = [window.width() as i32, window.height() as i32];
        let reaches = reaches(self.plan, &fusion.passes, fusion.lead);
        let halo = reaches.map_or([0; 2], |[_, halo]| [halo as i32; 2]);
        // Every image of a dispatch got its texture before it, or in an earlier one.
        let textures = |ids: &[ImageId]| ids.iter().filter_map(|id| self.places[id.index()]).collect();
        let shader = self.shader(fusion, passes);
        let groups = |side: u32| side.div_ceil(shader.workgroup);
        Dispatch {
            grid: Grid { origin: [window.x0, window.y0], size, full, halo, inputs },
            params: params(passes),
            inputs: textures(&read),
            outputs: textures(&fusion.outputs),
            workgroups: [groups(window.width()), groups(window.height()), 1],
            shader: Arc::new(shader),
        }
    }

    fn shader(&self, fusion: &Fusion, passes: &[&Pass]) -> Shader {
        let format = |image: &ImageId| Format::of(self.plan.desc(*image), self.precision);
        let first = passes[0];
        let reading = if fusion.lead == Lead::Single { self.reading(first) } else { Reading::default() };
        if let [pass] = passes {
            let outputs: Vec<Format> = pass.outputs.iter().map(format).collect();
            return Shader::of(pass.kernel, &outputs, reading);
        }
        let place = |image: &ImageId, before: usize| {
            passes[..before].iter().position(|pass| pass.outputs.contains(image))
        };
        let links = passes.iter().enumerate().map(|(at, pass)| Link {
            kernel: pass.kernel,
            values: pass.inputs.iter().map(|image| place(image, at)).collect(),
        });
        let outputs = fusion.outputs.iter();
        let outputs = outputs.filter_map(|image| Some((place(image, passes.len())?, format(image))));
        let level = |image: ImageId| self.plan.desc(image).level;
        let fused = Fused {
            links: links.collect(),
            lead: fusion.lead,
            outputs: outputs.collect(),
            is_held: level(first.inputs[0]) == level(first.outputs[0]),
            reading,
        };
        fused.shader()
    }

    /// Access of a pass to its textures.
    fn reading(&self, pass: &Pass) -> Reading {
        let pieces = &pass.kernel.pieces;
        let is_half =
            |input: &usize| Format::of(self.plan.desc(pass.inputs[*input]), self.precision) == Format::Rgba16;
        let is_fast = self.precision == Precision::Fast;
        // What enters is the caller's, and may be more precise, unless it is asked for in 16 bits.
        let is_own = |input: &usize| self.plan.inputs().iter().all(|port| port.image != pass.inputs[*input]);
        Reading {
            is_filtered: is_fast && !pieces.filtered.is_empty() && pieces.filtered.iter().all(is_half),
            is_packed: pieces.windowed.as_ref().is_some_and(|at| is_half(at) && (is_fast || is_own(at))),
        }
    }
}

/// The uniform bytes of passes in one dispatch.
fn params(passes: &[&Pass]) -> Vec<u8> {
    let mut params = Vec::new();
    for pass in passes {
        params.extend_from_slice(&pass.params);
        if passes.len() > 1 {
            params.resize(padded(params.len()), 0);
        }
    }
    params
}
