//! Checks that a binary may leave the machine that built it, by what it asks of the system that it is loaded on. Read
//! from the ELF file itself; other systems' formats have none of this.

use crate::error::{Error, Result};
use object::elf::{DT_NEEDED, DT_RPATH, DT_RUNPATH, DT_SONAME, FileHeader64, SHT_SYMTAB};
use object::read::elf::{Dyn as _, FileHeader as _, SectionHeader as _, SectionTable};
use object::{Endianness, StringTable};
use std::path::Path;

/// The GNU C library of Rocky Linux 9, the oldest system that is promised. Debian 12 builds what runs there.
const NEWEST_GLIBC: [u32; 3] = [2, 34, 0];

/// Libraries that come with every system that has the GNU C library. `ld-linux` is named by its machine.
const SYSTEM: [&str; 5] = ["libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "libgcc_s.so.1"];

/// Facts that a binary tells of itself.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Facts {
    /// Libraries that it is linked to.
    pub needed: Vec<String>,
    /// Its own name for those that link to it.
    pub soname: Option<String>,
    /// Folders that its libraries are looked for in, beside the system's.
    pub search: Vec<String>,
    /// Versions of the C library whose symbols it uses.
    pub glibc: Vec<[u32; 3]>,
    /// True where it still has the symbols that only debuggers read.
    pub has_symbols: bool,
}

type Header = FileHeader64<Endianness>;

/// Reads a binary's facts; `None` for files that are no 64-bit ELF.
///
/// # Errors
/// [`Error::File`] and [`Error::Malformed`].
pub fn facts(path: &Path) -> Result<Option<Facts>> {
    let bytes = std::fs::read(path).map_err(Error::at(path))?;
    if !bytes.starts_with(b"\x7fELF\x02") {
        return Ok(None);
    }
    parse(&bytes).map(Some).map_err(|error| Error::malformed(path, error))
}

fn parse(bytes: &[u8]) -> object::Result<Facts> {
    let header = Header::parse(bytes)?;
    let endian = header.endian()?;
    let sections = header.sections(endian, bytes)?;
    let mut facts = Facts {
        has_symbols: sections.iter().any(|section| section.sh_type(endian) == SHT_SYMTAB),
        glibc: glibc(&sections, endian, bytes)?,
        ..Facts::default()
    };
    let Some((entries, strings)) = sections.dynamic(endian, bytes)? else { return Ok(facts) };
    let strings: StringTable<'_> = sections.strings(endian, bytes, strings)?;
    for entry in entries {
        let text = || entry.string(endian, strings).map(|name| String::from_utf8_lossy(name).into_owned());
        match entry.tag(endian) {
            DT_NEEDED => facts.needed.push(text()?),
            DT_SONAME => facts.soname = Some(text()?),
            DT_RPATH | DT_RUNPATH => facts.search.push(text()?),
            _ => {}
        }
    }
    Ok(facts)
}

/// The versions of the C library that the binary's undefined symbols name.
fn glibc(
    sections: &SectionTable<'_, Header>,
    endian: Endianness,
    bytes: &[u8],
) -> object::Result<Vec<[u32; 3]>> {
    let mut versions = Vec::new();
    let Some((mut needs, strings)) = sections.gnu_verneed(endian, bytes)? else { return Ok(versions) };
    let strings = sections.strings(endian, bytes, strings)?;
    while let Some((_, mut names)) = needs.next()? {
        while let Some(name) = names.next()? {
            let name = String::from_utf8_lossy(name.name(endian, strings)?).into_owned();
            versions.extend(name.strip_prefix("GLIBC_").and_then(version));
        }
    }
    versions.sort_unstable();
    Ok(versions)
}

fn version(text: &str) -> Option<[u32; 3]> {
    let mut numbers = text.split('.').map(str::parse);
    let mut next = || numbers.next().unwrap_or(Ok(0)).ok();
    Some([next()?, next()?, next()?])
}

