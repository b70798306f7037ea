//! What time does to crust: erosion of continents, cooling of the sea floor, filling of trenches (section 4.5).

use super::crust::Crust;
use super::params::{GlobeParams, SeaFloor, gdh1_km};

/// Lets crust grow older by a step. `trench` (0–1) says how much of a trench it lies in.
pub fn wear(crust: &mut Crust, trench: f32, params: &GlobeParams) {
    let dt = params.dt_my;
    crust.orogeny_age += dt as f32;
    let z = f64::from(crust.z);
    if z > 0.0 {
        let rate = params.erosion + params.erosion_5km * (z / 5.0).powi(2);
        crust.raise(-(z / params.summit_km * rate * dt) as f32);
    }
    if !crust.continental {
        let age = f64::from(crust.age);
        crust.age += dt as f32;
        match params.sea_floor {
            SeaFloor::Damping => {
                let z = f64::from(crust.z);
                if z <= 0.0 {
                    crust.z -= ((1.0 - z / params.trench_km) * params.damping * dt) as f32;
                }
            }
            SeaFloor::Gdh1 => crust.z -= (gdh1_km(age + dt) - gdh1_km(age)) as f32,
        }
    }
    fill(crust, trench, params);
}

/// Cuts a trench or fills it.
fn fill(crust: &mut Crust, trench: f32, params: &GlobeParams) {
    let sediment = (params.sediment * params.dt_my) as f32;
    if params.trench_cut_km > 0.0 {
        let cut = -(params.trench_cut_km as f32) * trench;
        crust.trench = if cut < crust.trench {
            cut
        } else {
            (crust.trench + sediment).min(cut)
        };
    } else if trench > 0.0 && f64::from(crust.z) < params.abyss_km {
        crust.z = (crust.z + sediment).min(params.abyss_km as f32);
    }
}
