//! What a machine is good for, in one sentence.

use super::Row;

/// The live table takes 5 to 20 erosion steps a second; a step may fill half of the time between two.
const LIVE_STEP_MS: f64 = 50.0;
/// An answer that follows a finger, ms.
const ANSWER_MS: f64 = 33.0;
/// Sizes of lands that are measured, largest first.
const LANDS: [usize; 3] = [100_000, 60_000, 10_000];

/// A final terrain: its nodes, its steps, and how long somebody waits for it, s.
const FINAL_NODES: usize = 1_000_000;
const FINAL_STEPS: f64 = 100.0;
const FINAL_WAIT_S: f64 = 120.0;

/// What this machine is good for, in one sentence.
pub(super) fn verdict(rows: &[Row]) -> String {
    let wall = |stage: &str, size: usize, state: &str| {
        let mut found = rows.iter().filter(|row| row.stage == stage && row.size == size);
        found.find(|row| row.state == state).map(|row| row.wall_ms)
    };
    // What the live table does: rivers that lay down what they carry.
    let smooth =
        |nodes: &usize| wall("erosion_step", *nodes, "deposition").is_some_and(|ms| ms <= LIVE_STEP_MS);
    let mut answers = rows.iter().filter(|row| row.stage == "gesture_to_uplift");
    let answer_ms = answers
        .find(|row| row.state == "one fold layer")
        .map_or(f64::INFINITY, |row| row.wall_ms);
    let wait_s = wall("tin_build", FINAL_NODES, "–")
        .zip(wall("erosion_step", FINAL_NODES, "deposition"))
        .map(|(build, step)| (build + FINAL_STEPS * step) / 1e3);
    let finals = match wait_s {
        None => ".".to_owned(),
        Some(s) if s <= FINAL_WAIT_S => {
            format!("; final terrains of a million nodes are practical, with {s:.0} s of erosion each.")
        }
        Some(s) => format!("; final terrains of a million nodes are not: each takes {s:.0} s of erosion."),
    };
    match LANDS.into_iter().find(smooth) {
        Some(nodes) if answer_ms <= ANSWER_MS => {
            format!(
                "This machine sculpts {nodes} nodes live, and new uplift follows a finger in {answer_ms:.0} ms{finals}"
            )
        }
        Some(nodes) => format!(
            "This machine erodes {nodes} nodes live, but new uplift takes {answer_ms:.0} ms, more than the \
             {ANSWER_MS:.0} ms of a smooth answer{finals}"
        ),
        None => {
            format!("This machine is too slow for a live table, and can replay gestures to pictures{finals}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(figures: &[(&'static str, usize, &'static str, f64)]) -> Vec<Row> {
        let row = |&(stage, size, state, wall_ms): &_| Row {
            stage,
            size,
            state,
            threads: 2,
            wall_ms,
            cpu_ms: wall_ms,
            peak_mib: None,
            paper_ms: None,
            waited: None,
        };
        figures.iter().map(row).collect()
    }

    #[test]
    fn the_largest_land_that_keeps_pace_is_named() {
        let fast = rows(&[
            ("erosion_step", 60_000, "deposition", 30.0),
            ("erosion_step", 100_000, "deposition", 55.0),
            ("gesture_to_uplift", 1 << 20, "3 plates", 99.0),
            ("gesture_to_uplift", 1 << 20, "one fold layer", 21.4),
        ]);
        assert_eq!(
            verdict(&fast),
            "This machine sculpts 60000 nodes live, and new uplift follows a finger in 21 ms."
        );
    }

    #[test]
    fn slow_answers_and_slow_machines_are_called_so() {
        let steps = ("erosion_step", 10_000, "deposition", 5.0);
        let slow = rows(&[steps, ("gesture_to_uplift", 1 << 20, "one fold layer", 80.0)]);
        assert!(verdict(&slow).contains("but new uplift takes 80 ms"));
        let hopeless = rows(&[("erosion_step", 10_000, "deposition", 90.0)]);
        assert!(verdict(&hopeless).contains("too slow for a live table"));
    }

    #[test]
    fn final_terrains_are_judged_where_they_were_measured() {
        let of = |step_ms: f64| {
            verdict(&rows(&[
                ("tin_build", 1_000_000, "–", 2000.0),
                ("erosion_step", 1_000_000, "deposition", step_ms),
            ]))
        };
        assert!(of(200.0).ends_with("are practical, with 22 s of erosion each."));
        assert!(of(1500.0).ends_with("are not: each takes 152 s of erosion."));
    }
}
