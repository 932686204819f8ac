//! A bound on the memory that one scene may take while it is loaded. Files can claim far more than they hold:
//! images expand, accessors need no data, and thousands of meshes can refer to the same bytes.

use std::cell::{Cell, RefCell};
use std::fs::File;
use std::io::Read;

use isophote_files::identity::Identity;

const GIB: u64 = 1 << 30;

/// Advice for a scene that was refused.
pub const TOO_LARGE: &str = "use smaller images, or split the scene";

/// Rest of the memory of a scene. What was taken is not given back: the sum bounds the peak.
pub struct Budget {
    total: u64,
    left: Cell<u64>,
    exceeded: Cell<bool>,
    files: RefCell<Vec<Identity>>,
}

impl Default for Budget {
    /// 4 GiB.
    fn default() -> Self {
        Self::new(4 * GIB)
    }
}

impl Budget {
    /// A budget of so many bytes.
    pub fn new(total: u64) -> Self {
        Self { total, left: Cell::new(total), exceeded: Cell::new(false), files: RefCell::default() }
    }

    /// Takes the memory of `count` things of `size` bytes; to be called before it is allocated.
    ///
    /// # Errors
    /// A clause saying that there is not so much left.
    pub fn take(&self, count: usize, size: usize) -> Result<(), String> {
        let left = count.checked_mul(size).and_then(|bytes| self.left.get().checked_sub(bytes as u64));
        let Some(left) = left else {
            self.exceeded.set(true);
            let total = match self.total {
                total if total >= GIB => format!("{} GiB", total / GIB),
                total => format!("{total} bytes"),
            };
            return Err(format!("would take the scene beyond {total} of memory"));
        };
        self.left.set(left);
        Ok(())
    }

    /// Bytes that are left.
    #[cfg(feature = "compressed")]
    pub fn left(&self) -> u64 {
        self.left.get()
    }

    /// Reads a whole file.
    ///
    /// # Errors
    /// A clause saying why it cannot be read, or that it is larger than what is left.
    pub fn read(&self, file: File) -> Result<Vec<u8>, String> {
        self.files.borrow_mut().extend(Identity::of_open(&file));
        let length = file.metadata().map_err(|e| e.to_string())?.len();
        if length > self.left.get() {
            self.take(usize::MAX, 1)?;
        }
        let mut bytes = Vec::new();
        // Devices have no length, and files may grow.
        file.take(self.left.get().saturating_add(1)).read_to_end(&mut bytes).map_err(|e| e.to_string())?;
        self.take(bytes.len(), 1)?;
        Ok(bytes)
    }

    /// The files that were read.
    pub fn files(&self) -> Vec<Identity> {
        self.files.take()
    }

    /// True once the budget refused anything.
    pub fn exceeded(&self) -> bool {
        self.exceeded.get()
    }

    /// [`TOO_LARGE`] if the budget refused anything, or else `otherwise`.
    pub fn fix(&self, otherwise: &'static str) -> &'static str {
        if self.exceeded() { TOO_LARGE } else { otherwise }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_given_beyond_the_total() {
        let budget = Budget::new(10);
        assert_eq!(budget.fix("else"), "else");
        budget.take(2, 3).unwrap();
        assert_eq!(budget.take(5, 1).unwrap_err(), "would take the scene beyond 10 bytes of memory");
        assert_ne!(budget.fix("else"), "else");
        budget.take(2, 2).unwrap();
        assert!(Budget::default().take(usize::MAX, 2).unwrap_err().contains("4 GiB"));
    }

    #[test]
    fn files_count_with_their_length() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        std::fs::write(&path, [7; 100]).unwrap();
        let budget = Budget::new(150);
        assert_eq!(budget.read(File::open(&path).unwrap()).unwrap(), [7; 100]);
        assert!(budget.read(File::open(&path).unwrap()).is_err());
        #[cfg(unix)]
        assert!(budget.read(File::open("/dev/zero").unwrap()).unwrap_err().contains("150 bytes"));
    }
}
