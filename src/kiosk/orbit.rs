//! The planet's show: it turns, and now and then a hand leads one of its plates.

use glam::DVec2;

use super::lived::Lived;
use super::show::ShowStep;
use crate::gesture::command::{Action, Command};
use crate::gesture::contact::{Contact, ContactEvent, ContactKey, InputFrame, Phase, Source, quantise_mm};
use crate::units::GlobeView;

/// Time in which the planet turns once, s: slower than a clock's second hand.
const TURN_S: f64 = 150.0;
/// Latitude that it is seen from, degrees, and how fast it is brought there, per second.
const LATITUDE_DEG: f64 = 14.0;
const EASE_PER_S: f64 = 0.8;

/// A round: it turns alone, then a hand comes, leads, and lifts, µs from the round's begin.
const HAND_US: (u64, u64) = (9_000_000, 19_000_000);
const ROUND_US: u64 = 22_000_000;
/// After so many rounds the planet is a fresh one.
const ROUNDS: u64 = 12;
/// Shortest time between two moves of the hand or two turns of the planet, µs.
const MOVE_US: u64 = 30_000;
/// What one look may add to the time, µs.
const LONGEST_LOOK_US: u64 = 200_000;

/// Ways of the hand in turn, radii from the middle of the disc.
const WAYS: [[DVec2; 2]; 4] = [
    [DVec2::new(-0.35, -0.10), DVec2::new(0.22, 0.06)],
    [DVec2::new(0.30, 0.32), DVec2::new(-0.18, 0.10)],
    [DVec2::new(0.15, -0.42), DVec2::new(-0.05, 0.15)],
    [DVec2::new(-0.10, 0.40), DVec2::new(0.25, -0.12)],
];

/// Plays for as long as nobody is there.
#[derive(Clone, Debug)]
pub struct Orbit {
    lived: Lived,
    /// When it began, µs lived; none while it does not play.
    begun_us: Option<u64>,
    playing: bool,
    /// The last moment that was played, µs since it began.
    played_us: u64,
    /// The hand, while it is down, and how often it has come.
    down: Option<Contact>,
    hands: u32,
    planets: u64,
}

impl Default for Orbit {
    fn default() -> Self {
        Self {
            lived: Lived::new(LONGEST_LOOK_US),
            begun_us: None,
            playing: false,
            played_us: 0,
            down: None,
            hands: 0,
            planets: 0,
        }
    }
}

impl Orbit {
    /// True between start and stop.
    pub fn playing(&self) -> bool {
        self.playing
    }

    /// It begins, with a fresh planet.
    pub fn start(&mut self) {
        self.playing = true;
        self.begun_us = None;
    }

    /// What happens up to `now_us` to a planet that is seen as `view`. To be called once a frame.
    pub fn advance(&mut self, now_us: u64, view: &GlobeView) -> ShowStep {
        let lived_us = self.lived.at(now_us);
        let mut step = ShowStep::default();
        if !self.playing {
            return step;
        }
        if self.begun_us.is_none() {
            self.planets += 1;
            step.fresh = Some(self.planets);
            self.played_us = 0;
        }
        let time_us = lived_us - *self.begun_us.get_or_insert(lived_us);
        let passed_us = time_us.saturating_sub(self.played_us);
        if passed_us < MOVE_US && time_us > 0 {
            return step;
        }
        self.played_us = time_us;
        let (round, in_round_us) = (time_us / ROUND_US, time_us % ROUND_US);
        let mut frame = InputFrame {
            t_us: now_us,
            events: Vec::new(),
            commands: Vec::new(),
        };
        if (HAND_US.0..HAND_US.1).contains(&in_round_us) {
            let part = (in_round_us - HAND_US.0) as f64 / (HAND_US.1 - HAND_US.0) as f64;
            frame.events.push(self.hand(round, part, view));
        } else {
            frame.events.extend(self.lift(Phase::Up));
            frame.commands.push(turned(view, passed_us as f64 / 1e6));
        }
        step.frames.push(frame);
        if round >= ROUNDS && self.down.is_none() {
            self.begun_us = None;
        }
        step
    }

