//! The world: plain state, nothing else.

use std::sync::Arc;

use super::folding::LayerSkeleton;
use crate::isostasy::Crust;
use crate::mountain::PlateSet;
use crate::mountain::fold::{FoldDrive, FoldEdit};
use crate::mountain::strata::Strata;
use crate::rock::{Stratigraphy, preset};
use crate::survey::Underground;
use crate::terrain::{Resampling, Sediment, StartLand, Tin, TinError};
use crate::units::PlanMap;

/// Everything that the land is at one moment. Parameters and scratch memory live elsewhere, so a snapshot is a clone.
#[derive(Clone, Debug)]
pub struct World {
    /// The one seed: nodes and start land follow from it.
    pub seed: u64,
    /// How the table lies on the land.
    pub map: PlanMap,
    /// The nodes; never changed, so shared by all snapshots.
    pub tin: Arc<Tin>,
    /// The geological clock, years since the start.
    pub time_yr: f64,
    /// Land surface at each node, metres.
    pub z: Vec<f64>,
    /// The layers of rock as they were laid down.
    pub stratigraphy: Arc<Stratigraphy>,
    /// How far they have been moved at each node.
    pub strata: Strata,
    /// Crests of the folds, as the land last felt them.
    pub skeletons: Vec<LayerSkeleton>,
    /// What visitors have changed about folds.
    pub fold_edits: Vec<FoldEdit>,
    /// What has made the layers fold so far: the drive of each moment times its years, so that rates are metres, and the
    /// limit is metres per metre of wavelength. Pairs of layers that do not fold while the land is sculpted fold by it
    /// when it is refined. None where nothing has folded.
    pub folded: Option<Arc<FoldDrive>>,
    /// Loose sediment on the rock.
    pub sediment: Sediment,
    /// How the crust floats.
    pub crust: Crust,
    /// The plates, and what is left of their pushes.
    pub plates: PlateSet,
    /// When the last push began or changed, years; the world runs on from there.
    pub last_push_yr: f64,
    /// Volumes moved so far.
    pub totals: Totals,
}

/// Volumes moved since the start, m³.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Added by uplift (subsidence counts negative).
    pub uplifted_m3: f64,
    /// Taken away by rivers and landslides.
    pub eroded_m3: f64,
    /// Laid down by rivers and in lakes.
    pub deposited_m3: f64,
    /// Carried off the land as sediment.
    pub exported_m3: f64,
    /// Erosion steps.
    pub steps: u64,
}

impl World {
    /// The land before anybody touched it: 1 m noise on smooth ±150 m hills, over the default pile of rock.
    ///
    /// # Errors
    /// When that many nodes cannot be laid out.
    pub fn new(map: PlanMap, nodes: usize, seed: u64) -> Result<Self, TinError> {
        let tin = Arc::new(Tin::poisson(map.extent(), nodes, seed)?);
        let z = StartLand::new(seed).heights(&tin);
        let nodes_laid = tin.len();
        let strata = Strata::new(nodes_laid);
        Ok(Self {
            seed,
            map,
            tin,
            time_yr: 0.0,
            z,
            stratigraphy: preset::default(),
            strata,
            skeletons: Vec::new(),
            fold_edits: Vec::new(),
            folded: None,
            sediment: Sediment::new(nodes_laid),
            crust: Crust::new(nodes_laid),
            plates: PlateSet::default(),
            last_push_yr: 0.0,
            totals: Totals::default(),
        })
    }

    /// The same world over another pile of rock.
    #[must_use]
    pub fn with_layers(self, stratigraphy: Arc<Stratigraphy>) -> Self {
        Self { stratigraphy, ..self }
    }

    /// The same world on the nodes of `tin`, which `places` locates on the nodes it has: heights go over smoothly,
    /// displacements linearly.
    ///
    /// # Panics
    /// If `places` are not as many as the nodes.
    #[must_use]
    pub fn resampled(&self, tin: Arc<Tin>, places: &Resampling<'_>) -> Self {
        let z = places.smooth(&self.z);
        assert_eq!(z.len(), tin.len(), "one place per node");
        let mut strata = self.strata.clone();
        strata.resample(|values| places.linear(values));
        Self {
            z,
            strata,
            sediment: Sediment {
                thickness: places.linear(&self.sediment.thickness),
                // What waits on a slope is less than a step brings.
                debris: vec![0.0; tin.len()],
            },
            crust: Crust {
                root: places.linear(&self.crust.root),
                unanswered: places.linear(&self.crust.unanswered),
            },
            stratigraphy: Arc::clone(&self.stratigraphy),
            folded: self.folded.clone(),
            skeletons: self.skeletons.clone(),
            fold_edits: self.fold_edits.clone(),
            plates: self.plates.clone(),
            tin,
            ..*self
        }
    }

    /// The layers under the land, node by node.
    pub fn underground(&self) -> Underground<'_> {
        Underground {
            stratigraphy: &self.stratigraphy,
            base: self.strata.base(),
            folds: self
                .strata
                .folds()
                .map(|fold| (fold.interface, fold.raised.as_slice()))
                .collect(),
            sediment: &self.sediment.thickness,
            root: &self.crust.root,
        }
    }

    /// Books `years` of what makes layers fold.
    pub(super) fn has_folded(&mut self, drive: &FoldDrive, years: f64) {
        let sum = self
            .folded
            .get_or_insert_with(|| Arc::new(FoldDrive::still(drive.cos2.grid)));
        Arc::make_mut(sum).add(drive, years);
    }

    /// Memory that a snapshot of this world needs, bytes (the shared nodes not counted).
    pub fn snapshot_bytes(&self) -> usize {
        let folded = self.folded.as_ref().map_or(0, |drive| drive.bytes());
        5 * size_of_val(self.z.as_slice()) + self.strata.bytes() + folded
    }

    /// Memory of what is left of earlier pushes here and not in `before`, bytes: snapshots share the rest.
    pub(super) fn residue_bytes_beyond(&self, before: Option<&Self>) -> usize {
        let known = before.map_or(&[][..], |before| before.plates.residues());
        let residues = self.plates.residues().iter().map(|residue| &residue.uplift);
        residues
            .filter(|field| !known.iter().any(|other| Arc::ptr_eq(field, &other.uplift)))
            .map(|field| size_of_val(field.data.as_slice()))
            .sum()
    }
}
