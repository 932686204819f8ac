//! The archives as users get them: made by `cargo xtask dist`, unpacked in an empty folder, and used there by the
//! commands of their own README files, where nothing of Rust can be reached.

#![cfg(target_os = "linux")]

mod crates;
mod editors;

use isophote::registry;
use isophote_tests::library;
use isophote_tests::ofx::plugin::Binary;
use std::collections::BTreeSet;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;
use tempfile::TempDir;

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The archives, unpacked.
struct Unpacked {
    folder: TempDir,
}

impl Unpacked {
    fn get() -> &'static Self {
        static UNPACKED: OnceLock<Unpacked> = OnceLock::new();
        UNPACKED.get_or_init(|| {
            let folder = TempDir::new().unwrap();
            let archives = folder.path().join("archives");
            make(&archives);
            let this = Self { folder };
            this.run_in(&archives, "sha256sum --check --strict SHA256SUMS");
            for kind in ["library", "openfx", "program", "card"] {
                let archive = archives.join(format!("{}.tar.gz", name(kind)));
                this.run_in(this.folder.path(), &format!("tar xzf '{}'", archive.display()));
            }
            this
        })
    }

    fn archives(&self) -> PathBuf {
        self.folder.path().join("archives")
    }

    /// The folder of an archive.
    fn of(&self, kind: &str) -> PathBuf {
        self.folder.path().join(name(kind))
    }

    /// A command of the shell, where neither the build nor Rust can be reached: programs of these names in front of the
    /// system's say so.
    fn shell(&self, folder: &Path, line: &str) -> Command {
        let blocked = self.folder.path().join("blocked");
        if !blocked.exists() {
            std::fs::create_dir_all(&blocked).unwrap();
            for name in ["cargo", "rustc", "rustup"] {
                let program = blocked.join(name);
                std::fs::write(&program, "#!/bin/sh\necho 'Rust was asked for' >&2\nexit 99\n").unwrap();
                std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
            }
        }
        let mut command = Command::new("sh");
        command.args(["-e", "-c", line]).current_dir(folder).env_clear();
        command.env("PATH", format!("{}:/usr/bin:/bin", blocked.display()));
        command.env("HOME", self.folder.path()).env("LC_ALL", "C.UTF-8");
        command
    }

    /// Runs such a command to its end, and returns what it printed.
    fn run_in(&self, folder: &Path, line: &str) -> String {
        let output = self.shell(folder, line).output().unwrap();
        assert!(output.status.success(), "{line}\n{}", both(&output));
        String::from_utf8(output.stdout).unwrap()
    }
}

