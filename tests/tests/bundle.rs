//! The OpenFX bundle as it is installed: made by `cargo xtask bundle`, found as hosts find it, and loaded.

use isophote_abi::openfx::*;
use isophote_tests::library;
use isophote_tests::ofx::effect::Described;
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::state::Behaviour;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

const ARCHITECTURE: &str = if cfg!(target_arch = "aarch64") { "Linux-aarch64" } else { "Linux-x86-64" };
const SIDE: i32 = 24;

/// The binaries that a host finds in a folder of its search path.
fn found(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let binary = |bundle: PathBuf| {
        let name = bundle.file_name()?.to_str()?.strip_suffix(".bundle").filter(|n| n.ends_with(".ofx"))?;
        Some(bundle.join("Contents").join(ARCHITECTURE).join(name)).filter(|binary| binary.is_file())
    };
    entries.filter_map(binary).collect()
}

/// The texts of a property list by their keys.
fn property(list: &str, key: &str) -> String {
    let (_, rest) = list.split_once(&format!("<key>{key}</key>")).unwrap_or_else(|| panic!("no {key}"));
    let (_, rest) = rest.split_once("<string>").expect("a text");
    rest.split_once("</string>").expect("its end").0.to_owned()
}

/// The bundle, made as people make it, in `folder`.
fn make(folder: &Path) {
    let target = library::path().parent().unwrap();
    let profile = target.file_name().unwrap();
    let mut bundle = Command::new(target.join("xtask"));
    bundle.args(["bundle", "--install", "--to"]).arg(folder);
    if profile == "debug" {
        bundle.arg("--debug");
    }
    bundle.env("CARGO_TARGET_DIR", target.parent().unwrap()).current_dir(library::root());
    let made = bundle.output().unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
}

fn check_list(contents: &Path) {
    let list = std::fs::read_to_string(contents.join("Info.plist")).unwrap();
    for (key, value) in [
        ("CFBundleExecutable", "Isophote.ofx"),
        ("CFBundlePackageType", "BNDL"),
        ("CFBundleInfoDictionaryVersion", "6.0"),
        ("CFBundleVersion", env!("CARGO_PKG_VERSION")),
    ] {
        assert_eq!(property(&list, key), value);
    }
    assert!(!property(&list, "CFBundleDevelopmentRegion").is_empty());
}

fn check_icons(resources: &Path, binary: &Binary) {
    let listed = std::fs::read_dir(resources).unwrap();
    let listed: BTreeSet<String> =
        listed.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    let icons =
        |ending: &'static str| binary.plugins().iter().map(move |p| format!("{}.{ending}", p.identifier()));
    assert_eq!(listed, icons("png").chain(icons("svg")).collect());
    for icon in icons("png") {
        let picture = image::open(resources.join(&icon)).unwrap();
        assert!(matches!(picture, image::DynamicImage::ImageRgba8(_)), "{icon}");
        assert_eq!((picture.width(), picture.height()), (128, 128), "{icon}");
        let colours: BTreeSet<[u8; 4]> = picture.to_rgba8().pixels().map(|p| p.0).collect();
        assert!(colours.len() > 8, "{icon} shows nothing");
    }
    for icon in icons("svg") {
        let drawing = std::fs::read_to_string(resources.join(&icon)).unwrap();
        assert!(drawing.contains("<svg") && drawing.contains("http://www.w3.org/2000/svg"), "{icon}");
        assert!(drawing.trim_end().ends_with("</svg>"), "{icon}");
    }
}

/// An edge is blurred, and flat parts stay.
fn check_pixels(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let plugin = binary.plugin("org.isophote.gaussian");
    let instance = Described::new(&host, plugin).instance(kOfxImageEffectContextFilter);
    instance.set("working_space", 1);
    let edge = |i: i32| if i % SIDE < SIDE / 2 { [0.0_f32, 0.0, 0.0, 1.0] } else { [1.0; 4] };
    let bytes: Vec<u8> = (0..SIDE * SIDE).flat_map(edge).flat_map(f32::to_ne_bytes).collect();
    instance.connect("Source", Picture::packed_in(layout, SIDE, SIDE, &bytes));
    let result = instance.render(layout, [SIDE; 2]).packed();
    let value = |x: usize| f32::from_ne_bytes(result[16 * x..16 * x + 4].try_into().unwrap());
    assert!(value(0) < 1e-3 && value(23) > 0.999, "flat parts stay");
    assert!((1..23).all(|x| value(x) <= value(x + 1)) && (0.2..0.5).contains(&value(11)), "the edge is soft");
    host.no_faults();
}

#[test]
fn the_bundle_holds_what_hosts_look_for_and_renders() {
    if !cfg!(target_os = "linux") {
        return;
    }
    let folder = tempfile::TempDir::new().unwrap();
    make(folder.path());
    let binaries = found(folder.path());
    assert_eq!(binaries.len(), 1, "{binaries:?}");
    let contents = folder.path().join("Isophote.ofx.bundle/Contents");
    check_list(&contents);
    let binary = Binary::open(&binaries[0]);
    check_icons(&contents.join("Resources"), &binary);
    check_pixels(&binary);
}
