//! Loading and describing: what every effect says of itself.

use super::reference::{Expected, expected, identifier};
use isophote::spec::Param;
use isophote_abi::openfx::*;
use isophote_tests::ofx::effect::Described;
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::objects::Effect;
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::properties::Value;
use isophote_tests::ofx::state::Behaviour;
use std::collections::BTreeSet;
use std::ffi::CStr;

const CONTEXTS: [&CStr; 2] = [kOfxImageEffectContextFilter, kOfxImageEffectContextGeneral];

pub fn every_node_that_can_be_an_effect_is_one(binary: &Binary) {
    let found: BTreeSet<String> = binary.plugins().iter().map(|p| p.identifier()).collect();
    assert_eq!(found.len(), binary.plugins().len());
    let mut wanted: BTreeSet<String> = expected().iter().map(|effect| identifier(effect.node)).collect();
    wanted.insert("org.isophote.look".to_owned());
    assert_eq!(found, wanted);
    for node in isophote::registry::nodes().iter().filter(|n| n.group == "styles") {
        assert!(found.contains(&identifier(node)), "{}", node.id);
    }
}

pub fn descriptors_say_what_the_standard_asks_for(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let Expected { node } = effect;
    let plugin = effect.plugin(binary);
    let raw = plugin.raw();
    assert_eq!((raw.apiVersion, raw.pluginVersionMajor), (1, 1));
    let described = Described::new(&host, plugin);
    let set = &described.descriptor.set;
    let label = if node.id == "tensor_view" { "Structure" } else { node.label };
    assert_eq!(set.text(kOfxPropLabel).unwrap(), label.replace('-', " "));
    assert_eq!(
        set.text(kOfxImageEffectPluginPropGrouping).unwrap(),
        format!("Isophote/{}{}", node.group[..1].to_uppercase(), &node.group[1..])
    );
    assert_eq!(set.text(kOfxPropPluginDescription).unwrap(), node.hint);
    let contexts = set.texts(kOfxImageEffectPropSupportedContexts);
    assert_eq!(contexts, ["OfxImageEffectContextFilter", "OfxImageEffectContextGeneral"]);
    let depths = set.texts(kOfxImageEffectPropSupportedPixelDepths);
    assert_eq!(depths, ["OfxBitDepthFloat", "OfxBitDepthHalf", "OfxBitDepthShort", "OfxBitDepthByte"]);
    let icon = format!("{}.", plugin.identifier());
    assert_eq!(set.texts(kOfxPropIcon), [format!("{icon}svg"), format!("{icon}png")]);
    for gpu in [
        kOfxImageEffectPropOpenGLRenderSupported,
        kOfxImageEffectPropOpenCLRenderSupported,
        kOfxImageEffectPropCudaRenderSupported,
        kOfxImageEffectPropMetalRenderSupported,
    ] {
        assert_eq!(set.text(gpu).unwrap(), "false");
    }
    assert_eq!(set.int(kOfxImageEffectPropSupportsMultiResolution), Some(1));
    assert_eq!(set.int(kOfxImageEffectPropTemporalClipAccess), Some(node.is_steady().into()));
    assert_eq!(set.text(kOfxImageEffectPluginRenderThreadSafety).unwrap(), "OfxImageEffectRenderFullySafe");
    host.no_faults();
}

pub fn clips_are_source_and_output_and_in_general_a_mask_and_guides(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let Expected { node } = effect;
    let plugin = effect.plugin(binary);
    let described = Described::new(&host, plugin);
    assert_eq!(described.in_context(CONTEXTS[0]).clip_names(), ["Source", "Output"]);
    let first = if node.id == "tensor_view" { "structure_tensor" } else { node.id };
    let first = isophote::registry::find(first).unwrap();
    let takes = |id: &str| first.ports().any(|port| port.id == id);
    let mut general = vec!["Source", "Output", "Mask"];
    for (port, clip) in [
        ("normal", "Normal"),
        ("depth", "Depth"),
        ("motion", "Motion"),
        ("motion_forward", "MotionForward"),
        ("rest_position", "RestPosition"),
        ("object_id", "ObjectId"),
        ("flow", "Flow"),
        ("albedo", "Albedo"),
        ("diffuse", "Diffuse"),
        ("specular", "Specular"),
        ("control", "Control"),
        ("paper", "Paper"),
        ("hatching", "Hatching"),
        ("line_paint", "LinePaint"),
    ] {
        general.extend(takes(port).then_some(clip));
    }
    // What an effect came to take later is its last input: projects store the numbers of the others.
    if ["cartoon", "blueprint"].contains(&node.id) {
        const LATER: [&str; 6] = ["RestPosition", "Paper", "Albedo", "Diffuse", "Specular", "LinePaint"];
        general.sort_by_key(|clip| LATER.iter().position(|later| later == clip));
    }
    assert_eq!(described.in_context(CONTEXTS[1]).clip_names(), general, "{}", node.id);
    host.no_faults();
}

