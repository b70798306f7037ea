//! Named piles: real ranges in a few layers.

use std::sync::{Arc, LazyLock};

use super::Stratigraphy;

/// The presets' files. The first is the default.
const FILES: [(&str, &str); 6] = [
    ("plain", include_str!("../../assets/strata/plain.toml")),
    ("jura", include_str!("../../assets/strata/jura.toml")),
    ("zagros", include_str!("../../assets/strata/zagros.toml")),
    ("andes", include_str!("../../assets/strata/andes.toml")),
    (
        "southern_alps",
        include_str!("../../assets/strata/southern_alps.toml"),
    ),
    ("digne", include_str!("../../assets/strata/digne.toml")),
];

static PRESETS: LazyLock<Vec<Arc<Stratigraphy>>> = LazyLock::new(|| {
    FILES
        .iter()
        .filter_map(|(name, text)| {
            let pile = Stratigraphy::parse(text.as_bytes(), name).ok()?;
            Some(Arc::new(pile))
        })
        .collect()
});

/// Names of all presets; the first is the default's.
pub fn names() -> [&'static str; FILES.len()] {
    FILES.map(|(name, _)| name)
}

/// The preset of that name.
pub fn by_name(name: &str) -> Option<Arc<Stratigraphy>> {
    PRESETS.iter().find(|pile| pile.name() == name).cloned()
}

/// The pile where nobody has chosen one.
pub fn default() -> Arc<Stratigraphy> {
    Arc::clone(&PRESETS[0])
}

/// A preset's file, as an artist may copy and change it.
pub fn file(name: &str) -> Option<&'static str> {
    FILES
        .iter()
        .find(|(known, _)| *known == name)
        .map(|(_, text)| *text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_reads_and_is_called_as_its_file() {
        for (name, text) in FILES {
            let pile = Stratigraphy::parse(text.as_bytes(), name).unwrap();
            assert_eq!(pile.name(), name);
            assert_eq!(by_name(name).as_deref(), Some(&pile));
        }
        assert_eq!(PRESETS.len(), FILES.len());
    }
}
