//! Frames of small scenes whose geometry buffer and motion are known in advance. They need an adapter, a
//! software one included; without any they say so, and fail where `ISOPHOTE_REQUIRE_GPU` is set.

use glam::{Mat4, Quat, Vec2, Vec3};

use crate::background::Background;
use crate::gpu::Gpu;
use crate::lighting::Lighting;
use crate::readback::Readback;
use crate::renderer::Renderer;
use crate::targets::Target;
use isophote_pictures::floats::Picture;
use isophote_pictures::meaning::ImageState;
use isophote_scene::animation::{Animation, Channel, Interpolation, Property};
use isophote_scene::camera::View;
use isophote_scene::model::Projection;
use isophote_scene::pose::Pose;
use isophote_scene::{
    AlphaMode, Bounds, Influence, Material, Mesh, MorphDelta, Node, Primitive, Scene, Skin, Vertex,
};

const SIZE: (u32, u32) = (64, 48);

fn gpu() -> Option<Gpu> {
    match Gpu::open() {
        Ok(gpu) => Some(gpu),
        Err(error) if std::env::var_os("ISOPHOTE_REQUIRE_GPU").is_some() => panic!("{error}"),
        Err(error) => {
            eprintln!("skipped: {error}");
            None
        }
    }
}

/// A square of side 2 in the plane z = 0, facing +Z.
fn square() -> Primitive {
    let corner = |x: f32, y: f32| Vertex { position: [x, y, 0.0], ..Vertex::default() };
    Primitive {
        vertices: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        indices: vec![0, 1, 2, 0, 2, 3],
        ..Primitive::default()
    }
}

fn scene(primitives: Vec<Primitive>, nodes: Vec<Node>, channels: Vec<Channel>) -> Scene {
    let mut scene = Scene {
        name: "test".into(),
        meshes: primitives.into_iter().map(|p| Mesh { primitives: vec![p], ..Mesh::default() }).collect(),
        materials: vec![Material { metallic: 0.0, double_sided: false, ..Material::default() }],
        textures: Vec::new(),
        images: Vec::new(),
        order: (0..nodes.len()).collect(),
        draws: Vec::new(),
        nodes,
        cameras: Vec::new(),
        lights: Vec::new(),
        skins: Vec::new(),
        animations: vec![Animation { name: String::new(), channels }],
        bounds: Bounds { min: Vec3::splat(-1.0), max: Vec3::ONE, extremes: Vec::new() },
        warnings: Vec::new(),
        extensions: Vec::new(),
        files: Vec::new(),
    };
    scene.draws = (0..scene.nodes.len())
        .filter_map(|node| Some(isophote_scene::Draw { node, mesh: scene.nodes[node].mesh?, primitive: 0 }))
        .collect();
    scene
}

fn channel(node: usize, property: Property, values: &[f32]) -> Channel {
    let width = values.len() / 2;
    let channel = Channel {
        node,
        property,
        interpolation: Interpolation::Linear,
        times: vec![0.0, 1.0],
        values: values.to_vec(),
        width,
    };
    channel.validate().unwrap();
    channel
}

/// A parallel view along -Z that is 4 units high, from z = 5: one unit is 12 pixels.
fn view() -> View {
    View {
        world_to_view: Mat4::from_translation(Vec3::new(0.0, 0.0, -5.0)),
        projection: Projection::Orthographic { half_height: 2.0, near: 0.1, far: 10.0 },
    }
}

/// Renders the scene at each time and yields the targets of the last frame.
fn render(gpu: &Gpu, scene: &Scene, times: &[f32]) -> impl FnMut(&str) -> Picture {
    let mut renderer = Renderer::new(&gpu.device, &gpu.queue, scene, SIZE).unwrap();
    renderer.add_rest_positions();
    let mut pose = Pose::default();
    for &time in times {
        pose.update(scene, Some(0), time);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        renderer.encode(&mut encoder, scene, &pose, &view(), &Lighting::default());
        gpu.queue.submit([encoder.finish()]);
    }
    gpu.wait().unwrap();
    let (gpu, mut readback) = (gpu.clone(), Readback::default());
    move |name| {
        let targets = renderer.targets();
        let target: &Target = match name {
            "color" => &targets.color,
            "radiance" => &targets.radiance,
            "normal" => &targets.normal,
            "depth" => &targets.depth,
            "object_id" => &targets.object_id,
            "rest" => targets.rest.as_ref().expect("rest positions were asked for"),
            _ => &targets.motion,
        };
        readback.read(&gpu, &target.texture).unwrap()
    }
}

