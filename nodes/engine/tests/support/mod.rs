//! Small kernels, each as WGSL and as a CPU function, and plans of them.

use isophote_engine::kernel::Fusible;
use isophote_engine::wgsl::{Import, Piece, Pieces};
use isophote_engine::{Band, Class, CpuPass, Image, ImageId, Kernel, Plan, PlanBuilder, Support, Tolerance};
use std::sync::LazyLock;

/// The texts of pieces as one, each written as the piece's case and its text.
macro_rules! joined {
    ($($case:ident $text:literal)*) => { concat!($($text),*) };
}

/// Pieces of that text.
macro_rules! pieces {
    (@ Text $text:literal) => { Piece::Text($text) };
    (@ Name $text:literal) => { Piece::Name($text) };
    (@ Binding $text:literal) => { Piece::Binding($text) };
    (@ Format $text:literal) => { Piece::Format { output: 0, exact: $text } };
    (@ Slot $input:literal) => { Piece::Slot($input) };
    (@ $case:ident $text:literal) => { Piece::$case };
    ($($case:ident $text:literal)*) => { &[$(pieces!(@ $case $text)),*] };
}

/// Import of where textures lie in the picture.
pub static GRID: Import = Import {
    name: "gpu/grid",
    text: &[Piece::Text(include_str!("../../../../shaders/gpu/grid.wgsl"))],
    filtered: None,
    packed: None,
};

const EXACT: Tolerance = Tolerance::of_rounding(1e-5, 1e-5, "few sums");

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct BoxParams {
    pub radius: i32,
    pub gain: f32,
}

macro_rules! box_text {
    ($form:ident) => {
        $form! {
            Text "
struct Params { radius: i32, gain: f32 }
@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var result: texture_storage_2d<"
            Format "rgba32float"
            Text ", write>;
@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) { return; }
    var sum = vec4f(0.0);
    for (var y = -params.radius; y <= params.radius; y++) {
        for (var x = -params.radius; x <= params.radius; x++) {
            sum += fetch(source, 0, pixel(id) + vec2i(x, y));
        }
    }
    let side = f32(2 * params.radius + 1);
    textureStore(result, id.xy, sum / (side * side) * params.gain);
}"
        }
    };
}

/// Mean over a square, times a gain.
pub static BOX: Kernel = Kernel {
    name: "box",
    shader: concat!(include_str!("../../../../shaders/gpu/grid.wgsl"), box_text!(joined)),
    inputs: 1,
    outputs: &[4],
    params_size: size_of::<BoxParams>(),
    pieces: Pieces { imports: &[&GRID], own: box_text!(pieces), ..Pieces::NONE },
    fusible: Fusible::Never,
    cpu: box_cpu,
    cost: |_| 1.0,
    tolerance: EXACT,
    fast: EXACT.rounded_to_half(),
};

fn box_cpu(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let p: BoxParams = pass.params();
    let window = band.window;
    let side = (2 * p.radius + 1) as f32;
    for y in window.y0..window.y1 {
        let row = band.row_mut(0, y);
        for (x, out) in (window.x0..window.x1).zip(row.chunks_exact_mut(4)) {
            let mut sum = [0.0; 4];
            for dy in -p.radius..=p.radius {
                for dx in -p.radius..=p.radius {
                    let tap = pass.inputs[0].pixel4(x + dx, y + dy);
                    (0..4).for_each(|c| sum[c] += tap[c]);
                }
            }
            (0..4).for_each(|c| out[c] = sum[c] / (side * side) * p.gain);
        }
    }
}

const SPLIT_TEXT: &str = concat!(
    include_str!("../../../../shaders/gpu/grid.wgsl"),
    "
        @group(0) @binding(2) var source: texture_2d<f32>;
        @group(0) @binding(3) var brightness: texture_storage_2d<r32float, write>;
        @group(0) @binding(4) var position: texture_storage_2d<rg32float, write>;
        @compute @workgroup_size(8, 8)
        fn main(@builtin(global_invocation_id) id: vec3u) {
            if outside(id) { return; }
            let c = fetch(source, 0, pixel(id));
            textureStore(brightness, id.xy, vec4f(c.x + c.y + c.z));
            textureStore(position, id.xy, vec4f(centre(id), 0.0, 0.0));
        }"
);

