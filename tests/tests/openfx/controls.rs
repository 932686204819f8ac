//! Messages of instances as their values change: tiles, and controls that have no effect.

use super::reference::*;
use isophote_abi::openfx::*;
use isophote_tests::ofx::effect::{Described, Instance};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::properties::Value;
use isophote_tests::ofx::state::Behaviour;
use std::ffi::CStr;

const SIZE: [i32; 2] = [WIDTH, HEIGHT];
/// An effect that looks at the whole picture where it fills in orientations, which a number decides.
const RELAXED: &str = "org.isophote.structure";

fn supports_tiles(instance: &Instance<'_>) -> Option<i32> {
    instance.effect.set.int(kOfxImageEffectPropSupportsTiles)
}

pub fn tiles_are_supported_as_saved_values_say(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let described = Described::new(&host, binary.plugin(RELAXED));
    assert_eq!(described.descriptor.set.int(kOfxImageEffectPropSupportsTiles), Some(1));
    let create = |threshold: f64| {
        let saved = [("relax_threshold", threshold.into())];
        described.saved_instance(kOfxImageEffectContextFilter, &saved)
    };
    assert_eq!(supports_tiles(&create(0.0)), Some(1));
    let instance = create(0.1);
    assert_eq!(supports_tiles(&instance), Some(0));
    for reason in [kOfxChangeUserEdited, kOfxChangePluginEdited] {
        for (threshold, tiles) in [(0.0, 1), (0.1, 0)] {
            instance.set("relax_threshold", threshold);
            instance.changed(kOfxTypeParameter, reason, 0.0);
            assert_eq!(supports_tiles(&instance), Some(tiles), "{reason:?}");
        }
    }
    // What is animated decides for all times, whichever it is now.
    instance.animate("relax_threshold", vec![(0.0, 0.0.into()), (10.0, 0.1.into())]);
    instance.changed(kOfxTypeParameter, kOfxChangeUserEdited, 0.0);
    assert_eq!(supports_tiles(&instance), Some(0));
    host.no_faults();
}

pub fn another_time_is_no_edit(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let saved = [("relax_threshold", Value::from(0.1))];
    let instance =
        Described::new(&host, binary.plugin(RELAXED)).saved_instance(kOfxImageEffectContextFilter, &saved);
    let grey = || !instance.is_enabled("relax_steps");
    assert!(!grey());
    // Nothing is animated: another time changes nothing, and is not taken for an edit.
    instance.set("relax_threshold", 0.0);
    instance.changed(kOfxTypeParameter, kOfxChangeTime, 5.0);
    assert!(!grey() && supports_tiles(&instance) == Some(0));
    instance.changed(kOfxTypeParameter, kOfxChangeUserEdited, 5.0);
    assert!(grey() && supports_tiles(&instance) == Some(1));
    // What is animated has other values at another time.
    instance.animate("relax_threshold", vec![(0.0, 0.0.into()), (10.0, 0.1.into())]);
    instance.changed(kOfxTypeParameter, kOfxChangeTime, 12.0);
    assert!(!grey());
    instance.changed(kOfxTypeParameter, kOfxChangeTime, 3.0);
    assert!(grey());
    host.no_faults();
}

pub fn hosts_without_a_window_are_not_told_of_controls(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    host.properties().put(kOfxImageEffectHostPropIsBackground, vec![1.into()]);
    let described = Described::new(&host, binary.plugin(RELAXED));
    let saved = [("relax_threshold", Value::from(0.0))];
    let instance = described.saved_instance(kOfxImageEffectContextFilter, &saved);
    assert!(instance.is_enabled("relax_steps"));
    assert_eq!(supports_tiles(&instance), Some(1));
}

pub fn what_motion_comes_from_decides_about_tiles_and_controls(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let described = Described::new(&host, binary.plugin("org.isophote.oriented_bilateral"));
    let instance = described.instance(kOfxImageEffectContextGeneral);
    let changed = |what: &CStr| instance.changed(what, kOfxChangeUserEdited, 0.0);
    let usable =
        || ["steadiness", "window", "motion_from", "motion_convention"].map(|name| instance.is_enabled(name));
    assert_eq!((supports_tiles(&instance), usable()), (Some(1), [true, false, false, false]));
    instance.set("steadiness", 0.5);
    changed(kOfxTypeParameter);
    // An estimate looks at whole pictures.
    assert_eq!((supports_tiles(&instance), usable()), (Some(0), [true, true, true, false]));
    connect(&instance, "Motion", Layout::default());
    assert_eq!((supports_tiles(&instance), usable()), (Some(1), [true; 4]));
    instance.set("motion_from", 2);
    changed(kOfxTypeParameter);
    assert_eq!((supports_tiles(&instance), usable()), (Some(0), [true, true, true, false]));
    instance.disconnect("Motion");
    instance.set("motion_from", 1);
    changed(kOfxTypeParameter);
    assert_eq!((supports_tiles(&instance), usable()), (Some(1), [false, false, true, false]));
    // Nothing is grey for ever.
    instance.set("steadiness", 0.0);
    changed(kOfxTypeParameter);
    assert_eq!(usable(), [false, false, true, false]);
    // What is animated decides for all times.
    instance.set("motion_from", 0);
    instance.animate("steadiness", vec![(0.0, 0.0.into()), (10.0, 0.5.into())]);
    changed(kOfxTypeParameter);
    assert_eq!(supports_tiles(&instance), Some(0));
    host.no_faults();
}

