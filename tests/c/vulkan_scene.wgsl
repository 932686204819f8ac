// Octahedra that turn, and what a renderer knows of them: the scene of vulkan_host.c, which the test compiles to SPIR-V.

struct Corner {
    @builtin(position) place: vec4f,
    // In camera space: right, up, towards the camera.
    @location(0) normal: vec3f,
    // Along the camera's axis.
    @location(1) distance: f32,
    // From 1.
    @location(2) @interpolate(flat) object: u32,
}

struct Pixel {
    @location(0) color: vec4f,
    @location(1) normal: vec4f,
    @location(2) distance: f32,
    @location(3) object: f32,
}

const FACES = 8u;

fn turned(p: vec3f, angle: f32) -> vec3f {
    let c = cos(angle);
    let s = sin(angle);
    return vec3f(c * p.x + s * p.z, p.y, c * p.z - s * p.x);
}

// The number of the frame arrives as that of the first instance.
@vertex
fn corner(@builtin(vertex_index) index: u32, @builtin(instance_index) frame: u32) -> Corner {
    let object = index / (3u * FACES);
    let face = index / 3u % FACES;
    let signs = vec3f(vec3u(face, face >> 1u, face >> 2u) & vec3u(1u)) * 2.0 - 1.0;
    var p = vec3f(0.0);
    p[index % 3u] = signs[index % 3u];
    let angle = f32(frame) * 0.02 + f32(object);
    let ring = turned(vec3f(1.9, 0.0, 0.0), f32(object) * 1.2566 + f32(frame) * 0.005);
    let at = turned(p, angle) * vec3f(0.9, 1.3, 0.9) + ring + vec3f(0.0, 0.4 * sin(f32(object)), -6.0);
    var out: Corner;
    // What lies from 1 to 20 before the camera fills the range of depths.
    out.place = vec4f(at.x * 1.2, at.y * 1.8, (-at.z - 1.0) * 20.0 / 19.0, -at.z);
    out.normal = normalize(turned(signs, angle) * vec3f(1.3, 0.9, 1.3));
    out.distance = -at.z;
    out.object = object + 1u;
    return out;
}

@fragment
fn pixel(at: Corner) -> Pixel {
    let hue = f32(at.object) * 1.3;
    let base = 0.55 + 0.4 * cos(vec3f(hue, hue + 2.1, hue + 4.2));
    let light = 0.35 + 0.65 * max(dot(at.normal, normalize(vec3f(-0.5, 0.7, 0.6))), 0.0);
    let grain = 0.06 * sin(at.place.x * 0.9) * sin(at.place.y * 1.1);
    return Pixel(vec4f(base * light + grain, 1.0), vec4f(at.normal, 1.0), at.distance, f32(at.object));
}
