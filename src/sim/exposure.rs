//! Which rock lies at the surface, and what that means for the land (paper section 6.2).

use rayon::prelude::*;

use super::World;
use crate::mountain::strata::NodeFolds;
use crate::rock::MAX_LAYERS;
use crate::terrain::Forcing;

/// Nodes per task. Fixed, so that no result depends on the number of threads.
const CHUNK: usize = 4096;

/// How each node rises, and how its rock stands up to erosion.
#[derive(Clone, Debug, Default)]
pub(super) struct Exposure {
    /// Rise of the rock at the surface, m/yr.
    pub(super) rise: Vec<f64>,
    /// Factor on the erosion constant.
    pub(super) erodibility: Vec<f64>,
    /// Talus slope tan θ.
    pub(super) talus: Vec<f64>,
}

impl Exposure {
    /// What drives a step of the land it was read from.
    pub(super) fn forcing(&self) -> Forcing<'_> {
        Forcing {
            erodibility: Some(&self.erodibility),
            talus: Some(&self.talus),
            ..Forcing::uplift(&self.rise)
        }
    }

    /// Changes what rivers and slides meet at node `i` by two factors: on its erodibility, and on its talus.
    pub(super) fn weaken(&mut self, factors: impl Fn(usize) -> [f64; 2]) {
        for (i, (erodibility, talus)) in self.erodibility.iter_mut().zip(&mut self.talus).enumerate() {
            let [weaker, steeper] = factors(i);
            *erodibility *= weaker;
            *talus *= steeper;
        }
    }

    /// Reads it from `world`, whose pile rises at `base` m/yr while `folds` grow.
    pub(super) fn read(&mut self, world: &World, base: &[f64], folds: &[&NodeFolds]) {
        for values in [&mut self.rise, &mut self.erodibility, &mut self.talus] {
            values.resize(world.tin.len(), 0.0);
        }
        let pile = &*world.stratigraphy;
        self.rise
            .par_chunks_mut(CHUNK)
            .zip(self.erodibility.par_chunks_mut(CHUNK))
            .zip(self.talus.par_chunks_mut(CHUNK))
            .enumerate()
            .for_each(|(chunk, ((rise, erodibility), talus))| {
                for k in 0..rise.len() {
                    let node = chunk * CHUNK + k;
                    let mut rates = [0.0; MAX_LAYERS + 1];
                    let column = world.strata.column(pile, node);
                    let depth = column.depth_at(world.z[node] - world.sediment.thickness[node]);
                    for fold in folds {
                        rates[fold.interface] += fold.raised[node];
                    }
                    rise[k] = base[node] + column.fold_rate(depth, &rates);
                    let rock = pile.bed_rock(pile.place(depth));
                    erodibility[k] = rock.erodibility;
                    talus[k] = rock.talus;
                }
            });
    }
}