/// The one control of a name, by its type and properties.
fn check(effect: &Effect, name: &str, param: &Param) {
    let mut found = 0;
    effect.each_param(|control| {
        if control.name.to_string_lossy() != name {
            return;
        }
        found += 1;
        let set = &control.set;
        assert!(set.text(kOfxParamPropHint).unwrap().starts_with(param.hint), "{name}");
        assert_eq!(set.text(kOfxPropLabel).unwrap(), param.label);
        assert_eq!(set.text(kOfxParamPropScriptName).unwrap(), name);
        let ranges = [
            kOfxParamPropDefault,
            kOfxParamPropMin,
            kOfxParamPropDisplayMin,
            kOfxParamPropDisplayMax,
            kOfxParamPropMax,
        ]
        .map(|p| set.numbers(p).first().map(|v| *v as f32));
        let ([low, high], [from, to]) = (param.range, param.slider);
        match param.default {
            isophote::Value::Float(default) => {
                assert_eq!(control.kind.as_c_str(), kOfxParamTypeDouble);
                assert_eq!(ranges, [default, low, from, to, high].map(Some), "{name}");
                assert!(set.int(kOfxParamPropDigits) > Some(0));
            }
            isophote::Value::Int(default) => {
                assert_eq!(control.kind.as_c_str(), kOfxParamTypeInteger);
                assert_eq!(ranges, [default as f32, low, from, to, high].map(Some), "{name}");
            }
            isophote::Value::Bool(default) => {
                assert_eq!(control.kind.as_c_str(), kOfxParamTypeBoolean);
                assert_eq!(set.int(kOfxParamPropDefault), Some(default.into()));
            }
            isophote::Value::Choice(default) => {
                assert_eq!(control.kind.as_c_str(), kOfxParamTypeChoice);
                assert_eq!(set.int(kOfxParamPropDefault), Some(default as i32));
                let labels: Vec<&str> = param.options.iter().map(|o| o.label).collect();
                assert_eq!(set.texts(kOfxParamPropChoiceOption), labels);
            }
            isophote::Value::Color(default) => {
                assert_eq!(control.kind.as_c_str(), kOfxParamTypeRGBA);
                let got: Vec<f32> = set.numbers(kOfxParamPropDefault).iter().map(|v| *v as f32).collect();
                assert_eq!(got, default);
            }
        }
    });
    assert_eq!(found, 1, "{name}");
}

/// Names of the controls that are no parameters of nodes.
fn own_controls(effect: Expected, general: bool) -> BTreeSet<String> {
    let mut names =
        vec!["working_space", "process_alpha", "reference_height", "compute_on", "card", "precision"];
    if general {
        names.extend(["mask_apply", "mask_from", "mask_invert"]);
    }
    if general && effect.node.is_steady() {
        names.extend(["motion_from", "motion_convention"]);
    }
    names.extend(effect.is_lines().then_some("lines_output"));
    names.extend((effect.node.group == "styles").then_some("look"));
    names.into_iter().map(str::to_owned).collect()
}

pub fn controls_are_the_parameters_of_the_nodes(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let described = Described::new(&host, effect.plugin(binary));
    for context in CONTEXTS {
        let general = context == CONTEXTS[1];
        let shown = described.in_context(context);
        let find = |id| isophote::registry::find(id).unwrap();
        let members = match effect.node.id {
            "tensor_view" => vec![(find("structure_tensor"), ""), (effect.node, "view_")],
            _ if effect.is_lines() => vec![(effect.node, ""), (find("composite_lines"), "lines_")],
            _ => vec![(effect.node, "")],
        };
        let mut names = own_controls(effect, general);
        for (node, prefix) in members {
            for param in node.params() {
                let name = format!("{prefix}{}", param.id);
                check(&shown, &name, param);
                names.insert(name);
            }
        }
        let mut controls = BTreeSet::new();
        let mut labels = BTreeSet::new();
        let mut groups = BTreeSet::new();
        let mut page = Vec::new();
        let mut parents = BTreeSet::new();
        shown.each_param(|param| {
            let name = param.name.to_string_lossy().into_owned();
            match param.kind.as_c_str() {
                k if k == kOfxParamTypePage => page = param.set.texts(kOfxParamPropPageChild),
                k if k == kOfxParamTypeGroup => assert!(groups.insert(name)),
                _ => {
                    let [label, hint] =
                        [kOfxPropLabel, kOfxParamPropHint].map(|p| param.set.text(p).unwrap());
                    assert!(
                        label.chars().count() < 20 && hint.chars().count() < 160,
                        "{name}: {label}: {hint}"
                    );
                    assert!(labels.insert(label), "{name} has the label of another control");
                    assert!(controls.insert(name));
                }
            }
            parents.extend(param.set.text(kOfxParamPropParent));
        });
        assert_eq!(controls, names, "{}", effect.node.id);
        assert_eq!(page.iter().cloned().collect::<BTreeSet<_>>(), names);
        // Where hosts have their own.
        let last = page.last().unwrap();
        assert!(last.ends_with("mix") || !names.iter().any(|name| name.ends_with("mix")), "{last}");
        assert!(parents.is_subset(&groups));
    }
    host.no_faults();
}

