//! What is kept of the stack is never stale: whatever is done, the composite is, bit for bit, that of the same file opened afresh.

use std::collections::BTreeMap;

use orogeny_engine::{Error, ExportRequest, ExportSource, ImportRequest, Layer, LayerReference, Quiet};
use orogeny_field::LayerContent;
use orogeny_tests::child::is_long;
use serde_json::{Value, json};

use crate::random::Maker;
use crate::support::{Site, afresh, assert_same, operation, read, told};

const NUM_STEPS: usize = 25;
/// More layers than these are removed again.
const MANY_LAYERS: usize = 7;

#[derive(Debug)]
enum Step {
    Apply(Vec<Value>),
    TryOut(Value),
    Undo(u32),
    Redo(u32),
    Jump,
    Reopen,
    /// A part of the composite is written to a file, and read back into the layer `Base`.
    Import,
    /// The history is shortened, the file compacted.
    Shorten,
}

/// What is done next; often what was undone just before.
fn step(maker: &mut Maker, layers: &[Layer], was_undone: bool) -> Step {
    if was_undone && maker.chance(0.4) {
        return Step::Redo(maker.random.one_of(&[1, 2]));
    }
    let layer = maker.random.one_of(layers);
    let one = |operation: Value| Step::Apply(vec![operation]);
    match maker.random.bits() % 100 {
        0..=2 => Step::Reopen,
        3..=9 => Step::Undo(maker.random.one_of(&[1, 1, 2, 4])),
        11..=15 => Step::Redo(maker.random.one_of(&[1, 2])),
        16..=18 => Step::Jump,
        19..=21 => Step::TryOut(change(maker, &layer, layers)),
        28 | 29 => Step::Import,
        30 => Step::Shorten,
        // Several in one go, of which nothing is looked at in between.
        22..=27 => Step::Apply((0..3).map(|_| any(maker, layers)).collect()),
        _ => one(any(maker, layers)),
    }
}

pub fn any(maker: &mut Maker, layers: &[Layer]) -> Value {
    let layer = maker.random.one_of(layers);
    let is_paintable =
        |layer: &&Layer| layer.content == LayerContent::Heights && layer.transform.is_identity();
    let paintable: Vec<Layer> = layers.iter().filter(is_paintable).cloned().collect();
    match maker.random.bits() % 12 {
        0..=2 if !paintable.is_empty() => {
            let layer = maker.random.one_of(&paintable);
            maker.paint(&layer)
        }
        3 if !paintable.is_empty() => {
            let layer = maker.random.one_of(&paintable);
            maker.paint_seen(&layer)
        }
        4 => maker.paint_mask(&layer, "mask"),
        5 if maker.chance(0.5) => maker.paint_mask(&layer, "selection"),
        5 => maker.select(&layer),
        _ => change(maker, &layer, layers),
    }
}

/// A change of the stack.
fn change(maker: &mut Maker, layer: &Layer, layers: &[Layer]) -> Value {
    let of = |op: &str| json!({"op": op, "layer": layer.id});
    if layers.len() > MANY_LAYERS && maker.chance(0.5) {
        return of("remove_layer");
    }
    match maker.random.bits() % 20 {
        0..=3 => maker.add(layers),
        4 => maker.add_group(layers),
        5..=8 => maker.set(layer),
        9 if maker.chance(0.5) => maker.make_mask(layer),
        9 | 10 => maker.set_mask(layer, layers),
        11 | 12 => maker.move_layer(layer, layers),
        13 => of("duplicate_layer"),
        14 => {
            let mut collapse = of("collapse_layer");
            collapse["below"] = maker.chance(0.3).into();
            collapse
        }
        15 => json!({"op": "remove_layer", "layer": layer.id, "members": maker.chance(0.5)}),
        16 | 17 => {
            let is_kept = |layer: &&Layer| layer.content.is_kept() || layer.made_mask.is_some();
            let kept: Vec<u32> = layers.iter().filter(is_kept).map(|layer| layer.id).collect();
            if kept.is_empty() {
                maker.set(layer)
            } else {
                json!({"op": "refresh_layer", "layer": maker.random.one_of(&kept)})
            }
        }
        18 => json!({"op": "set_layer", "layer": layer.id, "locked": !layer.locked}),
        _ => maker.set(layer),
    }
}

/// Whether an operation was refused for what it is, rather than that it failed.
pub fn is_refusal(err: &Error) -> bool {
    match err {
        Error::InRecipe { source, .. } => is_refusal(source),
        Error::LayerRefused { .. }
        | Error::LayerLocked { .. }
        | Error::LayerNameTaken { .. }
        | Error::UnknownLayer { .. } => true,
        _ => false,
    }
}

