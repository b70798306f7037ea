//! The sheets of cross-sections: cut from the newest land, drawn by each side's wish, with notes typed on them.

use glam::DVec2;
use winit::event::{ElementState, KeyEvent};
use winit::keyboard::{Key, NamedKey};

use super::table::Table;
use crate::gesture::command::{Action, MAX_TEXT_CHARS};
use crate::gesture::contact::Side;
use crate::live::Frame;
use crate::slice::{Figure, FigureOptions, Label, Slice};
use crate::surface::Cut;
use crate::ui::Sight;
use crate::ui::section::{self, NoteDraft, letter};
use crate::units::KM;

/// Places along a cross-section for each point of its sheet's width: curves look smooth with fewer than one.
const PLACES_PER_POINT: f64 = 0.5;

/// Vertical exaggerations to choose from.
const EXAGGERATIONS: [f64; 5] = [5.0, 3.0, 2.0, 1.5, 1.0];

/// Parts of a sheet's width and height that the section itself may take.
const SECTION: DVec2 = DVec2::new(0.88, 0.6);

/// The figures of both sides, and the note that is being typed.
#[derive(Debug, Default)]
pub(super) struct Sheets {
    figures: [Option<Shown>; 2],
    typing: Option<(Side, NoteDraft)>,
    /// A note that has been typed.
    done: Option<(Side, NoteDraft)>,
}

/// A figure, and what it was made of.
#[derive(Debug)]
struct Shown {
    made_of: Subject,
    slice: Option<Slice>,
    figure: Option<Figure>,
    facts: String,
}

/// All that a figure hangs on.
#[derive(Clone, Debug, PartialEq)]
struct Subject {
    /// The land, where the figure follows it.
    land: Option<u64>,
    ends: [DVec2; 2],
    size: DVec2,
    notes: Vec<(f64, String)>,
}

impl Sheets {
    /// Cuts and lays out anew what has changed; asks for notes, and hands over those that have been typed.
    pub(super) fn follow(&mut self, table: &mut Table, sight: &Sight<'_>) {
        for paper in table.instrument().papers().collect::<Vec<_>>() {
            let side = paper.side;
            let ends = table.instrument().slices().find(|slice| slice.side == side);
            let frame = table.frame();
            let (Some(cut), Some(view)) = (&frame.cuts[side as usize], ends) else {
                continue;
            };
            let subject = Subject {
                land: (!cut.frozen).then_some(frame.land),
                ends: if cut.frozen {
                    cut.ends
                } else {
                    view.ends.map(|end| sight.map().to_plan(end))
                },
                size: section::figure_size(sight, &paper),
                notes: cut.notes.clone(),
            };
            let shown = &mut self.figures[side as usize];
            if shown.as_ref().is_none_or(|shown| shown.made_of != subject) {
                *shown = Some(Shown::new(shown.take(), subject, frame, cut, side));
            }
        }
        for side in [Side::North, Side::South] {
            if table.frame().cuts[side as usize].is_none() {
                self.figures[side as usize] = None;
                self.typing = self.typing.take().filter(|(of, _)| *of != side);
            }
        }
        if let Some((side, at)) = table.take_note() {
            let paper = table.instrument().papers().find(|paper| paper.side == side);
            let part = paper
                .zip(self.figure(side))
                .and_then(|(paper, figure)| section::part_of_length(sight, &paper, figure, at));
            // A tap beside the section ends the typing.
            self.typing = part.map(|at| {
                let text = String::new();
                (side, NoteDraft { at, text })
            });
        }
        if let Some((side, note)) = self.done.take() {
            let NoteDraft { at, text } = note;
            table.command(Action::LabelSlice { at, text }, side);
        }
    }

