//! Warping error, its ratio, and gradient energy; for one filter and for many.

use super::carry::{carried, rgb};
use super::look::show;
use super::shot::Shot;
use isophote_engine::Image;

/// A pixel that differs by more, in the mean of its channels, from the one before catches the eye.
const JUMP: f64 = 0.25;

/// Steadiness of the frames of a filter; formulas in the description of this module's parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steadiness {
    /// Warping error.
    pub error: f64,
    /// Warping error over that of the plain frames.
    pub ratio: f64,
    /// Gradient energy over that of the plain frames.
    pub energy_of_plain: f64,
    /// Gradient energy over that of the still frames.
    pub energy_of_still: f64,
    /// Part of the pixels, the first frame's left out, that count.
    pub counted: f64,
    /// Part of the pixels, the first frame's left out, that count and jump: that differ by more than 0.25.
    pub jumps: f64,
}

impl Steadiness {
    /// Flicker a contrast: the ratio over the gradient energy, since who draws strongly exaggerates all that moves.
    pub fn a_contrast(&self) -> f64 {
        self.ratio / self.energy_of_plain
    }
}

/// Measures the frames that a filter made of a shot; `still` are those that it makes without looking at other frames.
///
/// # Panics
/// When there are not as many frames of the same size as in the shot, or fewer than two.
pub fn measure(shot: &Shot, stylized: &[Image], still: &[Image]) -> Steadiness {
    let plain = shot.plain();
    assert!(plain.len() >= 2, "one frame is always steady");
    assert_eq!((stylized.len(), still.len()), (plain.len(), plain.len()), "a frame for every frame");
    let (changes, of_plain) = (Changes::of(shot, stylized), Changes::of(shot, &plain));
    let energy = energy(stylized);
    Steadiness {
        error: changes.error(),
        ratio: changes.error() / of_plain.error(),
        energy_of_plain: energy / self::energy(&plain),
        energy_of_still: energy / self::energy(still),
        counted: changes.share(changes.counted),
        jumps: changes.share(changes.jumps),
    }
}

/// Changes of all frames but the first against the frame before, carried.
#[derive(Default)]
struct Changes {
    sum: f64,
    counted: u64,
    jumps: u64,
    all: u64,
}

impl Changes {
    fn of(shot: &Shot, frames: &[Image]) -> Self {
        let mut changes = Self::default();
        for t in 1..frames.len() {
            let width = frames[t].width() as usize;
            for (index, before) in carried(shot, t, &frames[t - 1]).iter().enumerate() {
                changes.all += 1;
                if before.counts {
                    let now = rgb(&frames[t], (index % width) as i32, (index / width) as i32);
                    let change =
                        now.iter().zip(before.color).map(|(n, b)| f64::from((n - b).abs())).sum::<f64>()
                            / 3.0;
                    changes.sum += change;
                    changes.counted += 1;
                    changes.jumps += u64::from(change > JUMP);
                }
            }
        }
        changes
    }

    /// The warping error.
    fn error(&self) -> f64 {
        self.sum / self.counted as f64
    }

    fn share(&self, count: u64) -> f64 {
        count as f64 / self.all as f64
    }
}

/// Mean length of the gradient.
fn energy(frames: &[Image]) -> f64 {
    let (mut sum, mut count) = (0.0, 0_u64);
    for frame in frames {
        for y in 0..frame.height() as i32 - 1 {
            for x in 0..frame.width() as i32 - 1 {
                let (at, right, below) = (rgb(frame, x, y), rgb(frame, x + 1, y), rgb(frame, x, y + 1));
                let length = |c: usize| f64::from((right[c] - at[c]).hypot(below[c] - at[c]));
                sum += (length(0) + length(1) + length(2)) / 3.0;
                count += 1;
            }
        }
    }
    sum / count as f64
}

/// A filter that [`table`] measures.
pub struct Entry<'a> {
    name: String,
    still: Option<String>,
    frame: Box<dyn FnMut(usize) -> Image + 'a>,
}

impl<'a> Entry<'a> {
    /// A filter that makes the frame of a number, from 0, and is asked for them in order.
    pub fn new(name: impl Into<String>, frame: impl FnMut(usize) -> Image + 'a) -> Self {
        Self { name: name.into(), still: None, frame: Box::new(frame) }
    }

    /// Compares the energy with that of an entry before this one instead of its own.
    #[must_use]
    pub fn against(self, still: impl Into<String>) -> Self {
        Self { still: Some(still.into()), ..self }
    }
}

impl std::fmt::Debug for Entry<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Entry").field("name", &self.name).field("still", &self.still).finish_non_exhaustive()
    }
}

/// Result of [`table`] for an entry.
#[derive(Clone, Debug)]
pub struct Row {
    /// The entry's name.
    pub name: String,
    /// Its numbers.
    pub steadiness: Steadiness,
}

/// Runs filters over a shot and measures each. Shows their frames where a person asked for it, see [`show`].
///
/// # Panics
/// For a name in [`Entry::against`] that no entry before has, and as [`measure`].
pub fn table(shot: &Shot, entries: Vec<Entry<'_>>) -> Vec<Row> {
    show(shot, "plain", &shot.plain());
    let mut done: Vec<(String, Vec<Image>)> = Vec::new();
    let mut rows = Vec::new();
    for mut entry in entries {
        let frames: Vec<Image> = (0..shot.frames.len()).map(|t| (entry.frame)(t)).collect();
        show(shot, &entry.name, &frames);
        let still = entry.still.as_ref().map(|name| match done.iter().find(|(n, _)| n == name) {
            Some((_, frames)) => frames.as_slice(),
            None => panic!("no entry before '{}' is named '{name}'", entry.name),
        });
        let steadiness = measure(shot, &frames, still.unwrap_or(&frames));
        rows.push(Row { name: entry.name.clone(), steadiness });
        done.push((entry.name, frames));
    }
    rows
}
