//! The panel of rock layers and its files.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{Context, Rect};

use super::save::write_whole;
use super::table::Table;
use crate::gesture::command::{Action, Mode};
use crate::gesture::contact::Side;
use crate::input::pile::read_pile;
use crate::mountain::fold::wavelength::wavelength;
use crate::rock::{Stratigraphy, preset};
use crate::ui::layers::{LayersAction, LayersPanel, LayersView};

/// Where piles are kept, below the folder the program was started in.
const FOLDER: &str = "orogen-out/strata";
/// What their files end with.
const EXTENSION: &str = "toml";
/// Most files that are offered.
const MOST_FILES: usize = 64;

/// The panel, while it is open, and what it offers.
#[derive(Debug, Default)]
pub(super) struct Layers {
    panel: LayersPanel,
    open: bool,
    saved: Vec<String>,
    notice: Option<String>,
}

impl Layers {
    /// Opens the panel on the pile under the land, or closes it.
    pub(super) fn toggle(&mut self, table: &Table) {
        self.open = !self.open;
        if self.open {
            self.panel.open(&under(table));
            self.saved = saved();
            self.notice = None;
        }
    }

    /// Shows the panel, if it is open, and does what was pressed. Where it is, points.
    pub(super) fn show(&mut self, context: &Context, table: &mut Table, scale: f32) -> Option<Rect> {
        if !self.open || table.worlds().shown() != Mode::Mountain {
            return None;
        }
        let view = LayersView {
            pile: &under(table),
            saved: &self.saved,
            wavelength,
            notice: self.notice.as_deref(),
            scale,
        };
        let shown = self.panel.show(context, &view);
        for action in shown.actions {
            self.act(action, table);
        }
        Some(shown.rect)
    }

    fn act(&mut self, action: LayersAction, table: &mut Table) {
        self.notice = match action {
            LayersAction::Close => {
                self.open = false;
                None
            }
            LayersAction::Lay(pile) => {
                let known = preset::by_name(pile.name()).is_some_and(|known| known == pile);
                let action = if known {
                    Action::Layers(pile.name().to_owned())
                } else {
                    Action::Pile(pile)
                };
                table.command(action, Side::South);
                None
            }
            LayersAction::Save(name, pile) => {
                let path = file(&name);
                let done = write_whole(&path, pile.to_toml().as_bytes());
                self.saved = saved();
                Some(match done {
                    Ok(()) => path.display().to_string(),
                    Err(error) => format!("not kept: {error}"),
                })
            }
            LayersAction::Load(name) => match read_pile(&file(&name)) {
                Ok(pile) => {
                    self.panel.open(&pile);
                    None
                }
                Err(error) => Some(error.to_string()),
            },
        };
    }
}

/// The pile under the land as it is seen.
fn under(table: &Table) -> Arc<Stratigraphy> {
    let strata = table.frame().surface.strata.as_ref();
    strata.map_or_else(preset::default, |map| Arc::clone(&map.stratigraphy))
}

fn file(name: &str) -> PathBuf {
    Path::new(FOLDER).join(name).with_extension(EXTENSION)
}

/// Names of the piles that have been kept, in order. A folder that cannot be read holds none.
fn saved() -> Vec<String> {
    let entries = std::fs::read_dir(FOLDER).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|extension| extension == EXTENSION))
        .filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()))
        .collect();
    names.sort();
    names.truncate(MOST_FILES);
    names
}
