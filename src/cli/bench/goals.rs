//! The table of goals: what is done, what the literature needs for it, what it may take, and which row tells.

/// One goal.
pub(super) struct Goal {
    /// What is done.
    pub(super) work: &'static str,
    /// What the literature and the best peers need for it.
    pub(super) published: &'static str,
    /// What it may take; `None` where the figure is only told apart.
    pub(super) bound: Option<Bound>,
    pub(super) unit: &'static str,
    pub(super) figure: Figure,
    /// Why it is missed, where that is known.
    pub(super) why: &'static str,
    /// What a run lacks that does not have the figure.
    pub(super) absent: &'static str,
}

/// What a figure may be.
#[derive(Clone, Copy)]
pub(super) enum Bound {
    Most(f64),
    Least(f64),
}

/// How a figure comes from the rows of a run.
pub(super) enum Figure {
    /// CPU time, ms.
    Cpu(Of),
    /// Time on the wall, ms.
    Wall(Of),
    /// The same on a graphics card; a software adapter's is told and not judged.
    Card(Of),
    /// CPU time of the first less that of the second, ms.
    Apart(Of, Of),
    /// Highest memory use of all rows of this size, MiB.
    Peak(usize),
    /// What doubling the nodes multiplies the CPU time by, from one size to another.
    Doubling([usize; 2]),
    /// How many times faster two threads are than one, on the wall.
    Gain(usize),
    /// Nothing in a run tells it.
    Elsewhere,
}

/// A row of a run: stage, size (0: any), state.
#[derive(Clone, Copy)]
pub(super) struct Of(pub(super) &'static str, pub(super) usize, pub(super) &'static str);

pub(super) const GRID: usize = 1024 * 1024;
pub(super) const FRAME: usize = 1920 * 1080;
const MILLION: &str = "needs --million";
pub(super) const NO_CARD: &str = "no graphics card here";

const fn goal(
    work: &'static str,
    published: &'static str,
    bound: Bound,
    unit: &'static str,
    figure: Figure,
) -> Goal {
    Goal {
        work,
        published,
        bound: Some(bound),
        unit,
        figure,
        why: "",
        absent: "",
    }
}

impl Goal {
    const fn why(self, why: &'static str) -> Self {
        Self { why, ..self }
    }

    const fn absent(self, absent: &'static str) -> Self {
        Self { absent, ..self }
    }

    /// A figure that is told apart and not judged.
    const fn told(self) -> Self {
        Self { bound: None, ..self }
    }
}

use Bound::{Least, Most};
use Figure::{Apart, Card, Cpu, Doubling, Elsewhere, Gain, Peak, Wall};

const fn step(nodes: usize) -> Figure {
    Cpu(Of("erosion_step", nodes, "developed"))
}

const fn cold(nodes: usize) -> Figure {
    Cpu(Of("erosion_step", nodes, "cold"))
}

const fn build(nodes: usize) -> Figure {
    Cpu(Of("tin_build", nodes, "–"))
}

/// What landslides take of a step that includes them.
const fn landslides(work: &'static str, nodes: usize) -> Goal {
    let bare = Of("erosion_no_landslides", nodes, "developed");
    let figure = Apart(Of("erosion_step", nodes, "developed"), bare);
    goal(work, "–", Most(0.0), "CPU-ms", figure).told()
}

