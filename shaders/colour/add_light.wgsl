// A premultiplied picture and light that is added to it.
// Cost: two loads and three additions.
#import gpu/grid

@group(0) @binding(2) var picture: texture_2d<f32>;
@group(0) @binding(3) var light: texture_2d<f32>;
@group(0) @binding(4) var target_image: texture_storage_2d<rgba32float, write>;

fn of_pixel(id: vec3u, under: vec4f, light: vec4f) -> vec4f {
    return vec4f(under.rgb + light.rgb, under.a);
}
