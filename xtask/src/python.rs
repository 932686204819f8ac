//! `cargo xtask wheel`, `blender`, `comfyui` and `stubs`: the Python package, the Blender extension and the nodes of ComfyUI, and
//! their tests for `cargo xtask test`.
//!
//! Maturin, pytest and the rest live in a virtual environment below `target`, in the versions of
//! `nodes/python/requirements.txt`. The extension module has a target folder of its own there: maturin hands its build the
//! interpreter, which would have it compiled anew with every change between the two.

use crate::error::{Context, Failure, Result};
use crate::packing;
use crate::setup::{self, C_COMPILER, PYTHON};
use crate::tools::{
    WRAPPER, build_library, heading, host_file, library_file, root, run as run_command, target_dir,
};
use std::ffi::OsStr;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The profile of what users get.
pub const RELEASED: &str = "dist";

/// Options of `cargo xtask wheel`, `cargo xtask blender` and `cargo xtask comfyui`.
#[derive(clap::Args)]
pub struct WheelOptions {
    /// Takes the build for development, which is slow
    #[arg(long)]
    debug: bool,
}

/// Builds the wheel and says where it is.
///
/// # Errors
/// The first step that fails.
pub fn wheel(options: &WheelOptions) -> Result<()> {
    let (_, wheel) = released(options)?;
    println!("{}", wheel.display());
    Ok(())
}

/// Builds the Blender extension and says where it is.
///
/// # Errors
/// The first step that fails.
pub fn blender(options: &WheelOptions) -> Result<()> {
    let (environment, wheel) = released(options)?;
    let packed = pack_extension(&environment, &wheel, &target_dir("wheels"))?;
    println!("{}", packed.display());
    Ok(())
}

/// Packs the nodes of ComfyUI and says where they are.
///
/// # Errors
/// The first step that fails.
pub fn comfyui(options: &WheelOptions) -> Result<()> {
    let (environment, wheel) = released(options)?;
    println!("{}", pack_nodes(&environment, &wheel, &target_dir("wheels"))?.display());
    Ok(())
}

/// The wheel that users get, and what it was built with.
fn released(options: &WheelOptions) -> Result<(Environment, PathBuf)> {
    setup::ensure(&[&C_COMPILER, &PYTHON])?;
    heading("build");
    let profile = if options.debug { "debug" } else { RELEASED };
    build_library(profile, &[packing::PACKAGE])?;
    let _turn = turn()?;
    let environment = Environment::tools()?;
    let wheel = build_wheel(&environment, profile, &target_dir("wheels"))?;
    Ok((environment, wheel))
}

/// Unpacks a package of others as it is for 64-bit Windows.
///
/// # Errors
/// As pip.
#[cfg(unix)]
pub fn unpack_for_windows(package: &str, folder: &Path) -> Result<()> {
    let _turn = turn()?;
    let mut pip = Environment::tools()?.program("python");
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--upgrade"]);
    pip.args(["--platform", "win_amd64", "--only-binary=:all:", "--target"]);
    run_command(pip.arg(folder).arg(package))
}

/// The right to change what all chores share, until it is dropped: the environments, and what is put beside the package.
fn turn() -> Result<File> {
    let (folder, failed) =
        (target_dir("python"), || "cannot lock the folder of what Python needs".to_owned());
    std::fs::create_dir_all(&folder).context(failed)?;
    let file = File::create(folder.join("turn")).context(failed)?;
    file.lock().context(failed)?;
    Ok(file)
}

/// Packs the wheel, the extension and the nodes of ComfyUI of a build into a folder. The library and the program that packs must be built.
///
/// # Errors
/// The first step that fails.
pub fn pack(profile: &str, out: &Path) -> Result<()> {
    let _turn = turn()?;
    let environment = Environment::tools()?;
    let wheel = build_wheel(&environment, profile, out)?;
    // What the registry would refuse.
    run_command(environment.program("twine").args(["check", "--strict"]).arg(&wheel))?;
    pack_extension(&environment, &wheel, out)?;
    pack_nodes(&environment, &wheel, out).map(drop)
}

/// Packs the Blender extension with a wheel.
fn pack_extension(environment: &Environment, wheel: &Path, out: &Path) -> Result<PathBuf> {
    packed(environment, "extension.py", "isophote-blender-", wheel, out)
}

/// Packs the nodes of ComfyUI for a wheel.
fn pack_nodes(environment: &Environment, wheel: &Path, out: &Path) -> Result<PathBuf> {
    packed(environment, "comfyui.py", "isophote-comfyui-", wheel, out)
}

