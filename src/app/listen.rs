//! The touch devices that the table listens to itself, beside the window.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use glam::DVec2;
use winit::event_loop::EventLoopProxy;

use crate::device::tuio::{TuioListener, TuioListenerOptions};
use crate::device::{DeviceFrame, FrameQueue, Wake};
use crate::gesture::contact::Source;
use crate::settings::{InputSettings, Listen};

/// Most lines that are kept of what devices there are.
const MOST_LINES: usize = 12;

/// Listeners for what the settings ask for.
pub(super) struct Listeners {
    settings: InputSettings,
    wake: Wake,
    began: Instant,
    #[cfg(target_os = "linux")]
    hid: Option<crate::device::hid::HidListener>,
    tuio: Option<(TuioListener, FrameQueue)>,
    /// The frames that were read last, whose buffers go back.
    frames: Vec<DeviceFrame>,
    /// What staff should know of devices: by source and device, in words.
    lines: Vec<(Source, Option<u16>, String)>,
}

impl Listeners {
    /// Listens from now on; `proxy` is woken when something waits.
    pub(super) fn start(settings: &InputSettings, proxy: EventLoopProxy<()>) -> Self {
        let proxy = Mutex::new(proxy);
        let wake: Wake = Arc::new(move || {
            // A loop that has ended needs no waking.
            let _ = proxy
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .send_event(());
        });
        let mut listeners = Self {
            settings: settings.clone(),
            wake,
            began: Instant::now(),
            #[cfg(target_os = "linux")]
            hid: None,
            tuio: None,
            frames: Vec::new(),
            lines: Vec::new(),
        };
        listeners.open();
        listeners
    }

    /// Other settings: what is listened to begins anew. The devices there were are to be forgotten then, and true.
    pub(super) fn apply(&mut self, settings: &InputSettings) -> bool {
        if self.settings == *settings {
            return false;
        }
        self.settings = settings.clone();
        self.tuio = None;
        #[cfg(target_os = "linux")]
        {
            self.hid = None;
        }
        self.lines.clear();
        self.open();
        true
    }

    /// What staff should know of the devices, a line each.
    pub(super) fn lines(&self) -> impl Iterator<Item = &str> {
        self.lines.iter().map(|(_, _, line)| line.as_str())
    }

    /// States that nobody fetched in time.
    pub(super) fn lost(&self) -> u64 {
        let tuio = self.tuio.as_ref().map_or(0, |(_, queue)| queue.lost());
        #[cfg(target_os = "linux")]
        let tuio = tuio + self.hid.as_ref().map_or(0, crate::device::hid::HidListener::lost);
        tuio
    }

    /// Packets of TUIO that were turned away or made no sense.
    pub(super) fn refused(&self) -> u64 {
        let heard = self.tuio.as_ref().map(|(listener, _)| listener.heard());
        heard.map_or(0, |heard| heard.refused + heard.counts.turned_away())
    }

    /// Hands over what has been said since the last time, in order.
    pub(super) fn drain(&mut self, mut take: impl FnMut(Source, &DeviceFrame)) {
        let mut frames = std::mem::take(&mut self.frames);
        #[cfg(target_os = "linux")]
        if let Some(hid) = &self.hid {
            hid.drain(&mut frames);
            self.read(Source::Hid, &frames, &mut take);
        }
        if let Some((_, queue)) = &self.tuio {
            queue.drain(&mut frames);
            self.read(Source::Tuio, &frames, &mut take);
        }
        self.frames = frames;
    }

    fn read(&mut self, source: Source, frames: &[DeviceFrame], take: &mut impl FnMut(Source, &DeviceFrame)) {
        for frame in frames {
            match frame {
                DeviceFrame::Plugged { device, name, facts } => {
                    let most = facts
                        .max_contacts
                        .map_or(String::new(), |n| format!(", {n} contacts"));
                    self.note(source, Some(*device), &format!("{name}{most}"));
                }
                DeviceFrame::Unplugged { device } => {
                    tracing::warn!("{} device {device} is gone", word(source));
                    self.lines
                        .retain(|line| (line.0, line.1) != (source, Some(*device)));
                }
                DeviceFrame::Denied { path, vid, pid } => self.note(
                    source,
                    None,
                    &format!("{path} ({vid:04x}:{pid:04x}): permission denied; see `orogen devices --udev`"),
                ),
                DeviceFrame::State { .. } => {}
            }
            take(source, frame);
        }
    }

    fn note(&mut self, source: Source, device: Option<u16>, line: &str) {
        let line = format!("{}: {line}", word(source));
        tracing::info!("{line}");
        if self.lines.len() == MOST_LINES {
            self.lines.remove(0);
        }
        self.lines.push((source, device, line));
    }

    fn open(&mut self) {
        let wanted = |source| [Listen::Auto, source].contains(&self.settings.source);
        let (hid, tuio) = (wanted(Listen::Hid), wanted(Listen::Tuio));
        if hid {
            self.open_hid();
        }
        if tuio {
            self.open_tuio();
        }
    }

    #[cfg(target_os = "linux")]
    fn open_hid(&mut self) {
        use crate::device::hid::{HidListener, HidOptions};
        use crate::device::hidraw::Hidraw;

        let size_mm = match self.settings.surface_mm {
            [Some(width), Some(height)] => Some(DVec2::new(width, height)),
            _ => None,
        };
        let options = HidOptions {
            only: Vec::new(),
            size_mm,
            epoch: self.began,
            wake: Some(Arc::clone(&self.wake)),
        };
        let started = Hidraw::new()
            .and_then(|bus| HidListener::start(Box::new(bus), options).map_err(|error| error.to_string()));
        match started {
            Ok(listener) => self.hid = Some(listener),
            Err(error) => self.note(Source::Hid, None, &error),
        }
    }

    #[cfg(not(target_os = "linux"))]
    fn open_hid(&mut self) {
        if self.settings.source == Listen::Hid {
            let why = "raw touchscreens can be read on Linux only: use \"window\" or \"tuio\"";
            self.note(Source::Hid, None, why);
        }
    }

    fn open_tuio(&mut self) {
        let others = &self.settings.tuio_allow;
        let (open, all) = (!others.is_empty(), others.iter().any(IpAddr::is_unspecified));
        let host = if open {
            Ipv4Addr::UNSPECIFIED
        } else {
            Ipv4Addr::LOCALHOST
        };
        let mut allowed = Vec::new();
        if open && !all {
            allowed.push(IpAddr::V4(Ipv4Addr::LOCALHOST));
            allowed.extend(others);
        }
        let options = TuioListenerOptions {
            address: SocketAddr::new(IpAddr::V4(host), self.settings.tuio_port),
            open_to_network: open,
            allowed,
            surface_mm: match self.settings.surface_mm {
                [Some(width), Some(height)] => Some(DVec2::new(width, height)),
                _ => None,
            },
        };
        let queue = FrameQueue::new(Some(Arc::clone(&self.wake)));
        match TuioListener::start(options, queue.clone()) {
            Ok(listener) => self.tuio = Some((listener, queue)),
            Err(error) => self.note(Source::Tuio, None, &error.to_string()),
        }
    }
}

/// What people call a source.
pub(super) fn word(source: Source) -> &'static str {
    match source {
        Source::Window => "window",
        Source::Mouse => "mouse",
        Source::Hid => "hid",
        Source::Tuio => "tuio",
        Source::File => "file",
    }
}
