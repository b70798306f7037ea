//! Touches, mouse and pointer of a window → contacts.
//!
//! Window systems leave gaps: ids are used again at once, ends get lost when a window loses its focus or a device its
//! cable, and the first finger also moves the pointer. [`WindowInput`] closes them: what comes out is well formed
//! (each contact lands, moves and then lifts or is cancelled, once, and no key names two contacts), whatever goes in.
//!
//! * Each down gets a new generation; a second down of an id that is down cancels the first.
//! * The mouse is a finger, but not while touches are down nor for half a second after, when it is their shadow.
//! * Shift and a click plant a resting hand of five fingers, which stays until Shift and a click on it lift it.
//! * Positions are turned from window pixels into table millimetres here, on the raster of gesture files, so that a
//!   recording of the session is the session.

use std::collections::BTreeMap;

use glam::{DAffine2, DVec2};

use crate::gesture::contact::{
    Contact, ContactEvent, ContactKey, MAX_CONTACTS, MAX_COORDINATE_MM, Phase, Source, quantise_mm,
};
use crate::gesture::params::RELAXED_HAND_MM;
use crate::settings::Orientation;

/// How long after the last touch the mouse is still taken for its shadow, µs.
const SHADOW_US: u64 = 500_000;

/// A click this near to the middle of a planted hand lifts it, mm.
const PLANTED_REACH_MM: f64 = 75.0;

/// The mouse's finger, and the fingers of planted hands.
const FINGER_DEVICE: u16 = 0;
const PLANTED_DEVICE: u16 = 1;

/// What a window system says of a touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TouchPhase {
    /// It begins.
    Started,
    /// It moves.
    Moved,
    /// It ends.
    Ended,
    /// It was none.
    Cancelled,
}

/// How window pixels lie on the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowMap {
    /// Touch pixels → table mm.
    touch: DAffine2,
    /// Pointer pixels → table mm. Pointers are moved by eye, so they are never turned.
    pointer: DAffine2,
    /// Parts of a touching surface that covers the window → table mm.
    surface: DAffine2,
    /// Parts of the window → table mm.
    window: DAffine2,
}

impl WindowMap {
    /// The map of a window of `window_px` whose land fills the rectangle from `land_px.0`, of size `land_px.1`, and
    /// shows a table of `size_mm`. A touch device that lies on the window turned is turned back, and then brought to
    /// its place by `calibration` (parts of the window).
    pub fn new(
        window_px: DVec2,
        land_px: (DVec2, DVec2),
        size_mm: DVec2,
        orientation: Orientation,
        calibration: Option<DAffine2>,
    ) -> Self {
        let per_px = size_mm / land_px.1;
        let pointer = DAffine2::from_scale(per_px) * DAffine2::from_translation(-land_px.0);
        let window = pointer * DAffine2::from_scale(window_px);
        let surface = window * calibration.unwrap_or(DAffine2::IDENTITY) * orientation.affine();
        let touch = surface * DAffine2::from_scale(DVec2::ONE / window_px);
        Self {
            touch,
            pointer,
            surface,
            window,
        }
    }

    /// Parts of a touching surface (x right, y down) that covers the window → table mm.
    pub fn surface(&self) -> DAffine2 {
        self.surface
    }

    /// Parts of the window → table mm.
    pub fn window(&self) -> DAffine2 {
        self.window
    }
}

/// What was let pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WindowCounts {
    /// Moves and ends of touches that are not down, and downs with coordinates that are no place.
    pub unknown: u64,
    /// Downs of touches that were down.
    pub doubled: u64,
    /// Downs beyond [`MAX_CONTACTS`].
    pub over_cap: u64,
    /// Clicks while touches were down or had just been.
    pub shadows: u64,
    /// Contacts that were withdrawn with their window or device.
    pub withdrawn: u64,
}

type Slot = (Source, u16, u64);

/// The contacts of a window. Everything appends to `out` what it means, in order; each event is a moment of its own
/// (a contact that lands and lifts at once must not share an input frame).
#[derive(Clone, Debug)]
pub struct WindowInput {
    map: WindowMap,
    down: BTreeMap<Slot, Contact>,
    /// Downs so far: the next generation. One count serves all ids, since window systems with ever new ids would
    /// let a count for each grow without end.
    downs: u32,
    pointer: Option<DVec2>,
    /// Middle of each planted hand, mm, by its first id.
    planted: BTreeMap<u64, DVec2>,
    next_planted: u64,
    last_touch_us: Option<u64>,
    counts: WindowCounts,
}

