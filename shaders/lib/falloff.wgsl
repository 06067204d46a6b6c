// The weight of a brush over r = distance / outer radius. Twin: orogeny_reference::falloff.
#include "lib/transcendental.wgsl"

// orogeny_field::FalloffFormula
override FALLOFF_FORMULA: u32 = 0u;
const HARD_EDGE = 0u;
const LINEAR = 1u;
const SMOOTH = 2u;
const SPHERE = 3u;
const TIP = 4u;
const GAUSS = 5u;
const POWER = 6u;
const SIGMOID = 7u;
const CURVE = 8u; // read from a table, by whoever has it

// orogeny_field::Falloff, without its formula
struct Falloff {
    inverse_falloff_ratio: f32, // R / F
    exponent: f32,              // P of a power, k of a sigmoid
    scale: f32,                 // what makes the weight 1 at the centre
}

// clamp((R - distance) / F, 0, 1)
fn falloff_slope(r: f32, falloff: Falloff) -> f32 {
    return clamp((1.0 - r) * falloff.inverse_falloff_ratio, 0.0, 1.0);
}

// Exactly 0 for r >= 1.
fn falloff_weight(r: f32, falloff: Falloff) -> f32 {
    if r >= 1.0 {
        return 0.0;
    }
    let t = falloff_slope(r, falloff);
    switch FALLOFF_FORMULA {
        case LINEAR: {
            return t;
        }
        case SMOOTH: {
            return t * t * (3.0 - 2.0 * t);
        }
        case SPHERE: {
            return sqrt(t * (2.0 - t));
        }
        case TIP: {
            let t2 = t * t;
            return t2 / (1.0 + sqrt(1.0 - t2));
        }
        case GAUSS: {
            let s = 1.0 - t;
            return clamp((exp_minus_one(-4.5 * s * s) + 0.988891) * 1.0112338, 0.0, 1.0);
        }
        case POWER: {
            let drop = -exp_minus_one(falloff.exponent * natural_log(r));
            return clamp(select(1.0, drop, r > 0.0) * falloff.scale, 0.0, 1.0);
        }
        case SIGMOID: {
            let m = exp_minus_one(-2.0 * falloff.exponent * (1.0 - r));
            return clamp(-m / (2.0 + m) * falloff.scale, 0.0, 1.0);
        }
        default: { // HARD_EDGE
            return 1.0;
        }
    }
}
