//! Where a slice begins and ends.

use glam::DVec2;

use crate::units::{Extent, KM};

/// Shorter slices show nothing, metres.
const SHORTEST: f64 = 1.0;

/// Why a slice could not be cut.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SliceError {
    /// Not four numbers.
    #[error("expected four numbers x0,y0,x1,y1 in km, found {0}")]
    Count(usize),
    /// One of them is no number.
    #[error("{name}: expected a number of km, found {found:?}")]
    Number {
        /// Which of the four.
        name: &'static str,
        /// What stood there.
        found: String,
    },
    /// An end is not a place.
    #[error("the ends must be places")]
    NotFinite,
    /// There is nothing between the ends.
    #[error("the ends must be apart")]
    TooShort,
    /// The line passes the land by.
    #[error("the line must cross the land, which is {width_km} × {height_km} km")]
    Outside {
        /// West–east size of the land, km.
        width_km: f64,
        /// South–north size of the land, km.
        height_km: f64,
    },
}

/// The ends of a slice from `x0,y0,x1,y1` in km (x east, y north, from the south-west corner), in plan metres.
///
/// # Errors
/// What is not four finite numbers, and ends that coincide.
pub fn parse_ends(text: &str) -> Result<[DVec2; 2], SliceError> {
    const NAMES: [&str; 4] = ["x0", "y0", "x1", "y1"];
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    if parts.len() != NAMES.len() {
        return Err(SliceError::Count(parts.len()));
    }
    let mut metres = [0.0; 4];
    for ((metres, name), part) in metres.iter_mut().zip(NAMES).zip(parts) {
        let km: Option<f64> = part.parse().ok();
        *metres = km
            .map(|km| km * KM)
            .filter(|m| m.is_finite())
            .ok_or_else(|| SliceError::Number {
                name,
                found: part.chars().take(24).collect(),
            })?;
    }
    let [x0, y0, x1, y1] = metres;
    let ends = [DVec2::new(x0, y0), DVec2::new(x1, y1)];
    if ends[0].distance(ends[1]) < SHORTEST {
        return Err(SliceError::TooShort);
    }
    Ok(ends)
}

/// The part of the line between `ends` (plan, metres) that lies on the land (Liang & Barsky 1984).
///
/// # Errors
/// Where no metre of it does, or an end is not a place.
pub fn clipped(ends: [DVec2; 2], land: Extent) -> Result<[DVec2; 2], SliceError> {
    let [from, to] = ends;
    if !from.is_finite() || !to.is_finite() || !(to - from).is_finite() {
        return Err(SliceError::NotFinite);
    }
    let way = to - from;
    if way.length() < SHORTEST {
        return Err(SliceError::TooShort);
    }
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (start, step, size) in [(from.x, way.x, land.width), (from.y, way.y, land.height)] {
        if step == 0.0 {
            if !(0.0..=size).contains(&start) {
                leave = -1.0;
            }
            continue;
        }
        let (a, b) = (-start / step, (size - start) / step);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    // Rounding may leave a hair outside.
    let at = |t: f64| (from + way * t).clamp(DVec2::ZERO, land.size());
    let cut = [
        if enter > 0.0 { at(enter) } else { from },
        if leave < 1.0 { at(leave) } else { to },
    ];
    if enter > leave || cut[0].distance(cut[1]) < SHORTEST {
        return Err(SliceError::Outside {
            width_km: (land.width / 10.0).round() / 100.0,
            height_km: (land.height / 10.0).round() / 100.0,
        });
    }
    Ok(cut)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LAND: Extent = Extent {
        width: 60e3,
        height: 40e3,
    };

    #[test]
    fn faults_name_the_number_and_what_was_expected() {
        let refused = |text| parse_ends(text).unwrap_err().to_string();
        assert_eq!(
            refused("1,2,3"),
            "expected four numbers x0,y0,x1,y1 in km, found 3"
        );
        assert_eq!(refused("1,2,x,4"), "x1: expected a number of km, found \"x\"");
        assert_eq!(refused("1,inf,3,4"), "y0: expected a number of km, found \"inf\"");
        assert_eq!(refused("1,2,1,2"), "the ends must be apart");
        assert_eq!(
            parse_ends(" 1, 2.5,-3 ,4e1").unwrap(),
            [DVec2::new(1e3, 2.5e3), DVec2::new(-3e3, 40e3)]
        );
    }

    #[test]
    fn a_line_is_cut_at_the_border_and_one_that_passes_by_is_refused() {
        let cut = |ends: [[f64; 2]; 2]| clipped(ends.map(DVec2::from), LAND);
        assert_eq!(
            cut([[-10e3, 20e3], [90e3, 20e3]]).unwrap(),
            [DVec2::new(0.0, 20e3), DVec2::new(60e3, 20e3)]
        );
        let inside = [DVec2::new(1.5, 2.5), DVec2::new(59e3, 39e3)];
        assert_eq!(clipped(inside, LAND), Ok(inside));
        for missed in [
            [[-1.0, 0.0], [-1.0, 40e3]],
            [[-30e3, 20e3], [30e3, 90e3]],
            [[70e3, 1e3], [90e3, 1e3]],
        ] {
            assert!(
                matches!(cut(missed), Err(SliceError::Outside { .. })),
                "{missed:?}"
            );
        }
        assert_eq!(cut([[5.0, 5.0], [5.0, 5.0]]), Err(SliceError::TooShort));
        assert_eq!(cut([[f64::NAN, 5.0], [5.0, 5.0]]), Err(SliceError::NotFinite));
    }

    proptest! {
        /// Whatever is typed is read, or refused in one line.
        #[test]
        fn any_text_is_read_or_refused(text in "[-0-9a-zA-Z.,+ \\n∞]{0,40}") {
            match parse_ends(&text) {
                Ok(ends) => prop_assert!(ends.iter().all(|end| end.is_finite())),
                Err(error) => prop_assert!(!error.to_string().contains('\n')),
            }
        }

        /// What was cut lies on the land, on the line, and in its direction.
        #[test]
        fn cut_lines_lie_on_the_land(numbers in proptest::array::uniform4(-200e3..200e3f64)) {
            let [x0, y0, x1, y1] = numbers;
            let ends = [DVec2::new(x0, y0), DVec2::new(x1, y1)];
            if let Ok([a, b]) = clipped(ends, LAND) {
                prop_assert!(LAND.contains(a) && LAND.contains(b));
                let way = (ends[1] - ends[0]).normalize();
                prop_assert!((a - ends[0]).perp_dot(way).abs() < 1e-6);
                prop_assert!((b - ends[0]).perp_dot(way).abs() < 1e-6);
                prop_assert!((b - a).dot(way) > 0.0);
            }
        }
    }
}