impl WindowInput {
    /// Nothing is down.
    pub fn new(map: WindowMap) -> Self {
        Self {
            map,
            down: BTreeMap::new(),
            downs: 0,
            pointer: None,
            planted: BTreeMap::new(),
            next_planted: 0,
            last_touch_us: None,
            counts: WindowCounts::default(),
        }
    }

    /// What was let pass so far.
    pub fn counts(&self) -> WindowCounts {
        self.counts
    }

    /// Contacts that are down, in the order of their keys.
    pub fn contacts(&self) -> impl Iterator<Item = &Contact> {
        self.down.values()
    }

    /// Where the pointer is, table mm; `None` before it has moved and after it has left.
    pub fn pointer_mm(&self) -> Option<DVec2> {
        self.pointer
    }

    /// The map in use.
    pub fn map(&self) -> &WindowMap {
        &self.map
    }

    /// A touch that another source has told: the pointer that moves along is its shadow.
    pub fn shadowed(&mut self, now_us: u64) {
        self.last_touch_us = Some(now_us);
    }

    /// Another size, monitor or orientation. If that moves anything, all contacts are withdrawn.
    pub fn set_map(&mut self, map: WindowMap, out: &mut Vec<ContactEvent>) {
        if self.map != map {
            self.cancel_all(out);
            self.map = map;
            self.pointer = None;
        }
    }

    /// A touch of a device, at window pixels.
    pub fn touch(
        &mut self,
        (device, id): (u16, u64),
        phase: TouchPhase,
        px: DVec2,
        now_us: u64,
        out: &mut Vec<ContactEvent>,
    ) {
        let slot = (Source::Window, device, id);
        let at = place(self.map.touch, px);
        self.last_touch_us = Some(now_us);
        match phase {
            TouchPhase::Started => {
                // The pointer that the first finger pulls along is no second finger.
                self.end((Source::Mouse, FINGER_DEVICE, 0), Phase::Cancel, out);
                if self.down.contains_key(&slot) {
                    self.counts.doubled += 1;
                    self.end(slot, Phase::Cancel, out);
                }
                match at {
                    Some(at) => self.land(slot, at, out),
                    None => self.counts.unknown += 1,
                }
            }
            TouchPhase::Moved => {
                if !self.down.contains_key(&slot) {
                    self.counts.unknown += 1;
                } else if let Some(at) = at {
                    self.shift(slot, at, out);
                }
            }
            TouchPhase::Ended | TouchPhase::Cancelled => {
                let end = if phase == TouchPhase::Ended {
                    Phase::Up
                } else {
                    Phase::Cancel
                };
                if !self.end(slot, end, out) {
                    self.counts.unknown += 1;
                }
            }
        }
    }

    /// The pointer is at these window pixels.
    pub fn pointer_moved(&mut self, px: DVec2, out: &mut Vec<ContactEvent>) {
        let Some(at) = place(self.map.pointer, px) else {
            return;
        };
        self.pointer = Some(at);
        let slot = (Source::Mouse, FINGER_DEVICE, 0);
        if self.down.contains_key(&slot) {
            self.shift(slot, at, out);
        }
    }

    /// The pointer has left the window. A finger that the mouse holds down stays: it may come back.
    pub fn pointer_left(&mut self) {
        self.pointer = None;
    }

    /// The mouse's button: a finger where the pointer is; with Shift a resting hand is planted there, or lifted.
    pub fn button(&mut self, pressed: bool, shift: bool, now_us: u64, out: &mut Vec<ContactEvent>) {
        let slot = (Source::Mouse, FINGER_DEVICE, 0);
        if !pressed {
            self.end(slot, Phase::Up, out);
            return;
        }
        let Some(at) = self.pointer else {
            self.counts.unknown += 1;
            return;
        };
        let touched = self.down.keys().any(|slot| slot.0 == Source::Window);
        let recent = |last: u64| now_us.saturating_sub(last) < SHADOW_US;
        if touched || self.last_touch_us.is_some_and(recent) {
            self.counts.shadows += 1;
        } else if shift {
            self.plant_or_lift(at, out);
        } else {
            self.end(slot, Phase::Cancel, out);
            self.land(slot, at, out);
        }
    }

