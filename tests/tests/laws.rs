//! The laws of the house: names, orphans, promises, documents.

mod locks;
mod texts;

use isophote::kernels::KERNELS;
use isophote::registry;
use isophote_tests::lengths::{Function, functions};
use isophote_tests::shaders;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const GROUPS: [&str; 9] =
    ["structure", "smoothing", "lines", "painting", "strokes", "coherence", "colour", "time", "styles"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Stems of the files `dir/<group>/<stem>.<ext>`, as `group/stem`.
fn stems(dir: &Path, ext: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for group in std::fs::read_dir(dir).unwrap().flatten().filter(|e| e.path().is_dir()) {
        let group_name = group.file_name().into_string().unwrap();
        for file in std::fs::read_dir(group.path()).unwrap().flatten() {
            if file.path().extension().is_some_and(|e| e == ext) {
                found.insert(format!("{group_name}/{}", file.path().file_stem().unwrap().display()));
            }
        }
    }
    found
}

/// Files of the repository's own with one of these endings, without build results.
fn sources(endings: &[&str]) -> Vec<PathBuf> {
    fn walk(dir: &Path, endings: &[&str], found: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(dir).unwrap().flatten() {
            let (path, name) = (entry.path(), entry.file_name().into_string().unwrap_or_default());
            if path.is_dir() {
                if !name.starts_with('.') && !["target", "out", "node_modules"].contains(&name.as_str()) {
                    walk(&path, endings, found);
                }
            } else if endings.iter().any(|e| name.ends_with(e)) {
                found.push(path);
            }
        }
    }
    let mut found = Vec::new();
    for room in ["include", "nodes", "host-example", "tests", "xtask", "shaders"] {
        walk(&root().join(room), endings, &mut found);
    }
    found
}

#[test]
fn every_kernel_is_one_shader_and_one_twin_of_its_name() {
    // What helps only GPUs or only CPUs has no counterpart on the other side; all else has, what kernels
    // share as well as they themselves.
    let mut shader_files = stems(&shaders::folder(), "wgsl");
    shader_files.retain(|s| !s.starts_with("gpu/"));
    let mut twins = stems(&root().join("nodes/library/src/kernels"), "rs");
    twins.retain(|s| !s.starts_with("simd/") && !s.starts_with("trace/"));
    assert_eq!(shader_files, twins);
    assert!(twins.iter().filter(|t| t.starts_with("shared/")).count() > 5);
    twins.retain(|t| !t.starts_with("shared/"));
    let names: BTreeSet<String> = KERNELS.iter().map(|k| k.name.to_owned()).collect();
    let files: BTreeSet<String> =
        twins.iter().map(|t| t.rsplit('/').next().unwrap_or_default().to_owned()).collect();
    assert_eq!(names, files);
    assert_eq!(names.len(), KERNELS.len(), "two kernels share a name");
}

#[test]
fn shaders_are_the_sum_of_their_pieces() {
    for kernel in KERNELS {
        let imports = kernel.pieces.imports.iter().flat_map(|import| import.text);
        let pieces = imports.chain(kernel.pieces.own).chain(kernel.pieces.entry);
        let text: String = pieces.map(|piece| piece.text()).collect();
        assert!(text == kernel.shader, "{}:\n{text}", kernel.name);
        assert_eq!(kernel.pieces.textures.len(), kernel.inputs, "{}", kernel.name);
    }
}

#[test]
fn every_node_is_a_file_of_its_name_and_in_the_registry() {
    let files = stems(&root().join("nodes/library/src/nodes"), "rs");
    let nodes: BTreeSet<String> = registry::nodes().iter().map(|n| format!("{}/{}", n.group, n.id)).collect();
    assert_eq!(files, nodes);
    assert_eq!(nodes.len(), registry::nodes().len(), "two nodes share an id");
}

#[test]
fn every_group_is_one_of_the_house() {
    let dirs =
        [shaders::folder(), root().join("nodes/library/src/kernels"), root().join("nodes/library/src/nodes")];
    for dir in dirs {
        for entry in std::fs::read_dir(&dir).unwrap().flatten().filter(|e| e.path().is_dir()) {
            let name = entry.file_name().into_string().unwrap();
            let is_drawer = ["shared", "gpu", "simd", "trace"].contains(&&*name);
            assert!(GROUPS.contains(&&*name) || is_drawer, "{}", entry.path().display());
        }
    }
}

/// Ids that users' graphs, presets and scripts refer to. They are for ever: a node may gain parameters,
/// and never lose or rename one.
const PROMISED: &[(&str, &[&str])] = &[
    (
        "structure_tensor",
        &[
            "derivative",
            "sigma_g",
            "rho",
            "space",
            "normalize",
            "relax_threshold",
            "relax_steps",
            "levels",
            "oversample",
            "guide_weight",
        ],
    ),
    ("edge_tangent_flow", &["radius", "kernel", "iterations", "separable"]),
    ("tensor_view", &["show", "sigma", "k", "alpha", "rho"]),
    ("gaussian", &["sigma", "mix"]),
    ("bilateral", &["kernel", "sigma_d", "sigma_r", "iterations", "space", "mix"]),
    ("anisotropic_diffusion", &["scheme", "time_step", "iterations", "contrast", "rho", "sigma", "mix"]),
    ("mean_curvature_flow", &["constraint", "iterations", "time_step", "shock_every", "mix"]),
    ("oil_paint", &["detail", "saturation", "lights", "darks", "mix"]),
    ("watercolor", &["detail", "saturation", "lights", "darks", "mix"]),
    ("morphology", &["operator", "radius", "mix"]),
    ("flow_dilation", &["length", "seed", "mix"]),
    (
        "oriented_bilateral",
        &["sigma_dg", "sigma_dt", "sigma_rg", "sigma_rt", "iterations", "sampling", "anisotropy", "mix"],
    ),
    (
        "flow_bilateral",
        &[
            "sigma_dg",
            "sigma_dt",
            "sigma_rg",
            "sigma_rt",
            "iterations",
            "sampling",
            "integrator",
            "placement",
            "mix",
        ],
    ),
    ("line_integral_convolution", &["sigma", "integrator", "adapt", "max_angle", "step", "mix"]),
    (
        "difference_of_gaussians",
        &["sigma_e", "k", "form", "tau", "epsilon", "phi", "p", "epsilon_p", "phi_p", "threshold"],
    ),
    (
        "flow_dog",
        &[
            "sigma_e",
            "k",
            "form",
            "tau",
            "epsilon",
            "phi",
            "p",
            "epsilon_p",
            "phi_p",
            "threshold",
            "sigma_m",
            "iterations",
            "kernel",
            "integrator",
            "guide_weight",
        ],
    ),
    ("kuwahara", &["radius", "regions", "mix"]),
    ("generalized_kuwahara", &["radius", "sectors", "q", "threshold", "method", "mix"]),
    (
        "anisotropic_kuwahara",
        &[
            "radius",
            "sectors",
            "q",
            "threshold",
            "alpha",
            "weights",
            "iterations",
            "levels",
            "p_s",
            "p_d",
            "tau_v",
            "tau_w",
            "mix",
        ],
    ),
    ("painting", &["brush_size", "detail", "stroke_length", "sharpness", "saturation", "mix"]),
    (
        "quantize_luminance",
        &["bins", "phi_q", "adaptive", "lambda_delta", "omega_delta", "lambda_phi", "omega_phi", "mix"],
    ),
    ("composite_lines", &["color", "opacity", "paper", "mix"]),
    (
        "cartoon",
        &[
            "line_width",
            "line_amount",
            "suppress_small",
            "line_color",
            "detail",
            "posterize",
            "posterize_smooth",
            "saturation",
            "mix",
        ],
    ),
    ("edge_detector", &["method", "sigma", "low", "high"]),
    (
        "ink",
        &[
            "style",
            "line_width",
            "line_amount",
            "suppress_small",
            "line_color",
            "detail",
            "saturation",
            "mix",
        ],
    ),
    ("blueprint", &["line_width", "line_color", "paper_color", "grid", "paper_texture", "fill", "mix"]),
    ("shock", &["variant", "sigma_g", "sigma_i", "radius", "threshold", "iterations", "time_step", "mix"]),
    (
        "coherence_enhancing",
        &[
            "iterations",
            "rho",
            "relax_threshold",
            "sigma_t",
            "max_angle",
            "adapt",
            "shock",
            "sigma_g",
            "sigma_i",
            "radius",
            "threshold",
            "sigma_a",
            "mix",
        ],
    ),
    ("warp_sharpen", &["sigma_w", "phi_w", "mix"]),
    ("coherent", &["detail", "posterize", "saturation", "lights", "darks", "mix"]),
];

#[test]
fn promised_ids_are_there() {
    let mut missing = Vec::new();
    for &(node, params) in PROMISED {
        match registry::find(node) {
            Ok(spec) => {
                let lost = params.iter().filter(|p| spec.param(p).is_none());
                missing.extend(lost.map(|p| format!("{node}.{p}")));
            }
            Err(_) => missing.push((*node).to_owned()),
        }
    }
    assert!(missing.is_empty(), "missing: {}", missing.join(", "));
}

/// A closure that is handed on is compiled for every machine where it is not inlined, and calls a function for each
/// operation on vectors.
#[test]
fn closures_handed_on_by_kernels_are_inlined() {
    let kernels = root().join("nodes/library/src/kernels");
    let (mut found, mut wrong) = (0, Vec::new());
    for path in sources(&[".rs"]).into_iter().filter(|path| path.starts_with(&kernels)) {
        let text = std::fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        let mut before = "";
        for (n, line) in code.lines().map(str::trim).enumerate() {
            let is_alone = line.starts_with('|') && line.ends_with("| {");
            let is_behind_others = line.ends_with("| {") && line.contains("(band, |");
            let is_inlined = before == "#[inline(always)]" || line.contains("#[inline(always)] |");
            found += usize::from(is_alone);
            if (is_alone && !is_inlined) || is_behind_others {
                wrong.push(format!("{}:{}: {line}", path.display(), n + 1));
            }
            before = line;
        }
    }
    assert!(found > 30, "{found}");
    assert!(wrong.is_empty(), "without #[inline(always)] before them:\n{}", wrong.join("\n"));
}

/// Lines of a file, and of a function, at most.
const LINES_OF_A_FILE: usize = 500;
const LINES_OF_A_FUNCTION: usize = 60;

#[test]
fn every_function_stays_short() {
    let mut counted = 0;
    let mut wrong = Vec::new();
    for path in sources(&[".rs"]) {
        let found = functions(&std::fs::read_to_string(&path).unwrap());
        counted += found.len();
        for function in found.iter().filter(|function| function.lines > LINES_OF_A_FUNCTION) {
            let Function { name, line, lines } = function;
            wrong.push(format!("{}:{line}: {name} has {lines} lines", path.display()));
        }
    }
    assert!(counted > 1000, "{counted}");
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn every_file_says_what_it_is_for_and_stays_short() {
    let mut wrong = Vec::new();
    for path in sources(&[".rs", ".wgsl"]) {
        let text = std::fs::read_to_string(&path).unwrap();
        let opening = if path.extension().is_some_and(|e| e == "rs") { "//!" } else { "//" };
        let first = text.lines().find(|l| !l.is_empty() && !l.starts_with("#import "));
        if !first.is_some_and(|l| l.starts_with(opening)) {
            wrong.push(format!("{} does not open with what it is for", path.display()));
        }
        if text.lines().count() > LINES_OF_A_FILE {
            wrong.push(format!("{} has {} lines", path.display(), text.lines().count()));
        }
    }
    for stem in stems(&shaders::folder(), "wgsl") {
        let text = std::fs::read_to_string(shaders::folder().join(format!("{stem}.wgsl"))).unwrap();
        let is_kernel = !stem.starts_with("shared/") && !stem.starts_with("gpu/");
        if is_kernel && !text.contains("Cost:") {
            wrong.push(format!("shaders/{stem}.wgsl does not state its cost per pixel"));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn tests_without_the_built_in_harness_list_all_of_theirs() {
    // There the attribute does nothing, and what bears it would never run.
    let attribute = ["#[", "test]"].concat();
    let manifest = std::fs::read_to_string(root().join("tests/Cargo.toml")).unwrap();
    let own: Vec<&str> = manifest
        .split("[[test]]")
        .skip(1)
        .filter(|table| table.contains("harness = false"))
        .filter_map(|table| table.split('"').nth(1))
        .collect();
    assert!(!own.is_empty());
    for path in sources(&[".rs"]) {
        let Ok(inner) = path.strip_prefix(root().join("tests/tests")) else { continue };
        let first = inner.components().next().unwrap().as_os_str().to_str().unwrap();
        if own.contains(&first.trim_end_matches(".rs")) {
            let text = std::fs::read_to_string(&path).unwrap();
            assert!(!text.lines().any(|l| l.trim() == attribute), "{} has {attribute}", path.display());
        }
    }
}

#[test]
fn unsafe_code_stays_in_its_rooms_and_each_block_has_a_reason() {
    // Spelt in two parts, so that this file does not find itself.
    let keyword = ["un", "safe"].concat();
    let mut wrong = Vec::new();
    for path in sources(&[".rs"]) {
        let text = std::fs::read_to_string(&path).unwrap();
        let shown = path.display().to_string();
        // The tests' loader loads as a host does; what asks a driver for machine code calls it through pointers.
        let rooms = [
            "nodes/plugin",
            "nodes/godot/src/entry.rs",
            "nodes/python",
            "nodes/loader",
            "include",
            "tests/tests",
            "tests/src/library.rs",
            "tests/src/ofx",
            "xtask/gpu-cost/src/driver.rs",
        ];
        let allowed = rooms.iter().any(|room| shown.contains(room));
        let uses = |line: &str| {
            let code = line.split("//").next().unwrap_or("");
            let block = code.contains(&format!("{keyword} {{")) || code.contains(&format!("{keyword} impl"));
            let function =
                code.contains(&format!("{keyword} fn")) || code.contains(&format!("{keyword} extern"));
            (block, block || function)
        };
        for (number, line) in text.lines().enumerate() {
            let (block, any) = uses(line);
            if any && !allowed {
                wrong.push(format!("{shown}:{} is {keyword}", number + 1));
            }
            let above: Vec<&str> = text.lines().take(number + 1).collect();
            let reasoned = above.iter().rev().take(8).any(|l| l.contains("SAFETY"));
            if block && !reasoned {
                wrong.push(format!("{shown}:{} has no SAFETY reason", number + 1));
            }
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// Formats of files, names in Rust of what reads each, and the one place of the product that may name it. The pictures that
/// artists bring are read by `pictures`, with every depth and colour space that they have; textures of scenes become eight
/// bits within the scene's budget; pictures that lie in the program itself need no care.
const READERS: [(&str, &[&str], &[&str]); 11] = [
    ("OpenEXR", &["exr::prelude", "exr::meta", "exr::block", "exr::error"], &["host-example/exr-edit/src/"]),
    ("PNG", &["PngDecoder"], &["host-example/pictures/src/"]),
    ("JPEG", &["JpegDecoder"], &["host-example/pictures/src/"]),
    ("WebP", &["WebPDecoder"], &["host-example/pictures/src/"]),
    ("TIFF", &["TiffDecoder", "tiff::decoder"], &["host-example/pictures/src/"]),
    ("HDR", &["HdrDecoder"], &["host-example/pictures/src/"]),
    (
        "a picture of eight bits",
        &["ImageReader", "image::open", "load_from_memory"],
        &[
            "host-example/scene/src/decode.rs",
            "host-example/window/src/app/desktop.rs",
            "host-example/window/src/state/samples.rs",
        ],
    ),
    ("DDS", &["dds::Dec"], &["host-example/scene/src/decode.rs"]),
    ("glTF", &["gltf::"], &["host-example/scene/src/gltf_file"]),
    ("OBJ", &["tobj::"], &["host-example/scene/src/obj_file"]),
    ("a preset", &["\"between\""], &["nodes/library/src/preset"]),
];

#[test]
fn no_format_has_two_readers() {
    let mut wrong = Vec::new();
    let mut found = BTreeSet::new();
    for path in sources(&[".rs"]) {
        let shown = path.strip_prefix(root()).unwrap().to_string_lossy().replace('\\', "/");
        let is_product = shown.starts_with("nodes/") || shown.starts_with("host-example/");
        if !is_product
            || shown.contains("/tests/")
            || shown.contains("/examples/")
            || shown.ends_with("/tests.rs")
        {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap_or("");
        for (number, line) in (1..).zip(code.lines()) {
            let line = line.split("//").next().unwrap_or("");
            for (format, names, places) in READERS {
                if names.iter().any(|name| line.contains(name)) {
                    found.insert(format);
                    if !places.iter().any(|place| shown.starts_with(place)) {
                        wrong.push(format!(
                            "{shown}:{number} reads {format}, which {} does",
                            places.join(", ")
                        ));
                    }
                }
            }
        }
    }
    assert_eq!(found.len(), READERS.len(), "{found:?}");
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}