    /// What is on a side's sheet.
    pub(super) fn sheet(&self, side: Side) -> section::Sheet<'_> {
        let typing = self.typing.as_ref().filter(|(of, _)| *of == side);
        section::Sheet {
            figure: self.figure(side),
            facts: self.figures[side as usize]
                .as_ref()
                .map_or("", |shown| &shown.facts),
            draft: typing.map(|(_, draft)| draft),
        }
    }

    /// The figure of a side's cross-section.
    fn figure(&self, side: Side) -> Option<&Figure> {
        self.figures[side as usize].as_ref()?.figure.as_ref()
    }

    /// A key goes down while a note is being typed: true when it is the note's.
    pub(super) fn types(&mut self, key: &KeyEvent) -> bool {
        let Some((_, draft)) = &mut self.typing else {
            return false;
        };
        if key.state != ElementState::Pressed {
            return false;
        }
        match &key.logical_key {
            Key::Named(NamedKey::Escape) => self.typing = None,
            Key::Named(NamedKey::Enter) => {
                self.done = self
                    .typing
                    .take()
                    .filter(|(_, draft)| !draft.text.trim().is_empty());
            }
            Key::Named(NamedKey::Backspace) => drop(draft.text.pop()),
            _ => {
                let typed = key.text.iter().flat_map(|text| text.chars());
                let room = MAX_TEXT_CHARS - draft.text.chars().count().min(MAX_TEXT_CHARS);
                draft
                    .text
                    .extend(typed.filter(|letter| !letter.is_control()).take(room));
            }
        }
        true
    }
}

impl Shown {
    /// The figure of `subject`. What is frozen and has been cut before is laid out again, not cut again.
    fn new(before: Option<Self>, subject: Subject, frame: &Frame, cut: &Cut, side: Side) -> Self {
        let kept = before.filter(|before| cut.frozen && before.made_of.ends == subject.ends);
        let places = (subject.size.x * PLACES_PER_POINT) as usize;
        let slice = kept
            .and_then(|kept| kept.slice)
            .or_else(|| Slice::cut(&frame.surface, subject.ends, places).ok());
        let exaggeration = slice
            .as_ref()
            .map_or(1.0, |slice| exaggeration(slice, subject.size));
        let figure = slice.as_ref().map(|slice| {
            let options = FigureOptions {
                // It stands in the strip, in larger letters.
                heading: false,
                letter: letter(side),
                exaggeration: Some(exaggeration),
                crust: false,
                names: section::has_room_for_names(subject.size),
                labels: subject
                    .notes
                    .iter()
                    .map(|(at, text)| Label {
                        distance: at * slice.length(),
                        text: text.clone(),
                    })
                    .collect(),
                ..FigureOptions::default()
            };
            slice.figure(subject.size, &options)
        });
        let letter = letter(side);
        let facts = slice.as_ref().map(|slice| {
            let km = slice.length() / KM;
            let heights = if exaggeration == 1.0 {
                "true scale".to_owned()
            } else {
                format!("heights × {exaggeration}")
            };
            format!("{letter}–{letter}'  {km:.0} km   {heights}")
        });
        Self {
            made_of: subject,
            slice,
            figure,
            facts: facts.unwrap_or_default(),
        }
    }
}

/// The greatest exaggeration at which all that is to be seen has room on a sheet of `size`.
fn exaggeration(slice: &Slice, size: DVec2) -> f64 {
    let highest = |heights: &[f64]| heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = |heights: &[f64]| heights.iter().copied().fold(f64::INFINITY, f64::min);
    let (mut top, mut bottom) = (highest(&slice.ground), lowest(&slice.ground));
    if let Some(strata) = &slice.strata {
        let ends = (strata.interfaces.first(), strata.interfaces.last());
        if let (Some(first), Some(last)) = ends {
            top = top.max(highest(first));
            bottom = bottom.min(lowest(last));
        }
    }
    let room = SECTION * size;
    let fits = |times: &f64| (top - bottom + 2.0 * KM) * times * room.x / slice.length() <= room.y;
    EXAGGERATIONS.into_iter().find(fits).unwrap_or(1.0)
}
