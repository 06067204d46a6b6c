//! Brushes to and from JSON, by the table of parameters.

mod cloning;
mod drainage;
mod erosion;
mod fields;
mod gate;
mod noise;
mod write;

use serde_json::{Map, Value};

use super::{
    Alpha, AlphaRotation, Blending, Brush, BrushType, Cloning, Custom, Dynamics, Jitter, LedgeDirection,
    LevelOnly, PressureTarget, Profile, ProfileShape, RampAlong, RangeMap, RangeMapping, SmoothMethod,
    Smoothing, Stamp, StampMode, Symmetry, SymmetryKind, Terrace,
};
use crate::noise::Noise;
use crate::{Droplets, Error, FillPits, FlowMask, FlowRouting, Pipes, RainMask, Result, Thermal};
use fields::Fields;

impl Brush {
    /// A brush with the documented defaults.
    #[must_use]
    pub fn new(brush_type: BrushType, radius_m: f64, strength: f64) -> Self {
        Self {
            brush_type,
            radius_m,
            shape: ProfileShape::Smooth,
            falloff_m: radius_m,
            strength,
            spacing: 0.25,
            pressure: PressureTarget::Strength,
            blending: default_blending(brush_type),
            height_m: None,
            direction: LedgeDirection::Raise,
            only: LevelOnly::Both,
            flow: 1.0,
            is_airbrush: false,
            dynamics: Dynamics::default(),
            jitter: Jitter::default(),
            alpha: None,
            symmetry: None,
            gate: None,
            noise: Noise::default(),
            smoothing: Smoothing::default(),
            cloning: Cloning::default(),
            hardness: None,
            thermal: Thermal::default(),
            pipes: Pipes::default(),
            droplets: Droplets::default(),
            fill_pits: FillPits::default(),
            flow_routing: FlowRouting::default(),
            flow_mask: FlowMask::default(),
            rain_mask: RainMask::default(),
            terrace: Terrace::default(),
            range_map: RangeMap::default(),
            end_height_m: None,
            along: RampAlong::Linear,
            stamp: Stamp::default(),
            mask_value: 1.0,
            custom: None,
        }
    }

    /// Reads a brush object: `{"type": "raise", "radius": 40, …}`. Missing fields take their defaults.
    ///
    /// # Errors
    /// [`Error::BrushType`], [`Error::BrushField`], [`Error::BrushValue`], [`Error::Curve`] or [`Error::MissingField`], naming
    /// the field, its value and what is allowed.
    pub fn from_json(object: &Map<String, Value>) -> Result<Self> {
        let brush_type = brush_type_of(object)?;
        let fields = Fields::of_brush(brush_type, object);
        fields.refuse_unknown()?;
        let radius_m = fields.number("radius")?;
        let falloff_m = fields.optional_number("falloff")?.unwrap_or(radius_m);
        if falloff_m > radius_m {
            return Err(fields.refused(
                "falloff",
                falloff_m,
                format!("it must be within 0 to the radius, {radius_m} m"),
            ));
        }
        let height = |name| -> Result<Option<f32>> {
            Ok(fields.optional_number(name)?.map(|height_m| height_m as f32))
        };
        let brush = Self {
            brush_type,
            radius_m,
            shape: shape(&fields)?,
            falloff_m,
            strength: fields.number("strength")?,
            spacing: fields.number("spacing")?,
            pressure: fields.choice("pressure", PressureTarget::Strength)?,
            blending: fields.choice("blending", default_blending(brush_type))?,
            height_m: height("height")?,
            direction: fields.choice("direction", LedgeDirection::Raise)?,
            only: fields.choice("only", LevelOnly::Both)?,
            flow: fields.number("flow")?,
            is_airbrush: fields.flag("airbrush")?,
            dynamics: dynamics(&fields)?,
            jitter: jitter(&fields)?,
            alpha: alpha(&fields)?,
            symmetry: symmetry(&fields)?,
            gate: fields.object("gate")?.map(|fields| gate::read(&fields)).transpose()?.map(Box::new),
            noise: if brush_type == BrushType::Noise { noise::read(&fields)? } else { Noise::default() },
            smoothing: smoothing(&fields)?,
            cloning: cloning::read(&fields)?,
            hardness: fields.object("hardness")?.map(|fields| gate::read(&fields)).transpose()?.map(Box::new),
            thermal: erosion::read_thermal(&fields)?,
            pipes: erosion::read_pipes(&fields)?,
            droplets: drainage::read_droplets(&fields)?,
            fill_pits: drainage::read_fill_pits(&fields)?,
            flow_routing: drainage::read_routing(&fields)?,
            flow_mask: drainage::read_flow_mask(&fields)?,
            rain_mask: drainage::read_rain_mask(&fields)?,
            terrace: terrace(&fields)?,
            range_map: range_map(&fields)?,
            end_height_m: height("end_height")?,
            along: fields.choice("along", RampAlong::Linear)?,
            stamp: stamp(&fields)?,
            mask_value: if brush_type == BrushType::PaintMask { fields.number("value")? } else { 1.0 },
            custom: custom(&fields)?,
        };
        let missing = |field, why| Err(Error::MissingField { brush: brush_type.name(), field, why });
        if brush_type == BrushType::Grab
            && let Some(alpha) = fields.raw("alpha")
        {
            return Err(fields.refused(
                "alpha",
                alpha,
                "what is grabbed has the profile's shape: it takes none".to_owned(),
            ));
        }
        match brush_type {
            BrushType::SetHeight if brush.height_m.is_none() => {
                missing("height", "it is the height that the ground is set to")
            }
            BrushType::Stamp if brush.alpha.is_none() => {
                missing("alpha", "it is the picture that is pressed into the ground")
            }
            _ => Ok(brush),
        }
    }

