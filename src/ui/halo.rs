//! Halos: the answer to a touch, before the land can give its own.
//!
//! Each contact has a ring in the colour of its hand, drawn last and at the newest place that is known. It says what
//! the contact is taken for: solid while it may sculpt or pushes, dashed where it rests, small and warm on a control,
//! crossed out and grey where it is taken for a palm or a ghost. A tap leaves ripples, as on water.

use std::collections::BTreeMap;
use std::f32::consts::{FRAC_PI_4, TAU};

use egui::{Color32, Painter, Pos2, Vec2};
use glam::DVec2;

use super::ease;
use super::palette::{self, AMBER, BLUE_BLACK, LAMP, faded};
use super::pen::{Line, Pen};
use super::sight::Sight;
use crate::gesture::contact::{ContactKey, MAX_CONTACTS};
use crate::gesture::event::HandId;
use crate::gesture::hand::{Doing, HandView};
use crate::instrument::Route;

/// Time in which a halo comes, seconds.
const COMES: f64 = 0.08;

/// Time in which it goes, seconds.
const GOES: f64 = 0.35;

/// Time in which it turns from one manner into another, seconds.
const TURNS: f64 = 0.25;

/// Time that the ripples of a tap last, seconds.
const RIPPLES: f64 = 1.1;

/// A contact that was down for less than this (seconds) and moved less than [`TAP_TRAVEL`] was a tap, for the eye.
const TAP_TIME: f64 = 0.35;

/// See [`TAP_TIME`]; mm.
const TAP_TRAVEL: f64 = 6.0;

/// A finger of a hand is this contact when it is not farther from it than this, mm: a frame of the land is some
/// milliseconds older than the newest contact.
const SAME: f64 = 45.0;

/// A contact on the land that is in no hand for this long is taken for a palm or a ghost, seconds.
const STRAY: f64 = 0.4;

/// Radius of a halo, mm: wider than a fingertip, so that it shows around it.
const RADIUS: f32 = 12.5;

/// All halos. Times are seconds of one clock that only has to rise.
#[derive(Clone, Debug, Default)]
pub struct Halos {
    halos: BTreeMap<ContactKey, Halo>,
    ripples: Vec<Ripple>,
}

#[derive(Clone, Debug)]
struct Halo {
    at: DVec2,
    came_at: DVec2,
    came: f64,
    lifted: Option<f64>,
    route: Route,
    hand: Option<HandId>,
    /// When it was last seen in a hand.
    in_hand: f64,
    manner: Manner,
    before: Option<(Manner, f64)>,
}

#[derive(Clone, Debug)]
struct Ripple {
    at: DVec2,
    since: f64,
    colour: Color32,
}

/// How a halo is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Manner {
    Touching,
    Pushing,
    Resting,
    Control,
    Edit,
    Wake,
    Faint,
    Stray,
}

impl Halos {
    /// A contact went down, or goes on, at `at` (table mm).
    pub fn touch(&mut self, contact: ContactKey, at: DVec2, route: Route, now_s: f64) {
        if !at.is_finite() || (self.halos.len() >= 2 * MAX_CONTACTS && !self.halos.contains_key(&contact)) {
            return;
        }
        let halo = self.halos.entry(contact).or_insert_with(|| Halo {
            at,
            came_at: at,
            came: now_s,
            lifted: None,
            route,
            hand: None,
            in_hand: now_s,
            manner: manner(route),
            before: None,
        });
        halo.at = at;
        halo.lifted = None;
        if halo.route != route {
            halo.route = route;
            halo.turn(manner(route), now_s);
        }
    }

