//! What is drawn with: a brush for each type, as it was last used, and where it goes.

use std::collections::BTreeMap;

use orogeny_engine::session::Status;
use orogeny_engine::{BrushOperation, BrushType, Coverage, Operation, Parameter, ParameterKind, Presets};
use serde_json::{Map, Value, json};

use crate::Result;

/// The share of the terrain's longer side that a brush is wide at first: half of it is its radius.
const FIRST_RADIUS: f64 = 1.0 / 25.0;
/// What of its radius a brush raises by at full strength, in one pass.
const FULL_STRENGTH: f64 = 0.2;
/// A step of the keys for size and strength: three of them double.
const STEP: f64 = 1.259_921_049_894_873_2;

/// What another key held while drawing makes of a brush.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Twist {
    /// Nothing.
    #[default]
    None,
    /// Its opposite.
    Inverted,
    /// Smoothing, as wide as it.
    Smooth,
}

/// The brush in the hand.
#[derive(Debug, Clone, PartialEq)]
pub struct Tool {
    /// Its type.
    pub brush_type: BrushType,
    /// Parameters of each type by its name, without the type; what is not there is its default.
    pub objects: BTreeMap<String, Map<String, Value>>,
    /// Whether it paints on the layer's mask.
    pub is_on_mask: bool,
    /// Whether it paints on the selection.
    pub is_on_selection: bool,
    /// What a brush that the user wrote is painted with in place of its file, while that does not compile.
    pub stand_in: Option<String>,
    /// What the last stroke's seed was.
    seed: u32,
    first_radius_m: f64,
}

impl Tool {
    /// For a terrain, with parameters as they were last used.
    #[must_use]
    pub fn new(brush: &str, objects: BTreeMap<String, Map<String, Value>>) -> Self {
        Self {
            brush_type: BrushType::from_name(brush).unwrap_or(BrushType::Raise),
            objects,
            is_on_mask: false,
            is_on_selection: false,
            stand_in: None,
            seed: 0,
            first_radius_m: 50.0,
        }
    }

    /// Brushes that were never used are as wide as befits the terrain.
    pub fn set_terrain(&mut self, status: &Status) {
        let side = status.grid.width().max(status.grid.depth());
        let radius_m = f64::from(side) * status.grid.spacing_m() * FIRST_RADIUS / 2.0;
        self.first_radius_m = round_to_two_digits(radius_m);
    }

    /// What a type was last used with.
    #[must_use]
    pub fn object(&self) -> Map<String, Value> {
        self.objects.get(self.brush_type.name()).cloned().unwrap_or_default()
    }

    /// Whether the brush goes on where it rests.
    #[must_use]
    pub fn is_airbrush(&self) -> bool {
        self.object().get("airbrush").and_then(Value::as_bool) == Some(true)
    }

    /// Changes a parameter of the brush; `None` for its default.
    pub fn set(&mut self, name: &str, value: Option<Value>) {
        let object = self.objects.entry(self.brush_type.name().to_owned()).or_default();
        match value {
            Some(value) => object.insert(name.to_owned(), value),
            None => object.remove(name),
        };
    }

    /// Takes a brush with all its parameters, as a preset has it.
    pub fn take_up(&mut self, object: &Map<String, Value>) {
        let name = object.get("type").and_then(Value::as_str).unwrap_or_default();
        let Some(brush_type) = BrushType::from_name(name) else { return };
        let mut object = object.clone();
        object.remove("type");
        self.brush_type = brush_type;
        self.objects.insert(brush_type.name().to_owned(), object);
    }

    /// Takes up a brush that the user wrote, as it was last used; the first time at its full strength, as shapes are written for that.
    pub fn take_file(&mut self, file: &str) {
        let custom = BrushType::Custom.name();
        self.brush_type = BrushType::Custom;
        let present = self.objects.remove(custom).unwrap_or_default();
        let known = match present.get("file").and_then(Value::as_str).map(str::to_owned) {
            Some(same) if same == file => Some(present),
            Some(other) => {
                self.objects.insert(format!("{custom} {other}"), present);
                self.objects.remove(&format!("{custom} {file}"))
            }
            None => self.objects.remove(&format!("{custom} {file}")),
        };
        let first =
            || Map::from_iter([("file".to_owned(), file.into()), ("strength".to_owned(), 1.0.into())]);
        self.objects.insert(custom.to_owned(), known.unwrap_or_else(first));
    }

    /// The file of the brush in the hand, where the user wrote it.
    #[must_use]
    pub fn file(&self) -> Option<String> {
        if self.brush_type != BrushType::Custom {
            return None;
        }
        self.objects.get(self.brush_type.name())?.get("file")?.as_str().map(str::to_owned)
    }

    /// Takes up the brush that copies, from a place in metres.
    pub fn copy_from(&mut self, [x_m, z_m]: [f64; 2]) {
        self.brush_type = BrushType::Clone;
        self.set("source", Some(json!({"at": [x_m, z_m]})));
    }

