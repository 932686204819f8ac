// What every pass over the scene shares: the frame, the instances, and the deformation of vertices.

struct Frame {
    world_to_view: mat4x4f,
    view_projection: mat4x4f,
    previous_view_projection: mat4x4f,
    // World to the clip space of each shadow map.
    sun_matrices: array<mat4x4f, 3>,
    // Position of the camera; w is 1 for perspective, 0 for parallel projection.
    eye: vec4f,
    // Towards the camera, for parallel projection.
    backward: vec4f,
    // Towards the sun.
    sun_direction: vec4f,
    // What a white surface facing the sun reflects; w is 1 where there is a sun.
    sun_color: vec4f,
    // Radiance of the sky above, at the horizon and below.
    zenith: vec4f,
    horizon: vec4f,
    ground: vec4f,
    // Half extents of the picture one unit before the camera.
    sky_ray: vec4f,
    // Width, height and their reciprocals.
    size: vec4f,
    // Depth in the view at which each shadow map ends, and the size of its texels in the world.
    cascade_ends: vec4f,
    cascade_texels: vec4f,
    // The light of a picture of the surroundings that falls on a diffuse surface, divided by pi, as a polynomial of
    // its normal: 1, y, z, x, xy, yz, 3zz-1, zx, xx-yy. The first w is 1 where there is such a picture.
    irradiance: array<vec4f, 9>,
    // Least corner of the ground that shadows fall on, with the share of light that full shadow takes; its greatest
    // corner, with how far shadows reach.
    ground_low: vec4f,
    ground_high: vec4f,
    // x exposure, y number of lights, z number of shadow maps, w factor on the light of the sky.
    settings: vec4f,
}

struct Instance {
    model: mat4x4f,
    previous_model: mat4x4f,
    // From the space of the mesh to the scene before anything moves.
    rest: mat4x4f,
    joints: u32,
    previous_joints: u32,
    weights: u32,
    previous_weights: u32,
    morph_targets: u32,
    vertex_count: u32,
    influence_sets: u32,
    object_id: u32,
}

struct Influence {
    joints: vec4u,
    weights: vec4f,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> instances: array<Instance>;
@group(0) @binding(2) var<storage, read> joint_matrices: array<mat4x4f>;
@group(0) @binding(3) var<storage, read> morph_weights: array<f32>;
@group(1) @binding(0) var<storage, read> influences: array<Influence>;
@group(1) @binding(1) var<storage, read> morph_deltas: array<f32>;

struct VertexInput {
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) instance: u32,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) uv0: vec2f,
    @location(4) uv1: vec2f,
    @location(5) color: vec4f,
}

// Numbers per morph delta: position, normal, tangent.
const DELTA_WIDTH = 9u;

fn delta(target_index: u32, vertex: u32, vertex_count: u32, part: u32) -> vec3f {
    let start = (target_index * vertex_count + vertex) * DELTA_WIDTH + part * 3u;
    return vec3f(morph_deltas[start], morph_deltas[start + 1u], morph_deltas[start + 2u]);
}

fn morphed(value: vec3f, instance: u32, vertex: u32, weights: u32, part: u32) -> vec3f {
    var sum = value;
    let vertex_count = instances[instance].vertex_count;
    for (var i = 0u; i < instances[instance].morph_targets; i++) {
        let weight = morph_weights[weights + i];
        if weight != 0.0 {
            sum += weight * delta(i, vertex, vertex_count, part);
        }
    }
    return sum;
}

// From the space of the mesh to the world: the node's matrix, or the mean of the joints of a skin.
fn mesh_to_world(instance: u32, vertex: u32, model: mat4x4f, joints: u32) -> mat4x4f {
    let sets = instances[instance].influence_sets;
    if sets == 0u {
        return model;
    }
    var sum = mat4x4f();
    for (var i = 0u; i < sets; i++) {
        let influence = influences[vertex * sets + i];
        for (var k = 0u; k < 4u; k++) {
            let weight = influence.weights[k];
            if weight != 0.0 {
                sum += weight * joint_matrices[joints + influence.joints[k]];
            }
        }
    }
    return sum;
}

fn current_matrix(in: VertexInput) -> mat4x4f {
    return mesh_to_world(in.instance, in.vertex, instances[in.instance].model, instances[in.instance].joints);
}

fn current_position(in: VertexInput, matrix: mat4x4f) -> vec3f {
    let local = morphed(in.position, in.instance, in.vertex, instances[in.instance].weights, 0u);
    return (matrix * vec4f(local, 1.0)).xyz;
}

fn previous_position(in: VertexInput) -> vec3f {
    let matrix = mesh_to_world(
        in.instance, in.vertex, instances[in.instance].previous_model, instances[in.instance].previous_joints);
    let local = morphed(in.position, in.instance, in.vertex, instances[in.instance].previous_weights, 0u);
    return (matrix * vec4f(local, 1.0)).xyz;
}

// Cofactors carry normals through any matrix, also a singular one, up to the sign of its determinant.
fn transform_normal(matrix: mat4x4f, normal: vec3f) -> vec3f {
    let x = matrix[0].xyz;
    let y = matrix[1].xyz;
    let z = matrix[2].xyz;
    let cofactors = mat3x3f(cross(y, z), cross(z, x), cross(x, y));
    let side = select(1.0, -1.0, dot(x, cofactors[0]) < 0.0);
    return safe_normalize(cofactors * normal * side);
}

fn safe_normalize(v: vec3f) -> vec3f {
    let squared = dot(v, v);
    return select(vec3f(0.0, 0.0, 1.0), v * inverseSqrt(squared), squared > 1e-30);
}
