//! Materials that ship, as they are declared.

/// Pixels across and down of a material that ships.
pub(super) const SIDE: usize = 512;

/// A material that ships.
#[derive(Clone, Copy, Debug)]
pub struct Shipped {
    /// Name by which it is chosen.
    pub name: &'static str,
    /// What it is, for people.
    pub doc: &'static str,
    /// Its pixels, 8 bits a channel: 3 channels of paper, 4 of hatching.
    pub(super) made: fn() -> Vec<u8>,
}
