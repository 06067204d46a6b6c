//! What stacks come to, against whole planes worked out plainly.

use std::collections::BTreeMap;

use orogeny_engine::{ExportSource, Layer, LayerReference};
use orogeny_field::{Blend, LayerContent, MaskSource};
use orogeny_store::Store;
use orogeny_tests::Plane;
use orogeny_tests::child::is_long;
use serde_json::json;

use crate::plain::{Plain, Sheet};
use crate::random::Maker;
use crate::support::{Site, assert_near, assert_same, range_m, read, told};

/// How far from what is worked out plainly heights may be, as a share of the range of heights.
const SHARE: f64 = 1.0e-5;

/// And where rounding alone may come to more: a Laplacian blend sums a dozen planes, of each of which what was turned or enlarged before may
/// be as much off. Few are.
const MOST: f64 = 1.0e-4;

/// The range of the heights that stacks are made of, metres, whatever is left of it in the end.
const RANGE_M: f64 = 500.0;

/// What was met, by name.
#[derive(Default)]
struct Met(BTreeMap<String, usize>);

impl Met {
    fn note(&mut self, what: impl Into<String>) {
        *self.0.entry(what.into()).or_default() += 1;
    }

    fn note_layer(&mut self, layer: &Layer) {
        self.note(layer.content.name());
        if let Some(procedure) = layer.content.procedure() {
            self.note(procedure.brush.brush_type.name());
        }
        self.note(format!("blend {}", layer.blend.name()));
        for (what, is_so) in [
            ("hidden", !layer.visible),
            ("opacity", layer.opacity < 1.0),
            ("painted mask", layer.mask.is_some()),
            ("in a group", layer.group.is_some()),
            ("moved", !layer.transform.is_identity()),
            ("turned", layer.transform.rotation_deg != 0.0),
            ("made smaller", layer.transform.scale < 0.6),
        ] {
            if is_so {
                self.note(what);
            }
        }
        for term in &layer.mask_terms {
            self.note(format!("combine {:?}", term.combine));
            for (what, is_so) in [
                ("blur", term.blur_m > 0.0),
                ("invert", term.is_inverted),
                ("curve", term.curve.is_some()),
                ("heights of a layer", matches!(term.source, MaskSource::Heights { .. })),
                ("mask of a layer", matches!(term.source, MaskSource::Mask(_))),
            ] {
                if is_so {
                    self.note(what);
                }
            }
            if let MaskSource::Gate(gate) = &term.source {
                for (what, is_so) in [
                    ("slope", gate.slope_deg.is_some()),
                    ("aspect", gate.aspect.is_some()),
                    ("height", gate.height_m.is_some()),
                    ("noise gate", gate.noise.is_some()),
                    ("selection", gate.selection),
                ] {
                    if is_so {
                        self.note(what);
                    }
                }
            }
        }
    }

    fn assert_all(&self, wanted: &[&str]) {
        for what in wanted {
            assert!(self.0.contains_key(*what), "`{what}` was never met: {:?}", self.0);
        }
    }
}

/// Of masks, which are 0..1: what a curve makes of a blur is off by some times as much.
const MASK_RANGE: f64 = 3.0;

/// Compares a plane with one worked out plainly. Gives whether by bits, and whether within more than [`SHARE`].
fn assert_is(expected: &Sheet, found: &Plane, least_range: f64, what: &str) -> [bool; 2] {
    let plane = expected.plane();
    if expected.off == 0.0 {
        assert_same(&plane, found, what);
        return [true, false];
    }
    let range = range_m(&plane).max(least_range);
    assert!(expected.off <= MOST * range, "{what}: rounding alone may come to {} of {range}", expected.off);
    assert_near(&plane, found, expected.off.max(SHARE * range), what);
    [false, expected.off > SHARE * range]
}

