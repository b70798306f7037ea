//! One stream of contacts from all sources: never the same finger twice.
//!
//! A raw touchscreen is also seen by the window system, and a TUIO sender often sits on such a screen. So one source is
//! listened to at a time, the one that the settings name or, by themselves, the best of those that speak: a raw
//! touchscreen tells most, TUIO less, the window system least. When a better one begins to speak, what the others had
//! down is withdrawn; when all devices of the best are gone, the next one is heard again.

use std::collections::BTreeMap;

use glam::DAffine2;

use super::touching::{Touching, Tracker, TrackerCounts};
use crate::gesture::contact::{Contact, ContactEvent, Source};
use crate::settings::Listen;

/// What was let pass, over all devices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StreamCounts {
    /// What the devices' contacts were, as each tracker counts it.
    pub devices: TrackerCounts,
    /// States of sources that are not listened to.
    pub unheard: u64,
    /// Times that another source was listened to from then on.
    pub turns: u64,
}

/// The devices beside the window, and which source is heard. Everything appends to `out` what it means, in order.
#[derive(Clone, Debug)]
pub struct Stream {
    listen: Listen,
    map: DAffine2,
    devices: BTreeMap<(Source, u16), Tracker>,
    /// The source that has spoken and is better than the window.
    chosen: Option<Source>,
    counts: StreamCounts,
}

impl Stream {
    /// No devices yet. `map` takes parts of a surface to table millimetres.
    pub fn new(listen: Listen, map: DAffine2) -> Self {
        Self {
            listen,
            map,
            devices: BTreeMap::new(),
            chosen: None,
            counts: StreamCounts::default(),
        }
    }

    /// The source that is heard. The mouse is heard always, as the window's.
    pub fn heard(&self) -> Source {
        match self.listen {
            Listen::Auto => self.chosen.unwrap_or(Source::Window),
            Listen::Window => Source::Window,
            Listen::Hid => Source::Hid,
            Listen::Tuio => Source::Tuio,
        }
    }

    /// What was let pass so far.
    pub fn counts(&self) -> StreamCounts {
        let mut counts = self.counts;
        for tracker in self.devices.values() {
            counts.devices += tracker.counts();
        }
        counts
    }

    /// Contacts that are down, by device.
    pub fn contacts(&self) -> impl Iterator<Item = &Contact> {
        self.devices.values().flat_map(Tracker::contacts)
    }

    /// Devices that are there, and whether each is heard.
    pub fn devices(&self) -> impl Iterator<Item = (Source, u16, bool)> {
        let heard = self.heard();
        let keys = self.devices.keys();
        keys.map(move |&(source, device)| (source, device, source == heard))
    }

    /// Another choice. True where the window's touches are to be withdrawn.
    pub fn set_listen(&mut self, listen: Listen, out: &mut Vec<ContactEvent>) -> bool {
        let before = self.heard();
        self.listen = listen;
        self.chosen = None;
        self.turned(before, out)
    }

    /// Another place of the surfaces on the table.
    pub fn set_map(&mut self, map: DAffine2, out: &mut Vec<ContactEvent>) {
        self.map = map;
        for tracker in self.devices.values_mut() {
            tracker.set_map(map, out);
        }
    }

    /// A device is there.
    pub fn plugged(&mut self, source: Source, device: u16) {
        self.devices
            .entry((source, device))
            .or_insert_with(|| Tracker::new(source, device, self.map));
    }

    /// Who touches a device now. True where the window's touches are to be withdrawn, for they are the same fingers.
    pub fn state(
        &mut self,
        source: Source,
        device: u16,
        touching: &[Touching],
        out: &mut Vec<ContactEvent>,
    ) -> bool {
        let before = self.heard();
        if self.listen == Listen::Auto
            && !touching.is_empty()
            && self.chosen.is_none_or(|chosen| rank(source) > rank(chosen))
        {
            self.chosen = Some(source);
        }
        let withdraw = self.turned(before, out);
        if self.heard() == source {
            self.plugged(source, device);
            if let Some(tracker) = self.devices.get_mut(&(source, device)) {
                tracker.frame(touching, out);
            }
        } else {
            self.counts.unheard += 1;
        }
        withdraw
    }

