//! The instrument: contacts in, owners and deeds out.

use std::collections::BTreeMap;

use glam::DVec2;

use super::control::{ControlId, ControlKind, ControlView};
use super::deed::{Deed, EditView, Key, Route, Scene};
use super::edit::Edit;
use super::history;
use super::layout::{Placed, layout};
use super::press::{Finger, Press};
use super::speed;
use crate::gesture::command::{Action, Command, Tool};
use crate::gesture::contact::{Contact, ContactEvent, ContactKey, Phase, Side, Source};
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
    /// Figures are shown from the start.
    pub readouts: bool,
    /// What is a palm, and what is a motion.
    pub gesture: GestureParams,
}

/// The controls of both sides, and the owner of each contact.
#[derive(Clone, Debug)]
pub struct Instrument {
    params: InstrumentParams,
    placed: Vec<Placed>,
    /// As `placed`.
    glow: Vec<f64>,
    contacts: BTreeMap<ContactKey, Held>,
    /// Who presses a control. A control has one finger: of a palm's five contacts four do nothing.
    presses: BTreeMap<ControlId, Press>,
    /// Tools and figures of the north and south side.
    tools: [Tool; 2],
    readouts: [bool; 2],
    pointer: Option<DVec2>,
    clock: Clock,
    now_us: u64,
    deeds: Vec<Deed>,
}

/// A contact that is down.
#[derive(Clone, Debug)]
struct Held {
    at: DVec2,
    owner: Owner,
}

#[derive(Clone, Debug)]
enum Owner {
    Land,
    Control(ControlId),
    /// `None` for palms.
    Edit(Option<Box<Edit>>),
    Panel,
    Corner,
    Wake,
}

impl Owner {
    fn route(&self) -> Route {
        match self {
            Self::Land => Route::Land,
            Self::Control(_) => Route::Control,
            Self::Edit(_) => Route::Edit,
            Self::Panel => Route::Panel,
            Self::Corner => Route::Corner,
            Self::Wake => Route::Wake,
        }
    }
}

impl Instrument {
    /// Nothing is down; both sides push.
    pub fn new(params: InstrumentParams) -> Self {
        let placed = layout(params.size_mm, params.unattended);
        Self {
            glow: vec![0.0; placed.len()],
            placed,
            contacts: BTreeMap::new(),
            presses: BTreeMap::new(),
            tools: [Tool::Push; 2],
            readouts: [params.readouts; 2],
            pointer: None,
            clock: Clock::default(),
            now_us: 0,
            deeds: Vec::new(),
            params,
        }
    }

