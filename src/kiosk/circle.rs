//! The circle from one visitor to the next.

use super::hint::Hint;
use super::lived::Lived;
use super::presence::Presence;
use crate::gesture::contact::{ContactEvent, Phase as Touch};
use crate::settings::KioskSettings;

/// How long the land takes to become fresh before the eyes, ms.
const RESET_MS: u64 = 1500;

/// What one look may add to the time, ms: the table is looked at many times a second, at ten in a lazy attract.
const LONGEST_LOOK_MS: u64 = 1000;

/// Pushes so soon after the show has ended are still the show's, ms.
const ECHO_MS: u64 = 400;

/// Where the table is in its circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Nobody is there; the show plays.
    Attract,
    /// Somebody has touched; ghost hands show what hands do.
    Invite,
    /// Somebody sculpts.
    Play,
    /// Nobody has touched for a while; any touch ends the warning.
    IdleWarning {
        /// Until the reset, ms.
        left_ms: u64,
    },
    /// The land becomes fresh for the next visitor.
    Reset,
}

/// What is to be done when the phase changes, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// The show begins.
    StartShow,
    /// The show ends, and its contacts with it.
    CancelShow,
    /// All contacts are withdrawn.
    CancelContacts,
    /// The land starts afresh: new world, empty history.
    FreshLand,
    /// Tools, figures and speed are as on a new table.
    ResetTools,
    /// The view is the plan.
    ResetView,
}

/// Times of the circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KioskParams {
    /// Nobody has touched for so long: the warning begins, ms.
    pub idle_ms: u64,
    /// Length of the warning, ms.
    pub countdown_ms: u64,
    /// A visit that lasts longer is ended whatever touches, ms.
    pub longest_visit_ms: Option<u64>,
    /// The show plays while nobody is there.
    pub show: bool,
    /// The table resets itself; false where what somebody made must not go.
    pub resets: bool,
}

impl KioskParams {
    /// The times of a settings file.
    pub fn new(settings: &KioskSettings, resets: bool) -> Self {
        let ms = |seconds: f64| (seconds * 1000.0).round() as u64;
        Self {
            idle_ms: ms(settings.idle_s),
            countdown_ms: ms(settings.countdown_s),
            longest_visit_ms: settings.reset_hours.map(|hours| ms(hours * 3600.0)),
            show: settings.attract,
            resets,
        }
    }
}

/// The state machine. All times are in ms of any clock that mostly goes on; each call brings the present.
///
/// Each contact event goes through [`Kiosk::feed`] first, and the effects are carried out before it goes anywhere
/// else: the touch that ends the show lands on fresh land.
#[derive(Clone, Debug)]
pub struct Kiosk {
    params: KioskParams,
    lived: Lived,
    presence: Presence,
    stage: Stage,
    /// When the stage began, ms lived.
    since_ms: u64,
    /// When the visit began.
    visit_since_ms: u64,
    /// When somebody was there last.
    present_ms: u64,
    effects: Vec<Effect>,
}

/// The phase, and where the warning leads back to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Attract,
    Invite,
    Play,
    Warning { sculpted: bool },
    Reset,
}

impl Kiosk {
    /// A fresh table that nobody has touched.
    pub fn new(params: KioskParams) -> Self {
        let mut kiosk = Self {
            params,
            lived: Lived::new(LONGEST_LOOK_MS),
            presence: Presence::default(),
            stage: Stage::Attract,
            since_ms: 0,
            visit_since_ms: 0,
            present_ms: 0,
            effects: Vec::new(),
        };
        kiosk.enter(Stage::Attract);
        kiosk
    }

    /// Other times, from now on.
    pub fn set_params(&mut self, params: KioskParams) {
        self.params = params;
    }

    /// The phase.
    pub fn phase(&self) -> Phase {
        match self.stage {
            Stage::Attract => Phase::Attract,
            Stage::Invite => Phase::Invite,
            Stage::Play => Phase::Play,
            Stage::Warning { .. } => Phase::IdleWarning {
                left_ms: self.params.countdown_ms.saturating_sub(self.in_stage_ms()),
            },
            Stage::Reset => Phase::Reset,
        }
    }

    /// Time since somebody was there, ms. A bag that lies on the table is nobody.
    pub fn untouched_ms(&self) -> u64 {
        self.lived.total().saturating_sub(self.present_ms)
    }

