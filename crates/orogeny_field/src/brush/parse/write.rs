//! Brushes to JSON.

use serde_json::{Map, Value, json};

use super::{cloning, drainage, gate, noise};
use crate::brush::{
    Alpha, Brush, BrushType, DataSource, Dynamics, Jitter, Parameter, ProfileShape, RangeMapping, Symmetry,
    SymmetryKind,
};
use crate::{Curve, RockLayer};

/// The word that a value serialises to.
pub(super) fn word(value: &impl serde::Serialize) -> Value {
    serde_json::to_value(value).unwrap_or(Value::Null)
}

pub(super) fn curve(curve: &Curve) -> Value {
    json!(curve.points())
}

impl Brush {
    /// Writes all parameters that the brush has, so that reading them back gives the same brush.
    #[must_use]
    pub fn to_json(&self) -> Map<String, Value> {
        let mut object = Map::new();
        let mut put = |name: &str, value: Value| {
            if name == "type" || Parameter::find(self.brush_type, name).is_some() {
                object.insert(name.to_owned(), value);
            }
        };
        put("type", self.brush_type.name().into());
        put("radius", self.radius_m.into());
        put("falloff", self.falloff_m.into());
        for (name, value) in profile(&self.shape) {
            put(name, value);
        }
        put("strength", self.strength.into());
        put("flow", self.flow.into());
        put("spacing", self.spacing.into());
        put("pressure", word(&self.pressure));
        put("blending", word(&self.blending));
        put("airbrush", self.is_airbrush.into());
        if self.dynamics != Dynamics::default() {
            put("dynamics", dynamics(&self.dynamics));
        }
        if self.jitter != Jitter::default() {
            let Jitter { radius, position, strength } = self.jitter;
            put("jitter", json!({ "radius": radius, "position": position, "strength": strength }));
        }
        if let Some(given) = &self.alpha {
            put("alpha", alpha(given));
        }
        if let Some(given) = &self.symmetry {
            put("mirror", symmetry(given));
        }
        if let Some(given) = &self.gate {
            put("gate", gate::write(given));
        }
        if let Some(given) = &self.hardness {
            put("hardness", gate::write(given));
        }
        for (name, height_m) in [("height", self.height_m), ("end_height", self.end_height_m)] {
            if let Some(height_m) = height_m {
                put(name, f64::from(height_m).into());
            }
        }
        put("along", word(&self.along));
        put("direction", word(&self.direction));
        put("only", word(&self.only));
        put("method", word(&self.smoothing.method));
        if let Some(width_m) = self.smoothing.width_m {
            put("width", width_m.into());
        }
        if self.brush_type == BrushType::Sharpen {
            put("gain", self.smoothing.gain.into());
        }
        match self.brush_type {
            BrushType::ErodeThermal => {
                let rock = self.thermal.layers.first();
                put("iterations", self.thermal.iterations.into());
                put("talus_angle", rock.map_or(0.0, |rock| rock.talus_angle_deg).into());
                put("rate", rock.map_or(0.0, |rock| rock.rate).into());
                let layer = |rock: &RockLayer| json!({ "from": rock.from_m, "talus_angle": rock.talus_angle_deg, "rate": rock.rate });
                let layers: Vec<_> = self.thermal.layers.iter().skip(1).map(layer).collect();
                if !layers.is_empty() {
                    put("layers", layers.into());
                }
            }
            BrushType::ErodeFluvial | BrushType::RainMask => {
                put("iterations", self.pipes.iterations.into());
                put("rain", self.pipes.rain_m_per_s.into());
                put("evaporation", self.pipes.evaporation_per_s.into());
                put("capacity", self.pipes.capacity_s_per_m.into());
                put("dissolving", self.pipes.dissolving_per_s.into());
                put("deposition", self.pipes.deposition_per_s.into());
                put("min_slope", self.pipes.min_slope_deg.into());
                put("friction", self.pipes.friction_per_s.into());
            }
            _ => {}
        }
        put("step", self.terrace.step_m.into());
        put("sharpness", self.terrace.sharpness.into());
        put("tilt", self.terrace.tilt_deg.into());
        put("tilt_direction", self.terrace.tilt_direction_deg.into());
        put("low", self.range_map.low_m.into());
        put("high", self.range_map.high_m.into());
        let (mapping, parameter, value) = match &self.range_map.mapping {
            RangeMapping::Bias(bias) => ("bias", "bias", (*bias).into()),
            RangeMapping::Gain(gain) => ("gain", "gain", (*gain).into()),
            RangeMapping::Curve(given) => ("curve", "map_curve", curve(given)),
        };
        put("mapping", mapping.into());
        if self.brush_type == BrushType::RangeMap {
            put(parameter, value);
        }
        put("scale", self.stamp.scale_m.into());
        put("mode", word(&self.stamp.mode));
        put("value", self.mask_value.into());
        if let Some(custom) = &self.custom {
            let (name, source) = source(&custom.source);
            put(name, source.into());
            let values = custom.parameters.iter().map(|(name, value)| (name.clone(), (*value).into()));
            put("parameters", Value::Object(values.collect()));
        }
        object.append(&mut drainage::write(self));
        if self.brush_type == BrushType::Clone {
            object.append(&mut cloning::write(&self.cloning));
        }
        if self.brush_type == BrushType::Noise {
            object.append(&mut noise::write(&self.noise));
            if let Some(roughness) = &self.noise.roughness {
                object.insert("roughness".to_owned(), gate::write(roughness));
            }
        }
        object
    }
}

