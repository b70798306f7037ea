//! Times of recordings.

use serde_json::Value;

use super::ImportFault;
use crate::gesture::file::MAX_TIME_MS;
use crate::gesture::json::Expected;

/// Time of the first event and of the last one, µs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Span(Option<(u64, u64)>);

impl Span {
    /// Goes on to `t_us`: never back, and never farther than a gesture file reaches.
    pub(super) fn advance(&mut self, t_us: u64) -> Result<(), ImportFault> {
        let (first, last) = self.0.unwrap_or((t_us, t_us));
        if t_us < last {
            return Err(ImportFault::Backwards {
                before_s: last as f64 / 1e6,
                found_s: t_us as f64 / 1e6,
            });
        }
        if (t_us - first) as f64 > MAX_TIME_MS * 1e3 {
            return Err(ImportFault::LongTime);
        }
        self.0 = Some((first, t_us));
        Ok(())
    }

    /// Time of the last event, µs.
    pub(super) fn end_us(self) -> u64 {
        self.0.map_or(0, |span| span.1)
    }
}

/// Microseconds of `sec.usec`.
pub(super) fn micros(text: &str) -> Result<u64, Expected> {
    let digits = |s: &str| !s.is_empty() && s.bytes().all(|b| b.is_ascii_digit());
    let parse = || {
        // Fewer than six digits would be a fraction for some writers and a count for others.
        let (sec, usec) = text
            .split_once('.')
            .filter(|(s, us)| digits(s) && digits(us) && us.len() == 6)?;
        let sec: u64 = sec.parse().ok()?;
        sec.checked_mul(1_000_000)?.checked_add(usec.parse().ok()?)
    };
    parse().ok_or_else(|| Expected::new("E: time", "seconds with six decimals", &Value::from(text)))
}