    /// A device is gone: its contacts are withdrawn.
    pub fn unplugged(&mut self, source: Source, device: u16, out: &mut Vec<ContactEvent>) {
        if let Some(mut tracker) = self.devices.remove(&(source, device)) {
            tracker.cancel_all(out);
            self.counts.devices += tracker.counts();
        }
        if self.devices.keys().all(|key| Some(key.0) != self.chosen) {
            self.chosen = None;
        }
    }

    /// Withdraws all contacts of devices.
    pub fn cancel_all(&mut self, out: &mut Vec<ContactEvent>) {
        for tracker in self.devices.values_mut() {
            tracker.cancel_all(out);
        }
    }

    /// Another source may be heard than `before`: the contacts of that are withdrawn. True where it was the window.
    fn turned(&mut self, before: Source, out: &mut Vec<ContactEvent>) -> bool {
        let heard = self.heard();
        if heard == before {
            return false;
        }
        self.counts.turns += 1;
        for (key, tracker) in &mut self.devices {
            if key.0 != heard {
                tracker.cancel_all(out);
            }
        }
        before == Source::Window
    }
}

/// How much a source tells.
fn rank(source: Source) -> u8 {
    match source {
        Source::Hid => 2,
        Source::Tuio => 1,
        Source::Window | Source::Mouse | Source::File => 0,
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::gesture::contact::Phase;

    fn finger(id: u64) -> [Touching; 1] {
        [Touching {
            id,
            at: DVec2::splat(0.5),
            size_mm: None,
            confidence: None,
        }]
    }

    fn phases(out: &mut Vec<ContactEvent>) -> Vec<(Source, Phase)> {
        let brief = |event: ContactEvent| (event.contact.key.source, event.phase);
        out.drain(..).map(brief).collect()
    }

    #[test]
    fn the_better_source_takes_over_and_the_other_comes_back() {
        use Phase::{Cancel, Down};
        let mut stream = Stream::new(Listen::Auto, DAffine2::IDENTITY);
        let mut out = Vec::new();
        stream.plugged(Source::Tuio, 0);
        stream.plugged(Source::Hid, 0);
        assert!(!stream.state(Source::Hid, 0, &[], &mut out));
        assert_eq!(stream.heard(), Source::Window, "nobody has touched it");
        assert!(
            stream.state(Source::Tuio, 0, &finger(1), &mut out),
            "the same finger"
        );
        assert!(!stream.state(Source::Hid, 0, &finger(4), &mut out));
        assert!(!stream.state(Source::Tuio, 0, &finger(2), &mut out));
        let expected = [(Source::Tuio, Down), (Source::Tuio, Cancel), (Source::Hid, Down)];
        assert_eq!(phases(&mut out), expected);
        assert_eq!(stream.counts().unheard, 2);
        stream.unplugged(Source::Hid, 0, &mut out);
        assert_eq!(stream.heard(), Source::Window);
        stream.state(Source::Tuio, 0, &finger(2), &mut out);
        assert_eq!(phases(&mut out), [(Source::Hid, Cancel), (Source::Tuio, Down)]);
        assert_eq!(stream.contacts().count(), 1);
    }

    #[test]
    fn a_named_source_is_the_only_one() {
        let mut stream = Stream::new(Listen::Tuio, DAffine2::IDENTITY);
        let mut out = Vec::new();
        stream.state(Source::Hid, 0, &finger(1), &mut out);
        assert!(out.is_empty() && stream.heard() == Source::Tuio);
        stream.state(Source::Tuio, 0, &finger(1), &mut out);
        assert!(!stream.set_listen(Listen::Hid, &mut out));
        assert_eq!(
            phases(&mut out),
            [(Source::Tuio, Phase::Down), (Source::Tuio, Phase::Cancel)]
        );
        assert!(!stream.set_listen(Listen::Window, &mut out));
        assert!(stream.set_listen(Listen::Hid, &mut out), "the window's go");
    }
}
