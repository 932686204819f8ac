//! Describing an effect to a host: properties, clips and parameters, all from the effect's controls.

use super::clips::{MASK, OUTPUT, SOURCE, guide_clip, guide_label};
use super::colours::SPACES;
use super::effects::{Control, Effect, Target, USUAL_REFERENCE};
use super::host::{Host, Outcome, Properties};
use super::look_effect::DEFAULT;
use isophote::Value;
use isophote::spec::{ImageKind, Param, Unit, animates_marks};
use isophote::value::decimal;
use isophote_abi::openfx::*;
use std::ffi::{CStr, c_int};
use std::ptr::null_mut;

const COMPONENTS: [&CStr; 3] = [kOfxImageComponentRGBA, kOfxImageComponentRGB, kOfxImageComponentAlpha];
/// Alpha first: hosts that give a mask one channel give it the first that is named.
const MASK_COMPONENTS: [&CStr; 3] = [kOfxImageComponentAlpha, kOfxImageComponentRGBA, kOfxImageComponentRGB];

/// Describes what does not depend on a context.
///
/// # Errors
/// Failed, without a descriptor.
pub fn describe(effect: &'static Effect, host: &Host, descriptor: Handle) -> Outcome {
    let set = host.effect(descriptor);
    if set.is_null() {
        return Err(kOfxStatFailed);
    }
    labels(set, &effect.label);
    set.set_string(kOfxImageEffectPluginPropGrouping, 0, &effect.grouping);
    set.set_string(kOfxPropPluginDescription, 0, &effect.description);
    set.set_string(kOfxPropVersionLabel, 0, VERSION);
    for (index, number) in VERSION.to_string_lossy().split('.').enumerate() {
        set.set_int_at(kOfxPropVersion, index, number.parse().unwrap_or(0));
    }
    for (index, icon) in effect.icons.iter().enumerate() {
        set.set_string(kOfxPropIcon, index, icon);
    }
    let contexts = [kOfxImageEffectContextFilter, kOfxImageEffectContextGeneral];
    set_strings(set, kOfxImageEffectPropSupportedContexts, &contexts);
    let depths = [kOfxBitDepthFloat, kOfxBitDepthHalf, kOfxBitDepthShort, kOfxBitDepthByte];
    let depths = depths.into_iter().filter(|d| host.half || *d != kOfxBitDepthHalf);
    set_strings(set, kOfxImageEffectPropSupportedPixelDepths, &depths.collect::<Vec<_>>());
    // Nothing is kept between calls, so any number of frames may be rendered at once.
    set.set_string(kOfxImageEffectPluginRenderThreadSafety, 0, kOfxImageEffectRenderFullySafe);
    for (name, value) in [
        (kOfxImageEffectPluginPropSingleInstance, 0),
        (kOfxImageEffectPluginPropHostFrameThreading, 0),
        (kOfxImageEffectPropSupportsMultiResolution, 1),
        (kOfxImageEffectPropSupportsTiles, effect.is_local(host.temporal).into()),
        (kOfxImageEffectPropTemporalClipAccess, (effect.temporal && host.temporal).into()),
        (kOfxImageEffectPluginPropFieldRenderTwiceAlways, 0),
        (kOfxImageEffectPropSupportsMultipleClipDepths, 0),
        (kOfxImageEffectPropSupportsMultipleClipPARs, 0),
        (kOfxImageEffectInstancePropSequentialRender, 0),
    ] {
        set.set_int(name, value);
    }
    for (name, value) in [
        (kOfxImageEffectPropOpenGLRenderSupported, c"false"),
        (kOfxImageEffectPropOpenCLRenderSupported, c"false"),
        (kOfxImageEffectPropCudaRenderSupported, c"false"),
        (kOfxImageEffectPropMetalRenderSupported, c"false"),
        (kOfxImageEffectPropCPURenderSupported, c"true"),
        (kOfxImageEffectPropNoSpatialAwareness, c"false"),
        (kOfxImageEffectPropColourManagementStyle, kOfxImageEffectColourManagementBasic),
        (kOfxImageEffectPropColourManagementAvailableConfigs, COLOURSPACES),
    ] {
        set.set_string(name, 0, value);
    }
    set_strings(set, kOfxImageEffectPropClipPreferencesSlaveParam, &preference_controls(effect));
    Ok(kOfxStatOK)
}

