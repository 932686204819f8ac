//! Memory of this machine, or the part of it that this process may use, and what of it is free.

use std::fs;
use std::path::{Component, Path, PathBuf};

/// Root of the folders where Linux shows what it knows.
const ROOT: &str = "/";

/// Bytes of memory of the machine; where the process is in control groups with limits, as containers are, the least of
/// them. Nothing on systems that do not tell.
pub fn memory() -> Option<u64> {
    memory_of(Path::new(ROOT))
}

/// Bytes of memory that nobody uses, or the least that a control group leaves of its limit. Nothing on systems that do not
/// tell.
pub fn free() -> Option<u64> {
    free_of(Path::new(ROOT))
}

fn memory_of(root: &Path) -> Option<u64> {
    let total = bytes_of(root, "MemTotal:")?;
    Some(groups(root).into_iter().map(|group| group.limit).fold(total, u64::min))
}

fn free_of(root: &Path) -> Option<u64> {
    let available = bytes_of(root, "MemAvailable:")?;
    let left = groups(root).into_iter().map(|group| group.limit.saturating_sub(group.used));
    Some(left.fold(available, u64::min))
}

/// A number of `/proc/meminfo`.
fn bytes_of(root: &Path, name: &str) -> Option<u64> {
    let info = fs::read_to_string(root.join("proc/meminfo")).ok()?;
    let line = info.lines().find_map(|line| line.strip_prefix(name))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}

/// A control group with a limit, in bytes.
struct Group {
    limit: u64,
    /// Without files that the system has in memory and may forget.
    used: u64,
}

/// The control groups that this process is in, and those that they are in, as far as they have limits.
fn groups(root: &Path) -> Vec<Group> {
    let lines = fs::read_to_string(root.join("proc/self/cgroup")).unwrap_or_default();
    lines.lines().flat_map(|line| groups_of(root, line).unwrap_or_default()).collect()
}

/// Those of one line, which is `number:controllers:path` (cgroups(7)).
fn groups_of(root: &Path, line: &str) -> Option<Vec<Group>> {
    let mut fields = line.splitn(3, ':').skip(1);
    let (controllers, path) = (fields.next()?, fields.next()?);
    let (mount, limit, used) = match controllers {
        "" => ("sys/fs/cgroup", "memory.max", "memory.current"),
        _ if controllers.split(',').any(|c| c == "memory") => {
            ("sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes")
        }
        _ => return None,
    };
    let names: PathBuf = Path::new(path).components().filter(|c| matches!(c, Component::Normal(_))).collect();
    // A container may see its own group as the root of all.
    let folders = names.ancestors().map(|group| root.join(mount).join(group));
    let number = |file: PathBuf| fs::read_to_string(file).ok()?.trim().parse::<u64>().ok();
    let group = |folder: PathBuf| {
        let used = number(folder.join(used)).unwrap_or(0).saturating_sub(cached(&folder));
        Some(Group { limit: number(folder.join(limit))?, used })
    };
    Some(folders.filter_map(group).collect())
}

/// Bytes of files that a group has in memory and has not used of late.
fn cached(folder: &Path) -> u64 {
    let stat = fs::read_to_string(folder.join("memory.stat")).unwrap_or_default();
    let line = stat.lines().find_map(|line| {
        line.strip_prefix("inactive_file ").or_else(|| line.strip_prefix("total_inactive_file "))
    });
    line.and_then(|number| number.trim().parse().ok()).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_limit_counts_and_what_is_left_of_it() {
        let root = tempfile::tempdir().unwrap();
        let write = |file: &str, text: &str| {
            let path = root.path().join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        let memory = || memory_of(root.path());
        assert_eq!(memory(), None);
        write("proc/meminfo", "MemTotal:       8388608 kB\nMemFree:        1 kB\n");
        assert_eq!(memory(), Some(8 << 30));
        write("proc/self/cgroup", "9:cpu,memory:/farm/job\n0::/user/run\n");
        assert_eq!(memory(), Some(8 << 30));
        write("sys/fs/cgroup/user/run/memory.max", "max\n");
        write("sys/fs/cgroup/user/memory.max", "3221225472\n");
        assert_eq!(memory(), Some(3 << 30));
        // The older kind; without a limit it holds the largest number of pages.
        write("sys/fs/cgroup/memory/farm/job/memory.limit_in_bytes", "9223372036854771712\n");
        assert_eq!(memory(), Some(3 << 30));
        write("sys/fs/cgroup/memory/memory.limit_in_bytes", "1073741824\n");
        assert_eq!(memory(), Some(1 << 30));
        let free = || free_of(root.path());
        assert_eq!(free(), None);
        write("proc/meminfo", "MemTotal:       8388608 kB\nMemAvailable: 7340032 kB\n");
        assert_eq!(free(), Some(1 << 30));
        write("sys/fs/cgroup/memory/memory.usage_in_bytes", "838860800\n");
        assert_eq!(free(), Some(224 << 20));
        write("sys/fs/cgroup/memory/memory.stat", "cache 1\ntotal_inactive_file 104857600\n");
        assert_eq!(free(), Some(324 << 20));
        write("sys/fs/cgroup/user/memory.current", "3221225472\n");
        write("sys/fs/cgroup/user/memory.stat", "anon 1\ninactive_file 1048576\n");
        assert_eq!((memory(), free()), (Some(1 << 30), Some(1 << 20)));
    }
}
