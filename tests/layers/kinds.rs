//! Every brush as a layer, terrains of every shape, and what is told of a stack without reading all of it.

use orogeny_engine::{Adapter, ExportSource, LayerReference, Quiet, Settings, Terrain};
use orogeny_field::BrushType;
use orogeny_store::Store;
use orogeny_tests::Plane;
use serde_json::{Value, json};

use crate::plain::{Plain, Sheet};
use crate::random::Maker;
use crate::rich;
use crate::support::{
    Site, afresh, assert_differs, assert_near, assert_same, composite, dab, fill, operation, range_m, read,
    settings, told,
};

/// A brush of a type, with what it needs.
fn brush(brush_type: BrushType) -> Value {
    let mut brush = json!({"type": brush_type.name()});
    match brush_type {
        BrushType::Level | BrushType::SetHeight | BrushType::Ledge => brush["height"] = 40.into(),
        BrushType::Noise => brush["feature_size"] = 1500.into(),
        BrushType::ErodeFluvial | BrushType::ErodeThermal => brush["iterations"] = 3.into(),
        _ => {}
    }
    brush
}

/// Those that a layer cannot be made of: they need a stroke, a picture about one, or a mask.
const OF_STROKES: [BrushType; 9] = [
    BrushType::Ramp,
    BrushType::Smear,
    BrushType::Grab,
    BrushType::Clone,
    BrushType::Stamp,
    BrushType::PaintMask,
    BrushType::EraseMask,
    BrushType::FlowMask,
    BrushType::RainMask,
];
/// Those that need ground.
const OF_GROUND: [BrushType; 4] =
    [BrushType::ErodeThermal, BrushType::ErodeFluvial, BrushType::ErodeDroplets, BrushType::FillPits];

#[test]
fn every_brush_is_a_layer_at_every_level_or_is_refused() {
    let mut site = rich::flat();
    site.apply(&[fill("Base", 200.0, 1)]);
    let (mut num, mut num_refused) = (0, 0);
    for brush_type in BrushType::ALL {
        if brush_type == BrushType::Custom {
            continue;
        }
        for content in ["procedural", "effect"] {
            let what = format!("{content} of {}", brush_type.name());
            let add = json!({"op": "add_layer", "name": "New", "opacity": 0.5, "blend": "replace",
                "content": {"type": content, "brush": brush(brush_type), "seed": 3}});
            let is_refused = OF_STROKES.contains(&brush_type)
                || (content == "procedural" && OF_GROUND.contains(&brush_type));
            let done = orogeny_engine::Operation::from_json(add)
                .and_then(|operation| site.terrain.apply(&[operation], &mut Quiet));
            assert_eq!(done.is_err(), is_refused, "{what}: {done:?}");
            if is_refused {
                num_refused += 1;
                continue;
            }
            let store = Store::open_to_read(&site.path).unwrap();
            let layers = site.layers();
            for level in 0..=site.top_level() {
                let found = composite(&site.terrain, level);
                let plain = Plain { store: &store, layers: &layers, level };
                let expected = plain.composite().plane();
                assert_near(&expected, &found, 1.0e-5 * range_m(&expected).max(100.0), &what);
                num += 1;
            }
            assert_differs(&store_base(&store, &layers), &composite(&site.terrain, 0), &what);
            site.terrain.undo(1).unwrap();
        }
    }
    println!("{num} planes, {num_refused} brushes refused");
    assert_eq!(num_refused, 2 * OF_STROKES.len() + OF_GROUND.len());
}

/// The base alone.
fn store_base(store: &Store, layers: &[orogeny_engine::Layer]) -> Plane {
    Plain { store, layers: &layers[..1], level: 0 }.composite().plane()
}

