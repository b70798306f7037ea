//! The real program in a real window under real touch: what the tests of `window.rs` and `window_kiosk.rs` stand on.
//!
//! Each test has an X server of its own (`touch-x/`), a window manager, the program on software Vulkan, and fingers
//! that come in as device events. Tests run one at a time, because each wants the whole machine. What a test saw
//! lies in `target/window-failures/<test>/` while it runs, and stays there if it fails.
#![allow(clippy::unwrap_used, reason = "the equipment fails tests by panicking")]

mod display;
pub(crate) mod fingers;
mod land;
pub(crate) mod metrics;
pub(crate) mod picture;

use std::env;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, ExitStatus, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use display::Display;
use fingers::{Fingers, Script};
use land::Land;
use metrics::{Metrics, Second};
use picture::Picture;

/// Pixels, from the window's top-left corner.
pub(crate) type At = (f64, f64);

/// How long the program may take to show its window and write its first line.
const START_S: f64 = 30.0;

/// How long anything else may take that is done within a second on a machine with nothing else to do.
pub(crate) const SLOW_S: f64 = 60.0;

/// No hill of fresh land is as high, metres.
const FRESH_M: f64 = 200.0;

/// X keycodes (evdev + 8) of a US keyboard.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Key {
    Escape = 9,
    R = 27,
    S = 39,
    M = 58,
    Alt = 64,
    F4 = 70,
    F11 = 95,
}

/// How the program is started.
pub(crate) struct Setup<'a> {
    /// Size of the screen.
    pub(crate) screen: (u32, u32),
    /// Arguments before `--metrics FILE`.
    pub(crate) arguments: &'a [&'a str],
    /// The settings file's text.
    pub(crate) settings: &'a str,
}

impl Default for Setup<'_> {
    /// A full-screen table of 1209.6 × 680.4 mm at 1280 × 720 that stays in plan view while nobody touches it.
    fn default() -> Self {
        Self {
            screen: (1280, 720),
            arguments: &[],
            settings: "[table]\nwidth_mm = 1209.6\n[kiosk]\nidle_s = 600\nflight_after_s = 600\n",
        }
    }
}

/// A table with the program on it.
pub(crate) struct Table {
    pub(crate) metrics: Metrics,
    /// Where the window's inside begins on the screen.
    origin: At,
    program: Child,
    fingers: Fingers,
    display: Display,
    folder: PathBuf,
    saves: usize,
    // Held to the end: the next test starts when everything above is gone.
    _alone: MutexGuard<'static, ()>,
}

impl Table {
    /// Starts server, window manager and program, and waits for the program's first line. Nothing where this machine
    /// lacks the equipment, unless it is required to have it.
    #[allow(clippy::print_stdout, reason = "a skipped test says why")]
    pub(crate) fn start(test: &str, setup: &Setup<'_>) -> Option<Self> {
        let missing = display::missing();
        if missing.is_empty() {
            return Some(Self::open(test, setup));
        }
        let missing = missing.join(", ");
        assert!(
            env::var_os("OROGEN_REQUIRE_WINDOW").is_none(),
            "missing: {missing}"
        );
        println!("skipped {test}; missing: {missing}");
        None
    }

    /// A table in use: after the first push.
    pub(crate) fn in_play(test: &str, setup: &Setup<'_>) -> Option<Self> {
        let mut table = Self::start(test, setup)?;
        table.wake();
        Some(table)
    }

    /// A table in use, on fresh land.
    pub(crate) fn fresh(test: &str, setup: &Setup<'_>) -> Option<Self> {
        let mut table = Self::in_play(test, setup)?;
        table.start_over();
        Some(table)
    }

    fn open(test: &str, setup: &Setup<'_>) -> Self {
        static ALONE: Mutex<()> = Mutex::new(());
        let alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = evidence(test);
        let display = Display::start(&folder, setup.screen);
        let fingers = Fingers::start(&display, &folder);
        let settings = folder.join("settings.toml");
        fs::write(&settings, setup.settings).unwrap();
        let metrics = folder.join("metrics.jsonl");
        let program = display
            .command(env!("CARGO_BIN_EXE_orogen"))
            .args(setup.arguments)
            .arg("--settings")
            .arg(&settings)
            .arg("--metrics")
            .arg(&metrics)
            .current_dir(&folder)
            .stdin(Stdio::null())
            .stdout(File::create(folder.join("program.out")).unwrap())
            .stderr(File::create(folder.join("program.err")).unwrap())
            .spawn()
            .unwrap();
        let mut table = Self {
            metrics: Metrics::new(metrics),
            origin: (0.0, 0.0),
            program,
            fingers,
            display,
            folder,
            saves: 0,
            _alone: alone,
        };
        table.wait("a second with frames", START_S, |now| now.frames > 0);
        table.find_window();
        table
    }

    /// Looks where the window is now.
    pub(crate) fn find_window(&mut self) {
        self.origin = self.display.window_origin();
    }

    /// Touches and pushes until the table is in use. Aside, where no test looks: the push raises land.
    fn wake(&mut self) {
        let mut touch = Script::default();
        touch.tap(0.0, 0.1, self.at(0.93, 0.45));
        self.play(&touch);
        self.wait("the touch to wake the table", SLOW_S, |now| now.phase == "invite");
        let mut push = Script::default();
        push.stroke(0.0, 0.5, self.at(0.93, 0.45), self.at(0.93, 0.55));
        self.play(&push);
        self.wait("the push to begin the visit", SLOW_S, |now| {
            now.phase == "play" && now.contacts == 0
        });
    }