    /// A contact lifted. A short one that did not move leaves ripples.
    pub fn lift(&mut self, contact: ContactKey, now_s: f64) {
        let Some(halo) = self.halos.get_mut(&contact).filter(|halo| halo.lifted.is_none()) else {
            return;
        };
        halo.lifted = Some(now_s);
        let tapped = now_s - halo.came < TAP_TIME && halo.at.distance(halo.came_at) < TAP_TRAVEL;
        if tapped && matches!(halo.route, Route::Land | Route::Wake) && self.ripples.len() < MAX_CONTACTS {
            self.ripples.push(Ripple {
                at: halo.at,
                since: now_s,
                colour: halo.colour(),
            });
        }
    }

    /// A contact was withdrawn: it goes, crossed out.
    pub fn cancel(&mut self, contact: ContactKey, now_s: f64) {
        if let Some(halo) = self.halos.get_mut(&contact).filter(|halo| halo.lifted.is_none()) {
            halo.turn(Manner::Stray, now_s);
            halo.lifted = Some(now_s);
        }
    }

    /// Takes over what the hands of the newest frame do: each contact on the land belongs to the hand whose finger it
    /// is; one that belongs to none for a while is shown as not believed.
    pub fn meet(&mut self, hands: &[HandView], now_s: f64) {
        let fingers: Vec<(DVec2, &HandView)> = hands
            .iter()
            .flat_map(|hand| hand.fingers.iter().map(move |&finger| (finger, hand)))
            .collect();
        let down = self
            .halos
            .values_mut()
            .filter(|halo| halo.route == Route::Land && halo.lifted.is_none());
        for halo in down {
            let nearest = fingers
                .iter()
                .map(|&(finger, hand)| (finger.distance(halo.at), hand))
                .filter(|&(distance, _)| distance < SAME)
                .min_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((_, hand)) = nearest {
                halo.hand = Some(hand.hand);
                halo.in_hand = now_s;
                halo.turn(
                    match hand.doing {
                        Doing::Touching => Manner::Touching,
                        Doing::Resting => Manner::Resting,
                        Doing::Pushing { .. } => Manner::Pushing,
                    },
                    now_s,
                );
            } else if now_s - halo.in_hand > STRAY {
                halo.turn(Manner::Stray, now_s);
            }
        }
    }

    /// Forgets what has faded away. Called once a frame.
    pub fn tick(&mut self, now_s: f64) {
        self.halos
            .retain(|_, halo| halo.lifted.is_none_or(|lifted| now_s - lifted < GOES));
        self.ripples.retain(|ripple| now_s - ripple.since < RIPPLES);
    }

    /// True while there is something to draw.
    pub fn any(&self) -> bool {
        !(self.halos.is_empty() && self.ripples.is_empty())
    }

    /// Draws ripples and halos. To be called after everything else is drawn.
    pub fn draw(&self, painter: &Painter, sight: &Sight<'_>, now_s: f64) {
        let pen = Pen::at_least(painter, sight, 0.7);
        for ripple in &self.ripples {
            if let Some(at) = sight.of_table(ripple.at) {
                ripple.draw(pen, at, now_s);
            }
        }
        for halo in self.halos.values() {
            if let Some(at) = sight.of_table(halo.at) {
                halo.draw(pen, at, now_s);
            }
        }
    }
}

fn manner(route: Route) -> Manner {
    match route {
        Route::Land => Manner::Touching,
        Route::Control => Manner::Control,
        Route::Tool => Manner::Edit,
        Route::Wake => Manner::Wake,
        Route::Panel | Route::Corner => Manner::Faint,
        Route::Ignored => Manner::Stray,
    }
}

impl Halo {
    fn turn(&mut self, manner: Manner, now_s: f64) {
        if self.manner != manner {
            self.before = Some((self.manner, now_s));
            self.manner = manner;
        }
    }

    fn colour(&self) -> Color32 {
        self.hand.map_or(LAMP, palette::of_hand)
    }

