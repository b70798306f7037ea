//! The instrument: contacts in, owners and deeds out.

use std::collections::BTreeMap;

use glam::DVec2;

use super::control::{ControlId, ControlKind, Paper};
use super::deed::{Deed, EditView, FoldHandle, Route, Scene, SliceView};
use super::fold::Drawn;
use super::layout::{Layout, Placed, layout};
use super::owner::{Held, Owner};
use super::press::Press;
use super::slice::Section;
use crate::gesture::command::{Action, Command, Mode, Tool};
use crate::gesture::contact::{ContactEvent, ContactKey, Phase, Side, Source};
use crate::gesture::params::GestureParams;
use crate::live::Clock;
use crate::settings::Corner;

/// How far from a control a hand wakes it, mm.
const GLOW_REACH_MM: f64 = 160.0;

/// Times in which a control wakes and becomes quiet again, µs.
const WAKE_US: f64 = 120_000.0;
const QUIET_US: f64 = 1_200_000.0;

/// Longest time between two looks that counts for glow, µs: after a halt controls do not flash.
const LONGEST_TICK_US: u64 = 100_000;

/// What an instrument is made for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InstrumentParams {
    /// Size of the table, mm.
    pub size_mm: DVec2,
    /// The staff's corner.
    pub corner: Corner,
    /// True on unattended tables: nobody saves.
    pub unattended: bool,
    /// The artist's tools are offered: folds, and on attended tables the final land.
    pub artists: bool,
    /// The world that is shown. The globe's tools are its brushes.
    pub mode: Mode,
    /// Figures are shown from the start.
    pub readouts: bool,
    /// What is a palm, and what is a motion.
    pub gesture: GestureParams,
}

impl InstrumentParams {
    fn layout(&self) -> Layout {
        let flat = self.mode == Mode::Mountain;
        layout(self.size_mm, |kind| match kind {
            ControlKind::Save => flat && !self.unattended,
            ControlKind::Final => flat && !self.unattended && self.artists,
            ControlKind::Tool(Tool::Fold) => flat && self.artists,
            ControlKind::Tool(Tool::Land | Tool::Sea) => !flat,
            ControlKind::Tool(_)
            | ControlKind::Scrub
            | ControlKind::FreezeSlice
            | ControlKind::CloseSlice => flat,
            _ => true,
        })
    }
}

/// The controls of both sides, and the owner of each contact.
#[derive(Clone, Debug)]
pub struct Instrument {
    pub(super) params: InstrumentParams,
    pub(super) placed: Vec<Placed>,
    pub(super) papers: [Paper; 2],
    /// As `placed`.
    pub(super) glow: Vec<f64>,
    pub(super) contacts: BTreeMap<ContactKey, Held>,
    /// Who presses a control. A control has one finger: of a palm's five contacts four do nothing.
    pub(super) presses: BTreeMap<ControlId, Press>,
    /// What the north and the south side have: tools, figures, lines along folds, cross-sections.
    pub(super) tools: [Tool; 2],
    pub(super) readouts: [bool; 2],
    pub(super) drawn: [Option<Drawn>; 2],
    pub(super) sections: [Section; 2],
    /// Whether each side's cross-section is there, and whether it stays as it is.
    pub(super) cuts: [Option<bool>; 2],
    /// When somebody of the north and the south side last did something, µs.
    pub(super) stirred_us: [Option<u64>; 2],
    pointer: Option<DVec2>,
    pub(super) clock: Clock,
    /// How much is done of the final land that is being made, 0–1.
    pub(super) making: Option<f64>,
    pub(super) now_us: u64,
    pub(super) deeds: Vec<Deed>,
}

impl Instrument {
    /// Nothing is down; both sides push.
    pub fn new(params: InstrumentParams) -> Self {
        let Layout { placed, papers } = params.layout();
        Self {
            glow: vec![0.0; placed.len()],
            placed,
            papers,
            contacts: BTreeMap::new(),
            presses: BTreeMap::new(),
            tools: [Tool::Push; 2],
            readouts: [params.readouts; 2],
            drawn: [None, None],
            sections: [Section::default(), Section::default()],
            cuts: [None; 2],
            stirred_us: [None; 2],
            pointer: None,
            clock: Clock::default(),
            making: None,
            now_us: 0,
            deeds: Vec::new(),
            params,
        }
    }

