//! A show: fingers with their paths, sampled into the frames of a touchscreen.

use std::collections::BTreeMap;

use glam::DVec2;
use orogen::gesture::command::{Action, Command, Mode};
use orogen::gesture::contact::{
    Contact, ContactEvent, ContactKey, InputFrame, Phase, Side, Source, quantise_mm,
};
use orogen::gesture::file::{Expectation, GestureFile, Header, LandChange};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::Rng as _;

use super::hand::{Pose, pose_at};

/// The table: 16:9, 55 inches.
pub(super) const TABLE_MM: DVec2 = DVec2::new(1209.6, 680.4);

/// Time between two reports of the touchscreen, ms.
pub(super) const FRAME_MS: u32 = 16;

/// Size of the tremor that swings a finger, mm (root mean square, each axis).
const TREMOR_MM: f64 = 0.25;

/// How much of its deflection a trembling finger keeps from one frame to the next: swings of about 10 Hz, the pace of
/// physiological tremor.
const TREMOR_KEEP: f64 = 0.8;

/// A touchscreen reports a contact that has moved by this, mm; less is filtered away.
const HYSTERESIS_MM: f64 = 0.35;

/// Terrain nodes where a scene does not ask for others: what looks like land on a table.
const NODES: u64 = 60_000;

/// One contact of a show.
pub(super) struct Finger {
    /// Id in the file, if it matters; else the place in the show.
    pub(super) id: Option<u64>,
    pub(super) lands_ms: f64,
    pub(super) leaves_ms: f64,
    /// `Up` or `Cancel`.
    pub(super) leaves: Phase,
    /// The poses of its hand.
    pub(super) poses: Vec<Pose>,
    /// Where it is in its hand, mm.
    pub(super) offset: DVec2,
    /// Width and height from a moment on, (ms, mm), where the device tells them.
    pub(super) sizes: Vec<(f64, DVec2)>,
    pub(super) confidence: Option<f32>,
    /// When the screen begins to doubt that it is a finger, ms.
    pub(super) doubted_ms: Option<f64>,
    /// True if it reports the very same place until it leaves.
    pub(super) frozen: bool,
}

impl Finger {
    /// A finger that is down for as long as its poses last.
    pub(super) fn new(poses: Vec<Pose>) -> Self {
        let time = |pose: Option<&Pose>| pose.map_or(0.0, |pose| pose.t_ms);
        Self {
            id: None,
            lands_ms: time(poses.first()),
            leaves_ms: time(poses.last()),
            leaves: Phase::Up,
            poses,
            offset: DVec2::ZERO,
            sizes: Vec::new(),
            confidence: None,
            doubted_ms: None,
            frozen: false,
        }
    }

    fn at(&self, t_ms: f64) -> DVec2 {
        let pose = pose_at(&self.poses, t_ms);
        pose.at + DVec2::from_angle(pose.turn_deg.to_radians()).rotate(self.offset)
    }

    fn size_at(&self, t_ms: f64) -> Option<DVec2> {
        let known = self.sizes.partition_point(|(from, _)| *from <= t_ms);
        self.sizes[..known].last().map(|&(_, size)| size)
    }
}

/// Where a hand ended.
pub(super) struct Pushed {
    /// When it stood still, ms.
    pub(super) end_ms: f64,
    at: DVec2,
    fingers: Vec<DVec2>,
    along: DVec2,
}

impl Pushed {
    /// The place `mm` before the foremost finger, in the direction of the push.
    pub(super) fn ahead(&self, mm: f64) -> DVec2 {
        let reach = self.fingers.iter().map(|f| (f - self.at).dot(self.along));
        self.at + self.along * (reach.fold(0.0, f64::max) + mm)
    }
}

/// How a hand pushes: it lands, waits for a moment, goes, stands, and lifts.
#[derive(Clone, Copy)]
pub(super) struct Push {
    /// When it lands, ms.
    pub(super) from_ms: f64,
    /// How long it is on its way, ms.
    pub(super) for_ms: f64,
    /// Where its middle lands, table mm.
    pub(super) at: DVec2,
    /// How far it goes, mm.
    pub(super) by: DVec2,
    /// How far it turns on its way, degrees, clockwise as seen.
    pub(super) turn_deg: f64,
}

/// Time for which a hand stands before it goes, ms.
const POISE_MS: f64 = 64.0;

