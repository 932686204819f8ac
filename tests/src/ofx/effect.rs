//! Driver of a plugin's effects in tests: described, instantiated, rendered.

use super::handles::handle_of;
use super::host::Host;
use super::objects::{Clip, Effect, MAGIC, Param, Step};
use super::picture::{Layout, Picture};
use super::plugin::Plugin;
use super::properties::{Set, Value};
use super::state::{self, lock};
use isophote_abi::openfx::*;
use std::ffi::{CStr, CString};
use std::sync::Mutex;
use std::sync::atomic::Ordering;

/// A plugin's effect, loaded and described.
#[derive(Debug)]
pub struct Described<'h> {
    /// The host.
    pub host: &'h Host,
    /// The plugin.
    pub plugin: Plugin,
    /// Descriptor that it filled in.
    pub descriptor: Box<Effect>,
}

impl<'h> Described<'h> {
    /// Loads and describes.
    ///
    /// # Panics
    /// When an action does not return OK.
    pub fn new(host: &'h Host, plugin: Plugin) -> Self {
        match Self::attempt(host, plugin) {
            Ok(described) => described,
            Err((action, status)) => panic!("{} of {}: {status}", action, plugin.identifier()),
        }
    }

    /// Loads and describes, if the plugin will.
    ///
    /// # Errors
    /// The action that failed, and its status.
    pub fn attempt(host: &'h Host, plugin: Plugin) -> Result<Self, (&'static str, OfxStatus)> {
        plugin.set_host(host);
        let status = plugin.act(kOfxActionLoad, std::ptr::null_mut(), None, None);
        if status != kOfxStatOK {
            return Err(("Load", status));
        }
        let descriptor = Effect::new(&host.inner, false);
        let status = plugin.act(kOfxActionDescribe, descriptor.handle(), None, None);
        if status != kOfxStatOK {
            return Err(("Describe", status));
        }
        Ok(Self { host, plugin, descriptor })
    }

    /// Description that the plugin gives of the effect in a context.
    ///
    /// # Panics
    /// When it does not return OK.
    pub fn in_context(&self, context: &CStr) -> Box<Effect> {
        let effect = Effect::new(&self.host.inner, false);
        let args = Set::new(&self.host.inner, "arguments");
        args.put(kOfxImageEffectPropContext, vec![context.into()]);
        let status =
            self.plugin.act(kOfxImageEffectActionDescribeInContext, effect.handle(), Some(&args), None);
        assert_eq!(status, kOfxStatOK, "DescribeInContext of {}", self.plugin.identifier());
        effect
    }

    /// An instance with default values, but with lengths in pixels: those of pictures as small as in tests come to nothing
    /// where they are meant at 1080 lines.
    ///
    /// # Panics
    /// When it cannot be created.
    pub fn instance(&self, context: &CStr) -> Instance<'h> {
        self.saved_instance(context, &[])
    }

    /// An instance as a project saved it: with values that it has before it is created, by their names; lengths are in
    /// pixels as in [`Described::instance`].
    ///
    /// # Panics
    /// When it cannot be created.
    pub fn saved_instance(&self, context: &CStr, saved: &[(&str, Value)]) -> Instance<'h> {
        let described = self.in_context(context);
        let in_pixels = [("reference_height", Value::from(0))];
        let effect = Effect::new(&self.host.inner, true);
        effect.set.put(kOfxImageEffectPropContext, vec![context.into()]);
        for param in lock(&described.params).iter() {
            let saved =
                saved.iter().chain(&in_pixels).find(|(name, _)| *name == param.name.to_string_lossy());
            let value = saved.map_or_else(|| param.set.get(kOfxParamPropDefault), |(_, v)| vec![v.clone()]);
            let mut new = Box::new(Param {
                magic: MAGIC,
                kind: param.kind.clone(),
                name: param.name.clone(),
                set: Set::new(&self.host.inner, "parameter"),
                value: Mutex::new(value),
                keys: Mutex::default(),
                lent: Mutex::default(),
                instance: handle_of(&*effect) as usize,
            });
            new.set = param.set.copy("parameter", handle_of(&*new) as usize);
            lock(&effect.params).push(new);
        }
        for clip in lock(&described.clips).iter() {
            let mut new = Box::new(Clip {
                magic: MAGIC,
                name: clip.name.clone(),
                set: Set::new(&self.host.inner, "clip"),
                picture: Mutex::default(),
                film: Mutex::default(),
            });
            new.set = clip.set.copy("clip", handle_of(&*new) as usize);
            let connected = i32::from(self.host.inner.behaviour.all_connected);
            new.set.put(kOfxImageClipPropConnected, vec![connected.into()]);
            lock(&effect.clips).push(new);
        }
        *lock(&effect.entry) = self.plugin.raw().mainEntry;
        let status = self.plugin.act(kOfxActionCreateInstance, effect.handle(), None, None);
        assert_eq!(status, kOfxStatOK, "CreateInstance of {}", self.plugin.identifier());
        Instance { host: self.host, plugin: self.plugin, effect }
    }
}

