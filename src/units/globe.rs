//! How the globe lies on the table.

use glam::{DMat3, DQuat, DVec2, DVec3};

/// Diameter of the whole globe as a part of the table's short side.
const PART_OF_SHORT_SIDE: f64 = 0.92;

/// Least and greatest magnification that hands may choose; 1 shows the whole globe.
pub const ZOOM_LIMITS: (f64, f64) = (0.5, 8.0);

/// How the globe lies on the table: seen from infinitely far (orthographic), with north up, around the middle of the table.
///
/// Seen so, the globe is a disc at any magnification, a place under a finger has a closed form both ways, and a finger
/// that goes once its radius turns the middle of the globe by one radian. Anything that draws the globe uses this view,
/// so that hands touch what eyes see.
///
/// * **World frame**: unit vectors, `z` north pole, `x` where the prime meridian meets the equator.
/// * **View frame**: `x` right, `y` up, `z` towards the visitor; the disc is the unit disc.
/// * **Table frame**: millimetres, `x` right, `y` down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlobeView {
    size_mm: DVec2,
    longitude_deg: f64,
    latitude_deg: f64,
    zoom: f64,
}

impl GlobeView {
    /// The whole globe on a table of `size_mm`, seen from above the equator and the prime meridian.
    pub fn new(size_mm: DVec2) -> Self {
        Self {
            size_mm,
            longitude_deg: 0.0,
            latitude_deg: 0.0,
            zoom: 1.0,
        }
    }

    /// The same globe seen from above another place, degrees, and magnified otherwise. Longitudes are wrapped to −180 to
    /// 180, latitudes cut to ±90, magnifications cut to [`ZOOM_LIMITS`]; what is no number changes nothing.
    #[must_use]
    pub fn looking_at(self, longitude_deg: f64, latitude_deg: f64, zoom: f64) -> Self {
        if !(longitude_deg.is_finite() && latitude_deg.is_finite() && zoom.is_finite()) {
            return self;
        }
        let wrapped = if (-180.0..=180.0).contains(&longitude_deg) {
            longitude_deg
        } else {
            (longitude_deg + 180.0).rem_euclid(360.0) - 180.0
        };
        Self {
            longitude_deg: wrapped,
            latitude_deg: latitude_deg.clamp(-90.0, 90.0),
            zoom: zoom.clamp(ZOOM_LIMITS.0, ZOOM_LIMITS.1),
            ..self
        }
    }

    /// The table's size, mm.
    pub fn size_mm(&self) -> DVec2 {
        self.size_mm
    }

    /// Longitude of the middle of the disc, degrees, −180 to 180.
    pub fn longitude_deg(&self) -> f64 {
        self.longitude_deg
    }

    /// Latitude of the middle of the disc, degrees, −90 to 90.
    pub fn latitude_deg(&self) -> f64 {
        self.latitude_deg
    }

    /// Magnification, in [`ZOOM_LIMITS`].
    pub fn zoom(&self) -> f64 {
        self.zoom
    }

    /// Middle of the disc, table mm.
    pub fn centre_mm(&self) -> DVec2 {
        self.size_mm / 2.0
    }

    /// Radius of the disc, table mm.
    pub fn radius_mm(&self) -> f64 {
        self.zoom * PART_OF_SHORT_SIDE / 2.0 * self.size_mm.min_element()
    }

    /// The rotation from the world's frame to the view's.
    pub fn orientation(&self) -> DQuat {
        DQuat::from_mat3(&self.axes().transpose()).normalize()
    }

    /// True where the table shows the globe.
    pub fn contains(&self, mm: DVec2) -> bool {
        self.on_disc(mm).length_squared() <= 1.0
    }

    /// The place under a point of the table, in the world's frame. `None` beside the globe.
    pub fn cast(&self, mm: DVec2) -> Option<DVec3> {
        self.contains(mm).then(|| self.cast_nearest(mm))
    }

    /// As [`Self::cast`]; beside the globe, the place of its rim that is nearest.
    pub fn cast_nearest(&self, mm: DVec2) -> DVec3 {
        self.axes() * on_sphere(self.on_disc(mm))
    }

