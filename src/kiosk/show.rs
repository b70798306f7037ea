//! The show: gesture files played as contacts, one after the other, for as long as nobody is there.

use std::collections::BTreeMap;

use glam::DVec2;

use super::lived::Lived;
use crate::gesture::contact::{ContactEvent, ContactKey, InputFrame, Phase, quantise_mm};
use crate::gesture::file::read_gesture;
use crate::gesture::hand::HandTracker;
use crate::gesture::params::GestureParams;

/// What is shown, in turn: the files whose land is worth stopping for.
const PLAYLIST: [&str; 6] = [
    include_str!("../../gestures/two_hands_push.gesture.jsonl"),
    include_str!("../../gestures/builtin_session.gesture.jsonl"),
    include_str!("../../gestures/one_finger_push.gesture.jsonl"),
    include_str!("../../gestures/three_plates.gesture.jsonl"),
    include_str!("../../gestures/pull_apart.gesture.jsonl"),
    include_str!("../../gestures/four_visitors.gesture.jsonl"),
];

/// After the hands have gone the land is watched from above while it rises, then in flight, then the view comes back
/// for the next hands, µs.
const WATCH_US: u64 = 7_000_000;
const FLY_US: u64 = 16_000_000;
const LAND_US: u64 = 1_500_000;

/// What one look may add to the time, µs: after a halt the hands go on where they were.
const LONGEST_LOOK_US: u64 = 200_000;

/// Parts of a table that a clip may fill, the best first.
const SIZES: [f64; 5] = [1.0, 0.8, 0.64, 0.5, 0.4];

/// A tick of the hands, when a clip is tried on a table, µs, and how long it is watched after its end.
const TICK_US: u64 = 16_000;
const TRIED_US: u64 = 1_000_000;

/// What the show does now.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShowStep {
    /// The land is to start afresh, from this seed, before the frames are played.
    pub fresh: Option<u64>,
    /// Contacts (of [`crate::gesture::contact::Source::File`]), all at the present.
    pub frames: Vec<InputFrame>,
    /// No hand is on the table and the view may fly.
    pub fly: bool,
}

/// Plays the list over and over, each clip on fresh land.
#[derive(Clone, Debug)]
pub struct Show {
    clips: Vec<Clip>,
    lived: Lived,
    /// The clip that plays, or is to play next.
    clip: usize,
    /// When it began, µs lived; `None` before it has.
    begun_us: Option<u64>,
    /// Frames of it played.
    played: usize,
    playing: bool,
    down: BTreeMap<ContactKey, ContactEvent>,
    /// Added to generations, so that a contact of one clip is none of another's.
    generation: u32,
}

/// One file, in the millimetres of this table.
#[derive(Clone, Debug)]
struct Clip {
    seed: u64,
    frames: Vec<InputFrame>,
}

impl Show {
    /// A show for a table of `size_mm`, not yet begun. Clips fill the table as far as their hands stay the hands they
    /// are (on a wall they would fall apart), and those whose hands run together on a small table are left out.
    pub fn new(size_mm: DVec2) -> Self {
        let files = PLAYLIST
            .iter()
            .filter_map(|text| read_gesture(text.as_bytes(), "show").ok());
        let clips = files.filter_map(|file| {
            let own = file.header.size_mm;
            let clip = Clip {
                seed: file.header.seed.unwrap_or_default(),
                frames: file.frames,
            };
            let hands = clip.hands(own);
            let sizes = SIZES.iter().map(|size| clip.fitted(own, size_mm, *size));
            sizes.into_iter().find(|fitted| fitted.hands(size_mm) == hands)
        });
        Self {
            clips: clips.collect(),
            lived: Lived::new(LONGEST_LOOK_US),
            clip: 0,
            begun_us: None,
            played: 0,
            playing: false,
            down: BTreeMap::new(),
            generation: 0,
        }
    }

    /// True between start and stop.
    pub fn playing(&self) -> bool {
        self.playing
    }

    /// It begins, with the clip after the one that was shown last.
    pub fn start(&mut self) {
        self.playing = true;
        self.begun_us = None;
    }

