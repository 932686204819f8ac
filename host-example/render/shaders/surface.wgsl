// Shading of surfaces: GGX microfacets with Smith visibility and Schlick's Fresnel term over a Lambertian
// base, lit by a shadowed sun, the punctual lights of the file, and the sky.

// 0 opaque, 1 mask, 2 blend.
override ALPHA_MODE: u32 = 0u;

const PI = 3.14159265;
const POINT = 1u;
const SPOT = 2u;

struct Light {
    // w is the kind: 0 directional, 1 point, 2 spot.
    position: vec4f,
    // What a white surface reflects, at unit distance for all but directional lights; w is the range or 0.
    color: vec4f,
    // Towards the light for directional ones, along the beam for spots.
    direction: vec4f,
    // Scale and offset that map the cosine to the edge of a spot.
    spot: vec4f,
}

@group(0) @binding(4) var<storage, read> lights: array<Light>;
@group(3) @binding(0) var shadow_maps: texture_depth_2d_array;
@group(3) @binding(1) var shadow_sampler: sampler_comparison;

struct SurfaceInput {
    // The same in the pass for depth, bit for bit.
    @invariant @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    // At edges the middle of a pixel may lie outside of the triangle, where its texture ends.
    @location(3) @interpolate(perspective, centroid) uv0: vec2f,
    @location(4) @interpolate(perspective, centroid) uv1: vec2f,
    @location(5) @interpolate(perspective, centroid) color: vec4f,
}

@vertex
fn surface_vertex(in: VertexInput) -> SurfaceInput {
    let matrix = current_matrix(in);
    let position = current_position(in, matrix);
    let weights = instances[in.instance].weights;
    let normal = morphed(in.normal, in.instance, in.vertex, weights, 1u);
    let tangent = morphed(in.tangent.xyz, in.instance, in.vertex, weights, 2u);
    var out: SurfaceInput;
    out.clip = frame.view_projection * vec4f(position, 1.0);
    out.position = position;
    out.normal = transform_normal(matrix, normal);
    out.tangent = vec4f((matrix * vec4f(tangent, 0.0)).xyz, in.tangent.w);
    out.uv0 = in.uv0;
    out.uv1 = in.uv1;
    out.color = in.color;
    return out;
}

struct DepthInput {
    @invariant @builtin(position) clip: vec4f,
}

@vertex
fn depth_vertex(in: VertexInput) -> DepthInput {
    return DepthInput(frame.view_projection * vec4f(current_position(in, current_matrix(in)), 1.0));
}

@fragment
fn depth_fragment() {}

struct Surface {
    diffuse: vec3f,
    specular: vec3f,
    alpha: f32,
    normal: vec3f,
    view: vec3f,
    n_dot_v: f32,
}

// Light that goes from a surface towards the camera.
struct Reflected {
    diffuse: vec3f,
    specular: vec3f,
}

// Light reflected towards the camera, for light that a white surface facing it would reflect as 1.
fn reflected(s: Surface, to_light: vec3f) -> Reflected {
    let n_dot_l = dot(s.normal, to_light);
    if n_dot_l <= 0.0 {
        return Reflected(vec3f(0.0), vec3f(0.0));
    }
    let middle = normalize(s.view + to_light);
    let n_dot_h = saturate(dot(s.normal, middle));
    let v_dot_h = saturate(dot(s.view, middle));
    let a2 = s.alpha * s.alpha;
    let spread = n_dot_h * n_dot_h * (a2 - 1.0) + 1.0;
    let distribution = a2 / (spread * spread);
    let visibility = 0.5 / (n_dot_l * sqrt(s.n_dot_v * s.n_dot_v * (1.0 - a2) + a2)
        + s.n_dot_v * sqrt(n_dot_l * n_dot_l * (1.0 - a2) + a2));
    let fresnel = s.specular + (1.0 - s.specular) * pow(1.0 - v_dot_h, 5.0);
    return Reflected(n_dot_l * s.diffuse * (1.0 - fresnel), n_dot_l * fresnel * distribution * visibility);
}