    /// Where the table shows a place (a unit vector in the world's frame). `None` on the far side.
    pub fn project(&self, place: DVec3) -> Option<DVec2> {
        let seen = self.axes().transpose() * place;
        let mm = self.centre_mm() + DVec2::new(seen.x, -seen.y) * self.radius_mm();
        (seen.z >= 0.0).then_some(mm)
    }

    /// The view after a drag between two points of the table. On the globe the place under the finger follows it as
    /// long as north can stay up; beside it, the middle of the globe goes as far as the finger.
    #[must_use]
    pub fn dragged(self, from_mm: DVec2, to_mm: DVec2) -> Self {
        match self.cast(from_mm) {
            Some(place) if self.contains(to_mm) => self.carried(place, to_mm),
            _ => {
                let turn = (to_mm - from_mm) * (1.0 / self.radius_mm()).to_degrees();
                self.looking_at(self.longitude_deg - turn.x, self.latitude_deg + turn.y, self.zoom)
            }
        }
    }

    /// The view after two fingers have changed their distance by a factor.
    #[must_use]
    pub fn pinched(self, factor: f64) -> Self {
        self.looking_at(self.longitude_deg, self.latitude_deg, self.zoom * factor)
    }

    /// The view with `place` at a point of the disc. Two latitudes bring it to the right height; the nearer one is taken.
    fn carried(self, place: DVec3, to_mm: DVec2) -> Self {
        let v = on_sphere(self.on_disc(to_mm));
        // Height of the place over the equator: v.y cos φ + v.z sin φ = A cos(φ − δ).
        let (amplitude, delta) = (v.y.hypot(v.z), v.z.atan2(v.y));
        let swing = (place.z / amplitude.max(f64::MIN_POSITIVE))
            .clamp(-1.0, 1.0)
            .acos();
        let now = self.latitude_deg.to_radians();
        let (low, high) = (delta - swing, delta + swing);
        let latitude = if (low - now).abs() <= (high - now).abs() {
            low
        } else {
            high
        };
        let latitude_deg = latitude.to_degrees().clamp(-90.0, 90.0);
        let (sin, cos) = latitude_deg.to_radians().sin_cos();
        // Seen from longitude 0 the point would be over this meridian.
        let meridian = v.x.atan2(v.z * cos - v.y * sin);
        let longitude = place.y.atan2(place.x) - meridian;
        self.looking_at(longitude.to_degrees(), latitude_deg, self.zoom)
    }

    /// The view's axes in the world's frame: east, north, and towards the visitor.
    fn axes(&self) -> DMat3 {
        let (sin_lon, cos_lon) = self.longitude_deg.to_radians().sin_cos();
        let (sin_lat, cos_lat) = self.latitude_deg.to_radians().sin_cos();
        DMat3::from_cols(
            DVec3::new(-sin_lon, cos_lon, 0.0),
            DVec3::new(-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat),
            DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat),
        )
    }

    /// A point of the table in the view's frame, radii from the middle.
    fn on_disc(&self, mm: DVec2) -> DVec2 {
        let out = (mm - self.centre_mm()) / self.radius_mm();
        DVec2::new(out.x, -out.y)
    }
}

