// Draws lines over a picture in a colour for each pixel; coverage stays.
// Cost: three loads and six multiply-adds.
#import gpu/grid

#input source, edges
// The colour of lines.
#input paint
#output target_image rgba32float

fn of_pixel(id: vec3u, v: vec4f, edges: vec4f, paint: vec4f) -> vec4f {
    let ink = 1.0 - clamp(edges.x, 0.0, 1.0);
    return vec4f(v.rgb + ink * (paint.rgb - v.rgb), v.a);
}
