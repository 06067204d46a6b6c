//! Gates to and from JSON.

use serde_json::{Map, Value, json};

use super::fields::Fields;
use super::noise;
use super::write::source;
use crate::Result;
use crate::brush::{AspectGate, Band, Gate, GateImage, NoiseGate};
use crate::noise::Seeding;

impl Gate {
    /// Reads a gate: `{"slope": {"min": 20, "max": 45, "feather": 5}, …}`, the product of all that it names.
    ///
    /// # Errors
    /// As [`crate::Brush::from_json`], naming the field.
    pub fn from_json(object: &Map<String, Value>) -> Result<Self> {
        let fields = Fields::of_gate(object);
        fields.refuse_unknown()?;
        read(&fields)
    }

    /// Writes all that it names.
    #[must_use]
    pub fn to_json(&self) -> Map<String, Value> {
        match write(self) {
            Value::Object(object) => object,
            _ => Map::new(),
        }
    }
}

pub(super) fn read(fields: &Fields<'_>) -> Result<Gate> {
    let named = |name: &'static str| -> Result<Option<Band>> {
        fields.object(name)?.map(|fields| band(&fields)).transpose()
    };
    let aspect = match fields.object("aspect")? {
        None => None,
        Some(fields) => Some(AspectGate {
            angle_deg: fields.number("angle")?,
            width_deg: fields.number("width")?,
            feather_deg: fields.number("feather")?,
        }),
    };
    let noise = match fields.object("noise")? {
        None => None,
        Some(fields) => {
            let pattern = match fields.object("pattern")? {
                Some(pattern) => noise::read(&pattern)?,
                None => crate::noise::Noise::default(),
            };
            if pattern.seeding != Seeding::World {
                let value = serde_json::to_string(&pattern.seeding).unwrap_or_default();
                return Err(fields.refused(
                    "pattern.seeding",
                    value,
                    "a gate's noise is fixed to the world".to_owned(),
                ));
            }
            if pattern.direction.is_some_and(|direction| direction.follows_stroke) {
                let limit = "a gate's noise does not follow the stroke".to_owned();
                return Err(fields.refused("pattern.stretch.follow", true, limit));
            }
            Some(NoiseGate { noise: pattern, band: band(&fields)? })
        }
    };
    let image = match fields.object("image")? {
        None => None,
        Some(fields) => {
            let region_m: [f64; 4] = fields.numbers("region")?;
            let [.., width_m, depth_m] = region_m;
            if width_m <= 0.0 || depth_m <= 0.0 {
                let limit = "it must be [x, z, width, depth] in metres, width and depth above 0".to_owned();
                return Err(fields.refused("region", format!("{region_m:?}"), limit));
            }
            Some(GateImage { source: fields.source("it is the picture")?, region_m })
        }
    };
    Ok(Gate {
        image,
        slope_deg: named("slope")?,
        height_m: named("height")?,
        aspect,
        curvature_per_km: named("curvature")?,
        noise,
        selection: fields.flag("selection")?,
        is_inverted: fields.flag("inverted")?,
    })
}

fn band(fields: &Fields<'_>) -> Result<Band> {
    let band =
        Band { min: fields.number("min")?, max: fields.number("max")?, feather: fields.number("feather")? };
    if band.min > band.max {
        return Err(fields.refused("min", band.min, format!("it must not be above `max`, {}", band.max)));
    }
    Ok(band)
}

pub(super) fn write(gate: &Gate) -> Value {
    let mut object = Map::new();
    let band = |band: &Band| json!({ "min": band.min, "max": band.max, "feather": band.feather });
    let bands = [("slope", gate.slope_deg), ("height", gate.height_m), ("curvature", gate.curvature_per_km)];
    for (name, given) in bands {
        if let Some(given) = given {
            object.insert(name.to_owned(), band(&given));
        }
    }
    if let Some(aspect) = &gate.aspect {
        let value =
            json!({ "angle": aspect.angle_deg, "width": aspect.width_deg, "feather": aspect.feather_deg });
        object.insert("aspect".to_owned(), value);
    }
    if let Some(NoiseGate { noise, band: given }) = &gate.noise {
        let mut value = band(given);
        if let Some(object) = value.as_object_mut() {
            object.insert("pattern".to_owned(), Value::Object(noise::write(noise)));
        }
        object.insert("noise".to_owned(), value);
    }
    if let Some(image) = &gate.image {
        let (name, source) = source(&image.source);
        object.insert("image".to_owned(), json!({ name: source, "region": image.region_m }));
    }
    object.insert("selection".to_owned(), gate.selection.into());
    object.insert("inverted".to_owned(), gate.is_inverted.into());
    Value::Object(object)
}
