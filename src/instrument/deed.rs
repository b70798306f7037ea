//! What goes into the instrument and what comes out of it.

use glam::DVec2;

use crate::gesture::command::{Command, Mode, Tool};
use crate::gesture::contact::Side;
use crate::live::Clock;
use crate::surface::{Cut, FaultTrace, PlateMark};
use crate::units::PlanMap;

/// Where a contact goes, from where it lands to where it lifts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// To the session: it sculpts.
    Land,
    /// It is on a control, or on the sheet of a cross-section.
    Control,
    /// It is a tool's: it edits standing plates or folds, or sets a cross-section.
    Tool,
    /// It is on a panel (the staff menu), which is asked for what it means.
    Panel,
    /// It is in the staff's corner, and sculpts nothing even if it moves.
    Corner,
    /// It wakes the plan from flight, and sculpts nothing.
    Wake,
    /// It is nobody's: it did not land since the last [`super::Instrument::cancel_all`].
    Ignored,
}

/// What the instrument must see of the table to decide. Borrowed from the newest frame for one call.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// Plates that stand (plan metres).
    pub plates: &'a [PlateMark],
    /// Faults between them (plan metres).
    pub faults: &'a [FaultTrace],
    /// Cross-sections of the north and south side (plan metres).
    pub cuts: &'a [Option<Cut>; 2],
    /// Table ↔ plan.
    pub map: PlanMap,
    /// The geological clock.
    pub clock: &'a Clock,
    /// The view is not the plan: contacts that land now wake it.
    pub in_flight: bool,
    /// Rectangles (least and greatest corner, table mm) that belong to panels.
    pub panels: &'a [(DVec2, DVec2)],
}

/// What somebody has done.
#[derive(Clone, Debug, PartialEq)]
pub enum Deed {
    /// To be handed to the session and to the recording.
    Command(Command),
    /// The side has switched its figures on or off.
    Readouts {
        /// The side.
        side: Side,
        /// What they are now.
        on: bool,
    },
    /// The other world is to be shown.
    World {
        /// The side that asked.
        side: Side,
        /// Which one.
        mode: Mode,
    },
    /// The land is to be saved.
    Save {
        /// The side that asked.
        side: Side,
    },
    /// The final land is to be made, or given up.
    FinalLand {
        /// The side that asked.
        side: Side,
        /// True to make it.
        on: bool,
    },
    /// Somebody has tapped on the sheet of a cross-section, to put a note there.
    Note {
        /// The side whose sheet it is.
        side: Side,
        /// Where, in parts of the sheet's size from its top left corner, as its side reads it.
        at: DVec2,
    },
}

/// Keys that stand in for the controls of the south side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Key {
    /// As [`super::ControlKind::PlayPause`].
    PlayPause,
    /// As [`super::ControlKind::Undo`].
    Undo,
    /// As [`super::ControlKind::Tool`].
    Tool(Tool),
    /// As [`super::ControlKind::Readouts`].
    Readouts,
    /// As [`super::ControlKind::Save`].
    Save,
    /// As [`super::ControlKind::Final`]: held.
    Final,
    /// As [`super::ControlKind::World`].
    World,
    /// One step faster.
    Faster,
    /// One step slower.
    Slower,
    /// One step back in the land's history.
    Back,
    /// One step forward.
    Forward,
    /// As [`super::ControlKind::StartOver`]: held.
    StartOver,
}

/// What a contact of the edit tool is about to do, for drawing. Table millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EditView {
    /// The side it belongs to.
    pub side: Side,
    /// Where the contact is.
    pub at: DVec2,
    /// What lifting it would do, or what it does already.
    pub doing: Editing,
    /// Part of the time after which what is under it is removed, 0–1; 0 once it has moved.
    pub hold: f64,
}

/// What the edit tool does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Editing {
    /// Nothing is within reach: shown at once, so that nobody waits for an answer.
    Nothing,
    /// It has hold of the tip of an arrow, which is there.
    Tip {
        /// The tip as the plate has it, which may lag behind the contact.
        tip: DVec2,
    },
    /// It is on a plate; lifted where it is, it adds no arrow yet.
    Plate,
    /// Lifted now, it adds this arrow to the plate.
    NewArrow {
        /// Where it landed.
        from: DVec2,
        /// Where it is.
        to: DVec2,
    },
    /// It is on a fault, which flips when it is tapped.
    Fault,
    /// It has removed a plate.
    Removed,
}

/// A line that a side has drawn along folds, and the handle that raises them. Table millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoldHandle<'a> {
    /// The side it belongs to.
    pub side: Side,
    /// The line.
    pub path: &'a [DVec2],
    /// Its middle, where the handle stands when folds are as they would be.
    pub middle: DVec2,
    /// Where the handle is: away from its side raises.
    pub at: DVec2,
    /// Where it stands when folds are flat.
    pub lowest: DVec2,
    /// Where it stands when they are as high as they may be made.
    pub highest: DVec2,
    /// Factor on the height of the folds.
    pub by: f64,
    /// A finger holds it.
    pub held: bool,
}

/// The cross-section of a side on the land. Table millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SliceView {
    /// The side it belongs to.
    pub side: Side,
    /// Its ends; the same twice while there is only the first.
    pub ends: [DVec2; 2],
    /// False while the second end is not yet there.
    pub whole: bool,
    /// Which ends fingers hold.
    pub held: [bool; 2],
    /// Its ends can be taken hold of.
    pub handles: bool,
    /// It stays as it is.
    pub frozen: bool,
}
