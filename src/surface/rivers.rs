//! Rivers: the drainage network as polylines from source to confluence.

use glam::DVec2;

/// A vertex of a river.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RiverPoint {
    /// Plan position, metres.
    pub at: DVec2,
    /// Drainage area, m².
    pub drainage: f64,
}

/// One reach-chain: a channel from its source to where it joins a larger one, or to an outlet. A river that joins
/// another ends *on* the other, so that lines meet.
#[derive(Clone, Debug, PartialEq)]
pub struct River {
    /// Vertices in the direction of flow, at least two.
    pub points: Vec<RiverPoint>,
    /// Strahler's order at the downstream end.
    pub order: u32,
}

impl River {
    /// Length along the line, metres.
    pub fn length(&self) -> f64 {
        self.points
            .windows(2)
            .map(|pair| pair[0].at.distance(pair[1].at))
            .sum()
    }
}

/// The flow graph to read rivers from: parallel slices, one entry per node.
#[derive(Clone, Copy, Debug)]
pub struct FlowGraph<'a> {
    /// Plan positions, metres.
    pub positions: &'a [DVec2],
    /// The node each one drains to; an outlet drains to itself.
    pub receivers: &'a [u32],
    /// Drainage area, m². Strictly larger at the receiver.
    pub drainage: &'a [f64],
    /// True for nodes under standing water: rivers end at the shore, and go on below the lake.
    pub lake: &'a [bool],
}

/// Rivers of at least `threshold` m² of drainage area, in ascending order of their source node.
///
/// Channels begin where the drainage area passes the threshold (Montgomery & Dietrich 1988, with the slope left
/// out). At a confluence the river with the larger area goes on (Horton's main stem) and the others end there.
/// Orders follow Strahler (1957). Lines are interrupted inside lakes.
pub fn trace(graph: FlowGraph<'_>, threshold: f64) -> Vec<River> {
    let count = graph.positions.len();
    let in_channel = |i: usize| graph.drainage[i] >= threshold;
    let main_donor = main_donors(graph, threshold);
    let order = strahler_orders(graph, threshold);

    let mut rivers = Vec::new();
    for source in 0..count {
        if !in_channel(source) || main_donor[source].is_some() {
            continue;
        }
        let mut line = Vec::new();
        let mut node = source;
        let mut last_order = order[source];
        loop {
            let next = graph.receivers[node] as usize;
            line.push(RiverPoint {
                at: graph.positions[node],
                drainage: graph.drainage[node],
            });
            let goes_on = next != node && main_donor[next] == Some(node as u32);
            let under_water = graph.lake[node] && graph.lake[next];
            if under_water || !goes_on {
                if !under_water && next != node {
                    // The mouth: on the larger river, at this river's own size.
                    line.push(RiverPoint {
                        at: graph.positions[next],
                        drainage: graph.drainage[node],
                    });
                }
                push_river(&mut rivers, std::mem::take(&mut line), last_order);
            }
            if !goes_on {
                break;
            }
            node = next;
            last_order = order[node];
        }
    }
    rivers
}

fn push_river(rivers: &mut Vec<River>, points: Vec<RiverPoint>, order: u32) {
    if points.len() >= 2 {
        rivers.push(River { points, order });
    }
}

/// For each node its channel donor with the largest area (the smallest handle among equals).
fn main_donors(graph: FlowGraph<'_>, threshold: f64) -> Vec<Option<u32>> {
    let mut main: Vec<Option<u32>> = vec![None; graph.positions.len()];
    for (i, &receiver) in graph.receivers.iter().enumerate() {
        if receiver as usize == i || graph.drainage[i] < threshold {
            continue;
        }
        let best = &mut main[receiver as usize];
        if best.is_none_or(|b| graph.drainage[i] > graph.drainage[b as usize]) {
            *best = Some(i as u32);
        }
    }
    main
}

