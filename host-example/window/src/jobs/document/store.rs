//! Frames in memory within a bound, and which is to be read next.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::state::document::frame::Frame;
use isophote_files::error::Result;

/// Most frames that are read before they are shown, in the direction of play.
const AHEAD: usize = 48;
/// The same while nothing plays, on both sides.
const AROUND: usize = 2;
/// Factor by which a frame behind is given up sooner than one as far ahead.
const BEHIND: usize = 4;

/// Frames that were read, and where the play stands.
#[derive(Debug)]
pub struct Store {
    /// Most bytes of frames.
    most: u64,
    bytes: u64,
    /// Results of reading frames, by number.
    read: BTreeMap<i64, Result<Arc<Frame>>>,
    /// Bytes of the last frame that was read, which the next will hardly exceed.
    usual: u64,
    /// All frames that there are, in order.
    numbers: Arc<[i64]>,
    /// Index of the frame that is shown.
    at: usize,
    /// 1 forward, -1 backward, 0 for a play that stands still.
    direction: i64,
}

impl Store {
    /// A store of at most so many bytes, but for the one frame that is shown.
    pub fn new(most: u64, numbers: Arc<[i64]>) -> Self {
        Self { most, bytes: 0, read: BTreeMap::new(), usual: 0, numbers, at: 0, direction: 0 }
    }

    /// All frames that there are, in order.
    pub fn numbers(&self) -> &Arc<[i64]> {
        &self.numbers
    }

    /// Takes over that there are other frames than was thought.
    pub fn renumber(&mut self, numbers: Arc<[i64]>) {
        self.at = self.at.min(numbers.len().saturating_sub(1));
        self.numbers = numbers;
    }

    /// Sets the direction in which frames are shown from now on; true where that is news.
    pub fn play(&mut self, direction: i64) -> bool {
        std::mem::replace(&mut self.direction, direction.signum()) != direction.signum()
    }

    /// Direction in which frames are shown.
    pub fn direction(&self) -> i64 {
        self.direction
    }

    /// Shows a frame of those that there are, and says whether that is news.
    pub fn go_to(&mut self, number: i64) -> bool {
        let at = self.numbers.binary_search(&number).unwrap_or(self.at);
        std::mem::replace(&mut self.at, at) != at
    }

    /// The frame, or why there is none, where it was read.
    pub fn get(&self, number: i64) -> Option<Result<Arc<Frame>>> {
        self.read.get(&number).cloned()
    }

    /// Numbers of the frames that are here.
    pub fn cached(&self) -> Vec<i64> {
        self.read.iter().filter(|(_, frame)| frame.is_ok()).map(|(number, _)| *number).collect()
    }

    /// True where a frame is worth the room that it takes, which others have to give up.
    pub fn wants(&self, number: i64) -> bool {
        let Some(distance) = self.distance(number).filter(|_| !self.read.contains_key(&number)) else {
            return false;
        };
        let is_nearer = |other: i64| self.distance(other).is_none_or(|other| other > distance);
        distance == 0
            || self.bytes + self.usual <= self.most
            || self.read.iter().any(|(number, frame)| frame.is_ok() && is_nearer(*number))
    }

    /// Takes a frame, or why there is none, and gives up others that are farther away.
    pub fn put(&mut self, number: i64, frame: Result<Arc<Frame>>) {
        if let Ok(frame) = &frame {
            self.usual = frame.bytes();
            self.bytes += self.usual;
        }
        if let Some(Ok(old)) = self.read.insert(number, frame) {
            self.bytes -= old.bytes();
        }
        while self.bytes > self.most {
            let here = |number: &i64| self.distance(*number).unwrap_or(usize::MAX);
            let frames = self.read.iter().filter(|(_, frame)| frame.is_ok()).map(|(number, _)| *number);
            let Some(farthest) = frames.max_by_key(here).filter(|number| here(number) > 0) else { break };
            if let Some(Ok(old)) = self.read.remove(&farthest) {
                self.bytes -= old.bytes();
            }
        }
    }

    /// The frame that is to be read next: the one that is shown, or the nearest of those that will be.
    pub fn next(&self) -> Option<i64> {
        let count = self.numbers.len();
        if count == 0 {
            return None;
        }
        let ahead = |n: usize| (self.at + n) % count;
        let behind = |n: usize| (self.at + count - n % count) % count;
        let order: Vec<usize> = match self.direction {
            0 => (0..=AROUND)
                .flat_map(|n| [self.at.checked_add(n), self.at.checked_sub(n)])
                .flatten()
                .collect(),
            1 => (0..=AHEAD).map(ahead).collect(),
            _ => (0..=AHEAD).map(behind).collect(),
        };
        order.into_iter().filter_map(|at| self.numbers.get(at).copied()).find(|number| self.wants(*number))
    }

    /// Distance of a frame from the one that is shown, in the direction of play, which goes round.
    fn distance(&self, number: i64) -> Option<usize> {
        let at = self.numbers.binary_search(&number).ok()?;
        let count = self.numbers.len();
        let forward = (at + count - self.at) % count;
        let backward = (self.at + count - at) % count;
        Some(match self.direction {
            0 => at.abs_diff(self.at),
            1 => forward.min(backward.saturating_mul(BEHIND)),
            _ => backward.min(forward.saturating_mul(BEHIND)),
        })
    }
}