    /// What it was made for.
    pub fn params(&self) -> &InstrumentParams {
        &self.params
    }

    /// How much is done of the final land that is being made, 0–1; none while there is none.
    pub fn set_making(&mut self, done: Option<f64>) {
        self.making = done;
    }

    /// The tool of a side.
    pub fn tool(&self, side: Side) -> Tool {
        self.tools[side as usize]
    }

    /// True while figures are shown to a side.
    pub fn readouts(&self, side: Side) -> bool {
        self.readouts[side as usize]
    }

    /// Takes what a contact does and says whose it is. The owner is decided when it lands, and stays: panels come
    /// first, then the staff's corner, the wakening from flight, controls, sheets of cross-sections, handles of tools, the
    /// side's tool (while the clock stands at least the edit tool), and the land. The show's own contacts ([`Source::File`]) are always the land's.
    ///
    /// What is the land's must be handed on with its ends, whatever happens here.
    pub fn feed(&mut self, event: &ContactEvent, now_us: u64, scene: &Scene<'_>) -> Route {
        let contact = &event.contact;
        let key = contact.key;
        if key.source == Source::File {
            return Route::Land;
        }
        self.look(now_us, scene);
        match event.phase {
            Phase::Down => {
                let owner = self.owner_of(contact, scene);
                let route = owner.route();
                let at = contact.position;
                self.stir(&owner, at);
                self.contacts.insert(key, Held { at, owner });
                route
            }
            Phase::Move => self.shift(contact),
            Phase::Up | Phase::Cancel => {
                let Some(held) = self.contacts.remove(&key) else {
                    return Route::Ignored;
                };
                let route = held.owner.route();
                self.end(key, held, event.phase == Phase::Up, scene);
                route
            }
        }
    }

    /// The mouse's pointer is there (table mm): it wakes controls as a hand does.
    pub fn point(&mut self, pointer: Option<DVec2>) {
        self.pointer = pointer;
    }

    /// Time goes on: what is held long enough acts, arrows and the slider follow their fingers, controls wake and
    /// become quiet. To be called once a frame.
    pub fn tick(&mut self, now_us: u64, scene: &Scene<'_>) {
        let passed_us = now_us.saturating_sub(self.now_us).min(LONGEST_TICK_US) as f64;
        self.look(now_us, scene);
        for (i, placed) in self.placed.iter().enumerate() {
            let hands = self.contacts.values().map(|held| held.at).chain(self.pointer);
            let near = hands.map(|at| placed.distance(at)).fold(f64::INFINITY, f64::min);
            let goal = (1.0 - near / GLOW_REACH_MM).max(0.0);
            let time = if goal > self.glow[i] { WAKE_US } else { QUIET_US };
            self.glow[i] += (goal - self.glow[i]) * (1.0 - (-passed_us / time).exp());
        }
        let mut done = Vec::new();
        for (id, press) in &mut self.presses {
            if press.held_long_enough(id.1, now_us) {
                press.done = true;
                done.push((*id, press.finger));
            }
        }
        for (id, finger) in done {
            self.act(id, finger);
        }
        for side in [Side::North, Side::South] {
            self.follow_slider(ControlId(side, ControlKind::Scrub), now_us);
        }
        let mut done = Vec::new();
        for (key, held) in &mut self.contacts {
            let (action, side) = match &mut held.owner {
                Owner::Edit(edit) => (edit.tick(now_us, scene), edit.side),
                Owner::Handle(side) => {
                    let drawn = self.drawn[*side as usize].as_mut();
                    (drawn.and_then(|drawn| drawn.due(now_us, false)), *side)
                }
                Owner::End(side) => (self.sections[*side as usize].due(now_us, false), *side),
                _ => continue,
            };
            done.push((action, side, *key));
        }
        for (action, side, key) in done {
            self.command(action, side, Some(key));
        }
    }

    /// What has been done since the last call, in order.
    pub fn drain(&mut self) -> Vec<Deed> {
        std::mem::take(&mut self.deeds)
    }

    /// What contacts of the edit tool are about, for drawing.
    pub fn edits(&self) -> Vec<EditView> {
        let owners = self.contacts.values().map(|held| &held.owner);
        owners
            .filter_map(|owner| match owner {
                Owner::Edit(edit) => Some(edit.view(self.now_us)),
                _ => None,
            })
            .collect()
    }

