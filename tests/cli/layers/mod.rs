//! The layer stack by the command `layer`, by recipes and as it is exported, each command a process of its own.

mod made;
mod recipes;
mod refusals;
mod stack;

use serde_json::{Value, json};

use crate::program::Folder;

const SIDE: usize = 100;

/// Flat, at 100 m.
fn terrain() -> Folder {
    let folder = Folder::new();
    folder.succeed(&format!("new t.orogeny --size {SIDE}x{SIDE} --spacing 1 --height 100"));
    folder
}

/// What `info` says of the layers, from the bottom.
fn layers(folder: &Folder) -> Vec<Value> {
    folder.succeed("info t.orogeny")["layers"].as_array().unwrap().clone()
}

fn layer(folder: &Folder, name: &str) -> Value {
    let layers = layers(folder);
    layers.into_iter().find(|layer| layer["name"] == name).unwrap_or_else(|| panic!("there is no {name}"))
}

/// The names from the bottom.
fn names(folder: &Folder) -> Vec<String> {
    layers(folder).iter().map(|layer| layer["name"].as_str().unwrap().to_owned()).collect()
}

fn heights(folder: &Folder) -> Vec<f32> {
    folder.heights_of("t.orogeny")
}

/// The height that is the same everywhere.
fn height(folder: &Folder) -> f32 {
    let heights = heights(folder);
    assert!(heights.iter().all(|height_m| *height_m == heights[0]), "it is not the same everywhere");
    heights[0]
}

fn exported(folder: &Folder, options: &str) -> Vec<f32> {
    folder.succeed(&format!("export t.orogeny part.r32 {options}"));
    folder.heights("part.r32")
}

fn at(plane: &[f32], x: usize, z: usize) -> f32 {
    plane[z * SIDE + x]
}

/// A dab of 10 m at (30, 40) m, with a radius of 10 m and no slope.
fn dab(layer: &str) -> Value {
    let brush = json!({"type": "raise", "radius": 10, "falloff": 0, "strength": 10});
    json!({"op": "stroke", "layer": layer, "brush": brush, "points": [[30, 40]]})
}

/// Selects the square of 20 m from (50, 50) m on.
fn selecting() -> Value {
    json!({"op": "fill", "target": "selection", "brush": {"type": "paint_mask"}, "region": [50, 50, 20, 20]})
}
