use proptest::prelude::*;

use super::*;
use crate::material::{LayerNoise, MaterialLayer, MaterialSet, Surface};

fn ground(height_m: f32, slope_degrees: f32) -> Ground {
    Ground { height_m, slope_tangent: slope_degrees.to_radians().tan(), curvature: 0.0 }
}

/// Soil; grass up to 300 m and 35 degrees; rock from 35 degrees; snow from half way up, in patches.
fn set(contrast: f64) -> MaterialSet {
    let layer = |name: &str, surface| MaterialLayer::new(name, surface);
    let mut set = MaterialSet::new(
        "Test",
        vec![
            layer("soil", Surface::Soil),
            MaterialLayer {
                height_m: Some([None, Some(300.0)]),
                height_fade_m: 50.0,
                slope_degrees: Some([None, Some(35.0)]),
                ..layer("grass", Surface::Grass)
            },
            MaterialLayer { slope_degrees: Some([Some(35.0), None]), ..layer("rock", Surface::Rock) },
            MaterialLayer {
                height_share: Some([Some(0.5), None]),
                height_fade_share: 0.2,
                slope_degrees: Some([None, Some(50.0)]),
                curvature: Some([None, Some(0.1)]),
                noise: Some(LayerNoise { feature_m: 20.0, amount: 0.6, coverage: 0.7, seed: 1 }),
                mask: Some("snow".to_owned()),
                ..layer("snow", Surface::Snow)
            },
        ],
    );
    set.blend_contrast = contrast;
    set
}

fn weights_of(set: &MaterialSet, ground: Ground, inputs: &[LayerInput]) -> [f32; MAX_LAYERS] {
    let resolved = set.resolved(0.0, 1000.0).unwrap();
    weights(&resolved.layers, &resolved.set, ground, inputs)
}

#[test]
fn on_a_limit_a_layer_has_half_its_weight() {
    let set = set(0.0);
    let [soil, grass, ..] = weights_of(&set, ground(300.0, 0.0), &[]);
    assert!((soil - 0.5).abs() < 1.0e-3 && (grass - 0.5).abs() < 1.0e-3, "{soil} {grass}");
    let [soil, grass, ..] = weights_of(&set, ground(274.9, 0.0), &[]);
    assert!(soil < 1.0e-3 && grass > 0.999, "{soil} {grass}");
    let [_, grass, rock, ..] = weights_of(&set, ground(0.0, 35.0), &[]);
    // Degrees fade a little unevenly as tangents.
    assert!((rock - 0.5).abs() < 0.06 && grass < 0.3, "{grass} {rock}");
}

#[test]
fn the_last_layer_has_priority() {
    let mut set = set(0.0);
    let high = ground(900.0, 0.0);
    let bare = LayerInput { noise: 1.0, ..LayerInput::default() };
    let [soil, grass, rock, snow, ..] = weights_of(&set, high, &[bare; 4]);
    assert_eq!([soil, grass, rock, snow], [0.0, 0.0, 0.0, 1.0]);
    // Rock over all of it, after snow.
    set.layers.push(MaterialLayer { strength: 0.25, ..MaterialLayer::new("ash", Surface::Basalt) });
    let [.., snow, ash] = *weights_of(&set, high, &[bare; 5]).first_chunk::<5>().unwrap();
    assert_eq!([snow, ash], [0.75, 0.25]);
}

#[test]
fn a_mask_and_a_patch_take_a_layer_away() {
    let set = set(1.0);
    let high = ground(900.0, 0.0);
    let masked = LayerInput { noise: 1.0, mask: 0.0, texture_height: 1.0 };
    let beside_patches = LayerInput { noise: -0.9, ..LayerInput::default() };
    for input in [masked, beside_patches] {
        assert_eq!(weights_of(&set, high, &[input; 4])[3], 0.0);
    }
    assert_eq!(set.resolved(0.0, 1.0).unwrap().masks, ["snow"]);
}

#[test]
fn high_relief_reaches_through_low_one() {
    // Half grass, half soil.
    let border = ground(300.0, 0.0);
    let input = |texture_height| LayerInput { texture_height, ..LayerInput::default() };
    let inputs = [input(0.9), input(0.1), input(0.5), input(0.5)];
    assert!(weights_of(&set(1.0), border, &inputs)[0] > 0.99);
    assert!((weights_of(&set(0.0), border, &inputs)[0] - 0.5).abs() < 1.0e-3);
    let inputs = [input(0.1), input(0.9), input(0.5), input(0.5)];
    assert!(weights_of(&set(1.0), border, &inputs)[1] > 0.99);
    // Alike, they change nothing.
    let inputs = [input(0.3); 4];
    let nearly_grass = ground(290.0, 0.0);
    let (plain, blended) =
        (weights_of(&set(0.0), nearly_grass, &inputs), weights_of(&set(1.0), nearly_grass, &inputs));
    for (plain, blended) in plain.iter().zip(blended) {
        assert!((plain - blended).abs() < 1.0e-5, "{plain} {blended}");
    }
}

