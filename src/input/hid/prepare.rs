//! Report descriptors as bytes: what is checked, and put right, before they are parsed.
//!
//! A descriptor is a program that a stranger's device sends. Some dozen bytes of it may ask for billions of fields, so
//! everything is capped here, about where Linux caps it.

use super::usage::CONTACT_ID;

/// Most bytes of a descriptor. Linux takes 4096; the longest of 283 real touchscreens has 2271.
pub const MAX_DESCRIPTOR_BYTES: usize = 8192;

/// Most numbers in all reports together. Blobs of vendors are thousands of bytes, each a field.
const MAX_FIELDS: u64 = 65_536;

/// Most fields of one item.
const MAX_COUNT: u32 = 16_384;

/// Most usages of one field.
const MAX_USAGES: u32 = 4096;

/// Most bits of one field. (Linux: 256.)
const MAX_FIELD_BITS: u32 = 256;

/// Deepest nesting of collections and of pushed states.
const MAX_DEPTH: usize = 16;

/// Why the bytes are no report descriptor.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DescriptorError {
    /// There is none.
    #[error("expected the bytes of a HID report descriptor, found none")]
    Empty,
    /// Beyond [`MAX_DESCRIPTOR_BYTES`].
    #[error("{0} bytes; expected a HID report descriptor of at most {MAX_DESCRIPTOR_BYTES}")]
    TooLong(usize),
    /// Not to be parsed.
    #[error("byte {offset}: {problem}")]
    Item {
        /// Offset of the item, bytes.
        offset: usize,
        /// What was expected, and what is there.
        problem: String,
    },
}

/// A descriptor that can be parsed without harm.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Prepared {
    /// The bytes: items without data have got a zero, items without meaning are gone.
    pub(super) bytes: Vec<u8>,
    /// Contact ids were declared constant, as padding is; they are data now.
    pub(super) constant_ids: bool,
}

/// The state that items change, as far as it matters here.
#[derive(Clone, Copy, Default)]
struct Globals {
    page: Option<u16>,
    size: u32,
    count: u32,
}

#[derive(Default)]
struct Locals {
    usages: u32,
    minimum: Option<u32>,
    maximum: Option<u32>,
    contact_id: bool,
}

#[derive(Default)]
struct Walk {
    globals: Globals,
    pushed: Vec<Globals>,
    locals: Locals,
    depth: usize,
    fields: u64,
    prepared: Vec<u8>,
    constant_ids: bool,
}

/// Checks the bytes of a descriptor.
pub(super) fn prepare(bytes: &[u8]) -> Result<Prepared, DescriptorError> {
    if bytes.is_empty() {
        return Err(DescriptorError::Empty);
    }
    if bytes.len() > MAX_DESCRIPTOR_BYTES {
        return Err(DescriptorError::TooLong(bytes.len()));
    }
    let mut walk = Walk::default();
    let mut offset = 0;
    while let Some(&prefix) = bytes.get(offset) {
        let wrong = |problem: String| DescriptorError::Item { offset, problem };
        if prefix == 0xfe {
            return Err(wrong("expected a short item, found a long one".to_owned()));
        }
        let length = [0, 1, 2, 4][usize::from(prefix & 3)];
        let Some(data) = bytes.get(offset + 1..offset + 1 + length) else {
            return Err(wrong(format!(
                "expected an item of {length} bytes, found the end"
            )));
        };
        walk.item(prefix, data).map_err(wrong)?;
        offset += 1 + length;
    }
    if walk.prepared.is_empty() {
        return Err(DescriptorError::Empty);
    }
    Ok(Prepared {
        bytes: walk.prepared,
        constant_ids: walk.constant_ids,
    })
}

impl Walk {
    /// Takes one item; the error says what was expected.
    fn item(&mut self, prefix: u8, data: &[u8]) -> Result<(), String> {
        let value = data.iter().rev().fold(0_u32, |v, &byte| v << 8 | u32::from(byte));
        let mut flags = None;
        match prefix & 0xfc {
            0x80 => flags = self.field(value)?,
            0x90 | 0xb0 => drop(self.field(value)?),
            0xa0 => {
                self.depth += 1;
                if self.depth > MAX_DEPTH {
                    return Err(format!("expected collections at most {MAX_DEPTH} deep"));
                }
                if self.named() > 16 {
                    return Err("expected a collection with one usage".to_owned());
                }
                self.locals = Locals::default();
            }
            0xc0 => {
                let outer = self.depth.checked_sub(1);
                self.depth = outer.ok_or("expected a collection to end, found none")?;
                self.locals = Locals::default();
            }
            0x04 => self.globals.page = Some(value as u16),
            0x74 if value > MAX_FIELD_BITS => {
                return Err(format!(
                    "expected fields of at most {MAX_FIELD_BITS} bits, found {value}"
                ));
            }
            0x74 => self.globals.size = value,
            0x94 if value > MAX_COUNT => {
                return Err(format!("expected at most {MAX_COUNT} fields, found {value}"));
            }
            0x94 => self.globals.count = value,
            0x84 if !(1..256).contains(&value) => {
                return Err(format!("expected a report id from 1 to 255, found {value}"));
            }
            0xa4 => {
                if self.pushed.len() == MAX_DEPTH {
                    return Err(format!("expected at most {MAX_DEPTH} pushed states"));
                }
                self.pushed.push(self.globals);
            }
            0xb4 => self.globals = self.pushed.pop().ok_or("expected a pushed state, found none")?,
            0x08 => self.usage(value, data.len())?,
            0x18 => self.locals.minimum = Some(value),
            0x28 => self.locals.maximum = Some(value),
            // Other globals and locals do not matter here.
            tag if matches!(tag & 0x0c, 0x04 | 0x08) && known(tag) => {}
            // Without meaning; some devices pad with zeros.
            _ => return Ok(()),
        }
        self.keep(prefix, data, flags);
        Ok(())
    }