/// The controls that decide about clip preferences: which colour space is asked for, and whether marks move by themselves.
fn preference_controls(effect: &'static Effect) -> Vec<&'static CStr> {
    let decides = |control: &&Control| match control.target {
        Target::WorkingSpace | Target::Shown | Target::File | Target::TimesRead => true,
        Target::Param(_, param) | Target::Own(param) => animates_marks(param),
        _ => false,
    };
    effect.controls.iter().filter(decides).map(|control| control.name.as_c_str()).collect()
}

const VERSION: &CStr = match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
    Ok(version) => version,
    Err(_) => c"",
};

fn set_strings(set: Properties<'_>, name: &CStr, values: &[&'static CStr]) {
    for (index, value) in values.iter().enumerate() {
        set.set_string(name, index, value);
    }
}

/// Clips and parameters of one context.
///
/// # Errors
/// Failed, when the host refuses a clip or a parameter.
pub fn in_context(effect: &'static Effect, host: &Host, descriptor: Handle, in_args: Handle) -> Outcome {
    let context = host.set(in_args).string(kOfxImageEffectPropContext, 0).unwrap_or_default();
    let general = context.as_c_str() == kOfxImageEffectContextGeneral;
    for clip in clips(effect, general) {
        let set = define_clip(host, descriptor, clip.name)?;
        labels(set, clip.label);
        set_strings(set, kOfxImageEffectPropSupportedComponents, clip.components);
        set.set_int(kOfxImageClipPropOptional, clip.optional.into());
        set.set_int(kOfxImageClipPropIsMask, clip.mask.into());
        set.set_int(kOfxImageEffectPropSupportsTiles, effect.is_local(host.temporal).into());
        let temporal = clip.temporal && effect.temporal && host.temporal;
        set.set_int(kOfxImageEffectPropTemporalClipAccess, temporal.into());
        set.set_string(kOfxImageClipPropFieldExtraction, 0, kOfxImageFieldDoubled);
    }
    let params = host.params(descriptor)?;
    let shown = || effect.controls.iter().filter(|c| general || !c.target.is_of_clips());
    let page = define_param(host, params, kOfxParamTypePage, c"Controls")?;
    page.set_string(kOfxPropLabel, 0, c"Controls");
    for (index, control) in shown().enumerate() {
        page.set_string(kOfxParamPropPageChild, index, &control.name);
    }
    for group in &effect.groups {
        let set = define_param(host, params, kOfxParamTypeGroup, &group.name)?;
        labels(set, &group.label);
        set.set_string(kOfxParamPropScriptName, 0, &group.name);
        set.set_int(kOfxParamPropGroupOpen, group.open.into());
    }
    for control in shown() {
        define_control(effect, host, params, control)?;
    }
    Ok(kOfxStatOK)
}

/// A clip as it is described.
struct Described {
    name: &'static CStr,
    label: &'static CStr,
    components: &'static [&'static CStr],
    mask: bool,
    optional: bool,
    /// True where it is read at neighbouring frames.
    temporal: bool,
}

/// The clips, in the order of inputs.
fn clips(effect: &Effect, general: bool) -> Vec<Described> {
    let clip = |name| Described {
        name,
        label: name,
        components: &COMPONENTS,
        mask: false,
        optional: false,
        temporal: false,
    };
    let mut clips = vec![Described { temporal: true, ..clip(SOURCE) }, clip(OUTPUT)];
    if general {
        clips.push(Described { components: &MASK_COMPONENTS, mask: true, optional: true, ..clip(MASK) });
        clips.extend(effect.guides.iter().filter_map(|guide| {
            let name = guide_clip(*guide)?;
            let components: &[&CStr] = match guide.kind() {
                // One channel holds no vector and no tones, and three have no place for a strength.
                ImageKind::Motion | ImageKind::Position | ImageKind::Hatching => &COMPONENTS[..2],
                ImageKind::Control | ImageKind::Flow | ImageKind::Cryptomatte => &COMPONENTS[..1],
                ImageKind::Color
                | ImageKind::Scalar
                | ImageKind::Tensor
                | ImageKind::Normal
                | ImageKind::Depth
                | ImageKind::ObjectId => &COMPONENTS,
            };
            let label = guide_label(*guide).unwrap_or(name);
            Some(Described { label, components, optional: true, temporal: true, ..clip(name) })
        }));
    }
    clips
}

