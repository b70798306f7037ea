//! Touchscreens of any shape: their report descriptors and their reports, written by the rules of the HID
//! specification and independently of what reads them.

#![allow(dead_code, reason = "each test file uses a part")]

/// A page and a number.
pub(crate) type Usage = (u16, u16);

pub(crate) const TOUCH_SCREEN: Usage = (0x0d, 0x04);
pub(crate) const TOUCH_PAD: Usage = (0x0d, 0x05);
pub(crate) const PEN: Usage = (0x0d, 0x02);
pub(crate) const MOUSE: Usage = (0x01, 0x02);
pub(crate) const X: Usage = (0x01, 0x30);
pub(crate) const Y: Usage = (0x01, 0x31);
pub(crate) const FINGER: Usage = (0x0d, 0x22);
pub(crate) const IN_RANGE: Usage = (0x0d, 0x32);
pub(crate) const TIP: Usage = (0x0d, 0x42);
pub(crate) const CONFIDENCE: Usage = (0x0d, 0x47);
pub(crate) const WIDTH: Usage = (0x0d, 0x48);
pub(crate) const HEIGHT: Usage = (0x0d, 0x49);
pub(crate) const ID: Usage = (0x0d, 0x51);
pub(crate) const INPUT_MODE: Usage = (0x0d, 0x52);
pub(crate) const DEVICE_IDENTIFIER: Usage = (0x0d, 0x53);
pub(crate) const COUNT: Usage = (0x0d, 0x54);
pub(crate) const COUNT_MAX: Usage = (0x0d, 0x55);
pub(crate) const SCAN_TIME: Usage = (0x0d, 0x56);
pub(crate) const CONFIGURATION: Usage = (0x0d, 0x0e);

/// Writes the items of a descriptor.
#[derive(Clone, Default)]
pub(crate) struct Items(pub(crate) Vec<u8>);

impl Items {
    /// Any item with the shortest data that holds `value`.
    pub(crate) fn item(&mut self, prefix: u8, value: i64) -> &mut Self {
        let (code, length) = match value {
            -128..=127 => (1, 1),
            -32_768..=32_767 => (2, 2),
            _ => (3, 4),
        };
        self.0.push(prefix | code);
        self.0.extend(&value.to_le_bytes()[..length]);
        self
    }

    pub(crate) fn open(&mut self, (page, usage): Usage, kind: u8) -> &mut Self {
        self.item(0x04, page.into())
            .item(0x08, usage.into())
            .item(0xa0, kind.into())
    }

    pub(crate) fn close(&mut self) -> &mut Self {
        self.0.push(0xc0);
        self
    }

    /// `count` fields of one usage; `kind` is 0x80 for input, 0xb0 for feature.
    pub(crate) fn fields(
        &mut self,
        kind: u8,
        (page, usage): Usage,
        range: [i64; 2],
        bits: u32,
        count: u32,
    ) -> &mut Self {
        self.item(0x14, range[0]).item(0x24, range[1]);
        self.item(0x74, bits.into()).item(0x94, count.into());
        self.item(0x04, page.into()).item(0x08, usage.into());
        self.item(kind, 2)
    }

    pub(crate) fn pad(&mut self, bits: u32) -> &mut Self {
        if bits > 0 {
            self.item(0x74, bits.into()).item(0x94, 1).item(0x80, 3);
        }
        self
    }
}

/// How a touchscreen reports.
#[derive(Clone, Debug)]
#[allow(
    clippy::struct_excessive_bools,
    reason = "each is a field that a device has or has not"
)]
pub(crate) struct Shape {
    pub(crate) report_id: Option<u8>,
    pub(crate) slots: usize,
    pub(crate) id_bits: u32,
    /// Bits of coordinates, widths and heights, and their range.
    pub(crate) xy_bits: u32,
    pub(crate) x: [i64; 2],
    pub(crate) y: [i64; 2],
    pub(crate) physical_mm: Option<[i64; 2]>,
    pub(crate) tip: bool,
    pub(crate) in_range: bool,
    pub(crate) confidence: bool,
    pub(crate) area: bool,
    /// Each position twice: where it is touched, and the middle of the area.
    pub(crate) two_positions: bool,
    pub(crate) count_bits: Option<u32>,
    pub(crate) scan_bits: Option<u32>,
    pub(crate) max_feature: Option<u8>,
    /// Each contact in a collection of its own.
    pub(crate) collections: bool,
    /// The contact id is declared constant.
    pub(crate) constant_id: bool,
}

impl Default for Shape {
    fn default() -> Self {
        Self {
            report_id: Some(1),
            slots: 5,
            id_bits: 8,
            xy_bits: 16,
            x: [0, 4095],
            y: [0, 4095],
            physical_mm: Some([600, 340]),
            tip: true,
            in_range: false,
            confidence: true,
            area: true,
            two_positions: false,
            count_bits: Some(8),
            scan_bits: Some(16),
            max_feature: Some(10),
            collections: true,
            constant_id: false,
        }
    }
}

/// One slot of a report.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sent {
    pub(crate) id: u64,
    pub(crate) tip: bool,
    pub(crate) in_range: bool,
    pub(crate) confidence: bool,
    pub(crate) x: i64,
    pub(crate) y: i64,
    pub(crate) w: i64,
    pub(crate) h: i64,
}

impl Sent {
    /// A finger.
    pub(crate) fn at(id: u64, x: i64, y: i64) -> Self {
        Self {
            id,
            tip: true,
            in_range: true,
            confidence: true,
            x,
            y,
            w: 0,
            h: 0,
        }
    }

