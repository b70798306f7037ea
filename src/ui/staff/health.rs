//! How the table is: figures for whoever looks after it.

use egui::{Grid, RichText, Ui};
use glam::DVec2;

use super::style;
use crate::gesture::hand::ContactStats;
use crate::ui::palette::{AMBER, LAMP};

/// Most contacts that are listed.
const LISTED: usize = 8;

/// A contact that is down for so long is pointed out, seconds.
const LONG: f64 = 60.0;

/// A contact that is down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactHealth {
    /// Where, table mm.
    pub at_mm: DVec2,
    /// For how long, seconds.
    pub age_s: f64,
}

/// Figures of the running table.
#[derive(Clone, Copy, Debug, Default)]
pub struct Health<'a> {
    /// Version of the program.
    pub version: &'a str,
    /// The graphics card, and how it is spoken to.
    pub adapter: &'a str,
    /// Since the program began, seconds.
    pub uptime_s: f64,
    /// Time of a frame, median and 99th percentile, ms.
    pub frame_ms: (f64, f64),
    /// From a touch to the picture that answers, median and 95th percentile, ms.
    pub touch_ms: (f64, f64),
    /// Erosion steps per second.
    pub steps_per_s: f64,
    /// Nodes of the terrain.
    pub nodes: usize,
    /// Who computes transport and heights of folds.
    pub stages: (&'a str, &'a str),
    /// Which source of touches is heard.
    pub source: &'a str,
    /// Touch devices beside the window, and what is wrong with them, a line each.
    pub devices: &'a [&'a str],
    /// Contacts that are down.
    pub contacts: &'a [ContactHealth],
    /// What became of contacts so far.
    pub stats: ContactStats,
    /// Touches that changed nothing.
    pub dead_touches: u64,
    /// Times that the session went on from its last good world.
    pub panics: u64,
    /// Numbers that were none and were thrown away.
    pub quarantined: u64,
}

/// Frames per second for a time of a frame in ms; a dash where there is none.
fn rate(frame_ms: f64) -> String {
    if frame_ms > 0.0 {
        format!("{:.0}", 1000.0 / frame_ms)
    } else {
        "–".to_owned()
    }
}

fn ms(value: f64) -> String {
    if value.is_finite() {
        format!("{value:.1}")
    } else {
        "–".to_owned()
    }
}

fn span(seconds: f64) -> String {
    // What is no number, or negative, becomes 0.
    let seconds = seconds as u64;
    let (days, hours, minutes) = (seconds / 86_400, seconds / 3600 % 24, seconds / 60 % 60);
    if days > 0 {
        format!("{days} d {hours} h")
    } else if hours > 0 {
        format!("{hours} h {minutes} min")
    } else {
        format!("{minutes} min {} s", seconds % 60)
    }
}

pub(super) fn show(ui: &mut Ui, health: &Health<'_>) {
    let stats = &health.stats;
    let rows: [(&str, String, bool); 14] = [
        (
            "Version",
            format!("{}, running for {}", health.version, span(health.uptime_s)),
            false,
        ),
        ("Graphics", health.adapter.to_owned(), false),
        (
            "Frames per second",
            format!(
                "{} (1 % of frames: {})",
                rate(health.frame_ms.0),
                rate(health.frame_ms.1)
            ),
            health.frame_ms.1 > 50.0,
        ),
        (
            "Touch to picture",
            format!("{} ms (5 %: {} ms)", ms(health.touch_ms.0), ms(health.touch_ms.1)),
            health.touch_ms.1 > 50.0,
        ),
        (
            "Erosion",
            format!("{:.1} steps/s on {} nodes", health.steps_per_s, health.nodes),
            false,
        ),
        (
            "Transport, folds",
            format!("{}, {}", health.stages.0, health.stages.1),
            false,
        ),
        ("Touch from", touch_from(health), false),
        (
            "Touches",
            format!(
                "{} in {} hands, {} pushes",
                stats.total, stats.hands, stats.pushes
            ),
            false,
        ),
        ("Ghosts dropped", stats.dropped_ghosts.to_string(), false),
        ("Stuck contacts", stats.stuck.to_string(), stats.stuck > 0),
        ("Dead touches", health.dead_touches.to_string(), false),
        ("Panics survived", health.panics.to_string(), health.panics > 0),
        (
            "Bad numbers dropped",
            health.quarantined.to_string(),
            health.quarantined > 0,
        ),
        (
            "Contacts now",
            contacts(health.contacts),
            health.contacts.iter().any(|c| c.age_s > LONG),
        ),
    ];
    Grid::new("health")
        .num_columns(2)
        .min_row_height(1.0)
        .show(ui, |ui| {
            for (name, value, striking) in rows {
                ui.label(RichText::new(name).color(style::quiet()));
                ui.label(RichText::new(value).color(if striking { AMBER } else { LAMP }));
                ui.end_row();
            }
        });
}

/// The source that is heard, and the devices there are.
fn touch_from(health: &Health<'_>) -> String {
    let mut lines = vec![health.source];
    lines.extend(health.devices);
    lines.join("\n")
}

/// The oldest contacts, with place and age.
fn contacts(contacts: &[ContactHealth]) -> String {
    let mut oldest: Vec<&ContactHealth> = contacts.iter().collect();
    oldest.sort_by(|a, b| b.age_s.total_cmp(&a.age_s));
    let listed: Vec<String> = oldest
        .iter()
        .take(LISTED)
        .map(|c| format!("{:.0} s at {:.0}, {:.0}", c.age_s, c.at_mm.x, c.at_mm.y))
        .collect();
    let more = oldest.len().saturating_sub(LISTED);
    match (listed.is_empty(), more) {
        (true, _) => "none".to_owned(),
        (false, 0) => listed.join("\n"),
        (false, more) => format!("{}\nand {more} more", listed.join("\n")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_and_rates_are_for_people() {
        assert_eq!(span(42.9), "0 min 42 s");
        assert_eq!(span(3.0 * 3600.0 + 61.0), "3 h 1 min");
        assert_eq!(span(200_000.0), "2 d 7 h");
        assert_eq!(span(f64::NAN), "0 min 0 s");
        assert_eq!(rate(16.7), "60");
        assert_eq!(rate(0.0), "–");
        assert_eq!(ms(f64::INFINITY), "–");
    }

    #[test]
    fn the_oldest_contacts_are_listed_first_and_not_too_many() {
        let many: Vec<ContactHealth> = (0..20)
            .map(|i| ContactHealth {
                at_mm: DVec2::new(f64::from(i), 2.0),
                age_s: f64::from(i),
            })
            .collect();
        let listed = contacts(&many);
        assert!(listed.starts_with("19 s at 19, 2\n"), "{listed}");
        assert!(listed.ends_with("and 12 more"), "{listed}");
        assert_eq!(contacts(&[]), "none");
    }
}