    /// Accepts a brush that was made by its fields.
    ///
    /// # Errors
    /// As [`Self::from_json`]: a number that is not finite or out of its range is named.
    pub fn check(&self) -> Result<()> {
        Self::from_json(&self.to_json()).map(drop)
    }

    /// Weight over the distance from the centre.
    #[must_use]
    pub fn profile(&self) -> Profile {
        Profile { shape: self.shape.clone(), falloff_ratio: self.falloff_m / self.radius_m }
    }
}

/// How the instances of a brush meet that does not say.
const fn default_blending(brush_type: BrushType) -> Blending {
    match brush_type {
        BrushType::Smooth
        | BrushType::Sharpen
        | BrushType::ErodeThermal
        | BrushType::ErodeFluvial
        | BrushType::ErodeDroplets => Blending::BuildUp,
        BrushType::Smear => Blending::Each,
        _ => Blending::Wash,
    }
}

fn brush_type_of(object: &Map<String, Value>) -> Result<BrushType> {
    let known = || {
        let names: Vec<_> = BrushType::ALL.iter().map(|brush_type| brush_type.name()).collect();
        format!("there are {}", names.join(", "))
    };
    let unknown = |name: String| Error::BrushType { name, known: known() };
    match object.get("type") {
        Some(Value::String(name)) => BrushType::from_name(name).ok_or_else(|| unknown(name.clone())),
        Some(other) => Err(unknown(other.to_string())),
        None => Err(unknown(String::new())),
    }
}