    fn draw(&self, pen: Pen<'_>, at: Pos2, now_s: f64) {
        let came = ease::out((now_s - self.came) / COMES);
        let gone = self
            .lifted
            .map_or(0.0, |lifted| ease::smooth((now_s - lifted) / GOES));
        let strength = came * (1.0 - gone);
        // It opens as it comes and widens as it goes.
        let scale = 0.8 + 0.2 * came + 0.25 * gone;
        let turned = self
            .before
            .map_or(1.0, |(_, since)| ease::smooth((now_s - since) / TURNS));
        let ring = Ring {
            at,
            scale,
            colour: self.colour(),
        };
        if let Some((before, _)) = self.before.filter(|_| turned < 1.0) {
            ring.draw(pen, before, strength * (1.0 - turned));
        }
        ring.draw(pen, self.manner, strength * turned);
    }
}

struct Ring {
    at: Pos2,
    scale: f32,
    colour: Color32,
}

impl Ring {
    fn draw(&self, pen: Pen<'_>, manner: Manner, strength: f32) {
        match manner {
            Manner::Touching => {
                self.light(pen, RADIUS, self.colour, 0.42 * strength);
                self.ring(pen, RADIUS, Line::solid(self.colour, strength, 1.3));
            }
            Manner::Pushing => {
                self.light(pen, RADIUS, self.colour, 0.60 * strength);
                self.ring(pen, RADIUS, Line::solid(self.colour, strength, 2.0));
            }
            Manner::Resting => {
                self.light(pen, RADIUS, self.colour, 0.22 * strength);
                let dashed = Line {
                    dash: Some((4.4, 3.4)),
                    ..Line::solid(self.colour, strength, 1.6)
                };
                self.ring(pen, RADIUS, dashed);
                self.pins(pen, strength);
            }
            Manner::Control => {
                self.light(pen, RADIUS + 2.0, AMBER, 0.40 * strength);
            }
            Manner::Edit => {
                self.light(pen, RADIUS, AMBER, 0.30 * strength);
                self.ring(pen, RADIUS, Line::solid(AMBER, 0.9 * strength, 1.0));
            }
            Manner::Wake => {
                self.light(pen, 1.5 * RADIUS, LAMP, 0.45 * strength);
                self.ring(pen, 1.5 * RADIUS, Line::solid(LAMP, 0.9 * strength, 1.1));
            }
            Manner::Faint => self.ring(pen, RADIUS, Line::solid(LAMP, 0.4 * strength, 0.8)),
            Manner::Stray => self.crossed(pen, 0.55 * strength),
        }
    }

    /// Light around the finger, and a touch of shade outside, so that the ring reads on snow as well.
    fn light(&self, pen: Pen<'_>, radius: f32, colour: Color32, strength: f32) {
        let radius = radius * self.scale;
        pen.glow(
            self.at,
            radius + 0.6,
            3.0,
            6.0,
            faded(BLUE_BLACK, 0.35 * strength),
        );
        pen.glow(self.at, radius, 8.0, 9.0, faded(colour, strength));
    }

    /// A ring on a thin dark bed.
    fn ring(&self, pen: Pen<'_>, radius: f32, line: Line) {
        let bed = Line::solid(BLUE_BLACK, 0.50 * line.strength, line.width + 1.1);
        pen.ring(self.at, radius * self.scale, bed);
        pen.ring(self.at, radius * self.scale, line);
    }

    /// Four pins that hold the ring to the land.
    fn pins(&self, pen: Pen<'_>, strength: f32) {
        for quarter in 0..4 {
            let towards = Vec2::angled(FRAC_PI_4 + quarter as f32 * TAU / 4.0) * pen.mm(self.scale);
            let pin = [
                self.at + towards * (RADIUS + 1.4),
                self.at + towards * (RADIUS + 4.2),
            ];
            pen.line(&pin, false, Line::solid(BLUE_BLACK, 0.40 * strength, 2.3));
            pen.line(&pin, false, Line::solid(self.colour, strength, 1.4));
        }
    }

