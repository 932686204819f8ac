//! Search for the library, and checks that it is what it should be.

use std::env;
use std::ffi::OsStr;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::error::{Error, Result};
use isophote_abi::{ISOPHOTE_ABI_VERSION, IsophoteApi, IsophoteEntry};

/// Environment variable that names the library's file.
const VARIABLE: &str = "ISOPHOTE_LIBRARY";

/// Advice to fix most of what can go wrong.
const FIX: &str = "copy the archive's folder lib beside its folder bin (in the sources: cargo build --workspace), or set \
                   ISOPHOTE_LIBRARY to the library's file";

/// An error of loading, which most users mend in one way.
fn failure(problem: String) -> Error {
    Error::Load { problem, fix: FIX }
}

/// The table of the library, and the file it came from.
pub fn find() -> Result<(&'static IsophoteApi, PathBuf)> {
    if let Some(path) = env::var_os(VARIABLE).filter(|v| !v.is_empty()).map(PathBuf::from) {
        if !path.is_file() {
            return Err(failure(format!(
                "the library '{}' named by {VARIABLE} does not exist",
                path.display()
            )));
        }
        return Ok((open(&path)?, path));
    }
    let name = libloading::library_filename("isophote");
    let beside = env::current_exe().ok().and_then(|exe| exe.parent().map(Path::to_owned));
    let near = beside.iter().flat_map(|folder| [folder.join(&name), folder.join("../lib").join(&name)]);
    if let Some(path) = near.into_iter().find(|path| path.is_file()) {
        return Ok((open(&path)?, path));
    }
    let library = load(name.as_ref()).map_err(|_| {
        let places = beside.map_or_else(String::new, |f| format!("in '{}', ", f.display()));
        failure(format!(
            "the library {} was not found {places}in ../lib or among the system's",
            Path::new(&name).display()
        ))
    })?;
    let path = PathBuf::from(name);
    Ok((table(library, &path)?, path))
}

/// The table of the library in this file.
pub fn open(path: &Path) -> Result<&'static IsophoteApi> {
    // A bare name would be looked for among the system's libraries instead.
    let absolute = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    if is_cut(&absolute) {
        return Err(failure(format!(
            "'{}' cannot be loaded as a dynamic library: it is cut short",
            path.display()
        )));
    }
    let library = load(absolute.as_os_str()).map_err(|e| {
        failure(format!("'{}' cannot be loaded as a dynamic library: {}", path.display(), reason(&e)))
    })?;
    table(library, path)
}

fn load(name: &OsStr) -> std::result::Result<libloading::Library, libloading::Error> {
    // SAFETY: loading runs the library's initialisers. The file is the one that the user or the installation
    // names as Isophote, whose initialisers do nothing; there is no way to know beforehand.
    unsafe { libloading::Library::new(name) }
}

/// True where the file is a 64-bit ELF library that ends before its table of sections, which comes last. The
/// system's loader does not notice, and the process is killed at the first touch of what is missing.
fn is_cut(path: &Path) -> bool {
    let mut header = [0u8; 64];
    let Ok(mut file) = File::open(path) else { return false };
    if file.read_exact(&mut header).is_err() || !header.starts_with(b"\x7fELF\x02\x01") {
        return false;
    }
    let short = |at: usize| u64::from(u16::from_le_bytes([header[at], header[at + 1]]));
    let Some(sections) = header[40..].first_chunk().map(|bytes| u64::from_le_bytes(*bytes)) else {
        return false;
    };
    let end = sections.saturating_add(short(58) * short(60));
    file.metadata().is_ok_and(|metadata| metadata.len() < end)
}

/// Libloading wraps what the system says.
fn reason(error: &libloading::Error) -> String {
    use std::error::Error as _;
    error.source().map_or_else(|| error.to_string(), ToString::to_string)
}

fn table(library: libloading::Library, path: &Path) -> Result<&'static IsophoteApi> {
    // SAFETY: the contract gives the symbol this type; no other library has a reason to bear it.
    let entry = unsafe { library.get::<IsophoteEntry>(b"isophote_api\0") };
    let Some(entry) = entry.ok().and_then(|symbol| *symbol) else {
        return Err(failure(format!(
            "'{}' is a dynamic library, but not Isophote: it has no function isophote_api",
            path.display()
        )));
    };
    // SAFETY: the symbol is the library's entry, which takes any number.
    let api = unsafe { entry(ISOPHOTE_ABI_VERSION) };
    let other = |found: String| Error::Load {
        problem: format!("'{}' {found}; this program needs version {ISOPHOTE_ABI_VERSION}", path.display()),
        fix: "use the library and the program of one release",
    };
    if api.is_null() {
        return Err(other(format!("has no ABI version {ISOPHOTE_ABI_VERSION}")));
    }
    // SAFETY: every version's table begins with these two numbers; what follows is looked at only when they
    // are as they should be.
    let (version, size) =
        unsafe { ((&raw const (*api).abi_version).read(), (&raw const (*api).struct_size).read()) };
    if version != ISOPHOTE_ABI_VERSION || size as usize != size_of::<IsophoteApi>() {
        return Err(other(format!("offers ABI version {version} with a table of {size} bytes")));
    }
    // The table and all that it leads to are valid as long as the library is loaded: until the process ends.
    std::mem::forget(library);
    // SAFETY: version and size say that this is the table declared in the contract; it is constant.
    Ok(unsafe { &*api })
}
