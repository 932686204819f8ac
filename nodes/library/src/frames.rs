//! Knowledge that a host has of the frames around the one that it asks for.

/// Farthest frame that a plan reads, counted from the one that is computed.
pub const MOST_FRAMES: u32 = 31;

/// Frames that are there around the one that is computed.
///
/// A frame is known when all images of the graph's inputs are, of its own number and of all between it and the frame
/// that is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Frames {
    /// Known frames before this one, at most [`MOST_FRAMES`].
    pub past: u32,
    /// Known frames after this one, at most [`MOST_FRAMES`].
    pub future: u32,
    /// True where the stages that other frames carry leave the plan, as outputs `stage0`, `stage1@-1` and so on.
    pub keep: bool,
    /// The frames whose stages enter the plan instead of being computed in it, a bit each from -[`MOST_FRAMES`] on.
    handed: u64,
}

impl Frames {
    /// No other frame is known: every still.
    pub const NONE: Self = Self { past: 0, future: 0, keep: false, handed: 0 };

    /// So many frames before and after this one.
    pub const fn around(past: u32, future: u32) -> Self {
        let past = if past < MOST_FRAMES { past } else { MOST_FRAMES };
        let future = if future < MOST_FRAMES { future } else { MOST_FRAMES };
        Self { past, future, keep: false, handed: 0 }
    }

    /// Frames in order: so many before this one, whose stages the host hands in. Those of this one leave the plan.
    pub fn in_order(past: u32) -> Self {
        let known = Self::around(past, 0).keeping();
        (1..=known.past as i32).fold(known, |frames, before| frames.with_handed(-before))
    }

    /// The same where the host hands in the stages of `frame`, which is not 0.
    pub const fn with_handed(mut self, frame: i32) -> Self {
        if frame != 0 && frame.unsigned_abs() <= MOST_FRAMES {
            self.handed |= 1 << (frame + MOST_FRAMES as i32);
        }
        self
    }

    /// The same where all stages that are computed leave the plan.
    pub const fn keeping(mut self) -> Self {
        self.keep = true;
        self
    }

    /// The first and the last frame that is known, counted from the one that is computed.
    pub(crate) const fn range(&self) -> [i32; 2] {
        [-(self.past as i32), self.future as i32]
    }

    /// True for a frame that is known, counted from the one that is computed.
    pub const fn has(&self, frame: i32) -> bool {
        let [first, last] = self.range();
        first <= frame && frame <= last
    }

    /// True where the host hands in the stages of a frame.
    pub const fn is_handed(&self, frame: i32) -> bool {
        self.has(frame) && self.handed >> (frame + MOST_FRAMES as i32) & 1 == 1
    }
}