/// The file that a tool of the package packs for a wheel, whose name it prints, in the place of others that begin as it does.
fn packed(
    environment: &Environment,
    tool: &str,
    beginning: &str,
    wheel: &Path,
    out: &Path,
) -> Result<PathBuf> {
    let begins =
        |path: &Path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(beginning));
    for old in files(out, "zip").unwrap_or_default().into_iter().filter(|path| begins(path)) {
        std::fs::remove_file(&old).context(|| format!("cannot replace {}", old.display()))?;
    }
    let cannot = || format!("{tool} cannot pack for {}", wheel.display());
    let mut python = environment.program("python");
    let output =
        python.arg(package().join("tools").join(tool)).arg(wheel).arg(out).output().context(cannot)?;
    if !output.status.success() {
        return Err(Failure(format!("{}: {}", cannot(), String::from_utf8_lossy(&output.stderr).trim())));
    }
    Ok(PathBuf::from(String::from_utf8_lossy(&output.stdout).trim()))
}

/// Options of `cargo xtask stubs`.
#[derive(clap::Args)]
pub struct StubsOptions {
    /// Only say whether the file is true
    #[arg(long)]
    check: bool,
}

/// Writes or checks `nodes/python/isophote/nodes.pyi`.
///
/// # Errors
/// When the package cannot be built, or (checking) the file is stale.
pub fn stubs(options: &StubsOptions) -> Result<()> {
    setup::ensure(&[&C_COMPILER, &PYTHON])?;
    build_library("debug", &[packing::PACKAGE])?;
    let (environment, _) = installed()?;
    let mut tool = environment.program("python");
    tool.arg(package().join("tools/stubs.py")).arg(package().join("isophote/nodes.pyi"));
    run_command(tool.args(options.check.then_some("--check")))
}

/// The names of all tests.
///
/// # Errors
/// When their files cannot be read.
pub fn tests() -> Result<Vec<String>> {
    let mut names = Vec::new();
    let mut sources = files(&package().join("tests"), "py")?;
    for folder in [COMFYUI_TESTS, BLENDER_TESTS] {
        sources.extend(files(&package().join(folder), "py")?);
    }
    for file in sources {
        let text = std::fs::read_to_string(&file).context(|| format!("cannot read {}", file.display()))?;
        let functions = text.lines().filter_map(|line| line.strip_prefix("def test_")?.split_once('('));
        names.extend(functions.map(|(name, _)| format!("test_{name}")));
    }
    Ok(names)
}

/// Runs the tests of the installed wheel whose names contain the filter; without one all, and the linters.
/// The library and the host must be built.
///
/// # Errors
/// The first step that fails.
pub fn test(filter: Option<&str>) -> Result<()> {
    heading("Python");
    let (environment, wheel) = installed()?;
    if filter.is_none() {
        let lint = |program: &str, arguments: &[&str]| {
            run_command(environment.program(program).args(arguments).current_dir(package()))
        };
        lint("ruff", &["check", "--quiet", "."])?;
        lint("ruff", &["format", "--check", "--quiet", "."])?;
        lint("mypy", &["--cache-dir", "../../target/python/mypy"])?;
        if cfg!(target_os = "linux") {
            // Nothing else reads these before GitHub does.
            let workflows = files(&root().join(".github/workflows"), "yml")?;
            run_command(environment.program("actionlint").args(workflows))?;
        }
    }
    let mut pytest = environment.pytest(filter);
    pytest.arg(package().join("tests")).env("ISOPHOTE_HOST", host_file("debug"));
    run_tests(&mut pytest, filter)?;
    let nodes = pack_nodes(&environment, &wheel, &target_dir("python").join("comfyui"))?;
    let mut pytest = environment.pytest(filter);
    run_tests(pytest.arg(package().join(COMFYUI_TESTS)).env("ISOPHOTE_COMFYUI", nodes), filter)?;
    test_in_blender(&environment, &wheel, filter)
}

/// Tests of the nodes of ComfyUI, in the package's folder.
const COMFYUI_TESTS: &str = "comfyui/tests";

/// Tests of the Blender extension, in the package's folder.
const BLENDER_TESTS: &str = "blender/tests";

/// The version of Python that the Blender of the tests is for.
const BLENDER_PYTHON: &str = "3.11";

/// An environment with Blender, or why there is none.
fn with_blender(tools: &Environment) -> Result<std::result::Result<Environment, String>> {
    let version = tools.printed("import sys; print('%d.%d' % sys.version_info[:2])")?;
    if version != BLENDER_PYTHON {
        return Ok(Err(format!(
            "Blender's module is for Python {BLENDER_PYTHON}, and this one is {version}"
        )));
    }
    let environment = Environment(target_dir("python").join("blender"));
    environment.fill(&package().join("blender/requirements.txt"))?;
    Ok(Ok(environment))
}

