// Simplified colours, and those of before where the two differ much: what is small and plain to see stays, as
// letters, eyes and twigs; what is small and faint goes. Differences count against the light that is there.
// Cost: two loads and 25 multiply-adds.
#import gpu/grid

struct Params {
    /// Difference up to which nothing is kept.
    faint: f32,
    /// 1 / how much more is kept in full.
    inverse: f32,
}

#params
#input simple, source
#output target_image rgba32float

fn of_pixel(id: vec3u, simple: vec4f, v: vec4f) -> vec4f {
    let d = abs(v.rgb - simple.rgb);
    let light = clamp(dot(simple.rgb, vec3f(0.2126, 0.7152, 0.0722)), 0.0, 1.0);
    let difference = max(d.r, max(d.g, d.b)) / (0.35 + light);
    let t = clamp((difference - params.faint) * params.inverse, 0.0, 1.0);
    let kept = t * t * (3.0 - 2.0 * t);
    return vec4f(simple.rgb + kept * (v.rgb - simple.rgb), simple.a);
}
