//! Erosion: what a user asks of it, and the same as kernels take it, in samples and steps.

use crate::{Error, Result};

/// The most layers of rock.
pub const MAX_ROCK_LAYERS: usize = 8;
/// The steepest angle of repose, in degrees.
pub const MAX_TALUS_ANGLE_DEG: f64 = 89.0;
/// The largest rate of thermal erosion: with more, a step may make a new summit or pit.
pub const MAX_THERMAL_RATE: f64 = 0.25;
/// The most iterations of a simulation.
pub const MAX_EROSION_ITERATIONS: u32 = 100_000;
/// The most steps of a droplet.
pub const MAX_DROPLET_STEPS: u32 = 1024;
/// The largest radius that a droplet erodes, in samples.
pub const MAX_DROPLET_RADIUS: u32 = 8;
/// The most droplets of a round.
pub const DROPLETS_PER_ROUND: u32 = 4096;
/// Samples that a droplet of a round has for itself, on average: regions of less than 2^20 samples have smaller rounds.
pub const SAMPLES_PER_DROPLET: u32 = 256;
/// The most rock that one droplet takes up in its life, in 2^-16 m of one sample (just under 8 m), but for the rounding of a
/// disc: whole rounds, with what heights of ±1e7 m could not take of the round before (half a metre), cannot wrap an `i32`.
pub const DROPLET_BUDGET: i32 = (1 << 19) - 1024;

/// Rock from a height upward.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RockLayer {
    /// Where it begins, in metres. That of the lowest layer is not asked for: it reaches down as far as there is ground.
    pub from_m: f64,
    /// The steepest slope that holds, in degrees: 0..[`MAX_TALUS_ANGLE_DEG`].
    pub talus_angle_deg: f64,
    /// Share of the largest excess that leaves a sample in two iterations, 0..[`MAX_THERMAL_RATE`].
    pub rate: f64,
}

/// Ground that is too steep slides down (Musgrave, Kolb & Mace 1989, mass conserving).
#[derive(Debug, Clone, PartialEq)]
pub struct Thermal {
    /// From the lowest up, at most [`MAX_ROCK_LAYERS`]; each begins above the one before.
    pub layers: Vec<RockLayer>,
    /// How often.
    pub iterations: u32,
}

impl Default for Thermal {
    fn default() -> Self {
        Self {
            layers: vec![RockLayer { from_m: 0.0, talus_angle_deg: 35.0, rate: MAX_THERMAL_RATE }],
            iterations: 50,
        }
    }
}

/// A layer as kernels take it.
#[derive(Debug, Clone, Copy, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct ThermalLayer {
    /// Where it begins, in metres.
    pub from_m: f32,
    /// The drop to the next sample along x or z that holds, in metres.
    pub talus_m: f32,
    /// Half the rate.
    pub half_rate: f32,
}

/// [`Thermal`] as kernels take it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThermalKernel {
    /// From the lowest up.
    pub layers: [ThermalLayer; MAX_ROCK_LAYERS],
    /// How many of them there are, at least 1.
    pub num_layers: u32,
}

impl ThermalKernel {
    /// On samples `spacing_m` apart.
    ///
    /// # Errors
    /// [`Error::BrushValue`] of the brush named, for a value beyond its limits.
    pub fn new(brush: &'static str, thermal: &Thermal, spacing_m: f64) -> Result<Self> {
        let check = Check { brush };
        let num_layers = thermal.layers.len();
        check.within("layers", num_layers as f64, 1.0, MAX_ROCK_LAYERS as f64)?;
        check.within("iterations", f64::from(thermal.iterations), 0.0, f64::from(MAX_EROSION_ITERATIONS))?;
        let mut layers = [ThermalLayer::default(); MAX_ROCK_LAYERS];
        let mut lowest_m = -f64::from(crate::MAX_HEIGHT_M);
        for (index, (kernel, layer)) in layers.iter_mut().zip(&thermal.layers).enumerate() {
            check.within("talus_angle", layer.talus_angle_deg, 0.0, MAX_TALUS_ANGLE_DEG)?;
            check.within("rate", layer.rate, 0.0, MAX_THERMAL_RATE)?;
            if index > 0 {
                check.within("from", layer.from_m, lowest_m, f64::from(crate::MAX_HEIGHT_M))?;
                lowest_m = layer.from_m;
            }
            *kernel = ThermalLayer {
                from_m: lowest_m as f32,
                talus_m: (layer.talus_angle_deg.to_radians().tan() * spacing_m) as f32,
                half_rate: (layer.rate * 0.5) as f32,
            };
        }
        Ok(Self { layers, num_layers: num_layers as u32 })
    }

