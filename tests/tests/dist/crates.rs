//! Crates as the registry would get them: packed by cargo's own rehearsal, unpacked, and used by a stranger's means, whose build
//! sees nothing of the repository.

use super::{VERSION, both};
use isophote_tests::library;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// Those that are published.
const CRATES: [&str; 7] = [
    "isophote",
    "isophote-abi",
    "isophote-cryptomatte",
    "isophote-engine",
    "isophote-exr-edit",
    "isophote-loader",
    "isophote-shaders",
];

fn cargo() -> Command {
    Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Runs a command, which must succeed; returns what it printed.
fn succeed(command: &mut Command) -> String {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{command:?}: {}", both(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// Crates of a rehearsal, unpacked.
struct Published {
    folder: TempDir,
}

impl Published {
    fn new() -> Self {
        let folder = TempDir::new().unwrap();
        let pack = |arguments: &[&str]| {
            let mut pack = cargo();
            pack.args(arguments).args(["--quiet", "--no-verify", "--allow-dirty", "--target-dir"]);
            succeed(pack.arg(folder.path()).current_dir(library::root()));
        };
        // What the registry would refuse.
        pack(&["publish", "--dry-run", "--workspace"]);
        let mut named = vec!["package"];
        named.extend(CRATES.iter().flat_map(|name| ["--package", name]));
        pack(&named);
        let this = Self { folder };
        for name in CRATES {
            let packed = this.folder.path().join(format!("package/{name}-{VERSION}.crate"));
            succeed(Command::new("tar").arg("xzf").arg(&packed).current_dir(this.folder.path()));
            for file in ["README.md", "LICENSE-MIT", "LICENSE-APACHE"] {
                let text = std::fs::read_to_string(this.of(name).join(file)).unwrap();
                assert!(text.lines().count() > 5, "{name}: {file}");
            }
        }
        this
    }

    /// Folder of a crate.
    fn of(&self, name: &str) -> PathBuf {
        self.folder.path().join(format!("{name}-{VERSION}"))
    }

    /// A command of cargo for a crate, to which the others are what the registry has.
    fn cargo(&self, name: &str, arguments: &[&str]) -> Command {
        let mut cargo = cargo();
        cargo.args(arguments).arg("--quiet").arg("--manifest-path").arg(self.of(name).join("Cargo.toml"));
        for other in CRATES.into_iter().filter(|other| *other != name) {
            let path = self.of(other);
            cargo.arg("--config").arg(format!("patch.crates-io.{other}.path='{}'", path.display()));
        }
        // What others need is compiled once, however often this is run.
        cargo.env("CARGO_TARGET_DIR", library::path().ancestors().nth(2).unwrap().join("stranger"));
        cargo.current_dir(self.folder.path());
        cargo
    }

    /// What an example of a crate prints.
    fn example(&self, name: &str, example: &str) -> String {
        succeed(&mut self.cargo(name, &["run", "--example", example]))
    }
}

#[test]
fn crates_are_packed_and_their_examples_run() {
    let published = Published::new();
    assert!(
        published
            .example("isophote-engine", "own_kernel")
            .contains("[0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0]")
    );
    assert!(published.example("isophote-abi", "sizes").contains("IsophoteRequest "));
    let mut nodes = published.cargo("isophote-loader", &["run", "--example", "nodes"]);
    assert!(succeed(nodes.env("ISOPHOTE_LIBRARY", library::path())).contains("anisotropic_kuwahara"));
    succeed(&mut published.cargo("isophote-exr-edit", &["build"]));
    stylize(&published);
}

/// The example of the library, from file to file.
fn stylize(published: &Published) {
    let folder = published.folder.path();
    let picture = image::RgbImage::from_fn(48, 32, |x, y| {
        image::Rgb(if x / 16 % 2 == 0 { [220, 40, (y * 4) as u8] } else { [30, 90, 200] })
    });
    picture.save(folder.join("in.png")).unwrap();
    let mut run = published.cargo("isophote", &["run", "--example", "stylize"]);
    succeed(run.args(["--", "in.png", "out.png", "quantize_luminance"]));
    let (width, height) = image::image_dimensions(folder.join("out.png")).unwrap();
    assert_eq!((width, height), (48, 32));
    let [before, after] = ["in.png", "out.png"].map(|name| pixels(&folder.join(name)));
    assert!(before != after, "nothing was done");

    let mut run = published.cargo("isophote", &["run", "--example", "stylize"]);
    let failed = run.args(["--", "in.png", "none.png", "carton"]).output().unwrap();
    assert!(!failed.status.success() && both(&failed).contains("cartoon"), "{}", both(&failed));
    assert!(!folder.join("none.png").exists());
}

fn pixels(path: &Path) -> Vec<u8> {
    image::open(path).unwrap().into_rgb8().into_raw()
}
