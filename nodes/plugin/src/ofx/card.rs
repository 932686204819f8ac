//! The controls of where frames are computed: on the CPU, or on a graphics card, on which, and how precisely.

use isophote::engine::program::Precision;
use std::ffi::CStr;

/// Names of the controls.
pub const COMPUTE_ON: &CStr = c"compute_on";
pub const CARD: &CStr = c"card";
pub const PRECISION: &CStr = c"precision";

/// Options of the controls.
pub const COMPUTE_OPTIONS: [&CStr; 2] = [c"CPU", c"Graphics card"];
pub const CARD_OPTIONS: [&CStr; 9] =
    [c"Automatic", c"Card 1", c"Card 2", c"Card 3", c"Card 4", c"Card 5", c"Card 6", c"Card 7", c"Card 8"];
pub const PRECISION_OPTIONS: [&CStr; 2] = [c"Exact", c"Half"];

pub const COMPUTE_HINT: &str =
    "Device that computes the frames. Where the graphics card cannot, the CPU does, and the effect says so.";
pub const CARD_HINT: &str = "Graphics card that is used, counted from the best; Automatic takes the best.";
pub const PRECISION_HINT: &str =
    "Exact computes as the CPU does. Half stores 16 bits for each number: faster, a little coarser.";

/// Graphics card that an instance wants to be computed on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Card {
    /// Position among the cards, from 1 on; 0 for the best.
    pub number: usize,
    /// Precision of its numbers.
    pub precision: Precision,
}

impl Card {
    /// The card by the positions of the controls' options; none for the CPU. What a host does not give is 0.
    pub fn of([compute_on, number, precision]: [usize; 3]) -> Option<Self> {
        let precision = if precision == 1 { Precision::Half } else { Precision::Exact };
        let number = if number < CARD_OPTIONS.len() { number } else { 0 };
        (compute_on == 1).then_some(Self { number, precision })
    }

    /// Adapter as the engine names it; none for the best.
    pub fn adapter(self) -> Option<String> {
        (self.number > 0).then(|| format!("#{}", self.number))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_name_a_card() {
        assert_eq!(Card::of([0, 1, 1]), None);
        let best = Card { number: 0, precision: Precision::Exact };
        assert_eq!(Card::of([1, 0, 0]), Some(best));
        assert_eq!(Card::of([1, 99, 99]), Some(best));
        assert_eq!(best.adapter(), None);
        let third = Card::of([1, 3, 1]).unwrap();
        assert_eq!((third.precision, third.adapter().as_deref()), (Precision::Half, Some("#3")));
    }
}