    /// The layers that there are.
    pub fn layers(&self) -> impl Iterator<Item = &ThermalLayer> {
        self.layers.iter().take(self.num_layers as usize)
    }
}

/// Water on a grid of samples joined by pipes, that takes up rock and lays it down (after Mei, Decaudin & Hu 2007).
#[derive(Debug, Clone, PartialEq)]
pub struct Pipes {
    /// Rain everywhere, in metres a second: 0..1.
    pub rain_m_per_s: f64,
    /// Share of the water that evaporates in a second: 0..10.
    pub evaporation_per_s: f64,
    /// Sediment that a volume of water holds, for each metre a second of its velocity, on a vertical slope: 0..10.
    pub capacity_s_per_m: f64,
    /// Share of what water could still hold that it takes up in a second: 0..100.
    pub dissolving_per_s: f64,
    /// Share of what water holds too much that it lays down in a second: 0..100.
    pub deposition_per_s: f64,
    /// Ground is taken to be at least so steep, in degrees: 0..45.
    pub min_slope_deg: f64,
    /// Share of a pipe's flow that is lost to friction in a second: 0..100.
    pub friction_per_s: f64,
    /// Metres a second, each second: above 0, up to 1000.
    pub gravity_m_per_s2: f64,
    /// Cross-section of a pipe, in square metres; `None`: the spacing's square.
    pub pipe_area_m2: Option<f64>,
    /// Seconds an iteration, cut to [`PipesKernel::longest_step_s`]; `None`: that.
    pub time_step_s: Option<f64>,
    /// How many.
    pub iterations: u32,
}

impl Default for Pipes {
    fn default() -> Self {
        Self {
            rain_m_per_s: 0.01,
            evaporation_per_s: 0.02,
            capacity_s_per_m: 0.5,
            dissolving_per_s: 0.1,
            deposition_per_s: 0.1,
            min_slope_deg: 3.0,
            friction_per_s: 0.5,
            gravity_m_per_s2: 9.81,
            pipe_area_m2: None,
            time_step_s: None,
            iterations: 150,
        }
    }
}

/// [`Pipes`] as kernels take it: flows are metres of a sample's water in one iteration.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct PipesKernel {
    /// Metres that fall in an iteration.
    pub rain_m: f32,
    /// What an iteration leaves of the water.
    pub staying: f32,
    /// What an iteration's friction leaves of a flow.
    pub flowing: f32,
    /// `dt² A g / l³`: what a metre of difference adds to a flow; at most [`Self::MAX_ACCELERATION`].
    pub acceleration: f32,
    /// Metres of sediment that a flow of one metre holds on a vertical slope: capacity times `l / dt`.
    pub capacity: f32,
    /// Sine of the least slope.
    pub min_slope: f32,
    /// Share taken up in an iteration, 0..1.
    pub dissolving: f32,
    /// Share laid down in an iteration, 0..1.
    pub deposition: f32,
    /// `1 / 2 l`.
    pub slope_scale: f32,
}

impl PipesKernel {
    /// The largest [`Self::acceleration`]. Shallow water on this grid is stable below 1/2 (the largest eigenvalue of the
    /// five-point Laplacian is 8); where both pipes between two samples flow, twice as much is gained.
    pub const MAX_ACCELERATION: f64 = 0.25;

    /// The longest stable time step.
    #[must_use]
    pub fn longest_step_s(spacing_m: f64, pipe_area_m2: f64, gravity_m_per_s2: f64) -> f64 {
        (Self::MAX_ACCELERATION * spacing_m.powi(3) / (pipe_area_m2 * gravity_m_per_s2)).sqrt()
    }

