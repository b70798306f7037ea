//! mountain