/// The point of the near half of the unit sphere over a point of the disc; outside, of the rim.
fn on_sphere(disc: DVec2) -> DVec3 {
    let squared = disc.length_squared();
    if squared <= 1.0 {
        disc.extend((1.0 - squared).sqrt()).normalize()
    } else {
        disc.normalize().extend(0.0)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const TABLE: DVec2 = DVec2::new(1209.6, 680.4);

    fn views() -> impl Strategy<Value = GlobeView> {
        (-180.0..180.0, -90.0..=90.0, 0.1..20.0)
            .prop_map(|(lon, lat, zoom)| GlobeView::new(TABLE).looking_at(lon, lat, zoom))
    }

    fn on_globe() -> impl Strategy<Value = DVec2> {
        (0.0..0.97_f64, 0.0..std::f64::consts::TAU).prop_map(|(r, angle)| DVec2::from_angle(angle) * r.sqrt())
    }

    proptest! {
        #[test]
        fn cast_and_project_are_inverse(view in views(), at in on_globe()) {
            let mm = view.centre_mm() + at * view.radius_mm();
            let place = view.cast(mm).expect("on the globe");
            prop_assert!((place.length() - 1.0).abs() < 1e-14);
            let back = view.project(place).expect("on the near side");
            prop_assert!(back.distance(mm) < 1e-9);
            prop_assert_eq!(view.project(-place), None);
        }

        #[test]
        fn beside_the_globe_is_nothing_but_its_rim(view in views(), angle in 0.0..6.3, out in 1.001..4.0) {
            let mm = view.centre_mm() + DVec2::from_angle(angle) * (out * view.radius_mm());
            prop_assert_eq!(view.cast(mm), None);
            let rim = view.orientation() * view.cast_nearest(mm);
            prop_assert!(rim.z.abs() < 1e-12);
        }

        #[test]
        fn the_place_under_a_finger_follows_it_while_north_stays_up(
            view in views(),
            from in on_globe(),
            way in on_globe(),
        ) {
            let from_mm = view.centre_mm() + from * view.radius_mm();
            let to_mm = from_mm + way * (0.02 * view.radius_mm());
            let place = view.cast(from_mm).expect("on the globe");
            let turned = view.dragged(from_mm, to_mm);
            prop_assert_eq!(turned.zoom(), view.zoom());
            let north = turned.orientation() * DVec3::Z;
            prop_assert!(north.x.abs() < 1e-12 && north.y >= -1e-12, "north is up: {}", north);
            // Near a pole, and where a place would have to leave its circle of latitude, the finger goes on alone.
            let clear = turned.latitude_deg().abs() < 90.0 && place.z.abs() < 0.9 && view.latitude_deg().abs() < 60.0;
            if clear && from.length() < 0.4 {
                let seen = turned.project(place).expect("still near");
                prop_assert!(seen.distance(to_mm) < 1e-6, "{} {}", seen, to_mm);
            }
        }

        #[test]
        fn whatever_is_asked_the_view_stays_within_its_limits(
            lon in prop::num::f64::ANY, lat in prop::num::f64::ANY, zoom in prop::num::f64::ANY,
        ) {
            let view = GlobeView::new(TABLE).looking_at(lon, lat, zoom);
            prop_assert!((-180.0..=180.0).contains(&view.longitude_deg()));
            prop_assert!((-90.0..=90.0).contains(&view.latitude_deg()));
            prop_assert!((ZOOM_LIMITS.0..=ZOOM_LIMITS.1).contains(&view.zoom()));
        }
    }

    #[test]
    fn the_middle_is_where_one_looks_at_and_east_is_right() {
        let view = GlobeView::new(TABLE).looking_at(90.0, 0.0, 1.0);
        assert!(view.cast(TABLE / 2.0).expect("the middle").distance(DVec3::Y) < 1e-12);
        let right = TABLE / 2.0 + DVec2::new(view.radius_mm(), 0.0);
        assert!(view.cast_nearest(right).distance(-DVec3::X) < 1e-6);
        let up = view
            .cast(TABLE / 2.0 - DVec2::new(0.0, 100.0))
            .expect("on the globe");
        assert!(up.z > 0.0);
        assert!((view.orientation() * DVec3::Y).distance(DVec3::Z) < 1e-12);
    }

    #[test]
    fn a_drag_beside_the_globe_turns_its_middle_as_far() {
        let view = GlobeView::new(TABLE);
        let beside = DVec2::new(20.0, 20.0);
        let turned = view.dragged(beside, beside + DVec2::new(view.radius_mm() / 2.0, 0.0));
        assert!((turned.longitude_deg() + 0.5_f64.to_degrees()).abs() < 1e-9);
        let down = view.dragged(beside, beside + DVec2::new(0.0, 50.0));
        assert!(down.latitude_deg() > 0.0, "what is above comes down");
        assert!((view.pinched(2.0).radius_mm() / view.radius_mm() - 2.0).abs() < 1e-12);
    }
}