    /// Lines that fingers draw along folds now, table mm.
    pub fn strokes(&self) -> Vec<Vec<DVec2>> {
        let owners = self.contacts.values().map(|held| &held.owner);
        owners
            .filter_map(|owner| match owner {
                Owner::Stroke(_, stroke) => Some(stroke.points().collect()),
                _ => None,
            })
            .collect()
    }

    /// Lines that have been drawn along folds, with their handles.
    pub fn fold_handles(&self) -> impl Iterator<Item = FoldHandle<'_>> {
        self.drawn.iter().flatten().map(Drawn::view)
    }

    /// Cross-sections on the land, where fingers have set them: ahead of the session.
    pub fn slices(&self) -> impl Iterator<Item = SliceView> {
        let sides = [Side::North, Side::South].into_iter();
        sides.filter_map(|side| self.sections[side as usize].view(side, self.tool(side) == Tool::Slice))
    }

    /// Sheets of the cross-sections that are there.
    pub fn papers(&self) -> impl Iterator<Item = Paper> {
        let there = |paper: &Paper| self.cuts[paper.side as usize].is_some();
        self.papers.into_iter().filter(there)
    }

    /// Lets go of everything without acting: the window has lost its focus, or a visit is over. Contacts of the land
    /// stay the land's until they lift; all others are nobody's from now on.
    pub fn cancel_all(&mut self) {
        self.presses.clear();
        self.contacts.retain(|_, held| matches!(held.owner, Owner::Land));
        self.sections.iter_mut().for_each(Section::let_go);
        self.drawn.iter_mut().flatten().for_each(Drawn::release);
    }

    /// Tools and figures become as on a new table, and everything is let go of. The session is told of the tools.
    pub fn reset(&mut self) {
        self.cancel_all();
        for side in [Side::North, Side::South] {
            self.lay_down(side);
            self.stirred_us[side as usize] = None;
            if self.readouts(side) != self.params.readouts {
                self.toggle_readouts(side);
            }
        }
    }

    /// The table is made for something else: another size, corner or kind.
    pub fn set_params(&mut self, params: InstrumentParams) {
        if params != self.params {
            self.cancel_all();
            Layout {
                placed: self.placed,
                papers: self.papers,
            } = params.layout();
            self.glow = vec![0.0; self.placed.len()];
            self.params = params;
            for side in [Side::North, Side::South] {
                let kind = ControlKind::Tool(self.tool(side));
                if !self
                    .placed
                    .iter()
                    .any(|placed| placed.id == ControlId(side, kind))
                {
                    self.lay_down(side);
                }
            }
        }
    }

    /// The side's hands push again. The session is told, if that is news.
    fn lay_down(&mut self, side: Side) {
        if self.tool(side) != Tool::Push {
            self.take_up(side, Tool::Push);
            self.command(Some(Action::Tool(Tool::Push)), side, None);
        }
    }

    /// The side has another tool; what it began with the one before is left as it is.
    pub(super) fn take_up(&mut self, side: Side, tool: Tool) {
        self.tools[side as usize] = tool;
        self.drawn[side as usize] = None;
        self.sections[side as usize].let_go();
    }

    pub(super) fn look(&mut self, now_us: u64, scene: &Scene<'_>) {
        self.now_us = now_us;
        self.clock = *scene.clock;
        for (i, cut) in scene.cuts.iter().enumerate() {
            self.cuts[i] = cut.as_ref().map(|cut| cut.frozen);
            let known = cut
                .as_ref()
                .map(|cut| cut.ends.map(|end| scene.map.to_table(end)));
            self.sections[i].look(known, self.cuts[i] == Some(true), now_us);
        }
    }

    /// True while a control is there.
    pub(super) fn is_there(&self, id: ControlId) -> bool {
        match id.1 {
            ControlKind::Scrub => self.clock.paused,
            ControlKind::FreezeSlice | ControlKind::CloseSlice => self.cuts[id.0 as usize].is_some(),
            _ => true,
        }
    }

    pub(super) fn command(&mut self, action: Option<Action>, side: Side, contact: Option<ContactKey>) {
        self.deeds.extend(action.map(|action| {
            Deed::Command(Command {
                action,
                side: Some(side),
                contact: contact.map(|key| key.id),
            })
        }));
    }
}