/// A kernel of the user's own runs on a GPU only: a back end that does not run it does not take the layer, or the terrain could no longer
/// be read with it.
#[test]
fn a_layer_of_a_custom_brush_is_taken_by_who_can_run_it() {
    let mut site = Site::new([70, 90], 25.0, 64);
    site.apply(&[fill("Base", 60.0, 1)]);
    let file = site.file("steps.wgsl");
    std::fs::write(
        &file,
        "// Steps.\n// @param step_m: f32 = 20 (1 .. 100) \"height of a step, metres\"\n\
         fn brush(at: BrushInput) -> f32 {\n    return parameters.step_m * floor(at.height_m / parameters.step_m);\n}\n",
    )
    .unwrap();
    let add = json!({"op": "add_layer", "name": "Steps", "content": {"type": "effect", "brush": {"type": "custom", "file": file}}});
    let before = composite(&site.terrain, 0);
    let err = site.try_to(&add).unwrap_err().to_string();
    assert!(err.contains("software"), "{err}");
    assert_same(&before, &composite(&site.terrain, 0), "refused");
    drop(site.terrain);
    let on_gpu = Settings { adapter: Adapter::Software, ..settings() };
    site.terrain = Terrain::open(&site.path, on_gpu).unwrap();
    site.terrain.apply(&[operation(&add)], &mut Quiet).unwrap();
    std::fs::remove_file(&file).unwrap();
    for level in 0..=site.top_level() {
        let found = composite(&site.terrain, level);
        assert!(found.samples().iter().all(|height| height % 20.0 == 0.0), "level {level}");
    }
    assert_differs(&before, &composite(&site.terrain, 0), "the steps");
}

#[test]
fn terrains_of_every_shape_have_stacks() {
    let mut num = 0;
    for (number, sides) in [[1, 1], [1, 70], [2, 3], [64, 64], [130, 65], [5, 200]].into_iter().enumerate() {
        let mut site = Site::new(sides, 25.0, 64);
        let mut maker = Maker::new(0x5afe + number as u64, &site.terrain.grid());
        site.apply(&[json!({"op": "fill", "layer": "Base", "brush": maker.noise(150.0)})]);
        for blend in ["laplacian", "max", "laplacian"] {
            let name = maker.name();
            let brush = maker.noise(90.0);
            site.apply(&[
                json!({"op": "add_layer", "name": name, "blend": blend, "opacity": 0.7, "mask": [
                    {"gate": {"slope": {"min": 0, "max": 2, "feather": 3}}, "blur": 60}, {"gate": {"height": {"min": 100, "max": 900}}, "combine": "add"}]}),
                json!({"op": "fill", "layer": name, "brush": brush}),
                json!({"op": "add_layer", "name": maker.name(), "content": {"type": "effect", "brush": {"type": "smooth", "width": 70}}}),
            ]);
        }
        let store = Store::open_to_read(&site.path).unwrap();
        let layers = site.layers();
        for level in 0..=site.top_level() {
            // From the top, each over what the engine has below it.
            let mut seen = composite(&site.terrain, level);
            for layer in layers.iter().rev() {
                let hide = json!({"op": "set_layer", "layer": layer.id, "visible": false});
                site.apply(&[hide]);
                let below = composite(&site.terrain, level);
                let plain = Plain { store: &store, layers: &layers, level };
                let expected = plain.joined(layer, &Sheet::of(&below)).plane();
                assert_near(
                    &expected,
                    &seen,
                    5.0e-3,
                    &format!("{sides:?} at level {level}: {}", told(&layers)),
                );
                seen = below;
                num += 1;
            }
            site.terrain.undo(layers.len() as u32).unwrap();
        }
    }
    println!("{num} planes");
}