/// `profile` and what belongs to it.
fn profile(shape: &ProfileShape) -> Vec<(&'static str, Value)> {
    let (name, own) = match shape {
        ProfileShape::Power { power } => ("power", Some(("power", (*power).into()))),
        ProfileShape::Linear => ("linear", None),
        ProfileShape::Smooth => ("smooth", None),
        ProfileShape::Sphere => ("sphere", None),
        ProfileShape::Tip => ("tip", None),
        ProfileShape::Gauss => ("gauss", None),
        ProfileShape::Sigmoid { steepness } => ("sigmoid", Some(("steepness", (*steepness).into()))),
        ProfileShape::Curve(given) => ("curve", Some(("profile_curve", curve(given)))),
    };
    std::iter::once(("profile", name.into())).chain(own).collect()
}

fn dynamics(dynamics: &Dynamics) -> Value {
    let curves = [
        ("pressure_to_radius", &dynamics.pressure_to_radius),
        ("pressure_to_strength", &dynamics.pressure_to_strength),
        ("pressure_to_flow", &dynamics.pressure_to_flow),
        ("tilt_to_radius", &dynamics.tilt_to_radius),
        ("tilt_to_strength", &dynamics.tilt_to_strength),
        ("tilt_to_flow", &dynamics.tilt_to_flow),
    ];
    let given =
        curves.into_iter().filter_map(|(name, given)| Some((name.to_owned(), curve(given.as_ref()?))));
    Value::Object(given.collect())
}

/// The field and the text of data from outside.
pub(super) fn source(source: &DataSource) -> (&'static str, &str) {
    match source {
        DataSource::File(file) => ("file", file),
        DataSource::Blake3(hash) => ("blake3", hash),
    }
}

fn alpha(alpha: &Alpha) -> Value {
    let (name, source) = source(&alpha.source);
    json!({
        name: source,
        "angle": alpha.angle_deg,
        "rotation": word(&alpha.rotation),
        "mirrored": alpha.is_mirrored,
    })
}

fn symmetry(symmetry: &Symmetry) -> Value {
    match symmetry.kind {
        SymmetryKind::Axis { angle_deg } => {
            json!({ "kind": "axis", "centre": symmetry.centre_m, "angle": angle_deg })
        }
        SymmetryKind::Point => json!({ "kind": "point", "centre": symmetry.centre_m }),
        SymmetryKind::Radial { count } => {
            json!({ "kind": "radial", "centre": symmetry.centre_m, "count": count })
        }
    }
}
