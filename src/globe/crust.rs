//! Crust at one sample, and the sets of samples that plates are.

use glam::{DQuat, Vec3};

use crate::surface::planet::Orogeny;

/// Thickness of oceanic crust where it forms, km.
pub(super) const OCEANIC_KM: f32 = 7.0;
/// Thickness of continental crust whose surface is at the sea's level, km.
pub(super) const CONTINENTAL_KM: f32 = 33.0;
/// Thickness that a kilometre of height takes: its root floats it (Airy; densities 2.83 and 3.30 g/cm³).
pub(super) const ROOT: f32 = 7.02;

/// The crust at a sample (Cortial et al. 2019, Table 1). Directions are in the frame of its plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crust {
    /// Height of the surface, km, without a trench (z).
    pub z: f32,
    /// How far a trench cuts below that, km, negative or zero.
    pub trench: f32,
    /// Thickness, km (e).
    pub thickness: f32,
    /// Age of oceanic crust, My (`a_o`).
    pub age: f32,
    /// Time since mountains were last built, My (`a_c`).
    pub orogeny_age: f32,
    /// Along the belt's motion (f), or zero.
    pub fold: Vec3,
    /// Along the ridge (r), or zero.
    pub ridge: Vec3,
    /// Continental, else oceanic (`x_C`).
    pub continental: bool,
    /// What built the mountains (o).
    pub orogeny: Orogeny,
}

impl Crust {
    /// New sea floor.
    pub fn oceanic(z: f32, age: f32) -> Self {
        Self {
            z,
            trench: 0.0,
            thickness: OCEANIC_KM,
            age,
            orogeny_age: 0.0,
            fold: Vec3::ZERO,
            ridge: Vec3::ZERO,
            continental: false,
            orogeny: Orogeny::None,
        }
    }

    /// Old land.
    pub fn continental(z: f32) -> Self {
        Self {
            continental: true,
            thickness: CONTINENTAL_KM + ROOT * z,
            ..Self::oceanic(z, 0.0)
        }
    }

    /// Height of the surface with the trench, km.
    pub fn surface_km(&self) -> f32 {
        self.z + self.trench
    }

    /// Raises the surface and its root, km.
    pub fn raise(&mut self, dz: f32) {
        self.z += dz;
        if self.continental {
            self.thickness += ROOT * dz;
        }
    }

    /// The same crust in a frame that is turned by `turn`.
    #[must_use]
    pub fn turned(mut self, turn: DQuat) -> Self {
        let turn = turn.as_quat();
        self.fold = turn * self.fold;
        self.ridge = turn * self.ridge;
        self
    }
}

/// A bit for each sample of the lattice.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Marks(Vec<u64>);

impl Marks {
    /// Marks of `members` among `samples`.
    pub(super) fn new(samples: usize, members: impl IntoIterator<Item = u32>) -> Self {
        let mut bits = vec![0_u64; samples.div_ceil(64)];
        for i in members {
            bits[i as usize / 64] |= 1 << (i % 64);
        }
        Self(bits)
    }

    /// True for a sample that is marked.
    pub(super) fn contains(&self, i: u32) -> bool {
        self.0[i as usize / 64] >> (i % 64) & 1 == 1
    }

    /// Takes a mark away. True where there was one.
    pub(super) fn remove(&mut self, i: u32) -> bool {
        let word = &mut self.0[i as usize / 64];
        let was = *word >> (i % 64) & 1 == 1;
        *word &= !(1 << (i % 64));
        was
    }

    /// The samples that are marked, ascending.
    pub(super) fn iter(&self) -> impl Iterator<Item = u32> {
        let words = (0..).zip(&self.0);
        words.flat_map(|(number, &word)| {
            std::iter::successors(Some(word), |rest| Some(rest & rest.wrapping_sub(1)))
                .take_while(|rest| *rest != 0)
                .map(move |rest| number * 64 + rest.trailing_zeros())
        })
    }
}

/// A set of samples of the lattice, with its members numbered in their order ("slots").
///
/// A bit per sample of the lattice and a count per word: membership and slot take constant time, and forty plates of
/// half a million samples take four megabytes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SampleSet {
    marks: Marks,
    /// Members before each word.
    before: Vec<u32>,
}

impl SampleSet {
    /// The set of `members`, which ascend, of a lattice of `samples`.
    pub fn new(samples: usize, members: &[u32]) -> Self {
        let marks = Marks::new(samples, members.iter().copied());
        let mut before = Vec::with_capacity(marks.0.len());
        let mut count = 0;
        for word in &marks.0 {
            before.push(count);
            count += word.count_ones();
        }
        Self { marks, before }
    }

    /// True for members.
    pub fn contains(&self, i: u32) -> bool {
        self.marks.contains(i)
    }

    /// The number of a member.
    pub fn slot(&self, i: u32) -> Option<u32> {
        let word = self.marks.0[i as usize / 64];
        let bit = i % 64;
        (word >> bit & 1 == 1)
            .then(|| self.before[i as usize / 64] + (word & ((1_u64 << bit) - 1)).count_ones())
    }
}
