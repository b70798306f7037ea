//! Folds: the wrinkles of layered rock under compression, after Cordonnier et al. 2018, section 5.
//!
//! Layers shortened along their length buckle at a wavelength that their thickness and stiffness set ([`wavelength`]).
//! Rather than by solving the buckling, folds are drawn on a random mesh whose edges are about as long as a fold is
//! wide ([`FoldMesh`]): the edges that lie best across the compression make the crests ([`Skeleton`]), lines between
//! them the troughs, and a cosine joins the two ([`FoldShape`]).
//!
//! | module | what it does |
//! |---|---|
//! | [`drive`] | what makes folds at a place: rate, direction, the limit of the shortening |
//! | [`mesh`] | the random triangulation of a layer |
//! | [`skeleton`] | which of its edges are crests |
//! | [`lines`] | troughs between crests, crests and troughs as polylines |
//! | [`edit`] | crests drawn or raised by hand |
//! | [`shape`] | heights between crests and troughs |
//! | [`rates`] | how fast folds grow |
//! | [`stats`] | figures of a fold graph for the report |
//! | [`wavelength`] | the law from layers to wavelength |
//!
//! A layer's mesh depends on its extent, wavelength and seed alone and is made once; a skeleton is a few bits per edge
//! and is cloned with the world; a shape is scratch, made anew from the two when the skeleton changes.
//!
//! Everything is in the plan frame, metres and years, deterministic for any number of threads.

pub mod drive;
mod edge_set;
pub mod edit;
pub mod lines;
pub mod mesh;
mod nearest;
pub mod rates;
pub mod shape;
pub mod skeleton;
pub mod stats;
pub mod wavelength;

pub use drive::{Drive, FoldDrive};
pub use edit::{FoldEdit, FoldEditKind};
pub use mesh::FoldMesh;
pub use nearest::PackedLines;
pub use rates::{FoldRates, PointRates};
pub use shape::{CpuFolds, FoldShape, FoldStage};
pub use skeleton::Skeleton;
pub use stats::FoldStats;

use crate::terrain::TinError;

/// Why there are no folds.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FoldError {
    /// A wavelength out of [`mesh::WAVELENGTHS`].
    #[error("fold wavelength of {wavelength} m: it must lie between {least} and {most} m")]
    Wavelength {
        /// What was asked for, metres.
        wavelength: f64,
        /// The shortest, metres.
        least: f64,
        /// The longest, metres.
        most: f64,
    },
    /// The land or its mesh cannot be made.
    #[error("no mesh for folds: {0}")]
    Mesh(#[from] TinError),
    /// A drawn path with too few points.
    #[error("a path of {found} points: at least {expected} are needed")]
    ShortPath {
        /// How many there are.
        found: usize,
        /// How many are needed.
        expected: usize,
    },
    /// A coordinate or a factor that is NaN or infinite.
    #[error("an edit of folds holds a number that is not finite")]
    NotFinite,
}
