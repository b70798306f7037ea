//! Packets of TUIO, from bytes to who touches now.

use std::net::{Ipv4Addr, SocketAddr};

use glam::DVec2;

use super::Bench;
use crate::input::tuio::{TuioDecoder, TuioEvent, TuioOptions};

/// Fingers of a busy table, whose bundle should take 20 µs at most.
const BUSY: u32 = 40;

/// Most fingers, and frames a second of the fastest tables: a second of both should take 50 ms at most.
const MOST: u32 = 256;
const FASTEST_HZ: u32 = 240;

impl Bench {
    /// One bundle of a busy table, and a second of the fullest and fastest.
    pub(super) fn tuio(&mut self) {
        for (stage, fingers, state, packets, runs) in [
            ("tuio_bundle", BUSY, "one packet", 1, 2001),
            ("tuio_second", MOST, "240 Hz", FASTEST_HZ, 11),
        ] {
            let frames: Vec<_> = (0..FASTEST_HZ).map(|step| bundle(fingers, step)).collect();
            let mut frames = frames.iter().cycle();
            let mut decoder = TuioDecoder::new(TuioOptions {
                surface_mm: Some(DVec2::new(1209.6, 680.4)),
            });
            let peer = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
            let mut t_us = 0;
            let mut touching = 0;
            self.time((stage, fingers as usize, state), None, runs, || {
                for frame in frames.by_ref().take(packets as usize) {
                    t_us += u64::from(1_000_000 / FASTEST_HZ);
                    decoder.packet(t_us, peer, frame, &mut |event| {
                        if let TuioEvent::State { touching: now, .. } = event {
                            touching += now.len();
                        }
                    });
                }
                touching
            });
        }
    }
}

/// A frame of TUIO 1.1 without a number, in which all fingers move with `step`.
fn bundle(fingers: u32, step: u32) -> Vec<u8> {
    let mut out = b"#bundle\0\0\0\0\0\0\0\0\x01".to_vec();
    let mut message = |tags: &str, command: &str, numbers: &[[u8; 4]]| {
        let mut message = b"/tuio/2Dcur\0".to_vec();
        for text in [tags, command] {
            message.extend(text.as_bytes());
            message.resize((message.len() + 1).next_multiple_of(4), 0);
        }
        message.extend(numbers.as_flattened());
        out.extend((message.len() as u32).to_be_bytes());
        out.extend(message);
    };
    let ids: Vec<[u8; 4]> = (0..fingers).map(u32::to_be_bytes).collect();
    message(&format!(",s{}", "i".repeat(ids.len())), "alive", &ids);
    for id in 0..fingers {
        let x = ((id + step) % fingers) as f32 / fingers as f32;
        let numbers = [x, 0.5, 0.0, 0.0, 0.0].map(f32::to_be_bytes);
        message(",sifffff", "set", &[&[id.to_be_bytes()], &numbers[..]].concat());
    }
    message(",si", "fseq", &[(-1_i32).to_be_bytes()]);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bundle_is_a_frame() {
        let mut decoder = TuioDecoder::new(TuioOptions::default());
        let peer = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
        let mut seen = Vec::new();
        decoder.packet(0, peer, &bundle(40, 3), &mut |event| {
            if let TuioEvent::State { touching, .. } = event {
                seen.extend(touching.iter().map(|touching| (touching.id, touching.at.x)));
            }
        });
        assert_eq!((seen.len(), seen[5]), (40, (5, f64::from(0.2_f32))));
    }
}
