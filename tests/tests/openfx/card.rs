//! Effects on a graphics card, by a device of the library's own.

use super::reference::*;
use isophote_abi::openfx::*;
use isophote_abi::{ISOPHOTE_PRECISION_EXACT, ISOPHOTE_PRECISION_HALF};
use isophote_tests::device;
use isophote_tests::ofx::effect::{Described, Instance, Wanted};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::Layout;
use isophote_tests::ofx::plugin::{Binary, Plugin};
use isophote_tests::ofx::state::Behaviour;
use std::ptr::null_mut;
use std::sync::atomic::Ordering;

const SIZE: [i32; 2] = [WIDTH, HEIGHT];
const ALL: [i32; 4] = [0, 0, WIDTH, HEIGHT];

fn instance<'h>(host: &'h Host, plugin: Plugin) -> Instance<'h> {
    let instance = Described::new(host, plugin).instance(kOfxImageEffectContextFilter);
    plain(&instance);
    instance.connect("Source", source(Layout::default(), false));
    instance.set("compute_on", 1);
    instance
}

fn messages(host: &Host) -> Vec<String> {
    host.inner.messages.lock().unwrap().clone()
}

fn purge(plugin: Plugin) {
    assert_eq!(plugin.act(kOfxActionPurgeCaches, null_mut(), None, None), kOfxStatOK);
}

pub fn every_effect_equals_the_c_table_on_a_device(binary: &Binary, effect: Expected) {
    let Some(device) = On::device("a graphics card for OpenFX") else { return };
    let host = Host::new(Behaviour::default());
    let (graph, layout) = (effect.graph(false), Layout::default());
    let instance = instance(&host, effect.plugin(binary));
    let source = source(layout, false);
    let through = Through::of(&graph, SIZE);
    for (option, precision) in [(0, ISOPHOTE_PRECISION_EXACT), (1, ISOPHOTE_PRECISION_HALF)] {
        instance.set("precision", option);
        let got = instance.render(layout, SIZE).packed();
        let wanted = through.on(On { device, precision }, &[("color", &source.packed(), layout)], layout);
        let worst = difference(&got, &wanted, &layout);
        assert!(got == wanted, "{}: precision {option}: {worst}", effect.plugin(binary).identifier());
    }
    assert!(messages(&host).is_empty(), "{:?}", messages(&host));
    drop(instance);
    purge(effect.plugin(binary));
    host.no_faults();
}

pub fn frames_on_threads_share_a_card_and_stand_purges(binary: &Binary) {
    if device::device("frames on threads").is_none() {
        return;
    }
    let host = Host::new(Behaviour::default());
    let plugins = ["gaussian", "cartoon"].map(|id| binary.plugin(&format!("org.isophote.{id}")));
    let layout = Layout::default();
    let render = |plugin| instance(&host, plugin).render(layout, SIZE).packed();
    let first = plugins.map(render);
    std::thread::scope(|scope| {
        // More than there are places for frames.
        for thread in 0..6 {
            let (render, first) = (&render, &first);
            scope.spawn(move || {
                for turn in 0..4 {
                    let which = (thread + turn) % 2;
                    assert!(render(plugins[which]) == first[which]);
                    if thread == 0 {
                        purge(plugins[0]);
                    }
                }
            });
        }
    });
    assert_eq!(plugins[1].act(kOfxActionUnload, null_mut(), None, None), kOfxStatOK);
    assert!(render(plugins[0]) == first[0]);
    assert!(messages(&host).is_empty(), "{:?}", messages(&host));
    purge(plugins[0]);
    host.no_faults();
}

pub fn cards_are_counted_and_one_that_is_not_there_is_told_of(binary: &Binary) {
    if device::device("a card by its number").is_none() {
        return;
    }
    let host = Host::new(Behaviour::default());
    let plugin = binary.plugin("org.isophote.gaussian");
    let instance = instance(&host, plugin);
    let render = || instance.render(Layout::default(), SIZE).packed();
    let on_card = render();
    instance.set("card", 1);
    assert!(std::env::var_os("ISOPHOTE_ADAPTER").is_some() || render() == on_card);
    instance.set("compute_on", 0);
    let on_cpu = render();
    assert!(difference(&on_cpu, &on_card, &Layout::default()) < 1e-5);
    assert!(messages(&host).is_empty());
    // The last; no machine of a test has so many.
    instance.set("compute_on", 1);
    instance.set("card", 8);
    assert!(render() == on_cpu && render() == on_cpu);
    let said = messages(&host);
    assert!(said.len() == 1 && said[0].starts_with("The CPU computes here. ") && said[0].contains("#8"));
    // It is taken back when a card computes, or when none is wanted.
    instance.set("card", 0);
    assert!(render() == on_card && messages(&host).is_empty());
    instance.set("card", 8);
    render();
    instance.set("compute_on", 0);
    instance.changed(kOfxTypeParameter, kOfxChangeUserEdited, 0.0);
    assert!(messages(&host).is_empty());
    drop(instance);
    purge(plugin);
    host.no_faults();
}

pub fn the_card_and_its_precision_are_grey_on_the_cpu(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let instance = instance(&host, binary.plugin("org.isophote.gaussian"));
    for on in [1, 0] {
        instance.set("compute_on", on);
        instance.changed(kOfxTypeParameter, kOfxChangeUserEdited, 0.0);
        let usable = ["compute_on", "card", "precision"].map(|name| instance.is_enabled(name));
        assert_eq!(usable, [true, on == 1, on == 1]);
    }
    host.no_faults();
}

pub fn tiles_on_a_card_are_parts_of_the_frame(binary: &Binary) {
    if device::device("tiles on a card").is_none() {
        return;
    }
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    for id in ["gaussian", "kuwahara", "ink"] {
        let instance = instance(&host, binary.plugin(&format!("org.isophote.{id}")));
        let whole = instance.render(layout, SIZE);
        for tile in [[0, 0, 17, HEIGHT], [5, 7, 30, 20], [WIDTH - 1, HEIGHT - 1, WIDTH, HEIGHT]] {
            let (status, part) = instance.try_render(layout, SIZE, &Wanted::new(tile));
            assert_eq!(status, kOfxStatOK);
            assert!(part.crop(tile).packed() == whole.crop(tile).packed(), "{id}: {tile:?}");
        }
    }
    purge(binary.plugins()[0]);
    host.no_faults();
}

pub fn a_host_that_wants_to_stop_is_heard_while_a_card_computes(binary: &Binary) {
    if device::device("a frame that is no longer wanted").is_none() {
        return;
    }
    for after in [0, 1] {
        let host = Host::new(Behaviour { abort_after: Some(after), ..Behaviour::default() });
        let instance = instance(&host, binary.plugin("org.isophote.gaussian"));
        let (status, picture) = instance.try_render(Layout::default(), SIZE, &Wanted::new(ALL));
        assert_eq!((status, picture.touched_outside([0; 4])), (kOfxStatOK, 0), "it went on");
        assert!(host.inner.abort_calls.load(Ordering::SeqCst) > after && messages(&host).is_empty());
        host.no_faults();
    }
    purge(binary.plugins()[0]);
}
