//! Times of TUIO packets: from the bytes of a datagram to who touches now.

use std::net::SocketAddr;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec2;
use orogen::input::tuio::{TuioDecoder, TuioOptions};
use rosc::{OscBundle, OscMessage, OscPacket, OscType, encoder};

fn message(address: &str, args: Vec<OscType>) -> OscPacket {
    OscPacket::Message(OscMessage {
        addr: address.to_owned(),
        args,
    })
}

/// A frame of so many cursors of TUIO 1.1, that move with `step`. It has no number, so it is never late.
fn cursors(count: i32, step: i32) -> Vec<u8> {
    let of = |args: Vec<OscType>| message("/tuio/2Dcur", args);
    let alive = std::iter::once("alive".into()).chain((0..count).map(OscType::Int));
    let mut content = vec![
        of(vec!["source".into(), "bench@host".into()]),
        of(alive.collect()),
    ];
    content.extend((0..count).map(|id| {
        let x = ((id + step) % count) as f32 / count as f32;
        let numbers = [x, 0.5, 0.0, 0.0, 0.0].map(OscType::Float);
        of([vec!["set".into(), id.into()], numbers.to_vec()].concat())
    }));
    content.push(of(vec!["fseq".into(), (-1).into()]));
    let timetag = (0, 1).into();
    encoder::encode(&OscPacket::Bundle(OscBundle { timetag, content })).expect("a packet")
}

/// The same of pointers of TUIO 2.0.
fn pointers(count: i32, step: i32) -> Vec<u8> {
    let time = OscType::Time((1, 0).into());
    let frame = vec![0.into(), time, 0.into(), "bench:0@host".into()];
    let mut content = vec![message("/tuio2/frm", frame)];
    content.extend((0..count).map(|id| {
        let x = ((id + step) % count) as f32 / count as f32;
        let numbers = [x, 0.5, 0.0, 0.0, 0.01, 0.5].map(OscType::Float);
        let head = vec![id.into(), 0.into(), 0.into()];
        message("/tuio2/ptr", [head, numbers.to_vec()].concat())
    }));
    content.push(message("/tuio2/alv", (0..count).map(OscType::Int).collect()));
    let timetag = (0, 1).into();
    encoder::encode(&OscPacket::Bundle(OscBundle { timetag, content })).expect("a packet")
}

/// Writes a frame of so many contacts.
type Writer = fn(i32, i32) -> Vec<u8>;

fn bundle(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("tuio");
    group.throughput(Throughput::Elements(1));
    for (name, packet) in [("1.1", cursors as Writer), ("2.0", pointers)] {
        for count in [10, 40, 256] {
            let packets: Vec<_> = (0..64).map(|step| packet(count, step)).collect();
            let peer = SocketAddr::from(([127, 0, 0, 1], 5000));
            group.bench_function(BenchmarkId::new(name, count), |bencher| {
                let mut decoder = TuioDecoder::new(TuioOptions {
                    surface_mm: Some(DVec2::new(1000.0, 500.0)),
                });
                let (mut t_us, mut seen, mut next) = (0, 0, packets.iter().cycle());
                bencher.iter(|| {
                    // A hundred frames a second, which is not above the rate.
                    t_us += 10_000;
                    let Some(packet) = next.next() else { return };
                    decoder.packet(t_us, peer, packet, &mut |_| seen += 1);
                });
                assert!(seen > 0, "no packet was a frame");
            });
        }
    }
    group.finish();
}

criterion_group!(benches, bundle);
criterion_main!(benches);
