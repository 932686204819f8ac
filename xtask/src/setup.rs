//! Needs of the other chores on the machine: Debian packages, asked for only when the thing they
//! bring is missing.

use crate::error::{Failure, Result};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Something that a chore needs, how to see whether it is there, and what brings it.
pub struct Need {
    what: &'static str,
    present: fn() -> bool,
    packages: &'static [&'static str],
}

/// A Vulkan driver: a real one, or Mesa's software rasteriser.
pub const VULKAN: Need = Need {
    what: "a Vulkan driver",
    present: || shared_library("libvulkan.so.1") && vulkan_driver(),
    packages: &["libvulkan1", "mesa-vulkan-drivers"],
};

/// A C compiler.
pub const C_COMPILER: Need =
    Need { what: "a C compiler", present: || program("cc"), packages: &["gcc", "libc6-dev"] };

/// A C++ compiler.
pub const CPP_COMPILER: Need =
    Need { what: "a C++ compiler", present: || program("c++"), packages: &["g++"] };

/// Headers that a C program that uses Vulkan is compiled with, and layers that check each of its calls.
pub const VULKAN_HEADERS: Need = Need {
    what: "the headers and validation layers of Vulkan",
    present: || {
        !cfg!(target_os = "linux")
            || (Path::new("/usr/include/vulkan/vulkan.h").exists()
                && Path::new("/usr/share/vulkan/explicit_layer.d/VkLayer_khronos_validation.json").exists())
    },
    packages: &["libvulkan-dev", "vulkan-validationlayers"],
};

/// `nm`, to list exported symbols.
pub const BINUTILS: Need = Need { what: "binutils", present: || program("nm"), packages: &["binutils"] };

/// The memory checker; it reads the C library's debug symbols.
pub const VALGRIND: Need = Need {
    what: "valgrind",
    present: || program("valgrind") && Path::new("/usr/lib/debug/.build-id").exists(),
    packages: &["valgrind", "libc6-dbg"],
};

/// A second compiler of C and C++, which the header is tried by.
pub const CLANG: Need =
    Need { what: "clang", present: || program("clang") && program("clang++"), packages: &["clang"] };

/// A browser without a window, whose compiler is the second one that shaders are tried by.
pub const BROWSER: Need = Need {
    what: "Chromium without a window",
    present: || {
        ["chromium-headless-shell", "chromium", "chromium-browser", "google-chrome"].into_iter().any(program)
    },
    packages: &["chromium-headless-shell"],
};

/// The compiler of the system, of Debian's package for browsers: newer than its others, and with its sources.
pub const SYSTEM_RUSTC: &str = "/usr/bin/rustc";

/// Browsers, as compilers name them.
pub const WASM_TARGET: &str = "wasm32-unknown-unknown";

/// 64-bit ARM with Linux, as compilers name it.
pub const AARCH64_TARGET: &str = "aarch64-unknown-linux-gnu";

/// Compiler, linker and emulator for 64-bit ARM.
pub const AARCH64: Need = Need {
    what: "a cross compiler and an emulator for ARM",
    present: || {
        let compiles = has_target(AARCH64_TARGET) || Path::new(SYSTEM_RUSTC).is_file();
        compiles && program("aarch64-linux-gnu-gcc") && program("qemu-aarch64")
    },
    packages: &["rustc-web", "gcc-aarch64-linux-gnu", "libc6-dev-arm64-cross", "qemu-user"],
};

/// 64-bit Windows with MinGW's libraries, as compilers name it.
#[cfg(unix)]
pub const WINDOWS_TARGET: &str = "x86_64-pc-windows-gnu";

/// Linker and libraries for Windows.
#[cfg(unix)]
pub const MINGW: Need = Need {
    what: "MinGW",
    present: || program("x86_64-w64-mingw32-gcc"),
    packages: &["gcc-mingw-w64-x86-64"],
};

/// What runs programs for Windows.
#[cfg(unix)]
pub const WINE: Need = Need {
    what: "Wine",
    present: || program("wine") && program("wineserver"),
    packages: &["wine", "wine64"],
};

