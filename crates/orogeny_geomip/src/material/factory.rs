//! The sets that ship with the program.

use super::MaterialSet;
use crate::{Error, Result};

/// The set for terrain that nobody chose one for.
pub const DEFAULT_FACTORY_SET: &str = "alpine";

/// Each file of `material-sets`; a test holds the list against the folder.
macro_rules! files {
    ($($name:literal),+ $(,)?) => {
        [$(($name, include_str!(concat!("../../material-sets/", $name, ".json")))),+]
    };
}

const FILES: [(&str, &str); 4] = files!["alpine", "arctic", "desert", "volcanic"];

/// The names of the sets that ship with the program.
pub fn factory_sets() -> impl Iterator<Item = &'static str> {
    FILES.into_iter().map(|(name, _)| name)
}

/// A set that ships with the program, by its name in [`factory_sets`].
///
/// # Errors
/// [`Error::UnknownFactorySet`], with the names that there are.
pub fn factory_set(name: &str) -> Result<MaterialSet> {
    match FILES.into_iter().find(|(known, _)| *known == name) {
        Some((_, text)) => MaterialSet::from_json(text),
        None => {
            let known = FILES.map(|(known, _)| known).join(", ");
            Err(Error::UnknownFactorySet { name: name.to_owned(), known })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Ground, LayerInput, LayerSurface, weights};
    use super::*;

    #[test]
    fn the_list_is_the_folder() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("material-sets");
        let mut files: Vec<_> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap().replace(".json", ""))
            .collect();
        files.sort();
        assert_eq!(FILES.map(|(name, _)| name).as_slice(), files);
    }

    #[test]
    fn all_of_them_can_be_used_on_any_terrain() {
        for name in factory_sets() {
            let set = factory_set(name).unwrap_or_else(|err| panic!("{name}: {err}"));
            let least = if name == DEFAULT_FACTORY_SET { 8 } else { 6 };
            assert!(set.layers.len() >= least && !set.description.is_empty(), "{name}");
            for layer in &set.layers {
                assert_eq!(layer.height_m, None, "{name}, {}: metres fit one terrain only", layer.name);
                assert!(matches!(layer.surface, LayerSurface::Procedural(_)), "{name}: there are no files");
            }
            assert_eq!(MaterialSet::from_json(&set.to_json().unwrap()).unwrap(), set);
            set.resolved(-50.0, 4000.0).unwrap();
        }
        let err = factory_set("lunar").unwrap_err().to_string();
        assert!(err.contains("lunar") && err.contains("alpine"), "{err}");
    }

    /// Every layer shows somewhere: on some ground it is what is seen most.
    #[test]
    fn no_layer_is_hidden_everywhere() {
        for name in factory_sets() {
            let set = factory_set(name).unwrap();
            let resolved = set.resolved(0.0, 1000.0).unwrap();
            let mut seen = vec![false; set.layers.len()];
            for height in 0..=20 {
                for degrees in 0..17 {
                    for curvature in [-0.2, -0.02, 0.0, 0.02, 0.2] {
                        for which in 0..1_u32 << 6 {
                            let noise = |layer: usize| if which >> (layer % 6) & 1 == 1 { 0.9 } else { -0.9 };
                            let inputs: Vec<_> = (0..seen.len())
                                .map(|layer| LayerInput { noise: noise(layer), ..LayerInput::default() })
                                .collect();
                            let ground = Ground {
                                height_m: height as f32 * 50.0,
                                slope_tangent: (degrees as f32 * 5.0).to_radians().tan(),
                                curvature,
                            };
                            let weights = weights(&resolved.layers, &resolved.set, ground, &inputs);
                            for (seen, weight) in seen.iter_mut().zip(weights) {
                                *seen |= weight > 0.5;
                            }
                        }
                    }
                }
            }
            for (seen, layer) in seen.iter().zip(&set.layers) {
                assert!(seen, "{name}: {}", layer.name);
            }
        }
    }

    fn shown(name: &str, height_m: f32, degrees: f32) -> String {
        let set = factory_set(name).unwrap();
        let resolved = set.resolved(0.0, 1000.0).unwrap();
        let ground = Ground { height_m, slope_tangent: degrees.to_radians().tan(), curvature: 0.0 };
        let weights = weights(&resolved.layers, &resolved.set, ground, &[]);
        let best = (0..set.layers.len()).max_by(|a, b| weights[*a].total_cmp(&weights[*b])).unwrap();
        set.layers[best].name.clone()
    }

    #[test]
    fn grounds_are_what_one_expects() {
        for (name, height_m, degrees, layer) in [
            ("alpine", 950.0, 10.0, "snow"),
            ("alpine", 950.0, 75.0, "cliff"),
            ("alpine", 400.0, 75.0, "cliff"),
            ("alpine", 400.0, 47.0, "rock"),
            ("alpine", 5.0, 1.0, "gravel"),
            ("arctic", 500.0, 5.0, "snow"),
            ("desert", 300.0, 5.0, "sand"),
            ("desert", 700.0, 70.0, "cliff"),
            ("volcanic", 800.0, 20.0, "basalt"),
        ] {
            assert_eq!(shown(name, height_m, degrees), layer, "{name} {height_m} m {degrees} degrees");
        }
    }
}