fn pixel(picture: &Picture, x: u32, y: u32) -> &[f32] {
    let start = (y * picture.width + x) as usize * picture.channels;
    &picture.data[start..start + picture.channels]
}

#[test]
fn the_geometry_buffer_says_what_is_where() {
    let Some(gpu) = gpu() else { return };
    let tilted = Node {
        mesh: Some(1),
        transform: isophote_scene::Transform::Matrix(
            Mat4::from_translation(Vec3::new(0.0, 0.0, 1.0))
                * Mat4::from_rotation_y(1.0)
                * Mat4::from_scale(Vec3::splat(0.4)),
        ),
        ..Node::default()
    };
    let nodes = vec![Node { mesh: Some(0), ..Node::default() }, tilted];
    let scene = scene(vec![square(), square()], nodes, vec![]);
    let mut read = render(&gpu, &scene, &[0.0]);
    let (normal, depth, id) = (read("normal"), read("depth"), read("object_id"));
    let (motion, color) = (read("motion"), read("color"));
    assert_eq!(pixel(&normal, 1, 1), [0.0; 4]);
    assert_eq!((pixel(&depth, 1, 1), pixel(&id, 1, 1)), (&[0.0][..], &[0.0][..]));
    assert_eq!(pixel(&normal, 22, 24), [0.0, 0.0, 1.0, 1.0]);
    assert!((pixel(&depth, 22, 24)[0] - 5.0).abs() < 1e-5);
    assert_eq!(pixel(&id, 22, 24), [1.0]);
    // The tilted square hides the middle of the other one.
    assert_eq!(pixel(&id, 32, 24), [2.0]);
    assert!((pixel(&normal, 32, 24)[0] - 1f32.sin()).abs() < 1e-3, "{:?}", pixel(&normal, 32, 24));
    let slope = 1f32.tan() * (0.5 / 12.0);
    assert!((pixel(&depth, 32, 24)[0] - 4.0 - slope).abs() < 1e-4, "{:?}", pixel(&depth, 32, 24));
    assert!(motion.data.iter().all(|v| *v == 0.0), "the first frame has no motion");
    assert!(color.data.iter().all(|v| v.is_finite() && (0.0..=1.0).contains(v)));
    assert!(color.data.as_chunks::<4>().0.iter().all(|p| p[3] == 1.0));
    // The square covers 24 pixels of the height exactly.
    let covered = (0..SIZE.1).filter(|y| pixel(&id, 22, *y)[0] > 0.0).count();
    assert_eq!(covered, 24);
}

#[test]
fn shifted_geometry_is_another_sample_of_the_frame() {
    let Some(gpu) = gpu() else { return };
    let nodes = vec![Node { mesh: Some(0), ..Node::default() }];
    let scene = scene(vec![square()], nodes, vec![]);
    let mut renderer = Renderer::new(&gpu.device, &gpu.queue, &scene, SIZE).unwrap();
    let (pose, lighting) = (Pose::at_rest(&scene), Lighting::default());
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    renderer.encode(&mut encoder, &scene, &pose, &view(), &lighting);
    gpu.queue.submit([encoder.finish()]);
    let mut readback = Readback::default();
    let still = readback.read(&gpu, &renderer.targets().object_id.texture).unwrap();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    renderer.encode_shifted(&mut encoder, (&scene, &pose, &view(), &lighting), [3.0, 2.0]);
    gpu.queue.submit([encoder.finish()]);
    let moved = readback.read(&gpu, &renderer.targets().object_id.texture).unwrap();
    let places = (0..SIZE.1 - 2).flat_map(|y| (0..SIZE.0 - 3).map(move |x| (x, y)));
    assert!(still.data.contains(&1.0));
    assert!(
        places.clone().all(|(x, y)| pixel(&moved, x + 3, y + 2) == pixel(&still, x, y)),
        "three pixels to the right and two down"
    );
    assert!(places.clone().any(|(x, y)| pixel(&moved, x, y) != pixel(&still, x, y)));
}

