//! Contacts: what touches the table, as every source reports it.

use glam::DVec2;

use super::command::Command;

/// Most contacts down at once, over all sources; what lands beyond that is not seen.
pub const MAX_CONTACTS: usize = 256;

/// Farthest coordinate that is believed, millimetres: twice the largest table, so that fingers may leave its edge.
pub const MAX_COORDINATE_MM: f64 = 20_000.0;

/// `mm` on the raster of gesture files, 0.01 mm. A recorder that also plays live rounds first, so that both are equal.
pub fn quantise_mm(mm: f64) -> f64 {
    // Adding zero turns −0 into 0, which the file has no sign for.
    (mm * 100.0).round() / 100.0 + 0.0
}

/// Where a contact comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Source {
    /// Touch events of the window system.
    Window,
    /// The mouse, standing in for a finger.
    Mouse,
    /// A raw HID touchscreen.
    Hid,
    /// A TUIO sender.
    Tuio,
    /// A gesture file.
    File,
}

/// Names one contact for as long as it is down, and never another one after that: sources reuse their ids, so each
/// `Down` raises the generation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ContactKey {
    /// Where it comes from.
    pub source: Source,
    /// Which device of that source.
    pub device: u16,
    /// The source's own id, unique while the contact is down.
    pub id: u64,
    /// How often this id went down before.
    pub generation: u32,
}

impl ContactKey {
    /// The name the source itself gives: equal for contacts that follow each other under one id.
    pub fn slot(self) -> (Source, u16, u64) {
        (self.source, self.device, self.id)
    }
}

/// One contact at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Its name.
    pub key: ContactKey,
    /// Where it is, table millimetres (x right, y down).
    pub position: DVec2,
    /// Width and height of the touching area in millimetres, where the device tells.
    pub size_mm: Option<DVec2>,
    /// The device's confidence that this is a finger, 0 (palm, unsure) to 1, where it tells.
    pub confidence: Option<f32>,
}

impl Contact {
    /// The contact as a gesture file gives it back: positions and sizes on the file's raster, confidence in thousandths,
    /// and nothing where a device tells nonsense. Who plays this live can replay it to the bit.
    #[must_use]
    pub fn as_recorded(self) -> Self {
        let millimetres = |mm: DVec2| DVec2::new(quantise_mm(mm.x), quantise_mm(mm.y));
        let size = self.size_mm.filter(|size| size.is_finite());
        let confidence = self.confidence.filter(|c| (0.0..=1.0).contains(c));
        Self {
            key: self.key,
            position: millimetres(self.position),
            size_mm: size.map(|size| millimetres(size.clamp(DVec2::ZERO, DVec2::splat(MAX_COORDINATE_MM)))),
            confidence: confidence.map(|c| ((f64::from(c) * 1000.0).round() / 1000.0) as f32),
        }
    }
}

/// What happens to a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Phase {
    /// It lands.
    Down,
    /// It moves (or its size or confidence changes).
    Move,
    /// It lifts.
    Up,
    /// It is withdrawn: it was none, or its device went away.
    Cancel,
}

impl Phase {
    /// Place in the canonical order of one moment: up, cancel, move, down. An id that is set free can so land again
    /// at the same moment; a contact that lands and lifts at once needs two frames of equal time.
    pub fn order(self) -> u8 {
        match self {
            Self::Up => 0,
            Self::Cancel => 1,
            Self::Move => 2,
            Self::Down => 3,
        }
    }
}

/// A contact and what happens to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactEvent {
    /// What happens.
    pub phase: Phase,
    /// The contact as it is after that (for `Up` and `Cancel`: as it last was).
    pub contact: Contact,
}

/// All that happens at one moment of session time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InputFrame {
    /// Session time in microseconds (gesture files carry milliseconds with at most three decimals).
    pub t_us: u64,
    /// What the contacts do, in the order of the file or device.
    pub events: Vec<ContactEvent>,
    /// What visitors do outside the contacts.
    pub commands: Vec<Command>,
}

/// A long side of the table. Tools, undo and menus belong to a side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// The upper half.
    North,
    /// The lower half.
    South,
}

impl Side {
    /// The side of the table that `position` (mm) is nearer to.
    pub fn of(position: DVec2, size_mm: DVec2) -> Self {
        if position.y < size_mm.y / 2.0 {
            Self::North
        } else {
            Self::South
        }
    }

    /// The side across the table.
    #[must_use]
    pub fn opposite(self) -> Self {
        match self {
            Self::North => Self::South,
            Self::South => Self::North,
        }
    }
}
