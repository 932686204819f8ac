// One Jacobi step of Laplace's equation on tensors: those that are not valid become the mean of
// their four neighbours (2.171, Listing 2.3). Cost: up to 5 loads.
#import gpu/grid

#input source
#output target_image rgba32float

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    var t = fetch(source, 0u, p);
    if t.w < 1.0 {
        let across = fetch(source, 0u, p + vec2i(1, 0)) + fetch(source, 0u, p - vec2i(1, 0));
        let along = fetch(source, 0u, p + vec2i(0, 1)) + fetch(source, 0u, p - vec2i(0, 1));
        t = vec4f((across + along).xyz * 0.25, 0.0);
    }
    textureStore(target_image, vec2i(id.xy), t);
}
