//! The eye: the plan as the table shows it, the land seen aslant, and the way from one to the other.

use glam::{DMat4, DVec2, DVec3, DVec4};

use crate::units::{Extent, KM};

/// From so many land diagonals away there is no perspective left to be seen (a summit of 3 km in a corner of a land
/// 200 km wide moves by a fifth of a pixel), and single precision is better off without it.
const FARTHEST_DIAGONALS: f64 = 50.0;
/// Half of the height range that must lie between the near and the far plane, metres; no land is higher or deeper.
const HALF_HEIGHT: f64 = 30.0 * KM;

/// Where an eye that sees the land aslant is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oblique {
    /// What it looks at, plan metres.
    pub focus: DVec2,
    /// Height of that place, metres, as drawn.
    pub focus_height: f64,
    /// Direction in which it looks, radians clockwise from north.
    pub azimuth: f64,
    /// Angle at which it looks down, radians; a right angle looks straight down.
    pub depression: f64,
    /// Distance from the focus, metres.
    pub distance: f64,
    /// Vertical angle of view, radians.
    pub field_of_view: f64,
}

/// An eye and the picture it sees. Pixels count from the top-left corner of the viewport.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    viewport_px: DVec2,
    /// Unit vectors: to the right, up, and into the picture.
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    target: DVec3,
    /// `None`: all rays are parallel.
    distance: Option<f64>,
    /// Metres that the viewport's height spans at the target.
    span: f64,
    /// Radius about the target that holds the whole land, metres.
    reach: f64,
    /// 0 in plan, 1 in oblique view.
    tilt: f64,
}

impl Camera {
    /// The plan: north up, undistorted, as large as the viewport allows, centred.
    pub fn plan(extent: Extent, viewport_px: DVec2) -> Self {
        let middle = extent.size() / 2.0;
        let straight_down = Oblique {
            focus: middle,
            focus_height: 0.0,
            azimuth: 0.0,
            depression: std::f64::consts::FRAC_PI_2,
            distance: extent.size().length(),
            field_of_view: 1.0,
        };
        Self::between(extent, viewport_px, &straight_down, 0.0)
    }