/// A standard library of Rust for browsers, or its sources. `rustup target add wasm32-unknown-unknown` brings it, too.
pub const WASM: Need = Need {
    what: "Rust for WebAssembly (rustup target add wasm32-unknown-unknown)",
    present: || has_target(WASM_TARGET) || has_std_sources(),
    packages: &["rustc-web", "rust-web-src"],
};

/// The sources of Rust's standard library, with the compiler that they belong to.
pub const STD_SOURCES: Need = Need {
    what: "the sources of Rust's standard library",
    present: has_std_sources,
    packages: WASM.packages,
};

/// Programs that bundle and test pages.
pub const NODE: Need = Need {
    what: "Node.js with npm",
    present: || program("node") && program("npm"),
    packages: &["nodejs", "npm"],
};

/// Programs that users of the library build with, that show manual pages, and that tell whether desktops take the program's
/// entry.
pub const PACKAGING: Need = Need {
    what: "CMake, pkg-config, man, appstreamcli and desktop-file-validate",
    present: || {
        let programs = ["cmake", "make", "pkg-config", "man", "appstreamcli", "desktop-file-validate"];
        programs.into_iter().all(program)
    },
    packages: &["cmake", "make", "pkg-config", "man-db", "appstream", "desktop-file-utils"],
};

/// Python with virtual environments.
pub const PYTHON: Need = Need {
    what: "Python with virtual environments",
    present: || {
        let python = if cfg!(windows) { "python" } else { "python3" };
        let mut modules = Command::new(python);
        modules.args(["-c", "import venv, ensurepip"]).stdout(Stdio::null()).stderr(Stdio::null());
        modules.status().is_ok_and(|status| status.success())
    },
    packages: &["python3", "python3-venv"],
};

/// Libraries of the system that Blender as a module of Python loads.
pub const BLENDER: Need = Need {
    what: "the libraries that Blender loads",
    present: || {
        [
            "libGL.so.1",
            "libICE.so.6",
            "libSM.so.6",
            "libX11.so.6",
            "libXext.so.6",
            "libXfixes.so.3",
            "libXi.so.6",
            "libXrender.so.1",
            "libXt.so.6",
            "libxkbcommon.so.0",
        ]
        .into_iter()
        .all(shared_library)
    },
    packages: &[
        "libgl1",
        "libice6",
        "libsm6",
        "libx11-6",
        "libxext6",
        "libxfixes3",
        "libxi6",
        "libxrender1",
        "libxt6",
        "libxkbcommon0",
    ],
};

/// Programs that read and write videos, and that draw curves.
pub const FFMPEG: Need = Need {
    what: "ffmpeg and rsvg-convert",
    present: || ["ffmpeg", "ffprobe", "rsvg-convert"].into_iter().all(program),
    packages: &["ffmpeg", "librsvg2-bin"],
};

/// A display without a screen, what winit loads to open a window on it, and what windows are read aloud by.
pub const XVFB: Need = Need {
    what: "Xvfb, the X11 libraries, D-Bus and AT-SPI",
    present: || {
        program("Xvfb")
            && program("xdotool")
            && program("dbus-daemon")
            && Path::new("/usr/share/dbus-1/services/org.a11y.Bus.service").exists()
            && [
                "libX11.so.6",
                "libX11-xcb.so.1",
                "libXcursor.so.1",
                "libXi.so.6",
                "libXrandr.so.2",
                "libxkbcommon-x11.so.0",
            ]
            .into_iter()
            .all(shared_library)
    },
    packages: &[
        "xvfb",
        "xauth",
        "xdotool",
        "dbus-daemon",
        "at-spi2-core",
        "libx11-6",
        "libx11-xcb1",
        "libxcursor1",
        "libxi6",
        "libxrandr2",
        "libxkbcommon-x11-0",
    ],
};

/// A scheduler of render farms, its controller and its node.
pub const SLURM: Need = Need {
    what: "Slurm",
    present: || {
        program("sbatch")
            && ["/usr/sbin/slurmctld", "/usr/sbin/slurmd"].into_iter().all(|p| Path::new(p).exists())
    },
    packages: &["slurm-wlm"],
};

