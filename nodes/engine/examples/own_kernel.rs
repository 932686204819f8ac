//! A kernel of its own, run on the CPU: the mean of a pixel and its neighbours to the left and the right. Its shader would run
//! on a GPU from the same plan.

use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::kernel::Fusible;
use isophote_engine::wgsl::{Piece, Pieces};
use isophote_engine::{Band, Class, CpuPass, Image, Kernel, PlanBuilder, Rect, Support, Tolerance};

/// The block `grid` says where the textures of a pass lie in the picture, of which they may be a tile.
const SHADER: &str = "
struct Grid { origin: vec2i, size: vec2i, full: vec2i, halo: vec2i, inputs: array<vec4i, 6> }
@group(0) @binding(0) var<uniform> grid: Grid;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var result: texture_storage_2d<r32float, write>;

fn at(p: vec2i) -> vec4f {
    let place = grid.inputs[0];
    return textureLoad(source, clamp(p, vec2i(0), place.zw - 1) - place.xy, 0);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if any(vec2i(id.xy) >= grid.size) { return; }
    let p = grid.origin + vec2i(id.xy);
    let sum = at(p - vec2i(1, 0)) + at(p) + at(p + vec2i(1, 0));
    textureStore(result, id.xy, sum / 3.0);
}";

const EXACT: Tolerance = Tolerance::of_rounding(1e-6, 1e-6, "three sums");

static MEAN: Kernel = Kernel {
    name: "mean",
    shader: SHADER,
    inputs: 1,
    outputs: &[1],
    params_size: 0,
    pieces: Pieces { own: &[Piece::Text(SHADER)], ..Pieces::NONE },
    fusible: Fusible::Never,
    cpu: mean,
    cost: |_| 3.0,
    tolerance: EXACT,
    fast: EXACT.rounded_to_half(),
};

fn mean(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let (window, source) = (band.window, pass.inputs[0]);
    for y in window.y0..window.y1 {
        for (x, out) in (window.x0..window.x1).zip(band.row_mut(0, y)) {
            *out = (source.pixel1(x - 1, y) + source.pixel1(x, y) + source.pixel1(x + 1, y)) / 3.0;
        }
    }
}

fn main() -> isophote_engine::Result<()> {
    let mut builder = PlanBuilder::new(8, 1)?;
    let source = builder.input("source", 1, Class::Field);
    let soft = builder.pass(&MEAN, &[source], &(), Class::Field, Support::Pixels(1));
    builder.output("soft", soft);
    let plan = builder.finish()?;

    let step = Image::from_vec(8, 1, 1, vec![0.0, 0.0, 0.0, 0.0, 3.0, 3.0, 3.0, 3.0])?;
    let all = Rect::of_size(8, 1);
    let results =
        CpuExecutor::new().run(&plan, &[("source", &step)], all, &CallingThread, Control::default())?;
    println!("{:?}", results[0].data());
    Ok(())
}
