//! Curves along a slice, and where each is seen.

use super::cut::Slice;

/// Heights along a slice (metres), at its places and where interfaces crop out between them: there the curves bend.
pub(super) struct Profile {
    /// Distance from the first end, metres.
    pub(super) distance: Vec<f64>,
    pub(super) ground: Vec<f64>,
    /// The ground without its sediment.
    pub(super) bedrock: Vec<f64>,
    /// One curve per interface of the pile; none where no layers are known.
    pub(super) interfaces: Vec<Vec<f64>>,
    /// How far the base of the crust is pressed down.
    pub(super) root: Vec<f64>,
}

impl Profile {
    pub(super) fn new(slice: &Slice) -> Self {
        let places = slice.distance.len();
        let none = vec![0.0; places];
        let (interfaces, sediment, root) = slice.strata.as_ref().map_or((&[][..], &none, &none), |strata| {
            (strata.interfaces.as_slice(), &strata.sediment, &strata.root)
        });
        let bedrock: Vec<f64> = slice.ground.iter().zip(sediment).map(|(g, s)| g - s).collect();
        let mut stops: Vec<(usize, f64)> = Vec::with_capacity(2 * places);
        for i in 0..places {
            stops.push((i, 0.0));
            if i + 1 < places {
                let start = stops.len();
                for surface in [&slice.ground, &bedrock] {
                    for interface in interfaces {
                        let over = [i, i + 1].map(|i| interface[i] - surface[i]);
                        if over[0] * over[1] < 0.0 {
                            stops.push((i, over[0] / (over[0] - over[1])));
                        }
                    }
                }
                stops[start..].sort_by(|a, b| a.1.total_cmp(&b.1));
                stops.dedup();
            }
        }
        let at = |values: &[f64]| -> Vec<f64> {
            stops
                .iter()
                .map(|&(i, t)| {
                    if t > 0.0 {
                        values[i] + (values[i + 1] - values[i]) * t
                    } else {
                        values[i]
                    }
                })
                .collect()
        };
        Self {
            distance: at(&slice.distance),
            ground: at(&slice.ground),
            bedrock: at(&bedrock),
            interfaces: interfaces.iter().map(|heights| at(heights)).collect(),
            root: at(root),
        }
    }
}

/// The pieces of the curve `y(x)` where it runs between `low` and `high`, cut exactly where it leaves.
pub(super) fn between(x: &[f64], y: &[f64], low: &[f64], high: &[f64]) -> Vec<Vec<(f64, f64)>> {
    let mut pieces: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut open = false;
    for i in 0..x.len().saturating_sub(1) {
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for room in [
            [0, 1].map(|d| y[i + d] - low[i + d]),
            [0, 1].map(|d| high[i + d] - y[i + d]),
        ] {
            let cut = room[0] / (room[0] - room[1]);
            match (room[0] >= 0.0, room[1] >= 0.0) {
                (true, true) => {}
                (true, false) => leave = leave.min(cut),
                (false, true) => enter = enter.max(cut),
                (false, false) => leave = -1.0,
            }
        }
        if enter >= leave {
            open = false;
            continue;
        }
        let at = |t: f64| (x[i] + (x[i + 1] - x[i]) * t, y[i] + (y[i + 1] - y[i]) * t);
        if !open || enter > 0.0 {
            pieces.push(vec![at(enter)]);
        }
        if let Some(piece) = pieces.last_mut() {
            piece.push(at(leave));
        }
        open = leave >= 1.0;
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_cut_where_they_leave() {
        let x = [0.0, 1.0, 2.0, 3.0, 4.0];
        let y = [0.0, 2.0, 0.0, 2.0, 1.0];
        let pieces = between(&x, &y, &[0.5; 5], &[9.0; 5]);
        assert_eq!(
            pieces,
            [
                vec![(0.25, 0.5), (1.0, 2.0), (1.75, 0.5)],
                vec![(2.25, 0.5), (3.0, 2.0), (4.0, 1.0)]
            ]
        );
        assert!(between(&x, &y, &[3.0; 5], &[9.0; 5]).is_empty());
        assert_eq!(between(&x, &y, &[-1.0; 5], &[9.0; 5]).len(), 1);
    }
}
