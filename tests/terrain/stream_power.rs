//! The stream power law against closed forms, on chains of nodes and on frozen river networks.

use glam::DVec2;
use orogen::terrain::{Flow, Network, NodeId, Outlets, StreamPower, Tin};
use orogen::units::{Extent, KM};

const UPLIFT: f64 = 5e-4;

const LINEAR: StreamPower = StreamPower {
    k: 5.5e-7,
    m: 0.5,
    n: 1.0,
};

/// Length of the river and distance of its source from the divide, metres.
const L: f64 = 50.0 * KM;
const X0: f64 = 1.0 * KM;

/// A river of `cells` equal reaches from the outlet at x = L up to x = X0, x from the divide, with A = x².
struct River {
    positions: Vec<DVec2>,
    receivers: Vec<NodeId>,
    order: Vec<NodeId>,
    drainage: Vec<f64>,
}

impl River {
    fn new(cells: usize) -> Self {
        let x = |i: usize| L - (L - X0) * i as f64 / cells as f64;
        Self {
            positions: (0..=cells).map(|i| DVec2::new(x(i), 0.0)).collect(),
            receivers: (0..=cells).map(|i| NodeId::new(i.saturating_sub(1))).collect(),
            order: (0..=cells).map(NodeId::new).collect(),
            drainage: (0..=cells).map(|i| x(i).powi(2)).collect(),
        }
    }

    fn network(&self) -> Network<'_> {
        Network {
            positions: &self.positions,
            receivers: &self.receivers,
            order: &self.order,
            drainage: &self.drainage,
        }
    }

    fn run(&self, law: StreamPower, dt_yr: f64, steps: usize) -> Vec<f64> {
        let mut z = vec![0.0; self.order.len()];
        for _ in 0..steps {
            law.step(
                &self.network(),
                &mut z,
                None,
                |_| UPLIFT * dt_yr,
                |_| dt_yr,
                |_, _| {},
            );
        }
        z
    }
}

/// A law that gives a range of about 3 km at any n.
fn law_of(n: f64) -> StreamPower {
    // U = k Aᵐ sⁿ at A = 100 km² and s = 0.09.
    let m = 0.5 * n;
    StreamPower {
        k: UPLIFT / (1e8_f64.powf(m) * 0.09_f64.powf(n)),
        m,
        n,
    }
}

#[test]
fn steady_river_converges_to_the_analytic_profile_at_first_order() {
    let exact = UPLIFT / LINEAR.k * (L / X0).ln();
    assert!((exact - 3556.385).abs() < 1e-3);
    // Errors of the upwind scheme at dx = 1000, 500, 250, 125 m.
    let expected = [515.6, 241.2, 116.1, 56.9];
    for (cells, expected) in [49, 98, 196, 392].into_iter().zip(expected) {
        let z = River::new(cells).run(LINEAR, 1e6, 400);
        let error = (z[cells] - exact).abs();
        assert!(
            (error / expected - 1.0).abs() < 1e-3,
            "{cells} cells: {error} for {expected}"
        );
    }
}

#[test]
fn steady_rivers_of_other_exponents_converge_too() {
    for (n, m) in [(0.7, 0.5), (1.0, 0.4), (2.0, 0.8), (1.5, 0.75)] {
        let law = StreamPower { m, ..law_of(n) };
        let law = StreamPower {
            k: UPLIFT / (1e8_f64.powf(m) * 0.09_f64.powf(n)),
            ..law
        };
        let p = 1.0 - 2.0 * m / n;
        let scale = (UPLIFT / law.k).powf(1.0 / n);
        let exact = if p.abs() < 1e-12 {
            scale * (L / X0).ln()
        } else {
            scale * (L.powf(p) - X0.powf(p)) / p
        };
        let error = |cells: usize| (River::new(cells).run(law, 1e6, 600)[cells] - exact).abs() / exact;
        let (coarse, fine) = (error(98), error(392));
        assert!(fine < 0.05, "n {n}, m {m}: relative error {fine}");
        let order = (coarse / fine).log2() / 2.0;
        assert!((order - 1.0).abs() < 0.12, "n {n}, m {m}: order {order}");
    }
}

