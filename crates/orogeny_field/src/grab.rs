//! Ground that is moved as a whole, as the kernel takes it.

use crate::CURVE_TABLE_LENGTH;

/// The most steps in which ground is moved.
const MAX_STEPS: f64 = 1024.0;

/// One brush's way. The layout is that of `Drag` in `shaders/field/grab.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Drag {
    /// The sample at or before where its centre begins, along x and z.
    pub cell: [i32; 2],
    /// From that sample to the centre, 0..1 of a sample.
    pub fraction: [f32; 2],
    /// From where it begins to where it ends, in samples.
    pub way: [f32; 2],
    /// 1 over the outer radius in samples.
    pub inverse_radius: f32,
    /// Nothing: rows of a table begin at multiples of 8 bytes.
    pub padding: f32,
}

/// Brushes that move the ground, all at once.
#[derive(Debug, Clone, PartialEq)]
pub struct GrabKernel {
    /// One, and its copies in mirrors.
    pub drags: Vec<Drag>,
    /// Their weight over the distance from the centre: 0 to the radius, linear between entries.
    pub weights: [f32; CURVE_TABLE_LENGTH],
    /// The steps of their way.
    pub num_steps: u32,
    /// 1 over it.
    pub inverse_num_steps: f32,
}

impl GrabKernel {
    /// Brushes with a weight, 0..1, at distances from 0 to 1 by the radius. Steps are so short that within one no two samples
    /// come nearer to one another than by half.
    #[must_use]
    pub fn new(drags: Vec<Drag>, weight: impl Fn(f32) -> f32) -> Self {
        let last = (CURVE_TABLE_LENGTH - 1) as f32;
        let mut weights = std::array::from_fn(|entry| weight(entry as f32 / last));
        // At the radius there is nothing, so that nothing begins there at once.
        if let Some(weight) = weights.last_mut() {
            *weight = 0.0;
        }
        let steepest = weights.windows(2).map(|pair| match pair {
            [nearer, further] => f64::from((nearer - further).abs() * last),
            _ => 0.0,
        });
        let steepest = steepest.fold(0.0, f64::max);
        let longest = drags.iter().map(|drag| {
            let [x, z] = drag.way.map(f64::from);
            x.hypot(z) * f64::from(drag.inverse_radius)
        });
        let longest = longest.fold(0.0, f64::max);
        let num_steps = (2.0 * steepest * longest).ceil().clamp(1.0, MAX_STEPS);
        Self { drags, weights, num_steps: num_steps as u32, inverse_num_steps: (1.0 / num_steps) as f32 }
    }

    /// The weight at a distance by the radius, `0 <= r < 1`.
    #[inline(always)]
    #[must_use]
    pub fn weight(&self, r: f32) -> f32 {
        let place = r * (CURVE_TABLE_LENGTH - 1) as f32;
        let entry = place.floor();
        let at = |entry: usize| self.weights.get(entry).copied().unwrap_or_default();
        let (nearer, further) = (at(entry as usize), at(entry as usize + 1));
        nearer + (place - entry) * (further - nearer)
    }

    /// The longest way that ground is moved, in samples, if all brushes move it.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.drags.iter().map(|drag| f64::from(drag.way[0]).hypot(f64::from(drag.way[1]))).sum()
    }
}