fn define_clip<'h>(host: &'h Host, descriptor: Handle, name: &'static CStr) -> Outcome<Properties<'h>> {
    let define = host.effects.clipDefine.ok_or(kOfxStatErrMissingHostFeature)?;
    let mut set = null_mut();
    // SAFETY: a descriptor that the host gave, a string with a closing zero, and a place for the answer.
    let status = unsafe { define(descriptor, name.as_ptr(), &raw mut set) };
    if status == kOfxStatOK { Ok(host.set(set)) } else { Err(kOfxStatFailed) }
}

fn define_param<'h>(
    host: &'h Host,
    params: Handle,
    kind: &'static CStr,
    name: &'static CStr,
) -> Outcome<Properties<'h>> {
    let define = host.parameters.paramDefine.ok_or(kOfxStatErrMissingHostFeature)?;
    let mut set = null_mut();
    // SAFETY: a set that the host gave, strings with a closing zero, and a place for the answer.
    let status = unsafe { define(params, kind.as_ptr(), name.as_ptr(), &raw mut set) };
    if status == kOfxStatOK { Ok(host.set(set)) } else { Err(kOfxStatFailed) }
}

fn labels(set: Properties<'_>, label: &'static CStr) {
    for property in [kOfxPropLabel, kOfxPropShortLabel, kOfxPropLongLabel] {
        set.set_string(property, 0, label);
    }
}

/// The largest reference height, and the largest that a slider offers.
const MOST_HEIGHT: c_int = 65536;
const USUAL_HEIGHT: c_int = 2160;

fn define_control(
    effect: &'static Effect,
    host: &Host,
    params: Handle,
    control: &'static Control,
) -> Outcome<()> {
    let define = |kind| define_param(host, params, kind, &control.name);
    let set = match control.target {
        Target::Param(_, param) => match param.default {
            Value::Float(_) => number(define(kOfxParamTypeDouble)?, param),
            Value::Int(_) => whole_number(define(kOfxParamTypeInteger)?, param),
            Value::Bool(default) => switch(define(kOfxParamTypeBoolean)?, default),
            Value::Choice(default) => choice(define(kOfxParamTypeChoice)?, control, default),
            Value::Color(_) => colour(define(kOfxParamTypeRGBA)?, param),
        },
        Target::Own(param) => own(number(define(kOfxParamTypeDouble)?, param), param),
        Target::Look => look(choice(define(kOfxParamTypeChoice)?, control, 0), host),
        Target::Shown => choice(define(kOfxParamTypeChoice)?, control, DEFAULT),
        Target::File => file(define(kOfxParamTypeString)?),
        Target::Reload => define(kOfxParamTypePushButton)?,
        Target::TimesRead => hidden(count(define(kOfxParamTypeInteger)?, 0, [c_int::MAX; 2])),
        Target::LinesOutput
        | Target::MaskFrom
        | Target::MotionFrom
        | Target::MotionConvention
        | Target::ComputeOn
        | Target::Card
        | Target::Precision => choice(define(kOfxParamTypeChoice)?, control, 0),
        Target::WorkingSpace => {
            let default = SPACES.iter().position(|space| *space == Some(host.quirks.space)).unwrap_or(0);
            choice(define(kOfxParamTypeChoice)?, control, default)
        }
        Target::ReferenceHeight => {
            count(define(kOfxParamTypeInteger)?, USUAL_REFERENCE as c_int, [MOST_HEIGHT, USUAL_HEIGHT])
        }
        Target::ProcessAlpha | Target::MaskInvert => switch(define(kOfxParamTypeBoolean)?, false),
        Target::MaskApply => switch(define(kOfxParamTypeBoolean)?, !host.quirks.all_connected),
    };
    labels(set, &control.label);
    set.set_string(kOfxParamPropScriptName, 0, &control.name);
    set.set_string(kOfxParamPropHint, 0, &control.hint);
    if let Some(group) = control.group {
        set.set_string(kOfxParamPropParent, 0, &effect.groups[group].name);
    }
    Ok(())
}

