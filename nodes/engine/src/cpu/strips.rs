//! Order in which the CPU executor goes through a plan: all passes over a strip of rows before any goes on to the
//! next, so that what one pass writes is still in the cache when the next reads it.
//!
//! Every pass keeps a frontier, the row up to which its outputs are computed; it runs ahead of the
//! result by what the passes behind it reach. Nothing is computed twice. An intermediate image holds
//! only the rows that are still to be read.

use crate::image::Rect;
use crate::plan::{ImageId, Plan, Support};

/// The steps of a run and what each image must hold for them.
#[derive(Debug)]
pub(crate) struct Schedule {
    /// By step and virtual image: the row up to which the image is computed, exclusive.
    pub frontiers: Vec<Vec<i32>>,
    /// By step and virtual image: the first row that is read after the step.
    pub kept: Vec<Vec<i32>>,
    /// By virtual image: rows that it must be able to hold at once.
    pub capacity: Vec<i32>,
}

impl Schedule {
    /// One step: every pass over all its rows.
    pub fn whole(windows: &[Rect]) -> Self {
        Self {
            frontiers: vec![windows.iter().map(|w| w.y1).collect()],
            kept: vec![windows.iter().map(|w| w.y1).collect()],
            capacity: windows.iter().map(|w| w.height() as i32).collect(),
        }
    }

    /// Steps of `rows` rows of the result, where that takes no more memory than whole passes; `windows`
    /// are those of `region`.
    pub fn new(plan: &Plan, region: Rect, windows: &[Rect], rows: i32) -> Self {
        let whole = Self::whole(windows);
        // A step should be long against what passes reach, which a band reads on both its sides.
        // Images that enter are there as a whole: how far they are read costs nothing.
        let enters = |id: &ImageId| plan.inputs().iter().any(|port| port.image == *id);
        let inner = plan.passes().iter().flat_map(|pass| pass.inputs.iter().zip(&pass.supports));
        let reach = inner.filter(|(input, _)| !enters(input)).map(|(_, support)| match support {
            Support::Pixels(n) => i32::try_from(*n).unwrap_or(i32::MAX),
            Support::Global => i32::MAX,
        });
        let rows = rows.max(reach.max().unwrap_or(0).saturating_mul(4));
        if plan.passes().len() < 2 || rows > region.height() as i32 / 2 {
            return whole;
        }
        let strips = Self::strips(plan, region, windows, rows);
        let bytes = |rows: &[i32]| -> u64 {
            let of = |i: usize| {
                rows[i] as u64 * u64::from(windows[i].width()) * u64::from(plan.images()[i].channels)
            };
            written(plan).map(of).sum()
        };
        if bytes(&strips.capacity) <= plan.peak_values(windows) { strips } else { whole }
    }

    fn strips(plan: &Plan, region: Rect, windows: &[Rect], rows: i32) -> Self {
        let mut schedule = Self { frontiers: Vec::new(), kept: Vec::new(), capacity: vec![0; windows.len()] };
        let mut kept_from: Vec<i32> = windows.iter().map(|w| w.y0).collect();
        let mut y = region.y0;
        while y < region.y1 {
            // A short strip at the end joins the one before it.
            y = if region.y1 - y < 2 * rows { region.y1 } else { y + rows };
            let frontier: Vec<i32> = plan
                .windows(Rect { y1: y, ..region })
                .iter()
                .zip(windows)
                .map(|(top, all)| if y == region.y1 { all.y1 } else { top.y1.min(all.y1) })
                .collect();
            for image in written(plan) {
                let most = &mut schedule.capacity[image];
                *most = (*most).max(frontier[image] - kept_from[image]);
            }
            kept_from = kept(plan, windows, &frontier);
            schedule.frontiers.push(frontier);
            schedule.kept.push(kept_from.clone());
        }
        // With room for another strip, rows are moved to the front every other time only.
        for image in written(plan) {
            let most = &mut schedule.capacity[image];
            *most = (*most + rows).min(windows[image].height() as i32);
        }
        schedule
    }
}

/// The images that passes write.
fn written(plan: &Plan) -> impl Iterator<Item = usize> {
    plan.passes().iter().flat_map(|pass| pass.outputs.iter().map(|o| o.index()))
}

/// The first row of each image that is read once all is computed up to `frontier`.
fn kept(plan: &Plan, windows: &[Rect], frontier: &[i32]) -> Vec<i32> {
    let mut kept: Vec<i32> = windows.iter().map(|w| w.y1).collect();
    for pass in plan.passes() {
        let output = pass.outputs[0].index();
        let rest = Rect { y0: frontier[output], ..windows[output] };
        if rest.is_empty() {
            continue;
        }
        for (index, input) in pass.inputs.iter().enumerate() {
            let first = plan.read_by(pass, rest, index).y0;
            kept[input.index()] = kept[input.index()].min(first);
        }
    }
    for port in plan.outputs() {
        kept[port.image.index()] = windows[port.image.index()].y0;
    }
    kept.iter().zip(frontier).map(|(kept, frontier)| *kept.min(frontier)).collect()
}
