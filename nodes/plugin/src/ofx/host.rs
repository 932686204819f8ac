//! The host: its suites, fetched once, and its property sets, read with care.
//!
//! Hosts leave functions out, refuse properties and free strings early. Everything here answers with
//! `None` then, or does nothing.

use super::before::Before;
use super::quirks::Quirks;
use crate::abi::guard::lock;
use isophote_abi::openfx::*;
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr::{null, null_mut};
use std::sync::atomic::{AtomicPtr, Ordering};
use std::sync::{Mutex, OnceLock};

/// Status of a failed action, as the host gets it.
pub type Failure = OfxStatus;
/// Result of an action.
pub type Outcome<T = OfxStatus> = Result<T, Failure>;

/// The host's functions, copied, and what is known of it.
#[derive(Debug)]
pub struct Host {
    pub effects: OfxImageEffectSuiteV1,
    pub properties: OfxPropertySuiteV1,
    pub parameters: OfxParameterSuiteV1,
    pub threads: Option<OfxMultiThreadSuiteV1>,
    /// Address that suites are asked of, and the function for it.
    origin: AtomicPtr<c_void>,
    fetch: FetchSuite,
    /// Fetched when there is a message to show: not every host takes the question well.
    messages: OnceLock<Option<OfxMessageSuiteV2>>,
    /// Messages that instances show, by their addresses.
    showing: Mutex<BTreeMap<usize, Shown>>,
    /// Addresses of the instances that have been given their notice.
    noticed: Mutex<BTreeSet<usize>>,
    /// Addresses of the instances whose values the effect itself sets.
    edited: Mutex<BTreeSet<usize>>,
    /// Values of before the looks of instances, by their addresses.
    before: Mutex<BTreeMap<usize, Before>>,
    pub quirks: Quirks,
    /// True where images may hold only a part of the picture.
    pub tiles: bool,
    /// True where clips give the images of any time.
    pub temporal: bool,
    /// True where nobody looks at controls.
    pub background: bool,
    /// True where half floats may be offered.
    pub half: bool,
}

impl Host {
    /// Fetches the suites.
    ///
    /// # Errors
    /// Missing host feature, without one of the three that every host has.
    ///
    /// # Safety
    /// `host` is null or points to the host's structure.
    pub unsafe fn fetch(host: *const OfxHost) -> Outcome<Self> {
        // SAFETY: as the caller promised.
        let host = unsafe { host.as_ref() }.ok_or(kOfxStatErrMissingHostFeature)?;
        let fetch = host.fetchSuite.ok_or(kOfxStatErrMissingHostFeature)?;
        // SAFETY: the standard gives the function this type, and says which structure each name stands
        // for; the structures are copied, so that it does not matter how long they live.
        let mut found = unsafe {
            let suite = |name: &CStr, version| fetch(host.host, name.as_ptr(), version);
            Self {
                effects: *suite(kOfxImageEffectSuite, 1)
                    .cast::<OfxImageEffectSuiteV1>()
                    .as_ref()
                    .ok_or(kOfxStatErrMissingHostFeature)?,
                properties: *suite(kOfxPropertySuite, 1)
                    .cast::<OfxPropertySuiteV1>()
                    .as_ref()
                    .ok_or(kOfxStatErrMissingHostFeature)?,
                parameters: *suite(kOfxParameterSuite, 1)
                    .cast::<OfxParameterSuiteV1>()
                    .as_ref()
                    .ok_or(kOfxStatErrMissingHostFeature)?,
                threads: suite(kOfxMultiThreadSuite, 1).cast::<OfxMultiThreadSuiteV1>().as_ref().copied(),
                origin: AtomicPtr::new(host.host),
                fetch,
                messages: OnceLock::new(),
                showing: Mutex::default(),
                noticed: Mutex::default(),
                edited: Mutex::default(),
                before: Mutex::default(),
                quirks: Quirks::default(),
                tiles: true,
                temporal: false,
                background: false,
                half: false,
            }
        };
        let about = found.set(host.host);
        let quirks = Quirks::of(&about.string(kOfxPropName, 0).unwrap_or_default());
        let tiles = about.int(kOfxImageEffectPropSupportsTiles, 0) != Some(0);
        // The standard has every host say so; one that does not is asked for nothing that it may not have.
        let temporal = about.int(kOfxImageEffectPropTemporalClipAccess, 0) == Some(1);
        let background = about.int(kOfxImageEffectHostPropIsBackground, 0) == Some(1);
        let half = (0..8).any(|i| {
            about.string(kOfxImageEffectPropSupportedPixelDepths, i).as_deref() == Some(kOfxBitDepthHalf)
        });
        (found.quirks, found.tiles, found.half) = (quirks, tiles, half);
        (found.temporal, found.background) = (temporal, background);
        Ok(found)
    }

