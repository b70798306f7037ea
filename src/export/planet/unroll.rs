//! From rings on the sphere to polygons of longitude and latitude (RFC 7946): cut at the antimeridian, and led around the
//! poles along the edge of the map.

use glam::DVec3;

use crate::export::geojson::rounded;
use crate::sphere::latitude_longitude;

/// Longitude and latitude, degrees.
pub(super) type Place = [f64; 2];
/// An outer ring (counter-clockwise) and its holes (clockwise); the first point is repeated at the end.
pub(super) type Polygon = Vec<Vec<Place>>;

/// Corners of the map with the way to them along its edge, counter-clockwise from the south-west, degrees.
const CORNERS: [(f64, Place); 4] = [
    (0.0, [-180.0, -90.0]),
    (360.0, [180.0, -90.0]),
    (540.0, [180.0, 90.0]),
    (900.0, [-180.0, 90.0]),
];
/// Length of the map's edge, degrees.
const EDGE: f64 = 1080.0;
/// Positions have so many steps in a degree.
const STEPS: f64 = 1e6;
/// Great circles are followed to so many degrees of longitude, which matters near the poles.
const STRIDE_DEG: f64 = 2.0;

/// The polygons of an area that lies to the left of `rings`. `at_edge` says whether the area holds the places on the
/// antimeridian, where no ring crosses it.
pub(super) fn polygons(rings: &[Vec<DVec3>], at_edge: bool) -> Vec<Polygon> {
    let mut closed: Vec<Vec<Place>> = Vec::new();
    let mut lines: Vec<Vec<Place>> = Vec::new();
    for ring in rings {
        unroll(ring, &mut closed, &mut lines);
    }
    if lines.is_empty() && at_edge {
        closed.push(CORNERS.map(|(_, corner)| corner).to_vec());
    }
    closed.extend(joined(&lines));
    nested(closed.into_iter().filter_map(finished).collect())
}

/// Puts a ring on the map: whole where it does not cross the antimeridian, else as lines from edge to edge.
fn unroll(ring: &[DVec3], closed: &mut Vec<Vec<Place>>, lines: &mut Vec<Vec<Place>>) {
    let mut pieces: Vec<Vec<Place>> = vec![Vec::new()];
    for (k, &from) in ring.iter().enumerate() {
        let to = ring[(k + 1) % ring.len()];
        let mut put = |place: Place| {
            if let Some(piece) = pieces.last_mut() {
                piece.push(place);
            }
        };
        put(place(from));
        let Some(crossing) = crossing(from, to) else {
            follow(place(from), from, to, place(to), put);
            continue;
        };
        let side = if is_east(from) { 180.0 } else { -180.0 };
        let latitude = latitude_longitude(crossing).0;
        follow(place(from), from, crossing, [side, latitude], &mut put);
        put([side, latitude]);
        pieces.push(vec![[-side, latitude]]);
        if let Some(piece) = pieces.last_mut() {
            follow([-side, latitude], crossing, to, place(to), |place| {
                piece.push(place);
            });
        }
    }
    if pieces.len() == 1 {
        closed.append(&mut pieces);
        return;
    }
    // The last piece goes on in the first.
    if let Some(mut last) = pieces.pop() {
        last.append(&mut pieces[0]);
        pieces[0] = last;
    }
    lines.append(&mut pieces);
}

/// Places between the two ends of an arc that sweeps over many degrees of longitude.
fn follow(start: Place, from: DVec3, to: DVec3, end: Place, mut put: impl FnMut(Place)) {
    let steps = ((end[0] - start[0]).abs() / STRIDE_DEG).ceil().min(180.0) as u32;
    for k in 1..steps {
        let part = f64::from(k) / f64::from(steps);
        let longitude = (start[0] + part * (end[0] - start[0])).to_radians();
        // Where the great circle meets the meridian; nearer to the arc's ends is the side of the pole that they are on.
        let pole = from.cross(to);
        let meridian = DVec3::new(-longitude.sin(), longitude.cos(), 0.0);
        let Some(met) = pole.cross(meridian).try_normalize() else {
            return;
        };
        let met = if met.dot(from + to) < 0.0 { -met } else { met };
        put([longitude.to_degrees(), latitude_longitude(met).0]);
    }
}

