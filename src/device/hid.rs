//! Raw HID touchscreens: found, opened, asked, set, and listened to; each by a thread of its own. A table may come and
//! go at any time, and several may be there at once.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use glam::DVec2;

use super::{DeviceFacts, DeviceFrame, FrameQueue, Wake};
use crate::input::hid::prepare::MAX_DESCRIPTOR_BYTES;
use crate::input::hid::{Decoder, Descriptor, Frame, Quirks};

/// How often it is looked for new devices.
const LOOK: Duration = Duration::from_secs(1);

/// How long a read waits while something is down, ms: contacts of a device that falls silent are given up so soon.
const WAIT_TOUCHED_MS: i32 = 5;
/// The same while nothing is down: how soon a thread notices that it is to end.
const WAIT_IDLE_MS: i32 = 50;

/// Longest report, bytes; the longest of 283 real touchscreens has some hundred.
const MAX_REPORT_BYTES: usize = 4096;

/// A device on the bus, as it is known before it is opened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// Where it is.
    pub path: String,
    /// What it calls itself.
    pub name: String,
    /// Number of its maker.
    pub vid: u16,
    /// Number of the product.
    pub pid: u16,
    /// Whether it is plugged in by USB.
    pub usb: bool,
}

/// Why a device cannot be opened.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OpenError {
    /// The user may not read it.
    #[error("permission denied")]
    Denied,
    /// Anything else.
    #[error("{0}")]
    Other(String),
}

/// The device answers no more: it is unplugged, or as good as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the device is gone")]
pub struct Gone;

/// Where devices come from.
pub trait Bus: Send {
    /// The touchscreens that are there now.
    fn list(&mut self) -> Vec<Found>;

    /// Opens one of them.
    ///
    /// # Errors
    /// [`OpenError`] says why not.
    fn open(&mut self, found: &Found) -> Result<Box<dyn Wire>, OpenError>;
}

/// An open device.
pub trait Wire: Send {
    /// Its report descriptor, up to the size of the buffer; how many bytes that is.
    ///
    /// # Errors
    /// [`Gone`] when there is none to be had.
    fn descriptor(&mut self, buffer: &mut [u8]) -> Result<usize, Gone>;

    /// Asks for the feature report whose number is in the first byte, and yields the answer; `None` where the device
    /// has none. (Devices may refuse what they declare.)
    fn ask(&mut self, request: Vec<u8>) -> Option<Vec<u8>>;

    /// Sets the feature report whose number is in the first byte, if the device lets it.
    fn tell(&mut self, report: &[u8]);

    /// Waits for a report and reads it; 0 bytes when none has come in time.
    ///
    /// # Errors
    /// [`Gone`] when none will come any more.
    fn read(&mut self, buffer: &mut [u8], timeout_ms: i32) -> Result<usize, Gone>;
}

/// What to listen to, and how.
#[derive(Clone)]
pub struct HidOptions {
    /// Only devices of these makers and products; none: every touchscreen.
    pub only: Vec<(u16, u16)>,
    /// The surface as the operator has measured it, mm.
    pub size_mm: Option<DVec2>,
    /// Moment 0 of all times, so that several listeners share one clock.
    pub epoch: Instant,
    /// Called when something waits.
    pub wake: Option<Wake>,
}

impl Default for HidOptions {
    fn default() -> Self {
        Self {
            only: Vec::new(),
            size_mm: None,
            epoch: Instant::now(),
            wake: None,
        }
    }
}

/// Listens to touchscreens until it is dropped.
#[derive(Debug)]
pub struct HidListener {
    queue: FrameQueue,
    stop: Arc<AtomicBool>,
    keeper: Option<JoinHandle<()>>,
}

impl HidListener {
    /// Listens to the touchscreens of `bus`.
    ///
    /// # Errors
    /// The system has no thread left.
    pub fn start(bus: Box<dyn Bus>, options: HidOptions) -> std::io::Result<Self> {
        let queue = FrameQueue::new(options.wake.clone());
        let stop = Arc::new(AtomicBool::new(false));
        let keeper = Keeper {
            bus,
            options,
            queue: queue.clone(),
            stop: Arc::clone(&stop),
            known: BTreeMap::new(),
            next: 0,
        };
        let keeper = std::thread::Builder::new()
            .name("orogen-hid".to_owned())
            .spawn(move || keeper.run())?;
        Ok(Self {
            queue,
            stop,
            keeper: Some(keeper),
        })
    }

    /// Replaces what is in `out` by all that has been said since the last time, in order.
    pub fn drain(&self, out: &mut Vec<DeviceFrame>) {
        self.queue.drain(out);
    }

    /// A handle of the queue, which outlives the listener: what it said last can still be read.
    pub fn queue(&self) -> FrameQueue {
        self.queue.clone()
    }

    /// States that nobody fetched in time.
    pub fn lost(&self) -> u64 {
        self.queue.lost()
    }
}

impl Drop for HidListener {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(keeper) = self.keeper.take() {
            keeper.thread().unpark();
            // A reader that panicked has said so; there is nothing left to save.
            let _ = keeper.join();
        }
    }
}

/// What has become of a device that is there.
enum Known {
    /// It is no touchscreen, and stays none until it is gone.
    Ignored,
    /// It cannot be opened now, which may change; whether that was told.
    Closed { told: bool },
    /// A thread listens to it.
    Listened(JoinHandle<()>),
}