    /// What it was made for.
    pub fn params(&self) -> &InstrumentParams {
        &self.params
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
    /// first, then the staff's corner, the wakening from flight, controls, the edit tool (of the side's choice, or
    /// because the clock stands), and the land. The show's own contacts ([`Source::File`]) are always the land's.
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
                self.contacts.insert(key, Held { at, owner });
                route
            }
            Phase::Move => self.shift(contact),
            Phase::Up | Phase::Cancel => {
                let Some(held) = self.contacts.remove(&key) else {
                    return Route::Ignored;
                };
                let lifted = event.phase == Phase::Up;
                let route = held.owner.route();
                match held.owner {
                    Owner::Control(id) => self.release(id, Finger::Contact(key), lifted),
                    Owner::Edit(Some(mut edit)) if lifted => {
                        let action = edit.lift(now_us, scene);
                        self.command(action, edit.side, Some(key));
                    }
                    _ => {}
                }
                route
            }
        }
    }

    /// A key that stands in for a control of the south side goes down or up. Repeats of a key that is down do no harm,
    /// and let speed and history go on.
    pub fn key(&mut self, key: Key, down: bool, now_us: u64, scene: &Scene<'_>) {
        self.look(now_us, scene);
        let kind = match key {
            Key::PlayPause => ControlKind::PlayPause,
            Key::Undo => ControlKind::Undo,
            Key::Tool => ControlKind::Tool,
            Key::Readouts => ControlKind::Readouts,
            Key::Save => ControlKind::Save,
            Key::StartOver => ControlKind::StartOver,
            Key::Faster | Key::Slower if down => {
                let pace = speed::stepped(self.clock.pace_yr_per_s, key == Key::Faster);
                return self.command(Some(Action::Speed(pace)), Side::South, None);
            }
            Key::Back | Key::Forward if down => {
                let years = history::stepped(&self.clock, key == Key::Forward);
                return self.command(years.map(Action::Scrub), Side::South, None);
            }
            Key::Faster | Key::Slower | Key::Back | Key::Forward => return,
        };
        let id = ControlId(Side::South, kind);
        if !self.placed.iter().any(|placed| placed.id == id) {
            return;
        }
        if down {
            self.presses.entry(id).or_insert(Press::new(Finger::Key, now_us));
        } else {
            self.release(id, Finger::Key, true);
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
        let mut edits = Vec::new();
        for (key, held) in &mut self.contacts {
            if let Owner::Edit(Some(edit)) = &mut held.owner
                && let Some(action) = edit.tick(now_us, scene)
            {
                edits.push((action, edit.side, *key));
            }
        }
        for (action, side, key) in edits {
            self.command(Some(action), side, Some(key));
        }
    }

    /// What has been done since the last call, in order.
    pub fn drain(&mut self) -> Vec<Deed> {
        std::mem::take(&mut self.deeds)
    }

    /// The controls as they are now, north side first.
    pub fn controls(&self) -> Vec<ControlView> {
        let shown = |placed: &&Placed| placed.id.1 != ControlKind::Scrub || self.clock.paused;
        let each = self.placed.iter().zip(&self.glow);
        each.filter(|(placed, _)| shown(placed))
            .map(|(placed, &glow)| self.view(placed, glow))
            .collect()
    }

    /// What contacts of the edit tool are about, for drawing.
    pub fn edits(&self) -> Vec<EditView> {
        let owners = self.contacts.values().map(|held| &held.owner);
        owners
            .filter_map(|owner| match owner {
                Owner::Edit(Some(edit)) => Some(edit.view(self.now_us)),
                _ => None,
            })
            .collect()
    }

    /// Lets go of everything without acting: the window has lost its focus, or a visit is over. Contacts of the land
    /// stay the land's until they lift; all others are nobody's from now on.
    pub fn cancel_all(&mut self) {
        self.presses.clear();
        self.contacts.retain(|_, held| matches!(held.owner, Owner::Land));
    }

    /// Tools and figures become as on a new table, and everything is let go of. The session is told of the tools.
    pub fn reset(&mut self) {
        self.cancel_all();
        for side in [Side::North, Side::South] {
            if self.tool(side) != Tool::Push {
                self.tools[side as usize] = Tool::Push;
                self.command(Some(Action::Tool(Tool::Push)), side, None);
            }
            if self.readouts(side) != self.params.readouts {
                self.toggle_readouts(side);
            }
        }
    }

    /// The table is made for something else: another size, corner or kind.
    pub fn set_params(&mut self, params: InstrumentParams) {
        if params != self.params {
            self.cancel_all();
            self.placed = layout(params.size_mm, params.unattended);
            self.glow = vec![0.0; self.placed.len()];
            self.params = params;
        }
    }

    fn look(&mut self, now_us: u64, scene: &Scene<'_>) {
        self.now_us = now_us;
        self.clock = *scene.clock;
    }

    fn owner_of(&mut self, contact: &Contact, scene: &Scene<'_>) -> Owner {
        let (at, size_mm) = (contact.position, self.params.size_mm);
        let inside = |(least, most): &(DVec2, DVec2)| at.cmpge(*least).all() && at.cmple(*most).all();
        if scene.panels.iter().any(inside) {
            return Owner::Panel;
        }
        if self.params.corner.holds(at, size_mm) {
            return Owner::Corner;
        }
        if scene.in_flight {
            return Owner::Wake;
        }
        let palm = self.is_palm(contact);
        let paused = scene.clock.paused;
        let there = |placed: &&Placed| placed.takes(at) && (placed.id.1 != ControlKind::Scrub || paused);
        let nearest = self
            .placed
            .iter()
            .filter(there)
            .min_by(|a, b| a.distance(at).total_cmp(&b.distance(at)));
        if let Some(id) = nearest.map(|placed| placed.id) {
            if !palm {
                let mut press = Press::new(Finger::Contact(contact.key), self.now_us);
                press.at = at;
                self.presses.entry(id).or_insert(press);
            }
            return Owner::Control(id);
        }
        let side = Side::of(at, size_mm);
        if self.tool(side) == Tool::Edit || paused {
            let edit = || {
                Box::new(Edit::new(
                    side,
                    at,
                    self.params.gesture.motion_mm,
                    self.now_us,
                    scene,
                ))
            };
            return Owner::Edit((!palm).then(edit));
        }
        Owner::Land
    }

    fn shift(&mut self, contact: &Contact) -> Route {
        let palm = self.is_palm(contact);
        let Some(held) = self.contacts.get_mut(&contact.key) else {
            return Route::Ignored;
        };
        held.at = contact.position;
        let route = held.owner.route();
        match &mut held.owner {
            Owner::Edit(edit) => {
                if palm {
                    *edit = None;
                } else if let Some(edit) = edit {
                    edit.shift(contact.position);
                }
            }
            Owner::Control(id) => {
                let id = *id;
                let holds = self
                    .placed
                    .iter()
                    .any(|p| p.id == id && p.holds(contact.position));
                let now_us = self.now_us;
                let press = self.presses.get_mut(&id);
                if let Some(press) = press.filter(|press| press.finger == Finger::Contact(contact.key)) {
                    press.shift(contact.position, holds, now_us);
                    if palm {
                        self.presses.remove(&id);
                    }
                }
            }
            Owner::Land | Owner::Panel | Owner::Corner | Owner::Wake => {}
        }
        route
    }

    fn release(&mut self, id: ControlId, finger: Finger, lifted: bool) {
        if self.presses.get(&id).is_none_or(|press| press.finger != finger) {
            return;
        }
        if lifted {
            self.follow_slider(id, u64::MAX);
        }
        if let Some(press) = self.presses.remove(&id)
            && lifted
            // Between two looks of a slow machine it may have been held long enough.
            && (press.acts_on_lift(id.1) || press.held_long_enough(id.1, self.now_us))
        {
            self.act(id, finger);
        }
    }

    /// A control does what it does.
    fn act(&mut self, ControlId(side, kind): ControlId, finger: Finger) {
        let action = match kind {
            ControlKind::Tool => {
                let tool = &mut self.tools[side as usize];
                *tool = if *tool == Tool::Edit {
                    Tool::Push
                } else {
                    Tool::Edit
                };
                Action::Tool(*tool)
            }
            ControlKind::Undo if self.clock.can_undo[side as usize] => Action::Undo,
            ControlKind::PlayPause if self.clock.paused => Action::Play,
            ControlKind::PlayPause => Action::Pause,
            ControlKind::Speed => Action::Speed(speed::next(self.clock.pace_yr_per_s)),
            ControlKind::StartOver => Action::StartOver,
            ControlKind::Readouts => return self.toggle_readouts(side),
            ControlKind::Save => return self.deeds.push(Deed::Save { side }),
            ControlKind::Undo | ControlKind::Scrub => return,
        };
        self.command(Some(action), side, finger.contact());
    }

    fn toggle_readouts(&mut self, side: Side) {
        let on = !self.readouts(side);
        self.readouts[side as usize] = on;
        self.deeds.push(Deed::Readouts { side, on });
    }

    fn command(&mut self, action: Option<Action>, side: Side, contact: Option<ContactKey>) {
        self.deeds.extend(action.map(|action| {
            Deed::Command(Command {
                action,
                side: Some(side),
                contact: contact.map(|key| key.id),
            })
        }));
    }

    /// Sends the clock after the finger on a slider, not more often than the session can follow.
    fn follow_slider(&mut self, id: ControlId, now_us: u64) {
        let placed = self.placed.iter().find(|placed| placed.id == id);
        let (Some(placed), Some(press)) = (placed, self.presses.get_mut(&id)) else {
            return;
        };
        if id.1 != ControlKind::Scrub || !history::exists(&self.clock) {
            return;
        }
        if let Some(part) = press.follow(placed.along(press.at), now_us) {
            let contact = press.finger.contact();
            let years = history::years_at(&self.clock, part);
            self.command(Some(Action::Scrub(years)), id.0, contact);
        }
    }

    fn view(&self, placed: &Placed, glow: f64) -> ControlView {
        let ControlId(side, kind) = placed.id;
        let press = self.presses.get(&placed.id);
        ControlView {
            id: placed.id,
            side,
            kind,
            centre_mm: placed.centre,
            half_size_mm: placed.half,
            rotation: placed.rotation(),
            pressed: press.is_some_and(|press| press.inside),
            progress: press.map_or(0.0, |press| press.progress(kind, self.now_us)),
            on: match kind {
                ControlKind::Tool => self.tool(side) == Tool::Edit,
                ControlKind::PlayPause => !self.clock.paused,
                ControlKind::Readouts => self.readouts(side),
                _ => false,
            },
            enabled: match kind {
                ControlKind::Undo => self.clock.can_undo[side as usize],
                ControlKind::Scrub => history::exists(&self.clock),
                _ => true,
            },
            value: match kind {
                ControlKind::Speed => speed::place(self.clock.pace_yr_per_s),
                // While a finger drags it, the slider is where the finger is: the land follows.
                ControlKind::Scrub => {
                    press.map_or_else(|| history::place(&self.clock), |p| placed.along(p.at))
                }
                _ => 0.0,
            },
            glow: if press.is_some() { 1.0 } else { glow },
        }
    }

    fn is_palm(&self, contact: &Contact) -> bool {
        let wide = contact
            .size_mm
            .is_some_and(|size| size.max_element() > self.params.gesture.palm_mm);
        wide || contact.confidence == Some(0.0)
    }
}
