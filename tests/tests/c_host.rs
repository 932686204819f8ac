//! Hosts in C: compiled with the system's compiler, run on a picture, and run again under valgrind.

use isophote::engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote::engine::pixels::{Sample, read_row, write_row};
use isophote::engine::program::Program;
use isophote::engine::{Image, Rect};
use isophote::graph::GraphInput;
use isophote::spec::{ImageKind, NodeSpec};
use isophote::{Graph, Planned, Request};
use isophote_abi::*;
use isophote_tests::library;
use isophote_tests::trials::Trials;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::{Mutex, OnceLock, PoisonError};
use tempfile::TempDir;

const WARNINGS: [&str; 5] = ["-Wall", "-Wextra", "-pedantic", "-Werror", "-g"];

/// Tests by their names.
macro_rules! named {
    ($($test:ident)*) => { [$((concat!("c_host::", stringify!($test)), $test as fn())),*] };
}

/// Adds the trials of this file.
pub fn add(trials: &mut Trials) {
    // Those under valgrind take longest.
    for (name, test) in named! {
        a_c_program_lists_the_nodes_and_stylizes_under_valgrind
        a_c_program_prints_a_plan_as_data_under_valgrind
        a_c_program_stylizes_frames_on_its_own_vulkan_device
        a_c_program_runs_plans_with_vulkan
        the_header_is_cpp_too
        the_header_has_the_layout_of_the_declarations
        bad_arguments_of_the_c_program_are_one_line_each
        a_c_program_may_end_without_cleaning_up
        the_library_exports_the_entries_of_its_two_faces_and_no_more
        the_library_needs_nothing_but_what_every_system_has
        the_committed_header_is_the_generated_one
    } {
        trials.add_plain(name, test);
    }
    for node in nodes() {
        trials.add("c_host::a_c_program_stylizes", node.id, || {
            stylize(node.id, &[], false, 157, 101);
        });
        trials.add("c_host::a_c_program_prints_the_plan", node.id, || plan(node.id, false));
    }
}

/// True where a tool that the tests need is there; where it must be, its absence fails.
fn has(tool: &str) -> bool {
    if Command::new(tool).arg("--version").output().is_ok_and(|o| o.status.success()) {
        return true;
    }
    assert!(std::env::var("CI").is_err(), "{tool} is missing; install it");
    eprintln!("\n*** SKIPPED: a test of the C header needs {tool} ***\n");
    false
}

fn folder() -> &'static Path {
    static FOLDER: OnceLock<TempDir> = OnceLock::new();
    FOLDER.get_or_init(|| TempDir::new().expect("a folder for the test")).path()
}

/// One of the programs of `tests/c`, compiled once in a process and without a warning.
fn compiled(source: &'static str) -> Option<PathBuf> {
    static PROGRAMS: Mutex<Option<HashMap<&str, Option<PathBuf>>>> = Mutex::new(None);
    let mut programs = PROGRAMS.lock().unwrap_or_else(PoisonError::into_inner);
    programs.get_or_insert_default().entry(source).or_insert_with(|| compile(source)).clone()
}

fn compile(source: &str) -> Option<PathBuf> {
    let (compiler, standard) =
        if source.ends_with(".cpp") { ("c++", "-std=c++17") } else { ("cc", "-std=c11") };
    if !has(compiler) {
        return None;
    }
    let program = folder().join(format!("{source}.program"));
    let output = Command::new(compiler)
        .arg(standard)
        .args(WARNINGS)
        .arg("-I")
        .arg(library::root().join("include"))
        .arg(library::root().join("tests/c").join(source))
        .arg("-o")
        .arg(&program)
        .arg("-ldl")
        .args(if source.starts_with("vulkan") { &["-lvulkan", "-lm", "-lpthread"][..] } else { &[] })
        .output()
        .expect("the compiler can be started");
    assert!(output.status.success(), "{source}:\n{}", String::from_utf8_lossy(&output.stderr));
    Some(program)
}