/// Time for which it stands before it lifts, ms.
const STAND_MS: f64 = 192.0;

/// Seed of land and tremor where a scene does not ask for another: the same land lets scenes be compared.
const SEED: u64 = 7;

/// What is played, and what must be seen.
pub(super) struct Show {
    header: Header,
    seed: u64,
    expect: Expectation,
    fingers: Vec<Finger>,
    commands: BTreeMap<u32, Vec<Command>>,
}

impl Show {
    /// A show on the big table.
    pub(super) fn new(title: &str, see: &str) -> Self {
        Self {
            header: Header {
                title: Some(title.to_owned()),
                nodes: Some(NODES),
                mode: Mode::Mountain,
                ..Header::new(TABLE_MM)
            },
            seed: SEED,
            expect: Expectation {
                see: Some(see.to_owned()),
                ..Expectation::default()
            },
            fingers: Vec::new(),
            commands: BTreeMap::new(),
        }
    }

    /// A visitor at the southern side does something outside the contacts.
    pub(super) fn command(&mut self, t_ms: f64, action: Action) {
        let command = Command {
            side: Some(Side::South),
            ..Command::new(action)
        };
        self.commands.entry(frame_of(t_ms)).or_default().push(command);
    }

    /// Seed of land and tremor.
    pub(super) fn seed(&mut self, seed: u64) {
        self.seed = seed;
    }

    /// How long the world runs and how fine it is.
    pub(super) fn world(&mut self, years: f64, nodes: u64) {
        self.header.years = Some(years);
        self.header.nodes = Some(nodes);
    }

    /// The show is on the globe.
    pub(super) fn on_globe(&mut self) {
        self.header.mode = Mode::Globe;
    }

    /// Nothing may come of it.
    pub(super) fn nothing(&mut self) {
        self.expect.nothing = true;
    }

    /// The land changes at `at` within a second after `t_ms`.
    pub(super) fn changes(&mut self, at: DVec2, t_ms: f64) {
        self.expect.land_changes_at.push(LandChange {
            at: DVec2::new(at.x.round(), at.y.round()),
            t_us: u64::from(frame_of(t_ms) * FRAME_MS) * 1000,
        });
    }

    pub(super) fn finger(&mut self, finger: Finger) {
        self.fingers.push(finger);
    }

    /// A hand of `shape`: its fingers land and lift within a few frames of each other, the middle ones first.
    pub(super) fn hand(&mut self, shape: &[DVec2], poses: &[Pose]) {
        const ORDER: [f64; 5] = [2.0, 0.0, 0.0, 1.0, 2.0];
        for (i, &offset) in shape.iter().enumerate() {
            let late = ORDER[i % ORDER.len()] * f64::from(FRAME_MS);
            let mut finger = Finger::new(poses.to_vec());
            finger.lands_ms += late;
            finger.leaves_ms += late;
            finger.offset = offset;
            self.finger(finger);
        }
    }

    /// A hand that stays where it is.
    pub(super) fn rest(&mut self, shape: &[DVec2], at: DVec2, from_ms: f64, to_ms: f64) {
        let stay = |t_ms| Pose {
            t_ms,
            at,
            turn_deg: 0.0,
        };
        self.hand(shape, &[stay(from_ms), stay(to_ms)]);
    }

    /// A hand that pushes.
    pub(super) fn push(&mut self, shape: &[DVec2], push: Push) -> Pushed {
        let (poses, pushed) = push.poses(shape);
        self.hand(shape, &poses);
        pushed
    }

    /// The file.
    pub(super) fn file(mut self) -> GestureFile {
        let seed = self.seed;
        self.header.seed = Some(seed);
        self.header.expect = Some(self.expect);
        let mut moments: BTreeMap<u32, Vec<ContactEvent>> = BTreeMap::new();
        let mut generations: BTreeMap<u64, u32> = BTreeMap::new();
        self.fingers.sort_by(|a, b| a.lands_ms.total_cmp(&b.lands_ms));
        for (finger, place) in self.fingers.iter().zip(0..) {
            let id = finger.id.unwrap_or(place + 1);
            let generation = generations.entry(id).or_default();
            let key = ContactKey {
                source: Source::File,
                device: 0,
                id,
                generation: *generation,
            };
            *generation += 1;
            sample(finger, key, seed, place, &mut moments);
        }
        let mut commands = self.commands;
        for &frame in commands.keys() {
            moments.entry(frame).or_default();
        }
        let frames = moments.into_iter().map(|(frame, mut events)| {
            events.sort_by_key(|event| (event.phase.order(), event.contact.key));
            InputFrame {
                t_us: u64::from(frame * FRAME_MS) * 1000,
                events,
                commands: commands.remove(&frame).unwrap_or_default(),
            }
        });
        GestureFile {
            header: self.header,
            frames: frames.collect(),
            warnings: Vec::new(),
        }
    }
}

