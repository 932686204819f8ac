//! Frames around the one that is rendered: which are asked for, which there are, and what becomes of them.

use super::film::{self, RANGE, SIZE, connect, connect_motion, connect_vectors, render, vectors};
use super::reference::*;
use isophote_abi::openfx::*;
use isophote_tests::ofx::effect::{Described, Instance, Wanted};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::state::Behaviour;
use std::ffi::{CStr, CString};
use std::sync::atomic::Ordering;

const FILTER: &CStr = kOfxImageEffectContextFilter;
const GENERAL: &CStr = kOfxImageEffectContextGeneral;

/// An instance that is steadied, with the film for its source.
fn steadied<'h>(described: &Described<'h>, context: &CStr, window: i32) -> Instance<'h> {
    let instance = described.instance(context);
    plain(&instance);
    instance.set("steadiness", 0.5);
    instance.set("window", window);
    connect(&instance, Layout::default());
    instance
}

/// Picture that an instance shows without its neighbours.
fn still(instance: &Instance<'_>, time: i64) -> Vec<u8> {
    instance.set("steadiness", 0.0);
    let picture = render(instance, time).packed();
    instance.set("steadiness", 0.5);
    picture
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    values(bytes, &Layout::default())
}

pub fn frames_are_those_of_the_librarys_sequences(binary: &Binary, effect: Expected) {
    if !effect.node.is_steady() {
        return;
    }
    let host = Host::new(Behaviour::default());
    let described = Described::new(&host, effect.plugin(binary));
    let instance = steadied(&described, GENERAL, 2);
    connect_motion(&instance);
    for time in [5, 3, 8] {
        let got = floats(&render(&instance, time).packed());
        let wanted = film::through_the_library(&effect, 2, false, time);
        assert!(got == wanted, "{} at {time}", effect.node.id);
    }
    assert!(render(&instance, 5).packed() != still(&instance, 5), "{}", effect.node.id);
    let instance = steadied(&described, FILTER, 1);
    for time in [4, 8] {
        let got = floats(&render(&instance, time).packed());
        assert!(
            got == film::through_the_library(&effect, 1, true, time),
            "{} estimated at {time}",
            effect.node.id
        );
    }
    assert!(render(&instance, 4).packed() != still(&instance, 4), "{}", effect.node.id);
    assert_eq!(host.inner.lent.load(Ordering::SeqCst), 0);
    host.no_faults();
}

pub fn frames_are_asked_for_as_the_values_say(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let described = Described::new(&host, effect.plugin(binary));
    let needed = |instance: &Instance<'_>, time: f64| {
        let all = instance.frames_needed(time);
        all.into_iter().filter(|(_, range)| *range != [time, time]).collect::<Vec<_>>()
    };
    if !effect.node.is_steady() {
        let instance = described.instance(FILTER);
        connect(&instance, Layout::default());
        assert_eq!(needed(&instance, 5.0), []);
        return;
    }
    let range = |name: &str, first: f64, last: f64| (name.to_owned(), vec![first, last]);
    let instance = steadied(&described, FILTER, 2);
    assert_eq!(needed(&instance, 5.5), [range("Source", 3.5, 7.5)]);
    assert_eq!(needed(&instance, 8.0), [range("Source", 6.0, 8.0)], "nothing follows the last frame");
    instance.set("window", 1);
    assert_eq!(needed(&instance, 4.0), [range("Source", 3.0, 5.0)]);
    if instance.has("mix") {
        instance.set("mix", 0.0);
        assert_eq!(needed(&instance, 4.0), [], "no change needs no frame");
        instance.set("mix", 1.0);
    }
    instance.animate("steadiness", vec![(0.0, 0.0.into()), (5.0, 0.5.into())]);
    assert_eq!(needed(&instance, 4.0), []);
    assert_eq!(needed(&instance, 5.0), [range("Source", 4.0, 6.0)]);
    let instance = steadied(&described, GENERAL, 2);
    instance.set("motion_from", 1);
    assert_eq!(needed(&instance, 5.0), [], "there is no clip of motion");
    connect_motion(&instance);
    if instance.has("renewal") {
        // Marks are carried by the motion of all frames that are known.
        let carrying = [range("Source", 3.0, 7.0), range("Motion", 3.0, 6.0)];
        assert!(
            effect.node.id == "ink" || needed(&instance, 5.0) == carrying,
            "{:?}",
            needed(&instance, 5.0)
        );
        instance.set("renewal", 0);
    }
    // Of the nearest neighbours the motion back is compared, too.
    assert_eq!(needed(&instance, 5.0), [range("Source", 3.0, 7.0), range("Motion", 4.0, 6.0)]);
    connect_vectors(&instance, "MotionForward", &vectors([0.0; 2], [0.0; 2]));
    let forward = range("MotionForward", 4.0, 6.0);
    assert_eq!(needed(&instance, 5.0), [range("Source", 3.0, 7.0), range("Motion", 4.0, 6.0), forward]);
    instance.set("motion_from", 2);
    assert_eq!(needed(&instance, 5.0), [range("Source", 3.0, 7.0)]);
    host.no_faults();
}