#[test]
fn transient_river_follows_the_knickpoint() {
    // z = U min(t, τ), τ the time a knickpoint takes from the outlet; n = 1.
    let t = 5e6;
    let response = |x: f64| (L / x).ln() / LINEAR.k;
    assert!((response(X0) / 1e6 - 7.1128).abs() < 1e-4);
    let knick = L * (-LINEAR.k * t).exp();
    assert!((knick - 3196.0).abs() < 1.0);
    let cases = [
        (49, 1e6, 400.0, 40.0),
        (49, 1e5, 165.0, 17.0),
        (196, 1e5, 148.0, 7.8),
        (196, 1e4, 84.0, 5.2),
        (784, 1e4, 61.0, 1.7),
    ];
    for (cells, dt, max_expected, mean_expected) in cases {
        let river = River::new(cells);
        let z = river.run(LINEAR, dt, (t / dt) as usize);
        let errors: Vec<f64> = z
            .iter()
            .zip(&river.positions)
            .map(|(z, p)| (z - UPLIFT * t.min(response(p.x))).abs())
            .collect();
        let max = errors.iter().copied().fold(0.0, f64::max);
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        assert!(
            (max / max_expected - 1.0).abs() < 0.05,
            "{cells} cells, dt {dt}: max {max} for {max_expected}"
        );
        assert!(
            (mean / mean_expected - 1.0).abs() < 0.1,
            "{cells}, {dt}: mean {mean} for {mean_expected}"
        );
    }
}

#[test]
fn one_endless_step_gives_the_steady_state_and_a_short_one_explicit_euler() {
    let river = River::new(98);
    for n in [0.6, 1.0, 1.7] {
        let law = law_of(n);
        let steady = river.run(law, 1e6, 1000);
        let endless = river.run(law, 1e18, 1);
        for (a, b) in steady.iter().zip(&endless) {
            // z/(U Δt) is what the step falls short of endless, 1e-11.
            assert!((a - b).abs() < 1e-6, "n {n}: {a} and {b}");
        }
        // From the steady state without uplift: z′ = z − dt k Aᵐ sⁿ up to dt².
        let dt = 1.0;
        let mut z = steady.clone();
        law.step(&river.network(), &mut z, None, |_| 0.0, |_| dt, |_, _| {});
        for i in 1..z.len() {
            let slope = (steady[i] - steady[i - 1]) / river.positions[i].distance(river.positions[i - 1]);
            let explicit = steady[i] - dt * law.k * river.drainage[i].powf(law.m) * slope.powf(n);
            assert!(
                (z[i] - explicit).abs() < 1e-6 * dt * UPLIFT * 1e2,
                "n {n}: {} and {explicit}",
                z[i]
            );
        }
    }
}

/// A frozen network: the tree of a noisy cone on a Poisson TIN.
fn frozen_tree() -> (Tin, Flow) {
    let extent = Extent {
        width: 100.0 * KM,
        height: 100.0 * KM,
    };
    let tin = Tin::poisson(extent, 3000, 8).expect("a square");
    let middle = 0.5 * extent.size();
    let z: Vec<f64> = tin
        .positions()
        .iter()
        .map(|p| -0.01 * p.distance(middle) + 20.0 * (p.x * 1e-3).sin() * (p.y * 1.3e-3).cos())
        .collect();
    let mut flow = Flow::new(&tin);
    flow.route(&tin, &z, Outlets::Border, None);
    (tin, flow)
}

