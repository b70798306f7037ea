//! The pile at one place after the crust has moved.

use super::stratigraphy::{MAX_LAYERS, Stratigraphy};

/// How far the crust and the folds have raised the pile at one place.
///
/// The whole pile has risen by `base`. The folds of the layer above interface `i` over the one below have raised that
/// interface, and all above it, by `folds[i]`: the stiff layer bends with constant thickness, and the weak rock under it
/// flows into the cores of the folds. (The paper sums folds from the bottom up and raises the top of the folding
/// layer only, `h_k = h_{k−1} + u_k t`, so that the stiff layer itself would swell under its crests; the surface
/// rises alike in both.) Folds only ever raise, so interfaces cannot cross.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column<'a> {
    stratigraphy: &'a Stratigraphy,
    base: f64,
    folds: [f64; MAX_LAYERS + 1],
}

impl<'a> Column<'a> {
    /// The pile raised by `base` metres as a whole.
    pub fn new(stratigraphy: &'a Stratigraphy, base: f64) -> Self {
        Self {
            stratigraphy,
            base,
            folds: [0.0; MAX_LAYERS + 1],
        }
    }

    /// Raises an interface, and all above it, by `metres`. Interfaces that the pile has not are ignored.
    #[must_use]
    pub fn folded(mut self, interface: usize, metres: f64) -> Self {
        if (1..=self.stratigraphy.layers().len()).contains(&interface) {
            self.folds[interface] += metres;
        }
        self
    }

    /// Sum of what is given for the folds from an interface downwards.
    fn sum_from(values: &[f64; MAX_LAYERS + 1], interface: usize) -> f64 {
        values[interface.max(1)..].iter().sum()
    }

    /// Height of an interface, metres.
    pub fn height(&self, interface: usize) -> f64 {
        self.base - self.stratigraphy.depths()[interface] + Self::sum_from(&self.folds, interface)
    }

    /// Depth before folding of the rock that is at height `z` now, metres: the inverse of the motion, exact and
    /// monotone. Negative above the first surface.
    pub fn depth_at(&self, z: f64) -> f64 {
        let depths = self.stratigraphy.depths();
        let mut top = self.height(0);
        if z >= top {
            return top - z;
        }
        for layer in 0..depths.len() - 1 {
            let bottom = self.height(layer + 1);
            if z >= bottom {
                let thickness = depths[layer + 1] - depths[layer];
                return depths[layer] + (top - z) / (top - bottom) * thickness;
            }
            top = bottom;
        }
        depths[depths.len() - 1] + (top - z)
    }

    /// Speed at which the rock of a depth before folding rises when interface `i` and all above it are raised at
    /// `rates[i]`: between two interfaces the speed is interpolated (D24, D25), so rock that has lost its folded
    /// cover no longer rises with it.
    pub fn fold_rate(&self, depth: f64, rates: &[f64; MAX_LAYERS + 1]) -> f64 {
        let depths = self.stratigraphy.depths();
        let layer = depths[1..].iter().take_while(|&&bottom| depth >= bottom).count();
        let above = Self::sum_from(rates, layer);
        if layer + 1 >= depths.len() || layer == 0 {
            return above;
        }
        let part = (depth - depths[layer]) / (depths[layer + 1] - depths[layer]);
        above - rates[layer] * part
    }
}

#[cfg(test)]
mod tests {
    use super::super::preset;
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn an_undisturbed_pile_is_its_depths() {
        let pile = preset::default();
        let column = Column::new(&pile, 250.0);
        for (interface, depth) in pile.depths().iter().enumerate() {
            assert_eq!(column.height(interface), 250.0 - depth);
        }
        assert_eq!(column.depth_at(-250.0), 500.0);
        assert_eq!(column.depth_at(300.0), -50.0);
    }

    #[test]
    fn the_stiff_layer_keeps_its_thickness_and_the_weak_one_fills_the_core() {
        let pile = preset::by_name("jura").unwrap();
        let folding = pile.folding().next().unwrap();
        let (flat, folded) = (
            Column::new(&pile, 0.0),
            Column::new(&pile, 0.0).folded(folding, 900.0),
        );
        let thickness = |column: &Column<'_>, layer: usize| column.height(layer) - column.height(layer + 1);
        assert_eq!(thickness(&flat, folding - 1), thickness(&folded, folding - 1));
        assert!((thickness(&folded, folding) - thickness(&flat, folding) - 900.0).abs() < 1e-9);
        let rates = {
            let mut rates = [0.0; MAX_LAYERS + 1];
            rates[folding] = 1.0;
            rates
        };
        let middle = f64::midpoint(pile.depths()[folding], pile.depths()[folding + 1]);
        assert_eq!(folded.fold_rate(0.0, &rates), 1.0);
        assert!((folded.fold_rate(middle, &rates) - 0.5).abs() < 1e-12);
        assert_eq!(folded.fold_rate(pile.depths()[folding + 1] + 1.0, &rates), 0.0);
    }

    proptest! {
        /// Whatever the folds, interfaces stay in order and the way from height to depth is the inverse of the way back.
        #[test]
        fn interfaces_never_cross_and_depth_is_the_inverse(
            base in -3000.0..8000.0f64,
            folds in proptest::collection::vec(0.0..4000.0f64, MAX_LAYERS + 1),
            z in -12_000.0..12_000.0f64,
            preset in 0..preset::names().len(),
        ) {
            let pile = preset::by_name(preset::names()[preset]).unwrap();
            let mut column = Column::new(&pile, base);
            for (interface, &raise) in folds.iter().enumerate() {
                column = column.folded(interface, raise);
            }
            for interface in 1..pile.depths().len() {
                let thickness = column.height(interface - 1) - column.height(interface);
                prop_assert!(thickness >= pile.layers()[interface - 1].thickness_m - 1e-6);
            }
            for (interface, &depth) in pile.depths().iter().enumerate() {
                prop_assert!((column.depth_at(column.height(interface)) - depth).abs() < 1e-6);
            }
            prop_assert!(column.depth_at(z) > column.depth_at(z + 1.0));
        }
    }
}
