//! Memory of this machine, or the part of it that this process may use.

use std::fs;
use std::path::{Component, Path, PathBuf};

/// Root of the folders where Linux shows what it knows.
const ROOT: &str = "/";

/// Bytes of memory of the machine; where the process is in control groups with limits, as containers are, the least of
/// them. Nothing on systems that do not tell.
pub fn memory() -> Option<u64> {
    memory_of(Path::new(ROOT))
}

fn memory_of(root: &Path) -> Option<u64> {
    let info = fs::read_to_string(root.join("proc/meminfo")).ok()?;
    let line = info.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
    let total = line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024;
    let groups = fs::read_to_string(root.join("proc/self/cgroup")).unwrap_or_default();
    Some(groups.lines().filter_map(|group| limit(root, group)).fold(total, u64::min))
}

/// The least limit of a group and of those that it is in; `line` is `number:controllers:path` (cgroups(7)).
fn limit(root: &Path, line: &str) -> Option<u64> {
    let mut fields = line.splitn(3, ':').skip(1);
    let (controllers, path) = (fields.next()?, fields.next()?);
    let (mount, file) = match controllers {
        "" => ("sys/fs/cgroup", "memory.max"),
        _ if controllers.split(',').any(|c| c == "memory") => {
            ("sys/fs/cgroup/memory", "memory.limit_in_bytes")
        }
        _ => return None,
    };
    let names: PathBuf = Path::new(path).components().filter(|c| matches!(c, Component::Normal(_))).collect();
    // A container may see its own group as the root of all.
    let folders = names.ancestors().map(|group| root.join(mount).join(group));
    folders.filter_map(|folder| fs::read_to_string(folder.join(file)).ok()?.trim().parse().ok()).min()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_limit_counts() {
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
    }
}
