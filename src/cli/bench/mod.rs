//! `orogen bench`: every stage at the sizes of the literature, wall and CPU time, the goals, and one sentence for staff.

#[cfg(feature = "app")]
mod frames;
mod globe;
mod goals;
mod judge;
mod land;
mod picture;
mod plates;
mod touch;
mod tuio;
#[cfg(feature = "app")]
mod twins;
mod verdict;

use std::time::Instant;

use cpu_time::ProcessTime;
use serde::Serialize;

use super::console::Console;
use super::failure::Failure;
use super::{BenchArgs, on_threads};
use crate::units::{Extent, KM};
use judge::Circumstances;

/// The square and the uplift at which the literature's figures were taken: 100 × 100 km, 5e-4 m/yr.
const SQUARE: Extent = Extent {
    width: 100.0 * KM,
    height: 100.0 * KM,
};
const UPLIFT: f64 = 5e-4;
const SEED: u64 = 1;

/// Sizes of lands; the last one on demand.
const LANDS: [usize; 4] = [10_000, 60_000, 100_000, 1_000_000];

/// Other programs only ever add to a time, so a row is the median of its quicker half.
const QUIET: f64 = 0.25;

/// One line of the result.
#[derive(Clone, Debug, Serialize)]
struct Row {
    stage: &'static str,
    size: usize,
    state: &'static str,
    threads: usize,
    wall_ms: f64,
    cpu_ms: f64,
    /// Highest memory use of the process while the stage ran, where the system tells.
    peak_mib: Option<f64>,
    /// What the stage's source reports for this size, ms.
    paper_ms: Option<f64>,
    /// Part of their time that the threads waited for a processor that others had, where the system tells.
    #[serde(skip)]
    waited: Option<f64>,
}

/// Stage, size and state: what a row is known by.
type Key = (&'static str, usize, &'static str);

/// Runs all stages.
pub(super) fn run(args: &BenchArgs) -> Result<(), Failure> {
    let bench = on_threads(args.threads, || {
        let mut bench = Bench {
            rows: Vec::new(),
            circumstances: Circumstances::default(),
            json: args.json,
        };
        bench.note(
            "stage                       size  state       threads   wall ms    cpu ms  peak MiB  paper ms",
        );
        let sizes = LANDS.len() - usize::from(!args.million);
        for nodes in &LANDS[..sizes] {
            bench.terrain(*nodes)?;
        }
        bench.mountain();
        bench.gesture()?;
        bench.folds()?;
        bench.picture()?;
        bench.globe()?;
        bench.touch()?;
        bench.tuio();
        #[cfg(feature = "app")]
        bench.twins()?;
        #[cfg(feature = "app")]
        bench.frames();
        Ok(bench)
    })?;
    judge::print(&bench.rows, &bench.circumstances, args.json);
    bench.note(&format!("\n{}", verdict::verdict(&bench.rows)));
    Ok(())
}

struct Bench {
    rows: Vec<Row>,
    circumstances: Circumstances,
    json: bool,
}

impl Bench {
    /// Runs `work` `runs` times and records a row.
    fn time<T>(&mut self, key: Key, paper_ms: Option<f64>, runs: usize, mut work: impl FnMut() -> T) -> T {
        let ((), result) = self.time_part(key, paper_ms, (runs, QUIET), || (), |()| work());
        result
    }

    /// The same where each run needs something of its own, which is made outside its time. Returns the last of them.
    fn time_each<S>(
        &mut self,
        key: Key,
        paper_ms: Option<f64>,
        runs: usize,
        fresh: impl FnMut() -> S,
        work: impl FnMut(&mut S),
    ) -> S {
        self.time_part(key, paper_ms, (runs, QUIET), fresh, work).0
    }