#[test]
fn steady_state_on_a_tree_is_exact_for_any_exponent_and_time_step() {
    let (tin, flow) = frozen_tree();
    let network = Network {
        positions: tin.positions(),
        receivers: flow.receivers(),
        order: flow.order(),
        drainage: flow.drainage(),
    };
    for (n, m, dt) in [
        (1.0, 0.5, 1e7),
        (1.0, 0.5, 2.5e5),
        (1.0, 0.4, 1e6),
        (2.0, 1.0, 1e6),
        (0.6, 0.3, 1e6),
    ] {
        let law = StreamPower { m, ..law_of(n) };
        let mut z = vec![0.0; tin.len()];
        for _ in 0..(5e8 / dt) as usize {
            law.step(&network, &mut z, None, |_| UPLIFT * dt, |_| dt, |_, _| {});
        }
        for node in tin.nodes() {
            let i = node.index();
            if let Some(receiver) = flow.receiver(node) {
                let step = tin.distance(node, receiver)
                    * (UPLIFT / law.k).powf(1.0 / n)
                    * flow.drainage()[i].powf(-m / n);
                let found = z[i] - z[receiver.index()];
                assert!(
                    (found - step).abs() < 1e-8 * step.max(1.0),
                    "n {n} dt {dt}: {found} for {step}"
                );
            }
        }
    }
}

#[test]
fn steady_heights_are_a_line_in_chi() {
    let (tin, flow) = frozen_tree();
    let network = Network {
        positions: tin.positions(),
        receivers: flow.receivers(),
        order: flow.order(),
        drainage: flow.drainage(),
    };
    let mut z = vec![0.0; tin.len()];
    for _ in 0..100 {
        LINEAR.step(&network, &mut z, None, |_| UPLIFT * 1e7, |_| 1e7, |_, _| {});
    }
    // χ with A0 = 1 km²: z = U/(K √A0) χ.
    let reference: f64 = 1e6;
    let mut chi = vec![0.0; tin.len()];
    for &node in flow.order() {
        if let Some(receiver) = flow.receiver(node) {
            chi[node.index()] = chi[receiver.index()]
                + tin.distance(node, receiver) * (reference / flow.drainage()[node.index()]).sqrt();
        }
    }
    let slope = UPLIFT / (LINEAR.k * reference.sqrt());
    let highest = z.iter().copied().fold(0.0, f64::max);
    assert!(highest > 1000.0);
    for (z, chi) in z.iter().zip(&chi) {
        assert!((z - slope * chi).abs() < 1e-9 * highest);
    }
}

#[test]
fn erodibility_and_protection_act_node_by_node() {
    let river = River::new(49);
    let mut z = vec![0.0; 50];
    for _ in 0..3000 {
        let duration = |i: usize| if i == 20 { 0.5e6 } else { 1e6 };
        LINEAR.step(
            &river.network(),
            &mut z,
            None,
            |_| UPLIFT * 1e6,
            duration,
            |_, _| {},
        );
    }
    let plain = river.run(LINEAR, 1e6, 3000);
    let drop = |z: &[f64], i: usize| z[i] - z[i - 1];
    // Half the erodibility doubles the slope there and nowhere else: χ is local.
    assert!((drop(&z, 20) / drop(&plain, 20) - 2.0).abs() < 1e-9);
    assert!((drop(&z, 21) / drop(&plain, 21) - 1.0).abs() < 1e-9);
}

#[test]
fn nodes_under_water_rise_and_nodes_above_it_stop_at_its_surface() {
    // outlet ← sill ← bed ← slope; the bed lies 50 m under the sill.
    let positions = [0.0, 1e3, 2e3, 3e3].map(|x| DVec2::new(x, 0.0));
    let receivers = [0, 0, 1, 2].map(NodeId);
    let order = [0, 1, 2, 3].map(NodeId);
    let drainage = [4e8, 3e8, 2e8, 1e8];
    let network = Network {
        positions: &positions,
        receivers: &receivers,
        order: &order,
        drainage: &drainage,
    };
    let mut z = [0.0, 100.0, 50.0, 200.0];
    let mut water = [0.0; 4];
    LINEAR.step(&network, &mut z, Some(&mut water), |_| 1.0, |_| 1e4, |_, _| {});
    assert!(z[1] > 0.0 && z[1] < 100.0);
    assert_eq!(z[2], 51.0, "the bed rises with the uplift and is not cut");
    assert_eq!(water[2], z[1].max(51.0));
    assert!(z[3] >= water[2] && z[3] < 200.0);
    assert_eq!((water[0], water[1], water[3]), (z[0], z[1], z[3]));
}
