//! Random layers, masks and what is done to them, as operations in JSON: a function of a seed.

use orogeny_engine::{Layer, TerrainGrid};
use orogeny_field::LayerContent;
use orogeny_tests::Random;
use serde_json::{Value, json};

/// What makes operations up.
pub struct Maker {
    pub random: Random,
    spacing_m: f64,
    extent_m: [f64; 2],
    num_names: u32,
    /// Whether effects that are kept are made too.
    pub makes_kept: bool,
}

impl Maker {
    pub fn new(seed: u64, grid: &TerrainGrid) -> Self {
        let spacing_m = grid.spacing_m();
        let extent_m = [grid.width(), grid.depth()].map(|samples| f64::from(samples) * spacing_m);
        Self { random: Random::new(seed), spacing_m, extent_m, num_names: 0, makes_kept: false }
    }

    pub fn chance(&mut self, share: f64) -> bool {
        self.random.within(0.0, 1.0) < share
    }

    fn seed(&mut self) -> u32 {
        self.random.bits() as u32
    }

    /// A name that no layer has.
    pub fn name(&mut self) -> String {
        self.num_names += 1;
        format!("Layer {}", self.num_names)
    }

    /// A place, now and then beyond the edge.
    fn at_m(&mut self) -> [f64; 2] {
        self.extent_m.map(|side_m| self.random.within(-0.05, 1.05) * side_m)
    }

    /// A part of the terrain, as regions are given.
    pub fn region_m(&mut self) -> [f64; 4] {
        let [x, z] = self.extent_m.map(|side_m| self.random.within(0.0, 0.95) * side_m);
        let [width, depth] = self.extent_m.map(|side_m| self.random.within(0.01, 0.6) * side_m);
        [x, z, width, depth]
    }

    pub fn noise(&mut self, strength_m: f64) -> Value {
        json!({
            "type": "noise", "strength": strength_m, "seed": self.seed(),
            "feature_size": self.spacing_m * self.random.within(12.0, 120.0),
            "octaves": self.random.one_of(&[1, 3, 5]),
            "turbulence": self.random.one_of(&["fbm", "ridged", "billowy"]),
            "basis": self.random.one_of(&["gradient", "simplex"]),
        })
    }

    fn effect_brush(&mut self) -> Value {
        let strength = self.random.within(0.3, 1.0);
        match self.random.bits() % 5 {
            0 => {
                json!({"type": "smooth", "strength": strength, "width": self.spacing_m * self.random.within(0.5, 12.0)})
            }
            1 => {
                json!({"type": "sharpen", "strength": strength, "gain": 0.5, "width": self.spacing_m * self.random.within(1.0, 4.0)})
            }
            2 => {
                json!({"type": "terrace", "strength": strength, "step": self.random.within(20.0, 90.0), "sharpness": self.random.within(0.1, 0.7)})
            }
            3 => {
                json!({"type": "range_map", "strength": strength, "low": -200, "high": self.random.within(300.0, 900.0),
                "mapping": self.random.one_of(&["bias", "gain"])})
            }
            _ => {
                json!({"type": "level", "strength": 0.4 * strength, "height": self.random.within(-50.0, 300.0)})
            }
        }
    }

    fn kept_brush(&mut self) -> Value {
        match self.random.bits() % 4 {
            0 | 1 => {
                json!({"type": "erode_thermal", "iterations": 4, "talus_angle": self.random.within(1.0, 20.0)})
            }
            2 => json!({"type": "fill_pits"}),
            _ => json!({"type": "erode_fluvial", "iterations": 5}),
        }
    }

    pub fn content(&mut self) -> Value {
        let seed = self.seed();
        match self.random.bits() % if self.makes_kept { 8 } else { 7 } {
            0..=2 => json!({"type": "heights"}),
            3 | 4 => {
                let strength_m = self.random.within(10.0, 150.0);
                let brush = if self.chance(0.8) {
                    self.noise(strength_m)
                } else {
                    json!({"type": "roughen", "strength": 3})
                };
                json!({"type": "procedural", "seed": seed, "brush": brush})
            }
            5 | 6 => json!({"type": "effect", "seed": seed, "brush": self.effect_brush()}),
            _ => json!({"type": "effect", "seed": seed, "brush": self.kept_brush()}),
        }
    }