pub fn any_order_and_any_tile_gives_the_same_bits(binary: &Binary, effect: Expected) {
    if !effect.node.is_steady() {
        return;
    }
    let host = Host::new(Behaviour::default());
    let described = Described::new(&host, effect.plugin(binary));
    let name = |clip: &str| CString::new(format!("{ROI_PREFIX}{clip}")).unwrap();
    for context in [GENERAL, FILTER] {
        let instance = steadied(&described, context, 1);
        if context == GENERAL {
            connect_motion(&instance);
        }
        let frames: Vec<Vec<u8>> = (RANGE[0]..=RANGE[1]).map(|n| render(&instance, n).packed()).collect();
        let wanted = |time: i64| &frames[(time - RANGE[0]) as usize];
        for time in [8, 4, 4, 7, 3] {
            assert!(render(&instance, time).packed() == *wanted(time), "{} at {time}", effect.node.id);
        }
        let window = [17, 5, 40, 21];
        let regions = instance.regions_at(5.0, window.map(f64::from), 1.0).expect("regions");
        let tile = Wanted { time: 5.0, ..Wanted::new(window) };
        let crop = |pixels: &[f32], clip: &str| {
            let bounds = regions.numbers(&name(clip));
            film::picture(Layout::default(), pixels).crop([0, 1, 2, 3].map(|i| bounds[i].round() as i32))
        };
        let numbers = RANGE[0]..=RANGE[1];
        let source = numbers.clone().map(|n| crop(&film::frame(n), "Source")).collect();
        instance.connect_film("Source", RANGE[0] as i32, source);
        if context == GENERAL {
            let motion = vectors([-film::STEP[0], film::STEP[1]], [0.0, 1.0]);
            instance.connect_film(
                "Motion",
                RANGE[0] as i32,
                numbers.map(|_| crop(&motion, "Motion")).collect(),
            );
        }
        let (status, part) = instance.try_render(Layout::default(), SIZE, &tile);
        assert_eq!(status, kOfxStatOK);
        let whole = film::picture(Layout::default(), &floats(wanted(5)));
        assert!(part.crop(window).packed() == whole.crop(window).packed(), "{} {context:?}", effect.node.id);
    }
    host.no_faults();
}

pub fn frames_at_once_on_threads_are_the_same(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let described = Described::new(&host, binary.plugin("org.isophote.cartoon"));
    let instances: Vec<Instance<'_>> = (0..3).map(|_| steadied(&described, FILTER, 1)).collect();
    let alone: Vec<Vec<u8>> = (3..=6).map(|n| render(&instances[0], n).packed()).collect();
    std::thread::scope(|scope| {
        for (n, instance) in instances.iter().enumerate() {
            let alone = &alone;
            scope.spawn(move || {
                for turn in 0..4 {
                    let time = (3 * turn + n) % 4;
                    assert!(render(instance, 3 + time as i64).packed() == alone[time], "{time}");
                }
            });
        }
    });
    host.no_faults();
}

pub fn neighbours_are_given_back_before_the_next_is_taken(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let described = Described::new(&host, binary.plugin("org.isophote.cartoon"));
    for (context, own) in [(FILTER, 2), (GENERAL, 3)] {
        let instance = steadied(&described, context, 2);
        if context == GENERAL {
            connect_motion(&instance);
        }
        host.inner.most_lent.store(0, Ordering::SeqCst);
        render(&instance, 5);
        // The output, the source, vectors, and one of another frame.
        assert_eq!(host.inner.most_lent.load(Ordering::SeqCst), own + 1, "{context:?}");
        assert_eq!(host.inner.lent.load(Ordering::SeqCst), 0);
    }
    host.no_faults();
}