fn both(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// Name of an archive's folder.
fn name(kind: &str) -> String {
    format!("isophote-{kind}-{VERSION}-{}-{}", std::env::consts::OS, std::env::consts::ARCH)
}

/// The chores' program beside this test, for its profile.
fn dist(out: &Path) -> Command {
    let target = library::path().parent().unwrap();
    let profile = target.file_name().unwrap();
    let mut dist = Command::new(target.join("xtask"));
    dist.args(["dist", "--out"]).arg(out).arg("--profile");
    dist.arg(if profile == "debug" { "dev".as_ref() } else { profile });
    dist.env("CARGO_TARGET_DIR", target.parent().unwrap()).current_dir(library::root());
    dist
}

fn make(out: &Path) {
    let made = dist(out).output().unwrap();
    assert!(made.status.success(), "{}", both(&made));
}

/// Lines of the first block of commands in a README.
fn commands(readme: &Path, fence: &str) -> String {
    let text = std::fs::read_to_string(readme).unwrap();
    let blocks: Vec<&str> =
        text.split(fence).skip(1).filter_map(|rest| rest.split_once("```")).map(|(block, _)| block).collect();
    assert!(!blocks.is_empty(), "{} has no block of commands", readme.display());
    blocks.concat()
}

/// Text without the blanks that fill its lines.
fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A binary PPM with edges to be found.
fn photo(path: &Path) {
    let pixels = (0..61_u32).flat_map(|y| (0..90_u32).flat_map(move |x| [(x / 9) * 25, y * 3, 90]));
    let mut bytes = b"P6\n90 61\n255\n".to_vec();
    bytes.extend(pixels.map(|v| v as u8));
    std::fs::write(path, bytes).unwrap();
}

fn files(folder: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect()
}

#[test]
fn there_are_archives_and_checksums_and_nothing_half_done() {
    let archives = ["library", "openfx", "program", "card"].map(|kind| format!("{}.tar.gz", name(kind)));
    let others = [
        format!("isophote-{VERSION}.tgz"),
        "isophote.html".to_owned(),
        "SHA256SUMS".to_owned(),
        "NOTES.md".to_owned(),
    ];
    let expected: BTreeSet<String> = archives.into_iter().chain(others).collect();
    let mut found = files(&Unpacked::get().archives());
    for (beginning, ending) in
        [("isophote-", ".whl"), ("isophote-blender-", ".zip"), ("isophote-comfyui-", ".zip")]
    {
        let is_meant = |name: &&String| name.starts_with(beginning) && name.ends_with(ending);
        let named: Vec<String> = found.iter().filter(is_meant).cloned().collect();
        assert!(matches!(named.as_slice(), [name] if name.contains(VERSION)), "{found:?}");
        found.remove(&named[0]);
    }
    assert_eq!(found, expected);
    let notes = std::fs::read_to_string(Unpacked::get().archives().join("NOTES.md")).unwrap();
    assert!(notes.starts_with(&format!("# Isophote {VERSION}\n\n")) && notes.lines().count() > 2, "{notes}");
}

#[test]
fn the_npm_package_is_whole() {
    let unpacked = Unpacked::get();
    let package = unpacked.archives().join(format!("isophote-{VERSION}.tgz"));
    let folder = TempDir::new().unwrap();
    unpacked.run_in(folder.path(), &format!("tar xzf '{}'", package.display()));
    let read = |file: &str| std::fs::read(folder.path().join("package").join(file)).unwrap();
    for module in ["isophote.wasm", "isophote-cpu.wasm"] {
        assert!(read(module).starts_with(b"\0asm"), "{module}");
    }
    let texts = [
        "src/index.js",
        "src/index.d.ts",
        "src/three.js",
        "src/looks.js",
        "README.md",
        "LICENSES-OF-OTHERS.txt",
    ];
    for text in texts {
        assert!(!read(text).is_empty(), "{text}");
    }
    let manifest: serde_json::Value = serde_json::from_slice(&read("package.json")).unwrap();
    assert_eq!(manifest["version"], VERSION);
}

#[test]
fn what_cannot_be_packed_leaves_what_was_there() {
    let folder = TempDir::new().unwrap();
    let old = folder.path().join("SHA256SUMS");
    std::fs::write(&old, "of an earlier run\n").unwrap();
    // The archive of the library is complete before the plugin is found to be cut short.
    let bundle = folder.path().join("bundle");
    std::fs::create_dir(&bundle).unwrap();
    std::fs::write(bundle.join("Isophote.ofx"), b"\x7fELF\x02\x01\x01").unwrap();
    let built = library::path().parent().unwrap();
    let mut pack = Command::new(built.join("isophote-dist"));
    pack.arg("pack")
        .arg("--built")
        .arg(built)
        .arg("--bundle")
        .arg(&bundle)
        .arg("--icons")
        .arg(folder.path())
        .arg("--packed")
        .arg(folder.path())
        .arg("--out")
        .arg(folder.path())
        .arg("--draft");
    let output = pack.output().unwrap();
    assert!(!output.status.success());
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("Isophote.ofx: ") && said.lines().count() == 1, "{said}");
    assert_eq!(std::fs::read_to_string(&old).unwrap(), "of an earlier run\n");
    assert_eq!(files(folder.path()), BTreeSet::from(["SHA256SUMS".to_owned(), "bundle".to_owned()]));
}