/// The version of the C library that a binary needs, as `2.35`; nothing for files that are no 64-bit ELF.
///
/// # Errors
/// As [`facts`].
pub fn needed_glibc(path: &Path) -> Result<Option<String>> {
    Ok(facts(path)?.and_then(|facts| facts.glibc.last().copied()).map(written))
}

fn written(version: [u32; 3]) -> String {
    format!("{}.{}", version[0], version[1])
}

/// Reason why a binary may not leave; nothing where it may. Drafts may keep their symbols.
pub fn fault(facts: &Facts, soname: Option<&str>, draft: bool) -> Option<String> {
    if let Some(newest) = facts.glibc.last().filter(|newest| **newest > NEWEST_GLIBC) {
        return Some(format!(
            "needs the C library {}, newer than {} of Rocky Linux 9: build on that or on Debian 12",
            written(*newest),
            written(NEWEST_GLIBC)
        ));
    }
    if let Some(folder) = facts.search.first() {
        return Some(format!(
            "looks for libraries in {folder}, which others do not have: build without rpath"
        ));
    }
    let known = |name: &String| SYSTEM.contains(&name.as_str()) || name.starts_with("ld-linux");
    if let Some(library) = facts.needed.iter().find(|name| !known(name)) {
        return Some(format!("is linked to {library}, which not every system has"));
    }
    if facts.soname.as_deref() != soname {
        return Some(format!("has the soname {:?} instead of {soname:?}", facts.soname));
    }
    (facts.has_symbols && !draft).then(|| "is not stripped: build with the profile `dist`".to_owned())
}

/// Fails for a binary that may not leave.
///
/// # Errors
/// [`Error::Unfit`] with the reason, and what reading it brings.
pub fn check(path: &Path, soname: Option<&str>, draft: bool) -> Result<()> {
    let Some(facts) = facts(path)? else { return Ok(()) };
    match fault(&facts, soname, draft) {
        Some(problem) => Err(Error::Unfit { path: path.to_owned(), problem }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn good() -> Facts {
        Facts {
            needed: vec!["libc.so.6".into(), "ld-linux-x86-64.so.2".into()],
            glibc: vec![[2, 2, 5], [2, 34, 0]],
            soname: Some("libx.so.1".into()),
            ..Facts::default()
        }
    }

    #[test]
    fn each_fault_is_named() {
        let soname = Some("libx.so.1");
        assert_eq!(fault(&good(), soname, false), None);
        assert!(fault(&good(), None, false).unwrap().contains("libx.so.1"));
        let newer = Facts { glibc: vec![[2, 2, 5], [2, 38, 0]], ..good() };
        assert!(fault(&newer, soname, false).unwrap().contains("2.38, newer than 2.34"));
        let search = Facts { search: vec!["/home/me".into()], ..good() };
        assert!(fault(&search, soname, true).unwrap().contains("/home/me"));
        let needy = Facts { needed: vec!["libfoo.so.3".into()], ..good() };
        assert!(fault(&needy, soname, true).unwrap().contains("libfoo.so.3"));
        let symbols = Facts { has_symbols: true, ..good() };
        assert!(fault(&symbols, soname, false).unwrap().contains("stripped"));
        assert_eq!(fault(&symbols, soname, true), None);
    }

    #[test]
    fn versions_are_compared_as_numbers() {
        assert_eq!(version("2.2.5"), Some([2, 2, 5]));
        assert!(version("2.4") < version("2.34"));
        assert_eq!(version("PRIVATE"), None);
    }

    #[test]
    fn this_test_is_a_binary_with_facts() {
        if !cfg!(target_os = "linux") {
            return;
        }
        let own = std::env::current_exe().unwrap();
        let facts = facts(&own).unwrap().expect("an ELF file");
        assert!(facts.needed.iter().any(|name| name == "libc.so.6"), "{facts:?}");
        assert!(!facts.glibc.is_empty() && facts.soname.is_none() && facts.has_symbols, "{facts:?}");
    }
}