pub fn frames_may_cover_less_than_others(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let described = Described::new(&host, binary.plugin("org.isophote.steady"));
    let instance = steadied(&described, GENERAL, 1);
    connect_motion(&instance);
    let (columns, layout) = (24, Layout::default());
    let alone = floats(&still(&instance, 5));
    let frames = [4, 5, 6].map(|n| {
        let whole = film::picture(layout, &film::frame(n));
        let part = whole.crop([0, 0, columns, SIZE[1]]).packed();
        // A picture of its own, and no part of one.
        if n == 5 { whole } else { Picture::packed_in(layout, columns, SIZE[1], &part) }
    });
    instance.connect_film("Source", 4, frames.into());
    let got = floats(&render(&instance, 5).packed());
    let column = |at: usize| (at / 4) as i32 % SIZE[0];
    let apart = |columns: std::ops::Range<i32>| {
        let pairs = got.iter().zip(&alone).enumerate().filter(|(at, _)| columns.contains(&column(*at)));
        pairs.map(|(_, (a, b))| (a - b).abs()).fold(0.0, f32::max)
    };
    // Nothing is there where the others end.
    assert!(apart(columns + 8..SIZE[0]) < 1e-6, "{}", apart(columns + 8..SIZE[0]));
    assert!(apart(0..columns - 8) > 1e-4);
    host.no_faults();
}

pub fn fields_are_steadied_by_their_own_lines(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let described = Described::new(&host, binary.plugin("org.isophote.steady"));
    let instance = steadied(&described, FILTER, 1);
    let both = Layout { field: kOfxImageFieldBoth, ..Layout::default() };
    for (field, parity) in [(kOfxImageFieldLower, 0), (kOfxImageFieldUpper, 1)] {
        let render = |doubled: bool| {
            let frames = (4..=6).map(|n| {
                let picture = film::picture(both, &film::frame(n));
                let line = |y: i32| {
                    let other = if parity == 0 { y - 1 } else { y + 1 };
                    let from = if y % 2 == parity || !doubled { y } else { other };
                    picture.crop([0, from, SIZE[0], from + 1]).packed()
                };
                let lines: Vec<u8> = (0..SIZE[1]).rev().flat_map(line).collect();
                Picture::packed_in(both, SIZE[0], SIZE[1], &lines)
            });
            instance.connect_film("Source", 4, frames.collect());
            let wanted = Wanted { field, time: 5.0, ..Wanted::new([0, 0, SIZE[0], SIZE[1]]) };
            let (status, picture) = instance.try_render(both, SIZE, &wanted);
            assert_eq!(status, kOfxStatOK);
            picture.packed()
        };
        assert!(render(true) == render(false), "{field:?}");
    }
    host.no_faults();
}

pub fn frames_that_a_host_lacks_count_for_nothing(binary: &Binary) {
    let wanted = {
        let host = Host::new(Behaviour::default());
        let described = Described::new(&host, binary.plugin("org.isophote.oriented_bilateral"));
        let instance = steadied(&described, FILTER, 2);
        [3, 4, 5, 8].map(|time| render(&instance, time).packed())
    };
    let hidden = Behaviour { refused: vec![kOfxImageEffectPropFrameRange], ..Behaviour::default() };
    // What begins and ends the film shows when an image is asked for, in one way or the other.
    for behaviour in [Behaviour { null_images: true, ..hidden.clone() }, hidden] {
        let host = Host::new(behaviour);
        let described = Described::new(&host, binary.plugin("org.isophote.oriented_bilateral"));
        let instance = steadied(&described, FILTER, 2);
        for (time, wanted) in [3, 4, 5, 8].into_iter().zip(&wanted) {
            assert!(render(&instance, time).packed() == *wanted, "{time}");
        }
        assert_eq!(host.inner.lent.load(Ordering::SeqCst), 0);
        host.no_faults();
    }
}