/// Strahler's order of each channel node, 0 elsewhere: two donors of the highest order raise it by one.
fn strahler_orders(graph: FlowGraph<'_>, threshold: f64) -> Vec<u32> {
    let count = graph.positions.len();
    // Donors still to come, then a queue of nodes whose donors are all known (Kahn 1962).
    let mut waiting = vec![0_u32; count];
    for (i, &receiver) in graph.receivers.iter().enumerate() {
        if receiver as usize != i && graph.drainage[i] >= threshold {
            waiting[receiver as usize] += 1;
        }
    }
    let mut ready: Vec<usize> = (0..count)
        .filter(|&i| graph.drainage[i] >= threshold && waiting[i] == 0)
        .collect();
    let mut highest = vec![(0_u32, 0_u32); count];
    let mut order = vec![0; count];
    while let Some(i) = ready.pop() {
        let (top, times) = highest[i];
        order[i] = match times {
            0 => 1,
            1 => top,
            _ => top + 1,
        };
        let receiver = graph.receivers[i] as usize;
        if receiver == i {
            continue;
        }
        let (top, times) = &mut highest[receiver];
        match order[i].cmp(top) {
            std::cmp::Ordering::Greater => (*top, *times) = (order[i], 1),
            std::cmp::Ordering::Equal => *times += 1,
            std::cmp::Ordering::Less => {}
        }
        waiting[receiver] -= 1;
        if waiting[receiver] == 0 {
            ready.push(receiver);
        }
    }
    order
}

/// Rivers as a map shows them: smoothed, so that lines bend instead of following mesh edges and still meet; through
/// lakes (water drawn over them hides them, and where it does not no line ends on dry land); without the short ones
/// that only fray the picture.
///
/// A river without others is left out where less than `LEAST_LENGTH` of it is above water.
pub fn drawn(graph: FlowGraph<'_>, threshold: f64) -> Vec<River> {
    let positions = relaxed(graph, threshold);
    let dry = vec![false; positions.len()];
    let through_lakes = FlowGraph { lake: &dry, ..graph };
    let main_donor = main_donors(through_lakes, threshold);
    let order = strahler_orders(through_lakes, threshold);
    let mut lines = stems(through_lakes, threshold, &main_donor);

    // A river ends on one with a larger area. In ascending order of area at the mouth, all that end on a river are
    // judged before it.
    lines.sort_by(|a, b| {
        let area = |line: &[u32]| line.last().map_or(0.0, |&mouth| graph.drainage[mouth as usize]);
        area(a).total_cmp(&area(b)).then_with(|| a.cmp(b))
    });
    let least = LEAST_LENGTH * threshold.sqrt();
    let mut carries = vec![false; positions.len()];
    let mut rivers = Vec::new();
    for line in lines {
        let (Some(&source), Some(&last)) = (line.first(), line.last()) else {
            continue;
        };
        let mouth = graph.receivers[last as usize];
        let joined = line.iter().any(|&node| carries[node as usize]);
        let visible: f64 = line
            .iter()
            .zip(line.iter().skip(1).chain([&mouth]))
            .filter(|&(&from, &to)| !(graph.lake[from as usize] && graph.lake[to as usize]))
            .map(|(&from, &to)| graph.positions[from as usize].distance(graph.positions[to as usize]))
            .sum();
        if !joined && visible < least {
            continue;
        }
        carries[mouth as usize] = true;
        let mut points: Vec<RiverPoint> = line
            .iter()
            .map(|&node| RiverPoint {
                at: positions[node as usize],
                drainage: graph.drainage[node as usize],
            })
            .collect();
        if mouth != last {
            points.push(RiverPoint {
                at: positions[mouth as usize],
                drainage: graph.drainage[last as usize],
            });
        }
        if points.len() >= 2 {
            rivers.push((
                source,
                curved(&River {
                    points,
                    order: order[last as usize],
                }),
            ));
        }
    }
    rivers.sort_by_key(|&(source, _)| source);
    rivers.into_iter().map(|(_, river)| river).collect()
}

