//! How far the layers of rock have been moved (paper section 6.2).
//!
//! Heights of interfaces are sums of rates over time, `h = H⁰ + ∫(u0 + Σ u_j) dt`, never rate × elapsed time, so that
//! strata do not jump when a push changes (D24). Kept are the rise of the whole pile, and for each pair of layers that
//! has folded the rise that its folds added; [`Column`] puts them together.

use crate::rock::{Column, Stratigraphy};
use crate::units::MYR;

/// What is less than this is not owed any more, metres.
const LEAST_OWED: f64 = 0.5;

/// How long folds take to follow an edit, years (time constant).
const EDIT_YEARS: f64 = 0.1 * MYR;

/// What the folds of one pair of layers add, node by node: rates (m/yr) or sums (m).
#[derive(Clone, Debug, PartialEq)]
pub struct NodeFolds {
    /// The interface that folds: the top of the weaker layer.
    pub interface: usize,
    /// How far the node is raised.
    pub raised: Vec<f64>,
    /// How far it would be, were it on a crest.
    pub crests: Vec<f64>,
}

/// The folds of one pair of layers so far.
#[derive(Clone, Debug, PartialEq)]
struct FoldSum {
    sum: NodeFolds,
    /// What edits have promised and the land has not felt yet, metres; empty where nothing is.
    owed: Vec<f64>,
}

/// Rise of the pile and of its folds at each node, metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Strata {
    base: Vec<f64>,
    /// In the order in which they began.
    folds: Vec<FoldSum>,
}

impl Strata {
    /// Undisturbed layers under `nodes` nodes.
    pub fn new(nodes: usize) -> Self {
        Self {
            base: vec![0.0; nodes],
            folds: Vec::new(),
        }
    }

    /// Moves the layers on by `years`: the pile as a whole at `base` m/yr, folds at their own rates.
    ///
    /// # Panics
    /// If a fold does not hold one value per node.
    pub fn advance(&mut self, base: impl Fn(usize) -> f64, folds: &[NodeFolds], years: f64) {
        for (i, sum) in self.base.iter_mut().enumerate() {
            *sum += base(i) * years;
        }
        for fold in folds {
            let sum = &mut self.fold(fold.interface).sum;
            for (sums, rates) in [(&mut sum.raised, &fold.raised), (&mut sum.crests, &fold.crests)] {
                assert_eq!(sums.len(), rates.len(), "one rate per node");
                for (sum, rate) in sums.iter_mut().zip(rates) {
                    *sum += rate * years;
                }
            }
        }
    }

    fn fold(&mut self, interface: usize) -> &mut FoldSum {
        let known = self.folds.iter().position(|fold| fold.sum.interface == interface);
        let at = known.unwrap_or_else(|| {
            self.folds.push(FoldSum {
                sum: NodeFolds {
                    interface,
                    raised: vec![0.0; self.base.len()],
                    crests: vec![0.0; self.base.len()],
                },
                owed: Vec::new(),
            });
            self.folds.len() - 1
        });
        &mut self.folds[at]
    }

    /// Promises the folds of an interface to change by `part(node)` of the height of their crests. Folds are never turned
    /// inside out.
    pub fn owe(&mut self, interface: usize, part: impl Fn(usize) -> f64) {
        let fold = self.fold(interface);
        fold.owed.resize(fold.sum.raised.len(), 0.0);
        let sums = fold.sum.raised.iter().zip(&fold.sum.crests);
        for (i, (owed, (&raised, &crest))) in fold.owed.iter_mut().zip(sums).enumerate() {
            *owed = (*owed + part(i) * crest).max(-raised);
        }
    }

    /// Hands out what is owed for the next `years`, as rates: to be added to those of the step.
    pub fn pay(&mut self, years: f64) -> Vec<NodeFolds> {
        let part = 1.0 - (-years / EDIT_YEARS).exp();
        let mut paid = Vec::new();
        for fold in &mut self.folds {
            if fold.owed.is_empty() {
                continue;
            }
            let rates = fold.owed.iter().map(|owed| owed * part / years).collect();
            let mut most = 0.0_f64;
            for owed in &mut fold.owed {
                *owed *= 1.0 - part;
                most = most.max(owed.abs());
            }
            if most < LEAST_OWED {
                fold.owed.clear();
            }
            paid.push(NodeFolds {
                interface: fold.sum.interface,
                raised: rates,
                crests: vec![0.0; fold.sum.raised.len()],
            });
        }
        paid
    }

