//! Undo, redo and replay of every operation on layers; dry runs; data from outside that layers go on needing.

use std::path::Path;

use orogeny_engine::{Layer, Quiet, Terrain};
use orogeny_field::{LayerReference, MaskSource};
use orogeny_store::Store;
use orogeny_tests::Plane;
use serde_json::{Value, json};

use crate::incremental::is_refusal;
use crate::random::Maker;
use crate::support::{Site, afresh, assert_all_same, assert_differs, composite, name, operation, settings};
use crate::{rich, support};

/// All that there is to see of a terrain.
fn seen(site: &Site) -> (Vec<Layer>, Vec<Plane>) {
    (site.layers(), site.composites())
}

fn assert_seen(site: &Site, (layers, composites): &(Vec<Layer>, Vec<Plane>), what: &str) {
    assert_eq!(&site.layers(), layers, "{what}");
    assert_all_same(composites, &site.composites(), what);
    let fresh = afresh(&site.path);
    assert_eq!(fresh.layers().unwrap(), layers, "{what}");
    support::assert_same(&composites[0], &composite(&fresh, 0), &format!("{what}, opened afresh"));
}

#[test]
fn every_operation_is_undone_and_redone_to_the_bit() {
    let mut site = rich::site();
    let before = seen(&site);
    let changes = rich::changes();
    for change in &changes {
        site.apply_one(change);
        let after = seen(&site);
        assert_ne!(before.0, after.0, "{change}");
        site.terrain.undo(1).unwrap();
        assert_seen(&site, &before, &format!("{change} undone"));
        site.terrain.redo(1).unwrap();
        assert_seen(&site, &after, &format!("{change} redone"));
        site.terrain.undo(1).unwrap();
        assert_eq!(site.layers(), before.0, "{change}");
    }
    println!("{} operations there and back", changes.len());
    // All the way.
    let mut flat = rich::flat();
    let start = seen(&flat);
    flat.apply(&rich::operations());
    flat.terrain.undo(u32::MAX).unwrap();
    assert_seen(&flat, &start, "all undone");
    flat.terrain.redo(u32::MAX).unwrap();
    assert_all_same(&before.1, &flat.composites(), "all redone");
    assert!(Terrain::check(&flat.path).unwrap().problems.is_empty());
}

#[test]
fn a_dry_run_changes_nothing_and_says_what_it_would_do() {
    let mut site = rich::site();
    let before = seen(&site);
    let log = site.terrain.log().unwrap();
    for change in rich::changes() {
        let applied = site.terrain.try_out(&[operation(&change)], &mut Quiet).unwrap();
        assert_eq!(applied[0].operation, change["op"]);
        assert_eq!(site.layers(), before.0, "{change}");
        assert_all_same(&before.1, &site.composites(), &format!("{change}, tried"));
    }
    assert_eq!(site.terrain.log().unwrap(), log);
    // All at once, of which the later ones meet what the earlier ones left.
    let fits = ["duplicate_layer", "set_mask", "set_layer"];
    let all: Vec<_> = rich::changes()
        .iter()
        .filter(|change| fits.contains(&change["op"].as_str().unwrap()))
        .map(operation)
        .collect();
    site.terrain.try_out(&all, &mut Quiet).unwrap();
    assert_seen(&site, &before, "all tried");
}

/// A stack without the numbers that are given out as layers come and go.
fn without_ids(layers: &[Layer]) -> Vec<Value> {
    let name_of = |id: u32| layers.iter().find(|layer| layer.id == id).unwrap().name.clone();
    let plain = |layer: &Layer| {
        let mut terms = layer.mask_terms.clone();
        for term in &mut terms {
            if let MaskSource::Heights { layer, .. } | MaskSource::Mask(layer) = &mut term.source
                && let LayerReference::Id(id) = *layer
            {
                *layer = name(&name_of(id));
            }
        }
        json!({
            "name": layer.name, "content": layer.content, "constant": layer.constant_m, "terms": terms,
            "mask": layer.mask.map(|_| layer.mask_constant), "visible": layer.visible, "locked": layer.locked,
            "opacity": layer.opacity, "blend": layer.blend, "transform": layer.transform, "group": layer.group.map(name_of),
            "region": layer.made_of.as_ref().map(|made_of| made_of.region),
            "made mask": layer.made_mask.as_ref().map(|made| json!([made.brush, made.invert, made.scale, made.made_of.region])),
        })
    };
    layers.iter().map(plain).collect()
}