/// An instance, destroyed when it is dropped.
#[derive(Debug)]
pub struct Instance<'h> {
    host: &'h Host,
    /// Its plugin.
    pub plugin: Plugin,
    /// The host's side of it.
    pub effect: Box<Effect>,
}

// SAFETY: everything in an instance that changes is behind locks.
unsafe impl Sync for Instance<'_> {}
// SAFETY: as above.
unsafe impl Send for Instance<'_> {}

impl Drop for Instance<'_> {
    fn drop(&mut self) {
        let status = self.plugin.act(kOfxActionDestroyInstance, self.effect.handle(), None, None);
        if status != kOfxStatOK {
            self.host.inner.fault(format!("DestroyInstance: {status}"));
        }
    }
}

/// Render that a host wants.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// Pixels, y up.
    pub window: [i32; 4],
    /// Pixels per canonical unit.
    pub scale: f64,
    /// That of x over that of y.
    pub squeeze: f64,
    /// Fields.
    pub field: &'static CStr,
    /// Time.
    pub time: f64,
    /// True for a draft.
    pub draft: bool,
}

impl Wanted {
    /// A window at full size.
    pub fn new(window: [i32; 4]) -> Self {
        Self { window, scale: 1.0, squeeze: 1.0, field: kOfxImageFieldNone, time: 0.0, draft: false }
    }
}

