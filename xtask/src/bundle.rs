//! `cargo xtask bundle`: the dynamic library as an OpenFX bundle, with its property list and an icon for
//! every effect, and its installation.

use crate::error::{Context, Failure, Result};
use crate::tools::{build_with_host, heading, host, library_file, program, run as run_command, target_dir};
use std::path::{Path, PathBuf};

/// Options of `cargo xtask bundle`.
#[derive(clap::Args)]
pub struct Options {
    /// Copies the bundle to the system's folder of OpenFX plugins, or to that of --to
    #[arg(long)]
    install: bool,
    /// The folder to install to; the system's may need an administrator
    #[arg(long, value_name = "DIR", requires = "install")]
    to: Option<PathBuf>,
    /// Takes the build for development, which is slow
    #[arg(long)]
    debug: bool,
}

const NAME: &str = "Isophote.ofx";

/// The folder of the bundle.
pub const FOLDER: &str = "Isophote.ofx.bundle";

/// The package that draws its icons.
pub const ICONS: &str = "isophote-icons";

/// Folder where hosts look for plugins.
const SYSTEM: &str = if cfg!(target_os = "windows") {
    r"C:\Program Files\Common Files\OFX\Plugins"
} else if cfg!(target_os = "macos") {
    "/Library/OFX/Plugins"
} else {
    "/usr/OFX/Plugins"
};

/// The standard's name for this machine.
const ARCHITECTURE: &str = if cfg!(target_os = "windows") {
    "Win64"
} else if cfg!(target_os = "macos") {
    "MacOS"
} else if cfg!(target_arch = "aarch64") {
    "Linux-aarch64"
} else {
    "Linux-x86-64"
};

/// Builds and writes the bundle, and installs it if asked to.
///
/// # Errors
/// The first step that fails.
pub fn run(options: &Options) -> Result<()> {
    heading("build");
    let profile = if options.debug { "debug" } else { "release" };
    build_with_host(profile, &[ICONS])?;
    let bundle = target_dir("bundle").join(FOLDER);
    write(&bundle, profile)?;
    println!("{}", bundle.display());
    if options.install {
        let folder = options.to.clone().unwrap_or_else(|| PathBuf::from(SYSTEM));
        let installed = folder.join(FOLDER);
        remove(&installed)?;
        copy(&bundle, &installed)?;
        println!("{}", installed.display());
    }
    Ok(())
}

/// Writes the bundle of a build, and the catalogue of its library beside it.
///
/// # Errors
/// The first step that fails.
pub fn write(bundle: &Path, profile: &str) -> Result<()> {
    remove(bundle)?;
    let contents = bundle.join("Contents");
    let (binaries, resources) = (contents.join(ARCHITECTURE), contents.join("Resources"));
    for folder in [&binaries, &resources] {
        std::fs::create_dir_all(folder).context(|| format!("cannot create {}", folder.display()))?;
    }
    let library = library_file(profile);
    std::fs::copy(&library, binaries.join(NAME)).context(|| format!("cannot copy {}", library.display()))?;
    let list = contents.join("Info.plist");
    std::fs::write(&list, property_list()).context(|| format!("cannot write {}", list.display()))?;
    // The icons follow the catalogue of the library that was built.
    let catalogue = bundle.with_extension("json");
    for (listed, file) in
        [(&["nodes"][..], &catalogue), (&["preset", "list"], &bundle.with_extension("looks.json"))]
    {
        let name = format!("isophote {}", listed.join(" "));
        let output = host(profile).args(listed).arg("--json").output();
        let output = output.context(|| format!("cannot run `{name}`"))?;
        if !output.status.success() {
            return Err(Failure(format!("`{name}`: {}", String::from_utf8_lossy(&output.stderr))));
        }
        std::fs::write(file, output.stdout).context(|| format!("cannot write {}", file.display()))?;
    }
    run_command(program(ICONS, profile).arg(&catalogue).arg(&resources))
}

fn property_list() -> String {
    let entry = |key: &str, value: &str| format!("  <key>{key}</key>\n  <string>{value}</string>\n");
    let entries: String = [
        ("CFBundleDevelopmentRegion", "English"),
        ("CFBundleExecutable", NAME),
        ("CFBundleIdentifier", "org.isophote.ofx"),
        ("CFBundleInfoDictionaryVersion", "6.0"),
        ("CFBundleName", "Isophote"),
        ("CFBundlePackageType", "BNDL"),
        ("CFBundleShortVersionString", env!("CARGO_PKG_VERSION")),
        ("CFBundleVersion", env!("CARGO_PKG_VERSION")),
    ]
    .map(|(key, value)| entry(key, value))
    .concat();
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <!DOCTYPE plist PUBLIC \"-//Apple//DTD PLIST 1.0//EN\" \
         \"http://www.apple.com/DTDs/PropertyList-1.0.dtd\">\n\
         <plist version=\"1.0\">\n<dict>\n{entries}</dict>\n</plist>\n"
    )
}

fn remove(folder: &Path) -> Result<()> {
    if folder.exists() {
        std::fs::remove_dir_all(folder).context(|| format!("cannot replace {}", folder.display()))?;
    }
    Ok(())
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    std::fs::create_dir_all(to).context(|| format!("cannot create {}", to.display()))?;
    let entries = std::fs::read_dir(from).context(|| format!("cannot read {}", from.display()))?;
    for entry in entries {
        let entry = entry.context(|| format!("cannot read {}", from.display()))?;
        let (source, target) = (entry.path(), to.join(entry.file_name()));
        if source.is_dir() {
            copy(&source, &target)?;
        } else {
            std::fs::copy(&source, &target).context(|| format!("cannot write {}", target.display()))?;
        }
    }
    Ok(())
}