#[test]
fn c_programs_are_built_with_pkg_config_and_with_cmake() {
    let unpacked = Unpacked::get();
    let folder = unpacked.of("library");
    // All that the README says, one line after the other.
    let printed = unpacked.run_in(&folder, &commands(&folder.join("README.md"), "```sh\n"));
    let listed = format!("Isophote {VERSION}, {} nodes\n", registry::nodes().len());
    assert_eq!(printed.matches(&listed).count(), 2, "{printed}");

    let linked = unpacked.run_in(&folder, "ldd ./linked build/linked");
    let soname = format!("libisophote.so.1 => {}", folder.canonicalize().unwrap().display());
    assert_eq!(linked.matches(&soname).count(), 2, "{linked}");

    photo(&folder.join("photo.ppm"));
    unpacked.run_in(&folder, "build/stylize lib/libisophote.so photo.ppm cartoon.ppm");
    let [before, after] = ["photo.ppm", "cartoon.ppm"].map(|f| std::fs::read(folder.join(f)).unwrap());
    assert!(after.len() == before.len() && after != before);
    let plan = unpacked.run_in(&folder, "build/plan lib/libisophote.so 90 61 cartoon");
    assert!(plan.lines().count() > 10, "{plan}");
    // What a compiler of another version of C makes of the header.
    unpacked.run_in(
        &folder,
        "cc -std=c99 -Wall -Wextra -Werror -fsyntax-only $(PKG_CONFIG_PATH=lib/pkgconfig pkg-config --cflags \
         isophote) share/isophote/examples/linked.c",
    );
}

#[test]
fn cmake_takes_versions_that_fit_and_says_what_is_missing() {
    let unpacked = Unpacked::get();
    let project = TempDir::new().unwrap();
    let configure = |wanted: &str, prefix: &Path| {
        let text = format!(
            "cmake_minimum_required(VERSION 3.16)\nproject(host C)\nfind_package(Isophote {wanted} REQUIRED)\n"
        );
        std::fs::write(project.path().join("CMakeLists.txt"), text).unwrap();
        let line = format!("rm -rf build; cmake -S . -B build -DCMAKE_PREFIX_PATH='{}'", prefix.display());
        unpacked.shell(project.path(), &line).output().unwrap()
    };
    let package = unpacked.of("library");
    for wanted in ["", "0.1", VERSION] {
        let output = configure(wanted, &package);
        assert!(output.status.success(), "{wanted}: {}", both(&output));
    }
    for wanted in ["0.1.9999", "0.2", "1.0"] {
        let said = both(&configure(wanted, &package));
        assert!(said.contains(&format!("version: {VERSION}")), "{wanted}: {said}");
    }
    // A package that was not unpacked as a whole.
    let part = project.path().join("part");
    std::fs::create_dir(&part).unwrap();
    unpacked.run_in(&package, &format!("cp -r lib '{}'", part.display()));
    let said = both(&configure("", &part));
    assert!(said.contains("isophote.h is") && said.contains("missing"), "{said}");
}

#[test]
fn the_plugin_is_installed_and_removed_by_its_script() {
    let unpacked = Unpacked::get();
    let folder = unpacked.of("openfx");
    let plugins = TempDir::new().unwrap();
    let to = plugins.path().join("of hosts/Plugins");
    let install = format!("./install.sh --to '{}'", to.display());
    for _ in 0..2 {
        unpacked.run_in(&folder, &install);
        assert_eq!(files(&to), BTreeSet::from(["Isophote.ofx.bundle".to_owned()]));
    }
    let architecture = if cfg!(target_arch = "aarch64") { "Linux-aarch64" } else { "Linux-x86-64" };
    let binary = to.join("Isophote.ofx.bundle/Contents").join(architecture).join("Isophote.ofx");
    let ids: BTreeSet<String> =
        Binary::open(&binary).plugins().iter().map(|p| p.identifier().to_owned()).collect();
    assert!(ids.contains("org.isophote.cartoon") && ids.len() > 20, "{ids:?}");
    unpacked.run_in(&folder, &format!("{install} --remove"));
    assert!(files(&to).is_empty());

    std::fs::write(plugins.path().join("file"), "").unwrap();
    let blocked = format!("./install.sh --to '{}'", plugins.path().join("file/Plugins").display());
    for (line, said) in [(blocked.as_str(), "cannot be written"), ("./install.sh --frob", "usage:")] {
        let output = unpacked.shell(&folder, line).output().unwrap();
        assert!(!output.status.success() && both(&output).contains(said), "{}", both(&output));
    }
}

