//! `cargo xtask web`: planner and CPU executor as WebAssembly, the npm package and the page, and their tests for
//! `cargo xtask test`.
//!
//! All of it lies below `target/web`: `package` is the package as it is published, `isophote.html` the page. Bundler,
//! three.js and Playwright are in `nodes/web/node_modules`, in the versions of `package-lock.json`.

use crate::address;
use crate::error::{Context, Failure, Result};
use crate::packing;
use crate::setup::{self, BROWSER, C_COMPILER, NODE, WASM, WASM_TARGET};
use crate::tools::{
    build as build_programs, cargo_command, heading, host_file, library_file, root, run as run_command,
    target_dir,
};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A module of WebAssembly.
struct Module {
    /// Its file in the package.
    file: &'static str,
    features: &'static [&'static str],
}

/// What every page loads.
const PLANNER: Module = Module { file: "isophote.wasm", features: &["--no-default-features"] };

/// What pages without a graphics device load, too.
const PROCESSOR: Module = Module { file: "isophote-cpu.wasm", features: &[] };

/// Profile of both.
const PROFILE: &str = "web";

/// Flags of the compiler for both: browsers had vectors before graphics devices, since 2021, Safari since 2023.
const FLAGS: &str = "-C target-feature=+simd128";

/// Most bytes of the page, a third of them the module of the processor: what someone waits for before the first picture.
const MOST: u64 = 9 << 19;

/// Options of `cargo xtask web`.
#[derive(clap::Args)]
pub struct Options {
    /// Packs the npm package, too, as the file that is published
    #[arg(long)]
    pack: bool,
}

/// Builds package and page and says where they are.
///
/// # Errors
/// The first step that fails.
pub fn run(options: &Options) -> Result<()> {
    setup::ensure(&[&C_COMPILER, &WASM, &NODE])?;
    build_programs("debug", &[packing::PACKAGE])?;
    let built = build("debug")?;
    if options.pack {
        println!("{}", pack_package(&built, &target_dir("web"))?.display());
    }
    println!("{}\n{}", built.package.display(), built.page.display());
    Ok(())
}

/// Puts the npm package, as it is published, and the page into a folder. The program that packs must be built.
///
/// # Errors
/// The first step that fails.
pub fn pack(profile: &str, out: &Path) -> Result<()> {
    let built = build(profile)?;
    pack_package(&built, out)?;
    copy(&built.page, &out.join(PAGE))
}

/// File of the page.
const PAGE: &str = "isophote.html";

/// Files that are built.
struct Built {
    /// Folder of the npm package.
    package: PathBuf,
    /// The page, one file.
    page: PathBuf,
}

/// Builds planner, package and page; `profile` is that of the program that packs.
fn build(profile: &str) -> Result<Built> {
    heading("modules of WebAssembly");
    let modules = [(&PLANNER, compiled(&PLANNER)?), (&PROCESSOR, compiled(&PROCESSOR)?)];
    heading("package and page");
    install()?;
    let (package, page) = (target_dir("web").join("package"), target_dir("web").join(PAGE));
    stage(&modules, &package)?;
    packing::write_materials(&["isophote-web"], Some(WASM_TARGET), profile, &package)?;
    let mut bundle = node();
    bundle.arg(folder().join("page/bundle.mjs")).arg(&package).arg(&page);
    run_command(&mut bundle)?;
    let size = fs::metadata(&page).context(|| format!("cannot read {}", page.display()))?.len();
    if size > MOST {
        return Err(Failure(format!("{} has {size} bytes, and may have {MOST}", page.display())));
    }
    Ok(Built { package, page })
}

/// Packs the package as npm publishes it.
fn pack_package(built: &Built, out: &Path) -> Result<PathBuf> {
    fs::create_dir_all(out).context(|| format!("cannot create {}", out.display()))?;
    let mut pack = npm();
    pack.args(["pack", "--silent", "--pack-destination"]).arg(out).current_dir(&built.package);
    run_command(pack.stdout(Stdio::null()))?;
    Ok(out.join(format!("isophote-{}.tgz", env!("CARGO_PKG_VERSION"))))
}

/// The names of all tests.
///
/// # Errors
/// When their files cannot be read.
pub fn tests() -> Result<Vec<String>> {
    let mut names = Vec::new();
    for file in test_files()? {
        let text = fs::read_to_string(&file).context(|| format!("cannot read {}", file.display()))?;
        let named = text.lines().filter_map(|line| line.strip_prefix("test(\"")?.split_once('"'));
        names.extend(named.map(|(name, _)| name.to_owned()));
    }
    Ok(names)
}

/// Runs the tests in a browser whose names contain the filter; without one all. The library and the host must be built.
///
/// # Errors
/// The first step that fails.
pub fn test(filter: Option<&str>) -> Result<()> {
    setup::ensure(&[&C_COMPILER, &WASM, &NODE, &BROWSER])?;
    let built = build("debug")?;
    let packed = pack_package(&built, &target_dir("web"))?;
    heading("browser");
    // One after the other: on a processor that is a graphics device, several browsers take longer together.
    for file in test_files()? {
        let mut tests = node();
        tests
            .arg("--test")
            .args(filter.iter().map(|filter| format!("--test-name-pattern={filter}")))
            .arg(file);
        tests.env("ISOPHOTE_PACKAGE", &built.package).env("ISOPHOTE_PACKED", &packed);
        tests.env("ISOPHOTE_PAGE", &built.page);
        tests.env("ISOPHOTE_HOST", host_file("debug")).env("ISOPHOTE_LIBRARY", library_file("debug"));
        run_command(&mut tests)?;
    }
    Ok(())
}

