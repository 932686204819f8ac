//! Tiles against full frames, and regions of interest against the plan's support.

use super::reference::*;
use isophote::{Planned, Request};
use isophote_abi::openfx::*;
use isophote_engine::Rect;
use isophote_tests::ofx::effect::{Described, Wanted};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::properties::Value;
use isophote_tests::ofx::state::Behaviour;
use std::ffi::CString;

const SIZE: [i32; 2] = [97, 71];

fn source(layout: Layout) -> Picture {
    Picture::packed_in(layout, SIZE[0], SIZE[1], &packed(&scene(SIZE[0], SIZE[1], false), &layout))
}

pub fn tiles_from_their_regions_of_interest_equal_the_full_frame(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let name = CString::new(format!("{ROI_PREFIX}Source")).unwrap();
    let described = Described::new(&host, effect.plugin(binary));
    let declared = described.descriptor.set.int(kOfxImageEffectPropSupportsTiles).unwrap();
    // Far from every border of a large picture, a pixel needs no border.
    let planned = Planned::new(&effect.graph(false), Request::new(8192, 8192)).unwrap();
    let windows = planned.plan().windows(Rect { x0: 4096, y0: 4096, x1: 4097, y1: 4097 });
    let inputs = || planned.plan().inputs().iter().map(|port| windows[port.image.index()]);
    let local = inputs().all(|w| w.x0 > 0 && w.y0 > 0 && w.x1 < 8192 && w.y1 < 8192);
    // Effects that look at other frames by themselves estimate motion in whole pictures.
    let alone = effect.graph(false).frames() == [0, 0];
    assert_eq!(declared, i32::from(local && alone), "{}", effect.plugin(binary).identifier());
    for (origin, aspect) in [([0, 0], 1.0), ([-13, 7], 1.0667), ([4, -3], 2.0)] {
        let layout = Layout { origin, aspect, padding: 6, ..Layout::default() };
        let instance = described.instance(kOfxImageEffectContextFilter);
        plain(&instance);
        let source = source(layout);
        instance.connect("Source", source.clone());
        let full = instance.render(layout, SIZE);
        let [x, y] = origin;
        for window in [[0, 0, 31, 20], [31, 20, 64, 71], [40, 33, 41, 34], [90, 60, 97, 71]] {
            let window = [window[0] + x, window[1] + y, window[2] + x, window[3] + y];
            let [x1, y1, x2, y2] = window.map(f64::from);
            let roi = instance.regions([x1 * aspect, y1, x2 * aspect, y2], 1.0).expect("a region");
            let roi = roi.numbers(&name);
            let pixels = [roi[0] / aspect, roi[1], roi[2] / aspect, roi[3]].map(|v| v.round() as i32);
            let region = Rect {
                x0: window[0] - x,
                x1: window[2] - x,
                y0: SIZE[1] - (window[3] - y),
                y1: SIZE[1] - (window[1] - y),
            };
            let needed = needed(&effect, region, aspect);
            let wanted = [needed.x0 + x, SIZE[1] - needed.y1 + y, needed.x1 + x, SIZE[1] - needed.y0 + y];
            assert!(is_enough(pixels, wanted, window), "{wanted:?}: {pixels:?}");
            instance.connect("Source", source.crop(pixels));
            let (status, tile) = instance.try_render(layout, SIZE, &Wanted::new(window));
            assert_eq!(status, kOfxStatOK);
            let worst = difference(&tile.crop(window).packed(), &full.crop(window).packed(), &layout);
            assert_eq!(worst, 0.0, "{} at {window:?}", effect.plugin(binary).identifier());
            instance.connect("Source", source.clone());
        }
    }
    host.no_faults();
}

/// True for a region that holds all that is needed of the picture for a window. Drafts, which hosts do not announce, look at
/// pixels twice as large, and may need twice as much around it.
fn is_enough(region: [i32; 4], needed: [i32; 4], window: [i32; 4]) -> bool {
    (0..4).all(|side| {
        let sign = if side < 2 { -1 } else { 1 };
        let around = (needed[side] - window[side]) * sign;
        (0..=around + 8).contains(&((region[side] - needed[side]) * sign))
    })
}

pub fn a_host_without_tiles_may_give_parts_all_the_same(binary: &Binary) {
    let host = Host::new(Behaviour { tiles: false, ..Behaviour::default() });
    let layout = Layout::default();
    let name = CString::new(format!("{ROI_PREFIX}Source")).unwrap();
    let instance =
        Described::new(&host, binary.plugin("org.isophote.gaussian")).instance(kOfxImageEffectContextFilter);
    plain(&instance);
    let source = source(layout);
    instance.connect("Source", source.clone());
    let full = instance.render(layout, SIZE);
    let window = [40, 20, 56, 31];
    let roi = instance.regions(window.map(f64::from), 1.0).expect("a region").numbers(&name);
    let pixels = [0, 1, 2, 3].map(|i| roi[i] as i32);
    assert!(pixels[0] > 0 && pixels[2] < SIZE[0], "{pixels:?} is no part");
    // The region of definition stays that of the whole.
    instance.connect("Source", source.crop(pixels));
    let (status, tile) = instance.try_render(layout, SIZE, &Wanted::new(window));
    assert_eq!(status, kOfxStatOK);
    assert!(tile.crop(window).packed() == full.crop(window).packed());
    host.no_faults();
}

