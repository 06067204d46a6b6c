//! A device that is lost in the middle of a stroke: the stroke is never acknowledged, and on a new device it gives the bits
//! that it would have given.

use orogeny_brush::{Batch, Executor};
use orogeny_field::{Brush, FieldId, PageLayout, TerrainGrid};
use orogeny_tests::{Feed, Plane, apply, compare, gpu, plan, terrain};

use crate::{LOOP, gpu_executor, raise, stroke, wash};

const FIELD: FieldId = FieldId(2);
const MAX_BATCH: usize = 12;

fn layout() -> PageLayout {
    PageLayout::new(64).unwrap()
}

fn ground() -> Plane {
    terrain::random(200, 150, 8)
}

fn read(store: &orogeny_pages::MemoryPages) -> Plane {
    Plane::from_pages(200, 150, store, layout(), FIELD)
}

/// The stroke's batches, then its end, with the device destroyed before the step with this number; whether a step failed.
fn run_and_lose(
    executor: &mut orogeny_brush::GpuExecutor,
    batches: &[Batch],
    store: &mut orogeny_pages::MemoryPages,
    lost_before: usize,
) -> Result<(), orogeny_brush::Error> {
    for (step, batch) in batches.iter().enumerate() {
        if step == lost_before {
            executor.gpu().device().destroy();
        }
        executor.run(batch, store)?;
    }
    if lost_before == batches.len() {
        executor.gpu().device().destroy();
    }
    executor.finish(store).map(|_| ())
}

fn assert_survives(brush: Brush, num_pages: u64) {
    let grid = TerrainGrid::new(200, 150, 1.0).unwrap();
    let operation = stroke(brush, &LOOP);
    let feed = Feed { max_batch: MAX_BATCH, ..Feed::WHOLE };
    let batches = plan(&operation, &grid, FIELD, &mut ground().to_pages(layout(), FIELD), feed).unwrap();
    assert!(batches.len() >= 3, "{}", batches.len());

    let undisturbed = {
        let mut store = ground().to_pages(layout(), FIELD);
        let mut executor = gpu_executor(&gpu(), layout(), num_pages);
        apply(&operation, &grid, FIELD, &mut executor, &mut store, feed).unwrap();
        read(&store)
    };
    for lost_before in 0..=batches.len() {
        let mut store = ground().to_pages(layout(), FIELD);
        let mut executor = gpu_executor(&gpu(), layout(), num_pages);
        let lost = run_and_lose(&mut executor, &batches, &mut store, lost_before);
        let err = lost.expect_err("a stroke on a lost device was acknowledged");
        assert!(err.is_device_lost(), "lost before step {lost_before}: {err}");
        // Whatever is asked of it later, a lost device stays lost.
        executor.cancel();
        let again =
            executor.run(&batches[0], &mut store).and_then(|()| executor.finish(&mut store).map(|_| ()));
        assert!(again.expect_err("work on a lost device was acknowledged").is_device_lost());
        drop(executor);

        // What was saved before the loss belongs to a stroke that is undone.
        let mut store = ground().to_pages(layout(), FIELD);
        let mut executor = gpu_executor(&gpu(), layout(), num_pages);
        apply(&operation, &grid, FIELD, &mut executor, &mut store, feed).unwrap();
        compare::bit_equal(&undisturbed, &read(&store)).unwrap_or_else(|mismatch| panic!("{mismatch}"));
    }
}

#[test]
fn while_all_pages_are_resident() {
    assert_survives(raise(), 64);
}

#[test]
fn while_pages_make_room_for_each_other() {
    assert_survives(raise(), 4);
}

#[test]
fn in_a_wash_with_evicted_weights() {
    assert_survives(wash(), 4);
}

#[test]
fn before_the_first_stroke_and_between_strokes() {
    let grid = TerrainGrid::new(200, 150, 1.0).unwrap();
    let operation = stroke(raise(), &LOOP);
    for num_before in [0, 1] {
        let gpu = gpu();
        let mut executor = gpu_executor(&gpu, layout(), 64);
        let mut store = ground().to_pages(layout(), FIELD);
        for _ in 0..num_before {
            apply(&operation, &grid, FIELD, &mut executor, &mut store, Feed::WHOLE).unwrap();
        }
        gpu.device().destroy();
        let err = apply(&operation, &grid, FIELD, &mut executor, &mut store, Feed::WHOLE).unwrap_err();
        assert!(err.is_device_lost(), "{err}");
    }
}
