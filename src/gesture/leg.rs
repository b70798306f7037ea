//! The arrows of a hand: one stretch of its motion, its turning point, and how it falls apart.

use glam::DVec2;

use super::params::GestureParams;
use super::rigid::RigidFit;
use super::stroke::StrokeId;

/// One finger of a hand: the arrow from where it started to where it is. Table millimetres.
#[derive(Clone, Debug)]
pub(super) struct Arrow {
    /// The finger, while it is down; a lifted one is carried on by the others.
    pub(super) stroke: Option<StrokeId>,
    /// Where it landed.
    pub(super) landed: DVec2,
    /// Where it was when the leg began.
    pub(super) start: DVec2,
    /// Where it is.
    pub(super) now: DVec2,
    /// Where it was at the leg's farthest point.
    pub(super) far: DVec2,
    /// Where it was when the hand last won or lost a finger.
    anchor: DVec2,
}

impl Arrow {
    pub(super) fn new(stroke: StrokeId, landed: DVec2) -> Self {
        Self {
            stroke: Some(stroke),
            landed,
            start: landed,
            now: landed,
            far: landed,
            anchor: landed,
        }
    }

    fn is_down(&self) -> bool {
        self.stroke.is_some()
    }
}

/// The best rigid motion from the starts to where the arrows are.
pub(super) fn fit(arrows: &[Arrow]) -> RigidFit {
    let (from, to): (Vec<_>, Vec<_>) = arrows.iter().map(|a| (a.start, a.now)).unzip();
    RigidFit::fit(&from, &to)
}

/// The best rigid motion from the starts to the farthest point.
pub(super) fn far_fit(arrows: &[Arrow]) -> RigidFit {
    let (from, to): (Vec<_>, Vec<_>) = arrows.iter().map(|a| (a.start, a.far)).unzip();
    RigidFit::fit(&from, &to)
}

/// Motion of the fingers that are down: root mean square and maximum of the arrows' lengths, mm.
pub(super) fn motion(arrows: &[Arrow]) -> (f64, f64) {
    let (mut sum, mut max, mut count) = (0.0, 0.0_f64, 0.0);
    for arrow in arrows.iter().filter(|a| a.is_down()) {
        let squared = arrow.now.distance_squared(arrow.start);
        sum += squared;
        max = max.max(squared);
        count += 1.0;
    }
    if count == 0.0 {
        (0.0, 0.0)
    } else {
        ((sum / count).sqrt(), max.sqrt())
    }
}

/// Part of the motion of the fingers that are down that their rigid fit leaves unexplained, 0 to 1, as a ratio of
/// lengths: residual / √Σ|motion|².
pub(super) fn unexplained(arrows: &[Arrow]) -> f64 {
    let down: Vec<&Arrow> = arrows.iter().filter(|a| a.is_down()).collect();
    unexplained_of(&down)
}

fn unexplained_of(arrows: &[&Arrow]) -> f64 {
    let moved: f64 = arrows.iter().map(|a| a.now.distance_squared(a.start)).sum();
    if arrows.len() < 2 || moved == 0.0 {
        return 0.0;
    }
    let (from, to): (Vec<_>, Vec<_>) = arrows.iter().map(|a| (a.start, a.now)).unzip();
    RigidFit::fit(&from, &to).residual / moved.sqrt()
}

/// Moves the lifted arrows along with the fingers that are down.
pub(super) fn carry(arrows: &mut [Arrow]) {
    if arrows.iter().all(Arrow::is_down) {
        return;
    }
    let down = arrows.iter().filter(|a| a.is_down());
    let (from, to): (Vec<_>, Vec<_>) = down.map(|a| (a.anchor, a.now)).unzip();
    let motion = RigidFit::fit(&from, &to).motion;
    for arrow in arrows.iter_mut().filter(|a| !a.is_down()) {
        arrow.now = motion.apply(arrow.anchor);
    }
}

/// The hand won or lost a finger: what is carried is carried from here.
pub(super) fn anchor(arrows: &mut [Arrow]) {
    for arrow in arrows {
        arrow.anchor = arrow.now;
    }
}

/// Follows the leg's farthest point; true once the hand has turned back from it: the retreat along the leg exceeds
/// [`GestureParams::reversal_mm`] and [`GestureParams::reversal_fraction`] of the leg's length.
///
/// Lengths are root mean squares over all arrows, and the retreat is the part of the way back that lies along the
/// leg in the space of all arrows, so that turning on the spot and back counts like going and coming.
pub(super) fn turned_back(arrows: &mut [Arrow], params: &GestureParams) -> bool {
    let count = arrows.len() as f64;
    let (mut length, mut farthest, mut back) = (0.0, 0.0, 0.0);
    for arrow in &*arrows {
        length += arrow.now.distance_squared(arrow.start);
        farthest += arrow.far.distance_squared(arrow.start);
        back += (arrow.far - arrow.now).dot(arrow.far - arrow.start);
    }
    if length >= farthest {
        for arrow in arrows {
            arrow.far = arrow.now;
        }
        return false;
    }
    let farthest = (farthest / count).sqrt();
    let retreat = back / (count * farthest);
    retreat > params.reversal_mm.max(params.reversal_fraction * farthest)
}

/// The next leg: the fingers that are down go on from the farthest point of the last.
pub(super) fn next_leg(arrows: &mut Vec<Arrow>) {
    arrows.retain(Arrow::is_down);
    for arrow in arrows {
        arrow.start = arrow.far;
        arrow.far = arrow.now;
        arrow.anchor = arrow.now;
    }
}

/// Fingers that are down and move together: merges the pair of clusters whose common fit is best, as long as it
/// leaves at most `fraction` of their motion unexplained. Two fingers that do not move together are alone. Clusters
/// are lists of indices into `arrows`, each in order, and in the order of their first fingers.
pub(super) fn clusters(arrows: &[Arrow], fraction: f64) -> Vec<Vec<usize>> {
    let down = arrows.iter().enumerate().filter(|(_, a)| a.is_down());
    let mut clusters: Vec<Vec<usize>> = down.map(|(i, _)| vec![i]).collect();
    loop {
        let mut best: Option<(f64, usize, usize)> = None;
        for i in 0..clusters.len() {
            for j in i + 1..clusters.len() {
                let both: Vec<&Arrow> = clusters[i]
                    .iter()
                    .chain(&clusters[j])
                    .map(|&k| &arrows[k])
                    .collect();
                let left = unexplained_of(&both);
                if left <= fraction && best.is_none_or(|(least, ..)| left < least) {
                    best = Some((left, i, j));
                }
            }
        }
        let Some((_, i, j)) = best else { return clusters };
        let merged = clusters.remove(j);
        clusters[i].extend(merged);
        clusters[i].sort_unstable();
    }
}
