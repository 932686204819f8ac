//! The text that stands for the directives of a shader, and a clear refusal of those that are malformed or out of order.

#[path = "../build/directives.rs"]
mod directives;

use directives::{Bindings, Directive};

/// The declarations of a shader.
fn declared(shader: &str) -> Result<String, String> {
    let mut bindings = Bindings::default();
    let directives = shader.lines().filter_map(|line| Directive::read(line).transpose());
    directives.map(|directive| bindings.declare(directive?)).collect()
}

#[test]
fn bindings_are_numbered_by_their_order() {
    let shader = "// Colours.
#import gpu/grid
#params
#input source, tensors
#input depth
#output target_image rgba32float
#output weights r32float";
    let expected = "@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var tensors: texture_2d<f32>;
@group(0) @binding(4) var depth: texture_2d<f32>;
@group(0) @binding(5) var target_image: texture_storage_2d<rgba32float, write>;
@group(0) @binding(6) var weights: texture_storage_2d<r32float, write>;
";
    assert_eq!(declared(shader).unwrap(), expected);
}

#[test]
fn statements_are_inserted_by_the_name_of_their_file() {
    let read = Directive::read("#insert gpu/carry_begin");
    assert_eq!(read, Ok(Some(Directive::Insert("gpu/carry_begin"))));
    assert_eq!(declared("#insert gpu/carry_begin").unwrap(), "");
}

#[test]
fn textures_count_from_two_without_parameters() {
    let expected = "@group(0) @binding(2) var source: texture_2d<f32>;\n";
    assert_eq!(declared("#input source").unwrap(), expected);
}

#[test]
fn malformed_directives_are_refused() {
    for (shader, expected) in [
        ("#import", "`#import` is not of the form #import folder/name"),
        ("#import grid", "`#import grid` is not of the form #import folder/name"),
        ("#insert grid", "`#insert grid` is not of the form #insert folder/name"),
        ("#params Params", "`#params Params` is not of the form #params"),
        ("#input", "`#input` is not of the form #input name, name, ..."),
        ("#input source,", "`#input source,` is not of the form #input name, name, ..."),
        ("#input source tensors", "`#input source tensors` is not of the form #input name, name, ..."),
        ("#input source;", "`#input source;` is not of the form #input name, name, ..."),
        (
            "#output target_image",
            "`#output target_image` is not of the form #output name format, with a format of r32float, rg32float, rgba32float",
        ),
        (
            "#output target_image rgba8unorm",
            "`#output target_image rgba8unorm` is not of the form #output name format, with a format of r32float, rg32float, rgba32float",
        ),
        ("#inputs source", "`#inputs source` is none of #import, #insert, #params, #input, #output"),
    ] {
        assert_eq!(declared(shader).unwrap_err(), expected);
    }
}

#[test]
fn directives_out_of_order_are_refused() {
    for (shader, expected) in [
        ("#output target_image r32float\n#input source", "#input stands before #output"),
        ("#input source\n#params", "#params stands before #input and #output"),
        ("#params\n#params", "#params stands in a shader once"),
    ] {
        assert_eq!(declared(shader).unwrap_err(), expected);
    }
}
