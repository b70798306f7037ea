//! Every shader is valid, and every layout that Rust and a shader share is the same on both sides. No graphics needed.

#![cfg(feature = "app")]

use std::mem::offset_of;

use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{Module, TypeInner};
use orogen::render::RenderQuality;
use orogen::render::layout::{Air, Frames, Globe, Ground, Reach, SHADERS, View, source};

/// Names of the fields of a Rust struct and their places in it, bytes.
struct Layout {
    name: &'static str,
    shader: &'static str,
    size: usize,
    fields: Vec<(&'static str, usize)>,
}

macro_rules! layout {
    ($type:ident in $shader:literal: $($field:ident),+) => {
        Layout {
            name: stringify!($type),
            shader: $shader,
            size: size_of::<$type>(),
            fields: vec![$((stringify!($field), offset_of!($type, $field))),+],
        }
    };
}

fn parse(name: &str) -> Module {
    let text = source(name, RenderQuality::SOFTWARE.light, (0.3, 0.8));
    match naga::front::wgsl::parse_str(&text) {
        Ok(module) => module,
        Err(error) => panic!("{name}: {}", error.emit_to_string(&text)),
    }
}

/// What differs between a Rust struct and the shader's struct of that name.
fn differences(layout: &Layout, module: &Module) -> Vec<String> {
    let found = module
        .types
        .iter()
        .find(|(_, ty)| ty.name.as_deref() == Some(layout.name));
    let Some((_, ty)) = found else {
        return vec![format!("{} is not in the shader", layout.name)];
    };
    let TypeInner::Struct { members, span } = &ty.inner else {
        return vec![format!("{} is no struct in the shader", layout.name)];
    };
    let mut differences = Vec::new();
    // A uniform's size is rounded up to its alignment.
    if layout.size.next_multiple_of(16) != (*span as usize).next_multiple_of(16) {
        differences.push(format!("{}: {} bytes against {span}", layout.name, layout.size));
    }
    let theirs: Vec<(&str, usize)> = members
        .iter()
        .map(|member| (member.name.as_deref().unwrap_or(""), member.offset as usize))
        .collect();
    if layout.fields != theirs {
        differences.push(format!("{}: {:?} against {theirs:?}", layout.name, layout.fields));
    }
    differences
}

#[test]
fn every_shader_is_valid() {
    for (name, _) in SHADERS {
        let module = parse(name);
        let checked = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module);
        assert!(checked.is_ok(), "{name}: {:?}", checked.err());
    }
}

#[test]
fn shared_layouts_are_the_same_on_both_sides() {
    let layouts = [
        layout!(Ground in "sheet": extent, grid, sheet, spacing, lowland, blend, exaggeration, tree_line, snow_line,
            summit, rim, deepest, ramp_low, ramp_high, aslant, pile, geology),
        layout!(View in "land": view_proj, eye, right, up, forward, extent, mesh, focus, gathering,
            lowland, plan, tilt, exaggeration, haze, lamp, encodes, dusk, layered),
        layout!(Air in "land": mist, distance, glow, horizon, middle, zenith, table),
        layout!(Reach in "rivers": from_to, half_widths, large),
        layout!(Globe in "globe": turn, centre, size, radius, octaves, lamp, encodes, window),
        layout!(Frames in "globe": turns),
    ];
    for layout in &layouts {
        let found = differences(layout, &parse(layout.shader));
        assert!(found.is_empty(), "{found:?}");
    }
}

#[test]
fn a_layout_that_drifts_is_found() {
    let module = parse("land");
    let swapped = layout!(Air in "land": distance, mist, glow, horizon, middle, zenith, table);
    assert_eq!(differences(&swapped, &module).len(), 1);
    let short = layout!(Air in "land": mist, distance, glow, horizon, middle, zenith);
    assert_eq!(differences(&short, &module).len(), 1);
    let unknown = Layout {
        name: "Moon",
        ..layout!(Air in "land": mist)
    };
    assert_eq!(differences(&unknown, &module).len(), 1);
}

#[test]
fn every_shader_file_is_in_the_list() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    for entry in std::fs::read_dir(folder).expect("shaders") {
        let path = entry.expect("entry").path();
        let name = path.file_stem().expect("name").to_string_lossy().into_owned();
        let shared = matches!(&*name, "ground" | "encode" | "pile");
        assert!(
            shared || SHADERS.iter().any(|(known, _)| *known == name),
            "{name}.wgsl"
        );
    }
}
