//! Texts of a certain form.

use core::net::IpAddr;

use glam::{DAffine2, DVec2};

/// Most machines in a list.
const MOST_ADDRESSES: usize = 64;

/// Least and greatest area that a calibration may make of the surface's, and how far it may shift it: what is beyond is a
/// slip of the finger.
const AREA: (f64, f64) = (0.25, 4.0);
const SHIFT: f64 = 1.5;

/// What a text must look like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Addresses of machines, separated by commas, or nothing.
    Addresses,
    /// Six numbers, separated by spaces, that take parts of the touching surface to parts of the picture, or nothing.
    Affine,
}

impl Form {
    /// True for texts of this form.
    pub fn admits(self, text: &str) -> bool {
        match self {
            Self::Addresses => addresses(text).is_some(),
            Self::Affine => text.is_empty() || affine(text).is_some(),
        }
    }

    /// The form in words.
    pub fn expected(self) -> &'static str {
        match self {
            Self::Addresses => "addresses such as \"192.168.1.20, 192.168.1.21\", or \"\"",
            Self::Affine => "six numbers that calibration has written, or \"\"",
        }
    }

    /// A text of this form that means something.
    pub fn example(self) -> &'static str {
        match self {
            Self::Addresses => "127.0.0.1, 192.168.1.20",
            Self::Affine => "1.02 0 0 0.98 -0.01 0.01",
        }
    }
}

/// The machines of a list.
pub(super) fn addresses(text: &str) -> Option<Vec<IpAddr>> {
    if text.trim().is_empty() {
        return Some(Vec::new());
    }
    let parts = text.split(',').take(MOST_ADDRESSES + 1);
    let found: Option<Vec<IpAddr>> = parts.map(|part| part.trim().parse().ok()).collect();
    found.filter(|found| found.len() <= MOST_ADDRESSES)
}

/// The map of six numbers: columns first, then the shift.
pub(super) fn affine(text: &str) -> Option<DAffine2> {
    let numbers: Option<Vec<f64>> = text.split_whitespace().map(|part| part.parse().ok()).collect();
    let numbers: [f64; 6] = numbers?.try_into().ok()?;
    Some(DAffine2::from_cols_array(&numbers)).filter(|map| is_calibration(*map))
}

/// True for maps that a touching surface may lie by.
pub(super) fn is_calibration(map: DAffine2) -> bool {
    let middle = map.transform_point2(DVec2::splat(0.5)) - 0.5;
    let area = map.matrix2.determinant().abs();
    map.is_finite() && (AREA.0..=AREA.1).contains(&area) && middle.abs().max_element() <= SHIFT
}

/// The six numbers of a map.
pub(super) fn affine_text(map: DAffine2) -> String {
    // (Six decimals are a thousandth of a millimetre.)
    let numbers = map
        .to_cols_array()
        .map(|number| (number * 1e6).round() / 1e6 + 0.0);
    numbers.map(|number| number.to_string()).join(" ")
}