fn lit(cascade: u32, uv: vec2f, depth: f32) -> f32 {
    return textureSampleCompareLevel(shadow_maps, shadow_sampler, uv, cascade, depth);
}

// Share of the sun that arrives by one shadow map: up to 9 bilinear comparisons around the point, which is moved
// off the surface by about the size of a texel so that it does not shade itself.
fn sunlight_of(cascade: u32, position: vec3f, normal: vec3f) -> f32 {
    let texel = frame.cascade_texels[cascade];
    let slope = 1.0 - saturate(dot(normal, frame.sun_direction.xyz));
    let moved = position + normal * texel * (0.6 + 2.4 * slope) + frame.sun_direction.xyz * texel;
    let projected = frame.sun_matrices[cascade] * vec4f(moved, 1.0);
    let uv = projected.xy * vec2f(0.5, -0.5) + 0.5;
    // The map covers the framed scene; backdrops beyond it are in the sun.
    if any(uv < vec2f(0.0)) || any(uv > vec2f(1.0)) || projected.z > 1.0 {
        return 1.0;
    }
    let step = 1.0 / vec2f(textureDimensions(shadow_maps));
    // Where the middle and the corners agree, as nearly everywhere, so does what lies between.
    var sum = lit(cascade, uv, projected.z);
    for (var i = 0u; i < 4u; i++) {
        let corner = vec2f(f32(i & 1u), f32(i >> 1u)) * 2.0 - 1.0;
        sum += lit(cascade, uv + 1.3 * corner * step, projected.z);
    }
    if sum == 0.0 || sum == 5.0 {
        return sum / 5.0;
    }
    for (var i = 0u; i < 4u; i++) {
        let side = f32(i >> 1u) * 2.0 - 1.0;
        let edge = select(vec2f(0.0, side), vec2f(side, 0.0), (i & 1u) == 0u);
        sum += lit(cascade, uv + 1.3 * edge * step, projected.z);
    }
    return sum / 9.0;
}

// Share of the sun that arrives; near its end each map fades into the next, so that no seam shows.
fn sunlight(position: vec3f, normal: vec3f) -> f32 {
    let depth = -(frame.world_to_view * vec4f(position, 1.0)).z;
    let last = u32(frame.settings.z) - 1u;
    var cascade = 0u;
    while cascade < last && depth > frame.cascade_ends[cascade] {
        cascade++;
    }
    let share = sunlight_of(cascade, position, normal);
    let fade = smoothstep(0.9, 1.0, depth / frame.cascade_ends[cascade]);
    if cascade == last || fade == 0.0 {
        return share;
    }
    return mix(share, sunlight_of(cascade + 1u, position, normal), fade);
}

fn punctual(s: Surface, position: vec3f) -> Reflected {
    var sum = Reflected(vec3f(0.0), vec3f(0.0));
    for (var i = 0u; i < u32(frame.settings.y); i++) {
        let light = lights[i];
        let kind = u32(light.position.w);
        var to_light = light.direction.xyz;
        var strength = 1.0;
        if kind == POINT || kind == SPOT {
            let offset = light.position.xyz - position;
            let squared = max(dot(offset, offset), 1e-8);
            to_light = offset * inverseSqrt(squared);
            strength = 1.0 / squared;
            if light.color.w > 0.0 {
                let relative = squared / (light.color.w * light.color.w);
                strength *= saturate(1.0 - relative * relative);
            }
        }
        if kind == SPOT {
            let edge = saturate(dot(light.direction.xyz, -to_light) * light.spot.x + light.spot.y);
            strength *= edge * edge;
        }
        let one = reflected(s, to_light);
        sum.diffuse += one.diffuse * light.color.rgb * strength;
        sum.specular += one.specular * light.color.rgb * strength;
    }
    return sum;
}

