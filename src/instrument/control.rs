//! Controls as they are drawn.

use glam::DVec2;

use crate::gesture::command::Tool;
use crate::gesture::contact::Side;

/// What a control does. Few, and the same on both long sides. The slider and the two of the cross-section are there
/// only while there is something for them to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ControlKind {
    /// The side takes this tool (`on`), or its hands push again.
    Tool(Tool),
    /// Brings back the land that the side's last push found.
    Undo,
    /// The geological clock runs (`on`) or stands.
    PlayPause,
    /// The clock's speed, slow, normal, fast in turn; `value` is where it stands between slowest and fastest.
    Speed,
    /// A slider through the land's history, there while the clock stands; `value` is where the clock stands in it.
    Scrub,
    /// The land starts afresh. Held, not tapped: `progress` is the part of the time it has been held.
    StartOver,
    /// Figures are shown to the side (`on`).
    Readouts,
    /// The land is saved; absent on unattended tables.
    Save,
    /// The final land is made, in a minute or two (`on`, `value` is how much of it is done), or given up again. Held, not
    /// tapped: it takes half of the machine. One of the artist's tools.
    Final,
    /// The other world is shown; `on` while that is the mountain, for the globe is what it offers.
    World,
    /// The side's cross-section stays as it is (`on`), or follows the land.
    FreezeSlice,
    /// The side's cross-section goes.
    CloseSlice,
}

/// One control as it is now. Table millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlView {
    /// Names it for as long as the table has its size: side and kind.
    pub id: ControlId,
    /// The side it belongs to.
    pub side: Side,
    /// What it does.
    pub kind: ControlKind,
    /// Its middle.
    pub centre_mm: DVec2,
    /// Half of its width and height. All but [`ControlKind::Scrub`] are squares, to be drawn as discs.
    pub half_size_mm: DVec2,
    /// Clockwise angle by which it is turned to be read from its side, radians: 0 on the south side, π on the north.
    pub rotation: f64,
    /// A contact is on it and would set it off by lifting.
    pub pressed: bool,
    /// Part of the time for which it must be held, 0–1; 0 for those that are tapped.
    pub progress: f64,
    /// What it switches is on.
    pub on: bool,
    /// False where it would do nothing now.
    pub enabled: bool,
    /// Where its value is, 0–1; 0 for those that have none.
    pub value: f64,
    /// A hand is near or has just been, 0–1: far from hands controls stay quiet.
    pub glow: f64,
}

/// The sheet on which a side sees its cross-section. Table millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paper {
    /// The side it belongs to.
    pub side: Side,
    /// Its middle.
    pub centre_mm: DVec2,
    /// Half of its width and height.
    pub half_size_mm: DVec2,
    /// Height of the strip along its far edge, as the side sees it, that its controls stand in.
    pub strip_mm: f64,
    /// Clockwise angle by which it is turned to be read from its side, radians.
    pub rotation: f64,
}

impl Paper {
    /// True for places on it.
    pub fn holds(&self, place: DVec2) -> bool {
        (place - self.centre_mm).abs().cmple(self.half_size_mm).all()
    }

    /// A place on it in parts of its size, from its top left corner as its side reads it.
    pub fn part(&self, place: DVec2) -> DVec2 {
        let from_centre = (place - self.centre_mm) / (2.0 * self.half_size_mm);
        let read = if self.side == Side::North {
            -from_centre
        } else {
            from_centre
        };
        read + 0.5
    }
}

/// Names a control.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ControlId(pub Side, pub ControlKind);