    /// The same contact, lifted.
    pub(crate) fn lifted(self) -> Self {
        Self {
            tip: false,
            in_range: false,
            ..self
        }
    }
}

/// A descriptor and where its fields stand: usage, slot, first bit, bits.
pub(crate) struct Built {
    pub(crate) bytes: Vec<u8>,
    fields: Vec<(Usage, usize, u32, u32)>,
    report_bits: u32,
    id: Option<u8>,
}

impl Shape {
    pub(crate) fn build(&self) -> Built {
        let mut items = Items::default();
        items.open(TOUCH_SCREEN, 1);
        let built = self.report(&mut items);
        if let Some(max) = self.max_feature {
            if let Some(id) = self.report_id {
                items.item(0x84, i64::from(id) + 1);
            }
            items.fields(0xb0, COUNT_MAX, [0, max.into()], 8, 1);
        }
        items.close();
        Built {
            bytes: items.0,
            ..built
        }
    }

    /// The touch report alone, inside any application.
    pub(crate) fn report(&self, items: &mut Items) -> Built {
        let mut out = Layout {
            items,
            at: 0,
            fields: Vec::new(),
            slot: 0,
        };
        if let Some(id) = self.report_id {
            out.items.item(0x84, id.into());
            out.at = 8;
        }
        for slot in 0..self.slots {
            out.slot = slot;
            if self.collections {
                out.items.open(FINGER, 2);
            }
            self.contact(&mut out);
            if self.collections {
                out.items.close();
            }
        }
        out.slot = 0;
        for (usage, bits) in [(COUNT, self.count_bits), (SCAN_TIME, self.scan_bits)] {
            if let Some(bits) = bits {
                out.field(usage, [0, (1 << bits.min(31)) - 1], bits, 1);
            }
        }
        out.pad();
        Built {
            bytes: Vec::new(),
            fields: out.fields,
            report_bits: out.at,
            id: self.report_id,
        }
    }

    fn contact(&self, out: &mut Layout<'_>) {
        for (usage, is_there) in [
            (TIP, self.tip),
            (IN_RANGE, self.in_range),
            (CONFIDENCE, self.confidence),
        ] {
            if is_there {
                out.field(usage, [0, 1], 1, 1);
            }
        }
        if self.id_bits > 0 {
            out.field(ID, [0, (1 << self.id_bits.min(31)) - 1], self.id_bits, 1);
            if self.constant_id {
                *out.items.0.last_mut().expect("a field") = 3;
            }
        }
        out.pad();
        let positions = if self.two_positions { 2 } else { 1 };
        let (unit, exponent) = self.physical_mm.map_or((0, 0), |_| (0x11, -1));
        let [w, h] = self.physical_mm.unwrap_or([0, 0]);
        out.items.item(0x64, unit).item(0x54, exponent).item(0x34, 0);
        for (position, side, range, extent) in [(X, WIDTH, self.x, w), (Y, HEIGHT, self.y, h)] {
            out.items.item(0x44, extent);
            out.field(position, range, self.xy_bits, positions);
            if self.area {
                out.field(side, [0, range[1] - range[0]], self.xy_bits, 1);
            }
        }
        out.items.item(0x64, 0).item(0x54, 0).item(0x44, 0);
        out.pad();
    }
}

/// A report while it is laid out.
struct Layout<'a> {
    items: &'a mut Items,
    at: u32,
    slot: usize,
    fields: Vec<(Usage, usize, u32, u32)>,
}

impl Layout<'_> {
    fn field(&mut self, usage: Usage, range: [i64; 2], bits: u32, count: u32) {
        self.items.fields(0x80, usage, range, bits, count);
        self.fields.push((usage, self.slot, self.at, bits));
        self.at += bits * count;
    }

    fn pad(&mut self) {
        let bits = (8 - self.at % 8) % 8;
        self.items.pad(bits);
        self.at += bits;
    }
}

impl Built {
    /// A report with these slots, this contact count and scan time.
    pub(crate) fn encode(&self, sent: &[Sent], count: u64, scan: u64) -> Vec<u8> {
        let mut report = vec![0; self.report_bits as usize / 8];
        if let Some(id) = self.id {
            report[0] = id;
        }
        for &(usage, slot, at, bits) in &self.fields {
            let of = sent.get(slot).copied().unwrap_or_default();
            let value = match usage {
                TIP => of.tip.into(),
                IN_RANGE => of.in_range.into(),
                CONFIDENCE => of.confidence.into(),
                ID => of.id,
                X => of.x as u64,
                Y => of.y as u64,
                WIDTH => of.w as u64,
                HEIGHT => of.h as u64,
                COUNT => count,
                SCAN_TIME => scan,
                _ => 0,
            };
            for bit in 0..bits {
                let place = (at + bit) as usize;
                report[place / 8] |= ((value >> bit & 1) as u8) << (place % 8);
            }
        }
        report
    }

    /// A frame in as many reports as it takes: the count in the first.
    pub(crate) fn frame(&self, sent: &[Sent], slots: usize, scan: u64) -> Vec<Vec<u8>> {
        if sent.is_empty() {
            return vec![self.encode(&[], 0, scan)];
        }
        let count = |i: usize| if i == 0 { sent.len() as u64 } else { 0 };
        let parts = sent.chunks(slots).enumerate();
        parts.map(|(i, part)| self.encode(part, count(i), scan)).collect()
    }
}
