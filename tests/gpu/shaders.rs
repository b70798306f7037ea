//! Every compute shader is valid, and every layout that Rust and a shader share is the same on both sides. No graphics
//! needed.

use crate::shader_common;
use crate::shader_common::{check, differences, layout};
use naga::{AddressSpace, Module, TypeInner};
use orogen::gpu::layout::{Body, Edge, Folds, Lines, Place, Problem, SHADERS, source};

fn parse(name: &str) -> Module {
    shader_common::parse(name, &source(name))
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
        layout!(Problem in "transport": cols, rows, bodies, exponent, rest_weight, per_cell),
        layout!(Body in "transport": spin, lift, radius, first, edges, solid),
        layout!(Edge in "transport": normal, beyond, along, length),
        layout!(Lines in "folds": buckets, first, half_length),
        layout!(Folds in "folds": crests, troughs, size, count, bucket, reach),
        layout!(Place in "folds": bucket, offset),
    ];
    for layout in &layouts {
        let found = differences(layout, &parse(layout.shader));
        assert!(found.is_empty(), "{found:?}");
    }
}

/// Bytes from one element to the next of the array of structs `name`.
fn stride(module: &Module, name: &str) -> Option<u32> {
    module.types.iter().find_map(|(_, ty)| match ty.inner {
        TypeInner::Array { base, stride, .. } if module.types[base].name.as_deref() == Some(name) => {
            Some(stride)
        }
        _ => None,
    })
}

#[test]
fn elements_of_arrays_are_as_large_on_both_sides() {
    let sizes = [
        ("transport", "Body", size_of::<Body>()),
        ("transport", "Edge", size_of::<Edge>()),
        ("folds", "Place", size_of::<Place>()),
    ];
    for (shader, name, size) in sizes {
        assert_eq!(stride(&parse(shader), name), Some(size as u32), "{name}");
    }
    assert_eq!(
        stride(&parse("transport"), "Problem"),
        None,
        "a uniform is no array"
    );
}

/// A program binds one uniform, then three arrays to read, then one to write.
#[test]
fn every_shader_binds_what_programs_bind() {
    for (name, _) in SHADERS {
        let module = parse(name);
        let mut found: Vec<(u32, bool, bool)> = module
            .global_variables
            .iter()
            .filter_map(|(_, variable)| {
                let binding = variable.binding?;
                let (storage, writes) = match variable.space {
                    AddressSpace::Storage { access } => (true, access.contains(naga::StorageAccess::STORE)),
                    _ => (false, false),
                };
                Some((binding.binding, storage, writes))
            })
            .collect();
        found.sort_unstable();
        let expected = [
            (0, false, false),
            (1, true, false),
            (2, true, false),
            (3, true, false),
            (4, true, true),
        ];
        assert_eq!(found, expected, "{name}");
    }
}
