//! Feature reports: what a touchscreen is asked once, and what it is told.

use hidreport::{Field, Report};

use super::descriptor::Bits;
use super::usage;

/// Contacts of a device that does not tell how many it reports, as in Linux.
pub const DEFAULT_MAX_CONTACTS: u32 = 10;

/// More contacts than this are not believed, as in Linux.
pub const MOST_CONTACTS: u32 = 250;

/// Input mode of a touchscreen that reports all its contacts.
const MULTI_TOUCH: u32 = 2;

/// Longest feature report, bytes; certification blobs have 257.
const MAX_BYTES: usize = 4096;

/// A feature report as a buffer for the device: the first byte is its number, 0 where reports have none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FeatureReport {
    /// Its number, 0 where the device does not number its reports.
    pub id: u8,
    /// Length of the buffer in bytes, with the number.
    pub bytes: usize,
    numbered: bool,
}

impl FeatureReport {
    /// The buffer with which the device is asked for the report.
    pub fn request(&self) -> Vec<u8> {
        let mut buffer = vec![0; self.bytes];
        buffer[0] = self.id;
        buffer
    }

    /// The answer of the device as a buffer like [`FeatureReport::request`]. Reports without a number come with or
    /// without a zero in front. `None` if it is another report, or empty.
    fn aligned(&self, answer: &[u8]) -> Option<Vec<u8>> {
        let mut buffer = self.request();
        let from = usize::from(!self.numbered && answer.len() < self.bytes);
        if answer.is_empty() || (self.numbered && answer[0] != self.id) {
            return None;
        }
        for (to, byte) in buffer[from..].iter_mut().zip(answer) {
            *to = *byte;
        }
        Some(buffer)
    }
}

/// One number in a feature report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FeatureField {
    /// The report.
    pub report: FeatureReport,
    /// Where the number stands in its buffer.
    pub bits: Bits,
    /// Largest value, as declared.
    pub declared_max: i64,
}

/// What can be asked of a touchscreen, and what it can be told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Features {
    /// How many contacts it reports at once. The descriptor only says how many bits that number has.
    pub contact_count_max: Option<FeatureField>,
    /// What it is to be: a mouse, or a touchscreen.
    pub input_mode: Option<FeatureField>,
    /// The blob by which Windows knows it. Some devices report one contact until they have been asked for it.
    pub certification: Option<FeatureReport>,
}

impl Features {
    /// The first field of each kind: devices that declare one twice listen to the first.
    pub(super) fn find<'a>(reports: impl Iterator<Item = &'a (impl Report + 'a)>) -> Self {
        let mut found = Self::default();
        for report in reports {
            let bytes = report.size_in_bytes();
            let numbered = report.report_id().is_some();
            let about = FeatureReport {
                id: report.report_id().map_or(0, |id| u8::from(&id)),
                bytes: bytes + usize::from(!numbered),
                numbered,
            };
            if about.bytes > MAX_BYTES {
                continue;
            }
            for field in report.fields() {
                found.take(about, field);
            }
        }
        found
    }

    fn take(&mut self, report: FeatureReport, field: &Field) {
        let (usage, max) = match field {
            Field::Variable(field) => (u32::from(field.usage), i32::from(field.logical_maximum)),
            Field::Array(field) => match field.usages().first() {
                Some(usage) => (u32::from(usage), i32::from(field.logical_maximum)),
                None => return,
            },
            Field::Constant(_) => return,
        };
        let start = field.bits().start + if report.numbered { 0 } else { 8 };
        let found = FeatureField {
            report,
            bits: Bits {
                start: start as u32,
                len: field.bits().len().clamp(1, 32) as u8,
                signed: false,
            },
            declared_max: i64::from(max),
        };
        match usage {
            usage::CONTACT_COUNT_MAXIMUM => self.contact_count_max = self.contact_count_max.or(Some(found)),
            usage::INPUT_MODE => self.input_mode = self.input_mode.or(Some(found)),
            usage::CERTIFICATION => self.certification = self.certification.or(Some(report)),
            _ => {}
        }
    }

    /// How many contacts the device reports at once, from its answer to the report of
    /// [`Features::contact_count_max`]; without one, from what it declares as far as that can be believed.
    pub fn max_contacts(&self, answer: Option<&[u8]>) -> u32 {
        let Some(field) = self.contact_count_max else {
            return DEFAULT_MAX_CONTACTS;
        };
        let told = answer
            .and_then(|answer| field.report.aligned(answer))
            .map_or(0, |buffer| field.bits.read(&buffer));
        let believable = |n: &i64| (1..=i64::from(MOST_CONTACTS)).contains(n);
        [told, field.declared_max]
            .into_iter()
            .find(believable)
            .map_or(DEFAULT_MAX_CONTACTS, |n| n as u32)
    }

    /// The buffer that makes the device a touchscreen, from what its report of [`Features::input_mode`] says now: all
    /// else in it, such as which of several devices is meant, stays. `None` where there is nothing to set.
    pub fn set_touch_mode(&self, answer: Option<&[u8]>) -> Option<Vec<u8>> {
        let field = self.input_mode?;
        let now = answer.and_then(|answer| field.report.aligned(answer));
        let mut buffer = now.unwrap_or_else(|| field.report.request());
        field.bits.write(&mut buffer, MULTI_TOUCH);
        Some(buffer)
    }
}
