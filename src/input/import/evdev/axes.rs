//! What the head of a recording says about the device's axes.

use std::collections::BTreeMap;

use glam::DVec2;
use serde_json::Value;

use super::codes::{
    ABS_MT_ORIENTATION, ABS_MT_POSITION_X, ABS_MT_POSITION_Y, ABS_MT_SLOT, ABS_MT_TOUCH_MAJOR,
    ABS_MT_WIDTH_MAJOR, EV_ABS,
};

use crate::gesture::contact::MAX_CONTACTS;
use crate::gesture::json::Expected;
use crate::input::import::{ImportFault, ImportOptions, is_size};

/// Least and greatest value of an axis, in device units.
type Range = (f64, f64);

/// Range and resolution of an axis, as far as they are told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in super::super) struct Axis {
    pub(in super::super) min: Option<i32>,
    pub(in super::super) max: Option<i32>,
    /// Units per millimetre.
    pub(in super::super) resolution: Option<i32>,
}

impl Axis {
    /// The range, if it is one.
    fn range(&self) -> Option<Range> {
        let (min, max) = self.min.zip(self.max)?;
        (min < max).then_some((min.into(), max.into()))
    }
}

/// The absolute axes: by `A:` lines, and by the comments that describe them.
#[derive(Debug, Default)]
pub(super) struct Axes {
    lines: BTreeMap<u16, Axis>,
    comments: BTreeMap<u16, Axis>,
    /// The event type and code that the comments are speaking of.
    topic: (Option<u16>, Option<u16>),
}

impl Axes {
    pub(super) fn line(&mut self, code: u16, axis: Axis) {
        self.lines.insert(code, axis);
    }

    /// Follows a description (`Event code 53 (ABS_MT_POSITION_X)`, then `Min 0`, …); other comments say nothing.
    /// Returns the slot that is selected when the recording begins, where this line tells.
    pub(super) fn comment(&mut self, text: &str) -> Option<u16> {
        let words: Vec<&str> = text.split_whitespace().collect();
        match words[..] {
            ["Event", "type", kind, ..] => self.topic = (kind.parse().ok(), None),
            ["Event", "code", code, ..] => self.topic.1 = code.parse().ok(),
            ["Properties:", ..] => self.topic = (None, None),
            [what, value] => return self.described(what, value.parse().ok()?),
            _ => {}
        }
        None
    }

    fn described(&mut self, what: &str, value: i32) -> Option<u16> {
        let (Some(EV_ABS), Some(code)) = self.topic else {
            return None;
        };
        let axis = self.comments.entry(code).or_default();
        match what {
            "Min" => axis.min = Some(value),
            "Max" => axis.max = Some(value),
            "Resolution" => axis.resolution = Some(value),
            "Value" if code == ABS_MT_SLOT => {
                return u16::try_from(value)
                    .ok()
                    .filter(|slot| usize::from(*slot) < MAX_CONTACTS);
            }
            _ => {}
        }
        None
    }

    /// The first answer of the lines, then the comments.
    fn ask<T>(&self, code: u16, question: impl Fn(&Axis) -> Option<T>) -> Option<T> {
        [&self.lines, &self.comments]
            .into_iter()
            .find_map(|axes| axes.get(&code).and_then(&question))
    }

    /// The touching surface; `options` win over what the recording tells: headers
    /// are absent or wrong on one device in eight.
    pub(super) fn plane(
        &self,
        options: &ImportOptions,
        warnings: &mut Vec<String>,
    ) -> Result<Plane, ImportFault> {
        let range = |code| self.ask(code, Axis::range);
        let told = range(ABS_MT_POSITION_X).zip(range(ABS_MT_POSITION_Y));
        let given = options.range.map(given_range).transpose()?;
        let ((x0, x1), (y0, y1)) = given.or(told).ok_or(ImportFault::NoRange)?;
        if told.is_some_and(|told| given.is_some_and(|given| given != told)) {
            warnings.push("--range used in place of the recording's own".to_owned());
        }
        let units = DVec2::new(x1 - x0, y1 - y0);
        let resolution = |code| self.ask(code, |axis| axis.resolution.filter(|r| *r > 0));
        let told = resolution(ABS_MT_POSITION_X)
            .zip(resolution(ABS_MT_POSITION_Y))
            .map(|(x, y)| units / DVec2::new(x.into(), y.into()))
            .filter(|size| is_size(*size));
        let given = options.size()?;
        let size_mm = given.or(told).ok_or(ImportFault::NoSize)?;
        if told.is_some_and(|told| given.is_some_and(|given| given != told)) {
            warnings.push("--size-mm used in place of the recording's own".to_owned());
        }
        Ok(Plane {
            size_mm,
            origin: DVec2::new(x0, y0),
            units,
            touch_mm_per_unit: self.area_scale(ABS_MT_TOUCH_MAJOR, units, size_mm),
            approach_mm_per_unit: self.area_scale(ABS_MT_WIDTH_MAJOR, units, size_mm),
            lying: self
                .ask(ABS_MT_ORIENTATION, |axis| axis.max)
                .filter(|max| *max > 0),
        })
    }

    /// Millimetres per unit, along x and y, of the areas whose major axis is `code`; `None` if they cannot be told.
    ///
    /// The kernel's documentation asks for the units of the position, at most the diagonal of the surface, but many
    /// drivers report a strength of, say, 0 to 255: as a length it would make palms of fingers, or fingers of palms.
    fn area_scale(&self, code: u16, units: DVec2, size_mm: DVec2) -> Option<DVec2> {
        if let Some(resolution) = self.ask(code, |axis| axis.resolution.filter(|r| *r > 0)) {
            return Some(DVec2::splat(1.0 / f64::from(resolution)));
        }
        let lengths = units.min_element()..=units.length().ceil();
        self.ask(code, Axis::range)
            .is_none_or(|(min, max)| lengths.contains(&(max - min)))
            .then_some(size_mm / units)
    }
}

fn given_range(range: [f64; 4]) -> Result<(Range, Range), ImportFault> {
    let [x0, x1, y0, y1] = range;
    // Differences of what fits in 32 bits stay exact.
    let reach = f64::from(i32::MAX) + 1.0;
    if range.iter().all(|v| v.abs() <= reach) && x0 < x1 && y0 < y1 {
        return Ok(((x0, x1), (y0, y1)));
    }
    let what = "X0,X1,Y0,Y1 in device units with X0 < X1 and Y0 < Y1";
    Err(Expected::new("--range", what, &Value::from(range.to_vec())).into())
}

/// The touching surface in device units and millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    pub(super) size_mm: DVec2,
    origin: DVec2,
    units: DVec2,
    /// Millimetres per unit of the touching area, and of the area that approaches; `None` where its unit is unknown.
    pub(super) touch_mm_per_unit: Option<DVec2>,
    pub(super) approach_mm_per_unit: Option<DVec2>,
    /// The orientation at which a major axis lies along x.
    lying: Option<i32>,
}

impl Plane {
    /// Table millimetres of a position in device units.
    pub(super) fn position(&self, x: i32, y: i32) -> DVec2 {
        (DVec2::new(x.into(), y.into()) - self.origin) / self.units * self.size_mm
    }

    /// True if a major axis of this orientation is nearer to x than to y.
    pub(super) fn lies(&self, orientation: i32) -> bool {
        self.lying
            .is_some_and(|lying| 2 * i64::from(orientation).abs() > i64::from(lying))
    }
}
