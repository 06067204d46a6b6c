//! Which frames of a noise the instances of a stroke have: one for all, or some for each.

use std::sync::Arc;

use orogeny_field::hash::hash;
use orogeny_field::noise::{NUM_DIRECTIONS, Noise, NoiseFrame, NoiseKernel, Seeding};
use orogeny_field::{Instance, TerrainGrid};

use crate::Result;

/// A stroke's noise on its way: the kernel, and frames as they are needed.
#[derive(Debug)]
pub(crate) struct Frames {
    kernel: Arc<NoiseKernel>,
    seeding: Seeding,
    /// The brush's own seed.
    brush_seed: u32,
    stroke_seed: u32,
    /// What is added to the stroke's direction, radians; `None`: the pattern does not follow it.
    follow_angle: Option<f64>,
    /// Those of all instances, where they share them.
    shared: Arc<Vec<NoiseFrame>>,
    /// Those of the instances of one batch.
    own: Vec<NoiseFrame>,
}

impl Frames {
    /// A stroke's noise; `anchor_m` is its first point.
    ///
    /// # Errors
    /// [`orogeny_field::Error::FeatureSize`] for features that the terrain's samples cannot show.
    pub(crate) fn new(
        noise: &Noise,
        stroke_seed: u32,
        grid: &TerrainGrid,
        anchor_m: [f64; 2],
    ) -> Result<Self> {
        let kernel = Arc::new(NoiseKernel::new(noise, grid.spacing_m(), anchor_m)?);
        let shared_seed = match noise.seeding {
            Seeding::World => Some(noise.seed),
            Seeding::Stroke => Some(hash(noise.seed, 1, stroke_seed)),
            Seeding::Instance | Seeding::Random => None,
        };
        let frames = shared_seed.map_or_else(Vec::new, |seed| {
            (0..kernel.num_directions())
                .map(|direction| NoiseFrame::new(&kernel, seed, direction, None))
                .collect()
        });
        Ok(Self {
            follow_angle: noise
                .direction
                .filter(|direction| direction.follows_stroke)
                .map(|direction| direction.angle_deg.to_radians()),
            seeding: noise.seeding,
            brush_seed: noise.seed,
            stroke_seed,
            shared: Arc::new(frames),
            own: Vec::new(),
            kernel,
        })
    }

    /// The kernel's numbers.
    pub(crate) const fn kernel(&self) -> &Arc<NoiseKernel> {
        &self.kernel
    }

    /// Gives an instance its frame: instance number `index` of the stroke, at `place` in samples, going along `way`.
    pub(crate) fn assign(&mut self, instance: &mut Instance, index: u32, place: [f64; 2], [x, z]: [f64; 2]) {
        let (direction, blend) = self.follow_angle.map_or((0, 0.0), |angle| {
            // Half a turn leaves a stretched pattern as it is.
            let half_turns = ((z.atan2(x) + angle) / std::f64::consts::PI).rem_euclid(1.0);
            let place = half_turns * NUM_DIRECTIONS as f64;
            ((place.floor() as usize).min(NUM_DIRECTIONS - 1), place.fract())
        });
        instance.frame_blend = blend as f32;
        let (seed, centre) = match self.seeding {
            Seeding::World | Seeding::Stroke => {
                instance.frame = direction as u32;
                return;
            }
            Seeding::Instance => (self.brush_seed, Some(place)),
            Seeding::Random => (hash(index, 0, self.stroke_seed), None),
        };
        instance.frame = self.own.len() as u32;
        self.own.push(NoiseFrame::new(&self.kernel, seed, direction, centre));
        if self.follow_angle.is_some() {
            self.own.push(NoiseFrame::new(&self.kernel, seed, direction + 1, centre));
        }
    }

    /// The frames that a batch refers to.
    pub(crate) fn take(&mut self) -> Arc<Vec<NoiseFrame>> {
        if self.own.is_empty() { Arc::clone(&self.shared) } else { Arc::new(std::mem::take(&mut self.own)) }
    }
}
