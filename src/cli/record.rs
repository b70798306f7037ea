//! `orogen record`: the contacts of a touch device → a gesture file, line by line.

use std::fs::File;
use std::path::Path;
use std::time::{Duration, Instant};

use glam::{DAffine2, DVec2};

use super::RecordArgs;
use super::console::Console;
use super::failure::Failure;
use super::import::size_mm;
use super::table;
use crate::device::tuio::{TuioListener, TuioListenerOptions};
use crate::device::{DeviceFrame, FrameQueue};
use crate::gesture::contact::{InputFrame, Phase, Source};
use crate::gesture::file::{GestureWriter, Header, MAX_SIZE_MM};
use crate::input::touching::Tracker;
use crate::settings::Settings;

/// Time between two looks at what has come.
const LOOK: Duration = Duration::from_millis(4);

/// How long a raw touchscreen is waited for.
const PATIENCE: Duration = Duration::from_secs(5);

/// Records what `args` asks for: a device, or else the table in its window.
pub(super) fn run(args: &RecordArgs, console: Console) -> Result<(), Failure> {
    if args.out.exists() {
        return Err(Failure::input(format!(
            "--out {}: expected a new file, found one that is there",
            args.out.display()
        )));
    }
    let size_mm = size_mm(args.size_mm.as_deref())?;
    if let Some(size_mm) =
        size_mm.filter(|size| !(0.0 < size.min_element() && size.max_element() <= MAX_SIZE_MM))
    {
        return Err(Failure::input(format!(
            "--size-mm {},{}: expected sides of more than 0 and up to {MAX_SIZE_MM} mm",
            size_mm.x, size_mm.y
        )));
    }
    match (args.tuio, &args.hid) {
        (Some(port), _) => tuio(args, port, size_mm, console),
        (None, Some(path)) => hid(args, path, size_mm, console),
        (None, None) => table::record(args),
    }
}

fn tuio(args: &RecordArgs, port: u16, size_mm: Option<DVec2>, console: Console) -> Result<(), Failure> {
    let size_mm = size_mm.unwrap_or_else(|| Settings::default().table_size_mm(DVec2::new(16.0, 9.0)));
    let queue = FrameQueue::new(None);
    let mut options = TuioListenerOptions {
        surface_mm: Some(size_mm),
        ..TuioListenerOptions::default()
    };
    options.address.set_port(port);
    let listener = TuioListener::start(options, queue.clone()).map_err(Failure::input)?;
    console.note(&format!(
        "listening for TUIO on {}, a table of {} × {} mm; Ctrl+C ends",
        listener.address(),
        size_mm.x,
        size_mm.y
    ));
    let mut recording = Recording::begin(&args.out, Source::Tuio, size_mm)?;
    recording.follow(&queue, args.seconds, console)
}

#[cfg(not(target_os = "linux"))]
fn hid(_: &RecordArgs, _: &str, _: Option<DVec2>, _: Console) -> Result<(), Failure> {
    Err(Failure::input(
        "--hid: raw touchscreens can be read on Linux only; record the window, or --tuio",
    ))
}

#[cfg(target_os = "linux")]
fn hid(args: &RecordArgs, path: &str, size_mm: Option<DVec2>, console: Console) -> Result<(), Failure> {
    use crate::device::hid::{Bus, Found, HidListener, HidOptions, OpenError, Wire};
    use crate::device::hidraw::Hidraw;

    /// The device at a path, or any for an empty one.
    struct At(Hidraw, String);

    impl Bus for At {
        fn list(&mut self) -> Vec<Found> {
            let mut found = self.0.list();
            found.retain(|found| self.1.is_empty() || found.path == self.1);
            found
        }

        fn open(&mut self, found: &Found) -> Result<Box<dyn Wire>, OpenError> {
            self.0.open(found)
        }
    }

    let bus = At(Hidraw::new().map_err(Failure::other)?, path.to_owned());
    let options = HidOptions {
        size_mm,
        ..HidOptions::default()
    };
    let listener = HidListener::start(Box::new(bus), options).map_err(Failure::other)?;
    let queue = listener.queue();
    let began = Instant::now();
    let mut frames = Vec::new();
    while began.elapsed() < PATIENCE {
        queue.drain(&mut frames);
        for frame in &frames {
            match frame {
                DeviceFrame::Plugged { name, facts, .. } => {
                    let size_mm = size_mm.or(facts.physical_mm).ok_or_else(|| {
                        Failure::input(format!("{name} does not tell its size: give --size-mm W,H"))
                    })?;
                    console.note(&format!("{name}, {} × {} mm; Ctrl+C ends", size_mm.x, size_mm.y));
                    let mut recording = Recording::begin(&args.out, Source::Hid, size_mm)?;
                    return recording.follow(&queue, args.seconds, console);
                }
                DeviceFrame::Denied { path, .. } => {
                    return Err(Failure::input(format!(
                        "{path}: permission denied; see `orogen devices --udev`"
                    )));
                }
                DeviceFrame::State { .. } | DeviceFrame::Unplugged { .. } => {}
            }
        }
        std::thread::sleep(LOOK);
    }
    let which = if path.is_empty() { "a touchscreen" } else { path };
    Err(Failure::input(format!(
        "--hid: expected {which}, found none (see `orogen devices`)"
    )))
}

