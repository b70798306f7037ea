//! The goals, judged by the rows of a run: met, or how far off and why.

use serde::Serialize;

use super::Row;
use super::goals::Bound::{Least, Most};
use super::goals::Figure::{self, Apart, Card, Cpu, Doubling, Elsewhere, Gain, Peak, Wall};
use super::goals::{GOALS, Goal, Of};
use crate::cli::console::Console;

/// Threads that wait for this part of their time tell of a machine that others use.
const BUSY: f64 = 0.1;

/// What a run was made with, as far as judgements depend on it.
#[derive(Clone, Debug, Default)]
pub(super) struct Circumstances {
    /// Name of the adapter where processor cores do what a graphics card should.
    pub(super) software: Option<String>,
}

/// A goal, judged.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Judged {
    goal: &'static str,
    published: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    at_most: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    at_least: Option<f64>,
    unit: &'static str,
    measured: Option<f64>,
    /// `None` where it was not measured, or on what the goal is not about.
    met: Option<bool>,
    /// How many times over (or under) the bound the figure is.
    #[serde(skip_serializing_if = "Option::is_none")]
    distance: Option<f64>,
    #[serde(skip_serializing_if = "str::is_empty")]
    reason: String,
}

/// Judges all goals by the rows of a run.
fn judge(rows: &[Row], circumstances: &Circumstances) -> Vec<Judged> {
    GOALS.iter().map(|goal| goal.judge(rows, circumstances)).collect()
}

impl Goal {
    fn judge(&self, rows: &[Row], circumstances: &Circumstances) -> Judged {
        let measured = self.figure.of(rows);
        let software = match self.figure {
            Card(_) => circumstances.software.as_deref(),
            _ => None,
        };
        let distance = measured.zip(self.bound).map(|(measured, bound)| match bound {
            Most(most) => measured / most,
            Least(least) => least / measured,
        });
        let distance = distance.filter(|_| software.is_none());
        let met = distance.map(|distance| distance <= 1.0);
        let reason = match (measured, met, software) {
            (_, _, Some(name)) => format!("{name} computes on processor cores"),
            (None, ..) => self.absent.to_owned(),
            (_, Some(false), _) => self.reasons(rows),
            _ => String::new(),
        };
        Judged {
            goal: self.work,
            published: self.published,
            at_most: self.bound.and_then(|bound| match bound {
                Most(most) => Some(most),
                Least(_) => None,
            }),
            at_least: self.bound.and_then(|bound| match bound {
                Least(least) => Some(least),
                Most(_) => None,
            }),
            unit: self.unit,
            measured,
            met,
            distance,
            reason,
        }
    }
}

impl Goal {
    /// Why it is missed, as far as that is known.
    fn reasons(&self, rows: &[Row]) -> String {
        let mut reasons = Vec::new();
        if let Some(row) = self.figure.on_the_wall(rows) {
            if row.threads == 1 {
                reasons.push("on one thread".to_owned());
            }
            if let Some(waited) = row.waited.filter(|&waited| waited >= BUSY) {
                let percent = 100.0 * waited;
                reasons.push(format!(
                    "others had the processors for {percent:.0} % of the time"
                ));
            }
        }
        if !self.why.is_empty() {
            reasons.push(self.why.to_owned());
        }
        reasons.join("; ")
    }
}

impl Figure {
    /// The row whose time on the wall is judged.
    fn on_the_wall<'a>(&self, rows: &'a [Row]) -> Option<&'a Row> {
        match self {
            Wall(of) | Card(of) => of.find(rows),
            Gain(size) => Of("erosion_step", *size, "developed").find(rows),
            _ => None,
        }
    }

    /// The figure, where the rows have what it takes.
    fn of(&self, rows: &[Row]) -> Option<f64> {
        let cpu = |of: &Of| Some(of.find(rows)?.cpu_ms);
        match self {
            Cpu(of) => cpu(of),
            Wall(of) | Card(of) => Some(of.find(rows)?.wall_ms),
            Apart(whole, part) => Some((cpu(whole)? - cpu(part)?).max(0.0)),
            &Peak(size) => rows
                .iter()
                .filter(|row| row.size == size)
                .filter_map(|row| row.peak_mib)
                .reduce(f64::max),
            Doubling(sizes) => {
                let [small, large] = sizes.map(|size| cpu(&Of("erosion_step", size, "developed")));
                let doublings = (sizes[1] as f64 / sizes[0] as f64).log2();
                Some((large? / small?).powf(1.0 / doublings))
            }
            &Gain(size) => {
                let wall = |threads: usize| {
                    let step = Of("erosion_step", size, "developed");
                    let mut on = rows.iter().filter(|row| row.threads == threads);
                    Some(on.find(|row| step.names(row))?.wall_ms)
                };
                Some(wall(1)? / wall(2)?)
            }
            Elsewhere => None,
        }
    }
}

