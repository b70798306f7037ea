//! The pile of layers as it was laid down.

use super::file::StratigraphyError;

/// Most layers over the basement (Cordonnier et al. 2018, Table 2).
pub const MAX_LAYERS: usize = 10;

/// Most beds of a layer.
pub const MAX_BEDS: u8 = 10;

/// Most characters of a name.
pub(super) const MAX_NAME: usize = 64;

/// How much a bed's talus differs from its layer's at full contrast, degrees: the paper's weak rock stands at 30°, its
/// hard rock at 50°.
const TALUS_SPREAD_DEG: f64 = 10.0;

/// A colour as it is seen: sRGB, 0–255 each.
pub type Colour = [u8; 3];

/// What erosion and pictures need to know of a rock.
#[derive(Clone, Debug, PartialEq)]
pub struct Rock {
    /// Factor on the erosion constant k. 1 is average; limestone and gneiss less, marl and salt more.
    pub erodibility: f64,
    /// Steepest slope that stands, degrees. Weak rock 30, hard rock 50 (the paper's range).
    pub talus_deg: f64,
    /// Its colour on geological maps.
    pub colour: Colour,
    /// Its colour in the light, on a cliff.
    pub stone: Colour,
}

/// A layer of the pile. The range of each number is in [`bounds`].
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// What people call it.
    pub name: String,
    /// Thickness τ before folding, metres.
    pub thickness_m: f64,
    /// Viscosity μ, Pa s; only ratios between neighbours matter (Eq. 3).
    pub viscosity_pa_s: f64,
    /// What it is made of, on average over its beds.
    pub rock: Rock,
    /// Beds of equal thickness, 1 to [`MAX_BEDS`]; hard and weak ones alternate, the topmost is hard.
    pub beds: u8,
    /// How much hard and weak beds differ, 0–1.
    pub contrast: f64,
    /// Folding speed σ of this layer over the next one, as a part of the uplift; 0 does not fold.
    pub fold: f64,
    /// Wavelength of those folds, metres; `None`: Eq. 3.
    pub wavelength_m: Option<f64>,
}

/// What lies under all layers, down to the Moho.
#[derive(Clone, Debug, PartialEq)]
pub struct Basement {
    /// Part of the uplift that raises the pile as a whole. 1: the basement thickens with its cover (a thick-skinned
    /// range); less: the cover glides on a weak layer and folds, while the basement stays behind (thin-skinned).
    pub uplift: f64,
    /// What people call it.
    pub name: String,
    /// Viscosity, Pa s.
    pub viscosity_pa_s: f64,
    /// What it is made of.
    pub rock: Rock,
}

/// Range of a number of a layer: validates files and drives controls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Key in the file.
    pub key: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
}

impl Bound {
    /// True for values within the range; never for NaN.
    pub fn holds(&self, value: f64) -> bool {
        (self.min..=self.max).contains(&value)
    }
}

/// Ranges of the numbers of layers and rocks. Thickness, viscosity and wavelength: the paper's Table 2, with viscosities
/// in Pa s as rocks have them.
pub mod bounds {
    use super::Bound;

    /// Thickness of a layer.
    pub const THICKNESS: Bound = bound("thickness_m", "m", 100.0, 5000.0);
    /// Viscosity.
    pub const VISCOSITY: Bound = bound("viscosity_pa_s", "Pa s", 1e16, 1e24);
    /// Factor on the erosion constant.
    pub const ERODIBILITY: Bound = bound("erodibility", "", 0.05, 10.0);
    /// Talus angle.
    pub const TALUS: Bound = bound("talus_deg", "degrees", 15.0, 70.0);
    /// Difference between hard and weak beds.
    pub const CONTRAST: Bound = bound("contrast", "", 0.0, 1.0);
    /// Folding speed as a part of the uplift. The paper: 0.01–0.5.
    pub const FOLD: Bound = bound("fold", "", 0.0, 1.0);
    /// Part of the uplift that raises the pile as a whole.
    pub const UPLIFT: Bound = bound("uplift", "", 0.05, 2.0);
    /// Wavelength of folds.
    pub const WAVELENGTH: Bound = bound("wavelength_m", "m", 500.0, 20_000.0);

    const fn bound(key: &'static str, unit: &'static str, min: f64, max: f64) -> Bound {
        Bound { key, unit, min, max }
    }
}

/// A place in the pile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Layer, 0 the topmost; the number of layers is the basement.
    pub layer: usize,
    /// Bed of that layer from its top; 0 in the basement.
    pub bed: u8,
}

impl Place {
    /// Hard beds are the first, third, … of a layer.
    pub fn is_hard(self) -> bool {
        self.bed.is_multiple_of(2)
    }
}

/// How a bed stands up to erosion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BedRock {
    /// Factor on the erosion constant.
    pub erodibility: f64,
    /// Talus slope tan θ.
    pub talus: f64,
}