    /// Lifts all planted hands.
    pub fn lift_all(&mut self, out: &mut Vec<ContactEvent>) {
        while let Some((first, _)) = self.planted.pop_first() {
            self.lift_planted(first, out);
        }
    }

    /// Withdraws all contacts: the window has lost its focus, moved to another monitor, or starts afresh.
    pub fn cancel_all(&mut self, out: &mut Vec<ContactEvent>) {
        self.planted.clear();
        self.withdraw(|_| true, out);
    }

    /// Withdraws all touches: they are heard from another source. The mouse's stay.
    pub fn withdraw_touches(&mut self, out: &mut Vec<ContactEvent>) {
        self.withdraw(|slot| slot.0 == Source::Window, out);
    }

    /// Withdraws the touches of a device that is gone.
    pub fn device_removed(&mut self, device: u16, out: &mut Vec<ContactEvent>) {
        self.withdraw(|slot| slot.0 == Source::Window && slot.1 == device, out);
    }

    fn withdraw(&mut self, which: impl Fn(&Slot) -> bool, out: &mut Vec<ContactEvent>) {
        let slots: Vec<Slot> = self.down.keys().copied().filter(which).collect();
        self.counts.withdrawn += slots.len() as u64;
        for slot in slots {
            self.end(slot, Phase::Cancel, out);
        }
    }

    fn plant_or_lift(&mut self, at: DVec2, out: &mut Vec<ContactEvent>) {
        let near = self
            .planted
            .iter()
            .map(|(&first, middle)| (middle.distance(at), first))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .filter(|(distance, _)| *distance <= PLANTED_REACH_MM);
        if let Some((_, first)) = near {
            self.planted.remove(&first);
            self.lift_planted(first, out);
            return;
        }
        if self.down.len() + RELAXED_HAND_MM.len() > MAX_CONTACTS {
            self.counts.over_cap += 1;
            return;
        }
        let first = self.next_planted;
        self.next_planted += RELAXED_HAND_MM.len() as u64;
        self.planted.insert(first, at);
        for (id, offset) in (first..).zip(RELAXED_HAND_MM) {
            self.land((Source::Mouse, PLANTED_DEVICE, id), on_raster(at + offset), out);
        }
    }

    fn lift_planted(&mut self, first: u64, out: &mut Vec<ContactEvent>) {
        for id in first..first + RELAXED_HAND_MM.len() as u64 {
            self.end((Source::Mouse, PLANTED_DEVICE, id), Phase::Up, out);
        }
    }

    fn land(&mut self, slot: Slot, position: DVec2, out: &mut Vec<ContactEvent>) {
        if self.down.len() >= MAX_CONTACTS {
            self.counts.over_cap += 1;
            return;
        }
        let (source, device, id) = slot;
        let contact = Contact {
            key: ContactKey {
                source,
                device,
                id,
                generation: self.downs,
            },
            position,
            size_mm: None,
            confidence: None,
        };
        self.downs = self.downs.wrapping_add(1);
        self.down.insert(slot, contact);
        out.push(ContactEvent {
            phase: Phase::Down,
            contact,
        });
    }

    fn shift(&mut self, slot: Slot, position: DVec2, out: &mut Vec<ContactEvent>) {
        if let Some(contact) = self.down.get_mut(&slot)
            && contact.position != position
        {
            contact.position = position;
            out.push(ContactEvent {
                phase: Phase::Move,
                contact: *contact,
            });
        }
    }

    /// False when it is not down.
    fn end(&mut self, slot: Slot, phase: Phase, out: &mut Vec<ContactEvent>) -> bool {
        let contact = self.down.remove(&slot);
        out.extend(contact.map(|contact| ContactEvent { phase, contact }));
        contact.is_some()
    }
}

/// Where pixels are on the table; `None` for what is no place.
fn place(map: DAffine2, px: DVec2) -> Option<DVec2> {
    let at = map.transform_point2(px);
    (at.is_finite() && at.abs().max_element() <= MAX_COORDINATE_MM).then(|| on_raster(at))
}

fn on_raster(at: DVec2) -> DVec2 {
    DVec2::new(quantise_mm(at.x), quantise_mm(at.y))
}
