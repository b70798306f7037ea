//! Listens for TUIO on a UDP port.
//!
//! Nobody proves who sends a datagram, so by default only this machine is heard. On an open port anyone in the room
//! can draw; a list of allowed senders keeps out the careless, not the ill-willed, who can write any address.

use std::io;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use glam::DVec2;

use super::{DeviceFacts, DeviceFrame, FrameQueue};
use crate::input::tuio::{
    MAX_PACKET_BYTES, MAX_SOURCES, TuioCounts, TuioDecoder, TuioEvent, TuioOptions, TuioSource,
};

/// The port that TUIO senders use unless told otherwise.
pub const TUIO_PORT: u16 = 3333;

/// Longest wait for a packet: how late silence and the end are noticed.
const WAIT: Duration = Duration::from_millis(50);

/// Time between two looks at the senders for [`TuioHeard::sources`].
const LOOK: Duration = Duration::from_millis(500);

/// Where and to whom to listen.
#[derive(Clone, Debug, PartialEq)]
pub struct TuioListenerOptions {
    /// Address and port to listen on; port 0 takes a free one.
    pub address: SocketAddr,
    /// Whether [`Self::address`] may be one that other machines reach.
    pub open_to_network: bool,
    /// Machines that are listened to; none means all.
    pub allowed: Vec<IpAddr>,
    /// Size of the touching surface, mm. Without it contacts have no size.
    pub surface_mm: Option<DVec2>,
}

impl Default for TuioListenerOptions {
    fn default() -> Self {
        Self {
            address: SocketAddr::from((Ipv4Addr::LOCALHOST, TUIO_PORT)),
            open_to_network: false,
            allowed: Vec::new(),
            surface_mm: None,
        }
    }
}

/// What the listener has heard, for people.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TuioHeard {
    /// What was heard and let pass.
    pub counts: TuioCounts,
    /// Packets of machines that are not allowed.
    pub refused: u64,
    /// The senders, as they were half a second ago at most.
    pub sources: Vec<TuioSource>,
}