    /// Seen, and not believed.
    fn crossed(&self, pen: Pen<'_>, strength: f32) {
        let radius = 0.9 * RADIUS;
        let grey = Color32::from_rgb(206, 204, 198);
        let line = Line::solid(grey, strength, 0.8);
        self.ring(pen, radius, line);
        let towards = Vec2::angled(-FRAC_PI_4) * pen.mm(radius * self.scale);
        let stroke = [self.at - towards, self.at + towards];
        pen.line(&stroke, false, Line::solid(BLUE_BLACK, 0.40 * strength, 1.7));
        pen.line(&stroke, false, line);
    }
}

impl Ripple {
    fn draw(&self, pen: Pen<'_>, at: Pos2, now_s: f64) {
        for (delay, widest) in [(0.0, 34.0), (0.16, 24.0)] {
            let t = (now_s - self.since - delay) / (RIPPLES - delay);
            if (0.0..1.0).contains(&t) {
                let radius = RADIUS + (widest - RADIUS) * ease::out(t);
                let strength = (1.0 - ease::smooth(t)) * 0.8;
                pen.glow(at, radius, 5.0, 2.0, faded(self.colour, 0.4 * strength));
                pen.ring(at, radius, Line::solid(BLUE_BLACK, 0.45 * strength, 2.2));
                pen.ring(at, radius, Line::solid(self.colour, strength, 1.1));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gesture::contact::{Side, Source};

    fn key(id: u64) -> ContactKey {
        ContactKey {
            source: Source::Window,
            device: 0,
            id,
            generation: 0,
        }
    }

    fn resting(at: DVec2) -> HandView {
        HandView {
            hand: HandId(3),
            side: Side::South,
            fingers: vec![at],
            doing: Doing::Resting,
        }
    }

    #[test]
    fn a_contact_takes_the_manner_of_its_hand_and_is_crossed_out_when_it_has_none() {
        let mut halos = Halos::default();
        let at = DVec2::new(100.0, 100.0);
        halos.touch(key(1), at, Route::Land, 0.0);
        assert_eq!(halos.halos[&key(1)].manner, Manner::Touching);
        halos.meet(&[resting(at + DVec2::X)], 0.6);
        assert_eq!(halos.halos[&key(1)].manner, Manner::Resting);
        assert_eq!(halos.halos[&key(1)].hand, Some(HandId(3)));
        halos.meet(&[], 0.7);
        assert_eq!(halos.halos[&key(1)].manner, Manner::Resting, "not at once");
        halos.meet(&[resting(at + DVec2::X * 300.0)], 1.2);
        assert_eq!(halos.halos[&key(1)].manner, Manner::Stray);
    }

    #[test]
    fn a_tap_on_the_land_leaves_ripples_and_a_control_none() {
        let mut halos = Halos::default();
        for (id, route) in [(1, Route::Land), (2, Route::Control)] {
            halos.touch(key(id), DVec2::splat(50.0 * id as f64), route, 0.0);
            halos.lift(key(id), 0.1);
        }
        halos.touch(key(3), DVec2::ZERO, Route::Land, 0.0);
        halos.touch(key(3), DVec2::splat(9.0), Route::Land, 0.1);
        halos.lift(key(3), 0.2);
        assert_eq!(halos.ripples.len(), 1);
        halos.tick(0.3);
        assert!(halos.any());
        halos.tick(3.0);
        assert!(!halos.any(), "all fades away");
    }

    #[test]
    fn events_of_contacts_that_are_not_down_and_places_that_are_none_do_nothing() {
        let mut halos = Halos::default();
        halos.lift(key(1), 0.0);
        halos.cancel(key(1), 0.0);
        halos.touch(key(1), DVec2::NAN, Route::Land, 0.0);
        assert!(!halos.any());
        for id in 0..10_000 {
            halos.touch(key(id), DVec2::ZERO, Route::Land, 0.0);
        }
        assert!(halos.halos.len() <= 2 * MAX_CONTACTS);
    }
}
