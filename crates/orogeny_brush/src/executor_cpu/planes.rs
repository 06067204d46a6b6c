//! Graphs worked out on the CPU: plane after plane.

use orogeny_field::{Plane, SampleRect};

use super::steps::{Source, fill, fill_through};
use crate::execute::Watch;
use crate::filter::{Graph, Node, Step};
use crate::{Error, Result};

/// Works out graphs, and keeps the memory of their planes.
#[derive(Debug, Default)]
pub(super) struct Planes {
    pool: Vec<Plane>,
}

impl Planes {
    /// Works out the last plane of a graph over `target`; `given` fills those that are made of no other, but for those that are `there`
    /// with all that is needed of them.
    pub(super) fn work_out<'a>(
        &mut self,
        threads: &rayon::ThreadPool,
        graph: &Graph,
        target: SampleRect,
        there: impl Fn(&Step) -> Option<&'a Plane>,
        mut given: impl FnMut(&Step, Plane) -> Result<Plane>,
        watch: Watch<'_>,
    ) -> Result<Plane> {
        let rects = graph.plan(target);
        let mut planes: Vec<Option<Plane>> = Vec::with_capacity(rects.len());
        for (place, (node, rect)) in graph.nodes().iter().zip(&rects).enumerate() {
            if !watch(place as f64 / rects.len() as f64) {
                return Err(Error::Interrupted);
            }
            if graph.is_passing(place) || there(&node.step).is_some() {
                planes.push(None);
                continue;
            }
            let passing = passing(graph, node);
            let mut plane = self.memory(*rect, node.step.num_channels());
            if node.step.is_given() {
                plane = given(&node.step, plane)?;
            } else if !rect.is_empty() {
                let made_of = passing.map_or(node, |(_, before)| before);
                let plane_of = |input: usize| {
                    let there = there(&graph.nodes().get(input)?.step);
                    there.or_else(|| planes.get(input)?.as_ref())
                };
                let source =
                    |input: &usize| Some(Source { plane: plane_of(*input)?, mirrors: graph.mirrors(*input) });
                let sources: Vec<_> = made_of.inputs.iter().filter_map(source).collect();
                threads.install(|| match passing {
                    Some((place, before)) => {
                        fill_through(&mut plane, &node.step, &before.step, graph.mirrors(place), &sources);
                    }
                    None => fill(&mut plane, &node.step, &sources, graph.extent()),
                });
            }
            planes.push(Some(plane));
            // What no later plane is made of gives its memory back.
            for input in passing
                .map(|(place, _)| place)
                .into_iter()
                .chain([place])
                .flat_map(|place| graph.done_with(place))
            {
                if let Some(plane) = planes.get_mut(input).and_then(Option::take) {
                    self.give_back(plane);
                }
            }
        }
        Ok(planes.pop().flatten().unwrap_or_else(|| Plane::constant(SampleRect::EMPTY, 0.0)))
    }

    /// Takes back the memory of a plane that is no longer needed.
    pub(super) fn give_back(&mut self, plane: Plane) {
        self.pool.push(plane);
    }

    /// Gives up memory until at most so many bytes are kept for the next operation.
    pub(super) fn shrink_to(&mut self, max_in_bytes: u64) {
        // The largest are of use to planes of any size.
        self.pool.sort_unstable_by_key(|plane| std::cmp::Reverse(plane.capacity()));
        let mut kept_in_bytes = 0;
        self.pool.retain(|plane| {
            kept_in_bytes += plane.size_in_bytes();
            kept_in_bytes <= max_in_bytes
        });
    }

    /// The memory that is kept.
    pub(super) fn size_in_bytes(&self) -> u64 {
        self.pool.iter().map(Plane::size_in_bytes).sum()
    }

    /// A plane whose values are to be written.
    pub(super) fn memory(&mut self, rect: SampleRect, num_channels: u32) -> Plane {
        // The smallest that is large enough, else the largest.
        let size = rect.area() as usize * num_channels as usize;
        let is_better = |plane: &Plane| (plane.capacity() < size, plane.capacity().abs_diff(size));
        let best =
            self.pool.iter().enumerate().min_by_key(|(_, plane)| is_better(plane)).map(|(place, _)| place);
        match best {
            Some(place) => self.pool.swap_remove(place).reused(rect, num_channels),
            None => Plane::with_channels(rect, num_channels, 0.0),
        }
    }
}

