//! A developer's tool: draws thickening and uplift of typical gestures, to be looked at.
//!
//! `cargo run --example uplift_preview -- DIR` writes `DIR/<scene>.png`: above the uplift rate (brown rises, blue
//! sinks, contours every 0.1 mm/yr, faults red, supports grey), below `q` (white 1, red thicker, blue thinner).

use std::path::PathBuf;

use glam::DVec2;
use image::{Rgb, RgbImage};
use orogen::gesture::contact::Side;
use orogen::gesture::event::{HandEvent, HandId, Leg};
use orogen::gesture::rigid::RigidFit;
use orogen::mountain::{MountainParams, PlateSet, TectonicField, Tectonics};
use orogen::units::{DEFAULT_SHORT_SIDE, KM, PlanMap};

/// Five fingertips of a right hand spread to 19 km, km from its middle, fingers towards north.
const HAND: [[f64; 2]; 5] = [[-9.0, -4.0], [-5.5, 6.0], [0.0, 8.5], [5.0, 7.0], [9.0, 1.0]];

struct Scene {
    name: &'static str,
    hands: Vec<Hand>,
}

/// Fingers, rotation of the hand, and how it moves (km and degrees).
struct Hand {
    fingers: usize,
    at: [f64; 2],
    facing: f64,
    push: [f64; 2],
    turn: f64,
}

fn hand(fingers: usize, at: [f64; 2], facing: f64, push: [f64; 2], turn: f64) -> Hand {
    Hand {
        fingers,
        at,
        facing,
        push,
        turn,
    }
}

fn scenes() -> Vec<Scene> {
    let scene = |name, hands| Scene { name, hands };
    vec![
        scene(
            "two-hands",
            vec![
                hand(5, [45.0, 50.0], -90.0, [0.0, 0.0], 0.0),
                hand(5, [125.0, 50.0], 90.0, [-16.0, 0.0], 0.0),
            ],
        ),
        scene("one-finger", vec![hand(1, [110.0, 50.0], 0.0, [-14.0, 2.0], 0.0)]),
        scene("one-hand", vec![hand(5, [125.0, 50.0], 90.0, [-16.0, 0.0], 0.0)]),
        scene(
            "equal-pushes",
            vec![
                hand(5, [45.0, 48.0], -90.0, [9.0, 0.0], 0.0),
                hand(5, [125.0, 52.0], 90.0, [-9.0, 0.0], 0.0),
            ],
        ),
        scene(
            "oblique",
            vec![
                hand(5, [45.0, 42.0], -90.0, [0.0, 0.0], 0.0),
                hand(5, [125.0, 56.0], 90.0, [-14.0, -8.0], 0.0),
            ],
        ),
        scene("twist", vec![hand(5, [90.0, 50.0], 0.0, [0.0, 0.0], 50.0)]),
        scene(
            "push-and-turn",
            vec![
                hand(5, [45.0, 50.0], -90.0, [0.0, 0.0], 0.0),
                hand(5, [125.0, 50.0], 90.0, [-15.0, 3.0], 12.0),
            ],
        ),
        scene(
            "pull-apart",
            vec![
                hand(5, [65.0, 50.0], -90.0, [-10.0, 0.0], 0.0),
                hand(5, [110.0, 50.0], 90.0, [10.0, 0.0], 0.0),
            ],
        ),
        scene(
            "three-plates",
            vec![
                hand(5, [40.0, 40.0], -90.0, [0.0, 0.0], 0.0),
                hand(5, [110.0, 28.0], 60.0, [-14.0, 3.0], 0.0),
                hand(5, [95.0, 82.0], 180.0, [-6.0, -12.0], 0.0),
            ],
        ),
        scene(
            "four-visitors",
            vec![
                hand(5, [28.0, 22.0], 0.0, [10.0, 6.0], 0.0),
                hand(5, [150.0, 25.0], 30.0, [-12.0, 8.0], 5.0),
                hand(5, [40.0, 82.0], 180.0, [8.0, -10.0], 0.0),
                hand(3, [120.0, 80.0], 200.0, [-8.0, -9.0], 0.0),
            ],
        ),
        scene(
            "small-push",
            vec![
                hand(5, [45.0, 50.0], -90.0, [0.0, 0.0], 0.0),
                hand(5, [125.0, 50.0], 90.0, [-3.0, 0.0], 0.0),
            ],
        ),
        scene(
            "too-long",
            vec![
                hand(5, [55.0, 50.0], -90.0, [0.0, 0.0], 0.0),
                hand(5, [125.0, 55.0], 90.0, [-60.0, 0.0], 0.0),
            ],
        ),
        scene(
            "far-apart",
            vec![
                hand(5, [20.0, 50.0], -90.0, [0.0, 0.0], 0.0),
                hand(5, [150.0, 50.0], 90.0, [-16.0, 0.0], 0.0),
            ],
        ),
        scene(
            "chase",
            vec![
                hand(5, [60.0, 50.0], -90.0, [6.0, 0.0], 0.0),
                hand(5, [20.0, 50.0], -90.0, [16.0, 0.0], 0.0),
            ],
        ),
    ]
}