fn test_files() -> Result<Vec<PathBuf>> {
    let tests = folder().join("tests");
    let entries = fs::read_dir(&tests).context(|| format!("cannot read {}", tests.display()))?;
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.retain(|file| file.to_string_lossy().ends_with(".test.mjs"));
    files.sort();
    Ok(files)
}

/// The folder of planner, package and page.
fn folder() -> PathBuf {
    root().join("nodes/web")
}

fn node() -> Command {
    let mut command = Command::new("node");
    command.current_dir(folder()).env("NODEVICE_SELECT", "1");
    command
}

fn npm() -> Command {
    Command::new(if cfg!(windows) { "npm.cmd" } else { "npm" })
}

/// Installs bundler, three.js and Playwright where they are not these very versions.
fn install() -> Result<()> {
    let lock = folder().join("package-lock.json");
    let wanted = fs::read(&lock).context(|| format!("cannot read {}", lock.display()))?;
    let installed = folder().join("node_modules/.isophote-lock.json");
    if fs::read(&installed).is_ok_and(|has| has == wanted) {
        return Ok(());
    }
    let mut install = npm();
    install.args(["ci", "--no-audit", "--no-fund", "--ignore-scripts", "--loglevel=error"]);
    run_command(install.current_dir(folder()))?;
    // Last, so that a folder that was left half full is filled again.
    fs::write(&installed, wanted).context(|| format!("cannot write {}", installed.display()))
}

/// Compiles a module and says where it is: the other one's build replaces what cargo leaves.
fn compiled(module: &Module) -> Result<PathBuf> {
    let target = target_dir("web").join("build");
    let mut command = cargo_command(&["rustc", "--quiet", "--lib", "--crate-type", "cdylib"]);
    // Features are those of the package whose folder it is.
    command.current_dir(folder()).args(module.features);
    command.args(["--profile", PROFILE, "--target", WASM_TARGET, "--target-dir"]).arg(&target);
    command.env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS", FLAGS);
    if !setup::has_target(WASM_TARGET) {
        // A compiler of the system has the sources of its standard library, and another one's linker will do.
        command
            .arg("-Zbuild-std=std,panic_abort")
            .env("RUSTC", setup::SYSTEM_RUSTC)
            .env("RUSTC_BOOTSTRAP", "1");
        command.env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", linker()?);
    }
    run_command(&mut command)?;
    let kept = target_dir("web").join(module.file);
    copy(&target.join(WASM_TARGET).join(PROFILE).join("isophote_web.wasm"), &kept)?;
    Ok(kept)
}

/// The linker that comes with the compiler of this build.
fn linker() -> Result<PathBuf> {
    let sysroot = setup::sysroot("rustc").ok_or_else(|| Failure("rustc cannot be started".into()))?;
    let hosts = sysroot.join("lib/rustlib");
    let entries = fs::read_dir(&hosts).context(|| format!("cannot read {}", hosts.display()))?;
    let linkers = entries.filter_map(|entry| Some(entry.ok()?.path().join("bin/rust-lld")));
    let found = linkers.into_iter().find(|path| path.is_file());
    found.ok_or_else(|| Failure(format!("{} has no rust-lld", hosts.display())))
}

/// Puts the package together as it is published.
fn stage(modules: &[(&Module, PathBuf)], package: &Path) -> Result<()> {
    if package.exists() {
        fs::remove_dir_all(package).context(|| format!("cannot replace {}", package.display()))?;
    }
    copy_folder(&folder().join("package"), package)?;
    for (module, built) in modules {
        copy(built, &package.join(module.file))?;
    }
    let manifest = package.join("package.json");
    let text = fs::read_to_string(&manifest).context(|| format!("cannot read {}", manifest.display()))?;
    fs::write(&manifest, address::filled(&text))
        .context(|| format!("cannot write {}", manifest.display()))?;
    for licence in ["LICENSE-APACHE", "LICENSE-MIT"] {
        copy(&root().join(licence), &package.join(licence))?;
    }
    let looks = looks()?;
    let file = package.join("src/looks.js");
    fs::write(&file, looks).context(|| format!("cannot write {}", file.display()))
}

/// The looks as a module.
fn looks() -> Result<String> {
    let mut module =
        String::from("/** The looks that ship, by id, in their order. */\nexport const looks = {\n");
    for (id, file) in crate::tools::looks()? {
        let text = fs::read_to_string(&file).context(|| format!("cannot read {}", file.display()))?;
        let look: String = text.lines().map(str::trim).collect();
        module.push_str(&format!("  {id}: {look},\n"));
    }
    module.push_str("};\n");
    Ok(module)
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::copy(from, to).context(|| format!("cannot copy {} to {}", from.display(), to.display()))?;
    Ok(())
}

fn copy_folder(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to).context(|| format!("cannot create {}", to.display()))?;
    for entry in fs::read_dir(from).context(|| format!("cannot read {}", from.display()))? {
        let path = entry.context(|| format!("cannot read {}", from.display()))?.path();
        let target = to.join(path.file_name().unwrap_or_default());
        if path.is_dir() { copy_folder(&path, &target)? } else { copy(&path, &target)? }
    }
    Ok(())
}
