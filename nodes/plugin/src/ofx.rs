//! The OpenFX face: every node as an image effect of its own, for hosts such as Nuke, Resolve and Natron.
//!
//! Thin: [`effects`] derives what there is from the nodes' declarations, [`describe`] describes it to hosts,
//! [`settings`], [`known`], [`image`], [`inputs`] and [`vectors`] read what hosts have, [`crate::pixel_aspect`] makes their pixels
//! square, and [`render`] has the frame's [`plans`], which are [`prepared`], run by its [`executors`]. [`shipped`] lists the looks, [`looks`] sets the
//! controls of a style to one, and [`look_effect`] finds what the effect for looks shows. Nothing is kept between calls but
//! the host's functions, [`preset_files`], the [`device`] of a graphics card, memory of images, and what frames have in
//! common ([`neighbours`]), found by the contents of pictures alone; so any action may come on any thread, in any number.

mod before;
mod blending;
mod card;
mod clips;
mod colours;
mod content;
mod contents;
mod controls;
mod describe;
mod device;
mod effects;
mod executors;
mod faults;
mod frame;
mod host;
mod image;
mod inputs;
mod instance;
mod kept;
mod known;
#[cfg(test)]
mod labels;
mod look_effect;
mod looks;
mod made;
mod mask;
mod motion;
mod needed;
mod neighbours;
mod plans;
mod prepared;
mod preset_files;
#[cfg(test)]
mod promised;
mod quirks;
mod render;
mod results;
mod segments;
mod settings;
mod shipped;
mod stop;
mod threads;
mod values;
mod vectors;

use crate::abi::guard::lock;
use crate::abi::threads::forget_pools;
use effects::{EFFECTS, Effect};
use host::{Failure, Host, Outcome};
use isophote_abi::openfx::*;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::{null, null_mut};
use std::sync::{Arc, LazyLock, Mutex};

/// More effects than there are nodes. Hosts call a function per effect and do not say which effect they
/// mean, so that there must be as many functions; a test fails when they run out.
const MOST: usize = 64;

/// State that is known of the host of one effect.
struct Slot {
    host: *mut OfxHost,
    fetched: Option<Arc<Host>>,
}

// SAFETY: the pointer is the host's, which the standard keeps valid and constant until the library is
// unloaded, on every thread.
unsafe impl Send for Slot {}

static SLOTS: [Mutex<Slot>; MOST] = [const { Mutex::new(Slot { host: null_mut(), fetched: None }) }; MOST];

impl Slot {
    /// The host's functions, fetched when they are not yet.
    fn get(&mut self) -> Outcome<Arc<Host>> {
        if let Some(host) = &self.fetched {
            return Ok(Arc::clone(host));
        }
        // SAFETY: null, or what the host gave, as said above.
        let host = Arc::new(unsafe { Host::fetch(self.host) }?);
        self.fetched = Some(Arc::clone(&host));
        Ok(host)
    }
}

unsafe extern "C" fn set_host<const N: usize>(host: *mut OfxHost) {
    let _ = catch_unwind(|| {
        // The structure is not looked into before the host has loaded the effect.
        let mut slot = lock(&SLOTS[N]);
        if slot.host != host {
            *slot = Slot { host, fetched: None };
        }
    });
}

unsafe extern "C" fn main_entry<const N: usize>(
    action: *const c_char,
    handle: *const c_void,
    in_args: Handle,
    out_args: Handle,
) -> OfxStatus {
    guarded(|| {
        if action.is_null() {
            return Err(kOfxStatFailed);
        }
        // SAFETY: the standard has actions be strings with a closing zero.
        let action = unsafe { CStr::from_ptr(action) };
        act(N, action, handle.cast_mut(), in_args, out_args)
    })
}

/// The one gate: no panic leaves it.
fn guarded(body: impl FnOnce() -> Outcome) -> OfxStatus {
    catch_unwind(AssertUnwindSafe(body))
        .unwrap_or(Err(kOfxStatFailed))
        .unwrap_or_else(|failure: Failure| failure)
}

fn act(number: usize, action: &CStr, handle: Handle, in_args: Handle, out_args: Handle) -> Outcome {
    let effect: &'static Effect = EFFECTS.get(number).ok_or(kOfxStatFailed)?;
    if let Some(outcome) = act_on_library(number, action) {
        return outcome;
    }
    if !ACTIONS_ON_EFFECTS.contains(&action) {
        return Ok(kOfxStatReplyDefault);
    }
    if handle.is_null() {
        return Err(kOfxStatErrBadHandle);
    }
    faults::at(effect, action);
    // The slot is not locked while the host is called.
    let host = lock(&SLOTS[number]).get()?;
    act_on_effect(effect, &host, action, handle, in_args, out_args)
}

/// Actions that concern no effect in particular; none for the others.
fn act_on_library(number: usize, action: &CStr) -> Option<Outcome> {
    match action {
        a if a == kOfxActionLoad => {
            let mut slot = lock(&SLOTS[number]);
            // A host may come back at the same address with other functions.
            slot.fetched = None;
            Some(slot.get().map(|_| kOfxStatOK))
        }
        a if a == kOfxActionUnload => {
            lock(&SLOTS[number]).fetched = None;
            forget_caches();
            Some(Ok(kOfxStatOK))
        }
        a if a == kOfxActionPurgeCaches => {
            forget_caches();
            Some(Ok(kOfxStatOK))
        }
        _ => None,
    }
}

/// Frees graphics devices, ends idle threads, and gives back what is kept from one render to the next.
fn forget_caches() {
    device::forget();
    forget_pools();
    preset_files::forget_all();
    render::forget_caches();
}

