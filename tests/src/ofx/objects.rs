//! Descriptors and instances of the test host, with their parameters and clips.

use super::handles::handle_of;
use super::picture::Picture;
use super::properties::{Set, Value};
use super::state::{self, Inner, lock};
use isophote_abi::openfx::{
    Handle, MainEntry, kOfxImageEffectPropFrameRange, kOfxImageEffectPropTemporalClipAccess,
};
use std::ffi::{CString, c_char};
use std::sync::{Arc, Mutex};

pub(super) const MAGIC: u64 = 0x0ef_fec7;

/// Values by time.
type Keys = Vec<(f64, Value)>;

/// A parameter, described or with a value.
#[derive(Debug)]
pub struct Param {
    pub(super) magic: u64,
    /// Its type.
    pub kind: CString,
    /// Its name.
    pub name: CString,
    /// Its properties.
    pub set: Box<Set>,
    pub(super) value: Mutex<Vec<Value>>,
    /// Values from a time on, in the order of time; without any, `value` holds at all times.
    pub(super) keys: Mutex<Keys>,
    /// Texts that plugins were given.
    pub(super) lent: Mutex<Vec<CString>>,
    /// Address of its instance; 0 where it is described.
    pub(super) instance: usize,
}

impl Param {
    /// A text of its values, for the life of the parameter.
    pub(super) fn lend(&self, index: usize) -> *const c_char {
        let Some(Value::String(text)) = lock(&self.value).get(index).cloned() else {
            return std::ptr::null();
        };
        let mut lent = lock(&self.lent);
        lent.push(text);
        lent.last().map_or(std::ptr::null(), |text| text.as_ptr())
    }
}

/// A step that can be undone.
#[derive(Clone, Debug, Default)]
pub struct Step {
    /// Its label; none for what was set outside a step.
    pub label: Option<CString>,
    /// Parameters that the plugin set, each with the values and keys of before.
    pub(super) before: Vec<(CString, Vec<Value>, Keys)>,
}

impl Step {
    /// The parameters that were set, in their order.
    pub fn names(&self) -> Vec<String> {
        self.before.iter().map(|(name, ..)| name.to_string_lossy().into_owned()).collect()
    }
}

/// Steps of an instance that its plugin took.
#[derive(Debug, Default)]
pub(super) struct Edits {
    pub(super) done: Vec<Step>,
    pub(super) open: Option<Step>,
}

/// A clip, described or with a picture.
#[derive(Debug)]
pub struct Clip {
    pub(super) magic: u64,
    /// Its name.
    pub name: CString,
    /// Its properties.
    pub set: Box<Set>,
    /// Picture that it shows at all times, unless it has a film.
    pub(super) picture: Mutex<Option<Picture>>,
    /// Pictures that it shows, by time.
    pub(super) film: Mutex<Vec<(f64, Picture)>>,
}

impl Clip {
    /// Looks at what it shows at a time.
    pub(super) fn at<T>(&self, time: f64, look: impl FnOnce(&mut Picture) -> T) -> Option<T> {
        let (mut still, mut film) = (lock(&self.picture), lock(&self.film));
        let shown = film.iter_mut().find(|(at, _)| *at == time).map(|(_, picture)| picture);
        still.as_mut().or(shown).map(look)
    }

    /// Notes a plugin that wants the images of times which it has not announced, or which it has been told that there are
    /// not.
    pub(super) fn check_access(&self, time: f64) {
        let host = &self.set.host;
        let Some(now) = state::rendered() else {
            return host.fault(format!("{:?} is asked for an image outside a render", self.name));
        };
        if now == time {
            return;
        }
        if !host.behaviour.temporal || self.set.int(kOfxImageEffectPropTemporalClipAccess) != Some(1) {
            host.fault(format!("{:?} has no access to other times", self.name));
        }
        let hidden = host.behaviour.bare || host.behaviour.refused.contains(&kOfxImageEffectPropFrameRange);
        let range = self.set.numbers(kOfxImageEffectPropFrameRange);
        if !hidden && !matches!(range[..], [first, last] if first <= time && time <= last) {
            host.fault(format!("{:?} has no frame {time}", self.name));
        }
    }
}

/// A descriptor or an instance; its address is its handle.
#[derive(Debug)]
pub struct Effect {
    pub(super) magic: u64,
    /// The host.
    pub host: Arc<Inner>,
    /// True where it may be rendered.
    pub is_instance: bool,
    /// Its properties.
    pub set: Box<Set>,
    pub(super) param_set: Box<Set>,
    #[expect(clippy::vec_box, reason = "plugins hold their addresses as handles")]
    pub(super) params: Mutex<Vec<Box<Param>>>,
    #[expect(clippy::vec_box, reason = "plugins hold their addresses as handles")]
    pub(super) clips: Mutex<Vec<Box<Clip>>>,
    /// Function that is told of what the plugin sets.
    pub(super) entry: Mutex<Option<MainEntry>>,
    pub(super) edits: Mutex<Edits>,
}

impl Effect {
    pub(super) fn new(host: &Arc<Inner>, is_instance: bool) -> Box<Self> {
        let what = if is_instance { "instance" } else { "descriptor" };
        let mut effect = Box::new(Self {
            magic: MAGIC,
            host: Arc::clone(host),
            is_instance,
            set: Set::new(host, what),
            param_set: Set::new(host, what),
            params: Mutex::default(),
            clips: Mutex::default(),
            entry: Mutex::default(),
            edits: Mutex::default(),
        });
        let owner = handle_of(&*effect) as usize;
        effect.param_set = Set::owned_by(host, what, owner);
        effect
    }

    /// Handle that plugins are given.
    pub fn handle(&self) -> Handle {
        handle_of(self)
    }

    /// Looks at the parameters, in the order of their definition.
    pub fn each_param(&self, mut look: impl FnMut(&Param)) {
        lock(&self.params).iter().for_each(|param| look(param));
    }

    /// Names of the clips, in the order of their definition.
    pub fn clip_names(&self) -> Vec<String> {
        lock(&self.clips).iter().map(|c| c.name.to_string_lossy().into_owned()).collect()
    }
}

/// The descriptor or instance behind a handle of this host's, or of nothing.
pub(super) fn effect<'a>(handle: Handle) -> Option<&'a Effect> {
    // SAFETY: handles lead to things of a host that live while plugins may use them, or to null.
    let found = unsafe { handle.cast::<Effect>().as_ref() };
    found.filter(|effect| effect.magic == MAGIC)
}