/// The position at rest of the surface at every covered pixel of a frame at time 0.5 must be what `at_rest` says of
/// where it is.
fn assert_rest(gpu: &Gpu, scene: &Scene, what: &str, at_rest: impl Fn(Vec2) -> Vec2) {
    let mut read = render(gpu, scene, &[0.5]);
    let (rest, id) = (read("rest"), read("object_id"));
    let mut covered = 0;
    for y in 0..SIZE.1 {
        for x in 0..SIZE.0 {
            let found = pixel(&rest, x, y);
            if pixel(&id, x, y)[0] == 0.0 {
                assert_eq!(found, [0.0; 4], "{what}: the background at {x}, {y}");
                continue;
            }
            covered += 1;
            let world = Vec2::new(x as f32 + 0.5 - 32.0, 24.0 - y as f32 - 0.5) / 12.0;
            let expected = at_rest(world).extend(0.0).extend(1.0);
            assert!(
                glam::Vec4::from_slice(found).abs_diff_eq(expected, 1e-4),
                "{what}: {found:?} instead of {expected} at {x}, {y}"
            );
        }
    }
    assert!(covered > 100, "{what} shows {covered} pixels");
}

/// Motion of every covered pixel of a frame at time 0.5 after one at 0.25 must equal what `moved` says.
fn assert_motion(gpu: &Gpu, scene: &Scene, what: &str, before: impl Fn(Vec2) -> Vec2) {
    let mut read = render(gpu, scene, &[0.25, 0.5]);
    let (motion, id) = (read("motion"), read("object_id"));
    let mut covered = 0;
    for y in 0..SIZE.1 {
        for x in 0..SIZE.0 {
            if pixel(&id, x, y)[0] == 0.0 {
                continue;
            }
            covered += 1;
            let world = Vec2::new(x as f32 + 0.5 - 32.0, 24.0 - y as f32 - 0.5) / 12.0;
            let expected = (before(world) - world) * Vec2::new(12.0, -12.0);
            let found = Vec2::from_slice(pixel(&motion, x, y));
            assert!(found.abs_diff_eq(expected, 2e-3), "{what}: {found} instead of {expected} at {x}, {y}");
        }
    }
    assert!(covered > 100, "{what} shows {covered} pixels");
}

#[test]
fn motion_and_rest_positions_follow_nodes_joints_and_morph_targets() {
    let Some(gpu) = gpu() else { return };
    let plain = vec![Node { mesh: Some(0), ..Node::default() }];
    let slide = [0.0, 0.0, 0.0, 1.0, -2.0, 0.0];
    let moving = scene(vec![square()], plain.clone(), vec![channel(0, Property::Translation, &slide)]);
    assert_motion(&gpu, &moving, "a node", |p| p - Vec2::new(0.25, -0.5));
    assert_rest(&gpu, &moving, "a node", |p| p - Vec2::new(0.5, -1.0));

    let turn = [Quat::IDENTITY.to_array(), Quat::from_rotation_z(2.0).to_array()].concat();
    let turning = scene(vec![square()], plain.clone(), vec![channel(0, Property::Rotation, &turn)]);
    assert_motion(&gpu, &turning, "a turning node", |p| Vec2::from_angle(-0.5).rotate(p));
    assert_rest(&gpu, &turning, "a turning node", |p| Vec2::from_angle(-1.0).rotate(p));

    let mut skinned = square();
    skinned.influence_sets = 2;
    let half = |joint| Influence { joints: [joint, 0, 0, 0], weights: [0.5, 0.0, 0.0, 0.0] };
    skinned.influences = (0..4).flat_map(|_| [half(0), half(1)]).collect();
    let nodes =
        vec![Node { mesh: Some(0), skin: Some(0), ..Node::default() }, Node::default(), Node::default()];
    let mut skinned = scene(vec![skinned], nodes, vec![channel(2, Property::Translation, &slide)]);
    skinned.skins = vec![Skin { joints: vec![1, 2], inverse_bind: vec![Mat4::IDENTITY; 2] }];
    assert_motion(&gpu, &skinned, "a joint of half weight", |p| p - Vec2::new(0.125, -0.25));
    assert_rest(&gpu, &skinned, "a joint of half weight", |p| p - Vec2::new(0.25, -0.5));

    let mut morphed = square();
    let delta = MorphDelta { position: [1.0, 0.0, 0.0], ..MorphDelta::default() };
    morphed.morph_targets = vec![vec![MorphDelta::default(); 4], vec![delta; 4]];
    let nodes = vec![Node { mesh: Some(0), weights: vec![0.0; 2], ..Node::default() }];
    let morphed = scene(vec![morphed], nodes, vec![channel(0, Property::Weights, &[0.0, 0.0, 0.0, 1.0])]);
    assert_motion(&gpu, &morphed, "a morph target", |p| p - Vec2::new(0.25, 0.0));
    assert_rest(&gpu, &morphed, "a morph target", |p| p - Vec2::new(0.5, 0.0));
}