/// Default, range and slider, by the names of their properties.
fn range(param: &Param) -> [(&'static CStr, f64); 5] {
    let ([low, high], [from, to]) = (param.range.map(decimal), param.slider.map(decimal));
    [
        (kOfxParamPropDefault, param.default.decimals()[0]),
        (kOfxParamPropMin, low),
        (kOfxParamPropMax, high),
        (kOfxParamPropDisplayMin, from),
        (kOfxParamPropDisplayMax, to),
    ]
}

fn number<'h>(set: Properties<'h>, param: &Param) -> Properties<'h> {
    let kind = if param.unit == Unit::Degrees { kOfxParamDoubleTypeAngle } else { kOfxParamDoubleTypePlain };
    set.set_string(kOfxParamPropDoubleType, 0, kind);
    for (name, value) in range(param) {
        set.set_doubles(name, &[value]);
    }
    // A hundredth of the slider, as a round number, and one digit more.
    let digits = (2.0 - (param.slider[1] - param.slider[0]).log10().floor()).clamp(0.0, 6.0);
    set.set_doubles(kOfxParamPropIncrement, &[10_f64.powf(-f64::from(digits))]);
    set.set_int(kOfxParamPropDigits, digits as c_int + 1);
    set.set_int(kOfxParamPropAnimates, 1);
    set
}

fn whole_number<'h>(set: Properties<'h>, param: &Param) -> Properties<'h> {
    for (name, value) in range(param) {
        set.set_int(name, value as c_int);
    }
    set.set_int(kOfxParamPropAnimates, 1);
    set
}

fn colour<'h>(set: Properties<'h>, param: &Param) -> Properties<'h> {
    set.set_doubles(kOfxParamPropDefault, &param.default.decimals());
    set.set_int(kOfxParamPropAnimates, 1);
    set
}

fn switch(set: Properties<'_>, default: bool) -> Properties<'_> {
    set.set_int(kOfxParamPropDefault, default.into());
    set.set_int(kOfxParamPropAnimates, 0);
    set
}

fn choice<'h>(set: Properties<'h>, control: &'static Control, default: usize) -> Properties<'h> {
    for (index, option) in control.options.iter().enumerate() {
        set.set_string(kOfxParamPropChoiceOption, index, option);
    }
    set.set_int(kOfxParamPropDefault, default as c_int);
    set.set_int(kOfxParamPropAnimates, 0);
    set
}

/// The choice of a look, hidden where the effect would not hear of it.
fn look<'h>(set: Properties<'h>, host: &Host) -> Properties<'h> {
    // Natron undoes nothing that it does not render for, and the choice is the step there.
    set.set_int(kOfxParamPropEvaluateOnChange, (!host.quirks.keeps_steps).into());
    if host.quirks.tells_of_edits { set } else { hidden(set) }
}

/// The path of a file that must be there.
fn file(set: Properties<'_>) -> Properties<'_> {
    set.set_string(kOfxParamPropDefault, 0, c"");
    set.set_string(kOfxParamPropStringMode, 0, kOfxParamStringIsFilePath);
    set.set_int(kOfxParamPropStringFilePathExists, 1);
    set.set_int(kOfxParamPropAnimates, 0);
    set
}

/// A whole number from 0 on that is never animated, with the most that it and its slider can be.
fn count(set: Properties<'_>, default: c_int, [most, usual]: [c_int; 2]) -> Properties<'_> {
    for (name, value) in [
        (kOfxParamPropDefault, default),
        (kOfxParamPropMin, 0),
        (kOfxParamPropMax, most),
        (kOfxParamPropDisplayMin, 0),
        (kOfxParamPropDisplayMax, usual),
        (kOfxParamPropAnimates, 0),
    ] {
        set.set_int(name, value);
    }
    set
}

/// A parameter that nobody sees.
fn hidden(set: Properties<'_>) -> Properties<'_> {
    set.set_int(kOfxParamPropSecret, 1);
    set
}

/// A number of the effect's own. Hosts ask once for all times what steadiness decides about.
fn own<'h>(set: Properties<'h>, param: &Param) -> Properties<'h> {
    if animates_marks(param) {
        set.set_int(kOfxParamPropAnimates, 0);
    }
    set
}
