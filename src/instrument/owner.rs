//! Who owns a contact, and what it does for its owner.

use glam::DVec2;

use super::control::ControlId;
use super::deed::{Deed, Route, Scene};
use super::edit::Edit;
use super::fold::{Drawn, Stroke};
use super::press::{Finger, Press};
use super::table::Instrument;
use crate::gesture::command::{Action, Mode, Tool};
use crate::gesture::contact::{Contact, ContactKey, Side};

/// A half of the table that nobody has touched for so long is anybody's, µs: who stands alone at the table reaches across
/// with a tool.
const DESERTED_US: u64 = 10_000_000;

/// A contact that is down.
#[derive(Clone, Debug)]
pub(super) struct Held {
    pub(super) at: DVec2,
    pub(super) owner: Owner,
}

#[derive(Clone, Debug)]
pub(super) enum Owner {
    Land,
    Control(ControlId),
    /// The sheet of a side's cross-section; where the contact landed.
    Paper(Side, DVec2),
    Edit(Box<Edit>),
    /// It draws a line along folds.
    Stroke(Side, Box<Stroke>),
    /// It holds the handle of such a line.
    Handle(Side),
    /// It holds an end of a cross-section.
    End(Side),
    /// It landed where a tool works, and does nothing: a palm, or one finger too many.
    Idle,
    Panel,
    Corner,
    Wake,
}

impl Owner {
    pub(super) fn route(&self) -> Route {
        match self {
            Self::Land => Route::Land,
            Self::Control(_) | Self::Paper(..) => Route::Control,
            Self::Edit(_) | Self::Stroke(..) | Self::Handle(_) | Self::End(_) | Self::Idle => Route::Tool,
            Self::Panel => Route::Panel,
            Self::Corner => Route::Corner,
            Self::Wake => Route::Wake,
        }
    }
}

impl Instrument {
    pub(super) fn owner_of(&mut self, contact: &Contact, scene: &Scene<'_>) -> Owner {
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
        let nearest = self
            .placed
            .iter()
            .filter(|placed| placed.takes(at) && self.is_there(placed.id))
            .min_by(|a, b| a.distance(at).total_cmp(&b.distance(at)));
        if let Some(id) = nearest.map(|placed| placed.id) {
            if !palm {
                let mut press = Press::new(Finger::Contact(contact.key), self.now_us);
                press.at = at;
                self.presses.entry(id).or_insert(press);
            }
            return Owner::Control(id);
        }
        if let Some(paper) = self.papers().find(|paper| paper.holds(at)) {
            return Owner::Paper(paper.side, at);
        }
        if self.params.mode == Mode::Globe {
            return Owner::Land;
        }
        let (tool, side) = self.tool_at(at);
        if tool == Tool::Push || tool == Tool::View {
            return Owner::Land;
        }
        if palm {
            return Owner::Idle;
        }
        match tool {
            Tool::Fold => match self.drawn[side as usize].as_mut().filter(|drawn| drawn.takes(at)) {
                Some(drawn) => {
                    drawn.hold(at);
                    Owner::Handle(side)
                }
                None => Owner::Stroke(side, Box::new(Stroke::new(at))),
            },
            Tool::Slice if self.sections[side as usize].take(contact.key, at, self.now_us) => {
                Owner::End(side)
            }
            Tool::Slice => Owner::Idle,
            _ => {
                let motion_mm = self.params.gesture.motion_mm;
                Owner::Edit(Box::new(Edit::new(side, at, motion_mm, self.now_us, scene)))
            }
        }
    }

    /// Notes who is there: the side whose a contact is, which for the land is the half it lands on.
    pub(super) fn stir(&mut self, owner: &Owner, at: DVec2) {
        let side = match owner {
            Owner::Control(ControlId(side, _))
            | Owner::Paper(side, _)
            | Owner::Stroke(side, _)
            | Owner::Handle(side)
            | Owner::End(side) => *side,
            Owner::Edit(edit) => edit.side,
            Owner::Land => Side::of(at, self.params.size_mm),
            Owner::Idle | Owner::Panel | Owner::Corner | Owner::Wake => return,
        };
        self.stirred_us[side as usize] = Some(self.now_us);
    }

    /// True where a side's tool also works on the other half, because nobody is there.
    fn reaches_across(&self, side: Side) -> bool {
        let other = side.opposite();
        let deserted = self.stirred_us[other as usize]
            .is_none_or(|since_us| self.now_us.saturating_sub(since_us) > DESERTED_US);
        let is_down = |held: &Held| {
            matches!(held.owner, Owner::Land) && Side::of(held.at, self.params.size_mm) == other
        };
        let works = match self.tool(side) {
            Tool::Edit | Tool::Fold => true,
            // The ends of one that is there have handles.
            Tool::Slice => self.cuts[side as usize].is_none(),
            Tool::Push | Tool::View | Tool::Land | Tool::Sea => false,
        };
        works && deserted && !self.contacts.values().any(is_down)
    }

