// How much of an object a pixel covers: by how much the point of the undeformed object changes from pixel to
// pixel of the same surface.
// Cost: five loads and about 60 operations.
#import shared/rest_position
#import gpu/grid

#input points
#output target_image rg32float

// Change of the point per pixel along an axis, and 1 where it is known. Across a silhouette another object lies
// beside, so that of both sides the one with less change holds.
fn change(p: vec2i, here: vec3f, axis: vec2i) -> vec4f {
    let before = fetch(points, 0u, p - axis);
    let after = fetch(points, 0u, p + axis);
    let has_before = is_at_rest(before) && all(p - axis >= vec2i(0));
    let has_after = is_at_rest(after) && all(p + axis < grid.full);
    let back = select(vec3f(0.0), here - before.xyz, has_before);
    let ahead = select(vec3f(0.0), after.xyz - here, has_after);
    let takes_ahead = has_after && (!has_before || dot(ahead, ahead) < dot(back, back));
    return vec4f(select(back, ahead, takes_ahead), select(0.0, 1.0, has_before || has_after));
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let here = fetch(points, 0u, p);
    var found = vec2f(NO_FOOTPRINT);
    if is_at_rest(here) {
        var x = change(p, here.xyz, vec2i(1, 0));
        var y = change(p, here.xyz, vec2i(0, 1));
        // The metric of the surface (E, F, G) per pixel, relative to its trace.
        let xx = dot(x.xyz, x.xyz);
        let yy = dot(y.xyz, y.xyz);
        let e = select(yy, xx, x.w > 0.0);
        let g = select(xx, yy, y.w > 0.0);
        let trace = e + g;
        let f = select(0.0, dot(x.xyz, y.xyz), x.w > 0.0 && y.w > 0.0);
        if trace > 1e-30 {
            let area = sqrt(max((e / trace) * (g / trace) - (f / trace) * (f / trace), 0.0));
            let half = 0.5 * (e - g) / trace;
            let longest = 0.5 + sqrt(half * half + (f / trace) * (f / trace));
            let mean = max(area, 0.25 * longest);
            found = 0.5 * vec2f(log2(trace * mean), log2(trace * longest));
        }
    }
    textureStore(target_image, vec2i(id.xy), vec4f(found, 0.0, 0.0));
}
