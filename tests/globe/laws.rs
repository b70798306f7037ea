//! Closed forms of the planet's laws.

use std::f64::consts::E;

use orogen::globe::{
    Crust, GlobeParams, Reach, SeaFloor, gdh1_km, influence_km, rift_probability, surge_km, wear,
};

/// Crust keeps its height in 32 bits: a rounding per step of heights up to ten kilometres.
const ROUNDING_KM: f64 = 1e-6;

fn worn(mut crust: Crust, steps: usize, trench: f32, params: &GlobeParams) -> Crust {
    for _ in 0..steps {
        wear(&mut crust, trench, params);
    }
    crust
}

#[test]
fn damped_sea_floor_sinks_towards_trenches() {
    let params = GlobeParams::paper();
    for (k, expected) in [(1, -1.0720), (10, -1.6946), (50, -3.9768), (100, -5.9690)] {
        let z = f64::from(worn(Crust::oceanic(-1.0, 0.0), k, 0.0, &params).z);
        let closed = -10.0 + 9.0 * 0.992_f64.powi(k as i32);
        assert!(
            (z - closed).abs() < ROUNDING_KM * k as f64,
            "{z} after {k} steps for {closed}"
        );
        assert!((z - expected).abs() < 1e-4, "{z} after {k} steps for {expected}");
        assert!(
            (f64::from(worn(Crust::oceanic(-1.0, 0.0), k, 0.0, &params).age) - 2.0 * k as f64).abs() < 1e-3
        );
    }
}

#[test]
fn land_loses_the_same_share_in_each_step() {
    let params = GlobeParams::paper();
    for k in [1, 10, 50, 100] {
        let crust = worn(Crust::continental(5.0), k, 0.0, &params);
        let closed = 5.0 * 0.994_f64.powi(k as i32);
        assert!((f64::from(crust.z) - closed).abs() < ROUNDING_KM * k as f64);
        assert!(crust.age == 0.0 && crust.continental);
    }
    // Land below the sea is not raised by erosion.
    assert_eq!(worn(Crust::continental(-0.3), 10, 0.0, &params).z, -0.3);
}

#[test]
fn trenches_fill_up_to_the_plains_and_no_further() {
    let params = GlobeParams::paper();
    // Without the sinking of the floor: 0.6 km in a step.
    let still = GlobeParams {
        damping: 0.0,
        ..params
    };
    let steps = |k, trench| f64::from(worn(Crust::oceanic(-10.0, 100.0), k, trench, &still).z);
    for (k, expected) in [(1, -9.4), (6, -6.4), (7, -6.0), (30, -6.0)] {
        assert!((steps(k, 1.0) - expected).abs() < 1e-5, "{k}");
        assert_eq!(steps(k, 0.0), -10.0, "no sediment beside trenches");
    }
    let filled = worn(Crust::oceanic(-10.0, 100.0), 30, 1.0, &params);
    assert!(
        (f64::from(filled.z) + 6.0).abs() < 1e-5,
        "plains that sink stay filled"
    );
    assert_eq!(
        worn(Crust::oceanic(-5.0, 100.0), 1, 1.0, &still).z,
        -5.0,
        "what is higher is not touched"
    );
}

#[test]
fn cooling_sea_floor_has_the_published_depths() {
    // Stein and Stein 1992.
    for (age, depth) in [
        (0.0, 2.6),
        (10.0, 3.75),
        (20.0, 4.23),
        (60.0, 5.19),
        (100.0, 5.50),
        (180.0, 5.63),
    ] {
        assert!((gdh1_km(age) - depth).abs() < 0.01, "{age} My: {}", gdh1_km(age));
    }
    assert!(
        (gdh1_km(20.0 - 1e-9) - gdh1_km(20.0)).abs() < 0.01,
        "the two laws meet"
    );
    assert_eq!(gdh1_km(-1.0), gdh1_km(0.0));
    let params = GlobeParams {
        trench_cut_km: 0.0,
        ..GlobeParams::planet()
    };
    assert_eq!(params.sea_floor, SeaFloor::Gdh1);
    for k in [1, 5, 10, 50, 90] {
        let z = f64::from(worn(Crust::oceanic(-2.6, 0.0), k, 0.0, &params).z);
        assert!(
            (z + gdh1_km(2.0 * k as f64)).abs() < ROUNDING_KM * k as f64,
            "{k}"
        );
    }
}

#[test]
fn collisions_are_felt_as_far_as_worked_out_by_hand() {
    let paper = GlobeParams::paper();
    let mean = 12.75e6;
    let product = GlobeParams {
        reach: Reach::Product,
        ..paper
    };
    // A terrane of one tenth of a million km², and India.
    for (area, root, printed) in [(0.1e6, 372.0, 33.0), (3.3e6, 2137.0, 1087.0)] {
        assert!((influence_km(100.0, area, mean, &paper) - root).abs() < 1.0);
        assert!((influence_km(100.0, area, mean, &product) - printed).abs() < 1.0);
    }
    assert_eq!(influence_km(100.0, 1e9, mean, &paper), 4200.0);
    assert_eq!(influence_km(0.0, 1e9, mean, &paper), 0.0);
}

#[test]
fn surges_begin_as_printed_and_saturate() {
    let params = GlobeParams::paper();
    // Small areas: Δ_c A (1 − x²)², a 7,700 km² terrane raises 0.1 km.
    let small = surge_km(0.0, 0.0, 7_700.0, &params);
    assert!((small - 0.1001).abs() < 0.001, "{small}");
    assert!((surge_km(0.0, 0.5, 7_700.0, &params) / small - 0.5625).abs() < 0.01);
    for x in [1.0, 1.5, 100.0] {
        assert_eq!(surge_km(0.0, x, 1e9, &params), 0.0);
    }
    for z in [-1.0, 0.0, 3.0, 5.9, 6.0, 9.0] {
        let dz = surge_km(z, 0.0, 1e9, &params);
        assert!(
            dz >= 0.0 && z + dz <= z.max(params.collision_summit_km) + 1e-9,
            "{z} {dz}"
        );
    }
}

#[test]
fn rifts_follow_the_law_of_rare_events() {
    let params = GlobeParams {
        rifts: 0.01,
        least_rift_share: 0.1,
        ..GlobeParams::paper()
    };
    let mean = 12.75e6;
    let lambda: f64 = 0.01 * 0.5 * 4.0;
    assert!((rift_probability(0.5, 4.0 * mean, mean, &params) - lambda * (-lambda).exp()).abs() < 1e-15);
    assert_eq!(
        rift_probability(0.0, mean, mean, &params),
        rift_probability(0.1, mean, mean, &params)
    );
    // λ is at most 1, where the law is at its greatest.
    assert_eq!(rift_probability(1.0, 1e4 * mean, mean, &params), 1.0 / E);
}