    /// A property set of this host.
    pub fn set(&self, handle: Handle) -> Properties<'_> {
        Properties { host: self, handle }
    }

    /// The properties of an effect, descriptor or instance.
    pub fn effect(&self, handle: Handle) -> Properties<'_> {
        let mut set = null_mut();
        if let Some(get) = self.effects.getPropertySet {
            // SAFETY: a handle that the host gave, and a place for the answer.
            let status = unsafe { get(handle, &raw mut set) };
            if status != kOfxStatOK {
                set = null_mut();
            }
        }
        self.set(set)
    }

    /// The parameters of an effect.
    ///
    /// # Errors
    /// Failed, when the host has none.
    pub fn params(&self, effect: Handle) -> Outcome<Handle> {
        let get = self.effects.getParamSet.ok_or(kOfxStatErrMissingHostFeature)?;
        let mut set = null_mut();
        // SAFETY: a handle that the host gave, and a place for the answer.
        let status = unsafe { get(effect, &raw mut set) };
        if status == kOfxStatOK && !set.is_null() { Ok(set) } else { Err(kOfxStatFailed) }
    }

    /// True when the user no longer wants the frame.
    pub fn aborted(&self, effect: Handle) -> bool {
        // SAFETY: a handle that the host gave; any thread may ask.
        self.effects.abort.is_some_and(|abort| unsafe { abort(effect) } != 0)
    }

    /// Shows a failure on the effect, where that is known to be safe: once, until it renders again.
    pub fn show_failure(&self, effect: Handle, message: &str) {
        let Some(messages) = self.messages() else { return };
        let Some(show) = messages.setPersistentMessage.or(messages.message) else { return };
        if lock(&self.showing).insert(effect.addr(), Shown::Failure) != Some(Shown::Failure) {
            say(show, effect, kOfxMessageError, message);
        }
    }

    /// Tells the user something about an effect that renders all the same, where that is known to be safe: once in the
    /// life of an instance. It stays until it is withdrawn. `aloud`: also in hosts that stop people to tell them.
    pub fn give_notice(&self, effect: Handle, message: &str, aloud: bool) {
        let Some(messages) = self.messages() else { return };
        let aside = messages.setPersistentMessage.map(|show| (show, kOfxMessageWarning));
        let spoken = messages.message.filter(|_| aloud).map(|show| (show, kOfxMessageMessage));
        let Some((show, kind)) = aside.or(spoken) else { return };
        if lock(&self.noticed).insert(effect.addr()) {
            if aside.is_some() {
                lock(&self.showing).insert(effect.addr(), Shown::Notice);
            }
            say(show, effect, kind, message);
        }
    }

    /// The message suite, as far as the host has one that is known to be safe.
    fn messages(&self) -> Option<OfxMessageSuiteV2> {
        if !self.quirks.messages {
            return None;
        }
        *self.messages.get_or_init(|| {
            let origin = self.origin.load(Ordering::Relaxed);
            // SAFETY: as in `fetch`: the host and its function are constant until the library is unloaded.
            unsafe {
                let suite = |version| (self.fetch)(origin, kOfxMessageSuite.as_ptr(), version);
                if let Some(second) = suite(2).cast::<OfxMessageSuiteV2>().as_ref() {
                    return Some(*second);
                }
                let message = suite(1).cast::<OfxMessageSuiteV1>().as_ref()?.message;
                Some(OfxMessageSuiteV2 { message, setPersistentMessage: None, clearPersistentMessage: None })
            }
        })
    }

    /// Tells the user that the graphics card does not compute an effect, until it does: where messages stay on the effect and
    /// stop nobody, and not again while it is shown.
    pub fn warn_of_card(&self, effect: Handle, message: &str) {
        self.warn(effect, Shown::Card, message);
    }

    /// Tells the user, in the same way, of rules for things that a look does not follow.
    pub fn warn_of_rules(&self, effect: Handle, message: &str) {
        self.warn(effect, Shown::Rules, message);
    }

    fn warn(&self, effect: Handle, what: Shown, message: &str) {
        let Some(show) = self.messages().and_then(|messages| messages.setPersistentMessage) else { return };
        if lock(&self.showing).insert(effect.addr(), what) != Some(what) {
            say(show, effect, kOfxMessageWarning, message);
        }
    }

    /// Takes the message about rules for things back, if the effect shows it.
    pub fn rules_are_followed(&self, effect: Handle) {
        self.clear(effect, &[Shown::Rules]);
    }

    /// Takes the message about the graphics card back, if the effect shows it.
    pub fn card_computes(&self, effect: Handle) {
        self.clear(effect, &[Shown::Card]);
    }

    /// Takes a failure back, if the effect shows one.
    pub fn clear_failure(&self, effect: Handle) {
        self.clear(effect, &[Shown::Failure]);
    }

    /// Takes the notice of an effect back, if it shows it.
    pub fn withdraw_notice(&self, effect: Handle) {
        self.clear(effect, &[Shown::Notice]);
    }

    /// Forgets an instance that ends, and clears what it shows.
    pub fn forget(&self, effect: Handle) {
        lock(&self.noticed).remove(&effect.addr());
        lock(&self.before).remove(&effect.addr());
        self.clear(effect, &[Shown::Failure, Shown::Notice, Shown::Card, Shown::Rules]);
    }

    /// Sets values of an instance. What the host tells of them meanwhile is no news.
    pub fn editing(&self, effect: Handle, set: impl FnOnce()) {
        lock(&self.edited).insert(effect.addr());
        set();
        lock(&self.edited).remove(&effect.addr());
    }

    /// True while the effect itself sets values of an instance.
    pub fn is_editing(&self, effect: Handle) -> bool {
        lock(&self.edited).contains(&effect.addr())
    }

    /// Values that an instance had before its look, where they are kept.
    pub fn before(&self, effect: Handle) -> Option<Before> {
        lock(&self.before).get(&effect.addr()).cloned()
    }

    /// Keeps values of before a look, or none.
    pub fn keep_before(&self, effect: Handle, before: Option<Before>) {
        let mut kept = lock(&self.before);
        match before {
            Some(before) => kept.insert(effect.addr(), before),
            None => kept.remove(&effect.addr()),
        };
    }

    fn clear(&self, effect: Handle, what: &[Shown]) {
        let mut showing = lock(&self.showing);
        if !showing.get(&effect.addr()).is_some_and(|shown| what.contains(shown)) {
            return;
        }
        showing.remove(&effect.addr());
        drop(showing);
        if let Some(clear) = self.messages().and_then(|m| m.clearPersistentMessage) {
            // SAFETY: an effect that the host gave, on which a message was set.
            unsafe { clear(effect) };
        }
    }
}