/// Text that a run printed; its failure fails the test.
fn printed(output: &Output, what: &str) -> String {
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{what}: {}\n{errors}", output.status);
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// The arguments as they are, or valgrind's in front of them.
fn command(program: &Path, under_valgrind: bool) -> Command {
    if !under_valgrind {
        return Command::new(program);
    }
    let mut command = Command::new("valgrind");
    command.args(["--quiet", "--error-exitcode=99", "--leak-check=full"]);
    command.args(["--show-leak-kinds=definite", "--errors-for-leak-kinds=definite"]);
    let known = library::root().join("tests/c/valgrind.supp");
    command.arg(format!("--suppressions={}", known.display()));
    command.arg(program);
    command
}

/// A PPM of a slanted edge, a disc and grain.
fn picture(width: u32, height: u32) -> Vec<u8> {
    let mut ppm = format!("P6\n{width} {height}\n255\n").into_bytes();
    for y in 0..height {
        for x in 0..width {
            let (dx, dy) = (x as f32 - width as f32 * 0.6, y as f32 - height as f32 * 0.5);
            let disc = dx * dx + dy * dy < (height * height) as f32 * 0.08;
            let light = if x + y < width / 2 { 40 } else { 150 };
            let grain = (x * 7919 + y * 104_729) % 31;
            ppm.extend([light + grain, if disc { 220 } else { light }, 255 - light].map(|v| v as u8));
        }
    }
    ppm
}

fn pixels(ppm: &[u8], width: u32, height: u32) -> &[u8] {
    let start = format!("P6\n{width} {height}\n255\n");
    let pixels = ppm.strip_prefix(start.as_bytes()).expect("a PPM of the same size");
    assert_eq!(pixels.len() as u32, width * height * 3);
    pixels
}

/// Nodes that the programs can be given: all inputs that they need are the colour or a tensor.
fn nodes() -> impl Iterator<Item = &'static NodeSpec> {
    let given = |kind: ImageKind| matches!(kind, ImageKind::Color | ImageKind::Tensor);
    isophote::registry::nodes().iter().copied().filter(move |node| {
        node.id != "structure_tensor" && node.inputs.iter().all(|p| p.optional || given(p.kind))
    })
}

/// The graph that the programs build of a node, through the Rust crate.
fn planned(node: &str, settings: &[&str], width: u32, height: u32) -> Planned {
    let mut graph = Graph::new();
    let tensor = graph.add("structure_tensor", "structure_tensor").unwrap();
    let styled = graph.add(node, node).unwrap();
    for id in [tensor, styled] {
        for port in graph.spec(id).unwrap().inputs {
            match port.kind {
                ImageKind::Color => graph.connect_input(GraphInput::Color, id, port.id).unwrap(),
                ImageKind::Tensor => graph.connect(tensor, id, port.id).unwrap(),
                _ => {}
            }
        }
    }
    graph.set_output(styled).unwrap();
    for setting in settings {
        let (param, value) = setting.split_once('=').unwrap();
        graph.set_text(styled, param, value).unwrap();
    }
    Planned::new(&graph, Request::new(width, height)).unwrap()
}

/// Result that the programs compute, through the Rust crate.
fn reference(planned: &Planned, rgb: &[u8]) -> Vec<u8> {
    let [width, height] = planned.plan().size();
    let mut image = Image::new(width, height, 4).unwrap();
    read_row(rgb, Sample::U8, 3, image.data_mut(), 4);
    let region = Rect::of_size(width, height);
    let result = CpuExecutor::new()
        .run(planned.plan(), &[("color", &image)], region, &CallingThread, Control::default())
        .unwrap()
        .remove(0);
    let mut out = vec![0; rgb.len()];
    write_row(result.data(), result.channels() as usize, &mut out, Sample::U8, 3);
    out
}

/// A run of one of the programs that stylize a picture.
struct Run {
    /// Text that it printed.
    text: String,
    /// The picture, 8-bit RGB.
    before: Vec<u8>,
    /// Bytes that it wrote.
    after: Vec<u8>,
}