/// Does a step; whether something came of it.
fn take(site: &mut Site, maker: &mut Maker, step: &Step) -> bool {
    let done = match step {
        Step::Reopen => {
            site.reopen();
            return true;
        }
        Step::Undo(count) => return !site.terrain.undo(*count).unwrap().is_empty(),
        Step::Redo(count) => return !site.terrain.redo(*count).unwrap().is_empty(),
        Step::Jump => {
            let log = site.terrain.log().unwrap();
            let Some(entry) = log.len().checked_sub(1).map(|last| maker.random.bits() as usize % (last + 1))
            else {
                return false;
            };
            return !site.terrain.jump(log[entry].id).unwrap().is_empty();
        }
        Step::Shorten => {
            site.terrain.drop_branches().unwrap();
            let kept = site.terrain.describe().unwrap().history.size_in_bytes / 2;
            let dropped = site.terrain.set_history_budget(Some(kept)).unwrap();
            site.terrain.set_history_budget(None).unwrap();
            site.terrain.compact().unwrap();
            return !dropped.entries.is_empty();
        }
        Step::Import => {
            let file = site.file("part.npy");
            let export = ExportRequest { region_m: Some(maker.region_m()), ..ExportRequest::new(&file) };
            site.terrain.export(&export, &mut Quiet).unwrap();
            let [x, z, ..] = maker.region_m();
            let layer = Some("Base".to_owned());
            let request = ImportRequest { layer, at_m: [x, z], ..ImportRequest::new(&file) };
            let done = site.terrain.import(&request, &mut Quiet);
            std::fs::remove_file(&file).unwrap();
            return match done {
                Ok(_) => true,
                Err(err) if is_refusal(&err) => false,
                Err(err) => panic!("{step:?}: {err}"),
            };
        }
        Step::TryOut(json) => site.terrain.try_out(&[operation(json)], &mut Quiet),
        Step::Apply(list) => {
            let operations: Vec<_> = list.iter().map(operation).collect();
            // Looked at while it is on its way to the disk.
            if maker.chance(0.5) {
                site.terrain.submit(&operations, &mut Quiet)
            } else {
                site.terrain.apply(&operations, &mut Quiet)
            }
        }
    };
    match done {
        Ok(_) => true,
        Err(err) if is_refusal(&err) => false,
        Err(err) => panic!("{step:?}: {err}"),
    }
}

/// Something to look at: most often the composite.
fn look(maker: &mut Maker, layers: &[Layer]) -> ExportSource {
    let layer = maker.random.one_of(layers);
    let reference = LayerReference::Id(layer.id);
    match maker.random.bits() % 8 {
        0 if layer.content != LayerContent::Group => ExportSource::Layer(reference),
        1 => ExportSource::Mask(reference),
        2 => ExportSource::Selection,
        _ => ExportSource::Composite,
    }
}

/// Runs a random sequence; gives by step how often something came of it, and of how many reads.
fn run(seed: u64, counts: &mut BTreeMap<String, usize>) -> usize {
    let mut site = Site::new([150, 131], 25.0, 64);
    let mut maker = Maker::new(seed, &site.terrain.grid());
    maker.makes_kept = true;
    let fill = maker.noise(150.0);
    site.apply(&[json!({"op": "fill", "layer": "Base", "brush": fill})]);
    for _ in 0..2 {
        let add = maker.add(&site.layers());
        site.apply(&[add]);
    }
    let top = site.top_level();
    let mut past = Vec::new();
    let (mut num_reads, mut was_undone) = (0, false);
    for number in 0..NUM_STEPS {
        let step = step(&mut maker, &site.layers(), was_undone);
        was_undone = matches!(step, Step::Undo(_));
        past.push(format!("{step:?}"));
        let is_done = take(&mut site, &mut maker, &step);
        let what = match &step {
            Step::Apply(list) if list.len() == 1 => list[0]["op"].as_str().unwrap().to_owned(),
            Step::Apply(_) => "recipe".to_owned(),
            Step::TryOut(_) => "try_out".to_owned(),
            other => format!("{other:?}").split('(').next().unwrap().to_lowercase(),
        };
        *counts.entry(if is_done { what } else { format!("{what} refused") }).or_default() += 1;
        let looks: Vec<_> = (0..3)
            .map(|_| {
                let level = (maker.random.bits() % u64::from(top + 1)) as u8;
                let region_m = maker.chance(0.7).then(|| maker.region_m());
                (look(&mut maker, &site.layers()), region_m, level)
            })
            .collect();
        let found: Vec<_> = looks
            .iter()
            .map(|(source, region_m, level)| read(&site.terrain, source, *region_m, *level))
            .collect();
        // What was read is ahead of the file.
        site.terrain.flush().unwrap();
        let fresh = afresh(&site.path);
        assert_eq!(fresh.layers().unwrap(), site.layers(), "seed {seed}, step {number}");
        for ((source, region_m, level), found) in looks.iter().zip(found) {
            let what = || {
                let steps = past.join("\n");
                format!(
                    "seed {seed:#x}, step {number}: {source:?} of {region_m:?} at level {level} after\n{steps}\n{}",
                    told(&site.layers())
                )
            };
            let expected = read(&fresh, source, *region_m, *level);
            if expected != found {
                assert_same(&expected, &found, &what());
            }
            num_reads += 1;
        }
    }
    num_reads
}

#[test]
fn after_whatever_was_done_the_stack_is_that_of_the_file_opened_afresh() {
    let num_runs = if is_long() { 600 } else { 40 };
    let (mut counts, mut num_reads) = (BTreeMap::new(), 0);
    for seed in 0..num_runs {
        num_reads += run(0x1c4e_0000 + seed, &mut counts);
    }
    println!("{num_runs} runs of {NUM_STEPS} steps, {num_reads} reads: {counts:?}");
    assert_eq!(num_reads, num_runs as usize * NUM_STEPS * 3);
    for what in [
        "add_layer",
        "set_layer",
        "move_layer",
        "remove_layer",
        "duplicate_layer",
        "collapse_layer",
        "set_mask",
        "refresh_layer",
        "stroke",
        "fill",
        "recipe",
        "select",
        "try_out",
        "undo",
        "redo",
        "jump",
        "reopen",
        "import",
        "shorten",
    ] {
        assert!(counts.contains_key(what), "`{what}` never came to something: {counts:?}");
    }
}
