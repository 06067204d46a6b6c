//! How many instances act on each sample of a plane, and how far apart two back ends may be there.

use orogeny_brush::filter::Step;
use orogeny_brush::{Batch, Rule};
use orogeny_field::noise::Turbulence;
use orogeny_field::{FalloffFormula, Footprint, Instance, SampleRect, WeightMode};
use orogeny_reference::amounts;

use crate::{Plane, Tolerance};

/// For each sample of a plane, what reaches it.
#[derive(Debug)]
pub struct Reach {
    width: u32,
    num_instances: Vec<u32>,
    sum_of_amounts: Vec<f64>,
    largest_amplitude: f32,
    range_m: f64,
    most_instances: u32,
    has_transcendentals: bool,
    goal: Goal,
}

/// What an amount of 1 is worth.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Goal {
    /// A metre.
    Metres,
    /// The way to a height.
    Height(f32),
    /// So many metres; and what a height's rounding is magnified by on its way through the kernel, from instance to instance.
    Scale { metres: f64, magnified: f64 },
    /// The share of an amount, in metres, that two back ends may differ by.
    Noise(f64),
    /// The share of the range of all heights that they may differ by after each instance.
    Filter(f64),
}

/// What an amount of 1 is worth, by what a kernel does.
fn goal(rule: &Rule) -> Goal {
    let scale = |metres: f32, magnified: f64| Goal::Scale { metres: f64::from(metres), magnified };
    match rule {
        Rule::Raise | Rule::Ledge(_) | Rule::Roughen { .. } | Rule::Custom(_) => Goal::Metres,
        Rule::Level { target_height_m, .. } => Goal::Height(*target_height_m),
        // Over its edges a height counts as often as they are steep.
        Rule::Terrace(steps) => scale(steps.step_m, f64::from(steps.steepness)),
        // A bias by a small exponent is steep at the lower end of its range.
        Rule::RangeMap(range) => scale(range.high_m - range.low_m, 64.0),
        Rule::Stamp { scale_m, .. } => scale(scale_m.abs(), 1.0),
        // Of the heights that its instances have: see `add_instance`.
        Rule::Ramp { .. } => scale(1.0, 1.0),
        Rule::Mask { .. } => scale(1.0, 1.0),
        // What is sharpened is as far again from its neighbours, by the gain.
        Rule::Filter(filter) => {
            Goal::Filter(filter.graph.nodes().iter().fold(1.0e-5, |share, node| match node.step {
                Step::Sharpen { gain } => share * (1.0 + f64::from(gain)),
                // What ten iterations of a simulation may differ by.
                Step::Thermal { .. } | Step::Pipes { .. } => 1.0e-3,
                _ => share,
            }))
        }
        Rule::Noise(kernel) => {
            let amplitude: f64 =
                kernel.scales.iter().take(kernel.slots.main as usize).map(|scale| scale.weight).sum();
            let curve = if kernel.curve.is_some() || kernel.transfer.is_some() { 8.0 } else { 1.0 };
            // Erosive and Jordan noise look an octave up where the slopes of those before it lead: every octave magnifies their
            // rounding by its frequency. So does a distortion.
            let bent = match kernel.turbulence {
                Turbulence::Erosive | Turbulence::Jordan => 50.0,
                _ if kernel.slots.distortion > 0 => 4.0,
                _ => 1.0,
            };
            Goal::Noise(1.0e-4 * amplitude * kernel.scale.abs() * curve * bent)
        }
    }
}

impl Reach {
    /// What the batches of one operation do to a plane.
    #[must_use]
    pub fn of(batches: &[Batch], plane: &Plane) -> Self {
        let num_samples = plane.samples().len();
        let mut reach = Self {
            width: plane.width(),
            num_instances: vec![0; num_samples],
            sum_of_amounts: vec![0.0; num_samples],
            largest_amplitude: 0.0,
            range_m: range_m(plane),
            most_instances: 0,
            has_transcendentals: false,
            goal: Goal::Metres,
        };
        for batch in batches {
            reach.add(batch, plane);
        }
        reach.most_instances = reach.num_instances.iter().copied().max().unwrap_or_default();
        reach
    }

    fn add(&mut self, batch: &Batch, plane: &Plane) {
        let footprint = &batch.pass.footprint;
        if self.goal == Goal::Metres {
            self.goal = goal(&batch.pass.rule);
        }
        self.has_transcendentals |= footprint.weight_mode == WeightMode::BuildUp
            || matches!(batch.pass.rule, Rule::RangeMap(_) | Rule::Ramp { .. })
            // Bilinear and linear look-ups magnify the rounding of where they look, as a power does that of its base.
            || batch.pass.bitmap().is_some()
            || matches!(
                footprint.falloff.formula,
                FalloffFormula::Gauss | FalloffFormula::Power | FalloffFormula::Sigmoid | FalloffFormula::Curve
            );
        // By pages: a batch may be a piece of a larger one, with all of its instances and some of its pages.
        for work in &batch.pages {
            for index in &work.instances {
                let (instance, bound) = (&batch.instances[*index as usize], batch.bounds[*index as usize]);
                self.add_instance(instance, &bound.intersection(&work.rect), footprint, plane);
            }
        }
    }

