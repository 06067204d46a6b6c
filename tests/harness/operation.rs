//! Operations on a terrain, fed to an executor in a given way.

use std::sync::{Arc, OnceLock};

use orogeny_brush::{
    Batch, Canvas, CloneGround, Executor, Notices, Resources, Result, StrokePlanner, plan_fill,
};
use orogeny_field::{Bitmap, Brush, BrushType, FieldId, Gate, PageLayout, SampleRect, Stroke, TerrainGrid};
use orogeny_pages::PageStore;

use crate::{Plane, Random};

/// The field that [`paint`] paints on.
const FIELD: FieldId = FieldId(1);

/// What is done to a terrain.
#[derive(Debug, Clone)]
pub enum Operation {
    /// A brush along pointer samples.
    Stroke(Stroke),
    /// A brush over a region.
    Fill {
        /// What is filled with.
        brush: Brush,
        /// Feeds everything random in it.
        seed: u32,
        /// Where, in samples.
        region: SampleRect,
    },
}

/// How the pointer samples of a stroke arrive. Of a fill there is nothing to split.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Split {
    /// All before the first batch is asked for.
    Whole,
    /// Half of them; their batches; the other half.
    TwoHalves,
    /// One, and the batches that it settles, after another.
    SampleBySample,
}

/// How an operation is fed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Feed {
    /// How samples arrive.
    pub split: Split,
    /// Instances of a stroke, or pages of a fill, in one batch.
    pub max_batch: usize,
}

impl Feed {
    /// Everything at once.
    pub const WHOLE: Self = Self { split: Split::Whole, max_batch: usize::MAX };
}

/// A plane after operations.
#[derive(Debug)]
pub struct Painted {
    /// The heights.
    pub plane: Plane,
    /// What each operation met.
    pub notices: Vec<Notices>,
}

/// Does `operations` one after another to a terrain with the heights `plane`, and gives what its pages hold then.
///
/// # Errors
/// What planning and the executor say; the executor is then to be cancelled.
pub fn paint(
    plane: &Plane,
    spacing_m: f64,
    operations: &[Operation],
    executor: &mut dyn Executor,
    layout: PageLayout,
    feed: Feed,
) -> Result<Painted> {
    let grid = TerrainGrid::new(plane.width().into(), plane.depth().into(), spacing_m)?;
    let mut store = plane.to_pages(layout, FIELD);
    let mut notices = Vec::new();
    for operation in operations {
        notices.push(apply(operation, &grid, FIELD, executor, &mut store, feed)?);
        store.commit();
    }
    // The next terrain has the same field.
    executor.forget(&plane.keys(layout, FIELD));
    Ok(Painted { plane: Plane::from_pages(plane.width(), plane.depth(), &store, layout, FIELD), notices })
}

/// Does one operation to the pages of a store, and finishes it.
///
/// # Errors
/// What planning and the executor say; the executor is then to be cancelled.
pub fn apply(
    operation: &Operation,
    grid: &TerrainGrid,
    field: FieldId,
    executor: &mut dyn Executor,
    store: &mut dyn PageStore,
    feed: Feed,
) -> Result<Notices> {
    for_each_batch(operation, grid, field, store, feed, |batch, store| executor.run(&batch, store))?;
    executor.finish(store)
}

/// The batches that [`apply`] would run.
///
/// # Errors
/// What planning says.
pub fn plan(
    operation: &Operation,
    grid: &TerrainGrid,
    field: FieldId,
    store: &mut dyn PageStore,
    feed: Feed,
) -> Result<Vec<Batch>> {
    let mut batches = Vec::new();
    for_each_batch(operation, grid, field, store, feed, |batch, _| {
        batches.push(batch);
        Ok(())
    })?;
    Ok(batches)
}

/// What a brush is painted on: mask brushes take the field for a mask.
fn canvas(brush: &Brush, grid: TerrainGrid, layout: PageLayout, field: FieldId) -> Canvas {
    Canvas {
        is_mask: brush.brush_type.is_for_masks(),
        selection: field,
        ..Canvas::heights(grid, layout, field)
    }
}

/// What a brush names: one bitmap stands in for all.
#[must_use]
pub fn resources(brush: &Brush, field: FieldId) -> Resources {
    static BITMAP: OnceLock<Arc<Bitmap>> = OnceLock::new();
    let bitmap = BITMAP.get_or_init(|| {
        let mut random = Random::new(11);
        let values = (0..37 * 23).map(|_| random.within(0.0, 1.0) as f32).collect();
        Arc::new(Bitmap::new(37, 23, values).unwrap())
    });
    let of = |is_named: bool| is_named.then(|| Arc::clone(bitmap));
    let has_image = |gate: Option<&Gate>| gate.is_some_and(|gate| gate.image.is_some());
    Resources {
        alpha: of(brush.alpha.is_some()),
        gate_image: of(has_image(brush.gate.as_deref())),
        hardness_image: of(has_image(brush.hardness.as_deref())),
        roughness_image: of(has_image(brush.noise.roughness.as_deref())),
        custom: None,
        clone_ground: (brush.brush_type == BrushType::Clone).then(|| clone_ground(brush, field)),
    }
}

