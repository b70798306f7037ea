//! Which landing fingers make a hand, and which hand a later finger joins.

use glam::DVec2;

use super::event::HandId;
use super::params::{GestureParams, MAX_FINGERS};

/// A hand that is down, as landing fingers see it.
pub(super) struct Standing {
    pub(super) hand: HandId,
    /// Where its fingers are and where they landed.
    pub(super) fingers: Vec<(DVec2, DVec2)>,
    /// True as long as its first finger landed within the joining time.
    pub(super) fresh: bool,
}

/// Fingers that land as one.
#[derive(Debug, PartialEq)]
pub(super) struct Group {
    /// The hand they join, if it is down already.
    pub(super) hand: Option<HandId>,
    /// Which of the landing fingers.
    pub(super) landings: Vec<usize>,
}

#[derive(Clone)]
struct Cluster {
    hand: Option<HandId>,
    landings: Vec<usize>,
    fingers: usize,
    min: DVec2,
    max: DVec2,
    /// Some finger landed in the outer band of the upper and of the lower half.
    outer: (bool, bool),
}

/// Groups fingers that land at one moment, with each other and with hands that are down.
///
/// Single-linkage clustering, nearest pairs first, as long as the hand stays in its box, has at most five fingers,
/// and none of its fingers landed opposite another (see [`GestureParams::facing_gap_mm`]; on a table narrower than
/// two hand boxes nobody faces another). Two hands that are down never merge. O(n² log n) in the fingers.
pub(super) fn group(
    params: &GestureParams,
    size_mm: DVec2,
    landings: &[DVec2],
    standing: &[Standing],
) -> Vec<Group> {
    let outer = |landed: DVec2| outer_band(params, size_mm, landed);
    let mut clusters: Vec<Cluster> = landings
        .iter()
        .enumerate()
        .map(|(i, &at)| Cluster {
            hand: None,
            landings: vec![i],
            fingers: 1,
            min: at,
            max: at,
            outer: outer(at),
        })
        .collect();
    clusters.extend(standing.iter().map(|hand| Cluster::standing(hand, &outer)));
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (i, &at) in landings.iter().enumerate() {
        let earlier = landings[..i].iter().enumerate();
        pairs.extend(earlier.map(|(j, &other)| (at.distance_squared(other), i, j)));
        for (h, hand) in standing.iter().enumerate() {
            let nearest = hand
                .fingers
                .iter()
                .map(|(now, _)| at.distance_squared(*now))
                .fold(f64::INFINITY, f64::min);
            if hand.fresh || nearest <= params.late_reach_mm * params.late_reach_mm {
                pairs.push((nearest, i, landings.len() + h));
            }
        }
    }
    pairs.retain(|pair| pair.0 <= 2.0 * params.hand_box_mm * params.hand_box_mm);
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut owner: Vec<usize> = (0..clusters.len()).collect();
    for (_, i, j) in pairs {
        let (a, b) = (owner[i], owner[j]);
        if a == b {
            continue;
        }
        if let Some(merged) = clusters[a].merged(&clusters[b], params.hand_box_mm) {
            clusters[a] = merged;
            for o in owner.iter_mut().filter(|o| **o == b) {
                *o = a;
            }
        }
    }
    let first_of = |i: usize| (0..i).all(|j| owner[j] != owner[i]);
    let mut groups = Vec::new();
    for i in (0..landings.len()).filter(|&i| first_of(i)) {
        let cluster = &clusters[owner[i]];
        let mut landings = cluster.landings.clone();
        landings.sort_unstable();
        groups.push(Group {
            hand: cluster.hand,
            landings,
        });
    }
    groups
}

/// Whether a finger landed clearly on the upper, or clearly on the lower half of the table.
fn outer_band(params: &GestureParams, size_mm: DVec2, landed: DVec2) -> (bool, bool) {
    // The short direction is the one that visitors face each other across.
    let (across, width) = if size_mm.y <= size_mm.x {
        (landed.y, size_mm.y)
    } else {
        (landed.x, size_mm.x)
    };
    if width < 2.0 * params.hand_box_mm {
        return (false, false);
    }
    let (middle, half_gap) = (width / 2.0, params.facing_gap_mm / 2.0);
    (across <= middle - half_gap, across >= middle + half_gap)
}

impl Cluster {
    fn standing(hand: &Standing, outer: &impl Fn(DVec2) -> (bool, bool)) -> Self {
        let mut cluster = Self {
            hand: Some(hand.hand),
            landings: Vec::new(),
            fingers: hand.fingers.len(),
            min: DVec2::INFINITY,
            max: DVec2::NEG_INFINITY,
            outer: (false, false),
        };
        for &(now, landed) in &hand.fingers {
            cluster.min = cluster.min.min(now);
            cluster.max = cluster.max.max(now);
            let (upper, lower) = outer(landed);
            cluster.outer = (cluster.outer.0 || upper, cluster.outer.1 || lower);
        }
        cluster
    }