/// Actions on a descriptor or an instance; [`act_on_effect`] knows each.
const ACTIONS_ON_EFFECTS: [&CStr; 12] = [
    kOfxActionDescribe,
    kOfxActionCreateInstance,
    kOfxActionDestroyInstance,
    kOfxActionInstanceChanged,
    kOfxImageEffectActionDescribeInContext,
    kOfxImageEffectActionGetRegionOfDefinition,
    kOfxImageEffectActionGetRegionsOfInterest,
    kOfxImageEffectActionGetFramesNeeded,
    kOfxImageEffectActionGetClipPreferences,
    kOfxImageEffectActionGetOutputColourspace,
    kOfxImageEffectActionIsIdentity,
    kOfxImageEffectActionRender,
];

fn act_on_effect(
    effect: &'static Effect,
    host: &Host,
    action: &CStr,
    handle: Handle,
    in_args: Handle,
    out_args: Handle,
) -> Outcome {
    match action {
        a if a == kOfxActionDescribe => describe::describe(effect, host, handle),
        a if a == kOfxImageEffectActionDescribeInContext => {
            describe::in_context(effect, host, handle, in_args)
        }
        // Nothing is kept for an instance but its messages.
        a if a == kOfxActionCreateInstance => controls::created(effect, host, handle),
        a if a == kOfxActionDestroyInstance => {
            host.forget(handle);
            Ok(kOfxStatOK)
        }
        a if a == kOfxActionInstanceChanged => controls::changed(effect, host, handle, in_args),
        a if a == kOfxImageEffectActionGetRegionOfDefinition => {
            instance::region_of_definition(effect, host, handle, in_args, out_args)
        }
        a if a == kOfxImageEffectActionGetRegionsOfInterest => {
            instance::regions_of_interest(effect, host, handle, in_args, out_args)
        }
        a if a == kOfxImageEffectActionGetFramesNeeded => {
            needed::frames(effect, host, handle, in_args, out_args)
        }
        a if a == kOfxImageEffectActionGetClipPreferences => {
            instance::clip_preferences(effect, host, handle, out_args)
        }
        a if a == kOfxImageEffectActionGetOutputColourspace => instance::output_colourspace(host, out_args),
        a if a == kOfxImageEffectActionIsIdentity => {
            instance::is_identity(effect, host, handle, in_args, out_args)
        }
        _ => render::render(effect, host, handle, in_args),
    }
}

const fn functions<const N: usize>() -> (SetHost, MainEntry) {
    (set_host::<N>, main_entry::<N>)
}

macro_rules! functions_of {
    ($($eighth:literal)*) => {
        [$(
            functions::<{ $eighth * 8 }>(),
            functions::<{ $eighth * 8 + 1 }>(),
            functions::<{ $eighth * 8 + 2 }>(),
            functions::<{ $eighth * 8 + 3 }>(),
            functions::<{ $eighth * 8 + 4 }>(),
            functions::<{ $eighth * 8 + 5 }>(),
            functions::<{ $eighth * 8 + 6 }>(),
            functions::<{ $eighth * 8 + 7 }>(),
        )*]
    };
}

static FUNCTIONS: [(SetHost, MainEntry); MOST] = functions_of!(0 1 2 3 4 5 6 7);

/// The effects as hosts list them.
struct Plugins(Vec<OfxPlugin>);

// SAFETY: the structures are never written, and what they point to is never freed.
unsafe impl Send for Plugins {}
// SAFETY: as above.
unsafe impl Sync for Plugins {}

static PLUGINS: LazyLock<Plugins> = LazyLock::new(|| {
    let plugin = |(effect, (set_host, main_entry)): (&'static Effect, &(SetHost, MainEntry))| OfxPlugin {
        pluginApi: kOfxImageEffectPluginApi.as_ptr(),
        apiVersion: kOfxImageEffectPluginApiVersion,
        pluginIdentifier: effect.identifier.as_ptr(),
        // The first number changes only when saved projects would break.
        pluginVersionMajor: 1,
        pluginVersionMinor: 0,
        setHost: Some(*set_host),
        mainEntry: Some(*main_entry),
    };
    Plugins(EFFECTS.iter().zip(&FUNCTIONS).map(plugin).collect())
});

/// [any thread] The number of image effects.
// SAFETY: the standard claims the name for this function.
#[unsafe(no_mangle)]
pub extern "C" fn OfxGetNumberOfPlugins() -> c_int {
    crate::pinned::pin();
    crate::reserve::keep();
    catch_unwind(|| PLUGINS.0.len() as c_int).unwrap_or(0)
}

/// [any thread] The image effect at a position, or null. It is valid for the life of the process.
// SAFETY: the standard claims the name for this function.
#[unsafe(no_mangle)]
pub extern "C" fn OfxGetPlugin(nth: c_int) -> *const OfxPlugin {
    crate::pinned::pin();
    crate::reserve::keep();
    let find = || usize::try_from(nth).ok().and_then(|n| PLUGINS.0.get(n)).map_or(null(), |p| &raw const *p);
    catch_unwind(find).unwrap_or(null())
}

/// [any thread] The host, before it asks for effects. Few hosts call it, and each effect gets the host again.
// SAFETY: the standard claims the name for this function.
#[unsafe(no_mangle)]
pub extern "C" fn OfxSetHost(_host: *const OfxHost) -> OfxStatus {
    kOfxStatOK
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_functions_for_every_effect() {
        assert_eq!(OfxGetNumberOfPlugins() as usize, EFFECTS.len());
        assert!(OfxGetPlugin(-1).is_null() && OfxGetPlugin(OfxGetNumberOfPlugins()).is_null());
    }

    #[test]
    fn a_panic_becomes_a_status() {
        assert_eq!(guarded(|| panic!("broken")), kOfxStatFailed);
    }
}
