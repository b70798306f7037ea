//! Sizes that this machine has no memory for are refused before any work.

use super::failure::Failure;

/// Highest memory use of a run, bytes for each node: nodes and links, layers, the solver's scratch, and the files that are
/// made of them. Measured at a million nodes with the default pile, and rounded up.
const BYTES_PER_NODE: u64 = 1700;

const GIB: f64 = (1_u64 << 30) as f64;

/// Refuses `nodes` where they would not fit into the memory that is free.
pub(super) fn check(nodes: usize) -> Result<(), Failure> {
    fits(nodes, free())
}

fn fits(nodes: usize, free: Option<u64>) -> Result<(), Failure> {
    let needed = nodes as u64 * BYTES_PER_NODE;
    let Some(free) = free.filter(|&free| free < needed) else {
        return Ok(());
    };
    let most = free / BYTES_PER_NODE / 10_000 * 10_000;
    Err(Failure::input(format!(
        "{nodes} nodes need about {:.1} GiB of memory, and {:.1} GiB are free: expected at most {most} nodes",
        needed as f64 / GIB,
        free as f64 / GIB,
    )))
}

/// Memory that is free for use, bytes, where the system tells.
fn free() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib << 10)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_refused_with_what_would() {
        assert!(fits(1_000_000, Some(4 << 30)).is_ok());
        assert!(
            fits(4_000_000, None).is_ok(),
            "where nothing is known nothing is refused"
        );
        let refused = fits(4_000_000, Some(1 << 30)).unwrap_err().to_string();
        assert!(
            refused.contains("1.0 GiB are free: expected at most 630000 nodes"),
            "{refused}"
        );
        assert!(free().is_none_or(|free| free > 1 << 20));
    }
}
