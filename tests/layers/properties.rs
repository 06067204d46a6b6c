//! What must be the same whichever way it comes about.

use orogeny_engine::{ExportSource, LayerReference};
use orogeny_field::LayerContent;
use orogeny_tests::Plane;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use serde_json::{Value, json};

use crate::random::Maker;
use crate::support::{
    Site, assert_all_same, assert_differs, assert_near, assert_same, composite, fill, name, noise, range_m,
    read,
};

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        rng_seed: RngSeed::Fixed(0x0ca5_e5ed),
        failure_persistence: None,
        cases,
        ..ProptestConfig::default()
    }
}

/// A small terrain with a random stack of some layers.
fn site(seed: u64) -> (Site, Maker) {
    let mut site = Site::new([150, 97], 25.0, 64);
    let mut maker = Maker::new(seed, &site.terrain.grid());
    maker.makes_kept = true;
    site.apply(&[json!({"op": "fill", "layer": "Base", "brush": maker.noise(150.0)})]);
    for number in 0..4 {
        let add = if number == 1 { maker.add_group(&site.layers()) } else { maker.add(&site.layers()) };
        site.apply(&[add]);
        let top = site.layers().into_iter().max_by_key(|layer| layer.id).unwrap();
        if top.content == LayerContent::Heights && top.transform.is_identity() {
            site.apply(&[maker.paint(&top)]);
        }
        let is_moved = top.content == LayerContent::Heights && !top.transform.is_identity();
        if !is_moved && maker.chance(0.5) {
            site.apply(&[maker.paint_mask(&top, "mask"), maker.paint_mask(&top, "selection")]);
        }
    }
    (site, maker)
}

/// A layer over a random stack, by what it is to have.
fn added(site: &mut Site, maker: &mut Maker, with: &[(&str, Value)]) -> Value {
    let mut add = maker.add(&site.layers());
    for (field, value) in with {
        add[*field] = value.clone();
    }
    for gone in ["above", "group"] {
        add.as_object_mut().unwrap().remove(gone);
    }
    site.apply_one(&add);
    add
}

fn set(layer: &Value, field: &str, value: Value) -> Value {
    json!({"op": "set_layer", "layer": layer["name"], field: value})
}

