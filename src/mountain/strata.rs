//! The joint for rock layers (paper section 6.2): how far each stratigraphic interface has been displaced.
//!
//! Heights of interfaces are sums of rates over time, `h_k = H_k⁰ + ∫(u0 + Σ_{j≤k} u_j) dt`, never rate × elapsed
//! time, so that strata do not jump when a push changes. Today there is one interface, the top of the undivided
//! crust; folds add further ones with their own rates.

use thiserror::Error;

/// Why interfaces could not be advanced.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum StrataError {
    /// Rates and nodes do not match.
    #[error("expected {expected} rates for each of {interfaces} interfaces, got {got}")]
    Shape {
        /// Nodes.
        expected: usize,
        /// Interfaces.
        interfaces: usize,
        /// Rates given for some interface, or interfaces given.
        got: usize,
    },
}

/// Accumulated displacement ∫u dt of each interface at each node, metres; interface 0 is the topmost.
#[derive(Clone, Debug, PartialEq)]
pub struct Strata {
    /// Depth of each interface below the first surface, metres, growing downwards.
    depths: Vec<f64>,
    displaced: Vec<Vec<f64>>,
}

impl Strata {
    /// Undisturbed interfaces at `depths` (metres, strictly growing; the first usually 0) over `nodes` nodes.
    pub fn new(depths: &[f64], nodes: usize) -> Self {
        Self {
            depths: depths.to_vec(),
            displaced: vec![vec![0.0; nodes]; depths.len()],
        }
    }

    /// Adds `rates[interface][node] · years` (m/yr).
    ///
    /// # Errors
    /// When there is not one rate per interface and node; nothing is changed then.
    pub fn advance(&mut self, rates: &[&[f64]], years: f64) -> Result<(), StrataError> {
        let expected = self.displaced.first().map_or(0, Vec::len);
        let fault = |got| StrataError::Shape {
            expected,
            interfaces: self.depths.len(),
            got,
        };
        if rates.len() != self.depths.len() {
            return Err(fault(rates.len()));
        }
        if let Some(wrong) = rates.iter().find(|r| r.len() != expected) {
            return Err(fault(wrong.len()));
        }
        for (displaced, rates) in self.displaced.iter_mut().zip(rates) {
            for (d, &rate) in displaced.iter_mut().zip(*rates) {
                *d += rate * years;
            }
        }
        Ok(())
    }

    /// How many interfaces there are.
    pub fn interfaces(&self) -> usize {
        self.depths.len()
    }

    /// Displacement of an interface at each node, metres.
    pub fn displaced(&self, interface: usize) -> Option<&[f64]> {
        self.displaced.get(interface).map(Vec::as_slice)
    }

    /// Height of an interface at a node, relative to the first surface, metres.
    pub fn height(&self, interface: usize, node: usize) -> Option<f64> {
        Some(self.displaced.get(interface)?.get(node)? - self.depths.get(interface)?)
    }

    /// True while no interface reaches the one above it, at any node.
    pub fn is_monotone(&self) -> bool {
        (1..self.depths.len()).all(|k| {
            let room = self.depths[k] - self.depths[k - 1];
            self.displaced[k - 1]
                .iter()
                .zip(&self.displaced[k])
                .all(|(above, below)| below - above < room)
        })
    }

    /// Carries all displacements to other nodes: `sample(values)` gives the values there.
    pub fn resample(&mut self, mut sample: impl FnMut(&[f64]) -> Vec<f64>) {
        for displaced in &mut self.displaced {
            *displaced = sample(displaced);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn displacement_is_the_integral_of_changing_rates() {
        let mut strata = Strata::new(&[0.0, 100.0], 2);
        strata.advance(&[&[1e-3, 0.0], &[1e-3, 0.0]], 1e6).unwrap();
        strata.advance(&[&[0.0, 2e-3], &[0.0, 2e-3]], 1e5).unwrap();
        let top = strata.displaced(0).unwrap();
        assert!((top[0] - 1000.0).abs() < 1e-3 && (top[1] - 200.0).abs() < 1e-3);
        assert!((strata.height(1, 0).unwrap() - 900.0).abs() < 1e-3);
        assert!(strata.is_monotone());
        strata.advance(&[&[0.0, 0.0], &[1e-3, 0.0]], 1e6).unwrap();
        assert!(
            !strata.is_monotone(),
            "a lower interface rose through the upper one"
        );
    }

    #[test]
    fn wrong_shapes_are_refused_and_change_nothing() {
        let mut strata = Strata::new(&[0.0], 3);
        let before = strata.clone();
        assert!(strata.advance(&[&[1.0, 1.0]], 1.0).is_err());
        assert!(strata.advance(&[], 1.0).is_err());
        assert_eq!(strata, before);
    }

    #[test]
    fn resampling_carries_every_interface() {
        let mut strata = Strata::new(&[0.0, 50.0], 2);
        strata.advance(&[&[1.0, 3.0], &[5.0, 7.0]], 1.0).unwrap();
        strata.resample(|v| vec![v[0], f64::midpoint(v[0], v[1]), v[1]]);
        assert_eq!(strata.displaced(0), Some([1.0, 2.0, 3.0].as_slice()));
        assert_eq!(strata.displaced(1), Some([5.0, 6.0, 7.0].as_slice()));
    }
}