/// The parameters of an instance that are grey, with values that differ from theirs.
fn grey(instance: &Instance<'_>) -> Vec<(String, Vec<Value>)> {
    let mut grey = Vec::new();
    instance.effect.each_param(|param| {
        let set = &param.set;
        if set.int(kOfxParamPropEnabled) != Some(0) {
            return;
        }
        let ends = [kOfxParamPropDisplayMin, kOfxParamPropMax].map(|end| set.get(end));
        let values = match param.kind.as_c_str() {
            k if k == kOfxParamTypeBoolean => vec![0.into(), 1.into()],
            k if k == kOfxParamTypeChoice => {
                (0..set.texts(kOfxParamPropChoiceOption).len() as i32).map(Value::from).collect()
            }
            _ => ends.concat(),
        };
        grey.push((param.name.to_string_lossy().into_owned(), values));
    });
    grey
}

fn default_of(instance: &Instance<'_>, name: &str) -> Value {
    let mut found = None;
    instance.effect.each_param(|param| {
        if param.name.to_string_lossy() == name {
            found = param.set.get(kOfxParamPropDefault).first().cloned();
        }
    });
    found.expect("a parameter of this name")
}

pub fn what_is_grey_has_no_effect(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let described = Described::new(&host, effect.plugin(binary));
    for context in [kOfxImageEffectContextFilter, kOfxImageEffectContextGeneral] {
        let instance = described.instance(context);
        instance.connect("Source", source(layout, false));
        instance.changed(kOfxTypeClip, kOfxChangeUserEdited, 0.0);
        let render = || instance.render(layout, SIZE).packed();
        let before = render();
        for (name, values) in grey(&instance) {
            println!("{}: {name} is grey", effect.plugin(binary).identifier());
            for value in values {
                instance.set(&name, value);
                assert!(render() == before, "{} {name}", effect.plugin(binary).identifier());
            }
            instance.set(&name, default_of(&instance, &name));
        }
        for name in ["working_space", "process_alpha"] {
            assert!(instance.is_enabled(name), "{name}");
        }
        if instance.has("mix") {
            assert!(instance.is_enabled("mix"));
        }
    }
    host.no_faults();
}

fn connect(instance: &Instance<'_>, name: &str, layout: Layout) {
    let picture = Picture::packed_in(layout, WIDTH, HEIGHT, &packed(&scene(WIDTH, HEIGHT, true), &layout));
    instance.connect(name, picture);
    instance.changed(kOfxTypeClip, kOfxChangeUserEdited, 0.0);
}

pub fn controls_become_usable_with_what_they_need(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let general: &CStr = kOfxImageEffectContextGeneral;
    let instance = Described::new(&host, effect.plugin(binary)).instance(general);
    let identifier = effect.plugin(binary).identifier();
    if effect.is_lines() {
        assert!(!instance.is_enabled("lines_mix"), "{identifier}");
        instance.set("lines_output", 1);
        instance.changed(kOfxTypeParameter, kOfxChangeUserEdited, 0.0);
        assert!(instance.is_enabled("lines_mix"), "{identifier}");
    }
    assert!(!instance.is_enabled("mask_apply"));
    connect(&instance, "Mask", Layout { components: kOfxImageComponentAlpha, ..layout });
    assert!(instance.is_enabled("mask_apply"));
    if instance.has("guide_weight") {
        assert!(!instance.is_enabled("guide_weight"), "{identifier}");
        connect(&instance, "Normal", layout);
        assert!(instance.is_enabled("guide_weight"), "{identifier}");
    }
    if instance.has("wobble") && instance.has("hold") {
        assert!(!instance.is_enabled("hold"), "{identifier}");
        instance.set("wobble", 2.0);
        instance.changed(kOfxTypeParameter, kOfxChangeUserEdited, 0.0);
        assert!(instance.is_enabled("hold"), "{identifier}");
    }
    let opaque = Layout { alpha: Some(kOfxImageOpaque), ..layout };
    for (layout, enabled) in [(layout, true), (opaque, false), (layout, true)] {
        connect(&instance, "Source", layout);
        assert_eq!(instance.is_enabled("process_alpha"), enabled, "{identifier}");
    }
    host.no_faults();
}
