//! Commands → the text of a `do`.

use std::fmt::Write as _;

use glam::DVec2;

use super::super::contact::Side;
use super::super::json::{write_number, write_position, write_text};
use super::{Action, Command, Place};

impl Command {
    /// Writes the canonical form: the word, then side and contact where known; no spaces; mm with two decimals.
    pub fn write_json(&self, out: &mut String) {
        let _ = write!(out, "{{\"{}\":", self.action.word());
        match &self.action {
            Action::Tool(tool) => write_text(out, tool.name()),
            Action::Mode(mode) => write_text(out, mode.name()),
            Action::Play
            | Action::Pause
            | Action::Undo
            | Action::StartOver
            | Action::CloseSlice
            | Action::Earth => out.push_str("true"),
            Action::Speed(v) | Action::Scrub(v) => write_number(out, *v),
            Action::Remove { at } | Action::FlipFault { at } => write_position(out, *at),
            Action::AddArrow(arrow) | Action::EditArrow(arrow) | Action::Slice(arrow) => {
                out.push_str("{\"from\":");
                write_position(out, arrow.from);
                out.push_str(",\"to\":");
                write_position(out, arrow.to);
                out.push('}');
            }
            Action::Layers(name) => write_text(out, name),
            Action::Pile(pile) => write_text(out, &pile.to_toml()),
            Action::TurnFolds { path } => write_path(out, path),
            Action::RaiseFolds { path, by } => {
                out.push_str("{\"path\":");
                write_path(out, path);
                out.push_str(",\"by\":");
                write_number(out, *by);
                out.push('}');
            }
            Action::FreezeSlice(frozen) => out.push_str(if *frozen { "true" } else { "false" }),
            Action::LabelSlice { at, text } => {
                out.push_str("{\"at\":");
                write_number(out, *at);
                out.push_str(",\"text\":");
                write_text(out, text);
                out.push('}');
            }
            Action::Planet {
                plates,
                continental,
                seed,
            } => {
                let _ = write!(out, "{{\"plates\":{plates},\"continental\":");
                write_number(out, *continental);
                let _ = write!(out, ",\"seed\":{seed}}}");
            }
            Action::Cut { path } => {
                for (i, &place) in path.iter().enumerate() {
                    out.push(if i == 0 { '[' } else { ',' });
                    write_place(out, place);
                }
                out.push(']');
            }
            Action::Paint {
                at,
                radius_deg,
                paint,
            } => {
                out.push_str("{\"at\":");
                write_place(out, *at);
                out.push_str(",\"radius\":");
                write_number(out, *radius_deg);
                out.push_str(",\"crust\":");
                write_text(out, paint.name());
                out.push('}');
            }
            Action::View { lon, lat, zoom } => {
                for (start, value) in [("{\"lon\":", lon), (",\"lat\":", lat), (",\"zoom\":", zoom)] {
                    out.push_str(start);
                    write_number(out, *value);
                }
                out.push('}');
            }
        }
        match self.side {
            None => {}
            Some(Side::North) => out.push_str(",\"side\":\"north\""),
            Some(Side::South) => out.push_str(",\"side\":\"south\""),
        }
        if let Some(contact) = self.contact {
            let _ = write!(out, ",\"contact\":{contact}");
        }
        out.push('}');
    }
}

fn write_place(out: &mut String, place: Place) {
    for (start, value) in [('[', place.lat), (',', place.lon)] {
        out.push(start);
        write_number(out, value);
    }
    out.push(']');
}

fn write_path(out: &mut String, path: &[DVec2]) {
    out.push('[');
    for (i, &point) in path.iter().enumerate() {
        if i > 0 {
            out.push(',');
        }
        write_position(out, point);
    }
    out.push(']');
}
