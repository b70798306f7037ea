//! What is shared with the compute shaders: structs and constants. `tests/gpu/shaders.rs` compares the layouts.

use std::f32::consts::{LN_2, LOG2_E};
use std::fmt::Write as _;

use bytemuck::{Pod, Zeroable};

use crate::mountain::fold::shape::{FADE, QUOTIENT, TOUCH};
use crate::mountain::power::SQRT_HALF_BITS;
use crate::mountain::transport::rows::{RIM, UNIT};

/// As `Problem` in `shaders/transport.wgsl`, which says what the fields mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[expect(missing_docs, reason = "the shader's own struct says it")]
pub struct Problem {
    pub cols: u32,
    pub rows: u32,
    pub bodies: u32,
    pub exponent: f32,
    pub rest_weight: f32,
    pub per_cell: f32,
}

/// As `Body` in `shaders/transport.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[expect(missing_docs, reason = "the shader's own struct says it")]
pub struct Body {
    pub spin: [f32; 4],
    pub lift: [f32; 2],
    pub radius: f32,
    pub first: u32,
    pub edges: u32,
    pub solid: u32,
    /// To the next in an array.
    pub padding: [u32; 2],
}

/// As `Edge` in `shaders/transport.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[expect(missing_docs, reason = "the shader's own struct says it")]
pub struct Edge {
    pub normal: [f32; 2],
    pub beyond: f32,
    pub along: f32,
    pub length: f32,
    /// To the next in an array.
    pub padding: f32,
}

/// As `Lines` in `shaders/folds.wgsl`, which says what the fields mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[expect(missing_docs, reason = "the shader's own struct says it")]
pub struct Lines {
    pub buckets: [i32; 4],
    pub first: u32,
    pub half_length: f32,
    /// To the next in a uniform.
    pub padding: [u32; 2],
}

/// As `Folds` in `shaders/folds.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[expect(missing_docs, reason = "the shader's own struct says it")]
pub struct Folds {
    pub crests: Lines,
    pub troughs: Lines,
    pub size: [u32; 2],
    pub count: u32,
    pub bucket: f32,
    pub reach: f32,
    /// To a whole number of sixteen bytes.
    pub padding: [u32; 3],
}

/// As `Place` in `shaders/folds.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[expect(missing_docs, reason = "the shader's own struct says it")]
pub struct Place {
    pub bucket: i32,
    pub offset: f32,
}

/// How far the first look for the nearest line goes, in wavelengths: most places have one within it.
const FIRST_LOOK: f32 = 0.5;

/// Squared lengths that are divided by are at least this, m².
const LEAST_LENGTH: f32 = 1e-12;

/// Invocations along one side of a workgroup: no more than every adapter that computes can take.
pub(super) const SIDE: u32 = 16;

/// Squared distances are less, m².
const FARTHEST: f32 = f32::MAX;

/// The compute shaders, by name, as they are written; [`source`] makes modules of them.
pub const SHADERS: [(&str, &str); 2] = [
    ("transport", include_str!("../../shaders/transport.wgsl")),
    ("folds", include_str!("../../shaders/folds.wgsl")),
];

/// What shaders share.
const POWER: &str = include_str!("../../shaders/power.wgsl");

/// The whole text of a shader: the constants that Rust and shaders share, what shaders share, and its own.
pub fn source(name: &str) -> String {
    let mut text = String::new();
    let mut constant = |name: &str, value: &dyn std::fmt::Display| {
        // Writing into a string cannot fail.
        let _ = writeln!(text, "const {name} = {value};");
    };
    constant("SIDE", &format_args!("{SIDE}u"));
    constant("SQRT_HALF_BITS", &format_args!("{SQRT_HALF_BITS}u"));
    let numbers = [
        ("LN_2", LN_2),
        ("LOG2_E", LOG2_E),
        ("RIM", RIM),
        ("PER_UNIT", (1.0 / UNIT) as f32),
        ("LEAST_WEIGHT", f32::MIN_POSITIVE),
        ("FARTHEST", FARTHEST),
        ("FIRST_LOOK", FIRST_LOOK),
        ("LEAST_LENGTH", LEAST_LENGTH),
        ("TOUCH", TOUCH as f32),
        ("FADE_FROM", FADE[0] as f32),
        ("FADE_TO", FADE[1] as f32),
    ];
    for (name, value) in numbers {
        constant(name, &format_args!("{value:e}f"));
    }
    for (k, value) in QUOTIENT.iter().enumerate() {
        constant(&format!("QUOTIENT_{k}"), &format_args!("{value:e}f"));
    }
    let own = SHADERS
        .iter()
        .find(|(other, _)| *other == name)
        .map_or("", |(_, own)| own);
    format!("{text}{POWER}{own}")
}