/// Lets a program stylize a picture of this size.
fn run(mut program: Command, node: &str, settings: &[&str], [width, height]: [u32; 2]) -> Run {
    let folder = TempDir::new_in(folder()).expect("the folder is writable");
    let (input, output) = (folder.path().join("in.ppm"), folder.path().join("out.ppm"));
    let before = picture(width, height);
    std::fs::write(&input, &before).expect("the folder is writable");
    program.arg(library::path()).args([&input, &output]).arg(node).args(settings);
    let text = printed(&program.output().expect("the program can be started"), node);
    let after = std::fs::read(&output).expect("the program wrote a picture");
    let (before, after) = (pixels(&before, width, height).to_vec(), pixels(&after, width, height).to_vec());
    let changed = before.iter().zip(&after).filter(|(a, b)| a.abs_diff(**b) > 2).count();
    // Sharpening touches the edges alone, which are few.
    // A picture by itself is steady.
    let is_still = ["steady", "optical_flow"].contains(&node);
    let is_changed = changed * 40 > before.len() || is_still;
    assert!(is_changed, "{node} hardly changed it: {changed} of {}", before.len());
    assert!(is_still || after.iter().any(|v| *v != after[0]), "{node}: the picture is blank");
    Run { text, before, after }
}

/// Runs the program and compares with the Rust crate; returns what it printed.
fn stylize(node: &str, settings: &[&str], under_valgrind: bool, width: u32, height: u32) -> Option<String> {
    let program = compiled("stylize.c")?;
    let Run { text, before, after } = run(command(&program, under_valgrind), node, settings, [width, height]);
    assert!(text.contains(&format!("{width}x{height} pixels, 100 % done, 0 samples replaced")), "{text}");
    let expected = reference(&planned(node, settings, width, height), &before);
    let worst = expected.iter().zip(&after).map(|(a, b)| a.abs_diff(*b)).max();
    assert_eq!(worst, Some(0), "{node} is another through C");
    Some(text)
}

fn a_c_program_lists_the_nodes_and_stylizes_under_valgrind() {
    let settings = ["sigma_dg=1.5", "sigma_dt=2", "iterations=1"];
    let Some(text) = stylize("oriented_bilateral", &settings, has("valgrind"), 61, 37) else { return };
    for node in isophote::registry::nodes() {
        let line = format!("\n{} ({}):", node.id, node.group);
        let listed = text.split(&line).nth(1).and_then(|rest| rest.lines().next());
        let listed: Vec<&str> = listed.unwrap_or_default().split_whitespace().collect();
        assert_eq!(listed, node.params().map(|p| p.id).collect::<Vec<_>>(), "{} in\n{text}", node.id);
    }
}

/// True where a file of a package is there; where it must be, its absence fails.
fn has_file(path: &str, package: &str) -> bool {
    if Path::new(path).exists() {
        return true;
    }
    assert!(std::env::var("CI").is_err(), "{package} is missing; install it");
    eprintln!("\n*** SKIPPED: a part of the test of plans under Vulkan needs {package} ***\n");
    false
}

/// Drivers that compute on the CPU forgive barriers that are missing; this lets the validation layer find them.
const SYNCHRONIZATION: [&str; 2] =
    ["VK_LAYER_ENABLES", "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT"];

fn has_vulkan_headers() -> bool {
    has_file("/usr/include/vulkan/vulkan.h", "libvulkan-dev")
}

fn has_validation() -> bool {
    let layer = "/usr/share/vulkan/explicit_layer.d/VkLayer_khronos_validation.json";
    std::env::var_os("VK_LAYER_PATH").is_some() || has_file(layer, "vulkan-validationlayers")
}

const FRAMES: &str = "1000";

fn a_c_program_stylizes_frames_on_its_own_vulkan_device() {
    if !has_vulkan_headers() {
        return;
    }
    let Some(program) = compiled("vulkan_host.c") else { return };
    let source = library::root().join("tests/c/vulkan_scene.wgsl");
    let source = std::fs::read_to_string(source).expect("the scene's shaders are there");
    let scene = folder().join("vulkan_scene.spv");
    let words: Vec<u8> = spirv(&source).into_iter().flat_map(u32::to_ne_bytes).collect();
    std::fs::write(&scene, words).expect("the folder is writable");
    let [name, value] = SYNCHRONIZATION;
    let mut command = Command::new(program);
    command.env(name, value).arg(library::path()).arg(scene).args([FRAMES, "1"]);
    // A sample that differs and a message of the validation layer fail the program.
    let text = printed(&command.output().expect("the program can be started"), "vulkan_host");
    let validated = if has_validation() { "validated" } else { "not validated" };
    assert!(text.contains(&format!(", {validated}: {FRAMES} frames, ")), "{text}");
    assert!(text.trim_end().ends_with(" frames compared, 0 samples wrong"), "{text}");
    println!("{text}");
}

