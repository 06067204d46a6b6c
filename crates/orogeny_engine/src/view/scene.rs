//! What the renderer is told of a request beside the camera: sun, sky, haze, and what colours mean.

use orogeny_geomip::{DetailRule, Fog, Light, Scene, Sky};

use super::ViewRequest;

/// Makes scenes, and keeps what takes long of the last one.
#[derive(Debug, Default)]
pub(super) struct SceneMaker {
    /// The last sun and haze, and the sky under them.
    sky: Option<([f64; 3], Sky)>,
}

impl SceneMaker {
    /// The sky of a request, which takes long to work out and stays the same while the sun stands.
    fn sky(&mut self, request: &ViewRequest) -> Sky {
        let under = [request.sun_azimuth_degrees, request.sun_altitude_degrees, request.haze];
        match &self.sky {
            Some((known, sky)) if *known == under => sky.clone(),
            _ => {
                let [azimuth, altitude, haze] = under;
                let sky = Sky::new(azimuth, altitude, haze);
                self.sky = Some((under, sky.clone()));
                sky
            }
        }
    }

    /// A scene whose colours go over a range of heights.
    pub(super) fn scene(
        &mut self,
        request: &ViewRequest,
        range_m: [f32; 2],
        unpainted_overlay: [f32; 4],
    ) -> Scene {
        let span_m = (range_m[1] - range_m[0]).max(1.0e-3);
        let sky = self.sky(request);
        Scene {
            mode: request.mode,
            detail: DetailRule { metric: request.metric, max_error_px: request.max_error_px },
            light: Light {
                slope_exaggeration: request.slope_exaggeration,
                exposure: adapted_exposure(&sky) * request.exposure_stops.exp2(),
                has_shadows: request.has_shadows,
                ..Light::default()
            },
            sky,
            // As much as the sky's haze takes, and some for clear air; it thins out more slowly than that, between the two.
            fog: Fog {
                density: (8.4e-6 * request.haze + 1.2e-5) as f32,
                falloff: 1.0 / 2_500.0,
                base_m: range_m[0],
            },
            water_level_m: request.water_level_m,
            range_m,
            contour_m: request.contour_m.unwrap_or_else(|| round_step(span_m / 25.0)),
            overlay_range: [0.0, 1.0],
            unpainted_overlay,
            cursors: request.cursors.clone(),
        }
    }
}

/// What an eye makes of a light: most of the way to one brightness, so that an evening is darker than noon, but not dark.
fn adapted_exposure(sky: &Sky) -> f32 {
    const NOON: f64 = 0.95;
    const SHARE: f64 = 0.8;
    let light = sky.sun_light.y * sky.to_sun.y.max(0.0) + sky.sky_light.y;
    Light::default().exposure * (NOON / light.max(1.0e-3)).powf(SHARE) as f32
}

/// 1, 2 or 5 times a power of ten, the next above.
fn round_step(step: f32) -> f32 {
    let power = 10.0_f32.powf(step.log10().floor());
    let times = [1.0, 2.0, 5.0].into_iter().find(|times| times * power >= step * 0.999);
    times.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        let steps = [0.3, 1.0, 1.1, 37.0, 90.0, 230.0].map(round_step);
        assert_eq!(steps, [0.5, 1.0, 2.0, 50.0, 100.0, 500.0]);
    }
}