pub fn frames_beyond_a_cut_count_for_nothing(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let described = Described::new(&host, binary.plugin("org.isophote.steady"));
    for context in [FILTER, GENERAL] {
        let instance = steadied(&described, context, 2);
        if context == GENERAL {
            // A renderer knows nothing of cuts.
            connect_motion(&instance);
        }
        let show = |first: i64| {
            let other = |n| {
                film::frame(n).chunks_exact(4).flat_map(|p| [1.0 - p[1], 0.2 * p[2], p[0], 1.0]).collect()
            };
            let frames = (first..=RANGE[1]).map(|n| if n < 6 { other(n) } else { film::frame(n) });
            let layout = Layout::default();
            let frames = frames.map(|pixels: Vec<f32>| film::picture(layout, &pixels)).collect();
            instance.connect_film("Source", first as i32, frames);
            floats(&render(&instance, 6).packed())
        };
        let (cut, begun) = (show(3), show(6));
        let apart = cut.iter().zip(&begun).map(|(a, b)| (a - b).abs()).sum::<f32>() / cut.len() as f32;
        println!("{context:?}: {apart} from the film that begins there");
        assert!(apart < 1e-3, "{context:?}: {apart}");
    }
    host.no_faults();
}

pub fn hosts_of_single_frames_show_stills_and_say_so_once(binary: &Binary) {
    let usual = Behaviour { temporal: false, ..Behaviour::default() };
    for (behaviour, when_created, when_edited) in [
        (usual.clone(), 1, 1),
        // Without messages that stay, nobody is told who has not just asked for it.
        (Behaviour { message_version: 1, ..usual.clone() }, 0, 1),
        (Behaviour { null_functions: true, ..usual.clone() }, 0, 0),
        (Behaviour { without: vec![kOfxMessageSuite], ..usual.clone() }, 0, 0),
        (Behaviour { name: c"DaVinciResolve", ..usual.clone() }, 0, 0),
        (Behaviour { refused: vec![kOfxImageEffectPropTemporalClipAccess], ..Behaviour::default() }, 1, 1),
        (Behaviour::default(), 0, 0),
    ] {
        // A host that does not say gives single frames.
        let says = behaviour.refused.is_empty();
        let temporal = behaviour.temporal && says;
        let host = Host::new(behaviour);
        let said = || host.inner.messages.lock().unwrap().len();
        let described = Described::new(&host, binary.plugin("org.isophote.cartoon"));
        let access = described.descriptor.set.int(kOfxImageEffectPropTemporalClipAccess);
        assert_eq!(access, says.then_some(temporal.into()));
        drop(described.saved_instance(FILTER, &[("steadiness", 0.5.into())]));
        let instance = steadied(&described, FILTER, 2);
        let told = said();
        for _ in 0..2 {
            instance.changed(kOfxTypeParameter, kOfxChangeUserEdited, 5.0);
            render(&instance, 5);
        }
        assert_eq!(said() - told, when_edited);
        for name in ["steadiness", "window"] {
            assert_eq!(instance.is_enabled(name), temporal, "{name}");
        }
        assert_eq!(instance.frames_needed(5.0).is_empty(), !temporal);
        assert_eq!(render(&instance, 5).packed() == still(&instance, 5), !temporal);
        instance.set("steadiness", 0.0);
        instance.changed(kOfxTypeParameter, kOfxChangeUserEdited, 5.0);
        drop(instance);
        let told = said();
        let saved = described.saved_instance(FILTER, &[("steadiness", 0.5.into())]);
        assert_eq!(said() - told, when_created);
        drop(saved);
        host.no_faults();
    }
}

pub fn hosts_that_call_every_clip_connected_are_estimated_for(binary: &Binary) {
    let behaviour =
        Behaviour { name: c"DaVinciResolve", all_connected: true, tiles: false, ..Behaviour::default() };
    let [usual, resolve] = [Behaviour::default(), behaviour].map(|behaviour| {
        let host = Host::new(behaviour);
        let described = Described::new(&host, binary.plugin("org.isophote.steady"));
        let instance = steadied(&described, GENERAL, 1);
        let all = instance.regions_at(5.0, [10.0, 10.0, 20.0, 20.0], 1.0).expect("regions");
        let region = all.numbers(&CString::new(format!("{ROI_PREFIX}Source")).unwrap());
        let frames = instance.frames_needed(5.0).into_iter().find(|(name, _)| name == "Source");
        let picture = render(&instance, 5).packed();
        host.no_faults();
        (region, frames, picture)
    });
    assert!(usual == resolve);
}
