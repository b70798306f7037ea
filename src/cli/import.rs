//! `orogen import`: recordings of other tools → gesture files.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use glam::DVec2;

use super::ImportArgs;
use super::console::Console;
use super::failure::Failure;
use crate::export::OutDir;
use crate::gesture::file::{GestureFile, Header};
use crate::input::import::{ImportOptions, import_recording};
use crate::sim::SimParams;

/// Reads the recording of `args` and writes it as a gesture file.
pub(super) fn run(args: &ImportArgs) -> Result<(), Failure> {
    let name = args.file.display().to_string();
    let options = ImportOptions {
        range: args
            .range
            .as_deref()
            .map(|text| numbers("--range", "X0,X1,Y0,Y1", text))
            .transpose()?,
        size_mm: size_mm(args.size_mm.as_deref())?,
    };
    let file = File::open(&args.file).map_err(|error| Failure::input(format!("{name}: {error}")))?;
    let imported = import_recording(BufReader::new(file), &name, &options).map_err(Failure::input)?;
    for warning in &imported.warnings {
        Console::warn(warning);
    }
    // The picture shows the land as the session leaves it, but no younger than a push lasts: a short stroke has time to
    // become a range, and a long session is not worn down for another 5 My.
    let params = SimParams::default();
    let session_s = imported
        .frames
        .last()
        .map_or(0.0, |frame| frame.t_us as f64 / 1e6);
    let years = (params.run_on_yr - session_s * params.pace_yr_per_s).max(0.0);
    let header = Header {
        years: Some(years.round()),
        title: Some(imported.title),
        ..Header::new(imported.size_mm)
    };
    let gestures = GestureFile {
        header,
        frames: imported.frames,
        warnings: Vec::new(),
    };
    let (folder, target) = folder_and_name(&args.out)?;
    OutDir::create(folder)
        .and_then(|out| out.write(&target, |w| gestures.write(w).map(drop)))
        .map_err(Failure::input)?;
    Console::result(&args.out.display().to_string());
    Ok(())
}

/// What `--size-mm` says.
pub(super) fn size_mm(text: Option<&str>) -> Result<Option<DVec2>, Failure> {
    let size = text
        .map(|text| numbers::<2>("--size-mm", "W,H", text))
        .transpose()?;
    Ok(size.map(DVec2::from))
}

/// Folder and name of a file that is to be written.
pub(super) fn folder_and_name(path: &Path) -> Result<(&Path, String), Failure> {
    let name = path
        .file_name()
        .ok_or_else(|| Failure::input(format!("--out {}: expected a file name", path.display())))?;
    let folder = path
        .parent()
        .filter(|p| !p.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    Ok((folder, name.to_string_lossy().into_owned()))
}

/// `N` finite numbers, separated by commas.
fn numbers<const N: usize>(option: &str, form: &str, text: &str) -> Result<[f64; N], Failure> {
    let wrong = || Failure::input(format!("{option} {text}: expected {form}, {N} numbers"));
    let values = text
        .split(',')
        .map(|part| {
            part.trim()
                .parse::<f64>()
                .ok()
                .filter(|v| v.is_finite())
                .ok_or_else(wrong)
        })
        .collect::<Result<Vec<_>, _>>()?;
    values.try_into().map_err(|_| wrong())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_counted_and_checked() {
        assert_eq!(
            numbers::<2>("--size-mm", "W,H", "464.8, 255.6").expect("two"),
            [464.8, 255.6]
        );
        for wrong in ["", "1", "1,2,3", "1,x", "1,inf"] {
            let failure = numbers::<2>("--size-mm", "W,H", wrong).expect_err(wrong);
            assert!(
                failure.to_string().contains("expected W,H, 2 numbers"),
                "{failure}"
            );
        }
    }
}
