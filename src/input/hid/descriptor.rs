//! Report descriptor → where in which report the contacts are.

use glam::DVec2;
use hidreport::{Collection, CollectionType, Field, Report, ReportDescriptor, VariableField};

use super::feature::Features;
use super::prepare::{DescriptorError, prepare};
use super::usage;

/// A surface outside this is not believed, mm: smaller is a telephone's, larger a wall's.
const BELIEVABLE_MM: std::ops::RangeInclusive<f64> = 30.0..=6000.0;

/// Nor is one that is so much longer than wide.
const MOST_OBLONG: f64 = 10.0;

/// Slots of one report at most; no report is long enough for more that mean anything.
const MAX_SLOTS: usize = 256;

/// Where a number stands in a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bits {
    /// First bit, counted from the start of the report (its id included).
    pub start: u32,
    /// How many, 1 to 32.
    pub len: u8,
    /// Whether the number may be negative.
    pub signed: bool,
}

impl Bits {
    /// The number; bits beyond the end of the report are 0.
    pub fn read(self, report: &[u8]) -> i64 {
        let first = (self.start / 8) as usize;
        let end = (self.start as usize + usize::from(self.len)).div_ceil(8);
        let bytes = report.get(first..end.min(report.len())).unwrap_or_default();
        let mut value = 0_u64;
        for &byte in bytes.iter().rev() {
            value = value << 8 | u64::from(byte);
        }
        let unused = 64 - u32::from(self.len);
        let value = value >> (self.start % 8) << unused;
        if self.signed {
            (value as i64) >> unused
        } else {
            (value >> unused) as i64
        }
    }

    /// Writes a number; what does not fit is cut off, and bits beyond the end of the report stay away.
    pub fn write(self, report: &mut [u8], value: u32) {
        for bit in 0..u32::from(self.len) {
            let at = self.start + bit;
            if let Some(byte) = report.get_mut((at / 8) as usize) {
                *byte = *byte & !(1 << (at % 8)) | ((value >> bit & 1) as u8) << (at % 8);
            }
        }
    }
}

/// A number with a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// Where it stands.
    pub bits: Bits,
    /// Smallest value.
    pub min: i64,
    /// Largest value, above `min`.
    pub max: i64,
    /// Millimetres from `min` to `max`, where the device says something of the kind.
    pub extent_mm: Option<f64>,
}

impl Axis {
    fn new(field: &VariableField) -> Option<Self> {
        let bits = bits(field)?;
        let (min, max) = logical_range(field, bits);
        Some(Self {
            bits,
            min,
            max,
            extent_mm: extent_mm(field),
        })
    }

    /// Largest less smallest value.
    pub fn range(&self) -> f64 {
        (self.max - self.min) as f64
    }
}

/// Where the numbers of one contact stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slot {
    /// Where the finger is: from left to right. (Of two, the first is the touched point, the second the middle of
    /// the touching area.)
    pub x: Axis,
    /// From top to bottom.
    pub y: Axis,
    /// The contact's name.
    pub id: Option<Bits>,
    /// Whether it touches.
    pub tip: Option<Bits>,
    /// Whether the slot holds a contact at all, or one that hovers.
    pub in_range: Option<Bits>,
    /// Whether the device takes it for a finger.
    pub confidence: Option<Bits>,
    /// Width of the touching area.
    pub width: Option<Axis>,
    /// Height of the touching area.
    pub height: Option<Axis>,
}

/// The report that carries the contacts.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchReport {
    /// Its number, the first byte, where the device numbers its reports.
    pub id: Option<u8>,
    /// Its length in bytes, with its number.
    pub bytes: usize,
    /// The contacts it has room for, at least one.
    pub slots: Vec<Slot>,
    /// How many contacts the frame has.
    pub count: Option<Bits>,
    /// When the device saw them, and the largest value.
    pub scan_time: Option<(Bits, i64)>,
}

impl TouchReport {
    /// Size of the surface, if the device tells one that can be believed.
    pub fn physical_mm(&self) -> Option<DVec2> {
        let slot = self.slots.first()?;
        let size = DVec2::new(slot.x.extent_mm?, slot.y.extent_mm?);
        let fits = BELIEVABLE_MM.contains(&size.x) && BELIEVABLE_MM.contains(&size.y);
        (fits && size.max_element() <= MOST_OBLONG * size.min_element()).then_some(size)
    }

