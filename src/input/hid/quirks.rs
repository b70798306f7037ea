//! How devices depart from the rules, by the names that Linux gave these ways (`drivers/hid/hid-multitouch.c`).

use super::descriptor::{Descriptor, TouchReport};

/// One way of reporting contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quirk {
    /// `NOT_SEEN_MEANS_UP`: a slot whose tip is off is empty, and a contact that a frame does not name has lifted.
    NotSeenMeansUp,
    /// `VALID_IS_CONFIDENCE`: a slot whose confidence is off is empty. (So confidence tells nothing of palms.)
    ValidIsConfidence,
    /// `VALID_IS_INRANGE`: a slot that is not in range is empty.
    ValidIsInRange,
    /// `ALWAYS_VALID`: every slot up to the contact count names a contact; one whose tip is off has lifted.
    AlwaysValid,
    /// `SLOT_IS_CONTACTID`: ids count from 0 and stay below the most contacts; others are no contacts.
    SlotIsContactId,
    /// `SLOT_IS_CONTACTID_MINUS_ONE`: the same from 1.
    SlotIsContactIdMinusOne,
    /// `SLOT_IS_CONTACTNUMBER`: ids mean nothing; a contact is known by its place in the frame.
    SlotIsContactNumber,
    /// `CONTACT_CNT_ACCURATE`: slots beyond the contact count hold old or no data.
    ContactCountAccurate,
    /// `TOUCH_SIZE_SCALING`: width and height are twice as large as the finger.
    TouchSizeScaling,
    /// `NO_AREA`: width and height mean nothing.
    NoArea,
    /// `IGNORE_DUPLICATES`: of two slots of one frame with one id the first counts.
    IgnoreDuplicates,
    /// `FIX_CONST_CONTACT_ID`: the contact id is declared as padding and is none.
    FixConstContactId,
    /// `STICKY_FINGERS`: the device must name each contact again and again while it is down, and sometimes forgets to
    /// say that it lifted; see [`Habit`](super::habit::Habit).
    StickyFingers,
}

impl Quirk {
    /// All of them.
    pub const ALL: [Self; 13] = [
        Self::NotSeenMeansUp,
        Self::ValidIsConfidence,
        Self::ValidIsInRange,
        Self::AlwaysValid,
        Self::SlotIsContactId,
        Self::SlotIsContactIdMinusOne,
        Self::SlotIsContactNumber,
        Self::ContactCountAccurate,
        Self::TouchSizeScaling,
        Self::NoArea,
        Self::IgnoreDuplicates,
        Self::FixConstContactId,
        Self::StickyFingers,
    ];

    /// Its name in Linux.
    pub fn name(self) -> &'static str {
        match self {
            Self::NotSeenMeansUp => "NOT_SEEN_MEANS_UP",
            Self::ValidIsConfidence => "VALID_IS_CONFIDENCE",
            Self::ValidIsInRange => "VALID_IS_INRANGE",
            Self::AlwaysValid => "ALWAYS_VALID",
            Self::SlotIsContactId => "SLOT_IS_CONTACTID",
            Self::SlotIsContactIdMinusOne => "SLOT_IS_CONTACTID_MINUS_ONE",
            Self::SlotIsContactNumber => "SLOT_IS_CONTACTNUMBER",
            Self::ContactCountAccurate => "CONTACT_CNT_ACCURATE",
            Self::TouchSizeScaling => "TOUCH_SIZE_SCALING",
            Self::NoArea => "NO_AREA",
            Self::IgnoreDuplicates => "IGNORE_DUPLICATES",
            Self::FixConstContactId => "FIX_CONST_CONTACT_ID",
            Self::StickyFingers => "STICKY_FINGERS",
        }
    }
}

/// A set of quirks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Quirks(u16);

impl Quirks {
    /// The set of these.
    pub const fn of(quirks: &[Quirk]) -> Self {
        let mut set = 0;
        let mut i = 0;
        while i < quirks.len() {
            set |= 1 << quirks[i] as u16;
            i += 1;
        }
        Self(set)
    }

