//! Horizons: how high the land stands against the sky, seen from each pixel.
//!
//! One sweep along parallel lines finds, for every point, the steepest sight line to the points before it, in
//! amortised constant time, by keeping the upper convex hull of what was passed (Timonen & Westerholm 2010,
//! "Scalable height field self-shadowing").

use rayon::prelude::*;

use super::field::Field;

/// Tangent of the horizon's elevation towards `azimuth` (radians, clockwise from north), 0 where nothing stands
/// higher. Heights are in pixels.
pub(super) fn horizon(heights: &Field, azimuth: f64) -> Field {
    let (width, height) = (heights.width, heights.height);
    // Towards the horizon, in pixels: x east, y south.
    let towards = (azimuth.sin(), -azimuth.cos());
    let by_rows = towards.1.abs() >= towards.0.abs();
    // Lines cross the major axis one pixel a step and drift along the minor one.
    let (major, minor, step, drift) = if by_rows {
        (height, width, towards.1, towards.0)
    } else {
        (width, height, towards.0, towards.1)
    };
    let shear = (drift / step.abs()) as f32;
    let distance = f64::from(shear).hypot(1.0) as f32;
    // Steps go away from the horizon: k counts from its side.
    let along = |k: usize| if step < 0.0 { k } else { major - 1 - k };
    // A line through the minor coordinate m at step 0 is at m − shear·k at step k.
    let spread = (shear.abs() * (major - 1) as f32).ceil() as usize + 1;
    let offset = if shear < 0.0 { spread as f32 } else { 0.0 };
    let line_count = minor + spread + 1;
    let minor_at = |line: usize, k: usize| line as f32 - offset - shear * k as f32;

    let mut tangents = vec![0.0_f32; line_count * major];
    tangents
        .par_chunks_mut(major)
        .enumerate()
        .for_each_init(Vec::new, |hull, (line, out)| {
            hull.clear();
            for (k, tangent) in out.iter_mut().enumerate() {
                let across = minor_at(line, k);
                if across < -1.0 || across > minor as f32 {
                    continue;
                }
                let z = if by_rows {
                    heights.sample(across, along(k) as f32)
                } else {
                    heights.sample(along(k) as f32, across)
                };
                *tangent = sight(hull, k as f32 * distance, z);
            }
        });

    let mut data = vec![0.0; width * height];
    data.par_chunks_mut(width).enumerate().for_each(|(y, out)| {
        for (x, value) in out.iter_mut().enumerate() {
            let (m, a) = if by_rows { (x, y) } else { (y, x) };
            let k = along(a);
            let line = m as f32 + offset + shear * k as f32;
            let first = (line as usize).min(line_count - 2);
            let part = line - first as f32;
            let at = |line: usize| tangents[line * major + k];
            *value = at(first) + (at(first + 1) - at(first)) * part;
        }
    });
    Field { width, height, data }
}

/// Tangent from a new point up to the hull of those before it, and the point put on the hull.
fn sight(hull: &mut Vec<(f32, f32)>, at: f32, z: f32) -> f32 {
    let slope = |p: (f32, f32)| (p.1 - z) / (at - p.0);
    while let [.., before, top] = hull.as_slice() {
        if slope(*before) >= slope(*top) {
            hull.pop();
        } else {
            break;
        }
    }
    let tangent = hull.last().map_or(0.0, |&top| slope(top).max(0.0));
    hull.push((at, z));
    tangent
}

/// Part of the sky that is seen, 1 on open ground: 1 − mean sin(horizon) over `directions` azimuths (Zakšek,
/// Oštir & Kokalj 2011, Eq. 3).
pub(super) fn sky_view(heights: &Field, directions: usize) -> Field {
    let mut sum = vec![0.0_f32; heights.data.len()];
    for direction in 0..directions {
        let azimuth = std::f64::consts::TAU * (direction as f64 + 0.5) / directions as f64;
        let tangents = horizon(heights, azimuth);
        sum.par_iter_mut()
            .zip(&tangents.data)
            .for_each(|(sum, t)| *sum += t / (1.0 + t * t).sqrt());
    }
    let share = 1.0 / directions as f32;
    Field {
        width: heights.width,
        height: heights.height,
        data: sum.iter().map(|s| 1.0 - s * share).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(width: usize, height: usize, value: impl Fn(usize, usize) -> f32) -> Field {
        Field {
            width,
            height,
            data: (0..width * height).map(|i| value(i % width, i / width)).collect(),
        }
    }

    #[test]
    fn a_pillar_is_seen_from_behind_it_at_its_angle() {
        let pillar = field(41, 41, |x, y| if (x, y) == (20, 20) { 10.0 } else { 0.0 });
        // Straight and diagonal azimuths: the horizon lies towards the pillar.
        for (azimuth, from, metres) in [
            (0.0, (20, 30), 10.0_f32),
            (90.0, (12, 20), 8.0),
            (180.0, (20, 15), 5.0),
            (270.0, (30, 20), 10.0),
            (315.0, (30, 30), 200.0_f32.sqrt()),
            (45.0, (15, 25), 50.0_f32.sqrt()),
        ] {
            let tangents = horizon(&pillar, f64::to_radians(azimuth));
            let t = tangents.data[from.1 * 41 + from.0];
            assert!((t - 10.0 / metres).abs() < 0.02, "azimuth {azimuth}: {t}");
            let before = tangents.data[(40 - from.1) * 41 + 40 - from.0];
            assert_eq!(before, 0.0, "azimuth {azimuth}: nothing on the near side");
        }
    }

    #[test]
    fn sweep_agrees_with_looking_at_every_point() {
        // The hull must give the same as a direct search; rows of a west–east sweep are exact.
        let bumpy = field(64, 3, |x, y| ((x * 37 + y * 11) % 17) as f32);
        let tangents = horizon(&bumpy, f64::to_radians(270.0));
        for y in 0..3 {
            for x in 0..64 {
                let direct = (0..x)
                    .map(|i| (bumpy.data[y * 64 + i] - bumpy.data[y * 64 + x]) / (x - i) as f32)
                    .fold(0.0_f32, f32::max);
                assert!((tangents.data[y * 64 + x] - direct).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn open_ground_sees_all_of_the_sky_and_a_pit_little() {
        let flat = sky_view(&field(20, 20, |_, _| 3.0), 8);
        assert!(flat.data.iter().all(|&s| s == 1.0));
        let pit = sky_view(
            &field(21, 21, |x, y| {
                if x.abs_diff(10) + y.abs_diff(10) < 2 {
                    0.0
                } else {
                    20.0
                }
            }),
            8,
        );
        assert!(pit.data[10 * 21 + 10] < 0.2);
    }
}
