// Lightness of two Lab images beside each other: that of tones, and that of the relief that they rise from.
// Cost: two loads.
#import gpu/grid

#input lab, relief
#output target_image rgba32float

fn of_pixel(id: vec3u, lab: vec4f, relief: vec4f) -> vec4f {
    return vec4f(lab.x * lab.w, lab.w, relief.x * relief.w, relief.w);
}
