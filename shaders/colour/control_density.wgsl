// Light that a medium lets through where a control map says how much of it there is: densities add up, so that light is
// raised to the factor of the map's fourth channel (Bouguer, Beer and Lambert).
// Cost: two loads, three logarithms and four exponentials.
#import gpu/grid
#import shared/control

#input source, control
#output target_image rgba32float

fn of_pixel(id: vec3u, source: vec4f, control: vec4f) -> vec4f {
    let factor = control_factor(control.w);
    let light = clamp(source.rgb, vec3f(1e-6), vec3f(1.0));
    let darker = exp(factor * log(light));
    // Where the map is neutral, and where nothing or all is let through, light stays as it is.
    let changes = vec3<bool>(factor != 1.0) & (source.rgb > vec3f(0.0)) & (source.rgb < vec3f(1.0));
    return vec4f(select(source.rgb, darker, changes), source.a);
}