/// Compares the composite, each layer and each mask at all levels, layer by layer from the top: what the engine has below a layer is what
/// it has with all from there on hidden, and is compared next. Gives how many planes were compared, how many of them by bits, and how many
/// within more than [`SHARE`].
fn assert_is_plain(site: &mut Site, what: &str) -> [usize; 3] {
    let store = Store::open_to_read(&site.path).unwrap();
    let layers = site.layers();
    let levels = 0..=site.top_level();
    let masks_and_layers: Vec<_> = layers.iter().map(|layer| alone(site, layer)).collect();
    let ([mut num, mut num_exact, mut num_wide], mut num_hidden) = ([0; 3], 0);
    let mut compare = |expected: &Sheet, found: &Plane, least_range: f64, source: &str, level: u8| {
        let what = || format!("{what}, {source} at level {level} of\n{}", told(&layers));
        let [is_exact, is_wide] = assert_is(expected, found, least_range, &what());
        num_exact += usize::from(is_exact);
        num_wide += usize::from(is_wide);
        num += 1;
    };
    let mut seen = site.composites();
    for (layer, (masks, alone)) in layers.iter().zip(masks_and_layers).rev() {
        let is_group = layer.content == LayerContent::Group;
        let hide = json!({"op": "set_layer", "layer": layer.id, "visible": false});
        let with = seen.clone();
        if !is_group && layer.visible {
            site.apply(&[hide]);
            num_hidden += 1;
            seen = site.composites();
        }
        for level in levels.clone() {
            let place = usize::from(level);
            let plain = Plain { store: &store, layers: &layers, level };
            // Of a group, which no one hid, what lies below is what it was.
            let below = Sheet::of(&seen[place]);
            let name = &layer.name;
            compare(
                &plain.masks(layer, &below),
                &masks[place],
                MASK_RANGE,
                &format!("the mask of `{name}`"),
                level,
            );
            if is_group {
                continue;
            }
            let heights = plain.content(layer, &below);
            compare(&heights, &alone[place], RANGE_M, &format!("`{name}` alone"), level);
            let expected = if plain.is_visible(layer) { plain.joined(layer, &below) } else { below };
            compare(&expected, &with[place], RANGE_M, &format!("the composite up to `{name}`"), level);
        }
    }
    assert!(
        seen.iter().all(|plane| plane.samples().iter().all(|height| *height == 0.0)),
        "{what}: all is hidden"
    );
    site.terrain.undo(num_hidden).unwrap();
    [num, num_exact, num_wide]
}

/// A layer's mask and, of any but a group, what it is made of, at all levels.
fn alone(site: &Site, layer: &Layer) -> (Vec<Plane>, Vec<Plane>) {
    let reference = LayerReference::Id(layer.id);
    let levels = 0..=site.top_level();
    let read = |source: ExportSource| {
        levels.clone().map(|level| read(&site.terrain, &source, None, level)).collect()
    };
    let heights = if layer.content == LayerContent::Group {
        Vec::new()
    } else {
        read(ExportSource::Layer(reference.clone()))
    };
    (read(ExportSource::Mask(reference)), heights)
}

/// A stack of `count` layers over a base that is painted.
fn random_stack(maker: &mut Maker, site: &mut Site, count: usize, is_stored: bool) {
    let base = site.layers()[0].clone();
    let fill = maker.paint(&base);
    site.apply(&[json!({"op": "fill", "layer": "Base", "brush": maker.noise(150.0)}), fill]);
    site.apply(&[maker.paint_mask(&base, "selection"), maker.paint_mask(&base, "selection")]);
    while site.layers().len() <= count {
        let layers = site.layers();
        if !is_stored && maker.chance(0.15) {
            site.apply(&[maker.add_group(&layers)]);
            continue;
        }
        let mut add = maker.add(&layers);
        if is_stored {
            if add["content"]["type"] != "heights" {
                continue;
            }
            add["opacity"] = 1.into();
            add["mask"] = json!([]);
            if add["blend"] != "multiply" {
                add["blend"] = ["max", "subtract", "replace", "min", "add"][layers.len() % 5].into();
            }
            if add.get("transform").is_some() {
                add["transform"] = json!({"move": [1137.0, -661.0]});
            }
        }
        // Painted where it lies, and moved then.
        let transform = add.as_object_mut().unwrap().remove("transform");
        let is_heights = add["content"]["type"] == "heights";
        site.apply(&[add]);
        let layer =
            site.layers().into_iter().find(|layer| layers.iter().all(|other| other.id != layer.id)).unwrap();
        if is_heights {
            site.apply(&[maker.paint(&layer), maker.paint(&layer)]);
        }
        if !is_stored && maker.chance(0.4) {
            site.apply(&[maker.paint_mask(&layer, "mask"), maker.paint_mask(&layer, "mask")]);
        }
        if let Some(transform) = transform {
            site.apply(&[json!({"op": "set_layer", "layer": layer.id, "transform": transform})]);
        }
    }
}