impl Of {
    fn names(&self, row: &Row) -> bool {
        let &Self(stage, size, state) = self;
        row.stage == stage && (size == 0 || row.size == size) && row.state == state
    }

    /// The first such row: a stage that is run again on other threads comes after.
    fn find<'a>(&self, rows: &'a [Row]) -> Option<&'a Row> {
        rows.iter().find(|row| self.names(row))
    }
}

impl Judged {
    /// What it comes to, in words.
    fn verdict(&self) -> String {
        let mut words = match (self.met, self.distance) {
            (Some(true), _) => "met".to_owned(),
            (_, Some(distance)) if self.at_least.is_some() => format!("{distance:.2}× short"),
            (_, Some(distance)) => format!("{distance:.2}× over"),
            _ if self.measured.is_none() => "not measured".to_owned(),
            _ if self.at_most.is_some() || self.at_least.is_some() => "not judged".to_owned(),
            _ => "told apart".to_owned(),
        };
        if !self.reason.is_empty() {
            words.push_str(": ");
            words.push_str(&self.reason);
        }
        words
    }

    fn line(&self) -> String {
        let number = |value: f64| {
            let decimals = if value < 10.0 { 2 } else { 0 };
            format!("{value:.decimals$}")
        };
        let bound = match (self.at_most, self.at_least) {
            (Some(most), _) => format!("≤ {most} {}", self.unit),
            (_, Some(least)) => format!("≥ {least} {}", self.unit),
            _ => format!("– {}", self.unit),
        };
        format!(
            "{:<34} {:<18} {:>13} {:>9}  {}",
            self.goal,
            self.published,
            bound,
            self.measured.map_or("–".to_owned(), number),
            self.verdict()
        )
    }
}