fn assert_replays(site: &Site, what: &str) {
    let copy = site.file("replay.orogeny");
    site.terrain.replay(&copy, settings(), &mut Quiet).unwrap_or_else(|err| panic!("{what}: {err}"));
    let replayed = Terrain::open(&copy, settings()).unwrap();
    assert_eq!(without_ids(replayed.layers().unwrap()), without_ids(&site.layers()), "{what}");
    for (level, expected) in (0..).zip(site.composites()) {
        support::assert_same(&expected, &composite(&replayed, level), &format!("{what} at level {level}"));
    }
    let stale = |terrain: &Terrain| -> Vec<bool> {
        terrain.describe().unwrap().layers.iter().map(|layer| layer.is_stale).collect()
    };
    assert_eq!(stale(&replayed), stale(&site.terrain), "{what}");
    drop(replayed);
    assert_whole(&copy);
    std::fs::remove_file(copy).unwrap();
}

fn assert_whole(path: &Path) {
    let report = Terrain::check(path).unwrap();
    assert!(report.problems.is_empty(), "{:#?}", report.problems);
}

#[test]
fn a_replay_gives_the_same_stack_and_the_same_composite() {
    let changes = rich::changes();
    let (mut num_replays, mut done) = (0, vec![false; changes.len()]);
    // As many of them as go together, from wherever: what is removed is missing later, and a name is taken.
    for first in [0, 13, 20, 24, 28] {
        let mut site = rich::site();
        for place in (0..changes.len()).map(|place| (first + place) % changes.len()) {
            if site.try_to(&changes[place]).is_err() {
                continue;
            }
            done[place] = true;
            // Layers that were undone leave gaps in the numbers that are given out.
            if place % 4 == 3 {
                site.terrain.undo(1).unwrap();
                site.apply(&[changes[place].clone()]);
            }
        }
        assert_replays(&site, &format!("from change {first} on"));
        num_replays += 1;
    }
    println!("{num_replays} replays of {} operations", changes.len());
    let missing: Vec<_> =
        changes.iter().zip(&done).filter(|(_, done)| !**done).map(|(change, _)| change).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn a_random_history_is_replayed() {
    let mut num_done = 0;
    for seed in 0..6 {
        let mut site = Site::new([150, 120], 25.0, 64);
        let mut maker = Maker::new(0x4e91_a700 + seed, &site.terrain.grid());
        maker.makes_kept = true;
        for number in 0..30 {
            let layers = site.layers();
            let change = crate::incremental::any(&mut maker, &layers);
            match site.try_to(&change) {
                Ok(()) => num_done += 1,
                Err(err) => assert!(is_refusal(&err), "{change}: {err}"),
            }
            if number % 7 == 6 {
                site.terrain.undo(2).unwrap();
            }
        }
        assert_replays(&site, &format!("seed {seed}"));
        assert_whole(&site.path);
    }
    println!("{num_done} operations replayed");
    assert!(num_done > 100);
}

fn picture(site: &Site, file: &str, first: u8) -> String {
    let path = site.file(file);
    let pixels: Vec<u8> = (0..64_u8).map(|pixel| pixel.wrapping_mul(37).wrapping_add(first)).collect();
    let mut encoder = png::Encoder::new(std::fs::File::create(&path).unwrap(), 8, 8);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header().unwrap().write_image_data(&pixels).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_picture_stays_as_long_as_a_layer_needs_it() {
    let mut site = Site::usual();
    let files = [1, 2, 3].map(|number| picture(&site, &format!("{number}.png"), number));
    let gate = |number: usize| json!({"image": {"file": files[number], "region": [500, 500, 6000, 9000]}});
    let mut by_gate = noise_with(gate(1));
    by_gate["strength"] = 80.into();
    site.apply(&[
        support::fill("Base", 150.0, 1),
        json!({"op": "add_layer", "name": "Term", "height": 50, "mask": [{"gate": gate(0), "blur": 80}]}),
        json!({"op": "add_layer", "name": "Noise", "content": {"type": "procedural", "brush": by_gate}}),
        json!({"op": "duplicate_layer", "layer": "Noise"}),
        json!({"op": "add_layer", "name": "Set", "height": 30}),
        json!({"op": "set_mask", "layer": "Set", "terms": [{"gate": gate(2)}]}),
        json!({"op": "set_layer", "layer": "Term", "opacity": 0.9}),
        json!({"op": "add_layer", "name": "Group", "content": {"type": "group"}, "mask": [{"gate": gate(0)}]}),
        json!({"op": "move_layer", "layer": "Noise", "above": "Base", "group": "Group"}),
        json!({"op": "remove_layer", "layer": "Noise copy"}),
    ]);
    for file in &files {
        std::fs::remove_file(file).unwrap();
    }
    assert_replays(&site, "with pictures");
    let before = seen(&site);
    let dropped = site.terrain.set_history_budget(Some(0)).unwrap();
    assert_eq!(dropped.applied.len(), 10);
    assert_whole(&site.path);
    site.reopen();
    assert_seen(&site, &before, "without a history");
    // The layers can still be worked with.
    site.apply(&[
        json!({"op": "duplicate_layer", "layer": "Noise"}),
        json!({"op": "set_layer", "layer": "Noise", "visible": false}),
        json!({"op": "collapse_layer", "layer": "Noise copy"}),
        json!({"op": "collapse_layer", "layer": "Set", "below": true}),
    ]);
    site.reopen();
    assert_whole(&site.path);
    assert_differs(&composite(&site.terrain, 1), &before.1[1], "what was done then");
    let store = Store::open_to_read(&site.path).unwrap();
    assert_eq!(store.layers().len(), 3, "{:?}", store.layers());
}

fn noise_with(gate: Value) -> Value {
    let mut brush = support::noise(80.0, 4);
    brush["gate"] = gate;
    brush
}

/// What salvage copies is the whole stack: groups and masks by their layers, and the data that brushes and gates name.
#[test]
fn a_salvaged_stack_comes_to_the_same() {
    let mut site = rich::site();
    let file = picture(&site, "1.png", 1);
    site.apply(&[
        json!({"op": "duplicate_layer", "layer": "Hill"}),
        json!({"op": "remove_layer", "layer": "Hill copy"}),
        json!({"op": "add_layer", "name": "Noise", "group": "Massif",
            "content": {"type": "procedural", "brush": noise_with(json!({"image": {"file": file, "region": [500, 500, 6000, 9000]}}))},
            "mask": [{"mask": "Moved"}, {"gate": {"image": {"file": file, "region": [0, 0, 6000, 9000]}}, "combine": "max"}]}),
    ]);
    let copy = site.file("salvaged.orogeny");
    Terrain::salvage(&site.path, &copy).unwrap();
    assert_whole(&copy);
    let salvaged = Terrain::open(&copy, settings()).unwrap();
    let without_history = |layers: &[Layer]| {
        let layers: Vec<Layer> =
            layers.iter().map(|layer| Layer { made_of: None, ..layer.clone() }).collect();
        without_ids(&layers)
    };
    assert_eq!(without_history(salvaged.layers().unwrap()), without_history(&site.layers()));
    for (level, expected) in (0..).zip(site.composites()) {
        support::assert_same(&expected, &composite(&salvaged, level), &format!("level {level}"));
    }
}