    /// On samples `spacing_m` apart.
    ///
    /// # Errors
    /// [`Error::BrushValue`] of the brush named, for a value beyond its limits.
    pub fn new(brush: &'static str, pipes: &Pipes, spacing_m: f64) -> Result<Self> {
        const TINY: f64 = 1.0e-6;
        let check = Check { brush };
        let (area, gravity) = (pipes.pipe_area_m2.unwrap_or(spacing_m * spacing_m), pipes.gravity_m_per_s2);
        check.within("gravity", gravity, TINY, 1000.0)?;
        check.within("pipe_area", area, TINY, 1.0e9)?;
        let longest = Self::longest_step_s(spacing_m, area, gravity);
        let step = pipes.time_step_s.unwrap_or(longest);
        check.within("time_step", step, TINY, 1.0e6)?;
        let step = step.min(longest);
        check.within("rain", pipes.rain_m_per_s, 0.0, 1.0)?;
        check.within("evaporation", pipes.evaporation_per_s, 0.0, 10.0)?;
        check.within("capacity", pipes.capacity_s_per_m, 0.0, 10.0)?;
        check.within("dissolving", pipes.dissolving_per_s, 0.0, 100.0)?;
        check.within("deposition", pipes.deposition_per_s, 0.0, 100.0)?;
        check.within("min_slope", pipes.min_slope_deg, 0.0, 45.0)?;
        check.within("friction", pipes.friction_per_s, 0.0, 100.0)?;
        check.within("iterations", f64::from(pipes.iterations), 0.0, f64::from(MAX_EROSION_ITERATIONS))?;
        let left = |share_per_s: f64| (1.0 - share_per_s * step).max(0.0) as f32;
        Ok(Self {
            rain_m: (pipes.rain_m_per_s * step) as f32,
            staying: left(pipes.evaporation_per_s),
            flowing: left(pipes.friction_per_s),
            acceleration: (step * step * area * gravity / spacing_m.powi(3)) as f32,
            capacity: (pipes.capacity_s_per_m * spacing_m / step) as f32,
            min_slope: pipes.min_slope_deg.to_radians().sin() as f32,
            dissolving: (pipes.dissolving_per_s * step).min(1.0) as f32,
            deposition: (pipes.deposition_per_s * step).min(1.0) as f32,
            slope_scale: (0.5 / spacing_m) as f32,
        })
    }
}

/// Drops of water that run down, one by one, and take rock along.
#[derive(Debug, Clone, PartialEq)]
pub struct Droplets {
    /// How many, for each sample of the region: 0..64.
    pub per_sample: f64,
    /// How much of its direction a droplet keeps where the slope wants another: 0..0.99.
    pub inertia: f64,
    /// Sediment that it holds, in spacings, for each unit of slope, of speed and of water: 0..64.
    pub capacity: f64,
    /// Share of what it could still hold that it takes up at a step: 0..1.
    pub erosion: f64,
    /// Share of what it holds too much that it lays down at a step: 0..1.
    pub deposition: f64,
    /// Ground is taken to be at least so steep, in degrees: 0..45.
    pub min_slope_deg: f64,
    /// Share of its water that evaporates at a step: 0..0.5.
    pub evaporation: f64,
    /// What a unit of slope adds to the square of its speed at a step: 0..100.
    pub gravity: f64,
    /// How far it erodes to the sides, in samples: 1..[`MAX_DROPLET_RADIUS`].
    pub radius: u32,
    /// How many steps of one sample: 1..[`MAX_DROPLET_STEPS`].
    pub max_steps: u32,
    /// Where they start.
    pub seed: u32,
}

impl Default for Droplets {
    fn default() -> Self {
        Self {
            per_sample: 1.0,
            inertia: 0.1,
            capacity: 0.2,
            erosion: 0.1,
            deposition: 0.1,
            min_slope_deg: 0.5,
            evaporation: 0.02,
            gravity: 4.0,
            radius: 3,
            max_steps: 64,
            seed: 0,
        }
    }
}

/// Samples of a part of a disc.
pub const DISC_LANES: usize = 8;

/// Up to [`DISC_LANES`] samples side by side of the disc that a droplet erodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiscPart {
    /// Rows from its centre.
    pub dz: i32,
    /// Columns from its centre of the first.
    pub dx: i32,
    /// How many.
    pub num_samples: u32,
    /// Their shares, then zeros; those of a disc sum to 1.
    pub weights: [f32; DISC_LANES],
}

