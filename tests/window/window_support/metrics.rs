//! What the program says of itself, second by second.

use std::fs;
use std::path::PathBuf;
use std::thread;
use std::time::{Duration, Instant};

use serde::Deserialize;
use serde_json::Value;

use super::At;

/// Every field of a second.
pub(crate) const WHOLE_SECOND: &str = "t_s phase mode plates plates_led led_deg_per_my frames frame_ms_p50 frame_ms_p99 touch_ms_p50 touch_ms_p95 steps_per_s \
    contacts source devices retracted bridged stuck doubled over_cap withdrawn unheard states_lost packets_refused contacts_total hands pushes taps ghosts_dropped dead_touches control_presses resets panics nodes scale \
    elapsed_yr max_m min_m adapter backend width height";

/// The fields of a second that tests ask for.
#[derive(Clone, Debug, Default, Deserialize)]
pub(crate) struct Second {
    pub(crate) t_s: f64,
    pub(crate) phase: String,
    /// Frames shown in this second.
    pub(crate) frames: u64,
    /// Contacts that are down.
    pub(crate) contacts: u64,
    /// Hands that are down.
    pub(crate) hands: u64,
    /// Contacts that came to the land so far; likewise the counts that follow.
    pub(crate) contacts_total: u64,
    pub(crate) pushes: u64,
    pub(crate) taps: u64,
    pub(crate) dead_touches: u64,
    pub(crate) control_presses: u64,
    pub(crate) resets: u64,
    pub(crate) panics: u64,
    /// Age of the land, years.
    pub(crate) elapsed_yr: f64,
    /// Median time from one frame to the next, ms.
    pub frame_ms_p50: f64,
    /// The source of touches that is heard, and packets of TUIO that were turned away.
    pub(crate) source: String,
    pub(crate) packets_refused: u64,
    /// The world that is shown.
    pub(crate) mode: String,
    /// Plates of the planet, those that hands lead, and how fast the fastest of them turns.
    pub(crate) plates: u64,
    pub(crate) plates_led: u64,
    pub(crate) led_deg_per_my: f64,
    /// Highest point, metres.
    pub(crate) max_m: f64,
    /// Nodes of the land.
    pub(crate) nodes: u64,
    /// The window's inside, pixels.
    pub(crate) width: u32,
    pub(crate) height: u32,
}

/// A key or button.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Place {
    #[serde(default)]
    pub(crate) label: String,
    pub(crate) x_px: f64,
    pub(crate) y_px: f64,
}

impl Place {
    fn at(&self) -> At {
        (self.x_px, self.y_px)
    }
}

/// A control of a side.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Control {
    pub(crate) kind: String,
    pub(crate) x_px: f64,
    pub(crate) y_px: f64,
}

/// Lines that come when something is laid out.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
struct Layout {
    controls: Option<Vec<Control>>,
    staff_corner: Option<Place>,
    keypad: Option<Vec<Place>>,
    menu: Option<Vec<Place>>,
}

/// The metrics file, read as it grows.
pub(crate) struct Metrics {
    file: PathBuf,
    read: usize,
    seconds: Vec<Second>,
    layout: Layout,
    /// When the layout was read last.
    laid_out: Instant,
}

/// Panels find their place within a few frames.
const PANEL_RESTS: Duration = Duration::from_millis(700);

impl Metrics {
    pub(crate) fn new(file: PathBuf) -> Self {
        Self {
            file,
            read: 0,
            seconds: Vec::new(),
            layout: Layout::default(),
            laid_out: Instant::now(),
        }
    }

    /// The newest second.
    pub(crate) fn newest(&mut self) -> Second {
        self.poll();
        self.seconds.last().cloned().unwrap_or_default()
    }

    /// The newest second's line.
    pub(crate) fn last_line(&self) -> String {
        let text = fs::read_to_string(&self.file).unwrap();
        let mut seconds = text
            .lines()
            .filter(|line| line.contains("\"phase\"") && line.ends_with('}'));
        seconds.next_back().unwrap().to_owned()
    }

    /// The first second from now on for which `holds`; fails where `alive` does, or time runs out.
    pub(crate) fn wait(
        &mut self,
        what: &str,
        seconds: f64,
        mut alive: impl FnMut() -> Result<(), String>,
        holds: impl Fn(&Second) -> bool,
    ) -> Second {
        self.poll();
        let mut seen = self.seconds.len();
        let until = Instant::now() + Duration::from_secs_f64(seconds);
        loop {
            if let Some(found) = self.seconds[seen..].iter().find(|second| holds(second)) {
                return found.clone();
            }
            seen = self.seconds.len();
            if let Err(reason) = alive() {
                panic!("waited for {what}: {reason}");
            }
            let newest = self.seconds.last();
            assert!(
                Instant::now() < until,
                "waited {seconds} s for {what}; newest: {newest:?}"
            );
            thread::sleep(Duration::from_millis(50));
            self.poll();
        }
    }

    /// The corner that lets staff in.
    pub(crate) fn staff_corner(&mut self) -> At {
        self.poll();
        let corner = self.layout.staff_corner.as_ref();
        corner.map(Place::at).expect("the staff corner's place")
    }

    /// Whether a keypad has been shown so far.
    pub(crate) fn keypad_shown(&mut self) -> bool {
        self.poll();
        self.layout.keypad.is_some()
    }

    /// A control that does `kind`.
    pub(crate) fn control(&mut self, kind: &str) -> Control {
        self.poll();
        let controls = self.layout.controls.iter().flatten();
        let found = controls.clone().find(|control| control.kind == kind);
        found
            .cloned()
            .unwrap_or_else(|| panic!("no {kind} among {:?}", controls.collect::<Vec<_>>()))
    }

    /// A key of the keypad, or a button of the staff menu, as soon as it stands still.
    pub(crate) fn place(&mut self, label: &str, seconds: f64) -> At {
        let until = Instant::now() + Duration::from_secs_f64(seconds);
        loop {
            self.poll();
            let places = self.layout.menu.iter().chain(&self.layout.keypad).flatten();
            let found = places.clone().find(|place| place.label == label);
            if let Some(found) = found
                && self.laid_out.elapsed() >= PANEL_RESTS
            {
                return found.at();
            }
            let labels: Vec<_> = places.map(|place| &place.label).collect();
            assert!(
                Instant::now() < until,
                "no `{label}` after {seconds} s; there are {labels:?}"
            );
            thread::sleep(Duration::from_millis(50));
        }
    }

    /// Reads the lines that were completed since the last time.
    fn poll(&mut self) {
        let text = fs::read_to_string(&self.file).unwrap_or_default();
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        for line in text.get(self.read..whole).unwrap_or_default().lines() {
            let value: Value = serde_json::from_str(line).unwrap_or_else(|e| panic!("{e} in: {line}"));
            if value.get("phase").is_some() {
                let second = serde_json::from_value(value).unwrap_or_else(|e| panic!("{e} in: {line}"));
                self.seconds.push(second);
            } else {
                let new: Layout = serde_json::from_value(value).unwrap_or_else(|e| panic!("{e} in: {line}"));
                self.laid_out = Instant::now();
                self.layout = Layout {
                    controls: new.controls.or(self.layout.controls.take()),
                    staff_corner: new.staff_corner.or(self.layout.staff_corner.take()),
                    keypad: new.keypad.or(self.layout.keypad.take()),
                    menu: new.menu.or(self.layout.menu.take()),
                };
            }
        }
        self.read = self.read.max(whole);
    }
}
