//! What cannot be done, and what is cancelled: it says so, and changes nothing.

use std::ops::ControlFlow;

use orogeny_engine::{Error, Layer, Observer, Progress};
use orogeny_tests::Plane;
use serde_json::{Value, json};

use crate::rich;
use crate::support::{Site, afresh, assert_all_same, assert_same, composite, dab, noise, operation};

/// Cancels when it was asked so many times.
struct Impatient(u32);

impl Observer for Impatient {
    fn progress(&mut self, _progress: Progress) -> ControlFlow<()> {
        match self.0.checked_sub(1) {
            None => ControlFlow::Break(()),
            Some(left) => {
                self.0 = left;
                ControlFlow::Continue(())
            }
        }
    }
}

fn assert_unchanged(site: &Site, layers: &[Layer], composites: &[Plane], what: &str) {
    assert_eq!(site.layers(), layers, "{what}");
    assert_all_same(composites, &site.composites(), what);
    assert_same(&composites[0], &composite(&afresh(&site.path), 0), what);
}

/// The error without the recipe that it happened in.
fn cause(err: Error) -> Error {
    match err {
        Error::InRecipe { source, .. } => cause(*source),
        err => err,
    }
}

#[test]
fn what_is_refused_says_why_and_changes_nothing() {
    let mut site = rich::site();
    site.apply(&[
        json!({"op": "set_mask", "layer": "Smoothed", "terms": []}),
        json!({"op": "set_layer", "layer": "Hill", "locked": true}),
        json!({"op": "add_layer", "name": "Locked", "content": {"type": "group"}, "locked": true}),
        json!({"op": "add_layer", "name": "Inside", "group": "Locked", "content": {"type": "procedural", "brush": noise(5.0, 1)}}),
        json!({"op": "set_layer", "layer": "Slid", "locked": true}),
    ]);
    let (layers, composites) = (site.layers(), site.composites());
    let log = site.terrain.log().unwrap();
    let set =
        |layer: &str, field: &str, value: Value| json!({"op": "set_layer", "layer": layer, field: value});
    let on = |op: &str, layer: &str| json!({"op": op, "layer": layer});
    let cases = [
        // Locked, or in a group that is.
        (dab("Hill", "heights", "raise", 500.0, [1000.0, 1000.0]), "locked"),
        (dab("Hill", "mask", "erase_mask", 500.0, [1000.0, 1000.0]), "locked"),
        (dab("Inside", "mask", "erase_mask", 500.0, [1000.0, 1000.0]), "`Locked` is locked"),
        (set("Hill", "transform", json!({"move": [100, 100]})), "locked"),
        (set("Inside", "content", json!({"type": "procedural", "brush": noise(9.0, 1)})), "locked"),
        (on("remove_layer", "Hill"), "locked"),
        (on("remove_layer", "Inside"), "locked"),
        (json!({"op": "remove_layer", "layer": "Massif", "members": true}), "`Hill` is locked"),
        (on("collapse_layer", "Inside"), "locked"),
        (json!({"op": "collapse_layer", "layer": "Moved", "below": true}), "`Hill` is locked"),
        (json!({"op": "set_mask", "layer": "Hill", "invert": true}), "locked"),
        (on("refresh_layer", "Slid"), "locked"),
        // Names and layers.
        (json!({"op": "add_layer", "name": "Moved"}), "`Moved` already"),
        (set("Moved", "name", json!("Base")), "`Base` already"),
        (json!({"op": "duplicate_layer", "layer": "Moved", "name": "Base"}), "`Base` already"),
        (json!({"op": "add_layer", "name": ""}), "name"),
        (on("remove_layer", "Nobody"), "no layer `Nobody`"),
        (json!({"op": "add_layer", "name": "New", "above": "Nobody"}), "no layer `Nobody`"),
        (json!({"op": "add_layer", "name": "New", "group": "Base"}), "no group"),
        (json!({"op": "add_layer", "name": "New", "mask": [{"mask": 4711}]}), "4711"),
        (
            json!({"op": "set_mask", "layer": "Moved", "terms": [{"heights": {"layer": "Rocks", "low": 0, "high": 1}}]}),
            "heights",
        ),
        // What a layer is not for.
        (dab("Moved", "heights", "raise", 500.0, [1000.0, 1000.0]), "collapse"),
        (dab("Rocks", "heights", "raise", 500.0, [1000.0, 1000.0]), "collapse"),
        (dab("Massif", "heights", "raise", 500.0, [1000.0, 1000.0]), "group"),
        (set("Rocks", "transform", json!({"rotate": 10})), "noise"),
        (set("Base", "content", json!({"type": "group"})), "something else"),
        (on("collapse_layer", "Base"), "lie where they are"),
        (on("collapse_layer", "Massif"), "group"),
        (on("duplicate_layer", "Massif"), "group"),
        (on("refresh_layer", "Smoothed"), "looked at"),
        (json!({"op": "move_layer", "layer": "Massif", "above": "Hill"}), "`Hill`"),
        (json!({"op": "move_layer", "layer": "Massif", "group": "Massif"}), "in itself"),
        (json!({"op": "set_mask", "layer": "Moved", "from": "selection"}), "collapse"),
        // Numbers.
        (set("Moved", "opacity", json!(1.5)), "opacity"),
        (set("Moved", "transform", json!({"scale": 0})), "scale"),
        (json!({"op": "set_mask", "layer": "Moved", "scale": -0.5}), "scale"),
        (
            json!({"op": "add_layer", "name": "New", "content": {"type": "procedural", "brush": {"type": "noise", "feature_size": 1}}}),
            "feature",
        ),
        (json!({"op": "set_mask", "layer": "Moved", "terms": [{"mask": "Hill", "blur": 60_000}]}), "blur"),
        (
            json!({"op": "add_layer", "name": "New", "mask": [{"gate": {"noise": {"pattern": {"feature_size": 9}}}}]}),
            "feature",
        ),
        (
            json!({"op": "add_layer", "name": "New", "height": 5, "content": {"type": "procedural", "brush": noise(9.0, 1)}}),
            "height",
        ),
        (json!({"op": "add_layer", "name": "New", "height": 1.0e9}), "New"),
        (
            json!({"op": "add_layer", "name": "New", "mask": [{"gate": {"image": {"file": "nowhere.png", "region": [0, 0, 9, 9]}}}]}),
            "nowhere.png",
        ),
    ];
    for (change, word) in &cases {
        let err = match site.try_to(change) {
            Ok(()) => panic!("{change} was done"),
            Err(err) => cause(err).to_string(),
        };
        assert!(err.contains(word), "{change}: {err}");
        assert_eq!(site.layers(), layers, "{change}");
    }
    assert_unchanged(&site, &layers, &composites, "all that was refused");
    assert_eq!(site.terrain.log().unwrap(), log);
    // And with operations before it that would have done something.
    let recipe: Vec<_> = rich::changes()[..2].iter().chain([&cases[0].0]).map(operation).collect();
    site.terrain.apply(&recipe[1..], &mut orogeny_engine::Quiet).unwrap_err();
    assert_unchanged(&site, &layers, &composites, "a recipe whose end was refused");
    println!("{} refusals", cases.len());
}

