//! Archives and the content of each: the one list that everything else walks.

use crate::binary;
use crate::desktop;
use crate::editors;
use crate::error::{Error, Result};
use crate::pack;
use crate::share::{Names, VERSION, abi_version, add_library, add_licences};
use crate::tree::{Entry, Tree};
use std::path::{Path, PathBuf};
use std::process::Command;

/// An archive.
pub struct Archive {
    /// Kind of the archive, in its name.
    kind: &'static str,
    contents: Contents,
}

/// Source of the contents of an archive.
enum Contents {
    /// They are gathered and packed here.
    Gathered(fn(&Built, &mut Tree) -> Result<()>),
    /// The tools of other languages have packed them, into a file whose name begins and ends so.
    Packed(&'static str, &'static str),
}

/// All archives.
pub const ARCHIVES: [Archive; 9] = [
    Archive { kind: "library", contents: Contents::Gathered(library) },
    Archive { kind: "openfx", contents: Contents::Gathered(openfx) },
    Archive { kind: "program", contents: Contents::Gathered(program) },
    Archive { kind: "card", contents: Contents::Gathered(card) },
    Archive { kind: "wheel", contents: Contents::Packed("isophote-", ".whl") },
    Archive { kind: "blender", contents: Contents::Packed("isophote-blender-", ".zip") },
    Archive { kind: "comfyui", contents: Contents::Packed("isophote-comfyui-", ".zip") },
    Archive { kind: "npm", contents: Contents::Packed("isophote-", ".tgz") },
    Archive { kind: "page", contents: Contents::Packed("isophote", ".html") },
];

impl Archive {
    /// Writes it into a folder; returns its name and its checksum.
    ///
    /// # Errors
    /// A binary or a licence that must not leave, and what cannot be read or written.
    pub fn write(&self, built: &Built, to: &Path) -> Result<(String, String)> {
        match self.contents {
            Contents::Gathered(fill) => {
                let mut tree = Tree::default();
                fill(built, &mut tree)?;
                let (system, machine) = (std::env::consts::OS, std::env::consts::ARCH);
                let folder = format!("isophote-{}-{VERSION}-{system}-{machine}", self.kind);
                let name = format!("{folder}.tar.gz");
                let sum = pack::pack(&tree, &folder, &to.join(&name), built.draft)?;
                Ok((name, sum))
            }
            Contents::Packed(beginning, ending) => {
                let file = built.only(self.kind, beginning, ending)?;
                let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
                let copy = to.join(&name);
                std::fs::copy(&file, &copy).map_err(Error::at(&file))?;
                Ok((name, pack::checksum(&copy)?))
            }
        }
    }
}

/// Programs and libraries that were built before.
pub struct Built {
    /// The root of the repository.
    pub root: PathBuf,
    /// Folder of the library and the program.
    pub folder: PathBuf,
    /// The OpenFX bundle.
    pub bundle: PathBuf,
    /// Folder of the program's icons.
    pub icons: PathBuf,
    /// Folder of what the tools of other languages have packed: wheel, Blender extension, nodes of ComfyUI, npm package, page.
    pub packed: PathBuf,
    /// True where it is not what users get.
    pub draft: bool,
}

impl Built {
    /// Looks whether all is there.
    ///
    /// # Errors
    /// [`Error::File`] naming what is missing.
    pub fn check(&self) -> Result<()> {
        for path in [&self.root, &self.folder, &self.bundle, &self.icons, &self.packed] {
            std::fs::metadata(path).map_err(Error::at(path))?;
        }
        Ok(())
    }

    /// The one file with this beginning and ending that the tools of other languages have packed.
    fn only(&self, kind: &str, beginning: &str, ending: &str) -> Result<PathBuf> {
        let entries = std::fs::read_dir(&self.packed).map_err(Error::at(&self.packed))?;
        let is_meant = |entry: &std::fs::DirEntry| {
            entry
                .file_name()
                .to_str()
                .is_some_and(|name| name.starts_with(beginning) && name.ends_with(ending))
        };
        let found: Vec<PathBuf> = entries.flatten().filter(is_meant).map(|entry| entry.path()).collect();
        match found.as_slice() {
            [file] => Ok(file.clone()),
            _ => {
                let problem =
                    format!("holds {} files {beginning}...{ending} instead of one, the {kind}", found.len());
                Err(Error::malformed(&self.packed, problem))
            }
        }
    }

    fn source(&self, path: &str) -> PathBuf {
        self.root.join(path)
    }
}

/// The package with the C and the OpenFX face.
const LIBRARY: &str = "isophote-plugin";
/// The package of the program.
const PROGRAM: &str = "isophote-program";

/// The C library for programs that are compiled against it.
fn library(built: &Built, tree: &mut Tree) -> Result<()> {
    let names = Names::new(abi_version(&built.root)?);
    add_library(tree, &built.root, &built.folder, built.draft)?;
    let import = built.folder.join("isophote.dll.lib");
    if cfg!(windows) {
        tree.copy("lib/isophote.lib", import);
    }
    tree.copy("include/isophote.h", built.source("include/isophote.h"));
    let folder = if cfg!(windows) { "bin" } else { "lib" };
    let filled = |text: &str| {
        text.replace("@VERSION@", VERSION)
            .replace("@LIBRARY@", &format!("{folder}/{}", names.file))
            .replace("@SONAME@", &names.soname)
            .replace("@PLAIN@", &names.plain)
    };
    tree.text("lib/pkgconfig/isophote.pc", filled(include_str!("../files/isophote.pc")));
    let cmake = "lib/cmake/Isophote";
    tree.text(format!("{cmake}/IsophoteConfig.cmake"), filled(include_str!("../files/IsophoteConfig.cmake")));
    let version = filled(include_str!("../files/IsophoteConfigVersion.cmake"));
    tree.text(format!("{cmake}/IsophoteConfigVersion.cmake"), version);
    examples(built, tree)?;
    tree.text("README.md", filled(include_str!("../files/library.md")));
    add_licences(tree, "share/doc/isophote", &built.root, &[LIBRARY])
}