#[test]
fn the_program_runs_from_a_prefix_with_its_library() {
    let unpacked = Unpacked::get();
    let folder = unpacked.of("program");
    let prefix = TempDir::new().unwrap();
    let place = prefix.path().canonicalize().unwrap();
    unpacked.run_in(&folder, &format!("cp -r bin lib share '{}'", place.display()));
    std::fs::create_dir(place.join("work")).unwrap();
    let input = image::RgbImage::from_fn(90, 61, |x, y| image::Rgb([(x / 9 * 25) as u8, y as u8 * 3, 90]));
    input.save(place.join("work/photo.png")).unwrap();
    for style in ["look:copperplate", "../share/isophote/looks/copperplate.json"] {
        let line = format!("../bin/isophote apply {style} photo.png out.png --backend cpu");
        unpacked.run_in(&place.join("work"), &line);
        let result = image::open(place.join("work/out.png")).unwrap().to_rgb8();
        assert!(result != input && result.dimensions() == input.dimensions());
        std::fs::remove_file(place.join("work/out.png")).unwrap();
    }
    let listed = unpacked.run_in(&place.join("work"), "../bin/isophote preset list");
    let looks = listed.lines().filter(|line| line.trim_start().starts_with("look:")).count();
    assert_eq!(files(&place.join("share/isophote/looks")).len(), looks);
}

#[test]
fn desktops_know_the_program_by_its_entry_and_its_icons() {
    let unpacked = Unpacked::get();
    let share = unpacked.of("program").join("share");
    let id = "org.isophote.Isophote";
    // Words of Debian's own validators, of which the second would look for addresses on the network.
    unpacked.run_in(&share, &format!("desktop-file-validate applications/{id}.desktop"));
    unpacked.run_in(&share, &format!("appstreamcli validate --no-net metainfo/{id}.metainfo.xml"));
    let entry = std::fs::read_to_string(share.join(format!("applications/{id}.desktop"))).unwrap();
    for line in [format!("Icon={id}"), format!("StartupWMClass={id}"), "Exec=isophote view %f".to_owned()] {
        assert!(entry.lines().any(|known| known == line), "{line}: {entry}");
    }
    let icons = share.join("icons/hicolor");
    for side in [16, 32, 48, 64, 128, 256, 512] {
        let icon = image::open(icons.join(format!("{side}x{side}/apps/{id}.png"))).unwrap();
        assert_eq!((icon.width(), icon.height()), (side, side));
    }
    let drawing = std::fs::read_to_string(icons.join(format!("scalable/apps/{id}.svg"))).unwrap();
    assert!(drawing.starts_with("<svg") && drawing.trim_end().ends_with("</svg>"));
}

