//! A table for tests: contacts put down, moved and lifted by hand, ticks of 16 ms.
use glam::DVec2;
use orogen::gesture::contact::{Contact, ContactEvent, ContactKey, InputFrame, Phase, Source};
use orogen::gesture::event::{HandEvent, HandId};
use orogen::gesture::hand::HandTracker;
use orogen::gesture::params::GestureParams;

pub(crate) const TABLE_MM: DVec2 = DVec2::new(1209.6, 680.4);
pub(crate) const TICK_US: u64 = 16_000;

pub(crate) fn key(id: u64) -> ContactKey {
    ContactKey {
        source: Source::File,
        device: 0,
        id,
        generation: 0,
    }
}

pub(crate) fn event(phase: Phase, id: u64, x: f64, y: f64) -> ContactEvent {
    ContactEvent {
        phase,
        contact: Contact {
            key: key(id),
            position: DVec2::new(x, y),
            size_mm: None,
            confidence: None,
        },
    }
}

pub(crate) fn with_size(mut event: ContactEvent, w: f64, h: f64) -> ContactEvent {
    event.contact.size_mm = Some(DVec2::new(w, h));
    event
}

pub(crate) fn with_confidence(mut event: ContactEvent, confidence: f32) -> ContactEvent {
    event.contact.confidence = Some(confidence);
    event
}

/// A finger by its id, from where to where it goes.
pub(crate) type Drag = (u64, (f64, f64), (f64, f64));

/// A table on which a script plays. Time is in milliseconds.
#[derive(Clone)]
pub(crate) struct Table {
    pub(crate) tracker: HandTracker,
    pub(crate) t_us: u64,
    ticked_us: u64,
    /// Everything the hands did, with the tick in which it was told.
    pub(crate) told: Vec<(u64, HandEvent)>,
}

impl Default for Table {
    fn default() -> Self {
        Self {
            tracker: HandTracker::new(GestureParams::default(), TABLE_MM),
            t_us: 0,
            ticked_us: 0,
            told: Vec::new(),
        }
    }
}

impl Table {
    /// Plays ticks until `ms`.
    pub(crate) fn until(&mut self, ms: f64) -> &mut Self {
        self.t_us = (ms * 1000.0) as u64;
        while self.ticked_us + TICK_US <= self.t_us {
            self.ticked_us += TICK_US;
            let events = self.tracker.tick(self.ticked_us);
            self.tracker.sanity_check().expect("a sane tracker");
            self.told.extend(events.into_iter().map(|e| (self.ticked_us, e)));
        }
        self
    }

    /// Feeds events at `ms`.
    pub(crate) fn at(&mut self, ms: f64, events: &[ContactEvent]) -> &mut Self {
        // Ticks before this moment have gone by; one at this very moment comes after it.
        self.until(((ms * 1000.0) as u64).saturating_sub(1) as f64 / 1000.0);
        self.t_us = (ms * 1000.0) as u64;
        self.tracker.feed(&InputFrame {
            t_us: self.t_us,
            events: events.to_vec(),
            commands: Vec::new(),
        });
        self
    }

    pub(crate) fn down(&mut self, ms: f64, id: u64, x: f64, y: f64) -> &mut Self {
        self.at(ms, &[event(Phase::Down, id, x, y)])
    }

    pub(crate) fn shift(&mut self, ms: f64, id: u64, x: f64, y: f64) -> &mut Self {
        self.at(ms, &[event(Phase::Move, id, x, y)])
    }

    pub(crate) fn up(&mut self, ms: f64, id: u64) -> &mut Self {
        self.at(ms, &[event(Phase::Up, id, 0.0, 0.0)])
    }

    pub(crate) fn cancel(&mut self, ms: f64, id: u64) -> &mut Self {
        self.at(ms, &[event(Phase::Cancel, id, 0.0, 0.0)])
    }

    /// Drags fingers straight and evenly from their first to their second places, in steps of at most 4 mm.
    pub(crate) fn drag(&mut self, from_ms: f64, to_ms: f64, fingers: &[Drag]) -> &mut Self {
        let longest = fingers
            .iter()
            .map(|(_, a, b)| DVec2::from(*a).distance(DVec2::from(*b)));
        let steps = (longest.fold(0.0, f64::max) / 4.0).ceil().max(1.0);
        for step in 1..=steps as u64 {
            let part = step as f64 / steps;
            let events: Vec<ContactEvent> = fingers
                .iter()
                .map(|&(id, a, b)| {
                    let p = DVec2::from(a).lerp(DVec2::from(b), part);
                    event(Phase::Move, id, p.x, p.y)
                })
                .collect();
            self.at(from_ms + (to_ms - from_ms) * part, &events);
        }
        self
    }

    /// Lifts what is left and returns all events, in order.
    pub(crate) fn finish(&mut self) -> Vec<HandEvent> {
        let events = self.tracker.finish(self.t_us);
        let t_us = self.t_us;
        self.told.extend(events.into_iter().map(|e| (t_us, e)));
        self.tracker.sanity_check().expect("a sane tracker");
        assert_eq!(self.tracker.hands().count(), 0);
        self.events()
    }

    pub(crate) fn events(&self) -> Vec<HandEvent> {
        self.told.iter().map(|(_, e)| e.clone()).collect()
    }

    /// What happened, one word each: `rest 0`, `push 0.1` (updates of a leg as one), `end 0.1`, `tap 2`, `lift 0`, `retract`.
    pub(crate) fn words(&self) -> Vec<String> {
        let mut words: Vec<String> = self.told.iter().map(|(_, e)| word(e)).collect();
        words.dedup();
        words
    }

    /// The last push of a leg: its starts, and where the fit takes them.
    pub(crate) fn last_push(&self, hand: u32, index: u32) -> (Vec<DVec2>, Vec<DVec2>) {
        let push = self.told.iter().rev().find_map(|(_, e)| match e {
            HandEvent::Push { leg, starts, fit, .. } if leg.hand == HandId(hand) && leg.index == index => {
                Some((
                    starts.clone(),
                    starts.iter().map(|&p| fit.motion.apply(p)).collect(),
                ))
            }
            _ => None,
        });
        push.unwrap_or_else(|| panic!("no push {hand}.{index} in {:?}", self.words()))
    }
}

pub(crate) fn word(event: &HandEvent) -> String {
    match event {
        HandEvent::Rest { hand, .. } => format!("rest {}", hand.0),
        HandEvent::Push { leg, .. } => format!("push {}.{}", leg.hand.0, leg.index),
        HandEvent::PushEnd { leg } => format!("end {}.{}", leg.hand.0, leg.index),
        HandEvent::Tap { hand, .. } => format!("tap {}", hand.0),
        HandEvent::Lift { hand } => format!("lift {}", hand.0),
        HandEvent::Retract { .. } => "retract".to_owned(),
    }
}

pub(crate) fn near(a: DVec2, b: (f64, f64)) -> bool {
    a.distance(DVec2::from(b)) < 1e-6
}