/// Runs the tests of the extension in Blender, where this machine's Python has one.
fn test_in_blender(tools: &Environment, wheel: &Path, filter: Option<&str>) -> Result<()> {
    heading("Blender");
    let environment = match with_blender(tools)? {
        Ok(environment) => environment,
        Err(why) if std::env::var_os("CI").is_some() => return Err(Failure(why)),
        Err(why) => {
            println!("{why}: the extension is not tested");
            return Ok(());
        }
    };
    let extension = pack_extension(tools, wheel, &target_dir("python").join("extension"))?;
    // Blender's settings of the user stay as they are.
    let resources = target_dir("python").join("blender-user");
    if resources.exists() {
        std::fs::remove_dir_all(&resources).context(|| format!("cannot empty {}", resources.display()))?;
    }
    std::fs::create_dir_all(&resources).context(|| format!("cannot create {}", resources.display()))?;
    let mut pytest = environment.pytest(filter);
    pytest.arg(package().join(BLENDER_TESTS));
    pytest.env("ISOPHOTE_EXTENSION", extension).env("BLENDER_USER_RESOURCES", resources);
    run_tests(&mut pytest, filter)
}

/// Runs pytest. A filter may leave it none of its tests, which it tells by a code of its own.
fn run_tests(pytest: &mut Command, filter: Option<&str>) -> Result<()> {
    const NONE_CHOSEN: i32 = 5;
    let status = pytest.status().context(|| "pytest cannot be started".into())?;
    let is_none = filter.is_some() && status.code() == Some(NONE_CHOSEN);
    if status.success() || is_none { Ok(()) } else { Err(Failure(format!("pytest ended with {status}"))) }
}

/// Environment that the documentation's pages about Python and Blender are run in.
pub struct Documented {
    /// Folder of the wheel and the extension.
    pub packages: PathBuf,
    /// Folder of wheels of others, which pip takes instead of asking the network.
    pub wheels: PathBuf,
    /// Folder of the programs of an environment with Blender; none where this machine's Python has no Blender.
    pub blender: Option<PathBuf>,
}

/// Makes it, of the build for development. The library and the program that packs must be built.
///
/// # Errors
/// The first step that fails.
pub fn documented() -> Result<Documented> {
    let packages = target_dir("python").join("documented");
    pack("debug", &packages)?;
    let _turn = turn()?;
    let tools = Environment::tools()?;
    let blender = with_blender(&tools)?.ok().map(|environment| environment.programs());
    Ok(Documented { packages, wheels: tools.downloaded()?, blender })
}

/// The environment with the wheel of the build for development in it, and that wheel.
fn installed() -> Result<(Environment, PathBuf)> {
    let _turn = turn()?;
    let environment = Environment::tools()?;
    let wheel = build_wheel(&environment, "debug", &target_dir("python").join("wheels"))?;
    let mut pip = environment.program("python");
    pip.args([
        "-m",
        "pip",
        "install",
        "--quiet",
        "--force-reinstall",
        "--no-deps",
        "--disable-pip-version-check",
    ]);
    run_command(pip.arg(&wheel))?;
    Ok((environment, wheel))
}

/// Packs the library of a build, the package and its extension module.
fn build_wheel(environment: &Environment, profile: &str, out: &Path) -> Result<PathBuf> {
    put_beside_the_package(profile)?;
    for old in files(out, "whl").unwrap_or_default() {
        std::fs::remove_file(&old).context(|| format!("cannot replace {}", old.display()))?;
    }
    let mut maturin = environment.program("maturin");
    // The workspace's own build has linted the module.
    maturin.env_remove(WRAPPER);
    maturin.args(["build", "--quiet", "--locked", "--manifest-path"]).arg(package().join("Cargo.toml"));
    maturin.arg("--target-dir").arg(target_dir("python")).arg("--out").arg(out);
    maturin.arg("--interpreter").arg(environment.file("python"));
    maturin.args(["--profile", if profile == "debug" { "dev" } else { profile }]);
    if let Some(version) = packing::needed_glibc(&library_file(profile), profile)? {
        maturin.args(["--compatibility", &format!("manylinux_{}", version.replace('.', "_"))]);
    }
    run_command(&mut maturin)?;
    files(out, "whl")?.pop().ok_or_else(|| Failure("maturin has left no wheel".into()))
}

/// The packages that the wheel's binaries are.
const COMPILED: [&str; 2] = ["isophote-plugin", "isophote-python"];