#[test]
fn heights_told_of_the_terrain_are_those_of_all_of_it() {
    let mut num = 0;
    let mut assert_told = |site: &Site, what: &str| {
        let plane = composite(&site.terrain, 0);
        let told = site.terrain.height_statistics(&mut Quiet).unwrap();
        let (low, high) =
            plane.samples().iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), height| {
                (low.min(*height), high.max(*height))
            });
        assert_eq!((told.min_m, told.max_m), (low, high), "{what}");
        let mean = plane.samples().iter().map(|height| f64::from(*height)).sum::<f64>()
            / plane.samples().len() as f64;
        assert!(
            (told.mean_m - mean).abs() < 1.0e-6 * mean.abs().max(1.0),
            "{what}: {} and {mean}",
            told.mean_m
        );
        let at = site.terrain.height_m([1200.0, 900.0]).unwrap();
        let spacing_m = site.terrain.grid().spacing_m();
        assert_eq!(at, plane.at((1200.0 / spacing_m) as u32, (900.0 / spacing_m) as u32), "{what}");
        num += 1;
    };
    assert_told(&rich::site(), "the rich stack");
    // Layers without pages, of which some are everywhere the same, and some here and there painted.
    let mut site = Site::new([300, 200], 25.0, 64);
    assert_told(&site, "nothing");
    let here_m = [1000.0, 1000.0];
    for operation in [
        json!({"op": "add_layer", "name": "Half", "height": 30, "opacity": 0.5}),
        json!({"op": "set_mask", "layer": "Half", "scale": 0.25}),
        json!({"op": "add_layer", "name": "Group", "content": {"type": "group"}, "opacity": 0.5}),
        json!({"op": "add_layer", "name": "Twice", "height": 2, "blend": "multiply", "group": "Group"}),
        dab("Group", "mask", "erase_mask", 300.0, here_m),
        dab("Base", "heights", "raise", 300.0, [5000.0, 3000.0]),
        json!({"op": "set_mask", "layer": "Group", "invert": true}),
        json!({"op": "add_layer", "name": "Deep", "height": -500, "blend": "max"}),
        dab("Deep", "heights", "raise", 600.0, [3000.0, 3000.0]),
        json!({"op": "set_layer", "layer": "Deep", "transform": {"move": [-500, 0]}}),
        json!({"op": "set_layer", "layer": "Deep", "visible": false}),
        json!({"op": "add_layer", "name": "Even", "height": 7, "blend": "laplacian", "opacity": 0.5}),
    ] {
        site.apply_one(&operation);
        assert_told(&site, &operation.to_string());
    }
    println!("{num} stacks");
}

/// A reader that was opened before sees what was committed since, of the layers that there were then.
#[test]
fn a_reader_beside_the_writer_keeps_nothing_stale() {
    let mut site = rich::site();
    let mut reader = afresh(&site.path);
    let here_m = rich::MIDDLE_M;
    let strokes = [
        dab("Base", "heights", "raise", 900.0, here_m),
        dab("Massif", "mask", "erase_mask", 900.0, here_m),
        dab("Hill", "heights", "lower", 900.0, here_m),
        dab("Base", "selection", "erase_mask", 900.0, here_m),
        dab("Blended", "heights", "raise", 900.0, here_m),
    ];
    for stroke in &strokes {
        let before = composite(&reader, 0);
        site.apply_one(stroke);
        assert_same(&before, &composite(&reader, 0), "what the reader has not looked for yet");
        reader.refresh().unwrap();
        for level in [1, 0] {
            let found = composite(&reader, level);
            assert_same(&composite(&site.terrain, level), &found, &format!("{stroke} at level {level}"));
        }
        assert_differs(&before, &composite(&reader, 0), &stroke.to_string());
    }
    site.terrain.undo(3).unwrap();
    reader.refresh().unwrap();
    for (place, layer) in site.layers().iter().enumerate() {
        let mask = ExportSource::Mask(LayerReference::Id(layer.id));
        let found = read(&reader, &mask, None, 0);
        assert_same(&read(&site.terrain, &mask, None, 0), &found, &format!("undone, layer {place}"));
    }
    assert_same(&composite(&site.terrain, 0), &composite(&reader, 0), "undone");
}
