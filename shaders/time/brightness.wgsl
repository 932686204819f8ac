// Brightness of a colour over black, which optical flow compares. Cost: 1 load.
#import gpu/grid

#input source
#output target_image r32float

// Highlights beyond it would outweigh all else that moves.
const BRIGHTEST = 4.0;

fn of_pixel(id: vec3u, color: vec4f) -> vec4f {
    let luma = dot(color.rgb, vec3f(0.2126, 0.7152, 0.0722)) * color.a;
    return vec4f(clamp(luma, 0.0, BRIGHTEST));
}
