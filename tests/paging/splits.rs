//! On one back end no split over batches, pages, budgets, threads or the arrival of samples changes a bit.

use orogeny_brush::Executor;
use orogeny_field::{Brush, BrushType, PageLayout, SampleRect};
use orogeny_gpu::Gpu;
use orogeny_tests::{Feed, Operation, Plane, Split, compare, gpu, paint, terrain};

use crate::{LOOP, build_up, cpu_executor, gpu_executor, ledge, raise, roughen, stroke, wash};

const SPACING_M: f64 = 1.0;

/// One after another on one terrain, so that each finds what the last one left.
fn operations() -> Vec<Operation> {
    let fill = Brush { height_m: Some(250.0), ..Brush::new(BrushType::SetHeight, 1.0, 0.25) };
    vec![
        stroke(raise(), &LOOP),
        stroke(wash(), &LOOP),
        stroke(ledge(), &LOOP[2..]),
        stroke(build_up(), &LOOP[..5]),
        Operation::Fill { brush: fill, seed: 0, region: SampleRect::new(30, 10, 300, 90) },
        stroke(roughen(), &LOOP),
        // Back over the first pages after all the others: their weights have been evicted, and come back.
        stroke(wash(), &[LOOP.as_slice(), LOOP.as_slice()].concat()),
    ]
}

fn ground() -> Plane {
    terrain::random(200, 150, 5)
}

fn painted(executor: &mut dyn Executor, layout: PageLayout, feed: Feed) -> Plane {
    paint(&ground(), SPACING_M, &operations(), executor, layout, feed).unwrap().plane
}

fn layout(size: u32) -> PageLayout {
    PageLayout::new(size).unwrap()
}

/// Every way to feed; the first is the plainest.
fn feeds() -> Vec<Feed> {
    let mut feeds = Vec::new();
    for split in [Split::Whole, Split::TwoHalves, Split::SampleBySample] {
        for max_batch in [usize::MAX, 7, 1] {
            feeds.push(Feed { split, max_batch });
        }
    }
    assert_eq!(feeds[0], Feed::WHOLE);
    feeds
}

fn assert_equal(expected: &Plane, found: &Plane, what: &str) {
    compare::bit_equal(expected, found).unwrap_or_else(|mismatch| panic!("{what}: {mismatch}"));
}

/// `make` gives an executor for a page size and a budget in pages.
fn assert_no_split_matters(make: impl Fn(PageLayout, u64) -> Box<dyn Executor>, feeds: &[Feed]) {
    let mut num_runs = 0;
    let expected = painted(&mut *make(layout(256), 1000), layout(256), Feed::WHOLE);
    assert!(compare::bit_equal(&ground(), &expected).is_err(), "nothing was painted");
    for (size, budget) in [(64, 4), (64, 1000), (256, 4), (256, 1000), (1024, 1000)] {
        // One executor for all feeds: what stays resident does not matter either.
        let mut executor = make(layout(size), if size == 1024 { 4 } else { budget });
        for feed in feeds {
            let found = painted(&mut *executor, layout(size), *feed);
            assert_equal(&expected, &found, &format!("pages of {size}, a budget of {budget}, {feed:?}"));
            num_runs += 1;
        }
        let again = painted(&mut *executor, layout(size), feeds[0]);
        assert_equal(&expected, &again, "the same once more");
    }
    assert_eq!(num_runs, 5 * feeds.len());
}

#[test]
fn on_the_cpu_with_one_thread() {
    assert_no_split_matters(|layout, pages| Box::new(cpu_executor(layout, pages, 1)), &feeds());
}

#[test]
fn on_the_cpu_with_two_threads_and_the_same_as_with_one() {
    assert_no_split_matters(|layout, pages| Box::new(cpu_executor(layout, pages, 2)), &feeds()[..3]);
    let [one, two] =
        [1, 2].map(|threads| painted(&mut cpu_executor(layout(64), 1000, threads), layout(64), Feed::WHOLE));
    assert_equal(&one, &two, "one thread and two");
}

#[test]
fn on_the_gpu() {
    let gpu: Gpu = gpu();
    assert_no_split_matters(|layout, pages| Box::new(gpu_executor(&gpu, layout, pages)), &feeds());
    gpu.check().unwrap();
}

#[test]
fn two_devices_give_the_same_bits() {
    let [one, two] =
        [gpu(), gpu()].map(|gpu| painted(&mut gpu_executor(&gpu, layout(64), 8), layout(64), Feed::WHOLE));
    assert_equal(&one, &two, "two devices");
}
