//! Kernels that can be fused, each as WGSL in pieces and as a CPU function.
#![allow(missing_docs)]

use crate::support::GRID;
use bytemuck::{Pod, Zeroable};
use isophote_engine::kernel::Fusible;
use isophote_engine::wgsl::{Piece, Pieces};
use isophote_engine::{Band, Kernel, Tolerance};

const EXACT: Tolerance = Tolerance::of_rounding(1e-5, 1e-5, "few sums");

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub struct Amount {
    pub amount: f32,
}

/// Kernel of the texts `$own` and, if it is of single pixels, `$entry`.
macro_rules! kernel {
    ($kernel:ident, $textures:expr, $channels:expr, $fusible:expr, $own:ident, $entry:ident, $cpu:expr) => {
        pub static $kernel: Kernel = Kernel {
            name: stringify!($kernel),
            shader: concat!(
                include_str!("../../../../shaders/gpu/grid.wgsl"),
                $own!(joined),
                $entry!(joined)
            ),
            inputs: $textures.len(),
            outputs: &[$channels],
            params_size: size_of::<Amount>(),
            pieces: Pieces {
                imports: &[&GRID],
                own: $own!(pieces),
                entry: $entry!(pieces),
                textures: &$textures,
                ..Pieces::NONE
            },
            fusible: $fusible,
            cpu: $cpu,
            cost: |_| 1.0,
            tolerance: EXACT,
            fast: EXACT.rounded_to_half(),
        };
    };
}

macro_rules! no_entry {
    ($form:ident) => {
        $form! {}
    };
}