proptest! {
    #![proptest_config(config(10))]

    #[test]
    fn what_does_not_count_is_as_if_it_were_not_there(seed: u64, opacity in 0.01_f32..1.0) {
        let (mut site, mut maker) = site(seed);
        let before = site.composites();
        let add = added(&mut site, &mut maker, &[("opacity", json!(0)), ("visible", json!(true))]);
        assert_all_same(&before, &site.composites(), &format!("{add}"));
        site.apply(&[set(&add, "visible", json!(false)), set(&add, "opacity", json!(opacity))]);
        assert_all_same(&before, &site.composites(), &format!("{add}, hidden"));
        site.apply(&[set(&add, "visible", json!(true)), json!({"op": "set_mask", "layer": add["name"], "from": "nothing", "terms": []})]);
        assert_all_same(&before, &site.composites(), &format!("{add}, masked"));
        // In a hidden group, and in one without opacity.
        let layers = site.layers();
        let below = &layers[layers.len() - 2].name;
        site.apply(&[
            json!({"op": "add_layer", "name": "Hides", "content": {"type": "group"}, "visible": false}),
            json!({"op": "set_mask", "layer": add["name"], "from": "all"}),
            json!({"op": "move_layer", "layer": add["name"], "above": below, "group": "Hides"}),
        ]);
        assert_all_same(&before, &site.composites(), &format!("{add}, in a hidden group"));
        site.apply(&[json!({"op": "set_layer", "layer": "Hides", "visible": true, "opacity": 0})]);
        assert_all_same(&before, &site.composites(), &format!("{add}, in a group that does not count"));
        site.apply(&[json!({"op": "remove_layer", "layer": "Hides", "members": true})]);
        assert_all_same(&before, &site.composites(), &format!("{add}, removed"));
    }

    #[test]
    fn what_replaces_with_its_whole_weight_is_what_is_seen(seed: u64) {
        let (mut site, mut maker) = site(seed);
        let with = [("opacity", json!(1)), ("visible", json!(true)), ("blend", json!("replace")), ("mask", json!([]))];
        let add = added(&mut site, &mut maker, &with);
        let layer = site.layers().into_iter().find(|layer| layer.name == add["name"]).unwrap();
        for level in 0..=site.top_level() {
            let alone = read(&site.terrain, &ExportSource::Layer(LayerReference::Id(layer.id)), None, level);
            if !layer.content.is_kept() {
                assert_same(&alone, &composite(&site.terrain, level), &format!("{add} at level {level}"));
            }
            let mask = read(&site.terrain, &ExportSource::Mask(LayerReference::Id(layer.id)), None, level);
            prop_assert!(mask.samples().iter().all(|weight| *weight == 1.0));
        }
    }

    #[test]
    fn there_and_back_changes_nothing(seed: u64) {
        let (mut site, mut maker) = site(seed);
        let (layers, before) = (site.layers(), site.composites());
        let place = maker.random.bits() as usize % layers.len();
        let layer = &layers[place];
        let mut there = maker.move_layer(layer, &layers);
        there["group"] = json!(layer.group);
        let moved = site.try_to(&there).is_ok();
        site.composites();
        // Members of a group move with it: all go back one by one, from the bottom. Where groups lie does not matter.
        if moved {
            let mut below = None;
            for layer in layers.iter().filter(|layer| layer.content != LayerContent::Group) {
                site.apply(&[json!({"op": "move_layer", "layer": layer.id, "above": below, "group": layer.group})]);
                below = Some(layer.id);
            }
            assert_all_same(&before, &site.composites(), &format!("{there} and back"));
        }
        if layer.content != LayerContent::Group {
            let copy = json!({"op": "duplicate_layer", "layer": layer.id, "name": "Copy"});
            site.apply(&[copy]);
            site.composites();
            site.apply(&[json!({"op": "remove_layer", "layer": "Copy"})]);
            assert_all_same(&before, &site.composites(), &format!("{} copied, and the copy removed", layer.name));
        }
        site.apply(&[json!({"op": "set_layer", "layer": layer.id, "name": "Renamed", "locked": true})]);
        assert_all_same(&before, &site.composites(), "renamed and locked");
    }

    #[test]
    fn a_groups_opacity_is_that_of_its_members_times_its_own(seed: u64, own in 0.05_f32..1.0, of_group in 0.05_f32..1.0) {
        let (mut site, mut maker) = site(seed);
        let add = added(&mut site, &mut maker, &[("opacity", json!(own * of_group)), ("visible", json!(true))]);
        let expected = site.composites();
        site.apply(&[
            json!({"op": "add_layer", "name": "Outer", "content": {"type": "group"}}),
            json!({"op": "add_layer", "name": "Inner", "content": {"type": "group"}, "group": "Outer", "opacity": of_group}),
            set(&add, "opacity", json!(own)),
        ]);
        let place = site.layers().into_iter().rfind(|layer| layer.content != LayerContent::Group && layer.name != add["name"]);
        let into = json!({"op": "move_layer", "layer": add["name"], "above": place.unwrap().id, "group": "Inner"});
        site.apply(&[into]);
        assert_all_same(&expected, &site.composites(), &format!("{add} in groups"));
    }

    #[test]
    fn a_mask_inverted_twice_is_what_it_was(seed: u64) {
        let (mut site, mut maker) = site(seed);
        let layers = site.layers();
        let layer = layers[maker.random.bits() as usize % layers.len()].clone();
        let mask = |site: &Site| read(&site.terrain, &ExportSource::Mask(LayerReference::Id(layer.id)), None, 0);
        let before = mask(&site);
        let whole = site.composites();
        let invert = json!({"op": "set_mask", "layer": layer.id, "invert": true});
        site.apply_one(&invert);
        if layer.mask_terms.is_empty() && layer.group.is_none() {
            let inverse = Plane::new(before.width(), before.depth(), before.samples().iter().map(|weight| 1.0 - weight).collect());
            assert_near(&inverse, &mask(&site), 1.0e-7, "inverted");
        }
        site.apply(&[invert]);
        assert_near(&before, &mask(&site), 2.0e-7, "inverted twice");
        for (level, expected) in (0..).zip(&whole) {
            // What is off by rounding is made much of by gates on slopes.
            let tolerance = 1.0e-3 * range_m(expected).max(1.0);
            assert_near(expected, &composite(&site.terrain, level), tolerance, &format!("inverted twice, level {level}"));
        }
        // Nothing asked for: nothing done, to the bit.
        let now = site.composites();
        site.apply(&[json!({"op": "set_mask", "layer": layer.id})]);
        assert_all_same(&now, &site.composites(), "a mask kept");
        site.apply(&[json!({"op": "set_mask", "layer": layer.id, "from": "all"}), json!({"op": "set_mask", "layer": layer.id, "from": "all", "invert": true})]);
        let all_and_nothing = mask(&site);
        if layer.mask_terms.is_empty() {
            prop_assert!(all_and_nothing.samples().iter().all(|weight| *weight == 0.0));
        }
    }

    #[test]
    fn a_transform_and_its_inverse_lead_back(seed: u64, x in -40_i32..40, z in -30_i32..30, quarter in 0_i32..4) {
        let mut site = Site::new([150, 97], 25.0, 64);
        let mut maker = Maker::new(seed, &site.terrain.grid());
        site.apply(&[
            json!({"op": "set_mask", "layer": "Base", "from": "nothing"}),
            json!({"op": "add_layer", "name": "Layer", "height": 3}),
            json!({"op": "fill", "layer": "Layer", "brush": maker.noise(100.0)}),
        ]);
        let before = composite(&site.terrain, 0);
        let move_m = [f64::from(x) * 25.0, f64::from(z) * 25.0];
        let turned = |move_m: [f64; 2], degrees: i32| json!({"op": "set_layer", "layer": "Layer",
            "transform": {"move": move_m, "rotate": degrees, "pivot": [1875, 1200]}});
        let collapse = json!({"op": "collapse_layer", "layer": "Layer"});
        site.apply(&[turned(move_m, 0)]);
        let moved = composite(&site.terrain, 0);
        let at = |plane: &Plane, x: i32, z: i32| {
            let inside = (0..plane.width() as i32).contains(&x) && (0..plane.depth() as i32).contains(&z);
            inside.then(|| plane.at(x as u32, z as u32))
        };
        let mut num = 0;
        for to_z in 0..97 {
            for to_x in 0..150 {
                let expected = at(&before, to_x - x, to_z - z).unwrap_or(3.0);
                prop_assert_eq!(moved.at(to_x as u32, to_z as u32).to_bits(), expected.to_bits());
                num += 1;
            }
        }
        prop_assert_eq!(num, 150 * 97);
        if x != 0 || z != 0 {
            site.apply(&[collapse.clone(), turned(move_m.map(|m| -m), 0)]);
            let back = composite(&site.terrain, 0);
            let stays = |to_x: i32, to_z: i32| at(&before, to_x + x, to_z + z).is_some();
            let expected = Plane::from_fn(150, 97, |x, z| if stays(x as i32, z as i32) { before.at(x, z) } else { 3.0 });
            assert_same(&expected, &back, "moved there and back");
        }
        // A turn by quarters, and back, about a sample in the middle: whole samples again.
        site.terrain.undo(if x != 0 || z != 0 { 3 } else { 1 }).unwrap();
        if quarter > 0 {
            site.apply(&[turned([0.0, 0.0], 90 * quarter), collapse, turned([0.0, 0.0], -90 * quarter)]);
            let back = composite(&site.terrain, 0);
            // What is within the circle about the pivot that fits the terrain never leaves it.
            for z in 1..96 {
                for x in 28..122 {
                    prop_assert_eq!(back.at(x, z).to_bits(), before.at(x, z).to_bits(), "{} {}", x, z);
                }
            }
        }
    }
}

