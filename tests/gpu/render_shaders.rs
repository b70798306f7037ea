//! Every shader is valid, and every layout that Rust and a shader share is the same on both sides. No graphics needed.

use crate::shader_common;
use crate::shader_common::{Layout, check, differences, layout};
use naga::Module;
use orogen::gpu;
use orogen::render::RenderQuality;
use orogen::render::layout::{Air, Frames, Globe, Ground, Reach, SHADERS, View, source};

fn parse(name: &str) -> Module {
    shader_common::parse(name, &source(name, RenderQuality::SOFTWARE.light, (0.3, 0.8)))
}

#[test]
fn every_shader_is_valid() {
    for (name, _) in SHADERS {
        check(name, &parse(name));
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
        let shared = matches!(&*name, "ground" | "encode" | "pile" | "power");
        let mut listed = SHADERS.iter().chain(&gpu::layout::SHADERS);
        assert!(shared || listed.any(|(known, _)| *known == name), "{name}.wgsl");
    }
}