/// Shortest river a map shows, in units of √(threshold): by Hack's law (1957) a valley of the threshold's area is
/// about 1.4 of them long.
const LEAST_LENGTH: f64 = 2.0;

/// The nodes of each main stem, from its source down to the last that is its own.
fn stems(graph: FlowGraph<'_>, threshold: f64, main_donor: &[Option<u32>]) -> Vec<Vec<u32>> {
    (0..graph.positions.len())
        .filter(|&i| graph.drainage[i] >= threshold && main_donor[i].is_none())
        .map(|source| {
            let mut line = vec![source as u32];
            let mut node = source;
            loop {
                let next = graph.receivers[node] as usize;
                if next == node || main_donor[next] != Some(node as u32) {
                    return line;
                }
                line.push(next as u32);
                node = next;
            }
        })
        .collect()
}

/// How often channel nodes move to the mean of their neighbours along the stream: enough to take out the zigzag
/// of mesh edges, too little to leave the valley floor (each round moves a node by a fraction of an edge).
const RELAXATION_ROUNDS: usize = 6;

/// Channel nodes drawn towards their neighbours along the main stem, `(donor + 2 self + receiver) / 4`. Sources
/// and outlets stay. Because nodes move and not lines, tributaries still end on their main stem.
fn relaxed(graph: FlowGraph<'_>, threshold: f64) -> Vec<DVec2> {
    let main_donor = main_donors(graph, threshold);
    let mut positions = graph.positions.to_vec();
    for _ in 0..RELAXATION_ROUNDS {
        let before = positions.clone();
        for (i, position) in positions.iter_mut().enumerate() {
            let receiver = graph.receivers[i] as usize;
            if let Some(donor) = main_donor[i]
                && receiver != i
            {
                *position = (before[donor as usize] + 2.0 * before[i] + before[receiver]) / 4.0;
            }
        }
    }
    positions
}

/// Points per edge of a drawn river.
const PIECES: usize = 4;

