//! Regions of every image that a part of the result needs.

use super::parts::{Pass, Plan, Support};
use crate::error::{Error, Result};
use crate::image::Rect;

impl Plan {
    /// Refuses regions that no run can compute.
    ///
    /// # Errors
    /// [`Error::Geometry`] when `region` (level 0) is empty or not inside the picture.
    pub(crate) fn check_region(&self, region: Rect) -> Result<()> {
        let [width, height] = self.size();
        if region.is_empty() || !Rect::of_size(width, height).contains(&region) {
            return Err(Error::Geometry(format!(
                "region {region:?} is not inside the picture of {width}x{height}"
            )));
        }
        Ok(())
    }

    /// The pixels of `level` that lie under `region` (level 0): what an output of that level returns.
    pub fn region_at(&self, region: Rect, level: i8) -> Rect {
        self.clip(rescale(region, 0, level), level)
    }

    /// The region (level 0) whose pixels of `level` hold a window of them.
    pub fn region_over(&self, window: Rect, level: i8) -> Rect {
        self.clip(rescale(window, level, 0), 0)
    }

    /// The window of every virtual image that is needed to compute `region` (level 0) of every
    /// output. Images that are not needed get an empty window.
    pub fn windows(&self, region: Rect) -> Vec<Rect> {
        let mut windows = vec![Rect::default(); self.images.len()];
        for port in &self.outputs {
            let level = self.desc(port.image).level;
            let needed = self.region_at(region, level);
            windows[port.image.index()] = windows[port.image.index()].union(&needed);
        }
        for pass in self.passes.iter().rev() {
            let out = pass.outputs.iter().fold(Rect::default(), |r, o| r.union(&windows[o.index()]));
            if out.is_empty() {
                continue;
            }
            // Every output of a pass is computed over the same window.
            for output in &pass.outputs {
                windows[output.index()] = out;
            }
            for (index, input) in pass.inputs.iter().enumerate() {
                let needed = self.read_by(pass, out, index);
                windows[input.index()] = windows[input.index()].union(&needed);
            }
        }
        windows
    }

    /// The pixels of input `index` that `pass` reads to compute `out`.
    pub(crate) fn read_by(&self, pass: &Pass, out: Rect, index: usize) -> Rect {
        let (from, level) = (self.desc(pass.outputs[0]).level, self.desc(pass.inputs[index]).level);
        match pass.supports[index].sides() {
            Some(sides) => {
                let sides = sides.map(|n| n.min(MAX_HALO) as i32);
                self.clip(rescale(out, from, level).grown_by(sides), level)
            }
            None => self.whole(level),
        }
    }

    /// Distance outside a region within which the inputs are read, in pixels of level 0, or `Global`. Holds for
    /// every region; with pyramids a region aligned to them may need a little less.
    pub fn support(&self) -> Support {
        // A region far from every border shows the full halo.
        let wide = self.of_size([1 << 24, 1 << 24]);
        let coarsest = wide.images.iter().map(|i| i.level).max().unwrap_or(0).clamp(0, 22);
        let step = 1 << coarsest;
        let region = Rect { x0: 1 << 23, y0: 1 << 23, x1: (1 << 23) + step, y1: (1 << 23) + step };
        let windows = wide.windows(region);
        let mut halo = 0;
        for port in &wide.inputs {
            let window = windows[port.image.index()];
            if window.is_empty() {
                continue;
            }
            if window.x0 <= 0 {
                return Support::Global;
            }
            // What was handed to a plan may be of another level.
            let window = rescale(window, wide.desc(port.image).level, 0);
            halo = halo.max(region.x0 - window.x0).max(window.x1 - region.x1);
            halo = halo.max(region.y0 - window.y0).max(window.y1 - region.y1);
        }
        // That was a region of whole coarse pixels; any other lies inside such a one.
        Support::Pixels((halo + step - 1) as u32)
    }

    /// The same passes over a picture of another size, to ask what they read.
    pub(crate) fn of_size(&self, size: [u32; 2]) -> Self {
        Self { size, ..self.clone() }
    }

    fn whole(&self, level: i8) -> Rect {
        let [w, h] = self.level_size(level);
        Rect { x0: 0, y0: 0, x1: w, y1: h }
    }

    fn clip(&self, rect: Rect, level: i8) -> Rect {
        // A region wholly outside still needs the edge pixels that it clamps to.
        let [w, h] = self.level_size(level);
        let x0 = rect.x0.clamp(0, w - 1);
        let y0 = rect.y0.clamp(0, h - 1);
        Rect { x0, y0, x1: rect.x1.clamp(x0 + 1, w), y1: rect.y1.clamp(y0 + 1, h) }
    }
}

/// Wider halos than any picture are cut to this, so that sums of positions cannot overflow.
const MAX_HALO: u32 = 1 << 25;

/// The pixels of level `to` that lie under `rect` of level `from`.
fn rescale(rect: Rect, from: i8, to: i8) -> Rect {
    // Beyond these every picture is one pixel, or none is that large.
    let shift = (i32::from(to) - i32::from(from)).clamp(-8, 30);
    if shift >= 0 {
        let up = |v: i32| (v + (1 << shift) - 1) >> shift;
        Rect { x0: rect.x0 >> shift, y0: rect.y0 >> shift, x1: up(rect.x1), y1: up(rect.y1) }
    } else {
        Rect { x0: rect.x0 << -shift, y0: rect.y0 << -shift, x1: rect.x1 << -shift, y1: rect.y1 << -shift }
    }
}
