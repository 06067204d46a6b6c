//! A page store that fails at any one call: an error, and after cancelling the executor is as good as new.

use orogeny_brush::{Error, Executor};
use orogeny_field::{Brush, FieldId, PageLayout, TerrainGrid};
use orogeny_tests::{Feed, Operation, Plane, WatchedPages, apply, compare, gpu, terrain};

use crate::{LOOP, cpu_executor, gpu_executor, ledge, raise, stroke, wash};

const FIELD: FieldId = FieldId(6);

fn layout() -> PageLayout {
    PageLayout::new(64).unwrap()
}

fn grid() -> TerrainGrid {
    TerrainGrid::new(200, 150, 1.0).unwrap()
}

const FEED: Feed = Feed { max_batch: 20, ..Feed::WHOLE };

fn run(operation: &Operation, executor: &mut dyn Executor, store: &mut WatchedPages) -> Result<(), Error> {
    apply(operation, &grid(), FIELD, executor, store, FEED).map(|_| ())
}

fn read(store: &WatchedPages) -> Plane {
    Plane::from_pages(200, 150, store.pages(), layout(), FIELD)
}

/// One executor throughout: what one failure leaves behind would be seen in the next run. Each operation finds pages that are
/// resident from the one before.
fn assert_every_failure_is_survived(executor: &mut dyn Executor, brush: Brush) {
    let pages = terrain::random(200, 150, 8).to_pages(layout(), FIELD);
    let operation = stroke(brush, &LOOP);
    let first = stroke(raise(), &LOOP[3..6]);

    // The pages after the first operation, which was made durable.
    let prepared = |executor: &mut dyn Executor| {
        executor.forget(&terrain::random(200, 150, 8).keys(layout(), FIELD));
        let mut store = WatchedPages::new(pages.clone());
        run(&first, executor, &mut store).unwrap();
        let mut after = store.pages().clone();
        after.commit();
        after
    };
    let healthy = prepared(executor);
    let mut undisturbed = WatchedPages::new(healthy.clone());
    run(&operation, executor, &mut undisturbed).unwrap();
    let (num_calls, expected) = (undisturbed.num_calls(), read(&undisturbed));
    assert!(num_calls >= 3, "{num_calls}");

    let mut num_failures = 0;
    for call in 0..num_calls {
        let durable = prepared(executor);
        let mut failing = WatchedPages::new(durable.clone()).failing_at(call);
        match run(&operation, executor, &mut failing) {
            // How many copies arrive together is the GPU's affair, and with it how often pages are saved.
            Ok(()) => assert!(failing.num_calls() <= call, "the failure of call {call} was lost"),
            Err(err) => {
                assert!(matches!(err, Error::Pages(orogeny_pages::Error::Source(_))), "{err}");
                assert!(err.to_string().contains("was made to fail"), "{err}");
                num_failures += 1;
            }
        }
        executor.cancel();

        // The store drops what the cancelled operation had saved; the executor has to have dropped it too.
        let mut store = WatchedPages::new(durable);
        run(&operation, executor, &mut store).unwrap();
        compare::bit_equal(&expected, &read(&store))
            .unwrap_or_else(|mismatch| panic!("after call {call} of {num_calls} had failed: {mismatch}"));
    }
    assert!(num_failures * 2 > num_calls, "{num_failures} of {num_calls}");
}

#[test]
fn on_the_cpu() {
    for num_pages in [4, 1000] {
        for brush in [raise(), wash(), ledge()] {
            assert_every_failure_is_survived(&mut cpu_executor(layout(), num_pages, 2), brush);
        }
    }
}

#[test]
fn on_the_gpu() {
    let gpu = gpu();
    for num_pages in [4, 1000] {
        for brush in [raise(), wash()] {
            assert_every_failure_is_survived(&mut gpu_executor(&gpu, layout(), num_pages), brush);
            gpu.check().unwrap();
        }
    }
}

#[test]
fn a_finished_operation_that_could_not_be_made_durable_is_dropped_too() {
    let gpu = gpu();
    for mut executor in crate::executors(&gpu, layout(), 1000) {
        let before = terrain::random(200, 150, 8);
        let operation = stroke(raise(), &LOOP);
        let mut first = WatchedPages::new(before.to_pages(layout(), FIELD));
        run(&operation, &mut *executor, &mut first).unwrap();
        executor.cancel();
        let mut second = WatchedPages::new(before.to_pages(layout(), FIELD));
        run(&operation, &mut *executor, &mut second).unwrap();
        compare::bit_equal(&read(&first), &read(&second)).unwrap_or_else(|mismatch| panic!("{mismatch}"));
    }
}

#[test]
fn an_operation_cancelled_in_its_middle_leaves_nothing() {
    let gpu = gpu();
    for num_pages in [4, 1000] {
        for mut executor in crate::executors(&gpu, layout(), num_pages) {
            for brush in [raise(), wash()] {
                let before = terrain::random(200, 150, 8);
                executor.forget(&before.keys(layout(), FIELD));
                let operation = stroke(brush, &LOOP);
                let mut whole = WatchedPages::new(before.to_pages(layout(), FIELD));
                run(&operation, &mut *executor, &mut whole).unwrap();
                executor.forget(&before.keys(layout(), FIELD));

                let mut store = before.to_pages(layout(), FIELD);
                let batches = orogeny_tests::plan(&operation, &grid(), FIELD, &mut store, FEED).unwrap();
                for batch in &batches[..batches.len() / 2] {
                    executor.run(batch, &mut store).unwrap();
                }
                executor.cancel();
                let mut after = WatchedPages::new(before.to_pages(layout(), FIELD));
                run(&operation, &mut *executor, &mut after).unwrap();
                compare::bit_equal(&read(&whole), &read(&after))
                    .unwrap_or_else(|mismatch| panic!("{}: {mismatch}", executor.description()));
            }
        }
    }
}