    /// Where the brush copies from, metres.
    #[must_use]
    pub fn source_m(&self) -> Option<[f64; 2]> {
        if self.brush_type != BrushType::Clone {
            return None;
        }
        let object = self.object();
        let at = object.get("source")?.get("at")?.as_array()?;
        let along = |index: usize| at.get(index).and_then(Value::as_f64);
        Some([along(0)?, along(1)?])
    }

    fn number(&self, name: &str) -> Option<f64> {
        self.objects.get(self.brush_type.name())?.get(name)?.as_f64()
    }

    /// Half of its width, metres.
    #[must_use]
    pub fn radius_m(&self) -> f64 {
        self.number("radius").unwrap_or(self.first_radius_m)
    }

    /// Whether its strength is in metres.
    #[must_use]
    pub fn is_in_metres(&self) -> bool {
        self.brush_type.coverage() == Coverage::Additive
    }

    /// What its strength is as recipes have it, where its share is 1.
    fn full_strength(&self) -> f64 {
        if self.is_in_metres() { FULL_STRENGTH * self.radius_m() } else { 1.0 }
    }

    /// How strong it is, 0..1, the same for all brushes: of one whose strength is in metres, 1 is a fifth of its radius a pass.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.number("strength").map_or(0.5, |strength| strength / self.full_strength())
    }

    /// Its strength as recipes have it.
    #[must_use]
    pub fn strength(&self) -> f64 {
        self.share() * self.full_strength()
    }

    /// Makes it another size, and leaves the share of its strength as it is.
    pub fn set_radius_m(&mut self, radius_m: f64) {
        let share = self.share();
        let (low, high) = limits(self.brush_type, "radius");
        self.set("radius", Some(radius_m.clamp(low, high).into()));
        if self.number("strength").is_some() {
            self.set_share(share);
        }
    }

    /// Makes it weaker or stronger.
    pub fn set_share(&mut self, share: f64) {
        let (low, high) = limits(self.brush_type, "strength");
        self.set("strength", Some((share * self.full_strength()).clamp(low, high).into()));
    }

    /// A step of the keys, up or down.
    pub fn resize(&mut self, steps: i32) {
        self.set_radius_m(self.radius_m() * STEP.powi(steps));
    }

    /// A step of the keys, up or down.
    pub fn strengthen(&mut self, steps: i32) {
        self.set_share((self.share() * STEP.powi(steps)).clamp(0.001, 1.0));
    }

    /// The brush object as a recipe has it.
    #[must_use]
    pub fn brush_json(&self, twist: Twist) -> Map<String, Value> {
        let mut object = self.object();
        object.entry("radius").or_insert_with(|| self.radius_m().into());
        if Parameter::of(self.brush_type).any(|parameter| parameter.name == "strength") {
            object.entry("strength").or_insert_with(|| self.strength().into());
        }
        let brush_type = match twist {
            Twist::Smooth if !self.brush_type.is_for_masks() => {
                let strength = self.share().clamp(0.05, 1.0);
                object = Map::from_iter([
                    ("radius".to_owned(), self.radius_m().into()),
                    ("strength".to_owned(), strength.into()),
                ]);
                BrushType::Smooth
            }
            Twist::Inverted => opposite(self.brush_type),
            Twist::None | Twist::Smooth => self.brush_type,
        };
        // What its opposite does not have is left out.
        object.retain(|name, _| Parameter::of(brush_type).any(|parameter| parameter.name == name));
        object.insert("type".to_owned(), brush_type.name().into());
        object
    }

    /// [`Self::brush_json`] as it is painted with.
    #[must_use]
    pub fn painted_json(&self, twist: Twist) -> Map<String, Value> {
        let mut object = self.brush_json(twist);
        if let (Some(file), true) = (&self.stand_in, object.contains_key("file")) {
            object.insert("file".to_owned(), file.as_str().into());
        }
        object
    }

    /// What it paints on, as recipes have it.
    const fn target(&self, is_on_mask: bool) -> &'static str {
        match (self.is_on_selection, is_on_mask || self.is_on_mask || self.brush_type.is_for_masks()) {
            (true, _) => "selection",
            (false, true) => "mask",
            (false, false) => "seen",
        }
    }

    /// The next stroke has chances of its own.
    const fn next_seed(&mut self) {
        self.seed = self.seed.wrapping_add(1);
    }

    /// A stroke without points that begins now: see [`Self::stroke`].
    ///
    /// # Errors
    /// As there.
    pub fn begin(
        &mut self,
        layer: u32,
        is_on_mask: bool,
        twist: Twist,
        presets: &Presets,
    ) -> Result<BrushOperation> {
        self.next_seed();
        self.stroke(layer, is_on_mask, twist, presets)
    }

    /// A stroke without points on a layer, or on its mask where that is all that can be painted on.
    ///
    /// # Errors
    /// What is wrong with its parameters.
    pub fn stroke(
        &self,
        layer: u32,
        is_on_mask: bool,
        twist: Twist,
        presets: &Presets,
    ) -> Result<BrushOperation> {
        let value = json!({
            "op": "stroke",
            "seed": self.seed,
            "layer": layer,
            "target": self.target(is_on_mask),
            "brush": self.painted_json(twist),
            "points": [],
        });
        match Operation::from_json_with(value, presets)? {
            Operation::Brush(operation) => Ok(operation),
            // A stroke is read as one.
            Operation::Layers(_) | Operation::Select(_) => Err(orogeny_engine::Error::Cancelled.into()),
        }
    }

    /// The same brush over all of a layer, or of its mask where that is all that can be painted on.
    ///
    /// # Errors
    /// What is wrong with its parameters.
    pub fn fill(&mut self, layer: u32, is_on_mask: bool, presets: &Presets) -> Result<Operation> {
        self.next_seed();
        let mut brush = self.painted_json(Twist::None);
        brush.remove("radius");
        let value = json!({
            "op": "fill", "seed": self.seed, "layer": layer, "target": self.target(is_on_mask), "brush": brush,
        });
        Ok(Operation::from_json_with(value, presets)?)
    }
}