    fn blend(&mut self) -> Value {
        let all = ["add", "add", "subtract", "max", "min", "replace", "laplacian"];
        self.random.one_of(&all).into()
    }

    fn opacity(&mut self) -> f32 {
        if self.chance(0.5) { 1.0 } else { self.random.within(0.05, 1.0) as f32 }
    }

    /// A transform, as often a move alone as one that turns or enlarges too; now and then an extreme one.
    pub fn transform(&mut self) -> Value {
        let move_m = self.extent_m.map(|side_m| self.random.within(-0.3, 0.3) * side_m);
        let mut transform = json!({ "move": move_m });
        if self.chance(0.08) {
            let far_m = self.random.one_of(&[1.0e8, 2.0e4, -1.0e8]);
            let (rotate, scale) =
                (self.random.within(-36_000.0, 36_000.0), self.random.one_of(&[0.01, 1.0, 100.0]));
            return json!({"move": [far_m, self.at_m()[1]], "rotate": rotate, "scale": scale, "pivot": self.at_m()});
        }
        match self.random.bits() % 4 {
            0 => {}
            1 => transform["rotate"] = self.random.one_of(&[90, 180, -90, 270]).into(),
            _ => {
                transform["rotate"] = self.random.within(-180.0, 180.0).into();
                transform["scale"] = self.random.one_of(&[0.12, 0.3, 0.55, 0.9, 1.0, 1.7]).into();
                transform["height_scale"] = self.random.within(-1.5, 1.5).into();
            }
        }
        transform["pivot"] = json!(self.at_m());
        transform
    }

    fn gate(&mut self) -> Value {
        let mut gate = json!({});
        let low = self.random.within(-100.0, 250.0);
        match self.random.bits() % 6 {
            0 => {
                let (min, max) = (self.random.within(0.0, 6.0), self.random.within(7.0, 60.0));
                gate["slope"] =
                    json!({"min": min, "max": max, "feather": self.random.one_of(&[0.0, 5.0, 15.0])});
                if self.chance(0.3) {
                    gate["curvature"] = json!({"min": -0.5, "max": 2, "feather": 3});
                }
            }
            1 => {
                let angle = self.random.within(-180.0, 180.0);
                gate["aspect"] =
                    json!({"angle": angle, "width": self.random.within(10.0, 120.0), "feather": 30});
            }
            2 => gate["selection"] = true.into(),
            3 => {
                let mut pattern = self.noise(1.0);
                let pattern = pattern.as_object_mut().unwrap();
                pattern.remove("type");
                pattern.remove("strength");
                gate["noise"] = json!({"min": 0.1, "max": 0.6, "feather": 0.4, "pattern": pattern});
            }
            _ => {
                let high = low + self.random.within(0.0, 400.0);
                gate["height"] =
                    json!({"min": low, "max": high, "feather": self.random.one_of(&[0.0, 40.0, 150.0])});
            }
        }
        gate["inverted"] = self.chance(0.2).into();
        gate
    }

    fn term(&mut self, layers: &[Layer]) -> Value {
        let other = self.random.one_of(layers);
        let mut term = match self.random.bits() % 5 {
            3 if other.content == LayerContent::Heights => {
                let low = self.random.within(-50.0, 100.0);
                let high = low + self.random.one_of(&[-150.0, 100.0, 300.0]);
                json!({"heights": {"layer": other.id, "low": low, "high": high}})
            }
            4 => json!({"mask": other.id}),
            _ => json!({"gate": self.gate()}),
        };
        if self.chance(0.3) {
            term["blur"] = (self.spacing_m * self.random.within(0.3, 3.9)).into();
        }
        if self.chance(0.3) {
            term["invert"] = true.into();
        }
        if self.chance(0.3) {
            term["curve"] = json!([[0, 0], [0.4, self.random.within(0.1, 0.8)], [1, 1]]);
        }
        term["combine"] =
            self.random.one_of(&["multiply", "multiply", "add", "subtract", "max", "min"]).into();
        term
    }