#[test]
fn a_card_is_measured_by_the_script_in_its_folder() {
    let unpacked = Unpacked::get();
    let folder = unpacked.of("card");
    let elsewhere = TempDir::new().unwrap();
    let measure = folder.join("measure.sh");
    let options = "--node gaussian --size 64x48 --runs 1 --seconds 0";
    unpacked.run_in(elsewhere.path(), &format!("'{}' {options}", measure.display()));
    assert!(files(elsewhere.path()).is_empty());
    let report = std::fs::read_to_string(folder.join("report/card.md")).unwrap();
    assert!(report.contains("| `gaussian` | 64x48 | fast |"), "{report}");
    let report = std::fs::read(folder.join("report/card.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
    assert_eq!(report["problems"], serde_json::json!([]));
}

#[test]
fn every_manual_page_is_shown_without_a_warning() {
    let unpacked = Unpacked::get();
    let pages = unpacked.of("program").join("share/man/man1");
    let names = files(&pages);
    for verb in ["", "-apply", "-render", "-view", "-preset-save", "-farm-openjd"] {
        assert!(names.contains(&format!("isophote{verb}.1")), "{names:?}");
    }
    for name in names {
        let line = format!("MANROFFSEQ= man --warnings -E UTF-8 -l '{name}'");
        let output = unpacked.shell(&pages, &line).output().unwrap();
        assert!(output.status.success() && output.stderr.is_empty(), "{name}: {}", both(&output));
        let shown = words(&String::from_utf8_lossy(&output.stdout));
        let command = name.trim_end_matches(".1").replace('-', " ");
        assert!(shown.contains("SYNOPSIS") && shown.contains(&command), "{name}: {shown}");
    }
    let program = words(&unpacked.run_in(&pages, "man -l isophote.1"));
    assert!(program.contains("EXAMPLES isophote photo.jpg opens a picture"), "{program}");
    let apply = words(&unpacked.run_in(&pages, "man -l isophote-apply.1"));
    assert!(apply.contains("--skip-existing") && apply.contains("<STYLE> [INPUT] [OUTPUT]"), "{apply}");
}

#[test]
fn bash_completes_verbs_and_options() {
    let unpacked = Unpacked::get();
    let completions = unpacked.of("program").join("share/bash-completion/completions");
    let ask = |words: &str, count: usize| {
        let script = format!(
            "source ./isophote; COMP_WORDS=({words}); COMP_CWORD={count}; _isophote isophote \
             \"${{COMP_WORDS[-1]}}\" \"${{COMP_WORDS[-2]}}\"; echo \"${{COMPREPLY[@]}}\""
        );
        unpacked.run_in(&completions, &format!("bash --norc -c '{script}'")).trim().to_owned()
    };
    assert_eq!(ask("isophote app", 1), "apply");
    assert_eq!(ask("isophote preset sa", 2), "save");
    assert_eq!(ask("isophote apply --ba", 2), "--backend");
    assert_eq!(ask("isophote apply --backend c", 3), "cpu");
    let registered =
        unpacked.run_in(&completions, "bash --norc -c 'source ./isophote; complete -p isophote'");
    assert!(registered.contains("-F _isophote"), "{registered}");
}

#[test]
fn licences_of_all_dependencies_come_along() {
    let unpacked = Unpacked::get();
    let read = |kind: &str, place: &str| {
        let folder = unpacked.of(kind).join(place);
        for own in ["LICENSE-MIT", "LICENSE-APACHE"] {
            let copied = std::fs::read(folder.join(own)).unwrap();
            assert_eq!(copied, std::fs::read(library::root().join(own)).unwrap());
        }
        std::fs::read_to_string(folder.join("LICENSES-OF-OTHERS.txt")).unwrap()
    };
    let library = read("library", "share/doc/isophote");
    assert_eq!(read("openfx", "licences"), library);
    let program = read("program", "share/doc/isophote");
    assert_eq!(read("card", "licences"), program);
    for name in ["wgpu ", "naga ", "rayon ", "the Rust standard library"] {
        assert!(library.contains(name) && program.contains(name), "{name}");
    }
    // The program's own, and what stands in it as fonts.
    for name in ["clap ", "winit ", "epaint_default_fonts ", "SIL OPEN FONT LICENSE", "UBUNTU FONT LICENCE"] {
        assert!(!library.contains(name) && program.contains(name), "{name}");
    }
    // What only tests use is not given away.
    assert!(!program.contains("allocation-counter"));
}

#[test]
fn the_wheel_and_the_extension_hold_licences_too() {
    let unpacked = Unpacked::get();
    let library = unpacked.of("library").join("share/doc/isophote/LICENSES-OF-OTHERS.txt");
    let library = std::fs::read_to_string(library).unwrap();
    let out = TempDir::new().unwrap();
    let archives = unpacked.archives();
    for (ending, named, place) in [("whl", "*.whl", "*.dist-info/licenses"), ("zip", "*-blender-*.zip", ".")]
    {
        let folder = out.path().join(ending);
        let archive = format!("'{}'/{named}", archives.display());
        unpacked.run_in(out.path(), &format!("python3 -m zipfile -e {archive} {ending}"));
        let listed = unpacked.run_in(&folder, &format!("cd {place} && ls LICENSE*"));
        let expected = ["LICENSE-APACHE", "LICENSE-MIT", "LICENSES-OF-OTHERS.txt"];
        assert_eq!(listed.lines().collect::<Vec<_>>(), expected);
        let others = unpacked.run_in(&folder, &format!("cat {place}/LICENSES-OF-OTHERS.txt"));
        // Those of the library, and of what makes it a module of Python.
        for name in ["wgpu ", "naga ", "rayon ", "the Rust standard library"] {
            assert!(library.contains(name) && others.contains(name), "{ending}: {name}");
        }
        assert!(others.contains("pyo3 ") && !library.contains("pyo3 "), "{ending}");
    }
    // The extension has the very wheel that is published by itself.
    let same = format!("cmp zip/wheels/*.whl '{}'/*.whl", archives.display());
    unpacked.run_in(out.path(), &same);
}

/// Names of the packages in a bill of materials, which is whole and says nothing of the machine that it was made on.
fn materials(bill: &str) -> BTreeSet<String> {
    assert!(!bill.contains(library::root().to_str().unwrap()), "{bill}");
    let bill: serde_json::Value = serde_json::from_str(bill).unwrap();
    assert_eq!([&bill["bomFormat"], &bill["specVersion"]], ["CycloneDX", "1.6"]);
    let of = |value: &serde_json::Value, name: &str| value[name].as_str().unwrap().to_owned();
    let packages = bill["components"].as_array().unwrap();
    let known: BTreeSet<String> = packages.iter().map(|package| of(package, "bom-ref")).collect();
    assert_eq!(known.len(), packages.len());
    // Every package is needed by Isophote or by another, and all that are needed are there.
    let edges = bill["dependencies"].as_array().unwrap();
    let needed = edges.iter().flat_map(|edge| edge["dependsOn"].as_array().unwrap());
    assert_eq!(needed.map(|purl| purl.as_str().unwrap().to_owned()).collect::<BTreeSet<_>>(), known);
    packages.iter().map(|package| of(package, "name")).collect()
}

#[test]
fn bills_of_materials_name_all_that_binaries_are_made_of() {
    let unpacked = Unpacked::get();
    let read = |kind: &str, place: &str| {
        let file = unpacked.of(kind).join(place).join("isophote.cdx.json");
        materials(&std::fs::read_to_string(file).unwrap())
    };
    let library = read("library", "share/doc/isophote");
    assert_eq!(read("openfx", "licences"), library);
    let program = read("program", "share/doc/isophote");
    assert_eq!(read("card", "licences"), program);
    assert!(library.contains("wgpu") && !library.contains("winit"));
    assert!(program.is_superset(&library) && program.contains("winit"));
    assert!(!program.contains("allocation-counter"));
    let out = TempDir::new().unwrap();
    let archives = unpacked.archives();
    let packed =
        |line: &str| materials(&unpacked.run_in(out.path(), &format!("A='{}'; {line}", archives.display())));
    // Alone in the folder that scanners look into.
    let wheel = packed("python3 -m zipfile -e \"$A\"/*.whl whl; cat whl/*.dist-info/sboms/*");
    assert!(wheel.is_superset(&library) && wheel.contains("pyo3"));
    let npm = packed("tar xzOf \"$A\"/*.tgz package/isophote.cdx.json");
    assert!(npm.contains("fearless_simd") && !npm.contains("wgpu"), "{npm:?}");
}
