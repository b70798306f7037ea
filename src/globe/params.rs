//! Constants of the planet. "Paper" is Cortial et al. 2019, Appendix A; values marked *ours* are Orogen's choice.

/// How the sea floor sinks as it grows older.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeaFloor {
    /// The paper's damping towards the depth of trenches (section 4.5).
    Damping,
    /// Plate cooling, GDH1 (Stein and Stein 1992).
    Gdh1,
}

/// How far a collision is felt (section 4.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// `r_c √(v/v₀ · A/A₀)`, measured from the suture.
    Root,
    /// `r_c √(v/v₀) · A/A₀`, as printed.
    Product,
}

/// All constants of the model. Heights and lengths in km, times in My, speeds and rates in mm/yr (the same as km/My).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlobeParams {
    /// Time of a step, My (δt).
    pub dt_my: f64,
    /// Fastest motion of a plate, mm/yr (v₀).
    pub max_speed: f64,
    /// Highest oceanic ridge, km (`z_r`); with [`SeaFloor::Gdh1`] the ridge is where that law begins.
    pub ridge_km: f64,
    /// Abyssal plains, km (`z_a`).
    pub abyss_km: f64,
    /// Deepest trench, km (`z_t`).
    pub trench_km: f64,
    /// Highest land, km (`z_c`).
    pub summit_km: f64,
    /// Distance from the front to which a continent is raised, km (`r_s`).
    pub subduction_km: f64,
    /// The same on an oceanic plate, km (*ours*; the paper has one distance).
    pub arc_km: f64,
    /// Where the uplift is strongest, as a share of that distance (*ours*; the paper's "control distance").
    pub uplift_peak: f64,
    /// Uplift at the front itself, as a share of the strongest (*ours*).
    pub uplift_at_front: f64,
    /// Power of the normalised height of the plunging plate in the uplift (h; the paper prints 2).
    pub height_power: f64,
    /// Base uplift over a subduction, mm/yr (`u₀`).
    pub uplift: f64,
    /// Factor on it where the upper plate is oceanic (*ours*).
    pub arc_factor: f64,
    /// Height at which uplift has faded to nothing, km (*ours*; the paper clamps at `z_c`).
    pub uplift_limit_km: f64,
    /// How uneven uplift is along a belt, 0–1 (*ours*).
    pub uplift_noise: f64,
    /// An oceanic place that rises above this becomes continental, km (*ours*).
    pub emergence_km: f64,
    /// Uplift counts the motion at right angles to the front, and only above this, mm/yr (*ours*; 0: the whole relative
    /// speed of converging plates, as printed).
    pub least_closing: f64,
    /// Farthest turn of a plate's axis by slab pull, degrees per My (ε, *ours*).
    pub slab_pull_deg: f64,
    /// Time in which a free plate takes the speed that its slabs and its continents give it, My (*ours*; infinite: plates
    /// keep their speed, as in the paper).
    pub speed_relaxation_my: f64,
    /// Speed that a plate without slabs comes to, mm/yr; continents take up to half of it off, the sea adds a fifth (*ours*).
    pub free_speed: f64,
    /// What is added for a border that plunges all around, less on continents, mm/yr (*ours*).
    pub slab_speed: f64,
    /// Share of the border beyond which more slab is of no matter (*ours*).
    pub slab_share: f64,
    /// How much of a fold's direction a motion of 1 km makes, 1/km (β, *ours*).
    pub folding: f64,
    /// Land that rises more slowly than this is not a mountain belt, mm/yr (*ours*).
    pub least_orogeny: f64,
    /// Overlap of two continents at which they collide, km (section 6).
    pub collision_overlap_km: f64,
    /// Farthest influence of a collision, km (`r_c`).
    pub collision_km: f64,
    /// Upper limit of that influence, km (*ours*; the paper: `r_c`).
    pub collision_limit_km: f64,
    /// Law of that influence.
    pub reach: Reach,
    /// Collision coefficient, 1/km (`Δ_c`).
    pub collision: f64,
    /// Height that the surge of a collision approaches, km (*ours*).
    pub collision_summit_km: f64,
    /// Share of its plate above which a colliding terrane takes the whole plate with it (*ours*).
    pub merge_share: f64,
    /// Terranes below this area give way to an oceanic plate; greater ones turn the front around, Mkm² (*ours*).
    pub terrane_mkm2: f64,
    /// Law of the sea floor.
    pub sea_floor: SeaFloor,
    /// Oceanic damping, mm/yr (`ε_o`).
    pub damping: f64,
    /// Erosion of continents of the greatest height, mm/yr (`ε_c`).
    pub erosion: f64,
    /// What is added to it at 5 km height, growing with the square of the height, mm/yr (*ours*).
    pub erosion_5km: f64,
    /// Filling of trenches with sediment, mm/yr (`ε_t`).
    pub sediment: f64,
    /// Depth of a trench below its surroundings, km (*ours*). 0: trenches are what damping and sediment make of them.
    pub trench_cut_km: f64,
    /// Speed of closing at which a trench has its full depth, mm/yr (*ours*).
    pub trench_speed: f64,
    /// Time in which a margin without mountains sinks below the sea, My (*ours*; infinite in the paper).
    pub margin_my: f64,
    /// Steps between two generations of sea floor (the paper: 10–60).
    pub spread_steps: u32,
    /// Mean number of rifts of a plate of mean size in a step (λ₀).
    pub rifts: f64,
    /// Least share of continent that counts for rifting (*ours*).
    pub least_rift_share: f64,
    /// Speed at which the parts of a torn plate leave each other, mm/yr (*ours*).
    pub rift_speed: f64,
    /// Time for which a front keeps its polarity in any case, My (*ours*).
    pub polarity_my: f64,
    /// Difference of age that turns a front around after that, My (*ours*).
    pub polarity_age_my: f64,
    /// Plates below this share of the sphere join a neighbour (*ours*).
    pub least_plate: f64,
    /// Enclosed oceans below this area fill with sediment, Mkm² (*ours*; 0: never).
    pub basin_mkm2: f64,
    /// Hot spots of the mantle (an addition; none in the paper).
    pub hot_spots: u32,
    /// Growth of a volcano over a hot spot, mm/yr (*ours*).
    pub hot_spot_growth: f64,
}

