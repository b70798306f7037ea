//! Folds too fine for the table.

use crate::mountain::strata::NodeFolds;
use crate::sim::World;
use crate::sim::folding::{Folding, folding_layers};

/// Growth over `years` of the folds that the nodes of `world` can show and that have not grown yet: the pairs of layers
/// that did not fold on the table, as far as what has made layers fold so far makes them. Their crests are noted in
/// `world`; the land has yet to feel them.
///
/// What the shortening of the crust pays for, `Σ (πA/λ)²/4`, has been spent in part by the folds that stand: the finer
/// ones share what is left.
pub(super) fn finer(world: &mut World, years: f64) -> Vec<NodeFolds> {
    let Some(drive) = world.folded.clone() else {
        return Vec::new();
    };
    let mut layers = folding_layers(&world.stratigraphy, world.tin.spacing(), usize::MAX);
    layers.retain(|layer| world.strata.folds().all(|fold| fold.interface != layer.interface));
    let (mut folds, skeletons) = Folding::default().rates(world, &drive, &layers);
    let wavelength = |interface: usize| {
        let layer = layers.iter().find(|layer| layer.interface == interface);
        layer.map_or(f64::INFINITY, |layer| layer.wavelength)
    };
    let spent = spent(world);
    let steep: Vec<f64> = folds
        .iter()
        .map(|fold| wavelength(fold.interface).recip())
        .collect();
    for (i, &p) in world.tin.positions().iter().enumerate() {
        let left = (drive.at(p).limit.powi(2) - spent[i]).max(0.0);
        let wanted: f64 = folds
            .iter()
            .zip(&steep)
            .map(|(fold, steep)| (fold.crests[i] * steep).powi(2))
            .sum();
        let part = if wanted > left {
            (left / wanted).sqrt()
        } else {
            1.0
        };
        for fold in &mut folds {
            for metres in [&mut fold.raised[i], &mut fold.crests[i]] {
                *metres *= part / years;
                if !metres.is_finite() {
                    *metres = 0.0;
                }
            }
        }
    }
    let known = std::mem::take(&mut world.skeletons);
    let kept = known
        .into_iter()
        .filter(|old| skeletons.iter().all(|new| new.interface != old.interface));
    world.skeletons = kept.chain(skeletons.iter().cloned()).collect();
    folds
}

/// `Σ (A/λ)²` of the folds that stand, at each node.
fn spent(world: &World) -> Vec<f64> {
    let mut sum = vec![0.0; world.tin.len()];
    for fold in world.strata.folds() {
        let mut known = world.skeletons.iter();
        let Some(layer) = known.find(|layer| layer.interface == fold.interface) else {
            continue;
        };
        let wavelength = layer.mesh.wavelength();
        for (sum, crest) in sum.iter_mut().zip(&fold.crests) {
            *sum += (crest / wavelength).powi(2);
        }
    }
    sum
}