    /// True while edits are owed.
    pub fn owes(&self) -> bool {
        self.folds.iter().any(|fold| !fold.owed.is_empty())
    }

    /// Rise of the pile as a whole, metres.
    pub fn base(&self) -> &[f64] {
        &self.base
    }

    /// What folds have added, metres.
    pub fn folds(&self) -> impl Iterator<Item = &NodeFolds> {
        self.folds.iter().map(|fold| &fold.sum)
    }

    /// The layers under a node.
    pub fn column<'a>(&self, stratigraphy: &'a Stratigraphy, node: usize) -> Column<'a> {
        self.folds
            .iter()
            .fold(Column::new(stratigraphy, self.base[node]), |column, fold| {
                column.folded(fold.sum.interface, fold.sum.raised[node])
            })
    }

    /// Lays another pile under the land as it stands: it has risen as far as the surface has, and has not folded yet.
    pub fn relay(&mut self) {
        for fold in self.folds.drain(..) {
            for (base, raised) in self.base.iter_mut().zip(fold.sum.raised) {
                *base += raised;
            }
        }
    }

    /// Carries all displacements to other nodes: `sample(values)` gives the values there.
    pub fn resample(&mut self, mut sample: impl FnMut(&[f64]) -> Vec<f64>) {
        self.base = sample(&self.base);
        for fold in &mut self.folds {
            fold.sum.raised = sample(&fold.sum.raised);
            fold.sum.crests = sample(&fold.sum.crests);
            if !fold.owed.is_empty() {
                fold.owed = sample(&fold.owed);
            }
        }
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        let owed = self.folds.iter().filter(|fold| !fold.owed.is_empty()).count();
        size_of_val(self.base.as_slice()) * (1 + 2 * self.folds.len() + owed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rock::preset;

    fn folds(interface: usize, values: [f64; 2]) -> NodeFolds {
        NodeFolds {
            interface,
            raised: values.to_vec(),
            crests: vec![1e-3; 2],
        }
    }

    #[test]
    fn displacement_is_the_integral_of_changing_rates() {
        let pile = preset::default();
        let mut strata = Strata::new(2);
        strata.advance(|i| [1e-3, 0.0][i], &[], 1e6);
        strata.advance(|i| [0.0, 2e-3][i], &[folds(3, [0.0, 1e-3])], 1e5);
        strata.advance(|_| 0.0, &[folds(3, [0.0, 1e-3]), folds(1, [2e-3, 0.0])], 1e5);
        let tops = [strata.column(&pile, 0), strata.column(&pile, 1)].map(|column| column.height(0));
        assert!(
            (tops[0] - 1200.0).abs() < 1e-9 && (tops[1] - 400.0).abs() < 1e-9,
            "{tops:?}"
        );
        let third = strata.column(&pile, 1).height(3) + pile.depths()[3];
        assert!(
            (third - 400.0).abs() < 1e-9,
            "a fold raises its interface and all above"
        );
        let fourth = strata.column(&pile, 1).height(4) + pile.depths()[4];
        assert!((fourth - 200.0).abs() < 1e-9, "and none below");
    }

    #[test]
    fn resampling_carries_everything() {
        let mut strata = Strata::new(2);
        strata.advance(|i| [1.0, 3.0][i], &[folds(1, [5.0, 7.0])], 1.0);
        strata.resample(|v| vec![v[0], f64::midpoint(v[0], v[1]), v[1]]);
        assert_eq!(strata.base(), [1.0, 2.0, 3.0]);
        assert_eq!(strata.folds().next().unwrap().raised, [5.0, 6.0, 7.0]);
    }

    #[test]
    fn what_is_owed_is_paid_in_full_and_never_turns_a_fold_inside_out() {
        let mut strata = Strata::new(2);
        strata.advance(|_| 0.0, &[folds(1, [5e-4, 1e-4])], 1e6);
        strata.owe(1, |i| [0.25, -1.0][i]);
        assert!(strata.owes());
        let mut paid = [0.0; 2];
        for _ in 0..40 {
            for fold in strata.pay(5e4) {
                for (sum, rate) in paid.iter_mut().zip(&fold.raised) {
                    *sum += rate * 5e4;
                }
                strata.advance(|_| 0.0, &[fold], 5e4);
            }
        }
        assert!(!strata.owes());
        // A crest has grown by 1 km; the second node has only 100 m to lose.
        assert!(
            (paid[0] - 250.0).abs() < 1.0 && (paid[1] + 100.0).abs() < 1.0,
            "{paid:?}"
        );
        assert!(strata.folds().next().unwrap().raised[1] >= 0.0);
    }
}
