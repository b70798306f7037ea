//! The best Euler pole for a set of fingers, against published poles of real plates.

use glam::{DMat3, DQuat, DVec3};
use orogen::gesture::pole::{CLOSE, rate, rotation, rotation_vector};
use orogen::sphere::{arc, direction, latitude_longitude};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng as _, SeedableRng as _};

// NNR-MORVEL56 (Argus, Gordon and DeMets 2011, Geochemistry, Geophysics, Geosystems 12, Q11001, Table 1): the plates of
// MORVEL: code, latitude and longitude of the pole in degrees, degrees per million years. Codes tell upper from lower
// case: `nb` is Nubia.
const MORVEL: [(&str, f64, f64, f64); 25] = [
    ("am", 63.17, -122.82, 0.297),
    ("an", 65.42, -118.11, 0.250),
    ("ar", 48.88, -8.49, 0.559),
    ("au", 33.86, 37.94, 0.632),
    ("ca", 35.20, -92.62, 0.286),
    ("co", 26.93, -124.31, 1.198),
    ("cp", 44.44, 23.09, 0.608),
    ("eu", 48.85, -106.50, 0.223),
    ("in", 50.37, -3.29, 0.544),
    ("jf", -38.31, 60.04, 0.951),
    ("lw", 51.89, -69.52, 0.286),
    ("mq", 49.19, 11.05, 1.144),
    ("na", -4.85, -80.64, 0.209),
    ("nb", 47.68, -68.44, 0.292),
    ("nz", 46.23, -101.06, 0.696),
    ("pa", -63.58, 114.70, 0.651),
    ("ps", -46.02, -31.36, 0.910),
    ("ri", 20.25, -107.29, 4.536),
    ("sa", -22.62, -112.83, 0.109),
    ("sc", 22.52, -106.15, 0.146),
    ("sm", 49.95, -84.52, 0.339),
    ("sr", -32.50, -111.32, 0.107),
    ("su", 50.06, -95.02, 0.337),
    ("sw", -29.94, -36.87, 1.362),
    ("yz", 63.03, -116.62, 0.334),
];

fn omega(latitude: f64, longitude: f64, degrees: f64) -> DVec3 {
    direction(latitude, longitude) * degrees.to_radians()
}

struct Dice(Pcg64Mcg);

impl Dice {
    fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn place(&mut self) -> DVec3 {
        let z = 2.0 * self.unit() - 1.0;
        let (sin, cos) = (std::f64::consts::TAU * self.unit()).sin_cos();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * cos, r * sin, z)
    }

    /// `n` places within 30° of some middle, no two of them closer than [`CLOSE`].
    fn patch(&mut self, n: usize) -> Vec<DVec3> {
        let middle = self.place();
        let mut patch: Vec<DVec3> = Vec::new();
        while patch.len() < n {
            let p = self.place();
            if arc(p, middle) < 30_f64.to_radians() && patch.iter().all(|&q| arc(p, q) > CLOSE) {
                patch.push(p);
            }
        }
        patch
    }
}

#[test]
fn published_poles_come_back_from_the_velocities_of_two_three_and_five_fingers() {
    for (fingers, most) in [(2, 1.5e-13), (3, 2e-14), (5, 6e-15)] {
        let mut dice = Dice::new(fingers as u64);
        let mut worst = 0.0_f64;
        for (_, latitude, longitude, degrees) in MORVEL {
            let omega = omega(latitude, longitude, degrees);
            for _ in 0..20 {
                let places = dice.patch(fingers);
                let velocities: Vec<DVec3> = places.iter().map(|&p| omega.cross(p)).collect();
                let found = rate(&places, &velocities, DVec3::ZERO);
                worst = worst.max((found - omega).length() / omega.length());
            }
        }
        assert!(worst < most, "{fingers} fingers: {worst:e}");
    }
}

#[test]
fn published_poles_come_back_from_where_fingers_are_before_and_after() {
    for fingers in [2, 3, 5] {
        let mut dice = Dice::new(10 + fingers as u64);
        let mut worst = 0.0_f64;
        for (_, latitude, longitude, degrees) in MORVEL {
            // 20 My: Rivera turns by 91°, South America by 2°.
            let turn = omega(latitude, longitude, degrees) * 20.0;
            for _ in 0..20 {
                let before = dice.patch(fingers);
                let after: Vec<DVec3> = before
                    .iter()
                    .map(|&p| DQuat::from_scaled_axis(turn) * p)
                    .collect();
                let found = rotation_vector(rotation(&before, &after, DVec3::ZERO));
                worst = worst.max((found - turn).length() / turn.length());
            }
        }
        assert!(worst < 3.5e-13, "{fingers} fingers: {worst:e}");
    }
}

#[test]
fn relative_poles_of_published_plates_are_differences() {
    let of = |code| {
        let plate = MORVEL.iter().find(|plate| plate.0 == code).unwrap();
        omega(plate.1, plate.2, plate.3)
    };
    let relative = of("na") - of("pa");
    let (latitude, longitude) = latitude_longitude(relative);
    assert!((latitude - 48.88).abs() < 0.02, "{latitude}");
    assert!((longitude + 71.71).abs() < 0.02, "{longitude}");
    assert!((relative.length().to_degrees() - 0.75).abs() < 0.005);
}

