//! Uniform blocks of all passes of a plan, in one buffer.

/// WGSL rounds the size of a uniform block up to its alignment, which is at most this.
const BLOCK_ALIGNMENT: usize = 16;

/// Place of a pass's block in the buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    /// First byte.
    pub offset: usize,
    /// Number of bytes that are bound.
    pub size: usize,
}

/// Contents of the buffer.
#[derive(Clone, Debug)]
pub struct Bytes {
    alignment: usize,
    bytes: Vec<u8>,
}

impl Bytes {
    /// No block yet, for devices that want blocks aligned so.
    pub fn new(alignment: u32) -> Self {
        Self { alignment: alignment.max(1) as usize, bytes: Vec::new() }
    }

    /// Adds a place for a block such as this, filled with zeros.
    pub fn place(&mut self, block: &[u8]) -> Block {
        let block = Block { offset: self.bytes.len(), size: block_size(block) };
        self.bytes.resize(block.offset + block.size.next_multiple_of(self.alignment), 0);
        block
    }

    /// Changes the bytes of a block; says whether they are others now.
    ///
    /// # Panics
    /// Where they are longer than the place.
    pub fn put(&mut self, block: Block, new: &[u8]) -> bool {
        let old = &mut self.bytes[block.offset..][..new.len()];
        let is_changed = old != new;
        old.copy_from_slice(new);
        is_changed
    }

    /// All bytes.
    pub fn as_slice(&self) -> &[u8] {
        &self.bytes
    }
}

/// Number of bytes that a uniform block takes.
pub const fn block_size(block: &[u8]) -> usize {
    block.len().next_multiple_of(BLOCK_ALIGNMENT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_aligned_and_changes_are_seen() {
        let mut bytes = Bytes::new(256);
        let [first, second] = [[1; 20].as_slice(), &[2; 16]].map(|block| bytes.place(block));
        assert_eq!(first, Block { offset: 0, size: 32 });
        assert_eq!(second, Block { offset: 256, size: 16 });
        assert_eq!(bytes.as_slice(), [0; 512]);
        assert!(bytes.put(second, &[2; 16]) && !bytes.put(second, &[2; 16]));
        assert_eq!(bytes.as_slice()[255..273], [[0].as_slice(), &[2; 16], &[0]].concat());
    }
}