    /// The eye at `t` of its way from the plan (0) to `oblique` (1). It comes down from infinity, so that the first
    /// moment of the way is the plan and nothing jumps. `t` outside 0–1 is brought inside.
    pub fn between(extent: Extent, viewport_px: DVec2, oblique: &Oblique, t: f64) -> Self {
        let viewport_px = viewport_px.max(DVec2::ONE);
        let t = if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.0 };
        let mix = |a: f64, b: f64| a + (b - a) * t;
        let middle = extent.size() / 2.0;
        let plan_span = plan_scale(extent, viewport_px) * viewport_px.y;
        let near_span = 2.0 * oblique.distance * (oblique.field_of_view / 2.0).tan();
        let (azimuth, depression) = (
            mix(0.0, turned(oblique.azimuth)),
            mix(std::f64::consts::FRAC_PI_2, oblique.depression),
        );
        let ahead = DVec3::new(azimuth.sin(), azimuth.cos(), 0.0);
        let forward = ahead * depression.cos() - DVec3::Z * depression.sin();
        let up = ahead * depression.sin() + DVec3::Z * depression.cos();
        let reach = extent.size().length() + HALF_HEIGHT;
        let distance = oblique.distance.max(1.0) / t.max(f64::MIN_POSITIVE);
        Self {
            viewport_px,
            right: forward.cross(up),
            up,
            forward,
            target: middle
                .lerp(oblique.focus, t)
                .extend(mix(0.0, oblique.focus_height)),
            distance: (distance < FARTHEST_DIAGONALS * extent.size().length()).then_some(distance),
            // Spans differ by factors: their logarithms are what the eye takes as an even change.
            span: mix(plan_span.ln(), near_span.max(1.0).ln()).exp(),
            reach,
            tilt: t,
        }
    }

    /// How far it is from the plan, 0–1.
    pub fn tilt(&self) -> f64 {
        self.tilt
    }

    /// Size of the picture, pixels.
    pub fn viewport_px(&self) -> DVec2 {
        self.viewport_px
    }

    /// Where the eye is, plan metres and height; in plan, far above.
    pub fn eye(&self) -> DVec3 {
        self.target - self.forward * self.distance.unwrap_or(FARTHEST_DIAGONALS * self.reach)
    }

    /// What it looks at, plan metres and height.
    pub fn target(&self) -> DVec3 {
        self.target
    }

    /// Unit vectors to the right, up, and into the picture.
    pub fn axes(&self) -> [DVec3; 3] {
        [self.right, self.up, self.forward]
    }

    /// Tangents of half the angles of view, across and up; 0 where all rays are parallel.
    pub fn half_view(&self) -> (f64, f64) {
        let half = self.distance.map_or(0.0, |distance| self.span / 2.0 / distance);
        (half * self.aspect(), half)
    }

    /// Metres of ground per pixel at the place it looks at.
    pub fn metres_per_pixel(&self) -> f64 {
        self.span / self.viewport_px.y
    }

    /// From plan metres and height to clip space (x right, y up, depth 0 near to 1 far).
    pub fn view_proj(&self) -> DMat4 {
        let rotation = DMat4::from_cols(
            DVec4::new(self.right.x, self.up.x, self.forward.x, 0.0),
            DVec4::new(self.right.y, self.up.y, self.forward.y, 0.0),
            DVec4::new(self.right.z, self.up.z, self.forward.z, 0.0),
            DVec4::W,
        );
        let view = rotation * DMat4::from_translation(-self.target);
        let (half_height, half_width) = (self.span / 2.0, self.span / 2.0 * self.aspect());
        // The view's depth is counted from the target; near and far planes hold the whole land.
        let project = match self.distance {
            None => DMat4::from_cols(
                DVec4::X / half_width,
                DVec4::Y / half_height,
                DVec4::Z / (2.0 * self.reach),
                DVec4::new(0.0, 0.0, 0.5, 1.0),
            ),
            Some(distance) => {
                let (near, far) = (
                    (distance - self.reach).max(distance * 0.02),
                    distance + self.reach,
                );
                let depth = far / (far - near);
                DMat4::from_cols(
                    DVec4::X * distance / half_width,
                    DVec4::Y * distance / half_height,
                    DVec4::new(0.0, 0.0, depth, 1.0),
                    DVec4::new(0.0, 0.0, (distance - near) * depth, distance),
                )
            }
        };
        project * view
    }

    /// The pixel on which a place (plan metres, height) lies; `None` behind the eye.
    pub fn project(&self, place: DVec3) -> Option<DVec2> {
        let clip = self.view_proj() * place.extend(1.0);
        if clip.w <= 0.0 || !clip.is_finite() {
            return None;
        }
        let ndc = DVec2::new(clip.x, clip.y) / clip.w;
        Some(DVec2::new(ndc.x + 1.0, 1.0 - ndc.y) / 2.0 * self.viewport_px)
    }

    /// The place at sea level (plan metres) that lies under a pixel; `None` above the horizon.
    pub fn unproject(&self, px: DVec2) -> Option<DVec2> {
        let (origin, direction) = self.ray(px);
        if direction.z >= -1e-9 {
            return None;
        }
        let hit = origin - direction * (origin.z / direction.z);
        hit.is_finite().then_some(hit.truncate())
    }

    /// The ray through a pixel: a place on it and its direction, of unit length.
    pub fn ray(&self, px: DVec2) -> (DVec3, DVec3) {
        let ndc = DVec2::new(
            px.x / self.viewport_px.x * 2.0 - 1.0,
            1.0 - px.y / self.viewport_px.y * 2.0,
        );
        let across =
            self.right * (ndc.x * self.span / 2.0 * self.aspect()) + self.up * (ndc.y * self.span / 2.0);
        match self.distance {
            None => (self.target + across, self.forward),
            Some(distance) => (
                self.target - self.forward * distance,
                (self.forward * distance + across).normalize(),
            ),
        }
    }

    fn aspect(&self) -> f64 {
        self.viewport_px.x / self.viewport_px.y
    }
}

/// The rectangle of the viewport (top-left corner and size, pixels) that the land fills in plan.
pub fn plan_rect(extent: Extent, viewport_px: DVec2) -> (DVec2, DVec2) {
    let size = extent.size() / plan_scale(extent, viewport_px);
    ((viewport_px - size) / 2.0, size)
}

/// Metres per pixel of the plan.
fn plan_scale(extent: Extent, viewport_px: DVec2) -> f64 {
    (extent.size() / viewport_px.max(DVec2::ONE)).max_element()
}

