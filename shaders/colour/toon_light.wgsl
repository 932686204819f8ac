// Light on surfaces as steps of shading see it: how bright it is, how far surfaces turn away, and how much they mirror.
// Cost: five loads, five powers and about 60 multiply-adds.
#import gpu/grid
#import shared/colour
#import shared/host_colour

struct Params {
    /// Sum of 1: surfaces' colours are there to divide by; 2: mirrored light is there; 4: it stands for diffuse light where
    /// there is none; 8: normals are there.
    given: u32,
    /// Factor on light.
    gain: f32,
}

#params
// The picture, for its coverage.
#input source
// Light in the colours of surfaces, those colours, and light that they mirror.
#input lit, albedo, specular
#input normal
#output target_image rgba32float

// Darker surfaces show no light of their own.
const DARKEST: f32 = 1e-3;

fn luminance(rgb: vec3f) -> f32 {
    return max(dot(srgb_decode(rgb), vec3f(0.2126729, 0.7151522, 0.0721750)), 0.0);
}

// Lightness of CIELAB over 100, as far as twice that of white.
fn lightness(luminance: f32) -> f32 {
    return clamp(1.16 * lab_curve(vec3f(luminance * params.gain)).x - 0.16, 0.0, 2.0);
}

fn of_pixel(id: vec3u, source: vec4f, lit: vec4f, albedo: vec4f, specular: vec4f, normal: vec4f) -> vec4f {
    var light = luminance(lit.rgb);
    var mirrored = light;
    if (params.given & 2u) != 0u {
        mirrored = luminance(specular.rgb);
    }
    if (params.given & 1u) != 0u {
        let surface = luminance(albedo.rgb) + DARKEST;
        light /= surface;
        if (params.given & 4u) != 0u {
            // Metals reflect nothing diffusely.
            light += mirrored / surface * saturate(1.0 - 50.0 * light);
        }
    }
    var away = 0.0;
    if (params.given & 8u) != 0u {
        let length = length(finite(vec4f(normal.xyz, 0.0)).xyz);
        let facing = saturate(finite(normal).z / max(length, 1e-6));
        away = select(0.0, 1.0 - facing, length > 1e-6) * finite(normal.wwww).w;
    }
    return vec4f(lightness(light), away, lightness(mirrored), source.a);
}
