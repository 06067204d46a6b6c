//! Noise to and from JSON.

use serde_json::{Map, Value, json};

use super::fields::Fields;
use super::gate;
use super::write::{curve, word};
use crate::Result;
use crate::noise::{Basis, Distortion, Gain, Noise, NoiseDirection, Normalization, Seeding, Turbulence};

pub(super) fn read(fields: &Fields<'_>) -> Result<Noise> {
    let gain = |fields: &Fields<'_>| -> Result<Gain> {
        match fields.optional_number("gain")? {
            Some(_) if fields.has("hurst") => {
                Err(fields.refused("gain", "given", "give either `gain` or `hurst`".to_owned()))
            }
            Some(gain) => Ok(Gain::Given(gain)),
            None => Ok(Gain::Hurst(fields.number("hurst")?)),
        }
    };
    let distortion = match fields.object("distortion")? {
        None => None,
        Some(fields) => Some(Distortion {
            turbulence: fields.choice("turbulence", Turbulence::Fbm)?,
            octaves: fields.integer("octaves")?,
            weight: fields.number("weight")?,
            lacunarity: fields.number("lacunarity")?,
            gain: gain(&fields)?,
        }),
    };
    let direction = match fields.object("stretch")? {
        None => None,
        Some(fields) => Some(NoiseDirection {
            angle_deg: fields.number("angle")?,
            follows_stroke: fields.flag("follow")?,
            stretch: fields.number("factor")?,
        }),
    };
    Ok(Noise {
        basis: fields.choice("basis", Basis::Gradient)?,
        turbulence: fields.choice("turbulence", Turbulence::Fbm)?,
        feature_size_m: fields.number("feature_size")?,
        octaves: fields.integer("octaves")?,
        lacunarity: fields.number("lacunarity")?,
        gain: gain(fields)?,
        seed: fields.integer("seed")?,
        seeding: fields.choice("seeding", Seeding::World)?,
        normalization: fields.normalization("normalize")?,
        worley_weights: fields.numbers("worley_weights")?,
        slice: fields.number("slice")?,
        elevation: fields.number("elevation")?,
        transfer: fields.curve("transfer")?,
        curve: fields.curve("curve")?,
        distortion,
        direction,
        offset_m: fields.numbers("offset")?,
        rotation_deg: fields.number("rotation")?,
        roughness: fields.object("roughness")?.map(|fields| gate::read(&fields)).transpose()?.map(Box::new),
    })
}

/// All parameters that are not at their defaults' meaning of "not there".
pub(super) fn write(noise: &Noise) -> Map<String, Value> {
    let mut object = Map::new();
    let mut put = |name: &str, value: Value| object.insert(name.to_owned(), value);
    put("basis", word(&noise.basis));
    put("turbulence", word(&noise.turbulence));
    put("feature_size", noise.feature_size_m.into());
    put("octaves", noise.octaves.into());
    put("lacunarity", noise.lacunarity.into());
    let (name, value) = gain(noise.gain);
    put(name, value);
    put("seed", noise.seed.into());
    put("seeding", word(&noise.seeding));
    put(
        "normalize",
        match noise.normalization {
            Normalization::Wanted => true.into(),
            Normalization::Off => false.into(),
            Normalization::Given { offset, scale } => json!([offset, scale]),
        },
    );
    put("worley_weights", json!(noise.worley_weights));
    put("slice", noise.slice.into());
    put("elevation", noise.elevation.into());
    if let Some(transfer) = &noise.transfer {
        put("transfer", curve(transfer));
    }
    if let Some(shape) = &noise.curve {
        put("curve", curve(shape));
    }
    if let Some(distortion) = &noise.distortion {
        let mut value = json!({
            "turbulence": word(&distortion.turbulence),
            "octaves": distortion.octaves,
            "weight": distortion.weight,
            "lacunarity": distortion.lacunarity,
        });
        if let Some(object) = value.as_object_mut() {
            let (name, gain) = gain(distortion.gain);
            object.insert(name.to_owned(), gain);
        }
        put("distortion", value);
    }
    if let Some(direction) = &noise.direction {
        put(
            "stretch",
            json!({ "angle": direction.angle_deg, "follow": direction.follows_stroke, "factor": direction.stretch }),
        );
    }
    put("offset", json!(noise.offset_m));
    put("rotation", noise.rotation_deg.into());
    object
}

fn gain(gain: Gain) -> (&'static str, Value) {
    match gain {
        Gain::Hurst(hurst) => ("hurst", hurst.into()),
        Gain::Given(gain) => ("gain", gain.into()),
    }
}