/// Refuses a field that belongs to another choice than the one made.
fn only_with(fields: &Fields<'_>, choice: &'static str, pairs: &[(&'static str, &str)]) -> Result<()> {
    let chosen = fields.word(choice)?;
    for (field, needed) in pairs {
        if let Some(value) = fields.raw(field)
            && chosen != *needed
        {
            return Err(fields.refused(field, value, format!("it needs `\"{choice}\": \"{needed}\"`")));
        }
    }
    Ok(())
}

/// A curve that a choice needs.
fn needed_curve(fields: &Fields<'_>, name: &'static str, why: &'static str) -> Result<crate::Curve> {
    let brush = fields.brush_type().name();
    fields.curve(name)?.ok_or(Error::MissingField { brush, field: name, why })
}

fn shape(fields: &Fields<'_>) -> Result<ProfileShape> {
    only_with(
        fields,
        "profile",
        &[("power", "power"), ("steepness", "sigmoid"), ("profile_curve", "curve")],
    )?;
    Ok(match fields.word("profile")? {
        "power" => ProfileShape::Power { power: fields.number("power")? },
        "linear" => ProfileShape::Linear,
        "sphere" => ProfileShape::Sphere,
        "tip" => ProfileShape::Tip,
        "gauss" => ProfileShape::Gauss,
        "sigmoid" => ProfileShape::Sigmoid { steepness: fields.number("steepness")? },
        "curve" => {
            ProfileShape::Curve(needed_curve(fields, "profile_curve", "the profile `curve` is made of it")?)
        }
        _ => ProfileShape::Smooth,
    })
}

fn dynamics(fields: &Fields<'_>) -> Result<Dynamics> {
    let Some(fields) = fields.object("dynamics")? else { return Ok(Dynamics::default()) };
    Ok(Dynamics {
        pressure_to_radius: fields.curve("pressure_to_radius")?,
        pressure_to_strength: fields.curve("pressure_to_strength")?,
        pressure_to_flow: fields.curve("pressure_to_flow")?,
        tilt_to_radius: fields.curve("tilt_to_radius")?,
        tilt_to_strength: fields.curve("tilt_to_strength")?,
        tilt_to_flow: fields.curve("tilt_to_flow")?,
    })
}

fn jitter(fields: &Fields<'_>) -> Result<Jitter> {
    let Some(fields) = fields.object("jitter")? else { return Ok(Jitter::default()) };
    Ok(Jitter {
        radius: fields.number("radius")?,
        position: fields.number("position")?,
        strength: fields.number("strength")?,
    })
}

fn custom(fields: &Fields<'_>) -> Result<Option<Custom>> {
    if fields.brush_type() != BrushType::Custom {
        return Ok(None);
    }
    let source = fields.source("it says what the brush does")?;
    Ok(Some(Custom { source, parameters: fields.values("parameters")? }))
}

fn alpha(fields: &Fields<'_>) -> Result<Option<Alpha>> {
    let Some(fields) = fields.object("alpha")? else { return Ok(None) };
    let source = fields.source("it is the picture")?;
    Ok(Some(Alpha {
        source,
        angle_deg: fields.number("angle")?,
        rotation: fields.choice("rotation", AlphaRotation::Fixed)?,
        is_mirrored: fields.flag("mirrored")?,
    }))
}

fn symmetry(fields: &Fields<'_>) -> Result<Option<Symmetry>> {
    let Some(fields) = fields.object("mirror")? else { return Ok(None) };
    only_with(&fields, "kind", &[("angle", "axis"), ("count", "radial")])?;
    let kind = match fields.word("kind")? {
        "point" => SymmetryKind::Point,
        "radial" => SymmetryKind::Radial { count: fields.integer("count")? },
        _ => SymmetryKind::Axis { angle_deg: fields.number("angle")? },
    };
    Ok(Some(Symmetry { kind, centre_m: fields.numbers("centre")? }))
}

fn smoothing(fields: &Fields<'_>) -> Result<Smoothing> {
    let brush_type = fields.brush_type();
    if !matches!(brush_type, BrushType::Smooth | BrushType::Sharpen) {
        return Ok(Smoothing::default());
    }
    Ok(Smoothing {
        method: fields.choice("method", SmoothMethod::Gaussian)?,
        width_m: fields.optional_number("width")?,
        gain: if brush_type == BrushType::Sharpen {
            fields.number("gain")?
        } else {
            Smoothing::default().gain
        },
    })
}

fn terrace(fields: &Fields<'_>) -> Result<Terrace> {
    if fields.brush_type() != BrushType::Terrace {
        return Ok(Terrace::default());
    }
    Ok(Terrace {
        step_m: fields.number("step")?,
        sharpness: fields.number("sharpness")?,
        tilt_deg: fields.number("tilt")?,
        tilt_direction_deg: fields.number("tilt_direction")?,
    })
}

fn range_map(fields: &Fields<'_>) -> Result<RangeMap> {
    if fields.brush_type() != BrushType::RangeMap {
        return Ok(RangeMap::default());
    }
    let (low_m, high_m) = (fields.number("low")?, fields.number("high")?);
    if low_m >= high_m {
        return Err(fields.refused("low", low_m, format!("it must be below `high`, {high_m} m")));
    }
    only_with(fields, "mapping", &[("bias", "bias"), ("gain", "gain"), ("map_curve", "curve")])?;
    let mapping = match fields.word("mapping")? {
        "gain" => RangeMapping::Gain(fields.number("gain")?),
        "curve" => {
            RangeMapping::Curve(needed_curve(fields, "map_curve", "the mapping `curve` is made of it")?)
        }
        _ => RangeMapping::Bias(fields.number("bias")?),
    };
    Ok(RangeMap { low_m, high_m, mapping })
}

fn stamp(fields: &Fields<'_>) -> Result<Stamp> {
    if fields.brush_type() != BrushType::Stamp {
        return Ok(Stamp::default());
    }
    Ok(Stamp { scale_m: fields.number("scale")?, mode: fields.choice("mode", StampMode::Add)? })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brush::{Parameter, ParameterKind};

    fn parse(text: &str) -> Result<Brush> {
        Brush::from_json(&serde_json::from_str(text).unwrap())
    }

    #[test]
    fn every_brush_survives_writing_and_reading() {
        for brush_type in BrushType::ALL {
            for profile in ["power", "linear", "smooth", "sphere", "tip", "gauss", "sigmoid"] {
                let text = format!(
                    r#"{{"type": "{}", "profile": "{profile}", "radius": 37.5, "falloff": 12.5, "strength": 0.75,
                        "height": 3}}"#,
                    brush_type.name()
                );
                let mut object: Map<String, Value> = serde_json::from_str(&text).unwrap();
                if Parameter::find(brush_type, "height").is_none() {
                    object.remove("height");
                }
                match brush_type {
                    BrushType::Stamp => {
                        drop(object.insert("alpha".to_owned(), serde_json::json!({ "file": "rock.png" })))
                    }
                    BrushType::Custom => drop(object.insert("file".to_owned(), "crater.wgsl".into())),
                    BrushType::Clone => {
                        drop(object.insert("source".to_owned(), serde_json::json!({ "at": [3, 4] })))
                    }
                    _ => {}
                }
                let brush = Brush::from_json(&object).unwrap();
                assert_eq!(Brush::from_json(&brush.to_json()).unwrap(), brush);
            }
        }
    }

    #[test]
    fn bad_fields_are_named() {
        for (text, word) in [
            (r#"{"type": "raze"}"#, "raze"),
            (r#"{}"#, "no brush type"),
            (r#"{"type": "raise", "radios": 3}"#, "radios"),
            (r#"{"type": "raise", "height": 3}"#, "height"),
            (r#"{"type": "raise", "radius": 0}"#, "above 0"),
            (r#"{"type": "raise", "radius": -1}"#, "radius"),
            (r#"{"type": "raise", "radius": 1e10}"#, "radius"),
            (r#"{"type": "raise", "radius": "4"}"#, "radius"),
            (r#"{"type": "raise", "strength": -1}"#, "strength"),
            (r#"{"type": "raise", "strength": null}"#, "strength"),
            (r#"{"type": "level", "strength": 1.5}"#, "strength"),
            (r#"{"type": "raise", "falloff": 51}"#, "falloff"),
            (r#"{"type": "raise", "profile": "cone"}"#, "cone"),
            (r#"{"type": "set_height"}"#, "height"),
            (r#"{"type": "raise", "power": 3}"#, "profile"),
            (r#"{"type": "raise", "profile": "power", "steepness": 3}"#, "sigmoid"),
        ] {
            let err = parse(text).unwrap_err().to_string();
            assert!(err.contains(word), "{text}: {err}");
        }
    }

    #[test]
    fn a_brush_made_by_its_fields_is_checked_like_one_that_was_read() {
        let good = Brush::new(BrushType::Level, 50.0, 0.5);
        assert_eq!(good.check(), Ok(()));
        for bad in [f64::NAN, f64::INFINITY, -1.0] {
            for (brush, field) in [
                (Brush { radius_m: bad, ..good.clone() }, "radius"),
                (Brush { falloff_m: bad, ..good.clone() }, "falloff"),
                (Brush { strength: bad, ..good.clone() }, "strength"),
                (Brush { spacing: bad, ..good.clone() }, "spacing"),
                (Brush { shape: ProfileShape::Power { power: bad }, ..good.clone() }, "power"),
                (Brush { height_m: Some((bad * 1.0e30) as f32), ..good.clone() }, "height"),
            ] {
                let err = brush.check().unwrap_err().to_string();
                assert!(err.contains(field), "{bad}: {err}");
            }
        }
    }

    #[test]
    fn defaults_of_the_table_are_the_defaults_of_new() {
        assert_eq!(parse(r#"{"type": "raise"}"#).unwrap(), Brush::new(BrushType::Raise, 50.0, 10.0));
        assert_eq!(parse(r#"{"type": "level"}"#).unwrap(), Brush::new(BrushType::Level, 50.0, 1.0));
    }

    /// Every field of every object, away from its default.
    const FULL: &[&str] = &[
        r#"{"type": "raise", "profile": "curve", "profile_curve": [[0, 0], [0.4, 0.9], [1, 1]], "flow": 0.3, "airbrush": true,
            "dynamics": {"pressure_to_radius": [[0, 0.2], [1, 1]], "tilt_to_flow": [[0, 1], [1, 0]]},
            "jitter": {"radius": 0.1, "position": 0.5, "strength": 0.25}, "pressure": "flow",
            "alpha": {"file": "a.png", "angle": 30, "rotation": "follow", "mirrored": true},
            "mirror": {"kind": "radial", "centre": [10, 20], "count": 5},
            "gate": {"slope": {"min": 10, "max": 40, "feather": 5}, "height": {"min": 0},
                "aspect": {"angle": 90, "width": 30, "feather": 10}, "curvature": {"max": 0},
                "noise": {"min": 0.1, "feather": 0.3, "pattern": {"turbulence": "ridged", "feature_size": 12}},
                "selection": true, "inverted": true}}"#,
        r#"{"type": "noise", "basis": "worley", "turbulence": "erosive", "feature_size": 321, "octaves": 5, "lacunarity": 2.1,
            "gain": 0.4, "seed": 4294967295, "seeding": "random", "normalize": [0.25, 1.5], "worley_weights": [-1, 1, 0, 0],
            "slice": 2, "elevation": 1.5, "transfer": [[-1, 1], [1, 0]], "curve": [[-1, -1], [0, 0.5], [1, 1]],
            "distortion": {"turbulence": "billowy", "octaves": 2, "weight": -0.5, "lacunarity": 3, "hurst": 0.5},
            "stretch": {"angle": 15, "follow": true, "factor": 6}, "offset": [-3, 4], "rotation": 45,
            "roughness": {"height": {"min": 3}, "image": {"file": "map.png", "region": [0, 0, 100, 50]}}}"#,
        r#"{"type": "terrace", "step": 7, "sharpness": 0.2, "tilt": 3, "tilt_direction": 100, "blending": "build_up"}"#,
        r#"{"type": "range_map", "low": 5, "high": 6, "mapping": "gain", "gain": 0.2}"#,
        r#"{"type": "range_map", "mapping": "curve", "map_curve": [[0, 1], [1, 0]]}"#,
        r#"{"type": "ramp", "height": 1, "end_height": -2, "along": "smooth", "only": "cut", "mirror": {"angle": 12}}"#,
        r#"{"type": "stamp", "scale": -30, "mode": "max", "height": 3, "alpha": {"blake3": "00"}, "mirror": {"kind": "point"}}"#,
        r#"{"type": "smooth", "method": "lattice", "width": 12.5, "blending": "wash"}"#,
        r#"{"type": "sharpen", "width": 3, "gain": 2.5}"#,
        r#"{"type": "smear", "strength": 0.75}"#,
        r#"{"type": "erode_thermal", "iterations": 7, "talus_angle": 22, "rate": 0.125, "blending": "wash",
            "layers": [{"from": 300, "talus_angle": 60, "rate": 0.0625}, {"from": 700, "talus_angle": 10}]}"#,
        r#"{"type": "erode_fluvial", "iterations": 9, "rain": 0.5, "evaporation": 0.125, "capacity": 2, "dissolving": 3,
            "deposition": 4, "min_slope": 5, "friction": 6}"#,
        r#"{"type": "erode_droplets", "droplets": 0.5, "inertia": 0.25, "capacity": 3, "erosion": 0.75, "deposition": 0.125,
            "min_slope": 2, "evaporation": 0.0625, "gravity": 9, "erosion_radius": 5, "max_steps": 100, "blending": "wash"}"#,
        r#"{"type": "fill_pits", "slope": 0.25, "max_depth": 12.5, "blending": "build_up"}"#,
        r#"{"type": "fill_pits"}"#,
        r#"{"type": "flow_mask", "routing": "shared", "exponent": 4, "from": 100, "to": 5000, "blending": "build_up"}"#,
        r#"{"type": "flow_mask", "routing": "steepest"}"#,
        r#"{"type": "erode_thermal", "hardness": {"height": {"min": 3}, "inverted": true}}"#,
        r#"{"type": "rain_mask", "shows": "wear", "from": 0.5, "to": 3, "iterations": 20, "rain": 0.5}"#,
        r#"{"type": "paint_mask", "value": 0.25}"#,
        r#"{"type": "custom", "file": "a.wgsl", "parameters": {"step": 3.5, "ragged": 0}, "blending": "wash"}"#,
        r#"{"type": "noise", "normalize": false}"#,
    ];

    #[test]
    fn every_field_of_every_object_survives() {
        for text in FULL {
            let brush = parse(text).unwrap();
            assert_eq!(Brush::from_json(&brush.to_json()).unwrap(), brush, "{text}");
            let given: Map<String, Value> = serde_json::from_str(text).unwrap();
            let written = brush.to_json();
            for (name, value) in &given {
                let kept = &written[name];
                let is_kept = match (value, kept) {
                    (Value::Number(a), Value::Number(b)) => a.as_f64() == b.as_f64(),
                    (Value::String(a), Value::String(b)) => a == b,
                    (Value::Bool(a), Value::Bool(b)) => a == b,
                    _ => true,
                };
                assert!(is_kept, "{text}: `{name}` became {kept}");
            }
        }
    }

    #[test]
    fn what_does_not_fit_together_is_named() {
        for (text, words) in [
            (r#"{"type": "stamp"}"#, "alpha"),
            (r#"{"type": "custom"}"#, "file"),
            (r#"{"type": "custom", "file": "a", "parameters": {"step": "x"}}"#, "parameters"),
            (r#"{"type": "raise", "alpha": {}}"#, "alpha.file"),
            (r#"{"type": "raise", "alpha": {"file": "a", "blake3": "b"}}"#, "either"),
            (r#"{"type": "raise", "profile": "curve"}"#, "profile_curve"),
            (r#"{"type": "raise", "profile_curve": [[0, 0], [1, 1]]}"#, "profile"),
            (r#"{"type": "raise", "gate": 3}"#, "object"),
            (r#"{"type": "raise", "gate": {"slop": {}}}"#, "gate.slop"),
            (r#"{"type": "raise", "gate": {"slope": {"min": 95}}}"#, "gate.slope.min"),
            (r#"{"type": "raise", "gate": {"slope": {"min": 50, "max": 40}}}"#, "max"),
            (
                r#"{"type": "raise", "gate": {"noise": {"pattern": {"seeding": "random"}}}}"#,
                "gate.noise.pattern.seeding",
            ),
            (r#"{"type": "raise", "mirror": {"kind": "point", "angle": 3}}"#, "mirror.angle"),
            (r#"{"type": "raise", "gate": {"image": {"file": "a"}}}"#, "gate.image.region"),
            (r#"{"type": "raise", "gate": {"image": {"region": [0, 0, 1, 1]}}}"#, "image.file"),
            (r#"{"type": "noise", "roughness": {"noise": {}}}"#, "roughness.noise"),
            (r#"{"type": "raise", "mirror": {"centre": [1]}}"#, "mirror.centre"),
            (r#"{"type": "noise", "octaves": 17}"#, "octaves"),
            (r#"{"type": "noise", "octaves": 1.5}"#, "octaves"),
            (r#"{"type": "noise", "hurst": 0.5, "gain": 0.5}"#, "hurst"),
            (r#"{"type": "noise", "normalize": "yes"}"#, "normalize"),
            (r#"{"type": "noise", "distortion": {"turbulence": "swirly"}}"#, "distortion.turbulence"),
            (r#"{"type": "noise", "transfer": [[0, 0], [0, 1]]}"#, "rise"),
            (r#"{"type": "noise", "transfer": [[0, 9], [1, 1]]}"#, "transfer"),
            (r#"{"type": "range_map", "low": 3, "high": 3}"#, "below"),
            (r#"{"type": "range_map", "gain": 0.3}"#, "mapping"),
            (r#"{"type": "smooth", "gain": 1}"#, "gain"),
            (r#"{"type": "smooth", "width": 0}"#, "width"),
            (r#"{"type": "erode_thermal", "layers": {}}"#, "layers"),
            (r#"{"type": "erode_thermal", "layers": [3]}"#, "layers"),
            (r#"{"type": "erode_thermal", "layers": [{"form": 3}]}"#, "layers[0].form"),
            (r#"{"type": "erode_thermal", "layers": [{"from": 3}, {"from": 2}]}"#, "layers[1].from"),
            (r#"{"type": "erode_thermal", "layers": [{"rate": 0.3}]}"#, "layers[0].rate"),
            (r#"{"type": "erode_thermal", "layers": [{}, {}, {}, {}, {}, {}, {}, {}]}"#, "at most 7"),
            (r#"{"type": "smear", "blending": "wash"}"#, "blending"),
            (r#"{"type": "erode_droplets", "erosion_radius": 9}"#, "erosion_radius"),
            (r#"{"type": "erode_droplets", "seed": 3}"#, "seed"),
            (r#"{"type": "fill_pits", "max_depth": -1}"#, "max_depth"),
            (r#"{"type": "flow_mask", "exponent": 2}"#, "routing"),
            (r#"{"type": "flow_mask", "from": 500, "to": 500}"#, "`from`"),
            (r#"{"type": "rain_mask", "from": 2, "to": 1}"#, "`from`"),
            (r#"{"type": "raise", "step": 3}"#, "step"),
            (r#"{"type": "raise", "airbrush": 1}"#, "airbrush"),
        ] {
            let err = parse(text).unwrap_err().to_string();
            assert!(err.contains(words), "{text}: {err}");
        }
    }

    /// Each word of the table reads as a value that writes the same word.
    #[test]
    fn the_words_of_the_table_are_those_of_the_types() {
        let mut num_words = 0;
        for brush_type in BrushType::ALL {
            for parameter in Parameter::of(brush_type) {
                let ParameterKind::Choice { words } = parameter.kind else { continue };
                for word in words {
                    let mut object = Brush::new(brush_type, 10.0, 0.5).to_json();
                    object.insert(parameter.name.to_owned(), (*word).into());
                    for (name, needed) in [
                        ("power", "profile"),
                        ("steepness", "profile"),
                        ("gain", "mapping"),
                        ("bias", "mapping"),
                    ] {
                        if parameter.name == needed {
                            object.remove(name);
                        }
                    }
                    let line = serde_json::json!([[0.0, 0.0], [1.0, 1.0]]);
                    match (parameter.name, *word) {
                        ("profile", "curve") => drop(object.insert("profile_curve".to_owned(), line)),
                        ("mapping", "curve") => drop(object.insert("map_curve".to_owned(), line)),
                        _ => {}
                    }
                    if brush_type == BrushType::Stamp {
                        object.insert("alpha".to_owned(), serde_json::json!({ "file": "a" }));
                    }
                    if brush_type == BrushType::SetHeight {
                        object.insert("height".to_owned(), 3.into());
                    }
                    if brush_type == BrushType::Custom {
                        object.insert("file".to_owned(), "a.wgsl".into());
                    }
                    let written = Brush::from_json(&object).unwrap().to_json();
                    assert_eq!(written[parameter.name], *word, "{brush_type:?} {}", parameter.name);
                    num_words += 1;
                }
            }
        }
        assert!(num_words > 100);
    }
}