// Integral of the specular term over a uniform hemisphere: the fit of Karis, "Physically based shading on
// mobile" (2014). x multiplies the reflectance at normal incidence, y is added.
fn specular_integral(roughness: f32, n_dot_v: f32) -> vec2f {
    let r = roughness * vec4f(-1.0, -0.0275, -0.572, 0.022) + vec4f(1.0, 0.0425, 1.04, -0.04);
    let a = min(r.x * r.x, exp2(-9.28 * n_dot_v)) * r.x + r.y;
    return vec2f(-1.04, 1.04) * a + r.zw;
}

// Colour of a surface and its light, which is the sum of the last three.
struct Shaded {
    albedo: vec3f,
    diffuse: vec3f,
    specular: vec3f,
    emission: vec3f,
    coverage: f32,
}

fn shaded(in: SurfaceInput, front: bool) -> Shaded {
    let base = base_color(in.uv0, in.uv1, in.color);
    let side = select(-1.0, 1.0, front);
    let smooth_normal = safe_normalize(in.normal) * side;
    var normal = smooth_normal;
    if has(HAS_NORMAL) {
        let texel = textureSample(normal_texture, normal_sampler, coordinates(2u, in.uv0, in.uv1)).xyz * 2.0 - 1.0;
        let bent = texel * vec3f(vec2f(material.normal_scale), 1.0);
        let tangent = safe_normalize(in.tangent.xyz - smooth_normal * dot(smooth_normal, in.tangent.xyz));
        let bitangent = cross(safe_normalize(in.normal), tangent) * in.tangent.w;
        // The tangent plane turns with the back side.
        normal = safe_normalize(bent.x * tangent * side + bent.y * bitangent * side + bent.z * smooth_normal);
    }
    var metallic = material.metallic;
    var roughness = material.roughness;
    if has(HAS_METALLIC_ROUGHNESS) {
        let texel = textureSample(
            metallic_roughness_texture, metallic_roughness_sampler, coordinates(1u, in.uv0, in.uv1));
        roughness *= texel.g;
        metallic *= texel.b;
    }
    var occlusion = 1.0;
    if has(HAS_OCCLUSION) {
        let texel = textureSample(occlusion_texture, occlusion_sampler, coordinates(3u, in.uv0, in.uv1)).r;
        occlusion = mix(1.0, texel, material.occlusion_strength);
    }
    var emissive = material.emissive.rgb;
    if has(HAS_EMISSIVE) {
        emissive *= textureSample(emissive_texture, emissive_sampler, coordinates(4u, in.uv0, in.uv1)).rgb;
    }
    // Normals that change within a pixel widen the highlight, which otherwise sparkles (Tokuyoshi, Kaplanyan).
    let bend_x = dpdx(normal);
    let bend_y = dpdy(normal);
    let variance = min(0.25 * (dot(bend_x, bend_x) + dot(bend_y, bend_y)), 0.18);

    var coverage = base.a;
    if ALPHA_MODE == 0u {
        coverage = 1.0;
    } else if ALPHA_MODE == 1u {
        // Spreads the step over one pixel; the samples of the pixel then smooth the edge.
        coverage = saturate((base.a - material.alpha_cutoff) / max(fwidth(base.a), 1e-4) + 0.5);
        if coverage <= 0.0 {
            discard;
        }
    }

    var out = Shaded(vec3f(0.0), vec3f(0.0), vec3f(0.0), base.rgb, coverage);
    if !has(UNLIT) {
        roughness = clamp(roughness, 0.06, 1.0);
        var s: Surface;
        s.diffuse = base.rgb * (1.0 - metallic);
        s.specular = mix(vec3f(material.reflectance), base.rgb, metallic);
        s.alpha = sqrt(saturate(pow(roughness, 4.0) + variance));
        s.normal = normal;
        s.view = select(frame.backward.xyz, safe_normalize(frame.eye.xyz - in.position), frame.eye.w > 0.5);
        s.n_dot_v = max(abs(dot(s.normal, s.view)), 1e-3);

        var light = punctual(s, in.position);
        if frame.sun_color.w > 0.5 && dot(normal, frame.sun_direction.xyz) > 0.0 {
            // Where the surface itself turns away, a bent normal does not bring the sun back. Fading early also
            // hides that coarse meshes shade themselves facet by facet where the light grazes them.
            let facing = smoothstep(0.0, 0.25, dot(smooth_normal, frame.sun_direction.xyz));
            let sun = frame.sun_color.rgb * facing * sunlight(in.position, smooth_normal);
            let one = reflected(s, frame.sun_direction.xyz);
            light.diffuse += one.diffuse * sun;
            light.specular += one.specular * sun;
        }
        let blur = sqrt(s.alpha);
        let terms = specular_integral(blur, s.n_dot_v);
        let direction = reflect(-s.view, s.normal);
        // Glossy reflections are hidden less than diffuse light, and not where they point outward.
        let specular_occlusion = saturate(pow(s.n_dot_v + occlusion, exp2(-16.0 * s.alpha - 1.0)) - 1.0 + occlusion);
        light.diffuse += frame.settings.w * s.diffuse * sky_irradiance(s.normal) * occlusion;
        light.specular += frame.settings.w * mirrored(direction, blur) * (s.specular * terms.x + terms.y) * specular_occlusion;
        out = Shaded(base.rgb, light.diffuse, light.specular, emissive, coverage);
    }
    return out;
}