/// Copies what is no part of the package's sources to where maturin packs it.
fn put_beside_the_package(profile: &str) -> Result<()> {
    let copy = |from: &Path, folder: &Path| {
        let to = folder.join(from.file_name().unwrap_or_default());
        std::fs::copy(from, &to).context(|| format!("cannot copy {} to {}", from.display(), to.display()))
    };
    for licence in ["LICENSE-APACHE", "LICENSE-MIT"] {
        copy(&root().join(licence), &package())?;
    }
    packing::write_materials(&COMPILED, None, profile, &package())?;
    let (library, inner) = (library_file(profile), package().join("isophote"));
    copy(&library, &inner)?;
    Ok(())
}

/// The folder of the package.
fn package() -> PathBuf {
    root().join("nodes/python")
}

/// The files of a folder with this ending, by name.
fn files(folder: &Path, ending: &str) -> Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder).context(|| format!("cannot read {}", folder.display()))?;
    let mut files: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|e| e == ending))
        .collect();
    files.sort();
    Ok(files)
}

/// A virtual environment of Python.
struct Environment(PathBuf);

impl Environment {
    /// The one with what the package is built and tested by.
    fn tools() -> Result<Self> {
        let environment = Self(target_dir("python").join("venv"));
        environment.fill(&package().join("requirements.txt"))?;
        Ok(environment)
    }

    /// Makes the environment where it has not these very packages.
    fn fill(&self, requirements: &Path) -> Result<()> {
        let wanted =
            std::fs::read(requirements).context(|| format!("cannot read {}", requirements.display()))?;
        let filled = self.0.join("requirements.txt");
        if std::fs::read(&filled).is_ok_and(|has| has == wanted) {
            return Ok(());
        }
        println!("setting up {}", self.0.display());
        let mut venv = Command::new(if cfg!(windows) { "python" } else { "python3" });
        run_command(venv.args(["-m", "venv", "--clear"]).arg(&self.0))?;
        let mut pip = self.program("python");
        pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--requirement"]);
        run_command(pip.arg(requirements))?;
        // Last, so that an environment that was left half full is filled again.
        std::fs::write(&filled, wanted).context(|| format!("cannot write {}", filled.display()))
    }

    /// Wheels of what the pages about Python install, in the versions of the environment.
    fn downloaded(&self) -> Result<PathBuf> {
        let failed = || "cannot keep the wheels that pages install".to_owned();
        let folder = target_dir("python").join("downloaded");
        let requirements = std::fs::read_to_string(self.0.join("requirements.txt")).context(failed)?;
        let wanted: Vec<&str> = requirements
            .lines()
            .filter(|line| line.starts_with("numpy=") || line.starts_with("pillow="))
            .collect();
        let list = folder.join("list.txt");
        if std::fs::read_to_string(&list).is_ok_and(|has| has == wanted.join("\n")) {
            return Ok(folder);
        }
        let mut pip = self.program("python");
        pip.args([
            "-m",
            "pip",
            "download",
            "--quiet",
            "--disable-pip-version-check",
            "--only-binary",
            ":all:",
        ]);
        run_command(pip.arg("--dest").arg(&folder).args(&wanted))?;
        std::fs::write(&list, wanted.join("\n")).context(failed)?;
        Ok(folder)
    }

    /// The folder of its programs.
    fn programs(&self) -> PathBuf {
        self.0.join(if cfg!(windows) { "Scripts" } else { "bin" })
    }

    fn file(&self, program: &str) -> PathBuf {
        self.programs().join(format!("{program}{}", std::env::consts::EXE_SUFFIX))
    }

    fn program(&self, program: impl AsRef<str>) -> Command {
        let mut command = Command::new(self.file(program.as_ref()));
        command.env("NODEVICE_SELECT", "1").env("PYTHONDONTWRITEBYTECODE", "1");
        // Another library or package would be tested instead.
        for variable in ["ISOPHOTE_LIBRARY", "PYTHONPATH", "PYTHONHOME"] {
            command.env_remove(OsStr::new(variable));
        }
        command
    }

    /// Pytest with the tests whose names contain the filter, elsewhere than in the package's folder, which has the package
    /// without its extension module.
    fn pytest(&self, filter: Option<&str>) -> Command {
        let mut pytest = self.program("pytest");
        pytest.current_dir(target_dir("python")).args([
            "-q",
            "-p",
            "no:cacheprovider",
            "--durations=5",
            "-rs",
        ]);
        pytest.arg("-c").arg(package().join("pyproject.toml"));
        pytest.args(filter.iter().flat_map(|filter| ["-k", filter]));
        pytest
    }

    /// Text that a line of Python prints.
    fn printed(&self, line: &str) -> Result<String> {
        let output = self.program("python").args(["-c", line]).output();
        let output = output.context(|| "Python cannot be started".into())?;
        Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    }
}
