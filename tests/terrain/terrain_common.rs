//! A step of the land as plainly as it can be written: one thread, double precision, no reuse, no speed. What it does
//! is defined by the equations; the engine must do the same.

use orogen::terrain::{Edges, ErosionParams, NodeId, Tin, priority_flood};

/// The flow over a surface.
pub(crate) struct PlainFlow {
    pub(crate) receivers: Vec<usize>,
    /// Every node once, each after its receiver.
    pub(crate) stack: Vec<usize>,
    pub(crate) drainage: Vec<f64>,
    /// Level of the water, or of the ground where it is dry.
    pub(crate) level: Vec<f64>,
}

/// A link between two basins: its height, and its nodes in the basins of the larger and of the smaller number.
/// Water that falls over the border has the same node at both.
type Pass = (f64, usize, usize);

fn neighbours(tin: &Tin, i: usize) -> impl Iterator<Item = usize> + '_ {
    tin.neighbours(NodeId::new(i)).map(NodeId::index)
}

fn distance(tin: &Tin, i: usize, j: usize) -> f64 {
    tin.distance(NodeId::new(i), NodeId::new(j))
}

/// The steepest way down, if it is steeper than `slope`; the smaller id among equals.
fn steepest(tin: &Tin, z: &[f64], i: usize, slope: f64) -> Option<usize> {
    let mut best = None;
    let mut best_slope = slope;
    let mut all: Vec<usize> = neighbours(tin, i).collect();
    all.sort_unstable();
    for j in all {
        let s = (z[i] - z[j]) / distance(tin, i, j);
        if s > best_slope {
            (best, best_slope) = (Some(j), s);
        }
    }
    best
}

impl PlainFlow {
    pub(crate) fn new(tin: &Tin, z: &[f64], fixed_edges: bool) -> Self {
        let n = tin.len();
        let mut receivers: Vec<usize> = (0..n)
            .map(|i| {
                let border = tin.border()[i];
                if fixed_edges && border {
                    return i;
                }
                let level = |&j: &usize| !border && j < i && z[j] == z[i];
                steepest(tin, z, i, 0.0)
                    .or_else(|| neighbours(tin, i).filter(level).min())
                    .unwrap_or(i)
            })
            .collect();
        carve(tin, z, &mut receivers);

        let mut donors = vec![Vec::new(); n];
        let mut stack = Vec::new();
        let mut waiting = Vec::new();
        for i in 0..n {
            if receivers[i] == i {
                waiting.push(i);
            } else {
                donors[receivers[i]].push(i);
            }
        }
        while let Some(i) = waiting.pop() {
            stack.push(i);
            waiting.extend(&donors[i]);
        }
        let mut drainage = tin.areas().to_vec();
        for &i in stack.iter().rev() {
            if receivers[i] != i {
                drainage[receivers[i]] += drainage[i];
            }
        }
        Self {
            receivers,
            stack,
            drainage,
            level: priority_flood(tin, z),
        }
    }
}

/// Joins closed basins to the outside by Kruskal's minimum spanning tree (1956), relabelling at every join, and turns
/// the path from each basin's way out down to its pit.
fn carve(tin: &Tin, z: &[f64], receivers: &mut [usize]) {
    let n = tin.len();
    let end = |mut i: usize| {
        while receivers[i] != i {
            i = receivers[i];
        }
        i
    };
    let pits: Vec<usize> = (0..n)
        .filter(|&i| receivers[i] == i && !tin.border()[i])
        .collect();
    // Basin 0 is the outside.
    let basin: Vec<usize> = (0..n)
        .map(|i| pits.binary_search(&end(i)).map_or(0, |k| k + 1))
        .collect();
    let outer_basin = |&(_, inner, outer): &Pass| if inner == outer { 0 } else { basin[outer] };
    let mut passes: Vec<Pass> = Vec::new();
    for i in (0..n).filter(|&i| basin[i] != 0) {
        if tin.border()[i] {
            passes.push((z[i], i, i));
        }
        let lower = |&j: &usize| basin[j] < basin[i];
        passes.extend(neighbours(tin, i).filter(lower).map(|j| (z[i].max(z[j]), i, j)));
    }
    passes.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut joined: Vec<usize> = (0..=pits.len()).collect();
    let mut tree: Vec<Pass> = Vec::new();
    for pass in passes {
        let (a, b) = (joined[basin[pass.1]], joined[outer_basin(&pass)]);
        if a != b {
            joined
                .iter_mut()
                .filter(|label| **label == a)
                .for_each(|label| *label = b);
            tree.push(pass);
        }
    }
    let mut reached = vec![false; pits.len() + 1];
    reached[0] = true;
    let mut todo = vec![0];
    while let Some(from) = todo.pop() {
        for pass in &tree {
            let (a, b) = (basin[pass.1], outer_basin(pass));
            let (to, mouth, towards) = if b == from {
                (a, pass.1, pass.2)
            } else {
                (b, pass.2, pass.1)
            };
            if (a != from && b != from) || reached[to] {
                continue;
            }
            reached[to] = true;
            todo.push(to);
            let (mut node, mut receiver) = (mouth, towards);
            loop {
                let next = receivers[node];
                receivers[node] = receiver;
                if next == node {
                    break;
                }
                (receiver, node) = (node, next);
            }
        }
    }
}

/// One step for n = 1 under uniform uplift: Eq. 5 and the landslide law of §6.1 (Cordonnier et al. 2018), implicit.
pub(crate) fn plain_step(
    tin: &Tin,
    z: &mut [f64],
    uplift: f64,
    params: &ErosionParams,
    dt: f64,
) -> PlainFlow {
    let fixed = params.edges == Edges::Fixed;
    let flow = PlainFlow::new(tin, z, fixed);
    let mut water = vec![0.0_f64; tin.len()];
    for &i in &flow.stack {
        let receiver = flow.receivers[i];
        if receiver == i {
            if !fixed {
                z[i] += dt * uplift;
            }
            water[i] = z[i];
            continue;
        }
        let base = water[receiver];
        z[i] += dt * uplift;
        if z[i] > base {
            let courant = params.k * dt * flow.drainage[i].powf(params.m) / distance(tin, i, receiver);
            z[i] = (z[i] + courant * base) / (1.0 + courant);
        }
        water[i] = z[i].max(base);
    }
    if params.landslides {
        let before = z.to_vec();
        let mut upwards: Vec<usize> = (0..tin.len()).collect();
        upwards.sort_by(|&i, &j| before[i].total_cmp(&before[j]));
        for i in upwards.into_iter().filter(|&i| !(fixed && tin.border()[i])) {
            if let Some(below) = steepest(tin, &before, i, params.talus) {
                let r = distance(tin, i, below);
                let c = params.landslide_rate * dt / r;
                z[i] = z[i].min((z[i] + c * (z[below] + r * params.talus)) / (1.0 + c));
            }
        }
    }
    flow
}