#[test]
fn motion_is_the_same_after_a_frame_that_was_passed_over() {
    let Some(gpu) = gpu() else { return };
    let slide = [0.0, 0.0, 0.0, 1.0, -2.0, 0.0];
    let plain = vec![Node { mesh: Some(0), ..Node::default() }];
    let moving = scene(vec![square()], plain, vec![channel(0, Property::Translation, &slide)]);
    let drawn = render(&gpu, &moving, &[0.25, 0.5])("motion");
    let mut renderer = Renderer::new(&gpu.device, &gpu.queue, &moving, SIZE).unwrap();
    let mut pose = Pose::default();
    pose.update(&moving, Some(0), 0.25);
    renderer.pass_over(&moving, &pose, &view(), &Lighting::default());
    pose.update(&moving, Some(0), 0.5);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    renderer.encode(&mut encoder, &moving, &pose, &view(), &Lighting::default());
    gpu.queue.submit([encoder.finish()]);
    let passed = Readback::default().read(&gpu, &renderer.targets().motion.texture).unwrap();
    assert!(passed.data.iter().any(|v| *v != 0.0));
    assert_eq!(passed, drawn);
}

#[test]
fn control_maps_are_those_of_vertices_and_neutral_elsewhere() {
    let Some(gpu) = gpu() else { return };
    let small = Node {
        mesh: Some(1),
        transform: isophote_scene::Transform::Matrix(
            Mat4::from_translation(Vec3::new(0.0, 0.0, 1.0)) * Mat4::from_scale(Vec3::splat(0.25)),
        ),
        ..Node::default()
    };
    let nodes = vec![Node { mesh: Some(0), ..Node::default() }, small];
    let mut scene = scene(vec![square(), square()], nodes, vec![]);
    let rendered = |renderer: &mut Renderer, scene: &Scene| {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        renderer.encode(&mut encoder, scene, &Pose::at_rest(scene), &view(), &Lighting::default());
        gpu.queue.submit([encoder.finish()]);
        let control = renderer.targets().control.as_ref();
        control.map(|control| Readback::default().read(&gpu, &control.texture).unwrap())
    };
    let mut plain = Renderer::new(&gpu.device, &gpu.queue, &scene, SIZE).unwrap();
    plain.add_control(&scene).unwrap();
    assert_eq!(rendered(&mut plain, &scene), None, "no vertex has a value");
    let (left, right) = ([0.0, 1.0, 0.25, 0.5], [1.0, 0.0, 0.25, 0.75]);
    scene.meshes[0].primitives[0].control = vec![left, right, right, left];
    let mut renderer = Renderer::new(&gpu.device, &gpu.queue, &scene, (8, 8)).unwrap();
    assert_eq!(rendered(&mut renderer, &scene), None, "nobody asked for it");
    renderer.add_control(&scene).unwrap();
    renderer.resize(SIZE).unwrap();
    let control = rendered(&mut renderer, &scene).expect("the scene has values");
    let id = Readback::default().read(&gpu, &renderer.targets().object_id.texture).unwrap();
    for (x, y) in (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))) {
        let share = ((x as f32 + 0.5 - 32.0) / 12.0 + 1.0) * 0.5;
        let expected = match pixel(&id, x, y)[0] {
            1.0 => [0, 1, 2, 3].map(|k| left[k] + (right[k] - left[k]) * share),
            _ => [0.5; 4],
        };
        let found = pixel(&control, x, y);
        let is_near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-3);
        assert!(is_near, "{found:?} instead of {expected:?} at {x}, {y}");
    }
    assert_eq!([pixel(&id, 32, 24), pixel(&id, 22, 24), pixel(&id, 1, 1)], [[2.0], [1.0], [0.0]]);
}

