//! What the tests of shaders share: layouts of structs on both sides.

use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{Module, TypeInner};

/// Names of the fields of a Rust struct and their places in it, bytes.
pub(crate) struct Layout {
    pub(crate) name: &'static str,
    pub(crate) shader: &'static str,
    pub(crate) size: usize,
    pub(crate) fields: Vec<(&'static str, usize)>,
}

macro_rules! layout {
    ($type:ident in $shader:literal: $($field:ident),+) => {
        $crate::shader_common::Layout {
            name: stringify!($type),
            shader: $shader,
            size: size_of::<$type>(),
            fields: vec![$((stringify!($field), std::mem::offset_of!($type, $field))),+],
        }
    };
}
pub(crate) use layout;

/// Parses a shader, or says what is wrong with it.
pub(crate) fn parse(name: &str, text: &str) -> Module {
    match naga::front::wgsl::parse_str(text) {
        Ok(module) => module,
        Err(error) => panic!("{name}: {}", error.emit_to_string(text)),
    }
}

/// Nothing, for a valid module.
pub(crate) fn check(name: &str, module: &Module) {
    let checked = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(module);
    assert!(checked.is_ok(), "{name}: {:?}", checked.err());
}

/// What differs between a Rust struct and the shader's struct of that name.
pub(crate) fn differences(layout: &Layout, module: &Module) -> Vec<String> {
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