    /// Both as one hand, if they can be one.
    fn merged(&self, other: &Self, hand_box_mm: f64) -> Option<Self> {
        let (min, max) = (self.min.min(other.min), self.max.max(other.max));
        let facing = (self.outer.0 && other.outer.1) || (self.outer.1 && other.outer.0);
        let fits = (max - min).max_element() <= hand_box_mm && self.fingers + other.fingers <= MAX_FINGERS;
        if facing || !fits || (self.hand.is_some() && other.hand.is_some()) {
            return None;
        }
        Some(Self {
            hand: self.hand.or(other.hand),
            landings: [self.landings.as_slice(), &other.landings].concat(),
            fingers: self.fingers + other.fingers,
            min,
            max,
            outer: (self.outer.0 || other.outer.0, self.outer.1 || other.outer.1),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: DVec2 = DVec2::new(1200.0, 680.0);

    fn groups(landings: &[(f64, f64)], standing: &[Standing]) -> Vec<(Option<u32>, Vec<usize>)> {
        let landings: Vec<DVec2> = landings.iter().map(|&p| DVec2::from(p)).collect();
        group(&GestureParams::default(), TABLE, &landings, standing)
            .into_iter()
            .map(|g| (g.hand.map(|h| h.0), g.landings))
            .collect()
    }

    fn standing(hand: u32, at: &[(f64, f64)], fresh: bool) -> Standing {
        let fingers = at.iter().map(|&p| (DVec2::from(p), DVec2::from(p))).collect();
        Standing {
            hand: HandId(hand),
            fingers,
            fresh,
        }
    }

    #[test]
    fn near_fingers_are_a_hand_and_far_ones_are_two() {
        assert_eq!(
            groups(&[(100.0, 100.0), (150.0, 120.0)], &[]),
            [(None, vec![0, 1])]
        );
        let apart = groups(&[(100.0, 100.0), (301.0, 100.0)], &[]);
        assert_eq!(apart, [(None, vec![0]), (None, vec![1])]);
    }

    #[test]
    fn the_box_holds_even_where_each_neighbour_is_near() {
        let row: Vec<(f64, f64)> = (0..4).map(|i| (100.0 + 90.0 * f64::from(i), 300.0)).collect();
        for (_, landings) in groups(&row, &[]) {
            assert!(landings.len() <= 3, "{landings:?}");
        }
    }

    #[test]
    fn a_hand_has_at_most_five_fingers() {
        let six: Vec<(f64, f64)> = (0..6).map(|i| (100.0 + 20.0 * f64::from(i), 300.0)).collect();
        let sizes: Vec<usize> = groups(&six, &[]).iter().map(|g| g.1.len()).collect();
        assert_eq!(sizes.iter().sum::<usize>(), 6);
        assert!(sizes.iter().all(|&n| n <= 5));
    }

    #[test]
    fn hands_one_above_the_other_do_not_interleave() {
        let mut both = Vec::new();
        for i in 0..4 {
            both.push((300.0 + 30.0 * f64::from(i), 150.0));
            both.push((300.0 + 30.0 * f64::from(i), 290.0));
        }
        let found = groups(&both, &[]);
        assert_eq!(found, [(None, vec![0, 2, 4, 6]), (None, vec![1, 3, 5, 7])]);
    }

    #[test]
    fn visitors_who_face_each_other_are_two_even_within_a_box() {
        assert_eq!(groups(&[(600.0, 244.0), (600.0, 436.0)], &[]).len(), 2);
        // Both sides of the line, but too near to it to tell.
        assert_eq!(groups(&[(600.0, 250.0), (600.0, 430.0)], &[]).len(), 1);
        // A small screen has one visitor.
        let small = group(
            &GestureParams::default(),
            DVec2::new(464.0, 256.0),
            &[DVec2::new(200.0, 40.0), DVec2::new(200.0, 210.0)],
            &[],
        );
        assert_eq!(small.len(), 1);
    }

    #[test]
    fn late_fingers_join_within_reach_and_fresh_ones_within_the_box() {
        let at = [(300.0, 300.0)];
        assert_eq!(
            groups(&[(415.0, 300.0)], &[standing(7, &at, false)])[0].0,
            Some(7)
        );
        assert_eq!(groups(&[(430.0, 300.0)], &[standing(7, &at, false)])[0].0, None);
        assert_eq!(groups(&[(430.0, 300.0)], &[standing(7, &at, true)])[0].0, Some(7));
    }

    #[test]
    fn hands_that_are_down_never_merge() {
        let found = groups(
            &[(300.0, 300.0)],
            &[
                standing(1, &[(250.0, 300.0)], true),
                standing(2, &[(345.0, 300.0)], true),
            ],
        );
        assert_eq!(found, [(Some(2), vec![0])]);
    }
}