#[test]
fn backs_are_hidden_holes_are_open_and_mirrors_keep_their_front() {
    let Some(gpu) = gpu() else { return };
    let covered = |scale: Vec3, change: fn(&mut Material)| {
        let transform = isophote_scene::Transform::Matrix(Mat4::from_scale(scale));
        let node = Node { mesh: Some(0), transform, ..Node::default() };
        let mut scene = scene(vec![square()], vec![node], vec![]);
        change(&mut scene.materials[0]);
        let mut read = render(&gpu, &scene, &[0.0]);
        let front = pixel(&read("normal"), 32, 24)[2];
        (read("object_id").data.iter().filter(|v| **v > 0.0).count(), front)
    };
    assert_eq!(covered(Vec3::ONE, |_| {}), (576, 1.0));
    assert_eq!(covered(Vec3::new(-1.0, 1.0, 1.0), |_| {}), (576, 1.0), "mirrored");
    assert_eq!(covered(Vec3::new(-1.0, 1.0, -1.0), |_| {}), (0, 0.0), "turned around");
    assert_eq!(
        covered(Vec3::new(-1.0, 1.0, -1.0), |m| m.double_sided = true),
        (576, 1.0),
        "seen from behind"
    );
    let hole = |m: &mut Material| {
        m.base_color.w = 0.3;
        m.alpha_mode = AlphaMode::Mask { cutoff: 0.5 };
    };
    assert_eq!(covered(Vec3::ONE, hole), (0, 0.0));
    assert_eq!(covered(Vec3::ONE, |m| m.base_color.w = 0.3), (576, 1.0), "opaque materials ignore alpha");
}

#[test]
fn unlit_blended_and_emissive_surfaces_have_their_radiance() {
    let Some(gpu) = gpu() else { return };
    let radiance = |change: fn(&mut Material)| {
        let mut scene = scene(vec![square()], vec![Node { mesh: Some(0), ..Node::default() }], vec![]);
        change(&mut scene.materials[0]);
        let mut read = render(&gpu, &scene, &[0.0]);
        let picture = read("radiance");
        pixel(&picture, 32, 24).to_vec()
    };
    let close = |found: &[f32], expected: [f32; 3]| {
        found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 2e-3 * (1.0 + e))
    };
    let unlit = radiance(|m| {
        m.unlit = true;
        m.base_color = Vec3::new(0.25, 0.5, 3.0).extend(1.0);
    });
    assert!(close(&unlit, [0.25, 0.5, 3.0]), "{unlit:?}");
    let glowing = radiance(|m| m.emissive = Vec3::new(20.0, 0.0, 0.0));
    let dark = radiance(|_| {});
    assert!(close(&glowing, [dark[0] + 20.0, dark[1], dark[2]]), "{glowing:?} {dark:?}");
    let behind = radiance(|m| m.base_color.w = 0.0);
    let glass = radiance(|m| {
        m.alpha_mode = AlphaMode::Blend;
        m.unlit = true;
        m.base_color = Vec3::ONE.extend(0.25);
    });
    let empty = radiance(|m| {
        m.alpha_mode = AlphaMode::Blend;
        m.base_color.w = 0.0;
    });
    assert_eq!(behind, dark);
    assert!(close(&glass, [0, 1, 2].map(|i| 0.25 + 0.75 * empty[i])), "{glass:?} {empty:?}");
}

