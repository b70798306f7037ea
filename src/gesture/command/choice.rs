//! Tools and worlds, by the names that gesture files have for them.

use super::Paint;

/// What fingers on the table do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Tool {
    /// Hands are plates.
    #[default]
    Push,
    /// Arrows and plates are changed.
    Edit,
    /// Fold ridges are turned and raised.
    Fold,
    /// Two fingers set the ends of a cross-section.
    Slice,
    /// The view is moved.
    View,
    /// Fingers paint land on the globe.
    Land,
    /// Fingers paint sea on the globe.
    Sea,
}

/// Which world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// The flat one.
    #[default]
    Mountain,
    /// The round one.
    Globe,
}

impl Tool {
    pub(super) const ALL: [Self; 7] = [
        Self::Push,
        Self::Edit,
        Self::Fold,
        Self::Slice,
        Self::View,
        Self::Land,
        Self::Sea,
    ];

    /// What its fingers paint, if it is a brush.
    pub fn paint(self) -> Option<Paint> {
        match self {
            Self::Land => Some(Paint::Continent),
            Self::Sea => Some(Paint::Ocean),
            Self::Push | Self::Edit | Self::Fold | Self::Slice | Self::View => None,
        }
    }

    /// Its name in gesture files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Push => "push",
            Self::Edit => "edit",
            Self::Fold => "fold",
            Self::Slice => "slice",
            Self::View => "view",
            Self::Land => "land",
            Self::Sea => "sea",
        }
    }

    /// The tool of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|tool| tool.name() == name)
    }
}

impl Mode {
    /// Its name in gesture files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mountain => "mountain",
            Self::Globe => "globe",
        }
    }

    /// The world of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Mountain, Self::Globe]
            .into_iter()
            .find(|mode| mode.name() == name)
    }
}