    /// None, or up to three terms.
    pub fn terms(&mut self, layers: &[Layer]) -> Vec<Value> {
        let count = self.random.one_of(&[0, 0, 1, 1, 2, 3]);
        (0..count).map(|_| self.term(layers)).collect()
    }

    /// A layer that is made, anywhere in the stack.
    pub fn add(&mut self, layers: &[Layer]) -> Value {
        let (name, content) = (self.name(), self.content());
        let mut add = json!({"op": "add_layer", "name": name, "opacity": self.opacity(), "content": content});
        let is_heights = content["type"] == "heights";
        if is_heights && self.chance(0.25) {
            // Around 1: the product stays what heights are.
            (add["blend"], add["height"]) = ("multiply".into(), 1.into());
            add["transform"] = json!({"height_scale": 1});
        } else {
            add["blend"] = self.blend();
            if is_heights {
                add["height"] = self.random.within(-20.0, 60.0).into();
                if self.chance(0.4) {
                    add["transform"] = self.transform();
                }
            }
        }
        add["mask"] = self.terms(layers).into();
        if self.chance(0.12) {
            add["visible"] = false.into();
        }
        self.place(&mut add, layers);
        add
    }

    pub fn add_group(&mut self, layers: &[Layer]) -> Value {
        let mut add = json!({"op": "add_layer", "name": self.name(), "content": {"type": "group"}, "opacity": self.opacity()});
        if self.chance(0.4) {
            add["mask"] = self.terms(layers).into();
        }
        if self.chance(0.1) {
            add["visible"] = false.into();
        }
        self.place(&mut add, layers);
        add
    }

    fn place(&mut self, operation: &mut Value, layers: &[Layer]) {
        if self.chance(0.3) {
            operation["above"] = self.random.one_of(layers).id.into();
        }
        let groups: Vec<u32> = layers
            .iter()
            .filter(|layer| layer.content == LayerContent::Group)
            .map(|layer| layer.id)
            .collect();
        if !groups.is_empty() && self.chance(0.5) {
            operation["group"] = self.random.one_of(&groups).into();
        }
    }

    /// A fill or stroke of heights of a layer.
    pub fn paint(&mut self, layer: &Layer) -> Value {
        // A factor.
        if layer.constant_m == 1.0 {
            return json!({"op": "fill", "layer": layer.id, "brush": self.noise(0.3)});
        }
        if self.chance(0.5) {
            let strength_m = self.random.within(20.0, 200.0);
            return json!({"op": "fill", "layer": layer.id, "brush": self.noise(strength_m), "region": self.region_m()});
        }
        let brush = json!({"type": self.random.one_of(&["raise", "lower"]), "strength": self.random.within(10.0, 90.0),
            "radius": self.spacing_m * self.random.within(5.0, 60.0)});
        json!({"op": "stroke", "layer": layer.id, "brush": brush, "points": [self.at_m(), self.at_m()]})
    }

    /// A stroke on a layer's mask, or on the selection.
    pub fn paint_mask(&mut self, layer: &Layer, target: &str) -> Value {
        let brush_type = self.random.one_of(&["paint_mask", "erase_mask"]);
        let mut brush =
            json!({"type": brush_type, "radius": self.spacing_m * self.random.within(10.0, 90.0)});
        if brush_type == "paint_mask" {
            brush["value"] = self.random.within(0.0, 1.0).into();
        }
        json!({"op": "stroke", "layer": layer.id, "target": target, "brush": brush, "points": [self.at_m(), self.at_m()]})
    }

