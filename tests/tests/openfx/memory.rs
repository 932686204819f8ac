//! Memory: what an 8K frame of floats takes, by the plans that are rendered.

use super::reference::*;
use isophote::request::Guides;
use isophote::{ColourSpace, Planned, Request};
use isophote_abi::openfx::*;
use isophote_engine::plan::{LEAST_ROWS, WORKING_MEMORY};
use isophote_engine::{Rect, Support};
use isophote_tests::ofx::effect::{Described, Wanted};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::state::Behaviour;
use std::time::Instant;

const SIZE: [u32; 2] = [7680, 4320];
/// A frame of RGBA floats.
const FRAME: u64 = SIZE[0] as u64 * SIZE[1] as u64 * 16;
/// Most memory that the host's source and result, and the plugin's images, may take together.
const MOST: u64 = 4 << 30;

pub fn an_8k_frame_fits_into_4_gib(binary: &Binary, effect: Expected) {
    for over in [false, true] {
        if over && !effect.is_lines() {
            continue;
        }
        let request = Request {
            space: ColourSpace::Linear,
            premultiplied: true,
            guides: Guides { normal: true, depth: true, ..Guides::default() },
            ..Request::new(SIZE[0], SIZE[1])
        };
        let planned = Planned::new(&effect.graph(over), request).unwrap();
        let (plan, all) = (planned.plan(), Rect::of_size(SIZE[0], SIZE[1]));
        let rows = plan.band_rows(all, WORKING_MEMORY, LEAST_ROWS);
        let middle = (all.y1 - rows) / 2;
        let band = Rect { y0: middle, y1: middle + rows, ..all };
        // When it is computed, the result and the source are blended by the mask.
        let blended = 4 * FRAME * u64::from(band.height()) / u64::from(all.height());
        let bytes = 2 * FRAME + plan.peak_bytes(&plan.windows(band)).max(blended);
        let global = if plan.support() == Support::Global { "whole" } else { "bands" };
        let (id, gib) = (effect.plugin(binary).identifier(), bytes as f64 / (1_u64 << 30) as f64);
        println!("{id}: {gib:.2} GiB, {global} of {rows} rows, {:?}", plan.support());
        assert!(bytes <= MOST, "{gib:.2} GiB");
    }
}

/// The most bytes of this process that were in memory at once since the last call.
fn most_resident() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap_or_default();
    // Begins to count anew.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
    line.trim().trim_end_matches(" kB").parse::<u64>().map_or(0, |kib| kib << 10)
}

pub fn an_8k_frame_is_rendered_in_4_gib(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let [width, height] = SIZE.map(|n| n as i32);
    let instance = Described::new(&host, effect.plugin(binary)).instance(kOfxImageEffectContextFilter);
    plain(&instance);
    {
        let row: Vec<u8> = (0..width * 4)
            .flat_map(|i| (if i % 4 == 3 { 1.0 } else { 0.5 + 0.4 * (i as f32 * 0.003).sin() }).to_ne_bytes())
            .collect();
        let mut source = Picture::new(layout, width, height);
        for y in 0..height {
            source.fill_row(y, &row);
        }
        instance.connect("Source", source);
    }
    instance.connect("Output", Picture::new(layout, width, height));
    most_resident();
    let started = Instant::now();
    let status = instance.render_connected(&Wanted::new([0, 0, width, height]));
    assert_eq!(status, kOfxStatOK);
    let (bytes, id) = (most_resident(), effect.plugin(binary).identifier());
    let gib = bytes as f64 / (1_u64 << 30) as f64;
    println!("{id}: {gib:.2} GiB in memory at most, {:.0} s", started.elapsed().as_secs_f64());
    assert!(bytes <= MOST, "{id} takes {gib:.2} GiB");
}
