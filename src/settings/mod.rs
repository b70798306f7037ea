//! The one settings file.
//!
//! [`Settings`] is what a table needs to know about itself: its size and orientation, idle times, the staff's PIN,
//! quality. The file is TOML, every key is optional, and what is not there has its default. [`KEYS`] is the one table
//! of keys with unit, range and help: it reads and writes the file, and drives sliders and property tests.
//!
//! * [`Settings::parse`] takes bytes and refuses in one line with file, line and key; an unknown key is an error that
//!   names the nearest known one.
//! * [`Settings::to_toml`] writes every key with its help as a comment: the defaults so written are a sample file.
//!
//! No file is opened here.

mod form;
mod keys;
mod read;
mod table;
mod write;

pub use form::Form;
pub use keys::{Bound, Domain, Key, Value};
pub use read::SettingsError;
pub use table::KEYS;

use core::net::IpAddr;

use glam::{DAffine2, DMat2, DVec2};

use crate::gesture::command::Mode;
use crate::units::{KM, PlanMap};

/// The version written and read.
pub const VERSION: u64 = 1;

/// Fewest and most digits of the staff's PIN.
pub const PIN_DIGITS: (usize, usize) = (4, 8);

/// Size of the staff's corner along both edges, mm.
pub const CORNER_MM: f64 = 60.0;

/// The same as a part of the table's short side, where that is less.
const CORNER_PART: f64 = 0.12;

/// All settings, by the sections of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The world that is shown.
    pub mode: Mode,
    /// The table's frame.
    pub table: TableSettings,
    /// Where touches come from.
    pub input: InputSettings,
    /// What new land is made of.
    pub land: LandSettings,
    /// The circle of an unattended table.
    pub kiosk: KioskSettings,
    /// The way in for staff.
    pub staff: StaffSettings,
    /// What the machine is asked for.
    pub quality: QualitySettings,
    /// What is shown.
    pub view: ViewSettings,
    /// What is written.
    pub files: FileSettings,
}

/// `[table]`: size and orientation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableSettings {
    /// Width of the picture on the table, mm.
    pub width_mm: f64,
    /// Height of the picture, mm; `None`: from the window's shape.
    pub height_mm: Option<f64>,
    /// How the touch device lies on the picture.
    pub orientation: Orientation,
    /// What the orientation leaves, as four touches have shown it: parts of the surface → parts of the picture.
    pub calibration: Option<DAffine2>,
    /// Ground along the table's short side, km.
    pub short_side_km: f64,
}

/// `[input]`: where touches come from.
#[derive(Clone, Debug, PartialEq)]
pub struct InputSettings {
    /// The one source that is listened to.
    pub source: Listen,
    /// Width and height of the surface of raw touchscreens, mm; `None`: as they tell.
    pub surface_mm: [Option<f64>; 2],
    /// UDP port of TUIO.
    pub tuio_port: u16,
    /// Other machines whose TUIO is heard beside this one's; an unspecified address (0.0.0.0) stands for all.
    pub tuio_allow: Vec<IpAddr>,
}

/// Which source of touches is listened to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Listen {
    /// The best of those that speak: raw touchscreens, else TUIO, else the window system.
    #[default]
    Auto,
    /// The window system.
    Window,
    /// Raw HID touchscreens.
    Hid,
    /// TUIO.
    Tuio,
}

/// `[land]`: what new land is made of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LandSettings {
    /// A preset of rock layers, or the path of a TOML file, relative to the settings file.
    pub layers: String,
}

/// `[kiosk]`: times of the circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KioskSettings {
    /// Nobody has touched for so long: the warning begins, s.
    pub idle_s: f64,
    /// Length of the warning, s.
    pub countdown_s: f64,
    /// Untouched for so long, the view eases into flight, s.
    pub flight_after_s: f64,
    /// True: the show plays on an untouched table.
    pub attract: bool,
    /// A visit that lasts longer is ended whatever touches, hours; `None`: never.
    pub reset_hours: Option<f64>,
}

/// `[staff]`: the way in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StaffSettings {
    /// [`PIN_DIGITS`] digits.
    pub pin: String,
    /// The corner that is held.
    pub corner: Corner,
}

/// `[quality]`: what the machine is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QualitySettings {
    /// Nodes of the terrain; `None`: chosen for the machine.
    pub nodes: Option<u64>,
    /// Pixels rendered per pixel shown, along one side; `None`: follows the frame rate.
    pub scale: Option<f64>,
    /// Most frames per second while the show plays, Hz.
    pub attract_hz: f64,
    /// The same on a software adapter, Hz.
    pub attract_software_hz: f64,
    /// What computes transport and folds.
    pub stages: Compute,
}

/// What computes the stages that a graphics card can compute.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compute {
    /// Whichever is faster, measured when the table opens.
    #[default]
    Auto,
    /// The processor.
    Cpu,
    /// A graphics card, while it works.
    Gpu,
}

/// `[view]`: what is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ViewSettings {
    /// No flight, no eased motion.
    pub reduced_motion: bool,
    /// Figures are shown from the start.
    pub readouts: bool,
    /// Which tools are offered.
    pub tools: Tools,
}

/// `[files]`: what is written. Paths are as in the file, relative to the caller's folder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FileSettings {
    /// JSON lines of metrics go there.
    pub metrics: Option<String>,
    /// Folder of the log.
    pub log: Option<String>,
}

/// Which tools the table offers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tools {
    /// All, but on unattended tables those for visitors.
    #[default]
    Auto,
    /// All.
    All,
    /// Arrows and cross-sections; not the artist's: folds and layers.
    Visitor,
}