/// Prints the table of goals, judged by the rows of a run.
pub(super) fn print(rows: &[Row], circumstances: &Circumstances, json: bool) {
    if !json {
        Console::result(&format!(
            "\n{:<34} {:<18} {:>13} {:>9}",
            "work", "published", "goal", "measured"
        ));
    }
    for judged in judge(rows, circumstances) {
        if !json {
            Console::result(&judged.line());
        } else if let Ok(line) = serde_json::to_string(&judged) {
            Console::result(&line);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::bench::goals::{FRAME, GRID, NO_CARD};

    fn row(stage: &'static str, size: usize, state: &'static str, ms: f64) -> Row {
        Row {
            stage,
            size,
            state,
            threads: 2,
            wall_ms: ms,
            cpu_ms: 1.5 * ms,
            peak_mib: Some(ms),
            paper_ms: None,
            waited: None,
        }
    }

    /// The verdict on the goal whose name begins so.
    fn verdict(rows: &[Row], work: &str) -> String {
        let all = judge(rows, &Circumstances::default());
        let judged = all.iter().find(|judged| judged.goal.starts_with(work));
        judged.expect("a goal").verdict()
    }

    #[test]
    fn a_figure_at_its_bound_is_met_and_beyond_it_has_a_distance() {
        let met = [row("transport", GRID, "3 plates", 10.0)];
        assert_eq!(verdict(&met, "transport"), "met");
        let over = [row("transport", GRID, "3 plates", 11.4)];
        assert_eq!(verdict(&over, "transport"), "1.14× over");
        let other = [row("transport", 4096, "3 plates", 1.0)];
        assert_eq!(verdict(&other, "transport"), "not measured");
    }

    #[test]
    fn erosion_is_judged_by_cpu_time() {
        let rows = [row("erosion_step", 100_000, "developed", 16.0)];
        assert_eq!(verdict(&rows, "erosion step, 100k"), "1.20× over");
    }

    #[test]
    fn landslides_are_told_apart() {
        let rows = [
            row("erosion_step", 10_000, "developed", 4.0),
            row("erosion_no_landslides", 10_000, "developed", 3.0),
        ];
        let all = judge(&rows, &Circumstances::default());
        let judged = all
            .iter()
            .find(|judged| judged.goal.starts_with("landslides"))
            .expect("a goal");
        assert_eq!(
            (judged.measured, judged.met, judged.verdict().as_str()),
            (Some(1.5), None, "told apart")
        );
    }

    #[test]
    fn doubling_is_a_power_of_the_ratio() {
        let steps = |ratio: f64| {
            [
                row("erosion_step", 10_000, "developed", 1.0),
                row("erosion_step", 100_000, "developed", ratio),
            ]
        };
        // Ten times the nodes are 3.32 doublings.
        let figure = Doubling([10_000, 100_000]).of(&steps(10.0)).expect("two sizes");
        assert!((figure - 2.0).abs() < 1e-12, "{figure}");
        assert_eq!(verdict(&steps(13.0), "cost of doubling, 10k"), "met");
        assert_eq!(verdict(&steps(16.0), "cost of doubling, 10k"), "1.05× over");
        assert_eq!(
            verdict(&steps(10.0), "cost of doubling, 100k"),
            "not measured: needs --million"
        );
    }

    #[test]
    fn a_gain_takes_both_numbers_of_threads() {
        let step = row("erosion_step", 1_000_000, "developed", 100.0);
        let alone = |wall_ms: f64| Row {
            threads: 1,
            wall_ms,
            ..step.clone()
        };
        assert_eq!(Gain(1_000_000).of(std::slice::from_ref(&step)), None);
        let two = |wall_ms| [step.clone(), alone(wall_ms)];
        assert_eq!(verdict(&two(170.0), "two threads"), "met");
        assert_eq!(verdict(&two(128.0), "two threads"), "1.25× short");
        // The steps on one thread are not what the step is judged by.
        assert_eq!(verdict(&two(1e6), "erosion step, 1M"), "met");
    }

    #[test]
    fn memory_is_the_highest_of_its_size() {
        let rows = [
            row("tin_build", 1_000_000, "–", 1500.0),
            row("erosion_step", 1_000_000, "developed", 100.0),
            row("relief_map", FRAME, "–", 5000.0),
        ];
        assert_eq!(verdict(&rows, "memory"), "1.46× over");
    }

    #[test]
    fn a_software_adapter_is_no_graphics_card() {
        let rows = [row("frame_plan", FRAME, "p99", 12.0)];
        assert_eq!(verdict(&rows, "frame in plan"), "met");
        let circumstances = Circumstances {
            software: Some("llvmpipe".to_owned()),
        };
        let all = judge(&rows, &circumstances);
        let judged = all
            .iter()
            .find(|judged| judged.goal.starts_with("frame in plan"))
            .expect("a goal");
        assert_eq!((judged.measured, judged.met), (Some(12.0), None));
        assert_eq!(
            judged.verdict(),
            "not judged: llvmpipe computes on processor cores"
        );
    }

    #[test]
    fn a_busy_machine_is_a_reason_and_no_excuse() {
        let busy = |ms| {
            [Row {
                waited: Some(0.4),
                ..row("transport", GRID, "3 plates", ms)
            }]
        };
        assert_eq!(
            verdict(&busy(20.0), "transport"),
            "2.00× over: others had the processors for 40 % of the time"
        );
        assert_eq!(verdict(&busy(9.0), "transport"), "met");
        let alone = [Row {
            threads: 1,
            ..row("transport", GRID, "3 plates", 20.0)
        }];
        assert_eq!(verdict(&alone, "transport"), "2.00× over: on one thread");
        let known = [row("globe_step", 500_000, "developed", 180.0)];
        assert!(verdict(&known, "globe step").starts_with("1.50× over: many passes"));
    }

    #[test]
    fn each_goal_is_a_line_of_json() {
        let all = judge(
            &[row("globe_rift", 500_000, "3 parts", 80.0)],
            &Circumstances::default(),
        );
        assert_eq!(all.len(), GOALS.len());
        let rift = all.iter().find(|judged| judged.goal.starts_with("rift"));
        let line = serde_json::to_value(rift.expect("a goal")).expect("JSON");
        assert_eq!(line["met"], false);
        assert_eq!(line["at_most"], 50.0);
        assert_eq!(line["distance"], 1.6);
        let absent = serde_json::to_value(&all[1]).expect("JSON");
        assert_eq!(absent["measured"], serde_json::Value::Null);
        assert_eq!(absent["reason"], NO_CARD);
    }
}