/// NUVEL-1A says the same twice: plate by plate against no net rotation, and pair by pair.
#[test]
fn published_pairs_are_recovered_from_published_plates() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/globe/plates_velocity.csv");
    let Ok(text) = std::fs::read_to_string(path) else {
        println!("skipped: {path} is not here");
        return;
    };
    let rows: Vec<Vec<&str>> = text
        .lines()
        .filter(|line| !line.starts_with('#') && !line.starts_with("model,"))
        .map(|line| line.split(',').collect())
        .collect();
    let number = |field: &str| -> f64 { field.replace('\u{2212}', "-").parse().expect("a number") };
    let read = |row: &[&str]| omega(number(row[4]), number(row[5]), number(row[6]));
    // The two tables abbreviate differently; and `nb` and `NB` are two plates, so no case is changed.
    let long = |code: &str| match code {
        "af" => "afrc",
        "an" => "anta",
        "ar" => "arab",
        "au" => "aust",
        "ca" => "carb",
        "co" => "coco",
        "eu" => "eura",
        "in" => "indi",
        "na" => "noam",
        "nz" => "nazc",
        "pa" => "pcfc",
        "ri" => "rivr",
        "sa" => "soam",
        _ => panic!("no such plate: {code}"),
    };
    let plate = |code: &str| {
        let row = rows
            .iter()
            .find(|row| row[0] == "NNR-NUVEL-1A" && row[2] == long(code));
        read(row.expect("a row of the plate"))
    };
    let pairs: Vec<&Vec<&str>> = rows.iter().filter(|row| row[0] == "NUVEL-1A(relative)").collect();
    assert_eq!(pairs.len(), 30);
    for row in pairs {
        // All poles are published with the sign that makes the rate positive.
        let (first, second) = row[1].split_once('-').expect("a pair");
        let (found, published) = (plate(first) - plate(second), read(row));
        let pole = arc(found.normalize(), published.normalize()).to_degrees();
        let rate = (found.length() - published.length()).to_degrees().abs();
        assert!(pole < 0.0705, "{}: pole off by {pole}°", row[1]);
        assert!(rate < 0.0051, "{}: rate off by {rate}°/My", row[1]);
    }
    let codes: Vec<&str> = rows
        .iter()
        .filter(|row| row[0] == "NNR-MORVEL56")
        .map(|row| row[2])
        .collect();
    assert_eq!(codes.len(), 56);
    for (code, latitude, longitude, degrees) in MORVEL {
        let row = rows
            .iter()
            .find(|row| row[0] == "NNR-MORVEL56" && row[2] == code)
            .expect(code);
        assert_eq!(
            (latitude, longitude, degrees),
            (number(row[4]), number(row[5]), number(row[6]))
        );
    }
}

#[test]
fn one_finger_goes_its_way_and_keeps_the_former_spin() {
    let mut dice = Dice::new(3);
    for _ in 0..50 {
        let (p, former) = (dice.place(), dice.place() * 0.3);
        let velocity = (dice.place() * 0.02).cross(p);
        let found = rate(&[p], &[velocity], former);
        assert!((found.cross(p) - velocity).length() < 1e-15);
        assert!((found.dot(p) - former.dot(p)).abs() < 1e-14);
        let goal = (p + velocity * 10.0).normalize();
        let turn = rotation(&[p], &[goal], former);
        assert!((turn * p - goal).length() < 1e-13);
        let without = rotation(&[p], &[goal], DVec3::ZERO);
        let spin = DQuat::from_axis_angle(goal, former.dot(p));
        assert!(turn.angle_between(spin * without) < 1e-7);
        assert!((rotation_vector(without).dot(p)).abs() < 1e-7, "the shortest way");
    }
}

#[test]
fn close_fingers_do_not_spin_the_plate() {
    let middle = direction(20.0, 30.0);
    let side = middle.any_orthonormal_vector();
    let spin_of = |apart_deg: f64| {
        let half = DQuat::from_axis_angle(side, apart_deg.to_radians() / 2.0);
        let places = [half * middle, half.inverse() * middle];
        // Half a degree of noise across the line that joins them.
        let off = side * 0.5_f64.to_radians();
        let to: Vec<DVec3> = [places[0] + off, places[1] - off]
            .iter()
            .map(|p| p.normalize())
            .collect();
        let finite = rotation_vector(rotation(&places, &to, DVec3::ZERO))
            .dot(middle)
            .abs();
        let velocities = [off, -off];
        let instant = rate(&places, &velocities, DVec3::ZERO).dot(middle).abs();
        assert!((finite - instant).abs() < 0.1 * instant, "{finite} {instant}");
        instant.to_degrees()
    };
    // Unregularised the noise gain is 1/sin(half the distance): 57° at 1°.
    assert!(spin_of(1.0) < 0.6, "{}", spin_of(1.0));
    assert!(spin_of(4.0) < 2.5, "{}", spin_of(4.0));
    let apart = spin_of(20.0);
    assert!(
        (apart - 0.5 / 10_f64.to_radians().sin()).abs() < 0.1,
        "as it is: {apart}"
    );
}

#[test]
fn a_mirror_image_is_answered_with_a_rotation() {
    let before = [DVec3::X, DVec3::Y, DVec3::Z];
    let after = [DVec3::X, DVec3::Y, -DVec3::Z];
    let turn = rotation(&before, &after, DVec3::ZERO);
    assert!((DMat3::from_quat(turn).determinant() - 1.0).abs() < 1e-12);
    let misfit: f64 = before
        .iter()
        .zip(&after)
        .map(|(&p, &q)| (turn * p - q).length_squared())
        .sum();
    // The best of all rotations leaves 4 of it.
    assert!((misfit - 4.0).abs() < 1e-9, "{misfit}");
}

#[test]
fn nothing_to_fit_is_no_motion() {
    assert_eq!(rotation(&[], &[], DVec3::X), DQuat::IDENTITY);
    assert_eq!(rate(&[], &[], DVec3::X), DVec3::X);
    let opposite = [DVec3::X, -DVec3::X];
    assert!(rotation(&opposite, &opposite, DVec3::ZERO).is_finite());
    assert!(rate(&opposite, &[DVec3::ZERO; 2], DVec3::ZERO).is_finite());
}