#[test]
fn a_layer_turned_and_enlarged_and_back_is_near_what_it_was() {
    let mut site = Site::usual();
    site.apply(&[
        json!({"op": "set_mask", "layer": "Base", "from": "nothing"}),
        json!({"op": "add_layer", "name": "Layer"}),
        fill("Layer", 100.0, 5),
    ]);
    let before = composite(&site.terrain, 0);
    let set = |transform: Value| json!({"op": "set_layer", "layer": "Layer", "transform": transform});
    let pivot = [3750, 6450];
    for (degrees, scale) in [(25.0, 1.3), (-140.0, 1.0), (60.0, 2.0)] {
        site.apply(&[
            set(json!({"rotate": degrees, "scale": scale, "pivot": pivot, "height_scale": 2})),
            json!({"op": "collapse_layer", "layer": "Layer"}),
            set(json!({"rotate": -degrees, "scale": 1.0 / scale, "pivot": pivot, "height_scale": 0.5})),
        ]);
        let back = composite(&site.terrain, 0);
        // About the middle, of what was left of it.
        let middle = |plane: &Plane| Plane::from_fn(100, 100, |x, z| plane.at(100 + x, 208 + z));
        let worst =
            assert_near(&middle(&before), &middle(&back), 0.02 * range_m(&before), &format!("by {degrees}°"));
        assert!(worst > 0.0);
        site.terrain.undo(3).unwrap();
    }
}

#[test]
fn what_counts_by_the_mask_of_another_layer_counts_as_much_as_that() {
    let mut site = crate::rich::site();
    site.apply(&[
        json!({"op": "add_layer", "name": "New", "content": {"type": "procedural", "brush": noise(50.0, 3)}, "mask": [{"mask": "Moved"}]}),
    ]);
    for level in 0..=site.top_level() {
        let [of_new, of_moved] =
            ["New", "Moved"].map(|layer| read(&site.terrain, &ExportSource::Mask(name(layer)), None, level));
        assert_same(&of_moved, &of_new, &format!("level {level}"));
    }
    assert_differs(
        &Plane::from_fn(101, 173, |_, _| 1.0),
        &read(&site.terrain, &ExportSource::Mask(name("New")), None, 0),
        "the mask",
    );
}
