//! What a report descriptor comes to: for tools as one object, for people as a page.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::Serialize;

use super::descriptor::{Axis, Bits, Descriptor, Refusal, Slot, TouchReport};
use super::quirks::Quirks;

/// The facts of a device.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Facts {
    /// Whether Orogen can listen to it.
    pub touchscreen: bool,
    /// Why, or why not.
    pub reason: String,
    /// Contacts in one report; 0 when it is no touchscreen.
    pub slots: usize,
    /// Most contacts at once: as the device says when asked, else as far as its descriptor can be believed; 0 when it
    /// is no touchscreen.
    pub max_contacts: u32,
    /// What the report tells, and how often (fields of a contact: once for each slot).
    pub fields: BTreeMap<&'static str, usize>,
    /// Length of the report in bytes, with its number.
    pub report_bytes: usize,
    /// Width and height of the surface in millimetres, where that can be believed.
    pub physical_mm: Option<[f64; 2]>,
}

impl Facts {
    /// The facts of a device of which `max_contacts` are known.
    pub fn new(descriptor: &Descriptor, max_contacts: u32) -> Self {
        let report = match &descriptor.touch {
            Ok(report) => report,
            Err(refusal) => {
                return Self {
                    touchscreen: false,
                    reason: refusal.to_string(),
                    slots: 0,
                    max_contacts: 0,
                    fields: BTreeMap::new(),
                    report_bytes: 0,
                    physical_mm: None,
                };
            }
        };
        let slots = report.slots.len();
        let max_contacts = max_contacts.max(slots as u32);
        Self {
            touchscreen: true,
            reason: packing(report, max_contacts),
            slots,
            max_contacts,
            fields: fields(report),
            report_bytes: report.bytes,
            physical_mm: report.physical_mm().map(|size| size.to_array()),
        }
    }
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Touchpad => {
                "a touchpad: it moves a pointer, and where it is touched is no place on a screen"
            }
            Self::Pen => "a pen or its tablet: Orogen is played with fingers",
            Self::Mouse => "a mouse: the window system already turns it into one finger",
            Self::NoPositions => "it calls itself a touchscreen, but no report says where it is touched",
            Self::NoDigitizer => "no touchscreen: nothing in it reports touches",
        })
    }
}

/// How the contacts come.
fn packing(report: &TouchReport, max_contacts: u32) -> String {
    let slots = report.slots.len() as u32;
    let of = if slots == 1 { "contact" } else { "contacts" };
    match report.count {
        _ if slots >= max_contacts => format!("a touchscreen: all {slots} {of} in one report"),
        Some(_) => format!(
            "a touchscreen: {slots} {of} in each report, up to {max_contacts} in {} reports",
            max_contacts.div_ceil(slots)
        ),
        None => format!("a touchscreen: {slots} {of} in each report, one report after the other"),
    }
}

/// The numbers of one slot by name; those with a range are axes.
fn of_slot(slot: &Slot) -> Vec<(&'static str, Bits, Option<Axis>)> {
    let flag = |name, bits: Option<Bits>| bits.map(|bits| (name, bits, None));
    let axis = |name, axis: Option<Axis>| axis.map(|axis| (name, axis.bits, Some(axis)));
    let mut found: Vec<_> = [
        flag("tip", slot.tip),
        flag("in_range", slot.in_range),
        flag("confidence", slot.confidence),
        flag("contact_id", slot.id),
        axis("x", Some(slot.x)),
        axis("y", Some(slot.y)),
        axis("width", slot.width),
        axis("height", slot.height),
    ]
    .into_iter()
    .flatten()
    .collect();
    found.sort_by_key(|(_, bits, _)| bits.start);
    found
}

fn of_frame(report: &TouchReport) -> Vec<(&'static str, Bits)> {
    let count = report.count.map(|bits| ("contact_count", bits));
    let time = report.scan_time.map(|(bits, _)| ("scan_time", bits));
    let mut found: Vec<_> = count.into_iter().chain(time).collect();
    found.sort_by_key(|(_, bits)| bits.start);
    found
}

fn fields(report: &TouchReport) -> BTreeMap<&'static str, usize> {
    let mut fields = BTreeMap::new();
    for (name, ..) in report.slots.iter().flat_map(of_slot) {
        *fields.entry(name).or_insert(0) += 1;
    }
    fields.extend(of_frame(report).into_iter().map(|(name, _)| (name, 1)));
    fields
}

/// The descriptor for people: verdict and reason, the fields, what can be asked, and how it will be read.
pub fn describe(descriptor: &Descriptor, quirks: Quirks, facts: &Facts) -> String {
    let mut page = String::new();
    let mut line = |text: &str| {
        page.push_str(text.trim_end());
        page.push('\n');
    };
    let verdict = if facts.touchscreen { "yes" } else { "no" };
    line(&format!("touchscreen   {verdict}: {}", facts.reason));
    let names: Vec<String> = descriptor.applications.iter().map(|&usage| name(usage)).collect();
    if !names.is_empty() {
        line(&format!("collections   {}", names.join(", ")));
    }
    let Ok(report) = &descriptor.touch else {
        return page;
    };
    let size = facts.physical_mm.map_or(
        "not told, or not to be believed: measure it and give it in the settings".to_owned(),
        |[w, h]| format!("{w:.1} × {h:.1} mm"),
    );
    line(&format!("surface       {size}"));
    let number = report
        .id
        .map_or("without a number".to_owned(), |id| format!("{id}"));
    line(&format!("report        {number}, {} bytes", report.bytes));
    line("");
    line("  bit  bits  field          range");
    if let Some(slot) = report.slots.first() {
        for (name, bits, axis) in of_slot(slot) {
            let range = axis.map_or(String::new(), |axis| range(&axis));
            line(&format!("{:>5} {:>5}  {name:<13}  {range}", bits.start, bits.len));
        }
    }
    if let [first, second, more @ ..] = &report.slots[..] {
        let apart = i64::from(second.x.bits.start) - i64::from(first.x.bits.start);
        line(&match more.len() {
            0 => format!("             and 1 more slot, {apart} bits on"),
            more => format!("             and {} more slots, each {apart} bits on", more + 1),
        });
    }
    for (name, bits) in of_frame(report) {
        line(&format!("{:>5} {:>5}  {name}", bits.start, bits.len));
    }
    line("");
    let features = &descriptor.features;
    line(&match features.contact_count_max {
        Some(field) => format!(
            "most contacts feature report {}; {} until it is asked",
            field.report.id, facts.max_contacts
        ),
        None => format!("most contacts not told; {} are assumed", facts.max_contacts),
    });
    if let Some(field) = features.input_mode {
        line(&format!("input mode    feature report {}", field.report.id));
    }
    for (i, quirk) in quirks.iter().enumerate() {
        let label = if i == 0 { "read as" } else { "" };
        line(&format!("{label:<13} {}", quirk.name()));
    }
    page
}

fn range(axis: &Axis) -> String {
    let mut text = format!("{} to {}", axis.min, axis.max);
    if let Some(mm) = axis.extent_mm {
        let _ = write!(text, ", {mm:.1} mm");
    }
    text
}

/// Name of a usage in the HID Usage Tables.
fn name(usage: u32) -> String {
    let (page, number) = ((usage >> 16) as u16, usage as u16);
    let known = hut::Usage::new_from_page_and_id(page, number);
    known.map_or_else(|_| format!("{page:04x}/{number:04x}"), |usage| usage.name())
}
