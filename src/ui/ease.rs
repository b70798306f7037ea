//! Curves along which things come and go.

/// From 0 at `x ≤ 0` to 1 at `x ≥ 1`, level at both ends. Something that is no number counts as 1: arrived.
pub(super) fn smooth(x: f64) -> f32 {
    let x = if x.is_nan() { 1.0 } else { x.clamp(0.0, 1.0) };
    (x * x * (3.0 - 2.0 * x)) as f32
}

/// From 0 to 1, fast first and slow at the end: the answer to a touch.
pub(super) fn out(x: f64) -> f32 {
    let left = 1.0 - if x.is_nan() { 1.0 } else { x.clamp(0.0, 1.0) };
    (1.0 - left * left * left) as f32
}

/// 0 before `from`, 1 after `to`, level at both; `from < to`.
pub(super) fn step(from: f64, to: f64, x: f64) -> f32 {
    smooth((x - from) / (to - from))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_begin_at_nought_end_at_one_and_never_leave_that_range() {
        for curve in [smooth, out] {
            assert_eq!(curve(0.0), 0.0);
            assert_eq!(curve(1.0), 1.0);
            assert_eq!(curve(f64::NAN), 1.0);
            let mut last = 0.0;
            for i in -10..=110 {
                let y = curve(f64::from(i) / 100.0);
                assert!((0.0..=1.0).contains(&y) && y >= last);
                last = y;
            }
        }
    }
}