macro_rules! slope_text {
    ($form:ident) => {
        $form! {
            Text "\nstruct "
            ParamsType "Params"
            Text " { amount: f32 }\n"
            Binding "@group(0) @binding(1) var<uniform> params: Params;\n"
            Binding "@group(0) @binding(2) var source: texture_2d<f32>;\n"
            Binding "@group(0) @binding(3) var target_image: texture_storage_2d<"
            Format "rgba32float"
            Binding ", write>;\n"
            Text "// A name that another kernel has, too.
fn scaled(v: vec4f) -> vec4f { return v * "
            Params "params"
            Text ".amount; }
@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let v = fetch(source, 0u, pixel(id) + vec2i(1, 0)) - fetch(source, 0u, pixel(id));
    "
            Store "textureStore(target_image, vec2i(id.xy), "
            Text "scaled(v));\n}\n"
        }
    };
}

// Difference to the right neighbour, times an amount.
kernel!(SLOPE, ["source"], 4, Fusible::First, slope_text, no_entry, |pass, band| {
    let amount = pass.params::<Amount>().amount;
    let view = pass.inputs[0];
    each(band, 4, |x, y, out| {
        let (a, b) = (view.pixel4(x + 1, y), view.pixel4(x, y));
        (0..4).for_each(|c| out[c] = (a[c] - b[c]) * amount);
    });
});

macro_rules! sum_text {
    ($form:ident) => {
        $form! {
            Text "\nstruct "
            ParamsType "Params"
            Text " { amount: f32 }\n"
            Binding "@group(0) @binding(1) var<uniform> params: Params;\n"
            Binding "@group(0) @binding(2) var source: texture_2d<f32>;\n"
            Binding "@group(0) @binding(3) var target_image: texture_storage_2d<"
            Format "r32float"
            Binding ", write>;\n"
            Text "fn "
            Name "scaled"
            Text "(v: vec4f) -> f32 { return v.x + v.y + "
            Params "params"
            Text ".amount; }\nfn "
            Name "of_pixel"
            Text "(id: vec3u, "
            Name "source"
            Text ": vec4f) -> vec4f {\n    return vec4f("
            Name "scaled"
            Text "("
            Name "source"
            Text "), 7.0, 7.0, 7.0);\n}\n"
        }
    };
}

macro_rules! sum_entry {
    ($form:ident) => {
        $form! {
            Text "
@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    "
            Store "textureStore(target_image, vec2i(id.xy), "
            Text "of_pixel(id, fetch(source, 0u, pixel(id))));\n}\n"
        }
    };
}

// The sum of the first two channels plus an amount, alone.
kernel!(SUM, ["source"], 1, Fusible::SinglePixels { around: &[] }, sum_text, sum_entry, |pass, band| {
    let amount = pass.params::<Amount>().amount;
    let view = pass.inputs[0];
    each(band, 1, |x, y, out| {
        let v = view.pixel4(x, y);
        out[0] = v[0] + v[1] + amount;
    });
});

macro_rules! blend_text {
    ($form:ident) => {
        $form! {
            Text "\nstruct "
            ParamsType "Params"
            Text " { amount: f32 }\n"
            Binding "@group(0) @binding(1) var<uniform> params: Params;\n"
            Binding "@group(0) @binding(2) var picture: texture_2d<f32>;\n"
            Binding "@group(0) @binding(3) var factor: texture_2d<f32>;\n"
            Binding "@group(0) @binding(4) var target_image: texture_storage_2d<"
            Format "rgba32float"
            Binding ", write>;\n"
            Text "fn "
            Name "of_pixel"
            Text "(id: vec3u, "
            Name "picture"
            Text ": vec4f, "
            Name "factor"
            Text ": vec4f) -> vec4f {\n    return "
            Name "picture"
            Text " * "
            Name "factor"
            Text ".x * "
            Name "factor"
            Text ".a + vec4f("
            Params "params"
            Text ".amount * centre(id), "
            Name "factor"
            Text ".y, 0.0);\n}\n"
        }
    };
}

macro_rules! blend_entry {
    ($form:ident) => {
        $form! {
            Text "
@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    "
            Store "textureStore(target_image, vec2i(id.xy), "
            Text "of_pixel(id, fetch(picture, 0u, pixel(id)), fetch(factor, 1u, pixel(id))));\n}\n"
        }
    };
}

// A picture times a number of another one, plus its position.
kernel!(
    BLEND,
    ["picture", "factor"],
    4,
    Fusible::SinglePixels { around: &[] },
    blend_text,
    blend_entry,
    |pass, band| {
        let amount = pass.params::<Amount>().amount;
        let [picture, factor] = pass.inputs else { return };
        each(band, 4, |x, y, out| {
            let (v, f) = (picture.pixel4(x, y), factor.pixel1(x, y));
            (0..4).for_each(|c| out[c] = v[c] * f);
            out[0] += amount * (x as f32 + 0.5);
            out[1] += amount * (y as f32 + 0.5);
        });
    }
);

macro_rules! beside_text {
    ($form:ident) => {
        $form! {
            Text "\nstruct "
            ParamsType "Params"
            Text " { amount: f32 }\n"
            Binding "@group(0) @binding(1) var<uniform> params: Params;\n"
            Binding "@group(0) @binding(2) var picture: texture_2d<f32>;\n"
            Binding "@group(0) @binding(3) var factor: texture_2d<f32>;\n"
            Binding "@group(0) @binding(4) var target_image: texture_storage_2d<"
            Format "rgba32float"
            Binding ", write>;\n"
            Text "const "
            Name "INPUT_PICTURE"
            Text ": u32 = "
            Slot 0
            Text "u;\nfn "
            Name "of_pixel"
            Text "(id: vec3u, "
            Name "factor"
            Text ": vec4f) -> vec4f {\n    return "
            Params "params"
            Text ".amount * "
            Name "factor"
            Text ".x * fetch("
            Name "picture"
            Text ", "
            Name "INPUT_PICTURE"
            Text ", pixel(id) + vec2i(1, 0));\n}\n"
        }
    };
}

macro_rules! beside_entry {
    ($form:ident) => {
        $form! {
            Text "
@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    "
            Store "textureStore(target_image, vec2i(id.xy), "
            Text "of_pixel(id, fetch(factor, 1u, pixel(id))));\n}\n"
        }
    };
}

// A picture's right neighbour times a number of another one.
kernel!(
    BESIDE,
    ["picture", "factor"],
    4,
    Fusible::SinglePixels { around: &[0] },
    beside_text,
    beside_entry,
    |pass, band| {
        let amount = pass.params::<Amount>().amount;
        let [picture, factor] = pass.inputs else { return };
        each(band, 4, |x, y, out| {
            let (v, f) = (picture.pixel4(x + 1, y), factor.pixel1(x, y));
            (0..4).for_each(|c| out[c] = amount * f * v[c]);
        });
    }
);

fn each(band: &mut Band<'_>, channels: usize, mut of: impl FnMut(i32, i32, &mut [f32])) {
    let window = band.window;
    for y in window.y0..window.y1 {
        let row = band.row_mut(0, y).chunks_exact_mut(channels);
        (window.x0..window.x1).zip(row).for_each(|(x, out)| of(x, y, out));
    }
}
