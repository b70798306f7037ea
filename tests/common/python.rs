//! Python with the programs of others.
//!
//! It is looked for in `OROGEN_PEERS_PYTHON`, `target/peers` (made by `python3 -m venv target/peers` and
//! `target/peers/bin/pip install -r REQUIREMENTS`), and `python3`. Where it is missing each test says so and passes,
//! unless `OROGEN_REQUIRE_PEERS=1`.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A Python that can import the modules, or `None` after saying what is skipped.
pub(crate) fn with_modules(modules: &str) -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let given = std::env::var_os("OROGEN_PEERS_PYTHON").map(PathBuf::from);
    let candidates = [
        given,
        Some(root.join("target/peers/bin/python")),
        Some("python3".into()),
    ];
    let imports = |python: &PathBuf| {
        let imported = Command::new(python)
            .args(["-c", &format!("import {modules}")])
            .output();
        imported.is_ok_and(|output| output.status.success())
    };
    let found = candidates.into_iter().flatten().find(imports);
    if found.is_none() {
        let required = std::env::var_os("OROGEN_REQUIRE_PEERS").is_some_and(|v| v == "1");
        assert!(!required, "OROGEN_REQUIRE_PEERS=1, but no Python has {modules}");
        // Past the test harness, which keeps what passing tests print to itself.
        let _ = writeln!(std::io::stderr(), "SKIPPED: no Python has {modules}");
    }
    found
}
