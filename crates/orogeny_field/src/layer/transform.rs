//! Where a layer's content lies.

use serde::{Deserialize, Serialize};

use crate::{Error, Placement, Placing, Result};

/// A layer's content moved, turned and enlarged. Its painted mask goes along.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LayerTransform {
    /// By how much it is moved, in metres along x and z, after it was turned and enlarged.
    #[serde(rename = "move")]
    pub move_m: [f64; 2],
    /// By how many degrees it is turned, from x towards z.
    #[serde(rename = "rotate")]
    pub rotation_deg: f64,
    /// How much larger it becomes, 0.01 to 100.
    pub scale: f64,
    /// About which place it is turned and enlarged, in metres.
    #[serde(rename = "pivot")]
    pub pivot_m: [f64; 2],
    /// What its heights are multiplied by, within ±1000.
    pub height_scale: f64,
}

impl Default for LayerTransform {
    fn default() -> Self {
        Self { move_m: [0.0; 2], rotation_deg: 0.0, scale: 1.0, pivot_m: [0.0; 2], height_scale: 1.0 }
    }
}

impl LayerTransform {
    /// Whether it changes nothing.
    #[must_use]
    pub fn is_identity(&self) -> bool {
        *self == Self { pivot_m: self.pivot_m, ..Self::default() }
    }

    /// Refuses numbers out of their range.
    ///
    /// # Errors
    /// [`Error::LayerValue`], naming the number.
    pub fn check(&self) -> Result<()> {
        let far_m = 1.0e8;
        let [move_x, move_z] = self.move_m;
        let [pivot_x, pivot_z] = self.pivot_m;
        for (field, value, low, high) in [
            ("transform.move", move_x, -far_m, far_m),
            ("transform.move", move_z, -far_m, far_m),
            ("transform.pivot", pivot_x, -far_m, far_m),
            ("transform.pivot", pivot_z, -far_m, far_m),
            ("transform.rotate", self.rotation_deg, -36_000.0, 36_000.0),
            ("transform.scale", self.scale, 0.01, 100.0),
            ("transform.height_scale", self.height_scale, -1000.0, 1000.0),
        ] {
            if !(low..=high).contains(&value) {
                return Err(Error::LayerValue { field, value, low, high });
            }
        }
        Ok(())
    }

    /// Where the samples of a terrain lie on the content, both `spacing_m` apart.
    #[must_use]
    pub fn placement(&self, spacing_m: f64) -> Placement {
        let [x, z] = self.pivot_m;
        let [move_x, move_z] = self.move_m;
        Placement::new(&Placing {
            at_m: self.pivot_m,
            to_m: [x + move_x, z + move_z],
            rotation_deg: self.rotation_deg,
            scale: self.scale,
            is_mirrored: false,
            source_spacing_m: spacing_m,
            spacing_m,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pivot_comes_to_lie_where_it_was_moved_to_and_all_else_about_it() {
        let transform = LayerTransform {
            move_m: [100.0, -40.0],
            rotation_deg: 90.0,
            scale: 2.0,
            pivot_m: [60.0, 80.0],
            height_scale: 1.0,
        };
        let placement = transform.placement(2.0);
        let near = |place: [f64; 2], expected: [f64; 2]| {
            let [a, b] = placement.place(place);
            assert!((a - expected[0]).abs() < 1e-9 && (b - expected[1]).abs() < 1e-9, "{a} {b}");
        };
        near([80.0, 20.0], [30.0, 40.0]);
        // What lay 10 samples to the east of it lies 20 to the south now.
        near([80.0, 40.0], [40.0, 40.0]);
        assert!(LayerTransform { pivot_m: [3.0, 4.0], ..LayerTransform::default() }.is_identity());
        assert!(!transform.is_identity());
        assert!(LayerTransform { scale: f64::NAN, ..transform }.check().is_err());
        assert!(
            LayerTransform { scale: 0.0, ..transform }.check().unwrap_err().to_string().contains("scale")
        );
    }
}