/// [`Droplets`] as kernels take it.
#[derive(Debug, Clone, PartialEq)]
pub struct DropletKernel {
    /// 0..0.99.
    pub inertia: f32,
    /// Metres of sediment for each metre of drop, of speed and of water.
    pub capacity: f32,
    /// 0..1.
    pub erosion: f32,
    /// 0..1.
    pub deposition: f32,
    /// The least drop of a step, in metres.
    pub min_drop_m: f32,
    /// What a step leaves of the water.
    pub staying: f32,
    /// What a metre of drop adds to the square of the speed.
    pub gravity: f32,
    /// Steps of one sample.
    pub max_steps: u32,
    /// See [`Droplets::seed`].
    pub seed: u32,
    /// How far the disc reaches, in samples.
    pub radius: u32,
    /// `1 - distance / (radius + ½)`, where that is above 0, divided by the sum of them all.
    pub disc: Vec<DiscPart>,
}

impl DropletKernel {
    /// On samples `spacing_m` apart.
    ///
    /// # Errors
    /// [`Error::BrushValue`] of the brush named, for a value beyond its limits.
    pub fn new(brush: &'static str, droplets: &Droplets, spacing_m: f64) -> Result<Self> {
        let check = Check { brush };
        check.within("droplets", droplets.per_sample, 0.0, 64.0)?;
        check.within("inertia", droplets.inertia, 0.0, 0.99)?;
        check.within("capacity", droplets.capacity, 0.0, 64.0)?;
        check.within("erosion", droplets.erosion, 0.0, 1.0)?;
        check.within("deposition", droplets.deposition, 0.0, 1.0)?;
        check.within("min_slope", droplets.min_slope_deg, 0.0, 45.0)?;
        check.within("evaporation", droplets.evaporation, 0.0, 0.5)?;
        check.within("gravity", droplets.gravity, 0.0, 100.0)?;
        check.within("erosion_radius", f64::from(droplets.radius), 1.0, f64::from(MAX_DROPLET_RADIUS))?;
        check.within("max_steps", f64::from(droplets.max_steps), 1.0, f64::from(MAX_DROPLET_STEPS))?;
        Ok(Self {
            inertia: droplets.inertia as f32,
            capacity: droplets.capacity as f32,
            erosion: droplets.erosion as f32,
            deposition: droplets.deposition as f32,
            min_drop_m: (droplets.min_slope_deg.to_radians().tan() * spacing_m) as f32,
            staying: (1.0 - droplets.evaporation) as f32,
            gravity: (droplets.gravity / spacing_m) as f32,
            max_steps: droplets.max_steps,
            seed: droplets.seed,
            radius: droplets.radius,
            disc: disc(droplets.radius.cast_signed()),
        })
    }

    /// How far from its start a droplet reads or changes samples.
    #[must_use]
    pub const fn reach(&self) -> u32 {
        self.max_steps + self.radius + 2
    }

    /// Droplets of each round on a region of so many samples.
    #[must_use]
    pub fn droplets_per_round(num_samples: u64) -> u32 {
        (num_samples / u64::from(SAMPLES_PER_DROPLET)).clamp(1, u64::from(DROPLETS_PER_ROUND)) as u32
    }
}

fn disc(radius: i32) -> Vec<DiscPart> {
    let reach = f64::from(radius) + 0.5;
    let weight = |dx: i32, dz: i32| 1.0 - f64::from(dx * dx + dz * dz).sqrt() / reach;
    let columns = |dz: i32| (-radius..=radius).filter(move |dx| weight(*dx, dz) > 0.0);
    let sum: f64 = (-radius..=radius).flat_map(|dz| columns(dz).map(move |dx| weight(dx, dz))).sum();
    let mut parts: Vec<DiscPart> = Vec::new();
    for dz in -radius..=radius {
        for (place, dx) in columns(dz).enumerate() {
            if place % DISC_LANES == 0 {
                parts.push(DiscPart { dz, dx, num_samples: 0, weights: [0.0; DISC_LANES] });
            }
            let part = parts.last_mut();
            if let Some((part, share)) =
                part.and_then(|part| Some((&mut part.num_samples, part.weights.get_mut(place % DISC_LANES)?)))
            {
                (*part, *share) = (*part + 1, (weight(dx, dz) / sum) as f32);
            }
        }
    }
    parts
}

struct Check {
    brush: &'static str,
}

impl Check {
    fn within(&self, field: &str, value: f64, least: f64, most: f64) -> Result<()> {
        // NaN is in no range.
        if (least..=most).contains(&value) {
            return Ok(());
        }
        let limit = format!("give {least} to {most}");
        Err(Error::BrushValue { brush: self.brush, field: field.to_owned(), value: value.to_string(), limit })
    }
}