    /// Time since the phase began, ms: for what fades in and out.
    pub fn in_stage_ms(&self) -> u64 {
        self.lived.total().saturating_sub(self.since_ms)
    }

    /// What ghost hands show now, if they do.
    pub fn hint(&self) -> Option<Hint> {
        let shown = match self.stage {
            Stage::Invite => true,
            Stage::Attract => !self.params.show,
            Stage::Play | Stage::Warning { .. } | Stage::Reset => false,
        };
        shown.then(|| Hint::at(self.in_stage_ms())).flatten()
    }

    /// What has to be done since the last call, in order.
    pub fn drain(&mut self) -> Vec<Effect> {
        std::mem::take(&mut self.effects)
    }

    /// Takes what a contact does, wherever it is. The show's own contacts are nobody's.
    pub fn feed(&mut self, event: &ContactEvent, now_ms: u64) {
        let now_ms = self.lived.at(now_ms);
        if self.presence.feed(event, now_ms) {
            if event.phase == Touch::Up {
                // Whoever lifts was there, but begins nothing: staff's finger leaves the button that resets.
                self.present_ms = now_ms;
            } else {
                self.somebody();
            }
        }
        self.go_on();
    }

    /// Somebody is there without touching: a key, a button.
    pub fn stir(&mut self, now_ms: u64) {
        self.lived.at(now_ms);
        self.somebody();
        self.go_on();
    }

    /// A visitor's push has begun.
    pub fn pushed(&mut self, now_ms: u64) {
        self.lived.at(now_ms);
        if self.stage == Stage::Invite && self.in_stage_ms() >= ECHO_MS {
            self.enter(Stage::Play);
        }
        self.go_on();
    }

    /// Staff want the table fresh.
    pub fn reset(&mut self, now_ms: u64) {
        self.lived.at(now_ms);
        self.enter(Stage::Reset);
    }

    /// Time goes on. To be called once a frame, and at least once a second.
    pub fn tick(&mut self, now_ms: u64) {
        self.lived.at(now_ms);
        self.go_on();
    }

    fn somebody(&mut self) {
        self.present_ms = self.lived.total();
        match self.stage {
            Stage::Attract | Stage::Reset | Stage::Warning { sculpted: false } => self.enter(Stage::Invite),
            Stage::Warning { sculpted: true } => self.enter(Stage::Play),
            Stage::Invite | Stage::Play => {}
        }
    }

    fn go_on(&mut self) {
        let now_ms = self.lived.total();
        if self.presence.anybody(now_ms) {
            self.present_ms = now_ms;
        }
        let visit_ms = now_ms.saturating_sub(self.visit_since_ms);
        let too_long = self.params.longest_visit_ms.is_some_and(|most| visit_ms >= most);
        match self.stage {
            Stage::Reset if self.in_stage_ms() >= RESET_MS => self.enter(Stage::Attract),
            Stage::Attract | Stage::Reset => {}
            _ if !self.params.resets => {}
            _ if too_long => self.enter(Stage::Reset),
            Stage::Invite | Stage::Play if self.untouched_ms() >= self.params.idle_ms => {
                self.enter(Stage::Warning {
                    sculpted: self.stage == Stage::Play,
                });
            }
            Stage::Warning { .. } if self.in_stage_ms() >= self.params.countdown_ms => {
                self.enter(Stage::Reset);
            }
            Stage::Invite | Stage::Play | Stage::Warning { .. } => {}
        }
    }

    fn enter(&mut self, stage: Stage) {
        let from = std::mem::replace(&mut self.stage, stage);
        self.since_ms = self.lived.total();
        match stage {
            Stage::Attract if self.params.show => self.effects.push(Effect::StartShow),
            Stage::Invite if matches!(from, Stage::Attract | Stage::Reset) => {
                self.visit_since_ms = self.since_ms;
                if from == Stage::Attract {
                    self.effects.extend([Effect::CancelShow, Effect::FreshLand]);
                }
            }
            Stage::Reset => {
                if from == Stage::Attract {
                    self.effects.push(Effect::CancelShow);
                }
                self.effects.extend([
                    Effect::CancelContacts,
                    Effect::FreshLand,
                    Effect::ResetTools,
                    Effect::ResetView,
                ]);
            }
            Stage::Attract | Stage::Invite | Stage::Play | Stage::Warning { .. } => {}
        }
    }
}