    fn usage(&mut self, value: u32, length: usize) -> Result<(), String> {
        let usage = match (length, self.globals.page) {
            (4, _) => value,
            (_, Some(page)) => u32::from(page) << 16 | value,
            (_, None) => return Err("expected a usage page before a usage".to_owned()),
        };
        self.locals.usages += 1;
        self.locals.contact_id |= usage == CONTACT_ID;
        Ok(())
    }

    /// How many usages the locals name.
    fn named(&self) -> u32 {
        match (self.locals.minimum, self.locals.maximum) {
            (Some(low), Some(high)) => high.saturating_sub(low).saturating_add(1),
            _ => self.locals.usages,
        }
    }

    /// A field is declared; other flags than the device's, if they must be put right.
    fn field(&mut self, flags: u32) -> Result<Option<u8>, String> {
        if self.named() > MAX_USAGES {
            return Err(format!("expected at most {MAX_USAGES} usages of one field"));
        }
        let is_variable = flags & 3 == 2;
        self.fields += if is_variable { self.globals.count.into() } else { 1 };
        if self.fields > MAX_FIELDS {
            return Err(format!("expected at most {MAX_FIELDS} fields in all"));
        }
        let is_constant = flags & 1 != 0;
        let changed = (is_constant && self.locals.contact_id).then_some((flags & !1 | 2) as u8);
        self.constant_ids |= changed.is_some();
        self.locals = Locals::default();
        Ok(changed)
    }

    fn keep(&mut self, prefix: u8, data: &[u8], flags: Option<u8>) {
        let takes_none = matches!(prefix & 0xfc, 0xc0 | 0xa4 | 0xb4);
        if takes_none {
            self.prepared.push(prefix & 0xfc);
        } else if let Some(flags) = flags {
            self.prepared.extend([0x81, flags]);
        } else if data.is_empty() {
            // An item without data means zero.
            self.prepared.extend([prefix | 1, 0]);
        } else {
            self.prepared.push(prefix);
            self.prepared.extend(data);
        }
    }
}

/// Whether the standard gives this global or local item a meaning.
fn known(tag: u8) -> bool {
    match tag & 0x0c {
        0x04 => tag >> 4 <= 0x0b,
        _ => tag >> 4 <= 0x0a && tag >> 4 != 0x06,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(bytes: &[u8]) -> String {
        prepare(bytes).unwrap_err().to_string()
    }

    #[test]
    fn what_would_do_harm_is_refused() {
        assert!(problem(&[]).contains("found none"));
        assert!(problem(&[5; MAX_DESCRIPTOR_BYTES + 1]).contains("8193 bytes"));
        assert_eq!(
            problem(&[0x05]),
            "byte 0: expected an item of 1 bytes, found the end"
        );
        assert!(problem(&[0xfe, 2, 0, 0, 0]).contains("long"));
        assert!(problem(&[0x09, 4]).contains("usage page"));
        assert!(problem(&[0x97, 0xff, 0xff, 0xff, 0xff]).contains("at most 16384 fields"));
        assert!(problem(&[0x77, 1, 1, 0, 0]).contains("256 bits"));
        assert!(problem(&[0x05, 9, 0x19, 0, 0x2b, 0, 0, 1, 0, 0xa1, 1]).contains("one usage"));
        assert!(problem(&[0x05, 9, 0x1b, 0, 0, 0, 0, 0x2b, 0, 0, 1, 0, 0x81, 2]).contains("4096"));
        assert!(problem(&[0xa1, 1].repeat(17)).contains("16 deep"));
        assert!(problem(&[0xa4].repeat(17)).contains("pushed"));
        assert!(problem(&[0xb4]).contains("pushed"));
        assert!(problem(&[0xc0]).contains("collection"));
        assert!(problem(&[0x85, 0]).contains("report id"));
        let many = [&[0x96, 0, 0x40][..], &[0x81, 2].repeat(5)].concat();
        assert!(problem(&many).contains("in all"));
    }

    #[test]
    fn items_without_data_get_a_zero_and_items_without_meaning_go() {
        let prepared = prepare(&[0x05, 0x0d, 0x14, 0, 0, 0xc4, 0xa4, 0xb4]).unwrap();
        assert_eq!(prepared.bytes, [0x05, 0x0d, 0x15, 0, 0xa4, 0xb4]);
        assert!(!prepared.constant_ids);
    }

    #[test]
    fn contact_ids_that_are_declared_constant_are_data() {
        let bytes = [0x05, 0x0d, 0x75, 8, 0x95, 1, 0x09, 0x51, 0x81, 3, 0x81, 3];
        let prepared = prepare(&bytes).unwrap();
        assert!(prepared.constant_ids);
        assert_eq!(prepared.bytes[8..], [0x81, 2, 0x81, 3]);
    }
}