/// How a touch device lies on the picture: turned by quarters, and perhaps mirrored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Orientation {
    /// Quarter turns clockwise, 0 to 3, from the device to the picture.
    pub quarter_turns: u8,
    /// Left and right of the device are exchanged before it is turned.
    pub mirrored: bool,
}

/// A corner of the table, named as on the map: north is the top.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Corner {
    /// Top left.
    #[default]
    NorthWest,
    /// Top right.
    NorthEast,
    /// Bottom left.
    SouthWest,
    /// Bottom right.
    SouthEast,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            mode: Mode::Mountain,
            table: TableSettings {
                width_mm: 1209.6,
                height_mm: None,
                orientation: Orientation::default(),
                calibration: None,
                short_side_km: 100.0,
            },
            input: InputSettings {
                source: Listen::Auto,
                surface_mm: [None; 2],
                tuio_port: 3333,
                tuio_allow: Vec::new(),
            },
            land: LandSettings {
                layers: "plain".to_owned(),
            },
            kiosk: KioskSettings {
                idle_s: 75.0,
                countdown_s: 20.0,
                flight_after_s: 25.0,
                attract: true,
                reset_hours: Some(4.0),
            },
            staff: StaffSettings {
                pin: "2580".to_owned(),
                corner: Corner::NorthWest,
            },
            quality: QualitySettings {
                nodes: None,
                scale: None,
                attract_hz: 30.0,
                attract_software_hz: 10.0,
                stages: Compute::Auto,
            },
            view: ViewSettings {
                reduced_motion: false,
                readouts: false,
                tools: Tools::Auto,
            },
            files: FileSettings::default(),
        }
    }
}

impl Settings {
    /// Size of the table that shows a window of `window_px` (any positive size), mm.
    pub fn table_size_mm(&self, window_px: DVec2) -> DVec2 {
        let width = self.table.width_mm;
        let height = width * window_px.y / window_px.x;
        DVec2::new(width, self.table.height_mm.unwrap_or(height))
    }

    /// The map of a table of `size_mm`.
    pub fn plan_map(&self, size_mm: DVec2) -> PlanMap {
        PlanMap::new(size_mm, self.table.short_side_km * KM)
    }
}

impl Tools {
    /// All, with their names in the file.
    pub const ALL: [(&'static str, Self); 3] = [
        ("auto", Self::Auto),
        ("all", Self::All),
        ("visitor", Self::Visitor),
    ];

    /// True where only the visitors' tools are offered.
    pub fn are_few(self, unattended: bool) -> bool {
        self == Self::Visitor || (self == Self::Auto && unattended)
    }
}

impl Compute {
    /// All, with their names in the file.
    pub const ALL: [(&'static str, Self); 3] = [("auto", Self::Auto), ("cpu", Self::Cpu), ("gpu", Self::Gpu)];
}

impl Listen {
    /// All, with their names in the file.
    pub const ALL: [(&'static str, Self); 4] = [
        ("auto", Self::Auto),
        ("window", Self::Window),
        ("hid", Self::Hid),
        ("tuio", Self::Tuio),
    ];
}

impl Orientation {
    /// All eight, with their names in the file.
    pub const ALL: [(&'static str, Self); 8] = [
        ("0", Self::new(0, false)),
        ("90", Self::new(1, false)),
        ("180", Self::new(2, false)),
        ("270", Self::new(3, false)),
        ("0-mirrored", Self::new(0, true)),
        ("90-mirrored", Self::new(1, true)),
        ("180-mirrored", Self::new(2, true)),
        ("270-mirrored", Self::new(3, true)),
    ];

    /// Turned clockwise by so many quarters (modulo 4), after mirroring.
    pub const fn new(quarter_turns: u8, mirrored: bool) -> Self {
        Self {
            quarter_turns: quarter_turns % 4,
            mirrored,
        }
    }

    /// [`Self::apply`] as a map.
    pub fn affine(self) -> DAffine2 {
        let origin = self.apply(DVec2::ZERO);
        let axis = |end| self.apply(end) - origin;
        DAffine2::from_mat2_translation(DMat2::from_cols(axis(DVec2::X), axis(DVec2::Y)), origin)
    }

    /// A place on the device on the picture; both are in parts of their size, x right, y down, 0 to 1.
    pub fn apply(self, place: DVec2) -> DVec2 {
        let x = if self.mirrored { 1.0 - place.x } else { place.x };
        match self.quarter_turns % 4 {
            0 => DVec2::new(x, place.y),
            1 => DVec2::new(1.0 - place.y, x),
            2 => DVec2::new(1.0 - x, 1.0 - place.y),
            _ => DVec2::new(place.y, 1.0 - x),
        }
    }
}

impl Corner {
    /// All four, with their names in the file.
    pub const ALL: [(&'static str, Self); 4] = [
        ("north-west", Self::NorthWest),
        ("north-east", Self::NorthEast),
        ("south-west", Self::SouthWest),
        ("south-east", Self::SouthEast),
    ];

    /// True for places (mm) that are the corner's on a table of `size_mm`: within [`CORNER_MM`], less on small tables.
    pub fn holds(self, place: DVec2, size_mm: DVec2) -> bool {
        let reach = CORNER_MM.min(CORNER_PART * size_mm.min_element());
        (place - self.position(size_mm)).abs().max_element() <= reach
    }

    /// Where it is on a table of `size_mm`.
    pub fn position(self, size_mm: DVec2) -> DVec2 {
        match self {
            Self::NorthWest => DVec2::ZERO,
            Self::NorthEast => DVec2::new(size_mm.x, 0.0),
            Self::SouthWest => DVec2::new(0.0, size_mm.y),
            Self::SouthEast => size_mm,
        }
    }
}
