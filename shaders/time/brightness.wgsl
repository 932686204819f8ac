// Brightness of a colour over black, which optical flow compares. Cost: 1 load.
#import gpu/grid

@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<r32float, write>;

// Highlights beyond it would outweigh all else that moves.
const BRIGHTEST = 4.0;

fn of_pixel(id: vec3u, color: vec4f) -> vec4f {
    let luma = dot(color.rgb, vec3f(0.2126, 0.7152, 0.0722)) * color.a;
    return vec4f(clamp(luma, 0.0, BRIGHTEST));
}
