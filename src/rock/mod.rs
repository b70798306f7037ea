//! Rock: which layers lie on which, what each is made of, and where they are after the crust has moved.
//!
//! [`Stratigraphy`] is the pile as it was laid down, flat: layers with thickness, viscosity, erodibility and talus over a
//! crystalline basement. [`Column`] is the same pile at one place after folding: it tells how high each interface
//! stands, and which rock is found at a height. Named piles are in [`preset`]; artists write their own as TOML files.

mod bedding;
mod column;
mod file;
pub mod preset;
mod stratigraphy;

pub use bedding::Bedding;
pub use column::Column;
pub use file::StratigraphyError;
pub use stratigraphy::{
    Basement, BedRock, Bound, Colour, Layer, MAX_BEDS, MAX_LAYERS, Place, Rock, Stratigraphy, bounds,
};