/// Makes sure that everything in `needs` is there, installing packages where this machine is a
/// Debian and the user may.
///
/// # Errors
/// Names what is missing and the command that installs it.
pub fn ensure(needs: &[&Need]) -> Result<()> {
    let missing: Vec<&&Need> = needs.iter().filter(|n| !(n.present)()).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let packages: Vec<&str> = missing.iter().flat_map(|n| n.packages.iter().copied()).collect();
    let what = missing.iter().map(|n| n.what).collect::<Vec<_>>().join(", ");
    let by_hand = format!("apt-get install {}", packages.join(" "));
    let Some(prefix) = apt() else {
        return Err(Failure(format!(
            "this machine lacks {what}, and packages cannot be installed from here; on Debian, run as root: {by_hand}"
        )));
    };
    println!("installing what is missing ({what}): {by_hand}");
    let apt = |arguments: &[&str]| {
        let mut line: Vec<&str> = prefix.to_vec();
        line.extend(["apt-get", "-q"]);
        line.extend(arguments);
        Command::new(line[0])
            .args(&line[1..])
            .env("DEBIAN_FRONTEND", "noninteractive")
            .status()
            .is_ok_and(|s| s.success())
    };
    let mut install = vec!["install", "-y", "--no-install-recommends"];
    install.extend(&packages);
    if !(apt(&["update"]) && apt(&install)) {
        return Err(Failure(format!("could not install {what}; run as root: {by_hand}")));
    }
    match missing.iter().find(|n| !(n.present)()) {
        Some(need) => Err(Failure(format!("{} is still missing after: {by_hand}", need.what))),
        None => Ok(()),
    }
}

/// Command that runs apt-get: as it is, through a sudo that asks nothing, or not at all.
fn apt() -> Option<&'static [&'static str]> {
    if !program("apt-get") {
        return None;
    }
    let quiet = |name: &str, arguments: &[&str]| {
        Command::new(name)
            .args(arguments)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .stdin(Stdio::null())
            .status()
    };
    let root = Command::new("id").arg("-u").output().is_ok_and(|o| o.stdout.trim_ascii() == b"0");
    if root {
        Some(&["env"])
    } else if quiet("sudo", &["-n", "true"]).is_ok_and(|s| s.success()) {
        Some(&["sudo", "-n", "env"])
    } else {
        None
    }
}

/// True where the compiler of this build has the standard library of a target.
pub fn has_target(name: &str) -> bool {
    sysroot("rustc").is_some_and(|sysroot| sysroot.join("lib/rustlib").join(name).join("lib").is_dir())
}

/// True where the compiler of the system has the sources of its standard library.
fn has_std_sources() -> bool {
    sysroot(SYSTEM_RUSTC)
        .is_some_and(|sysroot| sysroot.join("lib/rustlib/src/rust/library/Cargo.lock").is_file())
}

/// The folder of a compiler.
pub fn sysroot(compiler: &str) -> Option<PathBuf> {
    let output = Command::new(compiler).args(["--print", "sysroot"]).output().ok()?;
    output.status.success().then(|| PathBuf::from(String::from_utf8_lossy(&output.stdout).trim()))
}

fn program(name: &str) -> bool {
    std::env::var_os("PATH")
        .is_some_and(|path| std::env::split_paths(&path).any(|dir| dir.join(name).is_file()))
}

/// True where a library lies in a folder in which Debian and its relatives keep them; other systems manage their own.
fn shared_library(name: &str) -> bool {
    if !cfg!(target_os = "linux") {
        return true;
    }
    let arch = format!("/usr/lib/{}-linux-gnu", std::env::consts::ARCH);
    [arch.as_str(), "/usr/lib64", "/usr/lib", "/usr/local/lib", "/lib"]
        .iter()
        .any(|dir| Path::new(dir).join(name).exists())
}

fn vulkan_driver() -> bool {
    if !cfg!(target_os = "linux")
        || std::env::var_os("VK_DRIVER_FILES").is_some()
        || std::env::var_os("VK_ICD_FILENAMES").is_some()
    {
        return true;
    }
    ["/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d"]
        .iter()
        .any(|dir| std::fs::read_dir(dir).is_ok_and(|mut entries| entries.next().is_some()))
}