/// Kind of message that an instance shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shown {
    /// That it did not render.
    Failure,
    /// That the CPU computes it in place of the graphics card.
    Card,
    /// That it leaves rules for things out.
    Rules,
    /// Anything else.
    Notice,
}

type Show = unsafe extern "C" fn(*mut c_void, *const c_char, *const c_char, *const c_char, ...) -> OfxStatus;

/// Hands a text to a function of the message suite.
fn say(show: Show, effect: Handle, kind: &CStr, message: &str) {
    // The text is the format, since Natron loses the arguments of one that has any.
    let text = CString::new(message.replace('\0', " ").replace('%', "%%")).unwrap_or_default();
    // SAFETY: strings with a closing zero that live during the call; the format asks for no arguments.
    unsafe { show(effect, kind.as_ptr(), null(), text.as_ptr()) };
}

/// A property set.
#[derive(Clone, Copy, Debug)]
pub struct Properties<'h> {
    host: &'h Host,
    handle: Handle,
}

impl Properties<'_> {
    /// True when there is no set behind it.
    pub fn is_null(&self) -> bool {
        self.handle.is_null()
    }

    /// A number, when the host has it.
    pub fn int(&self, name: &CStr, index: c_int) -> Option<c_int> {
        let get = self.host.properties.propGetInt.filter(|_| !self.handle.is_null())?;
        let mut value = 0;
        // SAFETY: a set that the host gave, a string with a closing zero, and a place for the answer.
        let status = unsafe { get(self.handle, name.as_ptr(), index, &raw mut value) };
        (status == kOfxStatOK).then_some(value)
    }

    /// A number, when the host has it and it is one.
    pub fn double(&self, name: &CStr, index: c_int) -> Option<f64> {
        let get = self.host.properties.propGetDouble.filter(|_| !self.handle.is_null())?;
        let mut value = 0.0;
        // SAFETY: as in `int`.
        let status = unsafe { get(self.handle, name.as_ptr(), index, &raw mut value) };
        (status == kOfxStatOK && !value.is_nan()).then_some(value)
    }

    /// A copy of a text, when the host has it.
    pub fn string(&self, name: &CStr, index: c_int) -> Option<CString> {
        let get = self.host.properties.propGetString.filter(|_| !self.handle.is_null())?;
        let mut value = null_mut();
        // SAFETY: as in `int`; the text is valid until the next call, and copied before it.
        unsafe {
            let status = get(self.handle, name.as_ptr(), index, &raw mut value);
            (status == kOfxStatOK && !value.is_null()).then(|| CStr::from_ptr(value).to_owned())
        }
    }

    /// A pointer, when the host has it.
    pub fn pointer(&self, name: &CStr) -> Option<*mut u8> {
        let get = self.host.properties.propGetPointer.filter(|_| !self.handle.is_null())?;
        let mut value = null_mut();
        // SAFETY: as in `int`.
        let status = unsafe { get(self.handle, name.as_ptr(), 0, &raw mut value) };
        (status == kOfxStatOK && !value.is_null()).then_some(value.cast())
    }

    /// Four whole numbers, such as bounds.
    pub fn ints<const N: usize>(&self, name: &CStr) -> Option<[c_int; N]> {
        let mut values = [0; N];
        for (index, value) in values.iter_mut().enumerate() {
            *value = self.int(name, index as c_int)?;
        }
        Some(values)
    }

    /// Several numbers, such as a region.
    pub fn doubles<const N: usize>(&self, name: &CStr) -> Option<[f64; N]> {
        let mut values = [0.0; N];
        for (index, value) in values.iter_mut().enumerate() {
            *value = self.double(name, index as c_int)?;
        }
        Some(values)
    }

    /// Sets a number. A host that does not know the property is left alone.
    pub fn set_int(&self, name: &CStr, value: c_int) {
        self.set_int_at(name, 0, value);
    }

    /// Sets one of several numbers.
    pub fn set_int_at(&self, name: &CStr, index: usize, value: c_int) {
        if let Some(set) = self.host.properties.propSetInt.filter(|_| !self.handle.is_null()) {
            // SAFETY: a set that the host gave, and a string with a closing zero.
            unsafe { set(self.handle, name.as_ptr(), index as c_int, value) };
        }
    }

    /// Sets numbers, from the first on; true when the host took them all.
    pub fn set_doubles(&self, name: &CStr, values: &[f64]) -> bool {
        let Some(set) = self.host.properties.propSetDouble.filter(|_| !self.handle.is_null()) else {
            return false;
        };
        // SAFETY: as in `set_int`.
        let one = |(i, v): (usize, &f64)| unsafe { set(self.handle, name.as_ptr(), i as c_int, *v) };
        values.iter().enumerate().map(one).all(|status| status == kOfxStatOK)
    }

    /// Sets a text, which must be one that is never freed; true when the host took it.
    pub fn set_string(&self, name: &CStr, index: usize, value: &'static CStr) -> bool {
        let Some(set) = self.host.properties.propSetString.filter(|_| !self.handle.is_null()) else {
            return false;
        };
        // SAFETY: as in `set_int`, and the value is valid for ever.
        unsafe { set(self.handle, name.as_ptr(), index as c_int, value.as_ptr()) == kOfxStatOK }
    }

    /// Sets a text that the host copies during the call.
    pub fn answer(&self, name: &CStr, value: &CStr) -> bool {
        let Some(set) = self.host.properties.propSetString.filter(|_| !self.handle.is_null()) else {
            return false;
        };
        // SAFETY: as in `set_int`; the standard has hosts copy what they are given.
        unsafe { set(self.handle, name.as_ptr(), 0, value.as_ptr()) == kOfxStatOK }
    }
}