/// A smooth curve through all vertices (Catmull & Rom 1974, uniform, reflected at the ends).
fn curved(river: &River) -> River {
    let vertices = &river.points;
    let mut points = Vec::with_capacity((vertices.len() - 1) * PIECES + 1);
    points.push(vertices[0]);
    for i in 0..vertices.len() - 1 {
        let (b, c) = (vertices[i], vertices[i + 1]);
        let a = if i > 0 {
            vertices[i - 1].at
        } else {
            2.0 * b.at - c.at
        };
        let d = vertices.get(i + 2).map_or(2.0 * c.at - b.at, |v| v.at);
        for piece in 1..PIECES {
            let t = piece as f64 / PIECES as f64;
            let at = 0.5
                * (2.0 * b.at
                    + t * ((c.at - a)
                        + t * ((2.0 * a - 5.0 * b.at + 4.0 * c.at - d)
                            + t * (3.0 * b.at - a - 3.0 * c.at + d))));
            points.push(RiverPoint {
                at,
                drainage: b.drainage + (c.drainage - b.drainage) * t,
            });
        }
        points.push(c);
    }
    River {
        points,
        order: river.order,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two springs (0, 1) join at 2; a third (3) joins at 4; 4 → 5 (lake) → 6 (lake) → 7 → 8 outlet.
    struct Net {
        positions: Vec<DVec2>,
        receivers: Vec<u32>,
        drainage: Vec<f64>,
        lake: Vec<bool>,
    }

    impl Net {
        fn new() -> Self {
            let at = |x: f64, y: f64| DVec2::new(x, y);
            Self {
                positions: vec![
                    at(0.0, 10.0),
                    at(0.0, -10.0),
                    at(10.0, 0.0),
                    at(20.0, 10.0),
                    at(20.0, 3.0),
                    at(30.0, 0.0),
                    at(40.0, 0.0),
                    at(50.0, 0.0),
                    at(60.0, 0.0),
                ],
                receivers: vec![2, 2, 4, 4, 5, 6, 7, 8, 8],
                drainage: vec![5.0, 4.0, 10.0, 3.0, 14.0, 15.0, 16.0, 17.0, 18.0],
                lake: vec![false, false, false, false, false, true, true, false, false],
            }
        }

        fn graph(&self) -> FlowGraph<'_> {
            FlowGraph {
                positions: &self.positions,
                receivers: &self.receivers,
                drainage: &self.drainage,
                lake: &self.lake,
            }
        }
    }

    fn nodes(net: &Net, river: &River) -> Vec<usize> {
        river
            .points
            .iter()
            .map(|p| net.positions.iter().position(|&q| q == p.at).unwrap())
            .collect()
    }

    #[test]
    fn main_stem_runs_through_and_tributaries_end_on_it() {
        let net = Net::new();
        let rivers = trace(net.graph(), 3.0);
        let lines: Vec<_> = rivers.iter().map(|r| nodes(&net, r)).collect();
        assert_eq!(lines, [vec![0, 2, 4, 5], vec![6, 7, 8], vec![1, 2], vec![3, 4]]);
        assert_eq!(
            rivers[2].points[1].drainage, 4.0,
            "a tributary keeps its own area at its mouth"
        );
    }

    #[test]
    fn orders_follow_strahler() {
        let net = Net::new();
        let rivers = trace(net.graph(), 3.0);
        let orders: Vec<_> = rivers.iter().map(|r| r.order).collect();
        assert_eq!(
            orders,
            [2, 2, 1, 1],
            "a first-order stream does not raise a second-order one"
        );
    }

    #[test]
    fn threshold_cuts_the_heads() {
        let net = Net::new();
        let rivers = trace(net.graph(), 4.5);
        let lines: Vec<_> = rivers.iter().map(|r| nodes(&net, r)).collect();
        assert_eq!(lines, [vec![0, 2, 4, 5], vec![6, 7, 8]]);
        assert!(trace(net.graph(), 100.0).is_empty());
    }

    #[test]
    fn drawn_rivers_still_meet_and_get_shorter() {
        let net = Net::new();
        let raw = trace(
            FlowGraph {
                lake: &[false; 9],
                ..net.graph()
            },
            3.0,
        );
        let drawn = drawn(net.graph(), 3.0);
        assert_eq!(drawn.len(), raw.len());
        for tributary in &drawn[1..] {
            let mouth = tributary.points.last().unwrap().at;
            assert!(
                drawn[0].points.iter().any(|p| p.at == mouth),
                "{mouth} lies on the main stem"
            );
        }
        assert!(drawn[0].length() < raw[0].length());
        assert_eq!(drawn[0].points[0].at, net.positions[0], "the source stays");
        assert_eq!(
            drawn[0].points.last().unwrap().at,
            net.positions[8],
            "through the lake to the outlet, which stays"
        );
    }

    #[test]
    fn drawn_rivers_leave_out_short_ones_that_carry_no_other() {
        let mut net = Net::new();
        let sources = |net: &Net| -> Vec<DVec2> {
            drawn(net.graph(), 3.0)
                .iter()
                .map(|river| river.points[0].at)
                .collect()
        };
        let [first, second, third] = [0, 1, 3].map(|i: usize| net.positions[i]);
        assert_eq!(sources(&net), [first, second, third]);
        // Two root-thresholds are 3.46 long.
        net.positions[3] = net.positions[4] + DVec2::new(0.0, 3.0);
        assert_eq!(sources(&net), [first, second], "too short");
        net.positions[1] = net.positions[2] + DVec2::new(0.0, -30.0);
        net.lake[1] = true;
        net.lake[2] = true;
        assert_eq!(sources(&net), [first], "under water");
    }
}