/// The same direction between half a turn to the left and half a turn to the right, so that an eye never goes the
/// long way round.
pub(super) fn turned(azimuth: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    (azimuth + PI).rem_euclid(TAU) - PI
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAND: Extent = Extent {
        width: 178.0 * KM,
        height: 100.0 * KM,
    };
    const WINDOW: DVec2 = DVec2::new(1280.0, 720.0);

    fn aslant() -> Oblique {
        Oblique {
            focus: DVec2::new(80.0 * KM, 55.0 * KM),
            focus_height: 1.5 * KM,
            azimuth: 0.7,
            depression: 0.5,
            distance: 140.0 * KM,
            field_of_view: 0.6,
        }
    }

    #[test]
    fn the_plan_fills_the_window_with_north_up() {
        let camera = Camera::plan(LAND, WINDOW);
        let (corner, size) = plan_rect(LAND, WINDOW);
        for height in [-KM, 0.0, 4.0 * KM] {
            let north_west = camera
                .project(DVec3::new(0.0, LAND.height, height))
                .expect("seen");
            let south_east = camera.project(DVec3::new(LAND.width, 0.0, height)).expect("seen");
            assert!(north_west.distance(corner) < 1e-6, "{north_west}");
            assert!(south_east.distance(corner + size) < 1e-6, "{south_east}");
        }
        assert!((size.x - WINDOW.x).abs() < 1e-9 || (size.y - WINDOW.y).abs() < 1e-9);
        let other = DVec2::new(700.0, 900.0);
        let (_, size) = plan_rect(LAND, other);
        assert!((size.x / size.y - 1.78).abs() < 1e-9, "undistorted");
    }

    #[test]
    fn a_pixel_leads_back_to_its_place() {
        for t in [0.0, 0.01, 0.3, 1.0] {
            let camera = Camera::between(LAND, WINDOW, &aslant(), t);
            for place in [
                DVec2::new(60.0, 40.0),
                DVec2::new(90.0, 60.0),
                DVec2::new(120.0, 50.0),
            ] {
                let place = place * KM;
                let px = camera.project(place.extend(0.0)).expect("in front");
                let back = camera.unproject(px).expect("ground");
                assert!(back.distance(place) < 1e-3, "t {t}: {back} for {place}");
            }
        }
    }

    #[test]
    fn the_way_down_begins_at_the_plan_and_never_jumps() {
        let places: Vec<DVec3> = [
            (0.0, 0.0),
            (178.0, 0.0),
            (178.0, 100.0),
            (0.0, 100.0),
            (89.0, 50.0),
        ]
        .map(|(x, y)| DVec3::new(x * KM, y * KM, 3.0 * KM))
        .to_vec();
        let steps = 4000;
        let mut before = Camera::plan(LAND, WINDOW);
        for step in 0..=steps {
            let t = f64::from(step) / f64::from(steps);
            let camera = Camera::between(LAND, WINDOW, &aslant(), t);
            for &place in &places {
                // What is not in the picture need not be calm.
                let (Some(a), Some(b)) = (before.project(place), camera.project(place)) else {
                    continue;
                };
                let seen = a.cmpge(DVec2::ZERO).all() && a.cmple(WINDOW).all();
                assert!(!seen || a.distance(b) < 4.0, "t {t}: {a} → {b}");
            }
            before = camera;
        }
    }

    #[test]
    fn depth_grows_away_from_the_eye_and_stays_in_range() {
        for t in [0.0, 0.2, 1.0] {
            let camera = Camera::between(LAND, WINDOW, &aslant(), t);
            let depth = |place: DVec3| {
                let clip = camera.view_proj() * place.extend(1.0);
                clip.z / clip.w
            };
            let (high, low) = (DVec3::new(80e3, 55e3, 4e3), DVec3::new(80e3, 55e3, 0.0));
            assert!(depth(high) < depth(low));
            for place in [high, low, DVec3::new(178e3, 100e3, -2e3)] {
                assert!((0.0..=1.0).contains(&depth(place)), "t {t} {place}");
            }
        }
    }

    #[test]
    fn above_the_horizon_there_is_no_ground() {
        let camera = Camera::between(
            LAND,
            WINDOW,
            &Oblique {
                depression: 0.1,
                ..aslant()
            },
            1.0,
        );
        assert_eq!(camera.unproject(DVec2::new(640.0, 0.0)), None);
        assert!(camera.unproject(DVec2::new(640.0, 700.0)).is_some());
    }
}