/// What a clone brush copies: the field itself, or a small raster that stands in for data from outside.
fn clone_ground(brush: &Brush, field: FieldId) -> CloneGround {
    static RASTER: OnceLock<Arc<orogeny_field::Plane>> = OnceLock::new();
    if brush.cloning.source.data.is_none() {
        return CloneGround::Field(field);
    }
    let heights = RASTER.get_or_init(|| {
        let mut random = Random::new(31);
        let heights = (0..61 * 47).map(|_| random.within(-300.0, 900.0) as f32).collect();
        let rect = SampleRect::new(0, 0, 61, 47);
        Arc::new(orogeny_field::Plane::from_samples(rect, 1, heights).unwrap())
    });
    CloneGround::Raster { heights: Arc::clone(heights), spacing_m: 2.5 }
}

fn for_each_batch(
    operation: &Operation,
    grid: &TerrainGrid,
    field: FieldId,
    store: &mut dyn PageStore,
    feed: Feed,
    mut act: impl FnMut(Batch, &mut dyn PageStore) -> Result<()>,
) -> Result<()> {
    let layout = store.layout();
    match operation {
        Operation::Fill { brush, seed, region } => {
            let canvas = canvas(brush, *grid, layout, field);
            let fill = plan_fill(brush, *seed, canvas, resources(brush, field), *region, store)?;
            for batch in fill.split(layout, feed.max_batch) {
                act(batch, store)?;
            }
        }
        Operation::Stroke(stroke) => {
            let num_points = stroke.points.len();
            let part = match feed.split {
                Split::Whole => num_points,
                Split::TwoHalves => num_points.div_ceil(2),
                Split::SampleBySample => 1,
            };
            let brush = &stroke.brush;
            let canvas = canvas(brush, *grid, layout, field);
            let mut planner = StrokePlanner::new(brush, stroke.seed, canvas, resources(brush, field))?;
            let mut num_pushed = 0;
            for points in stroke.points.chunks(part.max(1)) {
                for point in points {
                    planner.push(point)?;
                }
                num_pushed += points.len();
                if num_pushed == num_points {
                    planner.finish();
                }
                while let Some(batch) = planner.next_batch(store, feed.max_batch)? {
                    act(batch, store)?;
                }
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use orogeny_brush::CpuExecutor;
    use orogeny_field::{BrushType, PointerSample};

    fn stroke() -> Operation {
        let points = [(10.0, 10.0), (40.0, 12.0), (60.0, 20.0), (60.0, 50.0), (40.0, 60.0), (20.0, 50.0)];
        let points = points.map(|(x, z)| PointerSample::at(x, z)).to_vec();
        Operation::Stroke(Stroke { brush: Brush::new(BrushType::Raise, 8.0, 5.0), seed: 1, points })
    }

    fn plan_of(feed: Feed) -> Vec<Batch> {
        let layout = PageLayout::new(64).unwrap();
        let grid = TerrainGrid::new(80, 80, 1.0).unwrap();
        let mut store = Plane::from_fn(80, 80, |_, _| 0.0).to_pages(layout, FIELD);
        plan(&stroke(), &grid, FIELD, &mut store, feed).unwrap()
    }

    #[test]
    fn a_feed_cuts_the_work_and_loses_none() {
        let whole = plan_of(Feed::WHOLE);
        assert_eq!(whole.len(), 1);
        for (split, max_batch, least) in
            [(Split::Whole, 7, 5), (Split::TwoHalves, usize::MAX, 2), (Split::SampleBySample, usize::MAX, 3)]
        {
            let batches = plan_of(Feed { split, max_batch });
            assert!(batches.len() >= least, "{split:?} {max_batch}: {}", batches.len());
            let instances: Vec<_> = batches.iter().flat_map(|batch| batch.instances.clone()).collect();
            assert_eq!(instances, whole[0].instances, "{split:?} {max_batch}");
        }
        assert_eq!(plan_of(Feed { split: Split::Whole, max_batch: 1 }).len(), whole[0].instances.len());
    }

    #[test]
    fn operations_act_one_after_another() {
        let layout = PageLayout::new(64).unwrap();
        let plane = Plane::from_fn(80, 80, |_, _| 7.0);
        let fill = |brush_type, strength| Operation::Fill {
            brush: Brush { height_m: Some(100.0), ..Brush::new(brush_type, 8.0, strength) },
            seed: 0,
            region: SampleRect::new(0, 0, 80, 40),
        };
        let operations = [fill(BrushType::SetHeight, 1.0), fill(BrushType::Raise, 3.0)];
        let mut cpu = CpuExecutor::new(layout, 1 << 24, Some(1)).unwrap();
        let painted = paint(&plane, 1.0, &operations, &mut cpu, layout, Feed::WHOLE).unwrap();
        assert_eq!(painted.notices.len(), 2);
        assert_eq!(painted.plane, Plane::from_fn(80, 80, |_, z| if z < 40 { 103.0 } else { 7.0 }));
    }
}