/// The plane of which a node is made that is never whole, and its place.
fn passing<'a>(graph: &'a Graph, node: &Node) -> Option<(usize, &'a Node)> {
    let place = *node.inputs.first().filter(|place| graph.is_passing(**place))?;
    Some((place, graph.nodes().get(place)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::Canvas;
    use crate::filter::Filter;
    use orogeny_field::{
        Brush, BrushType, FieldId, PageLayout, SmoothMethod, Smoothing, TerrainGrid, gaussian_weights,
        mirrored,
    };

    const WIDTH: i32 = 157;
    const DEPTH: i32 = 118;

    fn ground() -> Plane {
        let rect = SampleRect::new(0, 0, WIDTH, DEPTH);
        let height = |x: u32, z: u32| {
            let random = orogeny_field::hash::uniform(x, z, 7);
            1500.0 + 300.0 * (x as f32 / 40.0).sin() - 2.0 * z as f32 + 25.0 * random
        };
        let places = (0..DEPTH.unsigned_abs()).flat_map(|z| (0..WIDTH.unsigned_abs()).map(move |x| (x, z)));
        Plane::from_samples(rect, 1, places.map(|(x, z)| height(x, z)).collect()).unwrap()
    }

    fn canvas(grid: TerrainGrid) -> Canvas {
        Canvas::heights(grid, PageLayout::default(), FieldId(0))
    }

    fn graphs() -> Vec<(String, Filter)> {
        let grid = TerrainGrid::new(WIDTH as u64, DEPTH as u64, 1.0).unwrap();
        let mut graphs = Vec::new();
        for method in [SmoothMethod::Gaussian, SmoothMethod::Lattice] {
            for width in [0.7, 1.0, 3.0, 4.1, 9.0, 30.0] {
                let smoothing = Smoothing { method, width_m: Some(width), ..Smoothing::default() };
                let brush = Brush { smoothing, ..Brush::new(BrushType::Smooth, 10.0, 1.0) };
                graphs.push((
                    format!("{method:?} {width}"),
                    Filter::of(&brush, &canvas(grid), None).unwrap().unwrap(),
                ));
            }
        }
        graphs.push(("drag".to_owned(), Filter::drag(&grid, [3.25, -7.5])));
        let sharpen = Brush::new(BrushType::Sharpen, 20.0, 1.0);
        graphs.push(("sharpen".to_owned(), Filter::of(&sharpen, &canvas(grid), None).unwrap().unwrap()));
        graphs
    }

    fn part_of(ground: &Plane, mut plane: Plane) -> Plane {
        let rect = plane.rect();
        assert!(ground.rect().contains(&rect), "{rect:?}");
        for z in rect.z0..rect.z1 {
            let columns = rect.x0.unsigned_abs() as usize..rect.x1.unsigned_abs() as usize;
            plane.row_mut(z).unwrap().copy_from_slice(&ground.row(z).unwrap()[columns]);
        }
        plane
    }

    fn work_out(graph: &Graph, ground: &Plane, target: SampleRect) -> Plane {
        let threads = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let mut planes = Planes::default();
        // Memory that was used before, and is not what it should be.
        planes.give_back(Plane::constant(SampleRect::new(0, 0, 500, 500), f32::NAN));
        planes
            .work_out(&threads, graph, target, |_| None, |_, plane| Ok(part_of(ground, plane)), &mut |_| true)
            .unwrap()
    }

    #[test]
    fn a_part_has_the_bits_of_the_whole_wherever_it_lies() {
        let ground = ground();
        for (name, filter) in graphs() {
            let whole = work_out(&filter.graph, &ground, ground.rect());
            for rect in [
                (0, 0, 1, 1),
                (0, 50, 64, 113),
                (63, 1, 128, 65),
                (100, 17, WIDTH, DEPTH),
                (156, 117, 157, 118),
            ] {
                let rect = SampleRect::new(rect.0, rect.1, rect.2, rect.3);
                let part = work_out(&filter.graph, &ground, rect);
                for z in rect.z0..rect.z1 {
                    for x in rect.x0..rect.x1 {
                        let (a, b) = (part.at(x, z).unwrap(), whole.at(x, z).unwrap());
                        assert_eq!(a.to_bits(), b.to_bits(), "{name}: {x}, {z}: {a} and {b}");
                    }
                }
            }
        }
    }

    /// The direct Gaussian in `f64`, on the terrain mirrored without an end.
    fn direct(ground: &Plane, sigma: f64) -> Vec<f64> {
        let half = gaussian_weights(sigma);
        let sum: f64 = 1.0 + 2.0 * half.iter().map(|w| f64::from(*w)).sum::<f64>();
        let centre = 1.0 - (sum - 1.0);
        let along = |values: &[f64], is_x: bool| -> Vec<f64> {
            let at = |x: i32, z: i32| {
                let (x, z) = (mirrored(x, WIDTH.unsigned_abs()), mirrored(z, DEPTH.unsigned_abs()));
                values[(z * WIDTH + x) as usize]
            };
            (0..DEPTH)
                .flat_map(|z| (0..WIDTH).map(move |x| (x, z)))
                .map(|(x, z)| {
                    let pair = |away: i32| {
                        if is_x {
                            at(x - away, z) + at(x + away, z)
                        } else {
                            at(x, z - away) + at(x, z + away)
                        }
                    };
                    centre * at(x, z)
                        + (1..).zip(&half).map(|(away, w)| f64::from(*w) * pair(away)).sum::<f64>()
                })
                .collect()
        };
        let heights: Vec<f64> = ground.samples().iter().map(|height| f64::from(*height)).collect();
        along(&along(&heights, true), false)
    }

    #[test]
    fn gaussians_of_any_width_change_the_ground_as_the_direct_one_does_within_a_hundredth() {
        let ground = ground();
        let grid = TerrainGrid::new(WIDTH as u64, DEPTH as u64, 1.0).unwrap();
        for sigma in [0.5, 2.0, 3.9, 4.1, 6.0, 7.9, 8.5, 16.0, 33.0, 64.0] {
            let smoothing = Smoothing { width_m: Some(sigma), ..Smoothing::default() };
            let brush = Brush { smoothing, ..Brush::new(BrushType::Smooth, 10.0, 1.0) };
            let filter = Filter::of(&brush, &canvas(grid), None).unwrap().unwrap();
            let whole = work_out(&filter.graph, &ground, ground.rect());
            let (mut error, mut change) = (0.0, 0.0);
            for ((height, direct), ours) in
                ground.samples().iter().zip(direct(&ground, sigma)).zip(whole.samples())
            {
                error += (f64::from(*ours) - direct).powi(2);
                change += (f64::from(*height) - direct).powi(2);
            }
            let ratio = (error / change).sqrt();
            println!("sigma {sigma}: {ratio:.6} of the change");
            let limit = if sigma <= 4.0 { 1.0e-4 } else { 0.01 };
            assert!(ratio < limit, "sigma {sigma}: {ratio}");
        }
    }
}