    /// The more, the rather this is the report to listen to: devices also have reports for one finger, or for hosts
    /// that know less.
    fn rank(&self) -> (usize, usize, bool, bool) {
        let ids = self.slots.iter().filter(|slot| slot.id.is_some()).count();
        let tells_confidence = self.slots.iter().all(|slot| slot.confidence.is_some());
        (
            ids,
            self.slots.len(),
            self.physical_mm().is_some(),
            tells_confidence,
        )
    }
}

/// What a device is when it is no touchscreen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// A touchpad moves a pointer; where it is touched is no place on a screen.
    Touchpad,
    /// A pen, or a tablet for one.
    Pen,
    /// A mouse or another pointer.
    Mouse,
    /// It calls itself a touchscreen, but no report says where it is touched.
    NoPositions,
    /// Nothing of the kind.
    NoDigitizer,
}

/// All that Orogen takes from a report descriptor.
#[derive(Clone, Debug)]
pub struct Descriptor {
    /// Usages of the top-level collections (page in the upper half), in their order.
    pub applications: Vec<u32>,
    /// The report with the contacts, or what the device is instead.
    pub touch: Result<TouchReport, Refusal>,
    /// What can be asked of the device and set.
    pub features: Features,
    /// Contact ids were declared as padding (see
    /// [`Quirk::FixConstContactId`](super::quirks::Quirk::FixConstContactId)).
    pub constant_ids: bool,
}

impl Descriptor {
    /// Reads a descriptor.
    ///
    /// # Errors
    /// [`DescriptorError`] when the bytes are none.
    pub fn parse(bytes: &[u8]) -> Result<Self, DescriptorError> {
        let prepared = prepare(bytes)?;
        let parsed = ReportDescriptor::try_from(&prepared.bytes).map_err(|error| {
            let offset = match &error {
                hidreport::ParserError::InvalidData { offset, .. } => *offset,
                _ => 0,
            };
            let problem = format!("expected a HID report descriptor: {error}");
            DescriptorError::Item { offset, problem }
        })?;
        let applications = applications(&parsed);
        let candidates = parsed.input_reports().iter().filter_map(touch_report);
        let most = |best: TouchReport, next: TouchReport| if next.rank() > best.rank() { next } else { best };
        let touch = candidates.reduce(most).ok_or_else(|| refusal(&applications));
        Ok(Self {
            applications,
            touch,
            features: Features::find(parsed.feature_reports().iter()),
            constant_ids: prepared.constant_ids,
        })
    }
}

fn refusal(applications: &[u32]) -> Refusal {
    let has = |usage: u32| applications.contains(&usage);
    if has(usage::TOUCH_PAD) {
        Refusal::Touchpad
    } else if has(usage::TOUCH_SCREEN) {
        Refusal::NoPositions
    } else if has(usage::PEN) || has(usage::DIGITIZER) {
        Refusal::Pen
    } else if has(usage::MOUSE) || has(usage::POINTER) {
        Refusal::Mouse
    } else {
        Refusal::NoDigitizer
    }
}

fn applications(parsed: &ReportDescriptor) -> Vec<u32> {
    let fields = parsed.input_reports().iter().flat_map(Report::fields);
    let features = parsed.feature_reports().iter().flat_map(Report::fields);
    let mut found = Vec::new();
    for usage in fields.chain(features).filter_map(application) {
        if !found.contains(&usage) {
            found.push(usage);
        }
    }
    found
}

/// Usage of the outermost collection.
fn application(field: &Field) -> Option<u32> {
    let usages = field.collections().first()?.usages();
    usages.first().map(u32::from)
}

/// The report as one that carries contacts of a touchscreen.
fn touch_report(report: &impl Report) -> Option<TouchReport> {
    let mut slots = Vec::new();
    let mut draft = Draft::default();
    let mut count = None;
    let mut scan_time = None;
    for field in report.fields() {
        let Field::Variable(variable) = field else {
            continue;
        };
        if application(field) != Some(usage::TOUCH_SCREEN) {
            continue;
        }
        match u32::from(variable.usage) {
            usage::CONTACT_COUNT => count = count.or(unsigned(variable)),
            usage::SCAN_TIME => {
                scan_time = scan_time.or_else(|| {
                    let bits = unsigned(variable)?;
                    Some((bits, logical_range(variable, bits).1))
                });
            }
            usage if usage::OF_CONTACT.contains(&usage) => draft.take(variable, usage, &mut slots),
            _ => {}
        }
    }
    slots.extend(draft.finish());
    slots.truncate(MAX_SLOTS);
    if slots.is_empty() {
        return None;
    }
    Some(TouchReport {
        id: report.report_id().map(u8::from),
        bytes: report.size_in_bytes(),
        slots,
        count,
        scan_time,
    })
}

