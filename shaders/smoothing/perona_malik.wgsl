// One explicit step of Perona and Malik's diffusion (3.3) towards the four neighbours.
// Cost: five loads, four diffusivities and about 60 multiply-adds.
#import gpu/grid

struct Params {
    /// Time step, up to 1/4.
    time_step: f32,
    /// 1 / K^2 or 1 / lambda^2 of 3.2.
    falloff: f32,
    /// The diffusivity of 3.2, 0: rational; 1: exponential.
    diffusivity: u32,
}

#params
#input source
#output target_image rgba32float

const DIFFUSIVITY_EXPONENTIAL = 1u;

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let origin = fetch(source, 0u, p);
    let steps = array(vec2i(-1, 0), vec2i(1, 0), vec2i(0, -1), vec2i(0, 1));
    var sum = vec3f(0.0);
    for (var i = 0u; i < 4u; i++) {
        let v = fetch(source, 0u, p + steps[i]);
        let d = v.rgb - origin.rgb;
        let s = dot(d, d) * params.falloff;
        var g = 1.0 / (1.0 + s);
        if params.diffusivity == DIFFUSIVITY_EXPONENTIAL {
            g = exp(-min(s, 87.0));
        }
        sum += g * v.a * d;
    }
    textureStore(target_image, vec2i(id.xy), vec4f(origin.rgb + params.time_step * sum, origin.a));
}