    /// Whether it is in the set.
    pub const fn has(self, quirk: Quirk) -> bool {
        self.0 & 1 << quirk as u16 != 0
    }

    /// Those of both sets.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Those in the set, in the order of [`Quirk::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Quirk> {
        Quirk::ALL.into_iter().filter(move |&quirk| self.has(quirk))
    }

    /// The quirks of a device: those of the list, else as its descriptor asks for.
    pub fn choose(vid: u16, pid: u16, descriptor: &Descriptor, max_contacts: u32) -> Self {
        let listed = LISTED.iter().find(|(v, p, _)| (*v, *p) == (vid, pid));
        let chosen = match (listed, &descriptor.touch) {
            (Some((.., quirks)), _) => *quirks,
            (None, Ok(report)) => by_report(report, max_contacts),
            (None, Err(_)) => Self::default(),
        };
        if descriptor.constant_ids {
            chosen.and(Self::of(&[Quirk::FixConstContactId]))
        } else {
            chosen
        }
    }
}

/// What the shape of the report tells.
fn by_report(report: &TouchReport, max_contacts: u32) -> Quirks {
    use Quirk::{
        AlwaysValid, ContactCountAccurate, IgnoreDuplicates, NotSeenMeansUp, SlotIsContactNumber,
        StickyFingers,
    };
    let slots = report.slots.len();
    let rules = match (report.count, report.scan_time) {
        // Scan time came with the rules of Windows 8: every contact is in every frame until it has lifted.
        (Some(_), Some(_)) => {
            Quirks::of(&[AlwaysValid, ContactCountAccurate, IgnoreDuplicates, StickyFingers])
        }
        (Some(_), None) => Quirks::of(&[AlwaysValid, ContactCountAccurate]),
        // Several slots and no count: unless there can be more contacts, each report is the whole state.
        (None, _) if slots > 1 && max_contacts <= slots as u32 => Quirks::of(&[NotSeenMeansUp]),
        // A contact in each report, one after the other.
        (None, _) => Quirks::of(&[AlwaysValid]),
    };
    if report.slots.iter().any(|slot| slot.id.is_none()) {
        rules.and(Quirks::of(&[SlotIsContactNumber]))
    } else {
        rules
    }
}

/// Devices whose descriptors do not tell enough: maker, product, and how they report, from the table of devices and
/// classes in Linux' `drivers/hid/hid-multitouch.c`.
const LISTED: [(u16, u16, Quirks); 10] = {
    use Quirk::{
        AlwaysValid, NoArea, NotSeenMeansUp, SlotIsContactId, SlotIsContactIdMinusOne, SlotIsContactNumber,
        TouchSizeScaling, ValidIsConfidence, ValidIsInRange,
    };
    const M3: Quirks = Quirks::of(&[ValidIsConfidence, SlotIsContactId, TouchSizeScaling]);
    const EGALAX: Quirks = Quirks::of(&[SlotIsContactId, ValidIsInRange]);
    const LUMIO: Quirks = Quirks::of(&[ValidIsConfidence, SlotIsContactIdMinusOne]);
    [
        // 3M, two generations.
        (0x0596, 0x0500, M3),
        (0x0596, 0x0506, M3),
        // CVTouch.
        (0x1ff7, 0x0013, Quirks::of(&[NotSeenMeansUp])),
        // eGalax, capacitive.
        (0x0eef, 0x72fa, EGALAX),
        (0x0eef, 0xa001, EGALAX),
        // FlatFrog.
        (0x25b5, 0x0002, Quirks::of(&[NotSeenMeansUp, NoArea])),
        // FocalTech.
        (0x10c4, 0x81b9, Quirks::of(&[AlwaysValid])),
        // Lumio CrystalTouch, two and one contact in each report.
        (0x202e, 0x0006, LUMIO),
        (0x202e, 0x0007, LUMIO),
        // PixArt optical.
        (0x093a, 0x8002, Quirks::of(&[ValidIsInRange, SlotIsContactNumber])),
    ]
};
