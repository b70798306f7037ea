//! A TUIO sender at the real table: one line of settings chooses it, its hands make mountains, and noise beside it stops
//! nothing.

use std::io::Write as _;
use std::net::UdpSocket;
use std::thread;
use std::time::{Duration, Instant};

use crate::tuio_common::cursors;
use crate::window_support::fingers::Script;
use crate::window_support::{SLOW_S, Setup, Table};

/// A sender of 60 frames per second, as reference senders are.
struct Sender {
    socket: UdpSocket,
    to: (&'static str, u16),
    frame: i32,
}

impl Sender {
    fn send(&mut self, down: &[(i32, f32, f32)]) {
        self.frame += 1;
        let packet = cursors("table@test", self.frame, down);
        self.socket.send_to(&packet, self.to).expect("loopback");
        thread::sleep(Duration::from_millis(16));
    }

    /// Two hands of five fingers that go towards each other for two seconds, and lift.
    fn push(&mut self) {
        for step in 0..=120 {
            let way = 0.08 * step as f32 / 120.0;
            let hand = |first: i32, x: f32| {
                (0..5).map(move |i| (first + i, x + 0.02 * i as f32, 0.5 + 0.02 * (i % 3) as f32))
            };
            let down: Vec<_> = hand(1, 0.3 + way).chain(hand(11, 0.6 - way)).collect();
            self.send(&down);
        }
        self.send(&[]);
    }
}

#[test]
fn one_line_of_settings_and_two_hands_of_tuio_make_mountains() {
    let port = UdpSocket::bind("127.0.0.1:0")
        .and_then(|socket| socket.local_addr())
        .expect("a free port")
        .port();
    let settings = format!(
        "[table]\nwidth_mm = 1209.6\n[kiosk]\nidle_s = 600\nflight_after_s = 600\n[input]\nsource = \"tuio\"\ntuio_port = {port}\n"
    );
    let setup = Setup {
        settings: &settings,
        ..Setup::default()
    };
    let Some(mut table) = Table::start(
        "one_line_of_settings_and_two_hands_of_tuio_make_mountains",
        &setup,
    ) else {
        return;
    };
    table.wait("the table", SLOW_S, |now| now.source == "tuio");
    let mut sender = Sender {
        socket: UdpSocket::bind("127.0.0.1:0").expect("a port"),
        to: ("127.0.0.1", port),
        frame: 0,
    };
    // A tap wakes the table.
    for _ in 0..6 {
        sender.send(&[(99, 0.5, 0.5)]);
    }
    sender.send(&[]);
    let fresh = table.wait("the touch to wake the table", SLOW_S, |now| {
        now.phase == "invite" && now.contacts == 0
    });
    sender.push();
    let risen = table.wait("land to rise", SLOW_S, |now| {
        now.contacts == 0 && now.max_m > fresh.max_m + 150.0
    });
    assert!(risen.contacts_total >= fresh.contacts_total + 10, "{risen:?}");
    table.look("risen");

    // The same screen's touches are not heard a second time.
    let mut stroke = Script::default();
    stroke.stroke(0.0, 0.6, table.at(0.3, 0.3), table.at(0.6, 0.3));
    table.play(&stroke);
    let still = table.settled();
    assert_eq!(still.contacts_total, risen.contacts_total);

    // Noise: ten thousand packets a second for three seconds, and a finger that must not be forgotten.
    let noise = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let began = Instant::now();
    let mut sent = 0_u32;
    while began.elapsed() < Duration::from_secs(3) {
        while f64::from(sent) < began.elapsed().as_secs_f64() * 10_000.0 {
            // A full queue of the system drops packets, which is as good.
            let _ = noise.send_to(&sent.to_be_bytes(), sender.to);
            sent += 1;
        }
        sender.send(&[(200, 0.5, 0.5)]);
    }
    sender.send(&[]);
    let after = table.wait("the finger to lift", SLOW_S, |now| {
        now.contacts == 0 && now.packets_refused > 0
    });
    // Past the test harness, which keeps what passing tests print to itself.
    let _ = writeln!(
        std::io::stderr(),
        "frame, median: {:.0} ms before {sent} packets of noise in 3 s, {:.0} ms after; {} refused",
        still.frame_ms_p50,
        after.frame_ms_p50,
        after.packets_refused
    );
    assert_eq!(after.panics, 0);
}