/// Without a uniform block: one channel of brightness, and two with the pixel's position.
pub static SPLIT: Kernel = Kernel {
    name: "split",
    shader: SPLIT_TEXT,
    inputs: 1,
    outputs: &[1, 2],
    params_size: 0,
    pieces: Pieces { own: &[Piece::Text(SPLIT_TEXT)], ..Pieces::NONE },
    fusible: Fusible::Never,
    cpu: split_cpu,
    cost: |_| 1.0,
    tolerance: EXACT,
    fast: EXACT.rounded_to_half(),
};

fn split_cpu(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let window = band.window;
    let view = pass.inputs[0];
    for y in window.y0..window.y1 {
        for x in window.x0..window.x1 {
            let c = &view.data()[view.offset(x, y)..][..3];
            let column = (x - window.x0) as usize;
            band.row_mut(0, y)[column] = c[0] + c[1] + c[2];
            band.row_mut(1, y)[2 * column..][..2].copy_from_slice(&[x as f32 + 0.5, y as f32 + 0.5]);
        }
    }
}

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct JoinParams {
    pub scale: f32,
}

const JOIN_TEXT: &str = concat!(
    include_str!("../../../../shaders/gpu/grid.wgsl"),
    "
        struct Params { scale: f32 }
        @group(0) @binding(1) var<uniform> params: Params;
        @group(0) @binding(2) var brightness: texture_2d<f32>;
        @group(0) @binding(3) var position: texture_2d<f32>;
        @group(0) @binding(4) var result: texture_storage_2d<rgba32float, write>;
        @compute @workgroup_size(8, 8)
        fn main(@builtin(global_invocation_id) id: vec3u) {
            if outside(id) { return; }
            let b = fetch(brightness, 0, pixel(id) + vec2i(1, 0)).x;
            let p = fetch(position, 1, pixel(id)).xy;
            textureStore(result, id.xy, vec4f(b, p * params.scale, 0.0));
        }"
);

/// A colour of three channels from those two images.
pub static JOIN: Kernel = Kernel {
    name: "join",
    shader: JOIN_TEXT,
    inputs: 2,
    outputs: &[3],
    params_size: size_of::<JoinParams>(),
    pieces: Pieces { own: &[Piece::Text(JOIN_TEXT)], ..Pieces::NONE },
    fusible: Fusible::Never,
    cpu: join_cpu,
    cost: |_| 1.0,
    tolerance: EXACT,
    fast: EXACT.rounded_to_half(),
};

fn join_cpu(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let p: JoinParams = pass.params();
    let window = band.window;
    let [brightness, position] = pass.inputs else { return };
    for y in window.y0..window.y1 {
        let row = band.row_mut(0, y);
        for (x, out) in (window.x0..window.x1).zip(row.chunks_exact_mut(3)) {
            let place = &position.data()[position.offset(x, y)..][..2];
            out.copy_from_slice(&[brightness.pixel1(x + 1, y), place[0] * p.scale, place[1] * p.scale]);
        }
    }
}

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct ShiftParams {
    pub by: [f32; 2],
    /// Pixels of the input's level per pixel of the output's.
    pub scale: f32,
    pub pad: f32,
}

/// A bilinear sample at another place, or at another pyramid level.
pub static SHIFT: LazyLock<Kernel> = LazyLock::new(|| {
    let shared = [
        include_str!("../../../../shaders/gpu/grid.wgsl"),
        include_str!("../../../../shaders/shared/sampling.wgsl"),
    ];
    let shader = format!(
        "{}{}
        struct Params {{ by: vec2f, scale: f32, pad: f32 }}
        @group(0) @binding(1) var<uniform> params: Params;
        @group(0) @binding(2) var source: texture_2d<f32>;
        @group(0) @binding(3) var result: texture_storage_2d<rgba32float, write>;
        @compute @workgroup_size(8, 8)
        fn main(@builtin(global_invocation_id) id: vec3u) {{
            if outside(id) {{ return; }}
            textureStore(result, id.xy, sample_linear(source, 0, centre(id) * params.scale + params.by));
        }}",
        shared[0],
        shared[1].replace("#import gpu/grid", "")
    );
    let shader: &'static str = shader.leak();
    Kernel {
        name: "shift",
        shader,
        inputs: 1,
        outputs: &[4],
        params_size: size_of::<ShiftParams>(),
        pieces: Pieces { own: vec![Piece::Text(shader)].leak(), ..Pieces::NONE },
        fusible: Fusible::Never,
        cpu: shift_cpu,
        cost: |_| 1.0,
        tolerance: EXACT,
        fast: EXACT.rounded_to_half(),
    }
});