/// Layers over a basement, topmost first. Interface `i` is the top of layer `i`; interface 0 is the first surface, the
/// last one the top of the basement.
#[derive(Clone, Debug, PartialEq)]
pub struct Stratigraphy {
    name: String,
    title: String,
    layers: Vec<Layer>,
    basement: Basement,
    /// Depth of each interface, metres.
    depths: Vec<f64>,
    /// How each bed stands up to erosion, layer after layer; the basement last.
    beds: Vec<BedRock>,
    /// Where each layer's beds begin in `beds`.
    first_bed: Vec<usize>,
}

impl Stratigraphy {
    /// A pile of `layers` (topmost first) over `basement`. `name` is what gesture files and settings call it, `title`
    /// what people do.
    ///
    /// # Errors
    /// The first number outside its range, a name that is empty or too long, or too many layers.
    pub fn new(
        name: impl Into<String>,
        title: impl Into<String>,
        layers: Vec<Layer>,
        basement: Basement,
    ) -> Result<Self, StratigraphyError> {
        let (name, title) = (name.into(), title.into());
        super::file::check(&name, &title, &layers, &basement)?;
        let mut depths = vec![0.0];
        let (mut beds, mut first_bed) = (Vec::new(), Vec::new());
        for layer in &layers {
            depths.push(depths.last().copied().unwrap_or(0.0) + layer.thickness_m);
            first_bed.push(beds.len());
            beds.extend((0..layer.beds).map(|bed| {
                let contrast = if layer.beds > 1 { layer.contrast } else { 0.0 };
                let hard = bed.is_multiple_of(2);
                let factor = 1.0 + contrast;
                let (erodibility, talus_deg) = if hard {
                    (
                        layer.rock.erodibility / factor,
                        layer.rock.talus_deg + TALUS_SPREAD_DEG * contrast,
                    )
                } else {
                    (
                        layer.rock.erodibility * factor,
                        layer.rock.talus_deg - TALUS_SPREAD_DEG * contrast,
                    )
                };
                bed_rock(erodibility, talus_deg)
            }));
        }
        first_bed.push(beds.len());
        beds.push(bed_rock(basement.rock.erodibility, basement.rock.talus_deg));
        Ok(Self {
            name,
            title,
            layers,
            basement,
            depths,
            beds,
            first_bed,
        })
    }

    /// What gesture files and settings call it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What people call it.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// The layers, topmost first.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// What lies under them.
    pub fn basement(&self) -> &Basement {
        &self.basement
    }

    /// Depth of each interface before folding, metres: 0 first, the top of the basement last.
    pub fn depths(&self) -> &[f64] {
        &self.depths
    }

    /// Which bed lies at a depth before folding, metres. Above the top the topmost bed goes on, below the last layer the
    /// basement.
    pub fn place(&self, depth: f64) -> Place {
        let layer = self.depths[1..]
            .iter()
            .take_while(|&&bottom| depth >= bottom)
            .count();
        let Some(found) = self.layers.get(layer) else {
            return Place { layer, bed: 0 };
        };
        let part = (depth - self.depths[layer]) / found.thickness_m;
        let bed = (part * f64::from(found.beds)).clamp(0.0, f64::from(found.beds - 1));
        Place {
            layer,
            bed: bed as u8,
        }
    }

    /// How the bed at a place stands up to erosion.
    pub fn bed_rock(&self, place: Place) -> BedRock {
        self.beds[self.first_bed[place.layer] + usize::from(place.bed)]
    }

    /// Beds above a layer, or above the basement.
    pub(super) fn first_bed(&self, layer: usize) -> usize {
        self.first_bed[layer]
    }

    /// Name of a layer, or of the basement.
    pub fn layer_name(&self, layer: usize) -> &str {
        self.layers
            .get(layer)
            .map_or(&self.basement.name, |layer| &layer.name)
    }

    /// What a layer, or the basement, is made of on average.
    pub fn rock(&self, layer: usize) -> &Rock {
        self.layers
            .get(layer)
            .map_or(&self.basement.rock, |layer| &layer.rock)
    }

    /// Interfaces at which the layer above folds over the one below: it does so where it is the stiffer one, and asks
    /// for it.
    pub fn folding(&self) -> impl Iterator<Item = usize> {
        (1..=self.layers.len()).filter(|&interface| {
            let above = &self.layers[interface - 1];
            let below = self
                .layers
                .get(interface)
                .map_or(self.basement.viscosity_pa_s, |layer| layer.viscosity_pa_s);
            above.fold > 0.0 && above.viscosity_pa_s > below
        })
    }
}

fn bed_rock(erodibility: f64, talus_deg: f64) -> BedRock {
    BedRock {
        erodibility,
        talus: talus_deg.to_radians().tan(),
    }
}