fn spirv(source: &str) -> Vec<u32> {
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    let module = naga::front::wgsl::parse_str(source).expect("the shaders can be read");
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module);
    let info = info.expect("the shaders are valid");
    naga::back::spv::write_vec(&module, &info, &Default::default(), None).expect("SPIR-V can express them")
}

fn a_c_program_runs_plans_with_vulkan() {
    if !has_vulkan_headers() {
        return;
    }
    let (Some(executes), Some(processes)) = (compiled("vulkan.c"), compiled("stylize.c")) else { return };
    let is_validated = has_validation();
    let cases: [(&str, &[&str]); 3] =
        [("cartoon", &[]), ("cartoon", &["posterize=4", "sigma_d=5"]), ("flow_dog", &[])];
    for (node, settings) in cases {
        let mut program = Command::new(&executes);
        let [name, value] = SYNCHRONIZATION;
        program.env(name, value);
        // A message of the validation layer fails the program.
        let ours = run(program, node, settings, [157, 101]);
        assert_eq!(ours.text.contains(", validated: "), is_validated, "{}", ours.text);
        let theirs = run(Command::new(&processes), node, settings, [157, 101]);
        // The twins agree to less than a step of 8 bits, which may fall on either side of a rounding; where
        // lines are thresholded a few pixels may tip over.
        let apart =
            |steps: u8| ours.after.iter().zip(&theirs.after).filter(|(a, b)| a.abs_diff(**b) > steps).count();
        assert!(apart(0) * 100 <= ours.after.len(), "{node}: {} samples differ", apart(0));
        assert!(apart(1) * 1000 <= ours.after.len(), "{node}: {} samples differ by more", apart(1));
    }
}

/// Runs the program and compares its passes with those of the Rust crate.
fn plan(node: &str, under_valgrind: bool) {
    let Some(program) = compiled("plan.c") else { return };
    let run = command(&program, under_valgrind)
        .arg(library::path())
        .args(["320", "200", node])
        .output()
        .expect("the program can be started");
    let text = printed(&run, "plan");
    let planned = planned(node, &[], 320, 200);
    let program = Program::lower(planned.plan(), Rect::of_size(320, 200)).unwrap();
    assert!(text.contains("input color, 320x200 rgba32float"), "{text}");
    assert!(text.contains("output output, 320x200 "), "{text}");
    let passes: Vec<&str> = text.lines().filter(|l| l.starts_with("pass ")).collect();
    assert_eq!(passes.len(), program.dispatches.len(), "{text}");
    for (index, (line, dispatch)) in passes.iter().zip(&program.dispatches).enumerate() {
        let (params, [x, y, _]) = (dispatch.params.len(), dispatch.workgroups);
        let start = format!(
            "pass {index}: {}, uniforms of 128 and {params} bytes, {x}x{y}x1 workgroups, reads",
            dispatch.shader.name
        );
        assert!(line.starts_with(&start), "{line} is not {start}");
    }
    for language in ["WGSL", "SPIR-V", "HLSL", "MSL", "GLSL"] {
        let shaders = text.lines().filter(|l| l.starts_with(&format!("  {language}, "))).count();
        assert_eq!(shaders, passes.len(), "{language} in\n{text}");
    }
    for head in ["    magic 07230203", "    #version 430 core", "    // language: metal2.0"] {
        assert_eq!(text.matches(head).count(), passes.len(), "{head} in\n{text}");
    }
}

fn a_c_program_prints_a_plan_as_data_under_valgrind() {
    plan("oriented_bilateral", has("valgrind"));
}

fn the_header_is_cpp_too() {
    let Some(program) = compiled("header_cpp.cpp") else { return };
    printed(&Command::new(program).output().expect("the program can be started"), "header_cpp");
}