    /// Holds the key that starts over, until the land is as it was.
    pub(crate) fn start_over(&mut self) {
        // Twice as long as need be: a slow machine looks at its clock a few times a second.
        self.press(&[Key::R], 3.0);
        self.wait("fresh land", SLOW_S, |now| now.max_m < FRESH_M);
    }

    /// What the screen shows when nothing is down and the land is so old.
    pub(crate) fn look_at_age(&mut self, years: f64, name: &str) -> Picture {
        self.wait("the land to age", 2.0 * SLOW_S, |now| {
            now.contacts == 0 && now.elapsed_yr >= years
        });
        self.look(name)
    }

    /// The place at a share of the window's width and height.
    pub(crate) fn at(&mut self, x: f64, y: f64) -> At {
        let now = self.metrics.newest();
        (x * f64::from(now.width), y * f64::from(now.height))
    }

    /// Plays contacts; returns when the X server has processed the last of them.
    pub(crate) fn play(&mut self, script: &Script) {
        self.fingers.play(script, self.origin);
    }

    /// Presses keys together, holds them for `seconds`, and lets them go.
    pub(crate) fn press(&mut self, keys: &[Key], seconds: f64) {
        self.fingers.keys(keys, seconds);
    }

    /// Drags the mouse with its button held.
    pub(crate) fn drag(&mut self, from: At, to: At, seconds: f64) {
        self.fingers.drag(from, to, seconds, self.origin);
    }

    /// Pulls the touchscreen's cable. What is down stays down as far as the device is concerned.
    pub(crate) fn unplug(&mut self) {
        self.display.xinput("disable");
    }

    /// Plugs the touchscreen in again.
    pub(crate) fn replug(&mut self) {
        self.display.xinput("enable");
        self.fingers = Fingers::start(&self.display, &self.folder);
    }

    /// The first second from now on for which `holds`.
    pub(crate) fn wait(&mut self, what: &str, seconds: f64, holds: impl Fn(&Second) -> bool) -> Second {
        let (program, folder) = (&mut self.program, &self.folder);
        let alive = || match program.try_wait().unwrap() {
            None => Ok(()),
            Some(status) => {
                let said = fs::read_to_string(folder.join("program.err")).unwrap_or_default();
                Err(format!("the program ended with {status} and said:\n{said}"))
            }
        };
        self.metrics.wait(what, seconds, alive, holds)
    }

    /// The next whole second: everything sent before is in it.
    pub(crate) fn settled(&mut self) -> Second {
        let from = self.metrics.newest().t_s;
        self.wait("a whole second", 10.0, |now| now.t_s >= from + 1.5)
    }

    /// The text of the settings' file.
    pub(crate) fn settings(&self) -> String {
        fs::read_to_string(self.folder.join("settings.toml")).expect("the settings' file")
    }

    /// What the screen shows; kept as `name`.
    pub(crate) fn look(&mut self, name: &str) -> Picture {
        self.display.screenshot(&self.folder.join(format!("{name}.png")))
    }

    /// Saves the land by key, and reads it.
    pub(crate) fn save(&mut self) -> Land {
        self.saves += 1;
        self.press(&[Key::S], 0.05);
        self.saved(&format!("table-{:03}", self.saves), SLOW_S)
    }

    /// Whether anything of that name has been saved.
    pub(crate) fn has_saved(&self, name: &str) -> bool {
        self.folder.join("orogen-out").join(name).exists()
    }

    /// Reads the land that is saved under a name, once it is there.
    pub(crate) fn saved(&mut self, name: &str, seconds: f64) -> Land {
        let saved = self.folder.join("orogen-out").join(name);
        let until = Instant::now() + Duration::from_secs_f64(seconds);
        while !Land::FILES.iter().all(|file| saved.join(file).is_file()) {
            assert!(Instant::now() < until, "no land in {}", saved.display());
            thread::sleep(Duration::from_millis(100));
        }
        let now = self.metrics.newest();
        Land::read(&saved, (now.width, now.height))
    }

    /// The first file of contacts that staff have saved.
    pub(crate) fn saved_contacts(&mut self) -> Vec<u8> {
        let saved = self.folder.join("orogen-out/contacts-001.gesture.jsonl");
        let until = Instant::now() + Duration::from_secs_f64(SLOW_S);
        while !saved.is_file() {
            assert!(Instant::now() < until, "no {}", saved.display());
            thread::sleep(Duration::from_millis(100));
        }
        fs::read(saved).unwrap()
    }

    /// How the program ended.
    pub(crate) fn ended(&mut self, seconds: f64) -> ExitStatus {
        let until = Instant::now() + Duration::from_secs_f64(seconds);
        loop {
            if let Some(status) = self.program.try_wait().unwrap() {
                return status;
            }
            assert!(
                Instant::now() < until,
                "the program still runs after {seconds} s: {:?}",
                self.metrics.newest()
            );
            thread::sleep(Duration::from_millis(50));
        }
    }

    /// Whether the program still runs after `seconds`.
    pub(crate) fn survives(&mut self, seconds: f64) -> bool {
        thread::sleep(Duration::from_secs_f64(seconds));
        self.program.try_wait().unwrap().is_none()
    }
}

impl Drop for Table {
    fn drop(&mut self) {
        let failed = thread::panicking();
        if failed {
            self.display.keep_evidence(&self.folder);
        }
        // Errors are left alone here: a panic while one is under way would hide the first.
        let _ = self.program.kill();
        let _ = self.program.wait();
        if !failed {
            let _ = fs::remove_dir_all(&self.folder);
        }
    }
}

/// An empty folder for what a test sees.
fn evidence(test: &str) -> PathBuf {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap();
    let folder = target.join("window-failures").join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}
