//! A planet at one moment, for eyes and files: plain data on the samples of a lattice that does not move.

use std::sync::Arc;

use glam::{DQuat, DVec3, Vec3};

use crate::sphere::Lattice;

/// What built the mountains at a place (Cortial et al. 2019, Table 1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Orogeny {
    /// Nothing yet.
    #[default]
    None,
    /// A plate that plunged below this one.
    Andean,
    /// A continent that ran into this one.
    Himalayan,
}

/// What two plates do where they meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum BorderKind {
    /// They part: a ridge, or a rift on land.
    Ridge,
    /// One plunges below the other.
    Subduction,
    /// Two continents meet.
    Collision,
    /// They slide along each other.
    Transform,
}

/// A short piece of the border between two plates: the edge between two Voronoi cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Border {
    /// Its ends, unit vectors.
    pub ends: [Vec3; 2],
    /// The samples on either side of it. Where one plate plunges, the second belongs to it.
    pub samples: [u32; 2],
    /// What happens there.
    pub kind: BorderKind,
    /// How fast the two come closer (negative: part), mm/yr, at right angles to the border.
    pub closing_mm_per_yr: f32,
}

/// What a hand does with a plate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Grip {
    /// Nobody holds it.
    #[default]
    Free,
    /// A hand rests on it: it does not move.
    Anchored,
    /// A hand leads it.
    Led,
}

/// A plate as a whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlateFacts {
    /// Its name for life: numbers are not used again.
    pub id: u32,
    /// From its own frame to the world's.
    pub rotation: DQuat,
    /// Angular velocity, rad/My; the velocity at `p` is its cross product with `p`.
    pub omega: DVec3,
    /// Area, steradians.
    pub area_sr: f64,
    /// Share of its area that is continental.
    pub continental: f64,
    /// What a hand does with it.
    pub grip: Grip,
}

/// A planet at one moment. Fields that are lists have one entry per sample of the lattice, in the world's frame.
#[derive(Clone, Debug)]
pub struct Planet {
    /// Where the samples are.
    pub lattice: Arc<Lattice>,
    /// Model time, My.
    pub time_my: f64,
    /// Height above the sea, metres.
    pub elevation_m: Vec<f32>,
    /// Index into [`Self::plates`].
    pub plate: Vec<u16>,
    /// Continental crust, else oceanic.
    pub continental: Vec<bool>,
    /// Thickness of the crust, km.
    pub thickness_km: Vec<f32>,
    /// Age of oceanic crust, My; 0 on continents.
    pub age_my: Vec<f32>,
    /// What raised it.
    pub orogeny: Vec<Orogeny>,
    /// Time since then, My.
    pub orogeny_age_my: Vec<f32>,
    /// Direction of folds (across the belt), a unit vector in the tangent plane, or zero. Its sign means nothing.
    pub fold: Vec<Vec3>,
    /// Direction along the ridge that made oceanic crust, as [`Self::fold`].
    pub ridge: Vec<Vec3>,
    /// The plates; their order may change from moment to moment, their `id`s do not.
    pub plates: Vec<PlateFacts>,
    /// Where they meet.
    pub borders: Vec<Border>,
    /// Hot spots of the mantle, unit vectors.
    pub hot_spots: Vec<Vec3>,
}
