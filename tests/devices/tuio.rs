//! The TUIO listener on a port of this machine.

use std::io::ErrorKind;
use std::net::{IpAddr, SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use crate::tuio_common::*;
use orogen::device::tuio::{TuioListener, TuioListenerOptions};
use orogen::device::{DeviceFrame, FrameQueue};

fn local(port: u16) -> TuioListenerOptions {
    TuioListenerOptions {
        address: peer(port),
        ..TuioListenerOptions::default()
    }
}

/// All that comes until `enough` of it has, or ten seconds have passed.
fn wait(queue: &FrameQueue, enough: impl Fn(&[DeviceFrame]) -> bool) -> Vec<DeviceFrame> {
    let began = Instant::now();
    let (mut all, mut new) = (Vec::new(), Vec::new());
    while !enough(&all) && began.elapsed() < Duration::from_secs(10) {
        queue.drain(&mut new);
        all.extend(new.iter().cloned());
        std::thread::sleep(Duration::from_millis(2));
    }
    all
}

#[test]
fn a_sender_is_plugged_heard_and_unplugged() {
    let queue = FrameQueue::new(None);
    let listener = TuioListener::start(local(0), queue.clone()).expect("a free port");
    let sender = UdpSocket::bind(peer(0)).unwrap();
    let from = sender.local_addr().unwrap();
    sender
        .send_to(&cursors("tracker@host", 1, &[(7, 0.5, 0.25)]), listener.address())
        .unwrap();
    let frames = wait(&queue, |frames| frames.len() >= 2);
    assert!(
        matches!(&frames[0], DeviceFrame::Plugged { device: 0, name, .. } if *name == format!("tracker@host from {from}")),
        "{frames:?}"
    );
    assert!(
        matches!(&frames[1], DeviceFrame::State { device: 0, touching, .. } if touching.len() == 1 && touching[0].id == 7),
        "{frames:?}"
    );
    let heard = listener.heard();
    assert_eq!((heard.counts.frames, heard.refused), (1, 0));
    drop(listener);
    assert_eq!(
        wait(&queue, |frames| !frames.is_empty()),
        [DeviceFrame::Unplugged { device: 0 }]
    );
}

#[test]
fn a_packet_may_be_as_large_as_a_datagram() {
    let queue = FrameQueue::new(None);
    let listener = TuioListener::start(local(0), queue.clone()).expect("a free port");
    let many: Vec<_> = (0..250).map(|id| (id, id as f32 / 250.0, 0.5)).collect();
    let packet = cursors("tracker@host", 1, &many);
    assert!(packet.len() > 14_000);
    UdpSocket::bind(peer(0))
        .unwrap()
        .send_to(&packet, listener.address())
        .unwrap();
    let frames = wait(&queue, |frames| frames.len() >= 2);
    assert!(matches!(&frames[1], DeviceFrame::State { touching, .. } if touching.len() == 250));
}

#[test]
fn a_port_that_is_taken_is_named() {
    let other = UdpSocket::bind(peer(0)).unwrap();
    let taken = other.local_addr().unwrap();
    let error = TuioListener::start(local(taken.port()), FrameQueue::new(None)).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::AddrInUse);
    let text = error.to_string();
    assert!(
        text.contains(&taken.to_string()) && text.contains("another program"),
        "{text}"
    );
}

#[test]
fn the_network_is_heard_only_by_leave() {
    let open = TuioListenerOptions {
        address: SocketAddr::from(([0, 0, 0, 0], 0)),
        ..TuioListenerOptions::default()
    };
    let error = TuioListener::start(open.clone(), FrameQueue::new(None)).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::PermissionDenied);
    let open = TuioListenerOptions {
        open_to_network: true,
        ..open
    };
    TuioListener::start(open, FrameQueue::new(None)).expect("with leave");
}

#[test]
fn who_is_not_allowed_is_not_heard() {
    let queue = FrameQueue::new(None);
    let options = TuioListenerOptions {
        allowed: vec![IpAddr::from([10, 0, 0, 1])],
        ..local(0)
    };
    let listener = TuioListener::start(options, queue.clone()).expect("a free port");
    let sender = UdpSocket::bind(peer(0)).unwrap();
    sender
        .send_to(&cursors("tracker@host", 1, &[(7, 0.5, 0.25)]), listener.address())
        .unwrap();
    let began = Instant::now();
    while listener.heard().refused == 0 && began.elapsed() < Duration::from_secs(10) {
        std::thread::sleep(Duration::from_millis(2));
    }
    assert_eq!(
        (listener.heard().refused, listener.heard().counts.packets),
        (1, 0)
    );
    assert_eq!(wait(&queue, |_| true), []);
}