/// A part of a picture that has no end.
fn plane(layout: Layout, [x1, y1, x2, y2]: [i32; 4]) -> Picture {
    let pixel = |x: i32, y: i32| {
        let grain = (x * 7919 + y * 104_729).rem_euclid(97) as f32 / 970.0;
        let waves = [0.5 + 0.3 * (x as f32 * 0.21).sin(), 0.5 + 0.3 * ((x + y) as f32 * 0.13).cos()];
        let disc = (x.rem_euclid(60) - 30).pow(2) + (y.rem_euclid(50) - 25).pow(2) < 300;
        [waves[0], if disc { 0.9 } else { waves[1] }, 0.3 + grain, 1.0]
    };
    let rgba: Vec<f32> = (y1..y2).rev().flat_map(|y| (x1..x2).flat_map(move |x| pixel(x, y))).collect();
    let layout = Layout { origin: [x1, y1], ..layout };
    Picture::packed_in(layout, x2 - x1, y2 - y1, &packed(&rgba, &layout))
}

pub fn a_source_without_bounds_has_no_seams(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let name = CString::new(format!("{ROI_PREFIX}Source")).unwrap();
    let described = Described::new(&host, effect.plugin(binary));
    let local = described.descriptor.set.int(kOfxImageEffectPropSupportsTiles).unwrap() != 0;
    let instance = described.instance(kOfxImageEffectContextFilter);
    plain(&instance);
    let extent = SIZE.map(f64::from);
    instance.effect.set.put(kOfxImageEffectPropProjectExtent, extent.map(Value::from).to_vec());
    for (endless, aspect) in [(f64::from(i32::MAX), 1.0), (f64::INFINITY, 2.0)] {
        let layout = Layout { endless: Some(endless), aspect, ..Layout::default() };
        let render = |window: [i32; 4]| {
            instance.connect("Source", plane(layout, window));
            let [x1, y1, x2, y2] = window.map(f64::from);
            let roi = instance.regions([x1 * aspect, y1, x2 * aspect, y2], 1.0).expect("a region");
            let roi = roi.numbers(&name);
            let [x1, y1, x2, y2] =
                [roi[0] / aspect, roi[1], roi[2] / aspect, roi[3]].map(|v| v.round() as i32);
            if local {
                assert!(x1 < window[0] && y1 < window[1] && x2 > window[2] && y2 > window[3], "{roi:?}");
            }
            instance.connect("Source", plane(layout, [x1, y1, x2, y2]));
            let (status, picture) = instance.try_render(layout, SIZE, &Wanted::new(window));
            assert_eq!(status, kOfxStatOK);
            picture
        };
        let width = if local { SIZE[0] } else { (extent[0] / aspect).ceil() as i32 };
        let full = render([0, 0, width, SIZE[1]]);
        for window in [[0, 0, 31, 20], [31, 20, width.min(64), SIZE[1]]] {
            let tile = render(window);
            assert!(
                tile.crop(window).packed() == full.crop(window).packed(),
                "{} at {window:?}, {aspect}",
                effect.plugin(binary).identifier()
            );
        }
        // The result has no end either, unless the effect needs one.
        let (args, answer) = (instance.args(), instance.args());
        args.put(kOfxPropTime, vec![0.0.into()]);
        let status = instance.act(kOfxImageEffectActionGetRegionOfDefinition, Some(&args), Some(&answer));
        assert_eq!(status, kOfxStatOK);
        let wanted =
            if local { [-endless, -endless, endless, endless] } else { [0.0, 0.0, extent[0], extent[1]] };
        assert_eq!(answer.numbers(kOfxImageEffectPropRegionOfDefinition), wanted);
    }
    host.no_faults();
}

