//! Which bed crops out at a depth, as painters of cliffs need it.

use super::stratigraphy::Stratigraphy;

/// The bed at a depth before folding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bedding {
    /// Layer, 0 the topmost; the number of layers is the basement.
    pub layer: usize,
    /// Number of the bed in the whole pile, 0 the topmost.
    pub bed: usize,
    /// How much harder than its layer the bed is: −1 weak to 1 hard, 0 where beds do not differ.
    pub hardness: f64,
    /// Way from the bed's top, as a part of its thickness, 0 to 1. 0 in the basement, which has no beds.
    pub part: f64,
    /// Thickness of the bed, metres; 0 in the basement, which has no end.
    pub thickness_m: f64,
}

impl Stratigraphy {
    /// The bed at a depth before folding, metres. Above the top the topmost bed's upper edge goes on, below the last
    /// layer the basement.
    pub fn bedding(&self, depth: f64) -> Bedding {
        let place = self.place(depth);
        let bed = usize::from(place.bed) + self.first_bed(place.layer);
        let Some(layer) = self.layers().get(place.layer) else {
            return Bedding {
                layer: place.layer,
                bed,
                hardness: 0.0,
                part: 0.0,
                thickness_m: 0.0,
            };
        };
        let thickness_m = layer.thickness_m / f64::from(layer.beds);
        let top = self.depths()[place.layer] + f64::from(place.bed) * thickness_m;
        let hardness = match (layer.beds, place.is_hard()) {
            (..=1, _) => 0.0,
            (_, true) => layer.contrast,
            (_, false) => -layer.contrast,
        };
        Bedding {
            layer: place.layer,
            bed,
            hardness,
            part: ((depth - top) / thickness_m).clamp(0.0, 1.0),
            thickness_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::preset;

    #[test]
    fn beds_follow_each_other_down_the_pile() {
        let pile = preset::by_name("digne").unwrap();
        // Conglomerate: four beds of 150 m, the first and third hard.
        let second = pile.bedding(225.0);
        assert_eq!((second.layer, second.bed), (0, 1));
        assert_eq!(second.thickness_m, 150.0);
        assert!((second.part - 0.5).abs() < 1e-12);
        assert_eq!(second.hardness, -0.7);
        assert_eq!(pile.bedding(310.0).hardness, 0.7);
        // The molasse below begins with its own first bed, the fifth of the pile.
        let molasse = pile.bedding(601.0);
        assert_eq!((molasse.layer, molasse.bed, molasse.hardness), (1, 4, 0.8));
    }

    #[test]
    fn above_the_pile_its_top_goes_on_and_below_it_the_basement() {
        let pile = preset::default();
        let above = pile.bedding(-500.0);
        assert_eq!((above.layer, above.part), (0, 0.0));
        let below = pile.bedding(1e5);
        assert_eq!(below.layer, pile.layers().len());
        assert_eq!((below.hardness, below.thickness_m), (0.0, 0.0));
    }
}
