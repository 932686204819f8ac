//! Order in which the CPU executor goes through a plan: all passes over a strip of rows before any goes on to the
//! next, so that what one pass writes is still in the cache when the next reads it.
//!
//! Every pass keeps a frontier, the row up to which its outputs are computed; it runs ahead of the
//! result by what the passes behind it reach. Nothing is computed twice. An intermediate image holds
//! only the rows that are still to be read. So do images that enter and leave, where they come and go by rows.

use crate::image::Rect;
use crate::plan::{ImageId, Plan};

/// Least rows of the result in a step that is to save memory: with fewer, threads have hardly anything to share.
const LEAST_STEP: i32 = 16;

/// Most rows that passes set out before the result; what is read beyond is read at once.
const MOST_REACH: u32 = 1 << 18;

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
        let rows = long_enough(plan, rows);
        if plan.passes().len() < 2 || rows > region.height() as i32 / 2 {
            return whole;
        }
        let strips = Self::strips(plan, region, windows, (rows, false));
        let values: u64 = written(plan).map(|image| strips.values(plan, windows, image)).sum();
        if values <= plan.peak_values(windows) { strips } else { whole }
    }

    /// Steps of `rows` rows of the result, or of fewer, so that all images take at most `most` bytes, those that enter and
    /// leave included, which come and go by rows. Steps of a few rows are the least; where even these take more, they do.
    pub fn within(plan: &Plan, region: Rect, windows: &[Rect], rows: i32, most: u64) -> Self {
        let mut rows = long_enough(plan, rows).clamp(1, region.height() as i32);
        loop {
            let strips = Self::strips(plan, region, windows, (rows, true));
            if rows <= LEAST_STEP || strips.bytes(plan, windows) <= most {
                return strips;
            }
            rows = (rows / 2).max(LEAST_STEP);
        }
    }

    /// Bytes that the images take, those that enter included.
    pub fn bytes(&self, plan: &Plan, windows: &[Rect]) -> u64 {
        let entering = plan.inputs().iter().map(|port| port.image.index());
        4 * entering.chain(written(plan)).map(|image| self.values(plan, windows, image)).sum::<u64>()
    }

    /// Values that an image holds at once.
    fn values(&self, plan: &Plan, windows: &[Rect], image: usize) -> u64 {
        let row = u64::from(windows[image].width()) * u64::from(plan.images()[image].channels);
        u64::try_from(self.capacity[image]).unwrap_or(0) * row
    }

    /// Steps of `rows` rows; by rows come and go those that enter and leave, or they are there as a whole.
    fn strips(plan: &Plan, region: Rect, windows: &[Rect], (rows, by_rows): (i32, bool)) -> Self {
        let entering = plan.inputs().iter().map(|port| port.image.index()).filter(|_| by_rows);
        let held: Vec<usize> = entering.chain(written(plan)).collect();
        let mut schedule = Self { frontiers: Vec::new(), kept: Vec::new(), capacity: vec![0; windows.len()] };
        let tops: Vec<i32> = windows.iter().map(|w| w.y0).collect();
        let mut kept_from = tops.clone();
        let endless = Endless::new(plan);
        // Where images are to hold few rows, passes set out one after the other: the result begins when the first of
        // them is as far ahead as it has to be.
        let mut y = if by_rows { region.y0 - endless.reach } else { region.y0 };
        while y < region.y1 {
            // A short strip at the end joins the one before it.
            y = if region.y1 - y < 2 * rows { region.y1 } else { y + rows };
            let frontier = match y == region.y1 {
                true => windows.iter().map(|all| all.y1).collect(),
                false => endless.frontier(y, windows),
            };
            if y < region.y1 && schedule.frontiers.last().unwrap_or(&tops) == &frontier {
                continue;
            }
            for image in &held {
                let most = &mut schedule.capacity[*image];
                *most = (*most).max(frontier[*image] - kept_from[*image]);
            }
            kept_from = kept(plan, windows, &frontier, by_rows);
            schedule.frontiers.push(frontier);
            schedule.kept.push(kept_from.clone());
        }
        // With room for another strip, rows are moved to the front every other time only.
        for image in held {
            let most = &mut schedule.capacity[image];
            *most = (*most + rows).min(windows[image].height() as i32);
        }
        schedule
    }
}

/// A plan for a picture that goes on above its first row, where no border stops what passes read.
struct Endless {
    plan: Plan,
    /// Rows above the first one.
    above: i32,
    /// Rows below a region that are read for it.
    reach: i32,
}

impl Endless {
    fn new(plan: &Plan) -> Self {
        let coarsest = plan.images().iter().map(|image| image.level).max().unwrap_or(0).clamp(0, 22);
        let [width, height] = plan.size();
        let reach = plan.support().sides().map_or(MOST_REACH, |[_, rows]| rows.min(MOST_REACH)) as i32;
        // Pixels of coarse levels stay where they are above fine ones.
        let above = (2 * reach as u32 + 1).next_multiple_of(1 << coarsest) as i32;
        Self { plan: plan.of_size([width, height + above as u32]), above, reach }
    }

    /// The rows up to which images must be computed for the row `y` of the result (level 0), exclusive, within `windows`.
    fn frontier(&self, y: i32, windows: &[Rect]) -> Vec<i32> {
        let [width, _] = self.plan.size();
        let row = Rect { x0: 0, y0: self.above + y - 1, x1: width as i32, y1: self.above + y };
        let levels = self.plan.images().iter().map(|image| image.level);
        let needed = self.plan.windows(row).into_iter().zip(levels).zip(windows);
        needed
            .map(|((needed, level), all)| {
                let above = if level >= 0 { self.above >> level } else { self.above << -level };
                (needed.y1 - above).clamp(all.y0, all.y1)
            })
            .collect()
    }
}

/// At least `rows` rows, and so many that a step is long against what passes reach, which a band reads on both its sides.
/// Images that enter do not count: they are there as far as they are read, which costs nothing.
fn long_enough(plan: &Plan, rows: i32) -> i32 {
    let enters = |id: &ImageId| plan.inputs().iter().any(|port| port.image == *id);
    let inner = plan.passes().iter().flat_map(|pass| pass.inputs.iter().zip(&pass.supports));
    let reach = inner.filter(|(input, _)| !enters(input)).map(|(_, support)| {
        support.sides().and_then(|[_, rows]| i32::try_from(rows).ok()).unwrap_or(i32::MAX)
    });
    rows.max(reach.max().unwrap_or(0).saturating_mul(4))
}

/// The images that passes write.
fn written(plan: &Plan) -> impl Iterator<Item = usize> {
    plan.passes().iter().flat_map(|pass| pass.outputs.iter().map(|o| o.index()))
}

/// The first row of each image that is read once all is computed up to `frontier`; images that leave are kept as a whole, or
/// go `by_rows`.
fn kept(plan: &Plan, windows: &[Rect], frontier: &[i32], by_rows: bool) -> Vec<i32> {
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
    for port in plan.outputs().iter().filter(|_| !by_rows) {
        kept[port.image.index()] = windows[port.image.index()].y0;
    }
    kept.iter().zip(frontier).map(|(kept, frontier)| *kept.min(frontier)).collect()
}