#[test]
fn light_that_is_displayed_adds_up_to_the_colour() {
    let Some(gpu) = gpu() else { return };
    let mut scene = scene(vec![square()], vec![Node { mesh: Some(0), ..Node::default() }], vec![]);
    scene.materials[0].base_color = Vec3::new(0.9, 0.4, 0.02).extend(1.0);
    for (background, exposure) in [(Background::Sky, 1.0), (Background::Transparent, 6.0)] {
        let mut renderer = Renderer::new(&gpu.device, &gpu.queue, &scene, (8, 8)).unwrap();
        renderer.set_background(&background, false).unwrap();
        renderer.add_layers(ImageState::SceneReferred);
        assert!(renderer.targets().layers_in(ImageState::DisplayReferred).is_none(), "nobody asked for it");
        renderer.add_layers(ImageState::DisplayReferred);
        renderer.resize(SIZE).unwrap();
        let lighting = Lighting { exposure, ..Lighting::default() };
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        renderer.encode(&mut encoder, &scene, &Pose::at_rest(&scene), &view(), &lighting);
        gpu.queue.submit([encoder.finish()]);
        let read = |target: &Target| Readback::default().read(&gpu, &target.texture).unwrap();
        for state in [ImageState::SceneReferred, ImageState::DisplayReferred] {
            let [albedo, diffuse, specular] = renderer.targets().layers_in(state).unwrap().map(read);
            let color = read(renderer.targets().color_in(state));
            let at = |picture: &Picture, x, y| Vec3::from_slice(&pixel(picture, x, y)[..3]);
            let (sum, whole) = (at(&diffuse, 32, 24) + at(&specular, 32, 24), at(&color, 32, 24));
            assert!(
                (sum - whole).abs().max_element() < 3e-3 * whole.max_element(),
                "{sum} instead of {whole}"
            );
            assert!((at(&albedo, 32, 24) - Vec3::new(0.9, 0.4, 0.02)).abs().max_element() < 1e-3);
            assert!(whole.min_element() > 0.0 && at(&specular, 32, 24).min_element() > 0.0);
            assert_eq!((at(&diffuse, 1, 1), at(&albedo, 1, 1)), (Vec3::ZERO, Vec3::ZERO), "the background");
        }
    }
}

#[test]
fn sizes_beyond_the_device_are_refused_and_resizing_works() {
    let Some(gpu) = gpu() else { return };
    let scene = scene(vec![square()], vec![Node { mesh: Some(0), ..Node::default() }], vec![]);
    let most = gpu.device.limits().max_texture_dimension_2d;
    for size in [(0, 4), (4, 0), (most + 1, 4)] {
        let error = Renderer::new(&gpu.device, &gpu.queue, &scene, size).err().unwrap();
        assert_eq!(error.exit_code(), 2, "{error}");
    }
    let mut renderer = Renderer::new(&gpu.device, &gpu.queue, &scene, SIZE).unwrap();
    assert!(renderer.resize((0, 0)).is_err());
    let mut readback = Readback::default();
    for size in [(1, 1), (130, 7), (64, 48)] {
        renderer.resize(size).unwrap();
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        renderer.encode(&mut encoder, &scene, &Pose::at_rest(&scene), &view(), &Lighting::default());
        gpu.queue.submit([encoder.finish()]);
        let picture = readback.read(&gpu, &renderer.targets().color.texture).unwrap();
        assert_eq!((picture.width, picture.height), size);
        assert!(picture.data.iter().all(|v| v.is_finite()));
    }
}

#[test]
fn errors_of_the_device_become_results() {
    let Some(gpu) = gpu() else { return };
    let _ = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("too large"),
        size: u64::MAX / 2,
        usage: wgpu::BufferUsages::STORAGE,
        mapped_at_creation: false,
    });
    let error = gpu.check().unwrap_err();
    assert_eq!(error.exit_code(), 1);
    assert_eq!(error.to_string().lines().count(), 1);
    gpu.check().unwrap();
}