impl Instance<'_> {
    /// Calls an action.
    pub fn act(&self, action: &CStr, in_args: Option<&Set>, out_args: Option<&Set>) -> OfxStatus {
        self.plugin.act(action, self.effect.handle(), in_args, out_args)
    }

    /// Arguments of an action.
    pub fn args(&self) -> Box<Set> {
        Set::new(&self.host.inner, "arguments")
    }

    /// Sets a parameter.
    ///
    /// # Panics
    /// When there is none of this name.
    pub fn set(&self, name: &str, value: impl Into<Value>) {
        self.with(name, |param| *lock(&param.value) = vec![value.into()]);
    }

    /// Animates a parameter: the values that it has from a time on, in the order of time.
    ///
    /// # Panics
    /// When there is none of this name.
    pub fn animate(&self, name: &str, keys: Vec<(f64, Value)>) {
        self.with(name, |param| *lock(&param.keys) = keys);
    }

    /// True where the control of a parameter can be used, and is not grey.
    ///
    /// # Panics
    /// When there is none of this name.
    pub fn is_enabled(&self, name: &str) -> bool {
        self.with(name, |param| param.set.int(kOfxParamPropEnabled) != Some(0))
    }

    fn with<T>(&self, name: &str, act: impl FnOnce(&Param) -> T) -> T {
        let params = lock(&self.effect.params);
        let param = params.iter().find(|p| p.name.to_string_lossy() == name);
        act(param.unwrap_or_else(|| panic!("{} has no {name}", self.plugin.identifier())))
    }

    /// Tells the plugin that something changed: of which type, and why.
    ///
    /// # Panics
    /// When the plugin does not take it.
    pub fn changed(&self, what: &CStr, reason: &CStr, time: f64) {
        let args = self.args();
        args.put(kOfxPropType, vec![what.into()]);
        args.put(kOfxPropChangeReason, vec![reason.into()]);
        args.put(kOfxPropTime, vec![time.into()]);
        args.put(kOfxImageEffectPropRenderScale, vec![1.0.into(); 2]);
        let status = self.act(kOfxActionInstanceChanged, Some(&args), None);
        assert_eq!(status, kOfxStatOK, "InstanceChanged of {}", self.plugin.identifier());
    }

    /// Sets a parameter as the user does, and tells the plugin.
    ///
    /// # Panics
    /// When there is none of this name, or the plugin does not take it.
    pub fn edit(&self, name: &str, value: impl Into<Value>) {
        self.set(name, value);
        self.touch(name);
    }

    /// Tells the plugin that the user edited a parameter, or pressed a button.
    ///
    /// # Panics
    /// When the plugin does not take it, or leaves a step open.
    pub fn touch(&self, name: &str) {
        let args = self.args();
        let name = CString::new(name).expect("a name");
        args.put(kOfxPropName, vec![name.as_c_str().into()]);
        args.put(kOfxPropType, vec![kOfxTypeParameter.into()]);
        args.put(kOfxPropChangeReason, vec![kOfxChangeUserEdited.into()]);
        args.put(kOfxPropTime, vec![0.0.into()]);
        args.put(kOfxImageEffectPropRenderScale, vec![1.0.into(); 2]);
        let status = self.act(kOfxActionInstanceChanged, Some(&args), None);
        assert_eq!(status, kOfxStatOK, "InstanceChanged of {}", self.plugin.identifier());
        assert!(lock(&self.effect.edits).open.is_none(), "a step without an end");
    }

    /// Values of a parameter.
    ///
    /// # Panics
    /// When there is none of this name.
    pub fn get(&self, name: &str) -> Vec<Value> {
        self.with(name, |param| lock(&param.value).clone())
    }

    /// True where a parameter has keyframes.
    ///
    /// # Panics
    /// When there is none of this name.
    pub fn has_keys(&self, name: &str) -> bool {
        self.with(name, |param| !lock(&param.keys).is_empty())
    }

    /// Steps that the plugin took since this was asked last.
    pub fn steps(&self) -> Vec<Step> {
        std::mem::take(&mut lock(&self.effect.edits).done)
    }

    /// Undoes a step.
    ///
    /// # Panics
    /// When it is of another instance.
    pub fn undo(&self, step: &Step) {
        for (name, values, keys) in step.before.iter().rev() {
            self.with(&name.to_string_lossy(), |param| {
                lock(&param.value).clone_from(values);
                lock(&param.keys).clone_from(keys);
            });
        }
    }

    /// Sets a property of the clip of this name.
    ///
    /// # Panics
    /// When there is no such clip.
    pub fn put(&self, name: &str, property: &CStr, value: impl Into<Value>) {
        let clips = lock(&self.effect.clips);
        let clip = clips.iter().find(|c| c.name.to_string_lossy() == name).expect("a clip of this name");
        clip.set.put(property, vec![value.into()]);
    }

    /// True where there is a parameter of this name.
    pub fn has(&self, name: &str) -> bool {
        lock(&self.effect.params).iter().any(|p| p.name.to_string_lossy() == name)
    }

    /// Connects a picture to a clip, which has no other frame.
    ///
    /// # Panics
    /// When there is no clip of this name.
    pub fn connect(&self, name: &str, picture: Picture) {
        self.show(name, picture.layout, [0.0; 2], |clip| {
            lock(&clip.film).clear();
            *lock(&clip.picture) = Some(picture);
        });
    }

    /// Connects frames to a clip: those of whole numbers from `first` on.
    ///
    /// # Panics
    /// When there is no clip of this name, or no frame.
    pub fn connect_film(&self, name: &str, first: i32, frames: Vec<Picture>) {
        let (first, layout) = (f64::from(first), frames.first().expect("a frame").layout);
        let last = first + frames.len() as f64 - 1.0;
        self.show(name, layout, [first, last], |clip| {
            *lock(&clip.picture) = None;
            *lock(&clip.film) = (0..).map(|n| first + f64::from(n)).zip(frames).collect();
        });
    }

    fn show(&self, name: &str, layout: Layout, range: [f64; 2], connect: impl FnOnce(&Clip)) {
        let clips = lock(&self.effect.clips);
        let clip = clips.iter().find(|c| c.name.to_string_lossy() == name).expect("a clip of this name");
        clip.set.put(kOfxImageClipPropConnected, vec![1.into()]);
        clip.set.put(kOfxImagePropPixelAspectRatio, vec![layout.aspect.into()]);
        clip.set.put(kOfxImageEffectPropFrameRange, range.map(Value::from).to_vec());
        clip.set.put(kOfxImageEffectPropPixelDepth, vec![layout.depth.into()]);
        clip.set.put(kOfxImageEffectPropComponents, vec![layout.components.into()]);
        if let Some(alpha) = layout.alpha {
            clip.set.put(kOfxImageEffectPropPreMultiplication, vec![alpha.into()]);
        }
        connect(clip);
    }

    /// Disconnects a clip.
    ///
    /// # Panics
    /// When there is no clip of this name.
    pub fn disconnect(&self, name: &str) {
        self.show(name, Layout::default(), [0.0; 2], |clip| {
            lock(&clip.film).clear();
            *lock(&clip.picture) = None;
            let connected = i32::from(self.host.inner.behaviour.all_connected);
            clip.set.put(kOfxImageClipPropConnected, vec![connected.into()]);
        });
    }

    /// Renders into a new picture of `layout` and `size` and returns it with the status.
    ///
    /// # Panics
    /// When the plugin touches what is not its own.
    pub fn try_render(&self, layout: Layout, size: [i32; 2], wanted: &Wanted) -> (OfxStatus, Picture) {
        self.connect("Output", Picture::new(layout, size[0], size[1]));
        let status = self.render_connected(wanted);
        let picture = self.take_output();
        assert_eq!(picture.touched_outside(wanted.window), 0, "{}", self.plugin.identifier());
        (status, picture)
    }

    /// Takes the picture away that is connected to the output.
    ///
    /// # Panics
    /// When there is none.
    pub fn take_output(&self) -> Picture {
        let clips = lock(&self.effect.clips);
        let clip = clips.iter().find(|c| c.name.as_c_str() == c"Output").expect("an output");
        lock(&clip.picture).take().expect("the picture that was connected")
    }

    /// Renders into what is connected.
    ///
    /// # Panics
    /// When the plugin keeps an image.
    pub fn render_connected(&self, wanted: &Wanted) -> OfxStatus {
        let args = self.args();
        args.put(kOfxPropTime, vec![wanted.time.into()]);
        args.put(kOfxImageEffectPropRenderWindow, wanted.window.map(Value::from).to_vec());
        args.put(
            kOfxImageEffectPropRenderScale,
            vec![(wanted.scale * wanted.squeeze).into(), wanted.scale.into()],
        );
        args.put(kOfxImageEffectPropFieldToRender, vec![wanted.field.into()]);
        args.put(kOfxImageEffectPropRenderQualityDraft, vec![i32::from(wanted.draft).into()]);
        self.hold_stills(wanted.time);
        state::render_at(Some(wanted.time));
        let status = self.act(kOfxImageEffectActionRender, Some(&args), None);
        state::render_at(None);
        let lent = self.host.inner.lent.load(Ordering::SeqCst);
        // Other threads may hold images of theirs.
        assert!(lent >= 0, "{lent} images were given back too often");
        status
    }

    /// Stills have no frame but the one that is rendered.
    fn hold_stills(&self, time: f64) {
        for clip in lock(&self.effect.clips).iter().filter(|clip| lock(&clip.picture).is_some()) {
            clip.set.put(kOfxImageEffectPropFrameRange, vec![time.into(); 2]);
        }
    }

    /// Renders a whole picture of `layout` at full size.
    ///
    /// # Panics
    /// When it fails.
    pub fn render(&self, layout: Layout, size: [i32; 2]) -> Picture {
        let [x, y] = layout.origin;
        let wanted = Wanted::new([x, y, x + size[0], y + size[1]]);
        let (status, picture) = self.try_render(layout, size, &wanted);
        assert_eq!(status, kOfxStatOK, "{} cannot be rendered", self.plugin.identifier());
        picture
    }

    /// Asks which frames of each clip a frame needs, first and last by the clip's name; nothing for the default.
    ///
    /// # Panics
    /// When the plugin fails.
    pub fn frames_needed(&self, time: f64) -> Vec<(String, Vec<f64>)> {
        let (args, answer) = (self.args(), self.args());
        args.put(kOfxPropTime, vec![time.into()]);
        let property = |name: &str| CString::new(format!("{FRAME_RANGE_PREFIX}{name}")).expect("a name");
        let clips = self.effect.clip_names();
        let inputs = || clips.iter().filter(|name| *name != "Output");
        inputs().for_each(|name| answer.put(&property(name), vec![time.into(); 2]));
        let status = self.act(kOfxImageEffectActionGetFramesNeeded, Some(&args), Some(&answer));
        match status {
            s if s == kOfxStatOK => {
                inputs().map(|name| (name.clone(), answer.numbers(&property(name)))).collect()
            }
            s if s == kOfxStatReplyDefault => Vec::new(),
            other => panic!("GetFramesNeeded: {other}"),
        }
    }

    /// Asks what a canonical region needs of each clip, by the clip's name; `None` for the default.
    pub fn regions(&self, region: [f64; 4], scale: f64) -> Option<Box<Set>> {
        self.regions_at(0.0, region, scale)
    }

    /// The same at a time.
    pub fn regions_at(&self, time: f64, region: [f64; 4], scale: f64) -> Option<Box<Set>> {
        let (args, answer) = (self.args(), self.args());
        args.put(kOfxPropTime, vec![time.into()]);
        args.put(kOfxImageEffectPropRenderScale, vec![scale.into(); 2]);
        args.put(kOfxImageEffectPropRegionOfInterest, region.map(Value::from).to_vec());
        let status = self.act(kOfxImageEffectActionGetRegionsOfInterest, Some(&args), Some(&answer));
        match status {
            s if s == kOfxStatOK => Some(answer),
            s if s == kOfxStatReplyDefault => None,
            other => panic!("GetRegionsOfInterest: {other}"),
        }
    }

    /// True where the effect says that it changes nothing.
    ///
    /// # Panics
    /// When it names another clip than the source.
    pub fn is_identity(&self) -> bool {
        let (args, answer) = (self.args(), self.args());
        args.put(kOfxPropTime, vec![3.0.into()]);
        args.put(kOfxImageEffectPropRenderScale, vec![1.0.into(); 2]);
        let status = self.act(kOfxImageEffectActionIsIdentity, Some(&args), Some(&answer));
        if status == kOfxStatOK {
            assert_eq!(answer.text(kOfxPropName).as_deref(), Some("Source"));
            assert_eq!(answer.numbers(kOfxPropTime), [3.0]);
        }
        status == kOfxStatOK
    }
}