    /// A stroke or fill that looks at the heights that are seen, wherever it goes.
    pub fn paint_seen(&mut self, layer: &Layer) -> Value {
        let mut brush = match self.random.bits() % 4 {
            0 => json!({"type": "smooth", "width": self.spacing_m * self.random.within(0.5, 6.0)}),
            1 => json!({"type": "level", "strength": 0.7, "height": self.random.within(-50.0, 300.0)}),
            2 => json!({"type": "raise", "strength": 40, "gate": self.gate()}),
            _ => json!({"type": "terrace", "step": 30}),
        };
        let target = self.random.one_of(&["seen", "seen", "heights"]);
        if self.chance(0.3) {
            return json!({"op": "fill", "layer": layer.id, "target": target, "brush": brush, "region": self.region_m()});
        }
        brush["radius"] = (self.spacing_m * self.random.within(5.0, 40.0)).into();
        json!({"op": "stroke", "layer": layer.id, "target": target, "brush": brush, "points": [self.at_m(), self.at_m()]})
    }

    /// A change of the selection in one step.
    pub fn select(&mut self, layer: &Layer) -> Value {
        let shape = match self.random.bits() % 6 {
            0 => json!({"mask": layer.id}),
            1 => json!({"gate": self.gate(), "region": self.region_m()}),
            2 => json!({"gate": self.gate()}),
            3 => json!({"lasso": [self.at_m(), self.at_m(), self.at_m(), self.at_m()]}),
            4 => json!({"nothing": true}),
            _ => json!({"rectangle": self.region_m()}),
        };
        let mut select = json!({"op": "select", "shape": shape, "invert": self.chance(0.2)});
        select["combine"] = self.random.one_of(&["replace", "add", "subtract", "intersect"]).into();
        if self.chance(0.4) {
            select["grow"] = (self.spacing_m * self.random.within(0.0, 9.0)).into();
            select["feather"] = (self.spacing_m * self.random.within(0.0, 6.0)).into();
        }
        select
    }

    /// A mask that a brush makes, and that is kept.
    pub fn make_mask(&mut self, layer: &Layer) -> Value {
        let brush = match self.random.bits() % 3 {
            0 => json!({"type": "flow_mask", "from": 4000, "to": 4_000_000}),
            1 => json!({"type": "rain_mask", "iterations": 4}),
            _ => json!({"type": "paint_mask", "gate": self.gate()}),
        };
        json!({"op": "set_mask", "layer": layer.id, "brush": {"brush": brush, "seed": 4}, "invert": self.chance(0.3)})
    }

    pub fn set_mask(&mut self, layer: &Layer, layers: &[Layer]) -> Value {
        let moved = layer.content == LayerContent::Heights && !layer.transform.is_identity();
        let from =
            self.random.one_of(&["keep", "keep", "all", "nothing", if moved { "keep" } else { "selection" }]);
        let mut set = json!({"op": "set_mask", "layer": layer.id, "from": from, "invert": self.chance(0.5)});
        if self.chance(0.3) {
            set["scale"] = self.random.within(0.1, 1.0).into();
        }
        if self.chance(0.4) {
            set["terms"] = self.terms(layers).into();
        }
        set
    }

    /// One or two settings of a layer changed.
    pub fn set(&mut self, layer: &Layer) -> Value {
        let mut set = json!({"op": "set_layer", "layer": layer.id});
        for _ in 0..self.random.one_of(&[1, 2]) {
            match self.random.bits() % 6 {
                0 | 1 => set["opacity"] = self.opacity().into(),
                2 => set["visible"] = (!layer.visible).into(),
                3 if layer.constant_m != 1.0 => set["blend"] = self.blend(),
                4 if layer.content == LayerContent::Heights => {
                    set["transform"] = if self.chance(0.4) { json!({}) } else { self.transform() };
                }
                4 if layer.content.procedure().is_some() => {
                    let mut content = json!({"type": "effect", "brush": self.effect_brush()});
                    if layer.content.name() == "procedural" {
                        content = json!({"type": "procedural", "brush": self.noise(80.0)});
                    }
                    content["seed"] = self.seed().into();
                    set["content"] = content;
                }
                _ => set["name"] = self.name().into(),
            }
        }
        set
    }

    pub fn move_layer(&mut self, layer: &Layer, layers: &[Layer]) -> Value {
        let mut operation = json!({"op": "move_layer", "layer": layer.id});
        self.place(&mut operation, layers);
        operation
    }
}