fn play(scene: &Scene, map: &PlanMap, params: &MountainParams) -> PlateSet {
    let mut plates = PlateSet::default();
    for (index, hand) in scene.hands.iter().enumerate() {
        let id = HandId(index as u32);
        let at = DVec2::from_array(hand.at);
        let starts: Vec<DVec2> = HAND[..hand.fingers]
            .iter()
            .map(|&f| (at + DVec2::from_angle(hand.facing.to_radians()).rotate(DVec2::from_array(f))) * KM)
            .collect();
        let turn = DVec2::from_angle(hand.turn.to_radians());
        let push = DVec2::from_array(hand.push) * KM;
        let tips: Vec<DVec2> = starts
            .iter()
            .map(|&p| turn.rotate(p - at * KM) + at * KM + push)
            .collect();
        let mm = |points: &[DVec2]| points.iter().map(|&p| map.to_table(p)).collect::<Vec<_>>();
        let event = if starts == tips {
            HandEvent::Rest {
                hand: id,
                side: Side::South,
                fingers: mm(&starts),
            }
        } else {
            HandEvent::Push {
                leg: Leg { hand: id, index: 0 },
                side: Side::South,
                starts: mm(&starts),
                fit: RigidFit::fit(&mm(&starts), &mm(&tips)),
            }
        };
        plates.apply(&event, map, 0.0, params);
    }
    plates
}

fn draw(field: &TectonicField, plates: &PlateSet, map: &PlanMap) -> RgbImage {
    const WIDTH: u32 = 1100;
    let extent = map.extent();
    let height = (f64::from(WIDTH) * extent.height / extent.width) as u32;
    let metres = extent.width / f64::from(WIDTH);
    let mut image = RgbImage::new(WIDTH, 2 * height);
    let place =
        |x: u32, y: u32| DVec2::new(f64::from(x) + 0.5, f64::from(height) - f64::from(y) - 0.5) * metres;
    let dx = DVec2::new(metres, 0.0);
    let dy = DVec2::new(0.0, metres);
    for y in 0..height {
        for x in 0..WIDTH {
            let p = place(x, y);
            let u = field.uplift_at(p) * 1e3;
            // Lit as if it were the land after 5 My, so that creases show.
            let slope = |d: DVec2| (field.uplift_at(p + d) - field.uplift_at(p - d)) * 5e6 / (2.0 * metres);
            let light = (1.0 + 2.0 * (slope(dx) - slope(dy))).clamp(0.35, 1.6) as f32;
            let tint = if u >= 0.0 {
                let t = (u / 1.2).min(1.0) as f32;
                [225.0 - 110.0 * t, 220.0 - 150.0 * t, 190.0 - 150.0 * t]
            } else {
                let t = (-u / 0.8).min(1.0) as f32;
                [225.0 - 150.0 * t, 220.0 - 90.0 * t, 190.0 + 40.0 * t]
            };
            let step = |v: f64| (v * 10.0).floor();
            let contour = step(u) != step(field.uplift_at(p + dx) * 1e3)
                || step(u) != step(field.uplift_at(p - dy) * 1e3);
            let shade = if contour { 0.75 } else { 1.0 };
            image.put_pixel(
                x,
                y,
                Rgb(tint.map(|c| (c * light * shade).clamp(0.0, 255.0) as u8)),
            );
            let q = field.transport.q.at(p) as f32 - 1.0;
            let (red, blue) = ((q * 400.0).clamp(0.0, 200.0), (-q * 400.0).clamp(0.0, 200.0));
            image.put_pixel(
                x,
                height + y,
                Rgb([
                    (250.0 - blue) as u8,
                    (250.0 - red - blue).max(0.0) as u8,
                    (250.0 - red) as u8,
                ]),
            );
        }
    }
    let mut line = |a: DVec2, b: DVec2, colour: Rgb<u8>| {
        let n = (a.distance(b) / metres).ceil().max(1.0) as usize;
        for k in 0..=n {
            let p = a.lerp(b, k as f64 / n as f64) / metres;
            let (x, y) = (p.x as i64, (f64::from(height) - p.y) as i64);
            if (0..i64::from(WIDTH)).contains(&x) && (0..i64::from(height)).contains(&y) {
                image.put_pixel(x as u32, y as u32, colour);
            }
        }
    };
    for plate in plates.plates() {
        for (hull, colour) in [
            (plate.support.clone(), Rgb([170, 170, 170])),
            (plate.moved_support(), Rgb([90, 90, 90])),
        ] {
            let rim = hull.outline(1_000.0);
            for k in 0..rim.len() {
                line(rim[k], rim[(k + 1) % rim.len()], colour);
            }
        }
        for (from, to) in plate.arrows() {
            line(from, to, Rgb([40, 40, 40]));
        }
    }
    for fault in &field.faults {
        for ends in fault.points.windows(2) {
            line(ends[0], ends[1], Rgb([200, 20, 20]));
            // A tooth every so often, on the range's side.
            if (ends[0].x / 2_000.0).floor() != (ends[1].x / 2_000.0).floor()
                || (ends[0].y / 2_000.0).floor() != (ends[1].y / 2_000.0).floor()
            {
                let left = (ends[1] - ends[0]).perp().normalize_or_zero();
                line(ends[0], ends[0] + left * 1_200.0, Rgb([200, 20, 20]));
            }
        }
    }
    image
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().unwrap_or_else(|| "orogen-out".into()));
    let params = if arguments.next().as_deref() == Some("paper") {
        MountainParams::paper()
    } else {
        MountainParams::default()
    };
    std::fs::create_dir_all(&folder)?;
    let map = PlanMap::new(DVec2::new(1209.6, 680.4), DEFAULT_SHORT_SIDE);
    let mut tectonics = Tectonics::default();
    let mut index = Vec::new();
    for scene in scenes() {
        let plates = play(&scene, &map, &params);
        let field = tectonics.compute(&plates, map.extent(), 1.0, &params);
        draw(&field, &plates, &map).save(folder.join(format!("{}.png", scene.name)))?;
        let caps: Vec<f64> = plates.plates().iter().map(|p| p.cap).collect();
        index.push(format!(
            "{}: {:?}\n  caps {caps:?}, {} faults\n",
            scene.name,
            field.report,
            field.faults.len()
        ));
    }
    std::fs::write(folder.join("figures.txt"), index.concat())?;
    Ok(())
}