    /// It ends: the frame that withdraws its hand, if it is down.
    pub fn stop(&mut self, now_us: u64) -> Option<InputFrame> {
        self.playing = false;
        self.lift(Phase::Cancel).map(|event| InputFrame {
            t_us: now_us,
            events: vec![event],
            commands: Vec::new(),
        })
    }

    fn hand(&mut self, round: u64, part: f64, view: &GlobeView) -> ContactEvent {
        let [from, to] = WAYS[(round % WAYS.len() as u64) as usize];
        // It sets out and arrives gently.
        let eased = part * part * (3.0 - 2.0 * part);
        let at = view.centre_mm() + from.lerp(to, eased) * view.radius_mm();
        let position = DVec2::new(quantise_mm(at.x), quantise_mm(at.y));
        let phase = if self.down.is_some() {
            Phase::Move
        } else {
            self.hands = self.hands.wrapping_add(1);
            Phase::Down
        };
        let contact = Contact {
            key: ContactKey {
                source: Source::File,
                device: 0,
                id: 1,
                generation: self.hands,
            },
            position,
            size_mm: None,
            confidence: None,
        };
        self.down = Some(contact);
        ContactEvent { phase, contact }
    }

    fn lift(&mut self, phase: Phase) -> Option<ContactEvent> {
        let contact = self.down.take()?;
        Some(ContactEvent { phase, contact })
    }
}

/// The planet a moment later: turned a little, and brought back to where all of it is seen.
fn turned(view: &GlobeView, dt_s: f64) -> Command {
    let eased = 1.0 - (-EASE_PER_S * dt_s).exp();
    let next = view.looking_at(
        view.longitude_deg() - 360.0 * dt_s / TURN_S,
        view.latitude_deg() + (LATITUDE_DEG - view.latitude_deg()) * eased,
        view.zoom() * view.zoom().recip().powf(eased),
    );
    Command::new(Action::View {
        lon: next.longitude_deg(),
        lat: next.latitude_deg(),
        zoom: next.zoom(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_turns_then_a_hand_lands_moves_and_lifts_and_a_fresh_planet_comes_in_the_end() {
        let mut orbit = Orbit::default();
        let mut view = GlobeView::new(DVec2::new(1200.0, 675.0)).looking_at(0.0, 60.0, 3.0);
        assert_eq!(orbit.advance(0, &view), ShowStep::default(), "not begun");
        orbit.start();
        let (mut fresh, mut downs, mut ups, mut moves) = (Vec::new(), 0, 0, 0);
        for ms in 0..(ROUND_US * (ROUNDS + 1) / 1000 + 500) / 40 {
            let step = orbit.advance(ms * 40_000, &view);
            fresh.extend(step.fresh);
            for frame in step.frames {
                for event in &frame.events {
                    assert!(view.contains(event.contact.position));
                    match event.phase {
                        Phase::Down => downs += 1,
                        Phase::Move => moves += 1,
                        Phase::Up => ups += 1,
                        Phase::Cancel => panic!("nobody withdraws it"),
                    }
                }
                for command in frame.commands {
                    if let Action::View { lon, lat, zoom } = command.action {
                        view = view.looking_at(lon, lat, zoom);
                    }
                }
            }
        }
        assert_eq!(fresh, [1, 2]);
        assert_eq!((downs, ups), (ROUNDS + 1, ROUNDS + 1));
        assert!(moves > 100 * downs);
        assert!((view.latitude_deg() - LATITUDE_DEG).abs() < 0.1 && (view.zoom() - 1.0).abs() < 0.01);
        assert_eq!(orbit.stop(u64::MAX), None);
    }

    #[test]
    fn a_hand_that_is_down_is_withdrawn_when_it_ends() {
        let mut orbit = Orbit::default();
        let view = GlobeView::new(DVec2::new(1200.0, 675.0));
        orbit.start();
        for ms in 0..300 {
            orbit.advance(ms * 40_000, &view);
        }
        let frame = orbit.stop(12_000_000).expect("a hand is down");
        assert_eq!(frame.events[0].phase, Phase::Cancel);
        assert!(!orbit.playing());
    }
}
