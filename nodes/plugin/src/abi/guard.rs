//! The one gate of every foreign call: errors and panics become statuses with a message.

use super::args;
use super::failure::{Failure, Outcome};
use super::handles::{Handle, Object};
use isophote_abi::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Runs the inside of a call; `report` is given the message of a failure.
pub fn call(body: impl FnOnce() -> Outcome<()>, report: impl FnOnce(&str)) -> IsophoteStatus {
    let outcome =
        catch_unwind(AssertUnwindSafe(body)).unwrap_or_else(|payload| Err(Failure::panicked(&*payload)));
    match outcome {
        Ok(()) => ISOPHOTE_OK,
        Err(failure) => {
            // Formatting and copying a message does not panic; if it ever did, the status still counts.
            let _ = catch_unwind(AssertUnwindSafe(|| report(&failure.message)));
            failure.status
        }
    }
}

/// A call on an object, which keeps the message of a failure.
pub fn on<T: Object>(handle: T::Handle, body: impl FnOnce(&Arc<T>) -> Outcome<()>) -> IsophoteStatus {
    let mut object = None;
    let inside = || {
        let found = T::slots().get(handle.id())?;
        body(object.insert(found))
    };
    // The object is looked up inside the guard and wanted again after it.
    let outcome = catch_unwind(AssertUnwindSafe(inside));
    let report = |message: &str| {
        if let Some(object) = &object {
            message.clone_into(&mut lock(object.message()));
        }
    };
    call(|| outcome.unwrap_or_else(|payload| Err(Failure::panicked(&*payload))), report)
}

/// A call that makes an object; its handle goes to `out`, the message of a failure to `error`.
///
/// # Safety
/// `error` is null or points to an `IsophoteText` that may be written, `out` is null or points to a
/// handle that may be written.
pub unsafe fn create<T: Object>(
    out: *mut T::Handle,
    error: *mut IsophoteText,
    body: impl FnOnce() -> Outcome<T>,
) -> IsophoteStatus {
    let inside = || {
        // SAFETY: as this function's caller promised.
        unsafe { args::put(out, T::Handle::new(0), "the place for the handle")? };
        let handle = T::Handle::new(T::slots().insert(body()?)?);
        // SAFETY: as before.
        unsafe { args::put(out, handle, "the place for the handle") }
    };
    // SAFETY: as this function's caller promised.
    call(inside, |message| unsafe { args::fill_message(error, message) })
}

/// Drops the handle's object once no call uses it.
pub fn destroy<T: Object>(handle: T::Handle) -> IsophoteStatus {
    call(
        || {
            // Dropped here, where a panic of a destructor is caught and no lock is held.
            drop(T::slots().remove(handle.id())?);
            Ok(())
        },
        |_| {},
    )
}

/// The message of the object's last failure.
///
/// # Safety
/// `text` is null or points to an `IsophoteText` that may be written.
pub unsafe fn last_message<T: Object>(handle: T::Handle, text: *mut IsophoteText) -> IsophoteStatus {
    call(
        || {
            let object = T::slots().get(handle.id())?;
            let message = lock(object.message()).clone();
            // SAFETY: as this function's caller promised.
            unsafe { args::fill(text, &message) }
        },
        |_| {},
    )
}

/// Locks, also after a panic in another call: what the locks here protect is replaced as a whole.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::abi::objects::GraphObject;
    use crate::abi::{graph, threads};
    use isophote::engine;
    use std::ptr::null_mut;

    #[test]
    fn a_panic_becomes_a_status_and_a_message() {
        let mut handle = IsophoteGraph::default();
        // SAFETY: both pointers may be written, or are null.
        assert_eq!(unsafe { graph::create(null_mut(), &raw mut handle) }, ISOPHOTE_OK);
        let status = on::<GraphObject>(handle, |_| panic!("the {} broke", "filter"));
        assert_eq!(status, ISOPHOTE_ERROR_INTERNAL);
        let object = GraphObject::slots().get(handle.id).unwrap();
        assert_eq!(*lock(object.message()), "a mistake inside Isophote: the filter broke");
        // The object goes on working.
        let mut count = 9;
        // SAFETY: the pointer may be written.
        assert_eq!(unsafe { graph::count(handle, &raw mut count) }, ISOPHOTE_OK);
        assert_eq!(count, 0);
        assert_eq!(destroy::<GraphObject>(handle), ISOPHOTE_OK);
        assert_eq!(destroy::<GraphObject>(handle), ISOPHOTE_ERROR_INVALID_HANDLE);
    }

    #[test]
    fn a_panic_on_a_worker_thread_becomes_a_status_too() {
        let pool = threads::pool(2);
        let status = call(
            || {
                engine::cpu::Threads::run(&*pool, 4, &|i| assert!(i != 3, "job {i} broke"));
                Ok(())
            },
            |message| assert!(message.ends_with("job 3 broke"), "{message}"),
        );
        assert_eq!(status, ISOPHOTE_ERROR_INTERNAL);
    }
}
