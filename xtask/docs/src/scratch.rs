//! The folder in which the commands of pages are run, with what they take for granted: pictures, a scene, a sequence, the
//! library.

use crate::error::{Error, Result};
use crate::markdown::Block;
use crate::page::Page;
use crate::studio::finish;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Files that pages take for granted, made once, when the first needs them.
pub struct Seed<'a> {
    /// Folder where they are made.
    pub folder: PathBuf,
    /// The sample host.
    pub host: &'a Path,
    /// The demo scene.
    pub scene: &'a Path,
    /// The dynamic library.
    pub library: &'a Path,
    /// The repository.
    pub root: &'a Path,
    /// Folder of the wheel and the Blender extension.
    pub packages: &'a Path,
    /// Folder of wheels of others, from which pip installs.
    pub wheels: &'a Path,
    /// Folder of the Python that has Blender as a module, if there is one.
    pub blender: Option<&'a Path>,
}

/// Number of commands on a page.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Blocks that were run.
    pub run: usize,
    /// Blocks that only a person can run.
    pub by_hand: usize,
}

impl Seed<'_> {
    /// Renders the demo scene as `photo.png` and as the sequence `shot.1001.exr` to `shot.1004.exr`, and puts the scene
    /// (`scene.gltf`), a painted control map (`focus.png`), the program, the header, the library, the wheel and the Blender extension beside them.
    fn make(&self) -> Result<()> {
        let folder = &self.folder;
        for name in ["bin", "include", "lib"] {
            let place = folder.join(name);
            std::fs::create_dir_all(&place).map_err(Error::at(&place))?;
        }
        link(self.host, &folder.join("bin/isophote"))?;
        link(&self.root.join("include/isophote.h"), &folder.join("include/isophote.h"))?;
        for name in ["libisophote.so", "libisophote.so.1"] {
            link(self.library, &folder.join("lib").join(name))?;
        }
        for entry in std::fs::read_dir(self.packages).map_err(Error::at(self.packages))? {
            let path = entry.map_err(Error::at(self.packages))?.path();
            link(&path, &folder.join(path.file_name().unwrap_or_default()))?;
        }
        let sources = self.scene.parent().unwrap_or(self.scene);
        for entry in std::fs::read_dir(sources).map_err(Error::at(sources))? {
            let path = entry.map_err(Error::at(sources))?.path();
            // Scenes take no files from outside their folder, where links would lead.
            copy(&path, &folder.join(path.file_name().unwrap_or_default()))?;
        }
        copy(self.scene, &folder.join("scene.gltf"))?;
        copy(&self.root.join("xtask/docs/pictures/focus.png"), &folder.join("focus.png"))?;
        let render = |out: &str, more: &[&str]| {
            let mut command = Command::new(self.host);
            command.arg("render").arg("scene.gltf").arg(out).args(more).current_dir(folder);
            finish(&mut command)
        };
        render("photo.png", &["--size", "480x320"])?;
        render("shot.####.exr", &["--size", "240x160", "--animate", "--frames", "1001-1004"])
    }

    /// The folders of the program, and of a Python with Blender where that is asked for, in front of the system's.
    fn path(&self, blender: Option<&Path>) -> OsString {
        let mut path = self.folder.join("bin").into_os_string();
        if let Some(blender) = blender {
            path.push(":");
            path.push(blender);
        }
        if let Some(system) = std::env::var_os("PATH") {
            path.push(":");
            path.push(system);
        }
        path
    }

    /// Writes the files of a page and runs its commands, in order, in a folder of its own.
    ///
    /// # Errors
    /// [`Error::Page`] with the block that fails.
    pub fn run(&self, page: &Page, blocks: &[Block], scratch: &Path) -> Result<Counts> {
        if blocks.iter().any(|block| block.is_shell() && !block.is_by_hand()) {
            if !self.folder.exists() {
                self.make()?;
            }
            clone(&self.folder, scratch)?;
        }
        let mut counts = Counts::default();
        for block in blocks {
            if let Some(name) = block.file() {
                std::fs::create_dir_all(scratch).map_err(Error::at(scratch))?;
                let file = scratch.join(name);
                std::fs::write(&file, &block.text).map_err(Error::at(&file))?;
            } else if block.is_shell() && (block.is_by_hand() || self.is_without(block)) {
                counts.by_hand += 1;
            } else if block.is_shell() {
                self.shell(page, block, scratch)?;
                counts.run += 1;
            }
        }
        Ok(counts)
    }

    /// True where a block needs a Blender that is not there.
    fn is_without(&self, block: &Block) -> bool {
        block.needs_blender() && self.blender.is_none()
    }

    fn shell(&self, page: &Page, block: &Block, scratch: &Path) -> Result<()> {
        let mut command = Command::new("sh");
        let blender = self.blender.filter(|_| block.needs_blender());
        command.args(["-e", "-c", &block.text]).current_dir(scratch).env("PATH", self.path(blender));
        // What pages install comes from this machine, and nothing of its user is used or changed.
        command.env("PIP_NO_INDEX", "1").env("PIP_FIND_LINKS", self.wheels);
        command.env("BLENDER_USER_RESOURCES", scratch.join("blender")).env_remove("PYTHONPATH");
        let output = command.output().map_err(Error::at(Path::new("sh")))?;
        if output.status.success() {
            return Ok(());
        }
        let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        Err(Error::page(&page.path, format!("these commands fail:\n{}{said}", block.text)))
    }
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    std::fs::copy(from, to).map(drop).map_err(Error::at(from))
}

/// The same files in another folder, without a copy of their bytes.
fn clone(from: &Path, to: &Path) -> Result<()> {
    std::fs::create_dir_all(to).map_err(Error::at(to))?;
    for entry in std::fs::read_dir(from).map_err(Error::at(from))? {
        let entry = entry.map_err(Error::at(from))?;
        let (path, target) = (entry.path(), to.join(entry.file_name()));
        let kind = entry.file_type().map_err(Error::at(&path))?;
        if kind.is_dir() {
            clone(&path, &target)?;
        } else if kind.is_symlink() {
            link(&path, &target)?;
        } else {
            std::fs::hard_link(&path, &target).map_err(Error::at(&target))?;
        }
    }
    Ok(())
}

/// Another name for a file, by its full path.
fn link(from: &Path, to: &Path) -> Result<()> {
    let from = from.canonicalize().map_err(Error::at(from))?;
    #[cfg(unix)]
    return std::os::unix::fs::symlink(&from, to).map_err(Error::at(to));
    #[cfg(not(unix))]
    return Err(Error::page(to.display(), format!("{} cannot be linked to on this system", from.display())));
}