    /// What happens up to `now_us`. To be called once a frame.
    pub fn advance(&mut self, now_us: u64) -> ShowStep {
        let lived_us = self.lived.at(now_us);
        let mut step = ShowStep::default();
        if !self.playing || self.clips.is_empty() {
            return step;
        }
        if self.begun_us.is_none() {
            step.fresh = Some(self.clips[self.clip].seed);
            self.played = 0;
        }
        let begun_us = *self.begun_us.get_or_insert(lived_us);
        let time_us = lived_us - begun_us;
        let frames = &self.clips[self.clip].frames;
        while let Some(frame) = frames.get(self.played).filter(|frame| frame.t_us <= time_us) {
            let mut frame = frame.clone();
            frame.t_us = now_us;
            for event in &mut frame.events {
                let key = &mut event.contact.key;
                key.generation = key.generation.wrapping_add(self.generation);
                match event.phase {
                    Phase::Down | Phase::Move => self.down.insert(*key, *event),
                    Phase::Up | Phase::Cancel => self.down.remove(key),
                };
            }
            step.frames.push(frame);
            self.played += 1;
        }
        let end_us = frames.last().map_or(0, |frame| frame.t_us);
        let after_us = time_us.saturating_sub(end_us);
        step.fly = after_us > WATCH_US && after_us < WATCH_US + FLY_US;
        if after_us >= WATCH_US + FLY_US + LAND_US {
            self.next();
        }
        step
    }

    /// It ends: the frame that withdraws its contacts, if any are down.
    pub fn stop(&mut self, now_us: u64) -> Option<InputFrame> {
        if self.playing && self.begun_us.is_some() {
            self.next();
        }
        self.playing = false;
        let events: Vec<ContactEvent> = std::mem::take(&mut self.down)
            .into_values()
            .map(|event| ContactEvent {
                phase: Phase::Cancel,
                ..event
            })
            .collect();
        (!events.is_empty()).then(|| InputFrame {
            t_us: now_us,
            events,
            commands: Vec::new(),
        })
    }

    fn next(&mut self) {
        let generations = self.clips[self.clip].generations();
        self.generation = self.generation.wrapping_add(generations);
        self.clip = (self.clip + 1) % self.clips.len();
        self.begun_us = None;
    }
}

impl Clip {
    /// In the middle of a table of another size, filling `part` of it.
    fn fitted(&self, own: DVec2, size_mm: DVec2, part: f64) -> Self {
        let scale = part * (size_mm / own).min_element();
        let place = |at: DVec2| {
            let at = (at - own / 2.0) * scale + size_mm / 2.0;
            DVec2::new(quantise_mm(at.x), quantise_mm(at.y))
        };
        let mut frames = self.frames.clone();
        for event in frames.iter_mut().flat_map(|frame| &mut frame.events) {
            event.contact.position = place(event.contact.position);
        }
        Self {
            seed: self.seed,
            frames,
        }
    }

    /// Hands and pushes that it makes on a table of `size_mm`.
    fn hands(&self, size_mm: DVec2) -> (u64, u64) {
        let mut hands = HandTracker::new(GestureParams::default(), size_mm);
        let end_us = self.frames.last().map_or(0, |frame| frame.t_us) + TRIED_US;
        let mut frames = self.frames.iter().peekable();
        for tick in 0..=end_us / TICK_US {
            let now_us = tick * TICK_US;
            while let Some(frame) = frames.next_if(|frame| frame.t_us <= now_us) {
                hands.feed(frame);
            }
            hands.tick(now_us);
        }
        let stats = hands.stats();
        (stats.hands, stats.pushes)
    }

    /// How many generations its keys use.
    fn generations(&self) -> u32 {
        let events = self.frames.iter().flat_map(|frame| &frame.events);
        events
            .map(|event| event.contact.key.generation)
            .max()
            .unwrap_or(0)
            + 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE_MM: DVec2 = DVec2::new(1209.6, 680.4);

    #[test]
    fn every_file_of_the_list_is_shown_on_tables_from_a_screen_to_a_wall() {
        for (width, height) in [(600.0, 340.0), (1209.6, 680.4), (1300.0, 900.0), (3000.0, 1700.0)] {
            let clips = Show::new(DVec2::new(width, height)).clips.len();
            assert_eq!(clips, PLAYLIST.len(), "on {width} × {height}");
        }
    }

    #[test]
    fn clips_whose_hands_run_together_on_a_small_table_are_left_out() {
        let clips = Show::new(DVec2::new(250.0, 140.0)).clips.len();
        assert!(0 < clips && clips < PLAYLIST.len(), "{clips}");
    }

    #[test]
    fn clips_are_centred_and_their_frames_stay_on_the_table() {
        for size_mm in [SIZE_MM * 0.5, DVec2::new(900.0, 900.0), DVec2::new(2000.0, 700.0)] {
            for clip in Show::new(size_mm).clips {
                for event in clip.frames.iter().flat_map(|frame| &frame.events) {
                    let at = event.contact.position;
                    assert!(at.min_element() >= 0.0 && (size_mm - at).min_element() >= 0.0);
                }
            }
        }
    }
}