fn the_header_has_the_layout_of_the_declarations() {
    macro_rules! sizes {
        ($($name:ident)*) => { [$((stringify!($name), size_of::<$name>())),*] };
    }
    let sizes = sizes! {
        IsophoteText IsophoteRect IsophoteChoice IsophotePort IsophoteParam IsophoteNode IsophoteCatalogue
        IsophoteValue IsophoteRequest IsophoteImage IsophoteTarget IsophoteInput IsophoteSupport
        IsophotePassTime IsophoteControl IsophoteReport IsophoteTexture IsophotePass IsophoteBinding IsophoteShader IsophoteApi
        IsophoteVulkanNeeds IsophoteVulkanHost IsophoteVulkanImage IsophoteVulkanSemaphore IsophoteVulkanApi
    };
    let Some(program) = compiled("layout.c") else { return };
    let text = printed(&Command::new(program).output().expect("the program can be started"), "layout");
    let mut expected: String = sizes.iter().map(|(name, size)| format!("{name} {size}\n")).collect();
    expected += &format!("device_name {}\n", std::mem::offset_of!(IsophoteApi, device_name));
    assert_eq!(text, expected);
}

fn bad_arguments_of_the_c_program_are_one_line_each() {
    let Some(program) = compiled("stylize.c") else { return };
    let input = folder().join("bad.ppm");
    std::fs::write(&input, picture(8, 8)).expect("the folder is writable");
    let cases: [(&[&str], &str); 4] = [
        (&["gausian"], "gausian: unknown name: there is no node 'gausian'; did you mean 'gaussian'?"),
        (&["gaussian", "sigma=-1"], "sigma: out of range: parameter 'sigma' of 'gaussian' must be"),
        (&["gaussian", "sigma=wide"], "sigma: out of range: parameter 'sigma' of 'gaussian' is a number"),
        (&["gaussian", "sgima=2"], "sgima: unknown name: node 'gaussian' has no parameter 'sgima'"),
    ];
    for (args, message) in cases {
        let run = Command::new(&program)
            .arg(library::path())
            .arg(&input)
            .arg(folder().join("never.ppm"))
            .args(args)
            .output()
            .expect("the program can be started");
        let errors = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.code() == Some(1) && errors.starts_with(message), "{args:?}: {errors}");
        assert_eq!(errors.lines().count(), 1, "{errors}");
        assert!(!folder().join("never.ppm").exists());
    }
}

fn a_c_program_may_end_without_cleaning_up() {
    let Some(program) = compiled("leave.c") else { return };
    for end in ["stay", "unload"] {
        for device in ["cpu", "gpu"] {
            let run = Command::new(&program).arg(library::path()).args([end, device]).output();
            let text = printed(&run.expect("the program can be started"), end);
            if device == "gpu" && text != "device\n" {
                assert!(std::env::var("CI").is_err(), "there is no graphics device");
                eprintln!("\n*** SKIPPED: ending with a graphics device alive needs one ***\n");
            }
        }
    }
}

fn the_library_exports_the_entries_of_its_two_faces_and_no_more() {
    if !cfg!(target_os = "linux") || !has("nm") {
        return;
    }
    let run = Command::new("nm").args(["-D", "--defined-only"]).arg(library::path()).output();
    let text = printed(&run.expect("nm can be started"), "nm");
    let mut names: Vec<&str> = text.lines().filter_map(|l| l.split_whitespace().last()).collect();
    names.sort_unstable();
    assert_eq!(names, ["OfxGetNumberOfPlugins", "OfxGetPlugin", "OfxSetHost", "isophote_api"], "{text}");
}

fn the_library_needs_nothing_but_what_every_system_has() {
    if !cfg!(target_os = "linux") || !has("readelf") {
        return;
    }
    let run = Command::new("readelf").args(["-d", "-W"]).arg(library::path()).output();
    let text = printed(&run.expect("readelf can be started"), "readelf");
    let needed = text.lines().filter(|l| l.contains("(NEEDED)"));
    for library in needed.filter_map(|l| l.split(['[', ']']).nth(1)) {
        // The loader is a part of libc.
        let known = ["libc.so", "libm.so", "libgcc_s.so", "ld-linux"];
        assert!(known.iter().any(|k| library.starts_with(k)), "{library} is needed");
    }
}

fn the_committed_header_is_the_generated_one() {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let run = Command::new(cargo)
        .args(["run", "--quiet", "--package", "xtask", "--", "header", "--check"])
        .current_dir(library::root())
        .output();
    printed(&run.expect("cargo can be started"), "cargo xtask header --check");
}
