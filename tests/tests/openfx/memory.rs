//! Memory: what an 8K frame of floats takes, by the plans that are rendered.

use crate::reference::*;
use isophote::request::Guides;
use isophote::{ColourSpace, Planned, Request};
use isophote_engine::{Rect, Support};

const SIZE: [u32; 2] = [7680, 4320];
/// A frame of RGBA floats.
const FRAME: u64 = SIZE[0] as u64 * SIZE[1] as u64 * 16;
/// What the host's source and result, and the plugin's images, may take together.
const MOST: u64 = 4 << 30;
/// What the plugin lets the images of a band take, and the least rows of one.
const WORKING_MEMORY: [u64; 2] = [768 << 20, 3000 << 20];
const LEAST_ROWS: i32 = 64;

#[test]
fn an_8k_frame_fits_into_4_gib() {
    let mut large = Vec::new();
    for effect in expected() {
        for over in [false, true] {
            if over && !effect.is_lines() {
                continue;
            }
            let request = Request {
                space: ColourSpace::Linear,
                premultiplied: true,
                guides: Guides { normal: true, depth: true, object_id: false },
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
            let (id, gib) = (effect.plugin.identifier(), bytes as f64 / (1_u64 << 30) as f64);
            println!("{id}: {gib:.2} GiB, {global} of {rows} rows, {:?}", plan.support());
            if bytes > MOST {
                large.push(format!("{id} {gib:.2} GiB"));
            }
        }
    }
    assert!(large.is_empty(), "{}", large.join(", "));
}
