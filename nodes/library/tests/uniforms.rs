//! Result of the build script for the uniform block of a shader: a Rust struct with the same fields at the
//! same places, and a clear refusal of what it cannot take over.

#[path = "../build/uniform.rs"]
mod uniform;

use naga::front::wgsl::{Frontend, Options};
use uniform::Block;

fn block(shader: &str) -> Result<Block, String> {
    let mut options = Options::new();
    options.parse_doc_comments = true;
    let source = format!("{shader}\n@group(0) @binding(1) var<uniform> params: Params;");
    let module = Frontend::new_with_options(options).parse(&source).unwrap();
    let (_, params) = module.global_variables.iter().next().unwrap();
    Block::read(&module, params.ty)
}

const EVERY_TYPE: &str = "struct Params {
    /// Share of the second picture, 0..=1.
    amount: f32,
    /// Rows, of
    /// the picture.
    rows: i32,
    /// Bits.
    flags: u32,
    /// Along x and y, pixels.
    step: vec2f,
    /// A colour.
    tint: vec3f,
    /// Its weight.
    weight: f32,
    /// A place.
    place: vec2i,
    /// Corners.
    corners: vec4u,
    /// Weights at distance 0, 1, ...
    weights: array<vec4f, 3>,
    /// The last one.
    last: f32,
}";

/// Fields in the order of the shader, a gap wherever an alignment of WGSL leaves one, and at the end.
const EVERY_TYPE_IN_RUST: &str = "/// Uniform block of `shaders/lines/sample.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Params {
    /// Share of the second picture, 0..=1.
    pub amount: f32,
    /// Rows, of
    /// the picture.
    pub rows: i32,
    /// Bits.
    pub flags: u32,
    /// Not used; `Default::default()`.
    pub padding: [u32; 1],
    /// Along x and y, pixels.
    pub step: [f32; 2],
    /// Not used; `Default::default()`.
    pub padding_2: [u32; 2],
    /// A colour.
    pub tint: [f32; 3],
    /// Its weight.
    pub weight: f32,
    /// A place.
    pub place: [i32; 2],
    /// Not used; `Default::default()`.
    pub padding_3: [u32; 2],
    /// Corners.
    pub corners: [u32; 4],
    /// Weights at distance 0, 1, ...
    pub weights: [[f32; 4]; 3],
    /// The last one.
    pub last: f32,
    /// Not used; `Default::default()`.
    pub padding_4: [u32; 3],
}
";

#[test]
fn every_supported_type_becomes_its_counterpart() {
    let block = block(EVERY_TYPE).unwrap();
    assert_eq!(block.size, 144);
    let rust = block.rust("shaders/lines/sample.wgsl");
    let checks = rust.strip_prefix(EVERY_TYPE_IN_RUST).unwrap_or_else(|| panic!("{rust}"));
    // The compiler is asked to confirm size and places.
    for check in
        ["size_of::<Params>() == 144", "offset_of!(Params, tint) == 32", "offset_of!(Params, last) == 128"]
    {
        assert!(checks.contains(check), "{check} is not among\n{checks}");
    }
}

#[test]
fn what_has_no_counterpart_is_refused_by_name() {
    let with = |ty: &str| {
        block(&format!(
            "struct Inner {{ v: vec4f }}\n\
             struct Params {{\n/// Pixels.\ngood: f32,\n/// Pixels.\nodd: {ty} }}"
        ))
    };
    assert!(with("array<vec4f, 2>").is_ok());
    for ty in ["mat3x3f", "array<vec3f, 2>", "Inner"] {
        let refusal = with(ty).unwrap_err();
        assert!(refusal.contains("`odd`") && refusal.contains("arrays of vec4"), "{ty}: {refusal}");
    }
}

#[test]
fn a_field_that_says_nothing_is_refused() {
    let refusal =
        block("struct Params {\n/// Pixels.\nradius: i32,\n// Not a comment of the field.\nsigma: f32 }");
    assert!(refusal.unwrap_err().contains("`sigma` has no `///` comment"));
}