/// A thread that listens until this is dropped; then the contacts of all senders are withdrawn.
#[derive(Debug)]
pub struct TuioListener {
    address: SocketAddr,
    heard: Arc<Mutex<TuioHeard>>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl TuioListener {
    /// Begins to listen; states go into `queue`, each sender as a device of its own, numbered from 0.
    ///
    /// # Errors
    /// The port is taken or may not be had, or the address is open to the network without leave.
    pub fn start(options: TuioListenerOptions, queue: FrameQueue) -> io::Result<Self> {
        if !options.address.ip().is_loopback() && !options.open_to_network {
            return Err(io::Error::new(
                io::ErrorKind::PermissionDenied,
                format!(
                    "TUIO on {}: expected an address of this machine alone (127.0.0.1), since anyone who reaches \
                     another one can draw; say that the network may",
                    options.address
                ),
            ));
        }
        let socket = UdpSocket::bind(options.address).map_err(|error| named(&error, options.address))?;
        socket.set_read_timeout(Some(WAIT))?;
        let address = socket.local_addr()?;
        let heard = Arc::new(Mutex::new(TuioHeard::default()));
        let stop = Arc::new(AtomicBool::new(false));
        let listening = Listening {
            socket,
            allowed: options.allowed,
            decoder: TuioDecoder::new(TuioOptions {
                surface_mm: options.surface_mm,
            }),
            devices: Devices::new(queue, options.surface_mm),
            heard: Arc::clone(&heard),
        };
        let thread = thread::Builder::new().name("orogen-tuio".to_owned()).spawn({
            let stop = Arc::clone(&stop);
            move || listening.run(&stop)
        })?;
        Ok(Self {
            address,
            heard,
            stop,
            thread: Some(thread),
        })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// What it has heard so far.
    pub fn heard(&self) -> TuioHeard {
        self.heard.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl Drop for TuioListener {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has nothing more to say.
            let _ = thread.join();
        }
    }
}

/// The error of a port that cannot be had, with what to do about it.
fn named(error: &io::Error, address: SocketAddr) -> io::Error {
    let why = match error.kind() {
        io::ErrorKind::AddrInUse => {
            "expected a free port, but another program listens there: end it, or choose another port"
                .to_owned()
        }
        io::ErrorKind::AddrNotAvailable => "expected an address of this machine".to_owned(),
        io::ErrorKind::PermissionDenied => {
            "expected a port that may be used: choose one above 1023".to_owned()
        }
        _ => error.to_string(),
    };
    io::Error::new(error.kind(), format!("TUIO on {address}: {why}"))
}

/// Which device each sender is. A sender that was lost and comes back is another device: nothing of it is carried on.
struct Devices {
    queue: FrameQueue,
    surface_mm: Option<DVec2>,
    of_source: [u16; MAX_SOURCES],
    next: u16,
}

impl Devices {
    fn new(queue: FrameQueue, surface_mm: Option<DVec2>) -> Self {
        Self {
            queue,
            surface_mm,
            of_source: [0; MAX_SOURCES],
            next: 0,
        }
    }

    fn take(&mut self, t_us: u64, event: TuioEvent<'_>) {
        match event {
            TuioEvent::Found { source, name, peer } => {
                let device = self.next;
                // After 65,536 senders the first is long gone.
                self.next = self.next.wrapping_add(1);
                self.of_source[usize::from(source)] = device;
                let name = if name.is_empty() {
                    format!("TUIO from {peer}")
                } else {
                    format!("{name} from {peer}")
                };
                let facts = DeviceFacts {
                    physical_mm: self.surface_mm,
                    max_contacts: None,
                };
                self.queue.push(DeviceFrame::Plugged { device, name, facts });
            }
            TuioEvent::State { source, touching } => {
                self.queue
                    .push_state(self.of_source[usize::from(source)], t_us, touching);
            }
            TuioEvent::Lost { source } => {
                let device = self.of_source[usize::from(source)];
                self.queue.push(DeviceFrame::Unplugged { device });
            }
        }
    }
}

/// What the thread owns.
struct Listening {
    socket: UdpSocket,
    allowed: Vec<IpAddr>,
    decoder: TuioDecoder,
    devices: Devices,
    heard: Arc<Mutex<TuioHeard>>,
}

impl Listening {
    fn run(mut self, stop: &AtomicBool) {
        let began = Instant::now();
        let now_us = || began.elapsed().as_micros() as u64;
        let mut buffer = vec![0; MAX_PACKET_BYTES];
        let mut refused = 0;
        let mut looked: Option<Instant> = None;
        while !stop.load(Ordering::Relaxed) {
            let received = self.socket.recv_from(&mut buffer);
            let t_us = now_us();
            let Self {
                decoder,
                devices,
                allowed,
                ..
            } = &mut self;
            let mut sink = |event: TuioEvent<'_>| devices.take(t_us, event);
            match received {
                Ok((_, peer)) if !allowed.is_empty() && !allowed.contains(&peer.ip()) => refused += 1,
                Ok((length, peer)) => decoder.packet(t_us, peer, &buffer[..length], &mut sink),
                Err(error) if is_wait(&error) => decoder.tick(t_us, &mut sink),
                // Windows tells here that nobody took an earlier packet. Nothing is lost by it.
                Err(_) => {
                    decoder.tick(t_us, &mut sink);
                    thread::sleep(Duration::from_millis(1));
                }
            }
            self.look(refused, &mut looked);
        }
        let t_us = now_us();
        let Self { decoder, devices, .. } = &mut self;
        decoder.forget_all(&mut |event| devices.take(t_us, event));
    }

    fn look(&self, refused: u64, looked: &mut Option<Instant>) {
        let mut heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
        heard.counts = self.decoder.counts();
        heard.refused = refused;
        if looked.is_none_or(|at| at.elapsed() >= LOOK) {
            *looked = Some(Instant::now());
            heard.sources.clear();
            heard.sources.extend(self.decoder.sources());
        }
    }
}

fn is_wait(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
    )
}
