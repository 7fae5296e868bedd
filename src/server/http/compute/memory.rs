//! How much memory the process uses and may use.

use std::fs;
use std::path::Path;

/// The share of the memory from which on computations are stopped. The whole process counts. The rest is for
/// what computations take until they notice that they must stop.
const SHARE: f64 = 0.72;

/// Bodies that are decoded may take one part in `DECODING_PARTS` of that share. More would leave little for
/// the computations that run beside them.
const DECODING_PARTS: u64 = 3;

/// The memory that the process may use.
#[derive(Debug, Clone, Copy)]
pub struct Memory {
    /// Bytes above which computations are stopped. `None` where the system does not tell its memory.
    most: Option<u64>,
}

impl Memory {
    /// A limit of `bytes`; without a number, no limit.
    pub fn of(bytes: Option<u64>) -> Self {
        Self { most: bytes.map(|bytes| (bytes as f64 * SHARE) as u64) }
    }

    /// Bytes for all bodies that are decoded at the same time.
    pub fn for_decoding(&self) -> usize {
        self.most.and_then(|most| usize::try_from(most / DECODING_PARTS).ok()).unwrap_or(usize::MAX)
    }

    /// Whether the process fills more than the share. `false` where the system does not tell.
    pub fn is_short(&self) -> bool {
        self.most.is_some_and(|most| used().is_some_and(|used| used > most))
    }
}

/// Bytes of memory that the process uses now.
fn used() -> Option<u64> {
    let text = fs::read_to_string("/proc/self/statm").ok()?;
    let pages: u64 = text.split(' ').nth(1)?.parse().ok()?;
    Some(pages * rustix::param::page_size() as u64)
}

/// Bytes of memory that the system grants to the process: the memory of the machine, or less where a control
/// group has a limit. `None` where the system does not tell.
pub fn granted() -> Option<u64> {
    let machine = fs::read_to_string("/proc/meminfo").ok().and_then(|text| {
        let line = text.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
        Some(line.trim().trim_end_matches(" kB").parse::<u64>().ok()? * 1024)
    });
    let groups = fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let limits = groups.lines().flat_map(group_limits);
    limits.chain(machine).min()
}

/// The memory limits of one control group and of the groups above it. `line` is a line
/// `ID:CONTROLLERS:PATH` of `/proc/self/cgroup`. In a container the system may mount the group itself as the
/// root, so the limit at the root counts too.
fn group_limits(line: &str) -> Vec<u64> {
    let mut fields = line.splitn(3, ':').skip(1);
    let (Some(controllers), Some(path)) = (fields.next(), fields.next()) else { return Vec::new() };
    let (root, file) = match controllers {
        "" => ("/sys/fs/cgroup", "memory.max"),
        names if names.split(',').any(|name| name == "memory") => {
            ("/sys/fs/cgroup/memory", "memory.limit_in_bytes")
        }
        _ => return Vec::new(),
    };
    let group = Path::new(path.trim_start_matches('/'));
    let limit =
        |group: &Path| fs::read_to_string(Path::new(root).join(group).join(file)).ok()?.trim().parse().ok();
    group.ancestors().filter_map(limit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn the_process_uses_less_than_the_system_grants() {
        let (used, granted) = (used().expect("a figure"), granted().expect("a figure"));
        assert!((1 << 20..granted).contains(&used), "{used} of {granted}");
        assert!(!Memory::of(Some(granted)).is_short());
        assert!(Memory::of(Some(1 << 20)).is_short());
        assert!(!Memory::of(None).is_short());
    }

    #[test]
    fn other_controllers_and_broken_lines_have_no_limit() {
        for line in ["", "4:cpu", "4:cpu:/", "0", "12:pids:/a/b"] {
            assert_eq!(group_limits(line), Vec::<u64>::new(), "{line}");
        }
    }
}
