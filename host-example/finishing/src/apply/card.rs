//! A graphics card that may fail.

use std::sync::atomic::{AtomicBool, Ordering};

use isophote_files::output;
use isophote_loader::abi::{ISOPHOTE_ERROR_DEVICE, ISOPHOTE_ERROR_NO_DEVICE, ISOPHOTE_ERROR_OUT_OF_MEMORY};
use isophote_loader::{Error, Result};

/// What looks are computed on: a graphics device, or the CPU where there is none. Where nobody insists on the device, the CPU
/// takes over as soon as it fails, as cards do whose driver cannot compile a shader.
#[derive(Debug)]
pub struct Card<D> {
    device: Option<D>,
    is_demanded: bool,
    has_failed: AtomicBool,
}

impl<D> Card<D> {
    /// A device; without one the CPU. `is_demanded` says that its failures are errors.
    pub fn new(device: Option<D>, is_demanded: bool) -> Self {
        Self { device, is_demanded, has_failed: AtomicBool::new(false) }
    }

    /// The device, until it fails.
    pub fn device(&self) -> Option<&D> {
        self.device.as_ref().filter(|_| !self.has_failed.load(Ordering::Relaxed))
    }

    /// The result of some work on the device, or else without it. That the CPU takes over is warned of once.
    ///
    /// # Errors
    /// Those of the work, but not the device's where the CPU takes over.
    pub fn run<T>(&self, mut work: impl FnMut(Option<&D>) -> Result<T>) -> Result<T> {
        let device = self.device();
        match work(device) {
            Err(error) if device.is_some() && !self.is_demanded && is_of_device(&error) => {
                if !self.has_failed.swap(true, Ordering::Relaxed) {
                    output::warn(format!(
                        "the graphics card fails, and the CPU computes in its place: {error}"
                    ));
                }
                work(None)
            }
            result => result,
        }
    }
}

/// True for errors that another device might not have.
fn is_of_device(error: &Error) -> bool {
    let of_devices = [ISOPHOTE_ERROR_NO_DEVICE, ISOPHOTE_ERROR_DEVICE, ISOPHOTE_ERROR_OUT_OF_MEMORY];
    error.status().is_some_and(|status| of_devices.contains(&status))
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_loader::abi::ISOPHOTE_ERROR_INPUT;

    fn failing(status: u32) -> impl Fn(Option<&i32>) -> Result<Option<i32>> {
        move |device| match device {
            Some(_) => Err(Error::Call { status, message: "it cannot compile".into() }),
            None => Ok(None),
        }
    }

    #[test]
    fn the_cpu_takes_over_where_nobody_insists_on_the_card() {
        let card = Card::new(Some(1), false);
        assert_eq!(card.run(|device| Ok(device.copied())).unwrap(), Some(1));
        let (result, warnings) = output::with_warnings(|| {
            let first = card.run(failing(ISOPHOTE_ERROR_DEVICE)).unwrap();
            assert_eq!((first, card.device()), (None, None));
            card.run(|device| Ok(device.copied())).unwrap()
        });
        assert_eq!((result, warnings.len()), (None, 1));
        assert!(warnings[0].contains("CPU") && warnings[0].contains("it cannot compile"), "{warnings:?}");
    }

    #[test]
    fn other_errors_and_those_of_a_card_that_is_demanded_stay() {
        let status = |card: &Card<i32>, status| card.run(failing(status)).unwrap_err().status();
        let demanded = Card::new(Some(1), true);
        assert_eq!(status(&demanded, ISOPHOTE_ERROR_DEVICE), Some(ISOPHOTE_ERROR_DEVICE));
        let card = Card::new(Some(1), false);
        assert_eq!(status(&card, ISOPHOTE_ERROR_INPUT), Some(ISOPHOTE_ERROR_INPUT));
        assert_eq!(card.device(), Some(&1));
        let cpu: Card<i32> = Card::new(None, false);
        let failing = |_: Option<&i32>| -> Result<()> {
            Err(Error::Call { status: ISOPHOTE_ERROR_OUT_OF_MEMORY, message: "full".into() })
        };
        assert!(cpu.run(failing).is_err());
    }
}