    /// Records the time that `part` of the runs do not exceed.
    fn time_part<S, T>(
        &mut self,
        (stage, size, state): Key,
        paper_ms: Option<f64>,
        (runs, part): (usize, f64),
        mut fresh: impl FnMut() -> S,
        mut work: impl FnMut(&mut S) -> T,
    ) -> (S, T) {
        reset_peak();
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let before = Processors::now();
        let mut times = Vec::with_capacity(runs);
        let (last, result) = loop {
            let mut own = fresh();
            let (wall, cpu) = (Instant::now(), ProcessTime::now());
            let result = std::hint::black_box(work(&mut own));
            let ms = [wall.elapsed(), cpu.elapsed()].map(|time| time.as_secs_f64() * 1e3);
            times.push(ms);
            if times.len() >= runs {
                break (own, result);
            }
        };
        let [wall_ms, cpu_ms] = [0, 1].map(|clock| {
            let mut ms: Vec<f64> = times.iter().map(|both| both[clock]).collect();
            quantile(&mut ms, part)
        });
        let row = Row {
            stage,
            size,
            state,
            threads: rayon::current_num_threads(),
            wall_ms,
            cpu_ms,
            peak_mib: peak_mib(),
            paper_ms,
            // More threads than processors wait for each other.
            waited: before
                .zip(Processors::now())
                .filter(|_| rayon::current_num_threads() <= cores)
                .map(|(then, now)| now.waited_since(then)),
        };
        self.print(&row);
        self.rows.push(row);
        (last, result)
    }

    fn print(&self, row: &Row) {
        if self.json {
            if let Ok(line) = serde_json::to_string(row) {
                Console::result(&line);
            }
            return;
        }
        let optional = |value: Option<f64>| value.map_or("–".to_owned(), |v| format!("{v:.1}"));
        Console::result(&format!(
            "{:<22} {:>9}  {:<14} {:>4} {:>9.2} {:>9.2} {:>9} {:>9}",
            row.stage,
            row.size,
            row.state,
            row.threads,
            row.wall_ms,
            row.cpu_ms,
            optional(row.peak_mib),
            optional(row.paper_ms)
        ));
    }

    /// A line that is no row.
    fn note(&self, text: &str) {
        if !self.json {
            Console::result(text);
        }
    }
}

/// The value that `part` of the samples do not exceed.
fn quantile(samples: &mut [f64], part: f64) -> f64 {
    samples.sort_by(f64::total_cmp);
    let last = samples.len().saturating_sub(1);
    samples
        .get((last as f64 * part).round() as usize)
        .copied()
        .unwrap_or(0.0)
}

/// What the threads of this process have had of the processors so far, ns.
#[derive(Clone, Copy, Debug)]
struct Processors {
    ran: u64,
    waited: u64,
}

impl Processors {
    /// Only Linux tells.
    fn now() -> Option<Self> {
        let mut all = Self { ran: 0, waited: 0 };
        for task in std::fs::read_dir("/proc/self/task").ok()? {
            let times = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
            let mut times = times.split_whitespace().map(str::parse::<u64>);
            all.ran += times.next()?.ok()?;
            all.waited += times.next()?.ok()?;
        }
        Some(all)
    }

    /// Part of the time since `then` that threads waited, 0–1.
    fn waited_since(self, then: Self) -> f64 {
        let ran = self.ran.saturating_sub(then.ran) as f64;
        let waited = self.waited.saturating_sub(then.waited) as f64;
        waited / (ran + waited).max(1.0)
    }
}

/// Starts a new measurement of the highest memory use. Only Linux tells, and only there it can be reset.
fn reset_peak() {
    // Refused in some containers; then the figure is that of the whole run so far.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// Highest memory use since [`reset_peak`], MiB.
fn peak_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kib: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib / 1024.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_the_median_of_its_quicker_half() {
        let mut ms = [9.0, 1.0, 100.0, 2.0, 3.0, 4.0, 50.0, 8.0, 7.0];
        assert_eq!(quantile(&mut ms, QUIET), 3.0);
        assert_eq!(quantile(&mut ms, 0.99), 100.0);
        assert_eq!(quantile(&mut [5.0], QUIET), 5.0);
        // Of two it is the quicker.
        assert_eq!(quantile(&mut [5.0, 4.0], QUIET), 4.0);
    }

    #[test]
    fn waiting_is_a_part_of_the_time() {
        let then = Processors { ran: 100, waited: 50 };
        let now = Processors {
            ran: 400,
            waited: 150,
        };
        assert_eq!(now.waited_since(then), 0.25);
        assert_eq!(then.waited_since(then), 0.0);
    }

    #[test]
    fn what_a_run_needs_of_its_own_is_made_for_each() {
        let mut bench = Bench {
            rows: Vec::new(),
            circumstances: Circumstances::default(),
            json: true,
        };
        let (mut made, mut done) = (0, 0);
        let fresh = || {
            made += 1;
            made
        };
        let last = bench.time_each(("stage", 1, "state"), None, 3, fresh, |own| {
            done += 1;
            assert_eq!(*own, done);
        });
        assert_eq!((last, done, bench.rows.len()), (3, 3, 1));
    }
}
