//! Messages of instances about their results: whether frames vary, and the lengths of new instances.

use super::reference::*;
use isophote_abi::openfx::*;
use isophote_tests::ofx::effect::{Described, Instance};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::state::Behaviour;

fn varies(instance: &Instance<'_>) -> bool {
    let answer = instance.args();
    instance.act(kOfxImageEffectActionGetClipPreferences, None, Some(&answer));
    answer.int(kOfxImageEffectFrameVarying) == Some(1)
}

pub fn marks_that_move_by_themselves_vary_from_frame_to_frame(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let described = Described::new(&host, effect.plugin(binary));
    let slaves = described.descriptor.set.texts(kOfxImageEffectPropClipPreferencesSlaveParam);
    for context in [kOfxImageEffectContextFilter, kOfxImageEffectContextGeneral] {
        let instance = described.instance(context);
        assert!(!varies(&instance), "{}", effect.node.id);
        for (name, on, off) in [("hold", 2, 0), ("lines_hold", 2, 0)] {
            assert_eq!(instance.has(name), slaves.contains(&name.to_owned()), "{}", effect.node.id);
            if instance.has(name) {
                instance.set(name, on);
                assert!(varies(&instance), "{} {name}", effect.node.id);
                instance.set(name, off);
                assert!(!varies(&instance));
                // What is animated decides for all times.
                instance.animate(name, vec![(0.0, 0.into()), (10.0, 2.into())]);
                assert!(varies(&instance), "{} {name} is animated", effect.node.id);
                instance.animate(name, Vec::new());
            }
        }
        if instance.has("renewal") {
            instance.set("steadiness", 0.5);
            assert!(varies(&instance), "{}", effect.node.id);
            instance.set("renewal", 0);
            assert!(!varies(&instance), "{}", effect.node.id);
        }
    }
    host.no_faults();
}

pub fn lengths_are_meant_at_1080_lines(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    for plugin in binary.plugins().iter().copied() {
        let described = Described::new(&host, plugin);
        for context in [kOfxImageEffectContextFilter, kOfxImageEffectContextGeneral] {
            let effect = described.in_context(context);
            let mut height = None;
            effect.each_param(|param| {
                if param.name.as_c_str() == c"reference_height" {
                    height = param.set.int(kOfxParamPropDefault);
                }
            });
            assert_eq!(height, Some(1080), "{}", plugin.identifier());
        }
    }
    host.no_faults();
}
