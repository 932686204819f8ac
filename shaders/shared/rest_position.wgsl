// Points of undeformed objects, as renderers write them beside a picture. Twin of
// kernels/shared/rest_position.rs.

// Footprints that are not known; those that are lie far below.
const NO_FOOTPRINT: f32 = 1e9;

fn has_footprint(footprint: f32) -> bool {
    return footprint < 1e8;
}

// True where a pixel shows a point of an object.
fn is_at_rest(point: vec4f) -> bool {
    // By bits: shader compilers may assume that NaN does not exist.
    let special = (bitcast<vec4u>(point) & vec4u(0x7f800000u)) == vec4u(0x7f800000u);
    // Squares of coordinates must stay finite.
    return !any(special) && point.w > 0.5 && all(abs(point.xyz) < vec3f(1e15));
}
