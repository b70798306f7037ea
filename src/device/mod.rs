//! Touch devices that Orogen listens to itself: each has a thread that opens it, decodes what it says with
//! [`crate::input`], and puts whole states into one bounded queue. The event loop empties the queue once per frame.

pub mod hid;
#[cfg(target_os = "linux")]
pub mod hidraw;
pub mod tuio;

use std::collections::VecDeque;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use glam::DVec2;

use crate::gesture::contact::MAX_CONTACTS;
use crate::input::touching::Touching;

/// States that wait at most: some seconds of one fast table. Beyond that the oldest state goes; each is whole, so
/// the next one makes up for it.
pub const MAX_WAITING: usize = 1024;

/// Buffers made at the start, enough for an event loop that keeps up.
const SPARE_BUFFERS: usize = 64;

/// What is known of a device.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DeviceFacts {
    /// Its surface in millimetres, where it tells something believable.
    pub physical_mm: Option<DVec2>,
    /// Most contacts it reports at once, where it tells.
    pub max_contacts: Option<u32>,
}

/// What a listener says.
#[derive(Clone, Debug, PartialEq)]
pub enum DeviceFrame {
    /// A device is there and listened to from now on.
    Plugged {
        /// Its number, never given to another one while Orogen runs.
        device: u16,
        /// What it calls itself.
        name: String,
        /// What is known of it.
        facts: DeviceFacts,
    },
    /// Who touches the device now: all contacts that are down.
    State {
        /// Number of the device.
        device: u16,
        /// When, µs of the listener's clock; it does not go back.
        t_us: u64,
        /// The contacts.
        touching: Vec<Touching>,
    },
    /// The device is gone; what was down on it is to be withdrawn.
    Unplugged {
        /// Number of the device.
        device: u16,
    },
    /// A device that may not be opened. Said once, until it may be.
    Denied {
        /// Where it is.
        path: String,
        /// Number of its maker.
        vid: u16,
        /// Number of the product.
        pid: u16,
    },
}

/// Called when something waits that did not before; it must not block.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// The way from listening threads to the event loop. Clones are handles of one queue. In steady state nothing is
/// allocated: buffers of states that were read come back with the next [`FrameQueue::drain`].
#[derive(Clone)]
pub struct FrameQueue {
    waiting: Arc<Mutex<Waiting>>,
    wake: Option<Wake>,
}

#[derive(Debug)]
struct Waiting {
    frames: VecDeque<DeviceFrame>,
    spare: Vec<Vec<Touching>>,
    lost: u64,
}

impl fmt::Debug for FrameQueue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FrameQueue")
            .field("waiting", &self.waiting)
            .finish_non_exhaustive()
    }
}

impl FrameQueue {
    /// An empty queue.
    pub fn new(wake: Option<Wake>) -> Self {
        let buffer = || Vec::with_capacity(MAX_CONTACTS);
        let waiting = Waiting {
            frames: VecDeque::with_capacity(MAX_WAITING + 1),
            spare: std::iter::repeat_with(buffer).take(SPARE_BUFFERS).collect(),
            lost: 0,
        };
        Self {
            waiting: Arc::new(Mutex::new(waiting)),
            wake,
        }
    }

    /// Appends who touches `device` now.
    pub fn push_state(&self, device: u16, t_us: u64, touching: &[Touching]) {
        let mut waiting = self.lock();
        let mut buffer = waiting.spare.pop().unwrap_or_default();
        buffer.extend_from_slice(touching);
        self.put(
            waiting,
            DeviceFrame::State {
                device,
                t_us,
                touching: buffer,
            },
        );
    }

    /// Appends anything.
    pub fn push(&self, frame: DeviceFrame) {
        self.put(self.lock(), frame);
    }

    fn put(&self, mut waiting: MutexGuard<'_, Waiting>, frame: DeviceFrame) {
        let first = waiting.frames.is_empty();
        waiting.frames.push_back(frame);
        if waiting.frames.len() > MAX_WAITING {
            let is_state = |frame: &DeviceFrame| matches!(frame, DeviceFrame::State { .. });
            if let Some(oldest) = waiting.frames.iter().position(is_state) {
                let gone = waiting.frames.remove(oldest);
                waiting.lost += 1;
                waiting.spare.extend(gone.and_then(emptied));
            }
        }
        drop(waiting);
        if first && let Some(wake) = &self.wake {
            wake();
        }
    }

    /// Replaces what is in `out` by all that waits, in order.
    pub fn drain(&self, out: &mut Vec<DeviceFrame>) {
        let mut waiting = self.lock();
        let Waiting { frames, spare, .. } = &mut *waiting;
        for buffer in out.drain(..).filter_map(emptied) {
            if spare.len() < MAX_WAITING {
                spare.push(buffer);
            }
        }
        out.extend(frames.drain(..));
    }

    /// States that nobody fetched in time.
    pub fn lost(&self) -> u64 {
        self.lock().lost
    }

    /// A thread that panicked while it held the queue leaves it whole: every change is one push.
    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The buffer of a state.
fn emptied(frame: DeviceFrame) -> Option<Vec<Touching>> {
    match frame {
        DeviceFrame::State { mut touching, .. } => {
            touching.clear();
            Some(touching)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    fn touching(id: u64) -> Touching {
        Touching {
            id,
            at: DVec2::splat(0.5),
            size_mm: None,
            confidence: None,
        }
    }

    #[test]
    fn what_is_pushed_is_drained_in_order_and_wakes_once() {
        let woken = Arc::new(AtomicUsize::new(0));
        let count = Arc::clone(&woken);
        let wake: Wake = Arc::new(move || {
            count.fetch_add(1, Ordering::Relaxed);
        });
        let queue = FrameQueue::new(Some(wake));
        queue.push_state(2, 10, &[touching(1)]);
        queue.push(DeviceFrame::Unplugged { device: 2 });
        let mut out = vec![DeviceFrame::Unplugged { device: 9 }];
        queue.drain(&mut out);
        let state = DeviceFrame::State {
            device: 2,
            t_us: 10,
            touching: vec![touching(1)],
        };
        assert_eq!(out, [state, DeviceFrame::Unplugged { device: 2 }]);
        assert_eq!(woken.load(Ordering::Relaxed), 1);
        queue.drain(&mut out);
        assert_eq!(out, []);
        queue.push_state(2, 11, &[]);
        assert_eq!(woken.load(Ordering::Relaxed), 2);
    }

    #[test]
    fn a_queue_that_nobody_empties_keeps_the_newest_states_and_all_that_is_no_state() {
        let queue = FrameQueue::new(None);
        queue.push(DeviceFrame::Unplugged { device: 7 });
        for t_us in 0..MAX_WAITING as u64 + 9 {
            queue.push_state(0, t_us, &[touching(t_us)]);
        }
        let mut out = Vec::new();
        queue.drain(&mut out);
        assert_eq!((out.len(), queue.lost()), (MAX_WAITING, 10));
        assert_eq!(out[0], DeviceFrame::Unplugged { device: 7 });
        assert!(matches!(out[1], DeviceFrame::State { t_us: 10, .. }));
    }

    #[test]
    fn buffers_come_back() {
        let queue = FrameQueue::new(None);
        let mut out = Vec::new();
        for t_us in 0..1000 {
            queue.push_state(0, t_us, &[touching(t_us)]);
            queue.drain(&mut out);
        }
        queue.drain(&mut out);
        let waiting = queue.lock();
        assert_eq!(waiting.spare.len(), SPARE_BUFFERS);
        assert!(waiting.spare.iter().all(|b| b.capacity() == MAX_CONTACTS));
    }
}