/// Grain and grid of a bounding box are those of the project, wherever the box stands.
pub fn a_bounding_box_shows_the_marks_of_the_project(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let (project, [x1, y1, x2, y2]) = ([150, 120], [26, 14, 130, 106]);
    let grey = |[x1, y1, x2, y2]: [i32; 4]| {
        let layout = Layout { origin: [x1, y1], ..Layout::default() };
        let pixels = (0..(x2 - x1) * (y2 - y1)).flat_map(|_| [0.5_f32, 0.45, 0.4, 1.0]);
        let bytes: Vec<u8> = pixels.flat_map(f32::to_ne_bytes).collect();
        (layout, Picture::packed_in(layout, x2 - x1, y2 - y1, &bytes))
    };
    for node in ["blueprint", "watercolor"] {
        let plugin = binary.plugin(&format!("org.isophote.{node}"));
        let instance = Described::new(&host, plugin).instance(kOfxImageEffectContextFilter);
        let extent = project.map(|side| Value::from(f64::from(side)));
        instance.effect.set.put(kOfxImageEffectPropProjectExtent, extent.to_vec());
        let render = |bounds: [i32; 4]| {
            let (layout, picture) = grey(bounds);
            instance.connect("Source", picture);
            instance.render(layout, [bounds[2] - bounds[0], bounds[3] - bounds[1]])
        };
        let (whole, part) = (render([0, 0, project[0], project[1]]), render([x1, y1, x2, y2]));
        let inner = [x1 + 36, y1 + 36, x2 - 36, y2 - 36];
        assert!(whole.crop(inner).packed() == part.crop(inner).packed(), "{node}");
    }
    host.no_faults();
}

/// Region that the plan says that a region needs, in rows from the top. Pixels that are wider than high are made
/// square, each from those that it touches and one more on each side, before the plan and after it.
fn needed(effect: &Expected, region: Rect, aspect: f64) -> Rect {
    let touched = |[x0, x1]: [i32; 2], factor: f64, most: i32| {
        if aspect == 1.0 {
            return [x0, x1];
        }
        let [first, end] = [f64::from(x0) * factor, f64::from(x1) * factor];
        [((first + 1e-6).floor() as i32 - 1).max(0), ((end - 1e-6).ceil() as i32 + 1).min(most)]
    };
    let width = (f64::from(SIZE[0]) * aspect - 0.01).ceil() as i32;
    let planned = Planned::new(&effect.graph(false), Request::new(width as u32, SIZE[1] as u32)).unwrap();
    let [x0, x1] = touched([region.x0, region.x1], aspect, width);
    let windows = planned.plan().windows(Rect { x0, x1, ..region });
    let port = planned.plan().inputs().iter().find(|p| p.name == "color").unwrap();
    let window = windows[port.image.index()];
    let [x0, x1] = touched([window.x0, window.x1], 1.0 / aspect, SIZE[0]);
    Rect { x0, x1, ..window }.union(&region)
}

pub fn the_mask_is_needed_where_it_is_used_and_the_result_covers_the_source(
    binary: &Binary,
    effect: Expected,
) {
    let host = Host::new(Behaviour::default());
    let layout = Layout { origin: [5, -9], ..Layout::default() };
    let instance = Described::new(&host, effect.plugin(binary)).instance(kOfxImageEffectContextGeneral);
    instance.connect("Source", source(layout));
    instance.connect("Mask", source(layout));
    let regions = instance.regions([20.0, 10.0, 30.0, 20.0], 1.0).expect("regions");
    let mask = CString::new(format!("{ROI_PREFIX}Mask")).unwrap();
    assert_eq!(regions.numbers(&mask), [20.0, 10.0, 30.0, 20.0]);
    let (args, answer) = (instance.args(), instance.args());
    args.put(kOfxPropTime, vec![0.0.into()]);
    let status = instance.act(kOfxImageEffectActionGetRegionOfDefinition, Some(&args), Some(&answer));
    assert_eq!(status, kOfxStatOK);
    assert_eq!(answer.numbers(kOfxImageEffectPropRegionOfDefinition), [5.0, -9.0, 102.0, 62.0]);
    let answer = instance.args();
    let status = instance.act(kOfxImageEffectActionGetClipPreferences, None, Some(&answer));
    assert_eq!(status, kOfxStatOK);
    let state = answer.text(kOfxImageEffectPropPreMultiplication).unwrap();
    assert_eq!(state, "OfxImageAlphaPremultiplied");
    host.no_faults();
}

pub fn regions_shrink_with_the_scale(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let name = CString::new(format!("{ROI_PREFIX}Source")).unwrap();
    let instance =
        Described::new(&host, binary.plugin("org.isophote.gaussian")).instance(kOfxImageEffectContextFilter);
    instance.set("sigma", 4.0);
    let halo = |scale: f64| {
        instance.connect("Source", source(Layout { scale, ..Layout::default() }));
        let at = 40.0 / scale;
        let roi = instance.regions([at, at, at + 4.0, at + 4.0], scale).expect("a region").numbers(&name);
        // Canonical units: nearly the same at every scale, since they are those of the full picture.
        at - roi[0]
    };
    let (full, half) = (halo(1.0), halo(0.5));
    assert!(full >= 12.0 && (half - full).abs() <= 3.0, "{full} {half}");
}