/// A file that grows.
struct Recording {
    writer: GestureWriter<File>,
    source: Source,
    map: DAffine2,
    /// Of each device that has spoken.
    trackers: Vec<(u16, Tracker)>,
    /// The clock of the devices when the first contact landed, µs.
    first_us: Option<u64>,
    last_us: u64,
    contacts: u64,
}

impl Recording {
    fn begin(out: &Path, source: Source, size_mm: DVec2) -> Result<Self, Failure> {
        let named = |error: std::io::Error| Failure::input(format!("--out {}: {error}", out.display()));
        let header = Header {
            title: Some("recorded contacts".to_owned()),
            ..Header::new(size_mm)
        };
        let file = File::create_new(out).map_err(named)?;
        Ok(Self {
            writer: GestureWriter::new(file, &header).map_err(named)?,
            source,
            map: DAffine2::from_scale(size_mm),
            trackers: Vec::new(),
            first_us: None,
            last_us: 0,
            contacts: 0,
        })
    }

    /// Writes what comes, for so many seconds or until the program is ended.
    fn follow(&mut self, queue: &FrameQueue, seconds: Option<f64>, console: Console) -> Result<(), Failure> {
        let began = Instant::now();
        let mut frames = Vec::new();
        while seconds.is_none_or(|seconds| began.elapsed().as_secs_f64() < seconds) {
            queue.drain(&mut frames);
            for frame in &frames {
                self.take(frame).map_err(Failure::other)?;
            }
            std::thread::sleep(LOOK);
        }
        let devices: Vec<u16> = self.trackers.iter().map(|(device, _)| *device).collect();
        for device in devices {
            self.take(&DeviceFrame::Unplugged { device })
                .map_err(Failure::other)?;
        }
        console.note(&format!("{} contacts", self.contacts));
        if queue.lost() > 0 {
            Console::warn(&format!("{} states were lost", queue.lost()));
        }
        Ok(())
    }

    fn take(&mut self, frame: &DeviceFrame) -> std::io::Result<()> {
        let mut events = Vec::new();
        match frame {
            DeviceFrame::State {
                device,
                t_us,
                touching,
            } => {
                self.last_us = *t_us;
                self.tracker(*device).frame(touching, &mut events);
            }
            DeviceFrame::Unplugged { device } => self.tracker(*device).cancel_all(&mut events),
            DeviceFrame::Plugged { .. } | DeviceFrame::Denied { .. } => {}
        }
        if events.is_empty() {
            return Ok(());
        }
        let landed = events.iter().filter(|event| event.phase == Phase::Down);
        self.contacts += landed.count() as u64;
        let first_us = *self.first_us.get_or_insert(self.last_us);
        self.writer.write_frame(&InputFrame {
            t_us: self.last_us.saturating_sub(first_us),
            events,
            commands: Vec::new(),
        })?;
        self.writer.flush()
    }

    fn tracker(&mut self, device: u16) -> &mut Tracker {
        let known = self.trackers.iter().position(|(known, _)| *known == device);
        let index = known.unwrap_or_else(|| {
            self.trackers
                .push((device, Tracker::new(self.source, device, self.map)));
            self.trackers.len() - 1
        });
        &mut self.trackers[index].1
    }
}