/// The goals. Times are on two ordinary cores.
pub(super) const GOALS: &[Goal] = &[
    goal(
        "transport, 1024² cells, 3 plates",
        "10 ms, GPU",
        Most(10.0),
        "ms",
        Wall(Of("transport", GRID, "3 plates")),
    ),
    goal(
        "the same on a graphics card",
        "10 ms",
        Most(1.0),
        "ms",
        Card(Of("transport_gpu", GRID, "3 plates")),
    )
    .absent(NO_CARD),
    goal(
        "fold skeletons, 32k lines",
        "53 ms (37k)",
        Most(10.0),
        "ms",
        Wall(Of("fold_skeletons", 0, "1 km")),
    ),
    goal(
        "fold heights, 1024² cells",
        "2.8 ms, GPU",
        Most(12.0),
        "ms",
        Wall(Of("fold_heights", GRID, "1 km")),
    ),
    goal(
        "the same on a graphics card",
        "2.8 ms",
        Most(1.0),
        "ms",
        Card(Of("fold_heights_gpu", GRID, "1 km")),
    )
    .absent(NO_CARD),
    goal(
        "finger moved → uplift with folds",
        "–",
        Most(33.0),
        "ms",
        Wall(Of("gesture_to_uplift", GRID, "one fold layer")),
    ),
    goal(
        "erosion step, 10k nodes",
        "10 ms; peers 1.45",
        Most(0.8),
        "CPU-ms",
        step(10_000),
    ),
    goal(
        "erosion step, 100k nodes",
        "peers 46",
        Most(20.0),
        "CPU-ms",
        step(100_000),
    ),
    goal(
        "erosion step, 1M nodes",
        "4 s; peers 1164",
        Most(350.0),
        "CPU-ms",
        step(1_000_000),
    )
    .absent(MILLION),
    landslides("landslides' part of it, 10k", 10_000),
    landslides("landslides' part of it, 100k", 100_000),
    landslides("landslides' part of it, 1M", 1_000_000).absent(MILLION),
    goal(
        "first step from noise, 10k nodes",
        "peers 3.2",
        Most(2.0),
        "CPU-ms",
        cold(10_000),
    ),
    goal(
        "first step from noise, 100k nodes",
        "peers 69",
        Most(40.0),
        "CPU-ms",
        cold(100_000),
    ),
    goal(
        "first step from noise, 1M nodes",
        "peers 1164",
        Most(700.0),
        "CPU-ms",
        cold(1_000_000),
    )
    .absent(MILLION),
    goal(
        "triangulation, 10k nodes",
        "peers 9.6",
        Most(10.0),
        "CPU-ms",
        build(10_000),
    ),
    goal(
        "triangulation, 100k nodes",
        "peers 121",
        Most(120.0),
        "CPU-ms",
        build(100_000),
    ),
    goal(
        "triangulation, 1M nodes",
        "peers 2279",
        Most(1500.0),
        "CPU-ms",
        build(1_000_000),
    )
    .absent(MILLION),
    goal(
        "memory at its peak, 1M nodes",
        "–",
        Most(1024.0),
        "MiB",
        Peak(1_000_000),
    )
    .absent(MILLION),
    goal(
        "two threads over one, 1M nodes",
        "–",
        Least(1.6),
        "×",
        Gain(1_000_000),
    )
    .absent(MILLION),
    goal(
        "cost of doubling, 10k → 100k",
        "–",
        Most(2.2),
        "×",
        Doubling([10_000, 100_000]),
    ),
    goal(
        "cost of doubling, 100k → 1M",
        "–",
        Most(2.2),
        "×",
        Doubling([100_000, 1_000_000]),
    )
    .absent(MILLION),
    goal(
        "globe step, 500k samples",
        "1.90 s",
        Most(120.0),
        "ms",
        Wall(Of("globe_step", 500_000, "developed")),
    )
    .why("many passes; finding nearest samples is the largest"),
    goal(
        "new sea floor, 500k samples",
        "13.1 s",
        Most(500.0),
        "ms",
        Wall(Of("globe_sea_floor", 500_000, "20 My")),
    ),
    goal(
        "rift, 500k samples",
        "7.7 s",
        Most(50.0),
        "ms",
        Wall(Of("globe_rift", 500_000, "3 parts")),
    ),
    goal(
        "frame in plan, p99, 1920 × 1080",
        "33 ms",
        Most(16.7),
        "ms",
        Card(Of("frame_plan", FRAME, "p99")),
    )
    .absent(NO_CARD),
    goal(
        "frame in flight, p99, 1920 × 1080",
        "33 ms",
        Most(16.7),
        "ms",
        Card(Of("frame_oblique", FRAME, "p99")),
    )
    .absent(NO_CARD),
    goal("touch to present, p95", "–", Most(20.0), "ms", Elsewhere)
        .absent("only the table can tell: touch_ms_p95 of its --metrics"),
];