fn shift_cpu(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let p: ShiftParams = pass.params();
    let window = band.window;
    let source = &pass.inputs[0];
    for y in window.y0..window.y1 {
        let row = band.row_mut(0, y);
        for (x, out) in (window.x0..window.x1).zip(row.chunks_exact_mut(4)) {
            let at = |i: i32, axis: usize| (i as f32 + 0.5) * p.scale + p.by[axis] - 0.5;
            let (u, v) = (at(x, 0), at(y, 1));
            let (i, j) = (u.floor(), v.floor());
            let [a, b, c, d] =
                [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| source.pixel4(i as i32 + dx, j as i32 + dy));
            for channel in 0..4 {
                let top = a[channel] + (b[channel] - a[channel]) * (u - i);
                let bottom = c[channel] + (d[channel] - c[channel]) * (u - i);
                out[channel] = top + (bottom - top) * (v - j);
            }
        }
    }
}

pub fn box_blur(b: &mut PlanBuilder, source: ImageId, radius: i32, gain: f32) -> ImageId {
    b.pass(&BOX, &[source], &BoxParams { radius, gain }, Class::Colour, Support::Pixels(radius as u32))
}

pub fn shift(b: &mut PlanBuilder, source: ImageId, by: [f32; 2]) -> ImageId {
    let support = Support::Pixels(by[0].abs().max(by[1].abs()) as u32 + 2);
    b.pass(&SHIFT, &[source], &ShiftParams { by, scale: 1.0, pad: 0.0 }, Class::Colour, support)
}

/// Half the size, or twice.
pub fn rescale(b: &mut PlanBuilder, source: ImageId, level: i8) -> ImageId {
    let from = b.desc(source).level;
    let scale = 2f32.powi(i32::from(level) - i32::from(from));
    let params = ShiftParams { by: [0.0; 2], scale, pad: 0.0 };
    b.pass_at(&SHIFT, &[source], &params, &[Class::Colour], Support::Pixels(2), level)
}

/// A plan that uses everything: blurs, a pyramid, several outputs and channels.
pub fn describe(b: &mut PlanBuilder, gain: f32) -> Result<(), isophote_engine::Error> {
    let source = b.input("source", 4, Class::Colour);
    let a = box_blur(b, source, 3, gain);
    let c = shift(b, a, [2.25, -1.5]);
    let half = rescale(b, c, 1);
    let half = box_blur(b, half, 1, 1.0);
    let d = rescale(b, half, 0);
    let e = box_blur(b, d, 2, 0.5);
    let brightness = b.pass_at(&SPLIT, &[e], &(), &[Class::Field, Class::Field], Support::Pixels(0), 0);
    let position = b.sibling(brightness, 1);
    let joined = b.pass(
        &JOIN,
        &[brightness, position],
        &JoinParams { scale: 0.25 },
        Class::Colour,
        Support::Pixels(1),
    );
    b.output("joined", joined);
    b.output("position", position);
    b.output("soft", d);
    Ok(())
}

pub fn plan(width: u32, height: u32, gain: f32) -> Plan {
    let mut b = PlanBuilder::new(width, height).unwrap();
    describe(&mut b, gain).unwrap();
    b.finish().unwrap()
}

/// Reproducible noise in 0..1.
pub fn noise(width: u32, height: u32, channels: u32) -> Image {
    let mut state = 0x2545_f491u32;
    let values = (0..width * height * channels).map(|_| {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        state as f32 / u32::MAX as f32
    });
    Image::from_vec(width, height, channels, values.collect()).unwrap()
}

pub fn worst(a: &Image, b: &Image) -> f32 {
    assert_eq!(a.window(), b.window());
    assert_eq!(a.channels(), b.channels());
    a.data().iter().zip(b.data()).map(|(x, y)| (x - y).abs()).fold(0.0, f32::max)
}