/// Programs in C that were tried, to begin from.
fn examples(built: &Built, tree: &mut Tree) -> Result<()> {
    let place = "share/isophote/examples";
    tree.text(format!("{place}/CMakeLists.txt"), include_str!("../files/examples.cmake"));
    for name in ["linked.c", "plan.c", "load.h", "ppm.h"] {
        tree.copy(format!("{place}/{name}"), built.source("tests/c").join(name));
    }
    // A whole renderer, to read.
    for name in ["vulkan_host.c", "vulkan_device.h", "vulkan_scene.h", "vulkan_scene.wgsl"] {
        tree.copy(format!("{place}/vulkan/{name}"), built.source("tests/c").join(name));
    }
    let readme = built.source("README.md");
    let text = std::fs::read_to_string(&readme).map_err(Error::at(&readme))?;
    let block = text.split_once("```c\n").and_then(|(_, rest)| rest.split_once("```"));
    let (program, _) = block.ok_or_else(|| Error::malformed(&readme, "has no program in C"))?;
    tree.text(format!("{place}/stylize.c"), program);
    Ok(())
}

/// The plugin for hosts of OpenFX, and what installs it.
fn openfx(built: &Built, tree: &mut Tree) -> Result<()> {
    let names = Names::new(abi_version(&built.root)?);
    let name = built.bundle.file_name().unwrap_or_default().to_string_lossy().into_owned();
    tree.folder(&name, &built.bundle, "")?;
    let mut binaries = 0;
    for (place, entry) in &mut tree.entries {
        if let Entry::Copy(path) = entry
            && place.ends_with(".ofx")
        {
            binary::check(path, Some(&names.soname), built.draft)?;
            *entry = Entry::Program(path.clone());
            binaries += 1;
        }
    }
    if binaries != 1 {
        return Err(Error::malformed(&built.bundle, format!("holds {binaries} plugins instead of one")));
    }
    let catalogue = built.bundle.with_extension("json");
    editors::add(tree, &catalogue, &built.bundle.join("Contents/Resources"))?;
    if cfg!(windows) {
        tree.text("install.ps1", include_str!("../files/install.ps1"));
    } else {
        tree.add("install.sh", Entry::Script(include_str!("../files/install.sh").into()));
    }
    tree.text("README.md", include_str!("../files/openfx.md").replace("@VERSION@", VERSION));
    tree.copy("OPENFX.md", built.source("nodes/plugin/OPENFX.md"));
    add_licences(tree, "licences", &built.root, &[LIBRARY])
}

/// The program with its library, pages, completions, looks, and what desktops know it by.
fn program(built: &Built, tree: &mut Tree) -> Result<()> {
    let program = add_program(built, tree)?;
    documents(&program, tree)?;
    if cfg!(target_os = "linux") {
        desktop::add(tree, &built.icons)?;
    }
    tree.folder("share/isophote/looks", &built.source("nodes/library/looks"), ".json")?;
    tree.folder("share/isophote/graphs", &built.source("host-example/graphs"), ".json")?;
    tree.text("README.md", include_str!("../files/program.md").replace("@VERSION@", VERSION));
    add_licences(tree, "share/doc/isophote", &built.root, &[LIBRARY, PROGRAM])
}

/// Measurement of a graphics card on a machine that has nothing else.
fn card(built: &Built, tree: &mut Tree) -> Result<()> {
    add_program(built, tree)?;
    tree.add("measure.sh", Entry::Script(include_str!("../files/measure.sh").into()));
    tree.text("README.md", include_str!("../files/card.md").replace("@VERSION@", VERSION));
    add_licences(tree, "licences", &built.root, &[LIBRARY, PROGRAM])
}

/// The program and the library that it finds; returns the file that was built.
fn add_program(built: &Built, tree: &mut Tree) -> Result<PathBuf> {
    add_library(tree, &built.root, &built.folder, built.draft)?;
    let name = format!("isophote{}", std::env::consts::EXE_SUFFIX);
    let program = built.folder.join(&name);
    binary::check(&program, None, built.draft)?;
    tree.add(format!("bin/{name}"), Entry::Program(program.clone()));
    Ok(program)
}

/// Documents that the program writes about its own command line.
fn documents(program: &Path, tree: &mut Tree) -> Result<()> {
    let folder = tempfile::tempdir().map_err(Error::at(program))?;
    let mut command = Command::new(program);
    let output = command.arg("documents").arg(folder.path()).output().map_err(Error::at(program))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        return Err(Error::Program { command: "isophote documents".into(), said });
    }
    let mut found = Tree::default();
    found.folder("share", folder.path(), "")?;
    for (place, entry) in found.entries {
        if let Entry::Copy(path) = entry {
            tree.text(place, std::fs::read_to_string(&path).map_err(Error::at(&path))?);
        }
    }
    Ok(())
}
