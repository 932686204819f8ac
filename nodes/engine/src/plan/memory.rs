//! Memory that a run takes, and its bounds.

use super::parts::{ImageId, Plan};
use crate::image::Rect;

/// Bytes that the working images of one band of a large frame should take, and those that they may, where the passes
/// allow bands. With a source and a result of 8K in floats, 4 GiB are not exceeded.
pub const WORKING_MEMORY: [u64; 2] = [768 << 20, 3000 << 20];
/// Bands of fewer rows would spend most of their time on what lies around them.
pub const LEAST_ROWS: i32 = 64;

impl Plan {
    /// The most bytes that the images of a run over `windows` ([`Plan::windows`]) take at once, those that
    /// enter included, when each is freed after its last use.
    pub fn peak_bytes(&self, windows: &[Rect]) -> u64 {
        let entering: u64 = self.inputs().iter().map(|port| self.values(port.image, windows)).sum();
        (entering + self.peak_values(windows)) * 4
    }

    /// The most values that passes over `windows` hold at once in the images they write.
    pub(crate) fn peak_values(&self, windows: &[Rect]) -> u64 {
        let enters = |id: &ImageId| self.inputs().iter().any(|port| port.image == *id);
        let (mut live, mut most) = (0, 0);
        for (index, pass) in self.passes().iter().enumerate() {
            live += pass.outputs.iter().map(|id| self.values(*id, windows)).sum::<u64>();
            most = most.max(live);
            let freed = self.lifetimes().ending_with(index).iter().filter(|id| !enters(id));
            live -= freed.map(|id| self.values(*id, windows)).sum::<u64>();
        }
        most
    }

    fn values(&self, id: ImageId, windows: &[Rect]) -> u64 {
        windows[id.index()].area() * u64::from(self.desc(id).channels)
    }

    /// Rows of a band of `region`, for callers that compute it band by band to save memory.
    ///
    /// Images ([`Plan::peak_bytes`]) take at most `good` bytes, as long as bands are high against what is
    /// read around them, which is computed anew for each; beyond that they take at most `most`. Bands have
    /// at least `least` rows, and all where a pass reads the whole picture, since a part would need as much.
    pub fn band_rows(&self, region: Rect, [good, most]: [u64; 2], least: i32) -> i32 {
        let all = region.height() as i32;
        let Some([_, halo]) = self.support().sides() else { return all };
        let efficient = i32::try_from(halo).unwrap_or(i32::MAX).saturating_mul(4).max(least);
        let takes = |rows: i32| {
            let middle = (region.y0 + region.y1 - rows) / 2;
            self.peak_bytes(&self.windows(Rect { y0: middle, y1: middle + rows, ..region }))
        };
        let mut rows = all;
        // No band is lower than that: a short one at the end would read as much around it as the others.
        while takes(rows) > good && (rows + 1) / 2 >= efficient {
            rows = (rows + 1) / 2;
        }
        while rows > least && takes(rows) > most {
            rows = ((rows + 1) / 2).max(least);
        }
        rows
    }
}