impl GlobeParams {
    /// Appendix A as printed, with the readings that it leaves open. It does not make a planet that looks like one; it is
    /// there for comparison.
    pub fn paper() -> Self {
        Self {
            dt_my: 2.0,
            max_speed: 100.0,
            ridge_km: -1.0,
            abyss_km: -6.0,
            trench_km: -10.0,
            summit_km: 10.0,
            subduction_km: 1800.0,
            arc_km: 1800.0,
            uplift_peak: 0.15,
            uplift_at_front: 0.5,
            height_power: 2.0,
            uplift: 0.6,
            arc_factor: 1.0,
            uplift_limit_km: 10.0,
            uplift_noise: 0.0,
            emergence_km: 0.0,
            least_closing: 0.0,
            slab_pull_deg: 0.3,
            speed_relaxation_my: f64::INFINITY,
            free_speed: 22.0,
            slab_speed: 95.0,
            slab_share: 0.6,
            folding: 0.01,
            least_orogeny: 0.015,
            collision_overlap_km: 300.0,
            collision_km: 4200.0,
            collision_limit_km: 4200.0,
            reach: Reach::Root,
            collision: 1.3e-5,
            collision_summit_km: 6.0,
            merge_share: 0.7,
            terrane_mkm2: 0.6,
            sea_floor: SeaFloor::Damping,
            damping: 0.04,
            erosion: 0.03,
            erosion_5km: 0.0,
            sediment: 0.3,
            trench_cut_km: 0.0,
            trench_speed: 40.0,
            margin_my: f64::INFINITY,
            spread_steps: 10,
            rifts: 0.01,
            least_rift_share: 0.0,
            rift_speed: 30.0,
            polarity_my: 20.0,
            polarity_age_my: 15.0,
            least_plate: 0.000_5,
            basin_mkm2: 0.0,
            hot_spots: 0,
            hot_spot_growth: 0.0,
        }
    }

    /// What makes a planet: narrower belts, plate cooling, collisions that saturate, plates driven by their slabs.
    pub fn planet() -> Self {
        Self {
            subduction_km: 480.0,
            arc_km: 400.0,
            uplift_peak: 0.28,
            uplift_at_front: 0.4,
            height_power: 1.0,
            uplift: 0.55,
            arc_factor: 1.2,
            uplift_limit_km: 6.5,
            uplift_noise: 0.7,
            emergence_km: 0.2,
            least_closing: 2.0,
            speed_relaxation_my: 40.0,
            collision_km: 1500.0,
            collision_limit_km: 600.0,
            collision: 4.5e-6,
            collision_summit_km: 5.0,
            sea_floor: SeaFloor::Gdh1,
            erosion: 0.08,
            erosion_5km: 0.16,
            trench_cut_km: 3.0,
            margin_my: 60.0,
            spread_steps: 1,
            rifts: 0.014,
            least_rift_share: 0.15,
            polarity_age_my: 40.0,
            least_plate: 0.001_5,
            basin_mkm2: 0.3,
            hot_spots: 12,
            hot_spot_growth: 0.4,
            ..Self::paper()
        }
    }
}

impl Default for GlobeParams {
    fn default() -> Self {
        Self::planet()
    }
}

/// Depth of sea floor of an age, km (GDH1, Stein and Stein 1992), My.
pub fn gdh1_km(age_my: f64) -> f64 {
    let age = age_my.max(0.0);
    if age < 20.0 {
        2.6 + 0.365 * age.sqrt()
    } else {
        5.651 - 2.473 * (-0.0278 * age).exp()
    }
}