/// The brush that does the opposite; itself where there is none.
const fn opposite(brush_type: BrushType) -> BrushType {
    match brush_type {
        BrushType::Raise => BrushType::Lower,
        BrushType::Lower => BrushType::Raise,
        BrushType::Smooth => BrushType::Sharpen,
        BrushType::Sharpen => BrushType::Smooth,
        BrushType::PaintMask => BrushType::EraseMask,
        BrushType::EraseMask => BrushType::PaintMask,
        other => other,
    }
}

/// Least and largest value of a number of a brush.
pub(crate) fn limits(brush_type: BrushType, name: &str) -> (f64, f64) {
    let kind = Parameter::of(brush_type).find(|parameter| parameter.name == name).map(|found| found.kind);
    match kind {
        Some(ParameterKind::Number { min, max, .. }) => (min, max),
        _ => (0.0, 1.0),
    }
}

fn round_to_two_digits(value: f64) -> f64 {
    let power = 10.0_f64.powf(value.max(1.0e-6).log10().floor() - 1.0);
    (value / power).round() * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_brush_makes_an_operation_at_first_use() {
        for brush_type in BrushType::ALL {
            let mut tool = Tool::new(brush_type.name(), BTreeMap::new());
            // These need something of the user's.
            match brush_type {
                BrushType::Stamp | BrushType::Custom => continue,
                BrushType::SetHeight => tool.set("height", Some(10.0.into())),
                BrushType::Clone => tool.copy_from([100.0, 200.0]),
                _ => {}
            }
            for twist in [Twist::None, Twist::Inverted, Twist::Smooth] {
                tool.stroke(1, false, twist, Presets::factory())
                    .unwrap_or_else(|err| panic!("{brush_type:?}: {err}"));
            }
        }
    }

    #[test]
    fn size_keeps_the_share_of_the_strength() {
        let mut tool = Tool::new("raise", BTreeMap::new());
        tool.set_share(0.3);
        tool.resize(3);
        assert!((tool.radius_m() - 100.0).abs() < 1.0e-9 && (tool.share() - 0.3).abs() < 1.0e-12);
        assert!((tool.strength() - 6.0).abs() < 1.0e-9);
        tool.resize(-300);
        tool.strengthen(-300);
        assert!(tool.radius_m() > 0.0 && tool.share() > 0.0);
        tool.strengthen(300);
        assert!(tool.share() <= 1.0);
    }

    #[test]
    fn each_file_keeps_its_own() {
        let mut tool = Tool::new("raise", BTreeMap::new());
        tool.take_file("a.wgsl");
        assert_eq!(
            (tool.file().as_deref(), tool.brush_json(Twist::None)["strength"].as_f64()),
            (Some("a.wgsl"), Some(1.0))
        );
        tool.set("parameters", Some(json!({"depth_m": 3})));
        tool.take_file("b.wgsl");
        assert!(!tool.object().contains_key("parameters"));
        tool.stand_in = Some("copy.wgsl".to_owned());
        assert_eq!(tool.painted_json(Twist::None)["file"], "copy.wgsl");
        assert_eq!(tool.brush_json(Twist::None)["file"], "b.wgsl", "a preset keeps the file itself");
        for _ in 0..2 {
            tool.take_file("a.wgsl");
            assert_eq!(tool.object()["parameters"]["depth_m"], 3);
        }
    }

    #[test]
    fn each_brush_keeps_its_own() {
        let mut tool = Tool::new("raise", BTreeMap::new());
        tool.set_radius_m(33.0);
        tool.brush_type = BrushType::Smooth;
        tool.set_radius_m(77.0);
        tool.brush_type = BrushType::Raise;
        assert_eq!(tool.radius_m(), 33.0);
        let preset = json!({"type": "smooth", "radius": 12, "width": 3});
        tool.take_up(preset.as_object().unwrap());
        assert_eq!((tool.brush_type, tool.radius_m()), (BrushType::Smooth, 12.0));
        assert_eq!(tool.brush_json(Twist::None)["width"], 3);
    }
}