// A colour as targets take it, multiplied by coverage where it is blended.
fn blended(color: vec3f, coverage: f32) -> vec4f {
    if ALPHA_MODE == 2u {
        return vec4f(color * coverage, coverage);
    }
    return vec4f(color, coverage);
}

fn whole(s: Shaded) -> vec4f {
    return blended(s.emission + s.diffuse + s.specular, s.coverage);
}

@fragment
fn surface_fragment(in: SurfaceInput, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    return whole(shaded(in, front));
}

// Samples of a pixel that so much coverage comes to.
fn covered_samples(coverage: f32) -> u32 {
    let covered = vec4f(coverage) > vec4f(0.0, 0.25, 0.5, 0.75);
    return dot(vec4u(covered), vec4u(1u, 2u, 4u, 8u));
}

struct Holed {
    @location(0) color: vec4f,
    @builtin(sample_mask) samples: u32,
}

// Covers as many samples as its coverage says. Those are opaque, which they would not be if the device made samples
// of alpha.
@fragment
fn surface_holed_fragment(in: SurfaceInput, @builtin(front_facing) front: bool) -> Holed {
    let color = whole(shaded(in, front));
    return Holed(vec4f(color.rgb, 1.0), covered_samples(color.a));
}

// The same surfaces taken apart, in a pass of their own, since few frames need it.
struct Layers {
    @location(0) albedo: vec4f,
    @location(1) diffuse: vec4f,
    @location(2) specular: vec4f,
}

@fragment
fn layers_fragment(in: SurfaceInput, @builtin(front_facing) front: bool) -> Layers {
    let s = shaded(in, front);
    return Layers(blended(s.albedo, s.coverage), blended(s.diffuse, s.coverage), blended(s.specular, s.coverage));
}

struct HoledLayers {
    @location(0) albedo: vec4f,
    @location(1) diffuse: vec4f,
    @location(2) specular: vec4f,
    @builtin(sample_mask) samples: u32,
}

@fragment
fn layers_holed_fragment(in: SurfaceInput, @builtin(front_facing) front: bool) -> HoledLayers {
    let s = shaded(in, front);
    return HoledLayers(vec4f(s.albedo, 1.0), vec4f(s.diffuse, 1.0), vec4f(s.specular, 1.0), covered_samples(s.coverage));
}