/// A contact's fields while they are gathered. They belong together as long as none of them comes again and the
/// collection is the same.
#[derive(Default)]
struct Draft<'a> {
    collection: Option<&'a Collection>,
    before: Option<u32>,
    x: Option<Axis>,
    y: Option<Axis>,
    width: Option<Axis>,
    height: Option<Axis>,
    id: Option<Bits>,
    tip: Option<Bits>,
    in_range: Option<Bits>,
    confidence: Option<Bits>,
}

impl<'a> Draft<'a> {
    fn take(&mut self, field: &'a VariableField, usage: u32, slots: &mut Vec<Slot>) {
        let collection = finger(field);
        if self.before.is_some() && collection != self.collection {
            self.close(slots);
        } else if self.before == Some(usage) {
            // The second of two positions of one contact: the middle of the touching area.
            return;
        } else if self.has(usage) {
            if self.x.is_none() || self.y.is_none() {
                return;
            }
            self.close(slots);
        }
        self.collection = collection;
        self.before = Some(usage);
        match usage {
            usage::X => self.x = Axis::new(field),
            usage::Y => self.y = Axis::new(field),
            usage::WIDTH => self.width = Axis::new(field),
            usage::HEIGHT => self.height = Axis::new(field),
            usage::CONTACT_ID => self.id = unsigned(field),
            usage::TIP_SWITCH => self.tip = unsigned(field),
            usage::IN_RANGE => self.in_range = unsigned(field),
            _ => self.confidence = unsigned(field),
        }
    }

    fn has(&self, usage: u32) -> bool {
        match usage {
            usage::X => self.x.is_some(),
            usage::Y => self.y.is_some(),
            usage::WIDTH => self.width.is_some(),
            usage::HEIGHT => self.height.is_some(),
            usage::CONTACT_ID => self.id.is_some(),
            usage::TIP_SWITCH => self.tip.is_some(),
            usage::IN_RANGE => self.in_range.is_some(),
            _ => self.confidence.is_some(),
        }
    }

    fn close(&mut self, slots: &mut Vec<Slot>) {
        slots.extend(std::mem::take(self).finish());
    }

    /// The contact, if it says where it is and whether it is there.
    fn finish(self) -> Option<Slot> {
        let tells = self.tip.or(self.in_range).or(self.confidence).is_some();
        Some(Slot {
            x: self.x?,
            y: self.y?,
            id: self.id,
            tip: self.tip,
            in_range: self.in_range,
            confidence: self.confidence,
            width: self.width,
            height: self.height,
        })
        .filter(|_| tells)
    }
}

/// The collection that holds all of one contact: the innermost logical one.
fn finger(field: &VariableField) -> Option<&Collection> {
    let logical = |c: &&Collection| matches!(c.collection_type(), CollectionType::Logical);
    field.collections.iter().rev().find(logical)
}

/// Where the field stands; the lower 32 bits of wider ones.
fn bits(field: &VariableField) -> Option<Bits> {
    Some(Bits {
        start: u32::try_from(field.bits.start).ok()?,
        len: field.bits.len().clamp(1, 32) as u8,
        signed: field.is_signed(),
    })
}

/// The field as a number that is never negative, whatever it declares.
fn unsigned(field: &VariableField) -> Option<Bits> {
    bits(field).map(|bits| Bits {
        signed: false,
        ..bits
    })
}

/// The logical range; where it is none, all that the bits can hold.
fn logical_range(field: &VariableField, bits: Bits) -> (i64, i64) {
    let min = i64::from(i32::from(field.logical_minimum));
    let max = i64::from(i32::from(field.logical_maximum));
    if max > min {
        (min, max)
    } else {
        (0, (1_i64 << bits.len) - 1)
    }
}

/// Physical extent in millimetres, where the unit is a length.
fn extent_mm(field: &VariableField) -> Option<f64> {
    let per_unit = match u32::from(field.unit?) {
        0x11 => 10.0,
        0x13 => 25.4,
        _ => return None,
    };
    let exponent = field.unit_exponent.map_or(0, |e| e.exponent());
    let min = f64::from(i32::from(field.physical_minimum?));
    let max = f64::from(i32::from(field.physical_maximum?));
    let extent = (max - min) * per_unit * 10_f64.powi(i32::from(exponent));
    (extent > 0.0 && extent.is_finite()).then_some(extent)
}