/// True east of the prime meridian, as far as the antimeridian.
fn is_east(p: DVec3) -> bool {
    p.y >= 0.0
}

fn place(p: DVec3) -> Place {
    // No negative zero, which would lie on the other side.
    let (latitude, longitude) = latitude_longitude(if p.y == 0.0 { DVec3::new(p.x, 0.0, p.z) } else { p });
    [longitude, latitude]
}

/// Where the arc between two places meets the antimeridian.
fn crossing(from: DVec3, to: DVec3) -> Option<DVec3> {
    if is_east(from) == is_east(to) {
        return None;
    }
    let met = from * to.y.abs() + to * from.y.abs();
    (met.x < 0.0).then(|| DVec3::new(met.x, 0.0, met.z).normalize())
}

/// Closes lines from edge to edge along the edge of the map, counter-clockwise: the area lies to the left of both.
fn joined(lines: &[Vec<Place>]) -> Vec<Vec<Place>> {
    let way = |&[longitude, latitude]: &Place| {
        if longitude > 0.0 {
            360.0 + latitude + 90.0
        } else {
            900.0 + 90.0 - latitude
        }
    };
    let starts: Vec<f64> = lines.iter().map(|line| line.first().map_or(0.0, way)).collect();
    let mut used = vec![false; lines.len()];
    let mut rings = Vec::new();
    for first in 0..lines.len() {
        let mut ring: Vec<Place> = Vec::new();
        let mut at = first;
        while !used[at] {
            used[at] = true;
            ring.extend(&lines[at]);
            let end = lines[at].last().map_or(0.0, way);
            let ahead = |to: f64| (to - end).rem_euclid(EDGE);
            let mut next = first;
            let mut nearest = f64::INFINITY;
            for (k, &start) in starts.iter().enumerate() {
                if ahead(start) < nearest && (!used[k] || k == first) {
                    (next, nearest) = (k, ahead(start));
                }
            }
            let mut passed: Vec<(f64, Place)> = CORNERS.map(|(to, corner)| (ahead(to), corner)).to_vec();
            passed.retain(|&(to, _)| to < nearest);
            passed.sort_by(|a, b| a.0.total_cmp(&b.0));
            ring.extend(passed.iter().map(|&(_, corner)| corner));
            at = next;
        }
        if !ring.is_empty() {
            rings.push(ring);
        }
    }
    rings
}

/// Rounded, without repeated places, closed; `None` where nothing is left.
fn finished(ring: Vec<Place>) -> Option<Vec<Place>> {
    let mut ring: Vec<Place> = ring
        .into_iter()
        .map(|place| place.map(|degrees| rounded(degrees, STEPS)))
        .collect();
    ring.dedup();
    while ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    if ring.len() < 3 || signed_area(&ring) == 0.0 {
        return None;
    }
    ring.push(ring[0]);
    Some(ring)
}

/// Square degrees on the map; positive when counter-clockwise.
fn signed_area(ring: &[Place]) -> f64 {
    let next = ring.iter().cycle().skip(1);
    ring.iter()
        .zip(next)
        .map(|(a, b)| (a[0] * b[1] - b[0] * a[1]) / 2.0)
        .sum()
}

/// Each hole into the smallest outer ring around it.
fn nested(rings: Vec<Vec<Place>>) -> Vec<Polygon> {
    let (outer, holes): (Vec<_>, Vec<_>) = rings.into_iter().partition(|ring| signed_area(ring) > 0.0);
    let mut polygons: Vec<Polygon> = outer.into_iter().map(|ring| vec![ring]).collect();
    for hole in holes {
        let around = polygons
            .iter_mut()
            .filter(|polygon| holds(&polygon[0], hole[0]))
            .min_by(|a, b| signed_area(&a[0]).total_cmp(&signed_area(&b[0])));
        if let Some(polygon) = around {
            polygon.push(hole);
        }
    }
    polygons
}

/// True for a place inside a ring, by the number of edges to its east.
fn holds(ring: &[Place], at: Place) -> bool {
    let crossed = ring.windows(2).filter(|edge| {
        let ([x0, y0], [x1, y1]) = (edge[0], edge[1]);
        (y0 > at[1]) != (y1 > at[1]) && x0 + (at[1] - y0) / (y1 - y0) * (x1 - x0) > at[0]
    });
    crossed.count() % 2 == 1
}