#[test]
fn stacks_of_stored_heights_are_those_of_the_table_bit_for_bit() {
    let num_stacks = if is_long() { 60 } else { 5 };
    let (mut met, mut num_planes) = (Met::default(), 0);
    for seed in 0..num_stacks {
        let mut site = Site::usual();
        let mut maker = Maker::new(0x57ac_0000 + seed, &site.terrain.grid());
        let count = 2 + seed as usize % 8;
        random_stack(&mut maker, &mut site, count, true);
        let store = Store::open_to_read(&site.path).unwrap();
        let layers = site.layers();
        for (level, found) in (0..).zip(site.composites()) {
            let plain = Plain { store: &store, layers: &layers, level };
            assert_is(
                &plain.composite(),
                &found,
                RANGE_M,
                &format!("seed {seed}, all at once, level {level}"),
            );
        }
        let [num, num_exact, _] = assert_is_plain(&mut site, &format!("seed {seed}"));
        assert_eq!(num, num_exact, "seed {seed}: it is all stored");
        num_planes += num;
        site.layers().iter().for_each(|layer| met.note_layer(layer));
    }
    println!("{num_stacks} stacks, {num_planes} planes, all of them by bits");
    met.assert_all(&[
        "blend add",
        "blend subtract",
        "blend max",
        "blend min",
        "blend multiply",
        "blend replace",
        "moved",
    ]);
}

#[test]
fn stacks_of_all_kinds_are_those_that_are_worked_out_plainly() {
    let num_stacks = if is_long() { 300 } else { 13 };
    let (mut met, mut sums) = (Met::default(), [0; 3]);
    for seed in 0..num_stacks {
        let sides = [[129, 197], [201, 131], [65, 201], [140, 150], [257, 300]][seed as usize % 5];
        let mut site = Site::new(sides, 25.0, if seed % 3 == 2 { 256 } else { 64 });
        let mut maker = Maker::new(0x57ac_1000 + seed, &site.terrain.grid());
        maker.makes_kept = true;
        let count = 2 + seed as usize % 9;
        random_stack(&mut maker, &mut site, count, false);
        let found = assert_is_plain(&mut site, &format!("seed {seed}"));
        sums = [0, 1, 2].map(|place| sums[place] + found[place]);
        site.layers().iter().for_each(|layer| met.note_layer(layer));
    }
    let [num, num_exact, num_wide] = sums;
    println!(
        "{num_stacks} stacks, {num} planes, {num_exact} by bits, {num_wide} within more than {SHARE:e}: {:?}",
        met.0
    );
    assert!(num_wide * 20 < num);
    let blends = Blend::ALL.map(|blend| format!("blend {}", blend.name()));
    met.assert_all(&blends.iter().map(String::as_str).collect::<Vec<_>>());
    met.assert_all(&[
        "heights",
        "procedural",
        "effect",
        "group",
        "hidden",
        "opacity",
        "painted mask",
        "in a group",
    ]);
    met.assert_all(&[
        "moved",
        "turned",
        "made smaller",
        "blur",
        "invert",
        "curve",
        "heights of a layer",
        "mask of a layer",
    ]);
    met.assert_all(&[
        "slope",
        "aspect",
        "height",
        "noise gate",
        "selection",
        "smooth",
        "sharpen",
        "terrace",
        "range_map",
        "level",
        "noise",
    ]);
    met.assert_all(&[
        "roughen",
        "combine Multiply",
        "combine Add",
        "combine Subtract",
        "combine Max",
        "combine Min",
    ]);
}

#[test]
#[should_panic(expected = "samples differ")]
fn another_blend_is_seen() {
    let (site, store) = two_layers();
    let mut layers = site.layers();
    layers[1].blend = Blend::Max;
    let plain = Plain { store: &store, layers: &layers, level: 0 };
    assert_is(
        &plain.composite(),
        &read(&site.terrain, &ExportSource::Composite, None, 0),
        RANGE_M,
        "another blend",
    );
}

#[test]
#[should_panic(expected = "samples differ")]
fn another_opacity_is_seen() {
    let (site, store) = two_layers();
    let mut layers = site.layers();
    layers[1].opacity = 0.5001;
    let plain = Plain { store: &store, layers: &layers, level: 1 };
    assert_is(
        &plain.composite(),
        &read(&site.terrain, &ExportSource::Composite, None, 1),
        RANGE_M,
        "another opacity",
    );
}

/// A hill half of which counts, on a base.
fn two_layers() -> (Site, Store) {
    let mut site = Site::usual();
    site.apply(&[
        json!({"op": "add_layer", "name": "Hill", "opacity": 0.5}),
        crate::support::fill("Hill", 200.0, 3),
        crate::support::fill("Base", 100.0, 4),
    ]);
    let store = Store::open_to_read(&site.path).unwrap();
    (site, store)
}
