//! Work that fails for a moment, and is tried again.
//!
//! On Windows a program that looks through new files, as those against viruses do, keeps others from opening, renaming and
//! removing them meanwhile.

use std::io;
use std::thread;
use std::time::{Duration, Instant};

/// Time that a file may be in use.
const PATIENCE: Duration = Duration::from_secs(2);

/// Pause between two tries.
const PAUSE: Duration = Duration::from_millis(25);

/// Numbers of Windows: access denied, which a file in use gets too where it is renamed or removed; sharing violation; lock
/// violation.
const IN_USE: [i32; 3] = [5, 32, 33];

/// The result of some work, tried again while it fails for something that passes, for two seconds at most.
///
/// # Errors
/// The last failure.
pub fn patiently<T>(mut work: impl FnMut() -> io::Result<T>) -> io::Result<T> {
    tried(&mut work, passes, PATIENCE)
}

/// True where a failure may pass by itself.
fn passes(error: &io::Error) -> bool {
    cfg!(windows) && error.raw_os_error().is_some_and(|number| IN_USE.contains(&number))
}

fn tried<T>(
    work: &mut impl FnMut() -> io::Result<T>,
    passes: impl Fn(&io::Error) -> bool,
    patience: Duration,
) -> io::Result<T> {
    let started = Instant::now();
    loop {
        match work() {
            Err(error) if passes(&error) && started.elapsed() < patience => thread::sleep(PAUSE),
            result => return result,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_passes_is_tried_again_and_what_stays_is_not() {
        let mut tries = 0;
        let mut third = || {
            tries += 1;
            if tries == 3 { Ok(tries) } else { Err(io::Error::from_raw_os_error(32)) }
        };
        assert_eq!(tried(&mut third, |e| e.raw_os_error() == Some(32), PATIENCE).unwrap(), 3);
        let mut tries = 0;
        let mut never = || -> io::Result<()> {
            tries += 1;
            Err(io::Error::from_raw_os_error(2))
        };
        assert_eq!(tried(&mut never, |_| false, PATIENCE).unwrap_err().raw_os_error(), Some(2));
        assert_eq!(tries, 1);
        let mut always = || -> io::Result<()> { Err(io::Error::from_raw_os_error(32)) };
        assert!(tried(&mut always, |_| true, PAUSE).is_err(), "it ends");
    }

    #[cfg(windows)]
    #[test]
    fn a_file_that_another_holds_for_a_moment_is_waited_for() {
        use std::os::windows::fs::OpenOptionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("held");
        std::fs::write(&path, "text").unwrap();
        let held = std::fs::OpenOptions::new().read(true).share_mode(0).open(&path).unwrap();
        assert!(std::fs::read(&path).is_err(), "nobody else may open it");
        let holder = thread::spawn(move || {
            thread::sleep(4 * PAUSE);
            drop(held);
        });
        assert_eq!(patiently(|| std::fs::read(&path)).unwrap(), b"text");
        holder.join().unwrap();
    }
}
