//! Hosts as they are: memory in every layout, missing properties and functions, forgotten scales, fields.

use super::reference::*;
use isophote_abi::openfx::*;
use isophote_tests::ofx::effect::{Described, Wanted};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::state::Behaviour;
use std::sync::atomic::Ordering;

const SIZE: [i32; 2] = [WIDTH, HEIGHT];

pub fn rows_may_run_downwards_be_padded_and_begin_anywhere(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let instance = Described::new(&host, effect.plugin(binary)).instance(kOfxImageEffectContextFilter);
    plain(&instance);
    for depth in [kOfxBitDepthFloat, kOfxBitDepthByte] {
        let usual = Layout { depth, ..Layout::default() };
        let render = |layout: Layout| {
            instance.connect("Source", source(layout, false));
            instance.render(layout, SIZE).packed()
        };
        let wanted = render(usual);
        for layout in [
            Layout { negative: true, ..usual },
            // Rows at addresses that no float may have.
            Layout { padding: 7, ..usual },
            Layout { origin: [-31, 17], negative: true, padding: 3, ..usual },
            Layout { blue_first: true, ..usual },
        ] {
            // Marks belong to the project: a picture that begins elsewhere shows others.
            let there = render(Layout { origin: layout.origin, ..usual });
            assert!(render(layout) == there, "{} {layout:?}", effect.plugin(binary).identifier());
            // Input and output need not be alike.
            instance.connect("Source", source(usual, false));
            let mixed = Layout { origin: [0, 0], ..layout };
            assert!(instance.render(mixed, SIZE).packed() == wanted);
        }
    }
    host.no_faults();
}

pub fn hosts_that_lack_what_can_be_lacked_get_their_pictures(binary: &Binary, effect: Expected) {
    let layout = Layout { alpha: None, ..Layout::default() };
    let render = |behaviour: Behaviour| {
        let host = Host::new(behaviour);
        let picture = {
            let described = Described::new(&host, effect.plugin(binary));
            let instance = described.instance(kOfxImageEffectContextGeneral);
            instance.set("working_space", 1);
            instance.connect("Source", source(layout, true));
            instance.render(layout, SIZE).packed()
        };
        assert_eq!(host.inner.lent.load(Ordering::SeqCst), 0);
        host.no_faults();
        picture
    };
    let wanted = render(Behaviour::default());
    let hosts = [
        Behaviour { bare: true, ..Behaviour::default() },
        Behaviour { refuses_optional: true, ..Behaviour::default() },
        Behaviour { null_functions: true, ..Behaviour::default() },
        Behaviour { strings_die: true, ..Behaviour::default() },
        Behaviour { tiles: false, half: false, ..Behaviour::default() },
        // Every clip is connected, and those without a picture give none.
        Behaviour { name: c"DaVinciResolve", all_connected: true, tiles: false, ..Behaviour::default() },
        Behaviour { without: vec![kOfxMultiThreadSuite, kOfxMessageSuite], ..Behaviour::default() },
    ];
    for behaviour in hosts {
        let shown = format!("{behaviour:?}");
        assert!(render(behaviour) == wanted, "{shown}");
    }
}

pub fn a_scale_counts_wherever_the_host_says_it(binary: &Binary) {
    let identifier = "org.isophote.gaussian";
    let picture = |layout| {
        let packed = packed(&scene(WIDTH, HEIGHT, true), &layout);
        Picture::packed_in(layout, WIDTH, HEIGHT, &packed)
    };
    // Scale of the arguments, of the regions and of the image.
    let render = |tiles, scale: f64, regions: f64, claimed_scale: f64| {
        let host = Host::new(Behaviour { tiles, ..Behaviour::default() });
        let instance =
            Described::new(&host, binary.plugin(identifier)).instance(kOfxImageEffectContextFilter);
        let layout = Layout { scale: regions, claimed_scale, ..Layout::default() };
        instance.set("sigma", 4.0);
        instance.connect("Source", picture(layout));
        let wanted = Wanted { scale, ..Wanted::new([0, 0, WIDTH, HEIGHT]) };
        let (status, picture) = instance.try_render(layout, SIZE, &wanted);
        assert_eq!(status, kOfxStatOK);
        host.no_faults();
        values(&picture.packed(), &layout)
    };
    let apart = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    let quarter = render(true, 0.25, 0.25, 0.25);
    assert!(apart(&quarter, &render(true, 1.0, 1.0, 1.0)) > 0.05);
    // Images that say 1, an inverse, and regions that are those of the proxy.
    for (tiles, scale, regions, claimed) in
        [(true, 0.25, 0.25, 1.0), (false, 0.25, 0.25, 4.0), (false, 0.25, 1.0, 1.0), (false, 1.0, 0.25, 1.0)]
    {
        let got = render(tiles, scale, regions, claimed);
        assert!(
            apart(&got, &quarter) < 2e-2,
            "{tiles} {scale} {regions} {claimed}: {}",
            apart(&got, &quarter)
        );
    }
}

pub fn fields_are_rendered_from_their_own_lines(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let instance = Described::new(&host, effect.plugin(binary)).instance(kOfxImageEffectContextFilter);
    plain(&instance);
    let both = Layout { field: kOfxImageFieldBoth, ..Layout::default() };
    let rows: Vec<Vec<f32>> =
        scene(WIDTH, HEIGHT, true).chunks_exact(WIDTH as usize * 4).map(<[f32]>::to_vec).collect();
    for (field, parity) in [(kOfxImageFieldLower, 0), (kOfxImageFieldUpper, 1)] {
        // Rows count from the bottom; a line of the other field repeats one of this.
        let doubled: Vec<f32> = (0..HEIGHT)
            .flat_map(|row| {
                let up = HEIGHT - 1 - row;
                let line = if up % 2 == parity {
                    up
                } else if parity == 0 {
                    up - 1
                } else {
                    up + 1
                };
                let line = if line >= HEIGHT { up - 1 } else { line };
                rows[(HEIGHT - 1 - line) as usize].clone()
            })
            .collect();
        instance.connect("Source", Picture::packed_in(both, WIDTH, HEIGHT, &packed(&doubled, &both)));
        let whole = instance.render(both, SIZE);
        let wanted = Wanted { field, ..Wanted::new([0, 0, WIDTH, HEIGHT]) };
        // An interlaced picture and one of doubled lines come out alike.
        for lines in [rows.concat(), doubled] {
            instance.connect("Source", Picture::packed_in(both, WIDTH, HEIGHT, &packed(&lines, &both)));
            let (status, got) = instance.try_render(both, SIZE, &wanted);
            assert_eq!(status, kOfxStatOK);
            for y in 0..HEIGHT {
                let row = [0, y, WIDTH, y + 1];
                if y % 2 == parity {
                    assert!(
                        got.crop(row).packed() == whole.crop(row).packed(),
                        "{}",
                        effect.plugin(binary).identifier()
                    );
                } else {
                    assert!(got.crop(row).packed().iter().all(|b| *b == 0xa5), "a row of the other field");
                }
            }
        }
    }
    host.no_faults();
}
