//! What erosion does between two steps, for those who look.

/// How fast rivers and slides have lowered each node of late, m/yr.
///
/// A step raises the land and cuts it at once. Who shows the uplift of the time since the last step must show the
/// erosion of that time too, or a range in balance pulses with each step.
#[derive(Debug, Default)]
pub(super) struct Wear {
    last: Vec<f64>,
    steady: Vec<f64>,
}

impl Wear {
    /// Learns from a step of `dt_yr` that took the heights `before` to `after` under `uplift` (m/yr).
    pub(super) fn learn(&mut self, before: &[f64], after: &[f64], uplift: &[f64], dt_yr: f64) {
        self.last.resize(after.len(), 0.0);
        self.steady.resize(after.len(), 0.0);
        let heights = before.iter().zip(after).zip(uplift);
        for (((before, after), uplift), (last, steady)) in
            heights.zip(self.last.iter_mut().zip(&mut self.steady))
        {
            let now = ((before - after) / dt_yr + uplift).max(0.0);
            // A slide happens once and does not go on.
            *steady = now.min(*last);
            *last = now;
        }
    }

    /// Forgets all: another land has taken the place of the one before.
    pub(super) fn forget(&mut self) {
        self.last.clear();
        self.steady.clear();
    }

    /// What goes on at node `i`, m/yr.
    pub(super) fn at(&self, i: usize) -> f64 {
        self.steady.get(i).copied().unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_goes_on_is_what_two_steps_have_in_common() {
        let mut wear = Wear::default();
        // Node 0 wears down by 2 m a year throughout, node 1 slides once, node 2 only rises.
        wear.learn(&[100.0; 3], &[90.0, 50.0, 115.0], &[1.0, 0.0, 1.5], 10.0);
        assert_eq!(
            [0, 1, 2].map(|i| wear.at(i)),
            [0.0; 3],
            "one step says nothing yet"
        );
        wear.learn(&[90.0, 50.0, 115.0], &[80.0, 50.0, 130.0], &[1.0, 0.0, 1.5], 10.0);
        assert_eq!([0, 1, 2].map(|i| wear.at(i)), [2.0, 0.0, 0.0]);
        wear.forget();
        assert_eq!(wear.at(0), 0.0);
    }
}