/// Looks for devices, and has one thread for each.
struct Keeper {
    bus: Box<dyn Bus>,
    options: HidOptions,
    queue: FrameQueue,
    stop: Arc<AtomicBool>,
    known: BTreeMap<String, Known>,
    next: u16,
}

impl Keeper {
    fn run(mut self) {
        while !self.stop.load(Ordering::Relaxed) {
            self.look();
            std::thread::park_timeout(LOOK);
        }
        for known in self.known.into_values() {
            if let Known::Listened(reader) = known {
                let _ = reader.join();
            }
        }
    }

    fn look(&mut self) {
        let mut found = self.bus.list();
        let only = &self.options.only;
        found.retain(|found| only.is_empty() || only.contains(&(found.vid, found.pid)));
        self.known.retain(|path, known| match known {
            // It has said so itself.
            Known::Listened(reader) => !reader.is_finished(),
            _ => found.iter().any(|found| found.path == *path),
        });
        for found in found {
            let told = match self.known.get(&found.path) {
                None => false,
                Some(Known::Closed { told }) => *told,
                Some(_) => continue,
            };
            let known = self.meet(&found, told);
            self.known.insert(found.path, known);
        }
    }

    fn meet(&mut self, found: &Found, told: bool) -> Known {
        let wire = match self.bus.open(found) {
            Ok(wire) => wire,
            Err(OpenError::Denied) => {
                if !told {
                    self.queue.push(DeviceFrame::Denied {
                        path: found.path.clone(),
                        vid: found.vid,
                        pid: found.pid,
                    });
                }
                return Known::Closed { told: true };
            }
            Err(OpenError::Other(_)) => return Known::Closed { told },
        };
        let Some((reader, facts)) = self.introduce(wire, found) else {
            return Known::Ignored;
        };
        let device = reader.device;
        self.next = self.next.wrapping_add(1);
        self.queue.push(DeviceFrame::Plugged {
            device,
            name: found.name.clone(),
            facts,
        });
        let started = std::thread::Builder::new()
            .name(format!("orogen-hid-{device}"))
            .spawn(move || reader.run());
        started.map_or_else(
            |_| {
                self.queue.push(DeviceFrame::Unplugged { device });
                Known::Ignored
            },
            Known::Listened,
        )
    }

    /// Asks the device for what it can do, and makes it a touchscreen. `None` when it is none.
    fn introduce(&self, mut wire: Box<dyn Wire>, found: &Found) -> Option<(Reader, DeviceFacts)> {
        let (descriptor, max_contacts) = introduce(&mut *wire)?;
        let quirks = Quirks::choose(found.vid, found.pid, &descriptor, max_contacts);
        let size_mm = self.options.size_mm;
        let decoder = Decoder::new(&descriptor, quirks, max_contacts, size_mm).ok()?;
        let facts = DeviceFacts {
            physical_mm: size_mm.or(descriptor.touch.ok()?.physical_mm()),
            max_contacts: Some(max_contacts),
        };
        let reader = Reader {
            device: self.next,
            wire,
            decoder,
            queue: self.queue.clone(),
            epoch: self.options.epoch,
            stop: Arc::clone(&self.stop),
        };
        Some((reader, facts))
    }
}

/// What an open device says of itself, and how many contacts it reports at once. It is asked for the blob by which
/// Windows knows it, since some report one contact before that, and set to report all contacts.
pub fn introduce(wire: &mut dyn Wire) -> Option<(Descriptor, u32)> {
    let mut buffer = vec![0; MAX_DESCRIPTOR_BYTES];
    let length = wire.descriptor(&mut buffer).ok()?;
    let descriptor = Descriptor::parse(buffer.get(..length)?).ok()?;
    descriptor.touch.as_ref().ok()?;
    let features = descriptor.features;
    let answer = features
        .contact_count_max
        .and_then(|field| wire.ask(field.report.request()));
    let max_contacts = features.max_contacts(answer.as_deref());
    if let Some(report) = features.certification {
        wire.ask(report.request());
    }
    let mode = features
        .input_mode
        .and_then(|field| wire.ask(field.report.request()));
    if let Some(report) = features.set_touch_mode(mode.as_deref()) {
        wire.tell(&report);
    }
    Some((descriptor, max_contacts))
}

/// Listens to one device.
struct Reader {
    device: u16,
    wire: Box<dyn Wire>,
    decoder: Decoder,
    queue: FrameQueue,
    epoch: Instant,
    stop: Arc<AtomicBool>,
}

impl Reader {
    fn run(mut self) {
        let mut buffer = vec![0; MAX_REPORT_BYTES];
        let mut is_touched = false;
        while !self.stop.load(Ordering::Relaxed) {
            let wait_ms = if is_touched { WAIT_TOUCHED_MS } else { WAIT_IDLE_MS };
            let Ok(length) = self.wire.read(&mut buffer, wait_ms) else {
                break;
            };
            let now_us = self.epoch.elapsed().as_micros() as u64;
            let frame = match buffer.get(..length) {
                Some(report) if length > 0 => self.decoder.decode(report, now_us),
                _ => self.decoder.tick(now_us),
            };
            if let Some(Frame { t_us, touching }) = frame {
                is_touched = !touching.is_empty();
                self.queue.push_state(self.device, t_us, touching);
            }
        }
        self.queue.push(DeviceFrame::Unplugged { device: self.device });
    }
}