#[test]
fn shares_follow_the_terrain_and_a_level_one_has_its_lowest_ground() {
    let set = set(0.0);
    let middle = |low_m: f32, high_m: f32, height_m: f32| {
        let resolved = set.resolved(low_m, high_m).unwrap();
        let inputs = [LayerInput { noise: 0.0, ..LayerInput::default() }; 4];
        resolved.layers[3].cover(ground(height_m, 0.0), inputs[3])
    };
    assert!((middle(-100.0, 300.0, 100.0) - middle(0.0, 8000.0, 4000.0)).abs() < 1.0e-4);
    assert_eq!(middle(5.0, 5.0, 5.0), 0.0);
    for (low_m, high_m) in [(1.0, 0.0), (f32::NAN, 1.0), (0.0, f32::INFINITY)] {
        let err = set.resolved(low_m, high_m).unwrap_err().to_string();
        assert!(err.contains(&format!("{low_m}")) && err.contains(&format!("{high_m}")), "{err}");
    }
}

#[test]
fn rules_are_laid_out_as_groups_of_four() {
    assert_eq!((size_of::<LayerRule>(), align_of::<LayerRule>()), (96, 4));
    assert_eq!(size_of::<SetRule>(), 16);
    assert_eq!(std::mem::offset_of!(LayerRule, ids), 80);
}

fn any_input() -> impl Strategy<Value = LayerInput> {
    (-1.0_f32..1.0, 0.0_f32..1.0, 0.0_f32..1.0).prop_map(|(noise, mask, texture_height)| LayerInput {
        noise,
        mask,
        texture_height,
    })
}

fn any_ground() -> impl Strategy<Value = Ground> {
    (-200.0_f32..1200.0, 0.0_f32..80.0, -0.3_f32..0.3)
        .prop_map(|(height_m, degrees, curvature)| Ground { curvature, ..ground(height_m, degrees) })
}

proptest! {
    #[test]
    fn weights_are_shares(
        place in any_ground(), inputs in prop::collection::vec(any_input(), 4), contrast in 0.0_f64..=1.0,
    ) {
        let resolved = set(contrast).resolved(0.0, 1000.0).unwrap();
        let weights = weights(&resolved.layers, &resolved.set, place, &inputs);
        prop_assert!(weights.iter().all(|weight| (0.0..=1.0 + 1.0e-6).contains(weight)), "{:?}", weights);
        prop_assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1.0e-6, "{:?}", weights);
        for (index, rule) in resolved.layers.iter().enumerate().skip(1) {
            if rule.cover(place, inputs[index]) == 0.0 {
                prop_assert_eq!(weights[index], 0.0);
            }
        }
    }

    #[test]
    fn small_changes_change_weights_little(
        place in any_ground(), inputs in prop::collection::vec(any_input(), 4), contrast in 0.0_f64..=1.0,
        which in 0_usize..6,
    ) {
        let (mut moved, mut moved_inputs) = (place, inputs.clone());
        match which {
            0 => moved.height_m += 0.01,
            1 => moved.slope_tangent += 1.0e-5,
            2 => moved.curvature += 1.0e-6,
            3 => for input in &mut moved_inputs { input.noise += 1.0e-4 },
            4 => for input in &mut moved_inputs { input.mask += 1.0e-4 },
            _ => for input in &mut moved_inputs { input.texture_height += 1.0e-4 },
        }
        let set = set(contrast);
        let (before, after) = (weights_of(&set, place, &inputs), weights_of(&set, moved, &moved_inputs));
        for (before, after) in before.iter().zip(after) {
            prop_assert!((before - after).abs() < 0.02, "{} {}", before, after);
        }
    }

    /// The case in which a blend that looks for the highest layer jumps: two layers side by side, and a third that begins, with high relief.
    #[test]
    fn a_layer_that_begins_does_not_jump(cover in 0.0_f64..1.0, relief in 0.0_f32..1.0, start in 0.0_f32..1.0e-3) {
        let mut set = MaterialSet::new("Test", vec![
            MaterialLayer::new("a", Surface::Soil),
            MaterialLayer { strength: cover, ..MaterialLayer::new("b", Surface::Grass) },
            MaterialLayer::new("c", Surface::Rock),
        ]);
        set.blend_contrast = 1.0;
        let input = |texture_height, mask| LayerInput { texture_height, mask, noise: 0.0 };
        let at = |mask| weights_of(&set, ground(0.0, 0.0), &[input(0.0, 1.0), input(relief, 1.0), input(1.0, mask)]);
        for (before, after) in at(0.0).iter().zip(at(start)) {
            prop_assert!((before - after).abs() < 0.03, "{} {}", before, after);
        }
    }
}