    fn add_instance(&mut self, instance: &Instance, rect: &SampleRect, footprint: &Footprint, plane: &Plane) {
        self.largest_amplitude = self.largest_amplitude.max(instance.amplitude.abs());
        let own_m = f64::from(instance.reference_height_m.abs().max(instance.end_height_m.abs()));
        if let Goal::Scale { metres, .. } = &mut self.goal {
            *metres = metres.max(own_m);
        }
        let mut row = vec![0.0; rect.width() as usize];
        for z in rect.z0..rect.z1 {
            amounts::row(&mut row, rect.x0, z, instance, footprint);
            let first = plane.index(rect.x0.cast_unsigned(), z.cast_unsigned());
            for (x, amount) in (rect.x0..).zip(&row) {
                let along = |place: i32, cell: i32, fraction: f32| {
                    f64::from(place) - f64::from(cell) - f64::from(fraction)
                };
                let [cell_x, cell_z] = instance.cell;
                let [fraction_x, fraction_z] = instance.fraction;
                let way = [along(x, cell_x, fraction_x), along(z, cell_z, fraction_z)];
                let [end_x, end_z] = instance.segment.map(f64::from);
                let share = (way[0] * end_x + way[1] * end_z) * f64::from(instance.inverse_segment_squared);
                let share = share.clamp(0.0, 1.0);
                let distance = (way[0] - share * end_x).hypot(way[1] - share * end_z);
                // A millionth more than the radius: where rounding decides, a back end may see it either way.
                if distance * f64::from(instance.inverse_radius) < 1.000_001 {
                    let index = first + x.abs_diff(rect.x0) as usize;
                    self.num_instances[index] += 1;
                    self.sum_of_amounts[index] += f64::from(amount.abs());
                }
            }
        }
    }

    /// What two back ends may differ by for an amount of 1 m of a noise, as a share of it.
    #[must_use]
    pub fn share(batch: &Batch) -> f64 {
        match goal(&batch.pass.rule) {
            Goal::Noise(share) => share,
            Goal::Metres | Goal::Height(_) | Goal::Scale { .. } | Goal::Filter(_) => 0.0,
        }
    }

    /// Instances that act on a sample.
    #[must_use]
    pub fn num_instances(&self, x: u32, z: u32) -> u32 {
        self.num_instances[self.index(x, z)]
    }

    /// Samples that any instance acts on.
    #[must_use]
    pub fn num_reached(&self) -> usize {
        self.num_instances.iter().filter(|num| **num > 0).count()
    }

    /// The most instances that act on one sample.
    #[must_use]
    pub const fn most_instances(&self) -> u32 {
        self.most_instances
    }

    /// How far apart two back ends may be at a sample whose height went from `before_m` to `after_m`: `(4 + 2 sqrt K)` units
    /// in the last place of the largest of the two, the amplitude and 1 m for `K` instances, and 4e-6 of the sum of their
    /// amounts where these take an exponential, a power or a hyperbolic tangent. Amplitude and amounts are in metres: those of
    /// a blending brush are shares of the way to its target, and count that often. For each instance of one that looks at
    /// neighbours, 1e-5 of the range of all heights. Where no instance acts, not a bit; only a
    /// denormal may become 0, since a kernel rounds its rectangle up.
    #[must_use]
    pub fn tolerance(&self, x: u32, z: u32, before_m: f32, after_m: f32) -> Tolerance {
        let num_instances = self.num_instances(x, z);
        if num_instances == 0 {
            let absolute_m = if before_m.is_subnormal() { f64::from(f32::MIN_POSITIVE) } else { 0.0 };
            return Tolerance { absolute_m, ..Tolerance::EXACT };
        }
        let way_m = |target_m: f32| (target_m - before_m).abs().max((target_m - after_m).abs());
        let (amplitude_m, metres, magnified) = match self.goal {
            Goal::Metres | Goal::Noise(_) | Goal::Filter(_) => (self.largest_amplitude, 1.0, 1.0),
            Goal::Height(target_m) => (way_m(target_m), f64::from(way_m(target_m)), 1.0),
            Goal::Scale { metres, magnified } => (metres as f32, metres, magnified),
        };
        let sum_of_amounts_m = self.sum_of_amounts[self.index(x, z)] * metres;
        let mut absolute_m = if self.has_transcendentals { 4.0e-6 * sum_of_amounts_m } else { 0.0 };
        if let Goal::Noise(share) = self.goal {
            absolute_m += share * sum_of_amounts_m;
        }
        if let Goal::Filter(share) = self.goal {
            // What one instance left different, the next ones take along.
            absolute_m += share * self.range_m * f64::from(self.most_instances);
        }
        Tolerance {
            ulps: magnified * (4.0 + 2.0 * f64::from(num_instances).sqrt()),
            of_m: before_m.abs().max(after_m.abs()).max(amplitude_m).max(1.0),
            absolute_m,
        }
    }

