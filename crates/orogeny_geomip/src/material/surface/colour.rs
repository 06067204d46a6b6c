//! Colours: sRGB as it is stored, linear light as it is reckoned with (IEC 61966-2-1).

use glam::{Vec3, vec3};

/// The luminance of linear light by channel (ITU-R BT.709).
pub(super) const LUMINANCE: Vec3 = vec3(0.2126, 0.7152, 0.0722);

/// Linear light, 0..1, of an sRGB value, 0..1.
#[must_use]
pub(super) fn to_linear(srgb: f32) -> f32 {
    if srgb <= 0.040_45 { srgb / 12.92 } else { ((srgb + 0.055) / 1.055).powf(2.4) }
}

/// The sRGB value of linear light, both 0..1.
#[must_use]
pub(super) fn to_srgb(linear: f32) -> f32 {
    let linear = linear.clamp(0.0, 1.0);
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// A value of 0..1 as a byte.
#[must_use]
pub(super) fn byte(value: f32) -> u8 {
    // The cast saturates.
    (value * 255.0 + 0.5) as u8
}

/// Linear light of a colour written as `0xRRGGBB` in sRGB.
#[must_use]
pub(super) fn hex(colour: u32) -> Vec3 {
    let [_, red, green, blue] = colour.to_be_bytes();
    vec3(red.into(), green.into(), blue.into()).to_array().map(|value| to_linear(value / 255.0)).into()
}