#[test]
fn groups_lie_in_one_another_so_deep_and_no_deeper() {
    let mut site = Site::new([70, 90], 25.0, 64);
    let group = |name: String, group: Option<String>| json!({"op": "add_layer", "name": name, "content": {"type": "group"}, "group": group});
    for number in 0..10 {
        for side in ["a", "b"] {
            let outer = (number > 0).then(|| format!("{side}{}", number - 1));
            site.apply(&[group(format!("{side}{number}"), outer)]);
        }
    }
    site.apply(&[
        json!({"op": "add_layer", "name": "Inside", "group": "b9", "height": 5}),
        json!({"op": "set_layer", "layer": "a0", "visible": false}),
    ]);
    let before = composite(&site.terrain, 0);
    // Ten and ten are too many, four and ten and the layer not.
    let into = |outer: &str| json!({"op": "move_layer", "layer": "b0", "above": "Base", "group": outer});
    let err = cause(site.try_to(&into("a9")).unwrap_err()).to_string();
    assert!(err.contains("deep"), "{err}");
    assert_same(&before, &composite(&site.terrain, 0), "refused");
    site.apply(&[into("a3")]);
    let hidden = composite(&site.terrain, 0);
    assert!(hidden.samples().iter().all(|height| *height == 100.0), "it is in a hidden group");
    let mut outer = "a9".to_owned();
    let mut depth = 10;
    while site.try_to(&group(format!("more{depth}"), Some(outer.clone()))).is_ok() {
        outer = format!("more{depth}");
        depth += 1;
    }
    assert!((15..=16).contains(&depth), "{depth}");
}

/// Does an operation that is cancelled ever later, first one by one, then at twice as late, until it is not. Gives how often it was.
fn cancelled(site: &mut Site, change: &Value) -> u32 {
    let (layers, composites) = (site.layers(), site.composites());
    let (mut num_cancelled, mut patience) = (0, 0);
    while patience < 100_000 {
        let done = site.terrain.apply(&[operation(change)], &mut Impatient(patience));
        match done.map_err(cause) {
            Ok(_) => return num_cancelled,
            Err(Error::Cancelled) => {
                assert_unchanged(site, &layers, &composites, &format!("{change}, cancelled at {patience}"));
            }
            Err(err) => panic!("{change}: {err}"),
        }
        num_cancelled += 1;
        patience += 1 + patience / 2;
    }
    panic!("{change} never ends")
}

#[test]
fn what_is_cancelled_on_its_way_changes_nothing() {
    let mut site = rich::site();
    let kept = |brush: Value| json!({"op": "add_layer", "name": "New", "content": {"type": "effect", "brush": brush}});
    let changes = [
        json!({"op": "refresh_layer", "layer": "Slid"}),
        kept(json!({"type": "erode_thermal", "iterations": 3, "talus_angle": 3})),
        kept(json!({"type": "fill_pits"})),
        json!({"op": "set_layer", "layer": "Slid",
            "content": {"type": "effect", "brush": {"type": "erode_thermal", "iterations": 3, "talus_angle": 2}}}),
        json!({"op": "collapse_layer", "layer": "Moved"}),
        json!({"op": "collapse_layer", "layer": "Rocks"}),
        json!({"op": "collapse_layer", "layer": "Slid", "below": true}),
        json!({"op": "duplicate_layer", "layer": "Hill"}),
        json!({"op": "set_mask", "layer": "Blended", "invert": true}),
    ];
    let mut num_cancelled = 0;
    for change in &changes {
        let times = cancelled(&mut site, change);
        assert!(times > 0, "{change} never asks");
        num_cancelled += times;
        site.terrain.undo(1).unwrap();
    }
    println!("{} operations cancelled {num_cancelled} times", changes.len());
}