    /// Which tool of which side a finger that lands there works with: handles are their side's wherever they are.
    fn tool_at(&self, at: DVec2) -> (Tool, Side) {
        let own = Side::of(at, self.params.size_mm);
        for side in [own, own.opposite()] {
            let takes = match self.tool(side) {
                Tool::Fold => self.drawn[side as usize]
                    .as_ref()
                    .is_some_and(|drawn| drawn.takes(at)),
                Tool::Slice => self.sections[side as usize].takes(at, self.now_us),
                _ => false,
            };
            if takes {
                return (self.tool(side), side);
            }
        }
        match self.tool(own) {
            Tool::Push if self.reaches_across(own.opposite()) => (self.tool(own.opposite()), own.opposite()),
            Tool::Push if self.clock.paused => (Tool::Edit, own),
            tool => (tool, own),
        }
    }

    pub(super) fn shift(&mut self, contact: &Contact) -> Route {
        let palm = self.is_palm(contact);
        let Some(held) = self.contacts.get_mut(&contact.key) else {
            return Route::Ignored;
        };
        let (key, at, now_us) = (contact.key, contact.position, self.now_us);
        held.at = at;
        let route = held.owner.route();
        match &mut held.owner {
            Owner::Edit(edit) => edit.shift(at),
            Owner::Stroke(_, stroke) => stroke.shift(at),
            Owner::Handle(side) => {
                if let Some(drawn) = &mut self.drawn[*side as usize] {
                    drawn.shift(at);
                }
            }
            Owner::End(side) => self.sections[*side as usize].shift(key, at, now_us),
            Owner::Control(id) => {
                let id = *id;
                let holds = self.placed.iter().any(|p| p.id == id && p.holds(at));
                let press = self.presses.get_mut(&id);
                if let Some(press) = press.filter(|press| press.finger == Finger::Contact(key)) {
                    press.shift(at, holds, now_us);
                    if palm {
                        self.presses.remove(&id);
                    }
                }
            }
            Owner::Land | Owner::Paper(..) | Owner::Idle | Owner::Panel | Owner::Corner | Owner::Wake => {}
        }
        if palm && route == Route::Tool {
            self.forget(key);
        }
        route
    }

    /// A finger of a tool has turned out to be a palm: what it has not yet done it does not do.
    fn forget(&mut self, key: ContactKey) {
        if let Some(held) = self.contacts.get_mut(&key) {
            let owner = std::mem::replace(&mut held.owner, Owner::Idle);
            self.let_go(key, &owner, false);
        }
    }

    /// The contact no longer holds what it held.
    fn let_go(&mut self, key: ContactKey, owner: &Owner, lifted: bool) {
        match owner {
            Owner::Handle(side) => {
                if let Some(drawn) = &mut self.drawn[*side as usize] {
                    drawn.release();
                }
            }
            Owner::End(side) => self.sections[*side as usize].release(key, lifted),
            _ => {}
        }
    }

    /// A contact that `held` something has lifted, or is withdrawn.
    pub(super) fn end(&mut self, key: ContactKey, mut held: Held, lifted: bool, scene: &Scene<'_>) {
        let (now_us, motion_mm) = (self.now_us, self.params.gesture.motion_mm);
        if lifted {
            match &mut held.owner {
                Owner::Edit(edit) => {
                    let action = edit.lift(now_us, scene);
                    self.command(action, edit.side, Some(key));
                }
                Owner::Stroke(side, stroke) => {
                    // A tap lets the handle of the last line go.
                    let path = stroke.finished(motion_mm);
                    self.drawn[*side as usize] = path.clone().map(|path| Drawn::new(*side, path, now_us));
                    self.command(path.map(|path| Action::TurnFolds { path }), *side, Some(key));
                }
                Owner::Handle(side) => {
                    let drawn = self.drawn[*side as usize].as_mut();
                    let action = drawn.and_then(|drawn| drawn.due(now_us, true));
                    self.command(action, *side, Some(key));
                }
                Owner::End(side) => {
                    let action = self.sections[*side as usize].due(now_us, true);
                    self.command(action, *side, Some(key));
                }
                Owner::Paper(side, from)
                    if !self.params.unattended && held.at.distance(*from) < motion_mm =>
                {
                    let at = self.papers[*side as usize].part(held.at);
                    self.deeds.push(Deed::Note { side: *side, at });
                }
                _ => {}
            }
        }
        if let Owner::Control(id) = held.owner {
            self.release(id, Finger::Contact(key), lifted);
        }
        self.let_go(key, &held.owner, lifted);
    }

    fn is_palm(&self, contact: &Contact) -> bool {
        let wide = contact
            .size_mm
            .is_some_and(|size| size.max_element() > self.params.gesture.palm_mm);
        wide || contact.confidence == Some(0.0)
    }
}