impl Push {
    /// The poses of the hand, and where `shape` ends.
    pub(super) fn poses(self, shape: &[DVec2]) -> (Vec<Pose>, Pushed) {
        let (go_ms, end_ms) = (self.from_ms + POISE_MS, self.from_ms + POISE_MS + self.for_ms);
        let end = self.at + self.by;
        let key = |t_ms, at, turn_deg| Pose { t_ms, at, turn_deg };
        let poses = vec![
            key(self.from_ms, self.at, 0.0),
            key(go_ms, self.at, 0.0),
            key(end_ms, end, self.turn_deg),
            key(end_ms + STAND_MS, end, self.turn_deg),
        ];
        let turn = DVec2::from_angle(self.turn_deg.to_radians());
        let pushed = Pushed {
            end_ms,
            at: end,
            fingers: shape.iter().map(|offset| end + turn.rotate(*offset)).collect(),
            along: self.by.normalize_or_zero(),
        };
        (poses, pushed)
    }
}

fn frame_of(t_ms: f64) -> u32 {
    (t_ms / f64::from(FRAME_MS)).round() as u32
}

/// What the touchscreen reports of a finger.
fn sample(
    finger: &Finger,
    key: ContactKey,
    seed: u64,
    place: u64,
    moments: &mut BTreeMap<u32, Vec<ContactEvent>>,
) {
    let mut tremor = Tremor::new(seed, place);
    let (first, last) = (frame_of(finger.lands_ms), frame_of(finger.leaves_ms));
    let mut reported: Option<Contact> = None;
    for frame in first..last {
        let t_ms = f64::from(frame * FRAME_MS);
        let at = if finger.frozen {
            finger.at(finger.lands_ms)
        } else {
            finger.at(t_ms) + tremor.next()
        };
        let contact = Contact {
            key,
            position: DVec2::new(quantise_mm(at.x), quantise_mm(at.y)),
            size_mm: finger
                .size_at(t_ms)
                .map(|size| DVec2::new(quantise_mm(size.x), quantise_mm(size.y))),
            confidence: match finger.doubted_ms {
                Some(doubted_ms) if t_ms >= doubted_ms => Some(0.0),
                _ => finger.confidence,
            },
        };
        let phase = match reported {
            None => Phase::Down,
            Some(old)
                if old.position.distance(contact.position) < HYSTERESIS_MM
                    && (old.size_mm, old.confidence) == (contact.size_mm, contact.confidence) =>
            {
                continue;
            }
            Some(_) => Phase::Move,
        };
        reported = Some(contact);
        moments
            .entry(frame)
            .or_default()
            .push(ContactEvent { phase, contact });
    }
    if let Some(contact) = reported {
        let phase = finger.leaves;
        moments
            .entry(last)
            .or_default()
            .push(ContactEvent { phase, contact });
    }
}

/// The tremor of one finger: a first-order autoregressive process.
struct Tremor {
    rng: Pcg64Mcg,
    at: DVec2,
}

impl Tremor {
    fn new(seed: u64, place: u64) -> Self {
        Self {
            rng: Pcg64Mcg::new((u128::from(seed) << 64) | u128::from(place)),
            at: DVec2::ZERO,
        }
    }

    fn next(&mut self) -> DVec2 {
        // A uniform number of unit variance, on a scale that gives the process the size asked for.
        let scale = TREMOR_MM * (1.0 - TREMOR_KEEP * TREMOR_KEEP).sqrt() * 12.0_f64.sqrt();
        let mut noise = || ((self.rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64 - 0.5) * scale;
        let kick = DVec2::new(noise(), noise());
        self.at = self.at * TREMOR_KEEP + kick;
        self.at
    }
}