    const fn index(&self, x: u32, z: u32) -> usize {
        z as usize * self.width as usize + x as usize
    }
}

/// From the lowest height to the highest.
fn range_m(plane: &Plane) -> f64 {
    let heights = || plane.samples().iter().map(|height_m| f64::from(*height_m));
    heights().fold(f64::MIN, f64::max) - heights().fold(f64::MAX, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Feed, Operation, plan};
    use orogeny_field::{
        Brush, BrushType, FieldId, PageLayout, PointerSample, ProfileShape, SampleRect, Stroke, TerrainGrid,
    };

    fn reach(operation: &Operation) -> Reach {
        let layout = PageLayout::new(64).unwrap();
        let plane = Plane::from_fn(80, 80, |_, _| 0.0);
        let grid = TerrainGrid::new(80, 80, 1.0).unwrap();
        let mut store = plane.to_pages(layout, FieldId(0));
        let feed = Feed { max_batch: 1, ..Feed::WHOLE };
        Reach::of(&plan(operation, &grid, FieldId(0), &mut store, feed).unwrap(), &plane)
    }

    fn stroke(shape: ProfileShape, points: &[(f64, f64)]) -> Operation {
        let brush = Brush { shape, ..Brush::new(BrushType::Raise, 10.0, 8.0) };
        let points = points.iter().map(|(x, z)| PointerSample::at(*x, *z)).collect();
        Operation::Stroke(Stroke { brush, seed: 0, points })
    }

    #[test]
    fn one_dab_acts_once_within_its_radius_and_nowhere_else() {
        let reach = reach(&stroke(ProfileShape::Linear, &[(20.0, 30.0)]));
        assert_eq!((reach.most_instances(), reach.num_instances(29, 30)), (1, 1));
        assert_eq!(reach.num_instances(31, 30), 0);
        assert_eq!(reach.tolerance(31, 30, 5.0, 5.0), Tolerance::EXACT);
        let tolerance = reach.tolerance(20, 30, 5.0, 13.0);
        assert_eq!(tolerance, Tolerance { ulps: 6.0, of_m: 13.0, absolute_m: 0.0 });
        assert_eq!(reach.tolerance(20, 30, 0.5, 0.25).of_m, 8.0);
    }

    #[test]
    fn a_pass_acts_as_often_as_its_spacing_says() {
        // A radius of 10 at a quarter of it: 2 * 10 / 2.5 instances reach the centre line.
        let reach = reach(&stroke(ProfileShape::Gauss, &[(5.0, 40.3), (75.0, 40.3)]));
        assert!((7..=8).contains(&reach.num_instances(40, 40)), "{}", reach.num_instances(40, 40));
        let tolerance = reach.tolerance(40, 40, 0.0, 8.0);
        assert!((tolerance.absolute_m - 4.0e-6 * 8.0).abs() < 1.0e-6, "{tolerance:?}");
    }

    #[test]
    fn what_a_blending_brush_does_is_measured_by_the_way_to_its_target() {
        let Operation::Stroke(mut stroke) = stroke(ProfileShape::Gauss, &[(20.0, 30.0)]) else { panic!() };
        stroke.brush = Brush { height_m: Some(1000.0), shape: ProfileShape::Gauss, ..stroke.brush };
        stroke.brush.brush_type = BrushType::SetHeight;
        stroke.brush.strength = 0.5;
        let reach = reach(&Operation::Stroke(stroke));
        let tolerance = reach.tolerance(20, 30, 200.0, 600.0);
        assert_eq!((tolerance.ulps, tolerance.of_m), (6.0, 800.0));
        assert!((tolerance.absolute_m - 4.0e-6 * 0.5 * 800.0).abs() < 1.0e-9, "{tolerance:?}");
    }

    #[test]
    fn a_fill_acts_once_on_each_sample_of_its_region() {
        let region = SampleRect::new(10, 20, 80, 70);
        let brush = Brush::new(BrushType::Raise, 10.0, 8.0);
        let reach = reach(&Operation::Fill { brush, seed: 0, region });
        assert_eq!(reach.most_instances(), 1);
        assert_eq!(reach.num_reached() as u64, region.area());
    }
}