pub fn the_working_space_follows_the_host(binary: &Binary) {
    for (name, index) in
        [(c"uk.co.thefoundry.nuke", 0), (c"fr.inria.Natron", 0), (c"DaVinciResolve", 1), (c"mlt", 1)]
    {
        let host = Host::new(Behaviour { name, ..Behaviour::default() });
        let shown = Described::new(&host, binary.plugins()[0]).in_context(CONTEXTS[0]);
        shown.each_param(|param| {
            if param.name.as_c_str() == c"working_space" {
                assert_eq!(param.set.get(kOfxParamPropDefault), [Value::Int(index)], "{name:?}");
                let options = param.set.texts(kOfxParamPropChoiceOption);
                // Saved projects hold their places.
                assert_eq!(options[..5], ["Linear (Rec. 709)", "sRGB", "As is", "ACEScg", "Linear (P3)"]);
                assert_eq!(options.len(), 13);
            }
        });
    }
}

pub fn hosts_that_manage_colours_are_asked_for_the_working_space(binary: &Binary) {
    let host = Host::new(Behaviour { name: c"fr.inria.Natron", ..Behaviour::default() });
    let described = Described::new(&host, binary.plugin("org.isophote.gaussian"));
    let set = &described.descriptor.set;
    assert_eq!(
        set.texts(kOfxImageEffectPropColourManagementAvailableConfigs),
        [COLOURSPACES.to_str().unwrap()]
    );
    assert_eq!(set.texts(kOfxImageEffectPropClipPreferencesSlaveParam), ["working_space"]);
    let instance = described.instance(CONTEXTS[0]);
    let wanted = || {
        let answer = instance.args();
        instance.act(kOfxImageEffectActionGetClipPreferences, None, Some(&answer));
        answer.texts(PREFERRED_COLOURSPACES_OF_SOURCE)
    };
    assert!(wanted().is_empty(), "this host manages no colours yet");
    let style = Value::from(kOfxImageEffectColourManagementBasic);
    instance.effect.set.put(kOfxImageEffectPropColourManagementStyle, vec![style]);
    for (space, name) in [
        (0, "ofx_scene_linear"),
        (1, "ofx_display_sdr"),
        (3, "ofx_scene_linear"),
        (6, "ofx_scene_linear"),
        (7, "ofx_display_sdr"),
        (11, "ofx_display_hdr"),
    ] {
        instance.set("working_space", space);
        assert_eq!(wanted(), [name]);
    }
    instance.set("working_space", 2);
    assert!(wanted().is_empty());
    let answer = instance.args();
    let status = instance.act(kOfxImageEffectActionGetOutputColourspace, None, Some(&answer));
    assert_eq!(status, kOfxStatOK);
    assert_eq!(answer.texts(kOfxImageClipPropColourspace), ["OfxColourspace_Source"]);
    host.no_faults();
}

pub fn half_floats_are_offered_to_hosts_that_have_them(binary: &Binary) {
    let host = Host::new(Behaviour { half: false, ..Behaviour::default() });
    let described = Described::new(&host, binary.plugins()[0]);
    let depths = described.descriptor.set.texts(kOfxImageEffectPropSupportedPixelDepths);
    assert_eq!(depths, ["OfxBitDepthFloat", "OfxBitDepthShort", "OfxBitDepthByte"]);
}

pub fn describing_is_the_same_every_time_and_stands_refused_properties(binary: &Binary, effect: Expected) {
    let described = |refuses_optional| {
        let host = Host::new(Behaviour { refuses_optional, ..Behaviour::default() });
        let described = Described::new(&host, effect.plugin(binary));
        let mut all = Vec::new();
        described.in_context(CONTEXTS[1]).each_param(|p| {
            all.push((p.name.clone(), p.set.get(kOfxParamPropDefault), p.set.get(kOfxParamPropHint)));
        });
        host.no_faults();
        all
    };
    let first = described(false);
    assert_eq!(first, described(false));
    assert_eq!(first.len(), described(true).len());
}

pub fn a_host_without_a_needed_suite_is_told(binary: &Binary) {
    let missing = [kOfxPropertySuite, kOfxImageEffectSuite, kOfxParameterSuite];
    for suite in missing {
        let host = Host::new(Behaviour { without: vec![suite], ..Behaviour::default() });
        let plugin = binary.plugin("org.isophote.gaussian");
        let failed = Described::attempt(&host, plugin).err();
        assert_eq!(failed, Some(("Load", kOfxStatErrMissingHostFeature)), "{suite:?}");
    }
}
