//! A brush costs what it touches.

use std::collections::BTreeSet;

use orogeny_brush::{CpuExecutor, GpuBudget, GpuExecutor};
use orogeny_field::{Blending, Brush, BrushType, FieldId, PageKey, PageLayout, Smoothing, TerrainGrid};
use orogeny_pages::MemoryPages;
use orogeny_tests::{Feed, WatchedPages, apply, gpu};

use crate::{executors, ledge, raise, stroke, wash};

const FIELD: FieldId = FieldId(4);

#[test]
fn a_stroke_over_three_pages_of_a_hundred_thousand_loads_only_these() {
    let layout = PageLayout::default();
    // 317 x 317 pages of 256 x 256 samples.
    let grid = TerrainGrid::new(81_152, 81_152, 1.0).unwrap();
    assert!(layout.num_pages_in(grid.bounds()) >= 100_000);
    let touched: BTreeSet<_> =
        [(200, 100), (201, 100), (202, 100)].map(|(x, z)| PageKey::full_resolution(FIELD, x, z)).into();
    let [start, end] = [200.5, 202.5].map(|page| [page * 256.0, 100.5 * 256.0]);

    let gpu = gpu();
    for brush in [raise(), wash(), ledge()] {
        for mut executor in executors(&gpu, layout, 32) {
            let mut store = WatchedPages::new(MemoryPages::new(layout, 100.0));
            let operation = stroke(brush.clone(), &[start, end]);
            apply(&operation, &grid, FIELD, &mut *executor, &mut store, Feed::WHOLE).unwrap();
            let what = format!("{:?} on {}", brush.brush_type, executor.description());
            assert_eq!(store.loaded(), &touched, "{what}");
            assert_eq!(store.saved(), &touched, "{what}");
            assert_eq!(store.pages().pages_unsorted().keys().copied().collect::<BTreeSet<_>>(), touched);
            assert!(store.num_calls() < 40, "{what}: {} calls", store.num_calls());
            if brush == raise() {
                assert_eq!(store.pages().num_loads(), 3, "{what}: each page once");
            }
        }
    }
}

/// A brush that looks at neighbours also reads the pages that they lie on, and those alone.
#[test]
fn smoothing_loads_the_pages_within_its_width_and_changes_only_those_it_touches() {
    let layout = PageLayout::default();
    let grid = TerrainGrid::new(81_152, 81_152, 1.0).unwrap();
    let key = |x, z| PageKey::full_resolution(FIELD, x, z);
    let start = [200.5 * 256.0, 100.03 * 256.0];
    let touched: BTreeSet<_> = [key(200, 100), key(200, 99)].into();
    let gpu = gpu();
    for (width_m, looked_at) in [(2.0, [200..=200, 99..=100]), (60.0, [199..=201, 98..=101])] {
        for blending in [Blending::BuildUp, Blending::Wash] {
            let smoothing = Smoothing { width_m: Some(width_m), ..Smoothing::default() };
            let brush = Brush { smoothing, blending, ..Brush::new(BrushType::Smooth, 40.0, 0.5) };
            for mut executor in executors(&gpu, layout, 32) {
                let mut store = WatchedPages::new(MemoryPages::new(layout, 100.0));
                let operation = stroke(brush.clone(), &[start]);
                apply(&operation, &grid, FIELD, &mut *executor, &mut store, Feed::WHOLE).unwrap();
                let what = format!("{width_m} m, {blending:?}, on {}", executor.description());
                let [columns, rows] = looked_at.clone();
                let allowed: BTreeSet<_> =
                    rows.flat_map(|z| columns.clone().map(move |x| key(x, z))).collect();
                assert!(store.loaded().is_subset(&allowed), "{what}: {:?}", store.loaded());
                assert!(store.loaded().is_superset(&touched), "{what}: {:?}", store.loaded());
                assert_eq!(store.saved(), &touched, "{what}");
            }
        }
    }
}

#[test]
fn a_second_stroke_on_resident_pages_loads_nothing() {
    let layout = PageLayout::new(64).unwrap();
    let grid = TerrainGrid::new(200, 150, 1.0).unwrap();
    let gpu = gpu();
    for mut executor in executors(&gpu, layout, 64) {
        let mut store = WatchedPages::new(MemoryPages::new(layout, 0.0));
        let operation = stroke(raise(), &crate::LOOP);
        apply(&operation, &grid, FIELD, &mut *executor, &mut store, Feed::WHOLE).unwrap();
        let num_loads = store.pages().num_loads();
        assert_eq!(num_loads, store.saved().len() as u64);
        apply(&operation, &grid, FIELD, &mut *executor, &mut store, Feed::WHOLE).unwrap();
        assert_eq!(store.pages().num_loads(), num_loads, "{}", executor.description());
        // What was changed elsewhere is loaded again, and only that.
        let changed = *store.saved().first().unwrap();
        executor.forget(&[changed]);
        apply(&operation, &grid, FIELD, &mut *executor, &mut store, Feed::WHOLE).unwrap();
        assert_eq!(store.pages().num_loads(), num_loads + 1, "{}", executor.description());
    }
}

#[test]
fn textures_keep_within_their_budget() {
    let layout = PageLayout::new(64).unwrap();
    let grid = TerrainGrid::new(200, 150, 1.0).unwrap();
    let gpu = gpu();
    for num_pages in [4, 5, 7, 10] {
        let budget_in_bytes = num_pages * layout.size_in_bytes();
        let budget = GpuBudget { budget_in_bytes, layers_per_array: 2 };
        let mut executor = GpuExecutor::new(gpu.clone(), layout, budget).unwrap();
        for brush in [raise(), wash()] {
            let mut store = MemoryPages::new(layout, 0.0);
            let operation = stroke(brush, &crate::LOOP);
            apply(&operation, &grid, FIELD, &mut executor, &mut store, Feed::WHOLE).unwrap();
        }
        let used = executor.texture_size_in_bytes();
        assert!(used > 0 && used <= budget_in_bytes, "{used} of {budget_in_bytes} bytes");
    }
}

#[test]
fn budgets_too_small_are_refused_and_absurd_ones_are_no_harm() {
    let layout = PageLayout::new(64).unwrap();
    let gpu = gpu();
    let make = |budget_in_bytes, layers_per_array| {
        GpuExecutor::new(gpu.clone(), layout, GpuBudget { budget_in_bytes, layers_per_array })
    };
    for budget_in_bytes in [0, 1, 4 * layout.size_in_bytes() - 1] {
        let refused = make(budget_in_bytes, 8).unwrap_err();
        let expected = budget_in_bytes / layout.size_in_bytes();
        assert!(
            matches!(
                refused,
                orogeny_brush::Error::Pages(orogeny_pages::Error::Budget { num_pages, needed: 4, .. })
                    if num_pages == expected
            ),
            "{refused}"
        );
    }
    let grid = TerrainGrid::new(200, 150, 1.0).unwrap();
    let operation = stroke(Brush { falloff_m: 3.0, ..raise() }, &crate::LOOP);
    for layers_per_array in [0, u32::MAX] {
        let mut executor = make(u64::MAX, layers_per_array).unwrap();
        let mut store = MemoryPages::new(layout, 0.0);
        apply(&operation, &grid, FIELD, &mut executor, &mut store, Feed::WHOLE).unwrap();
    }
    for budget_in_bytes in [0, u64::MAX] {
        let mut executor = CpuExecutor::new(layout, budget_in_bytes, Some(1)).unwrap();
        let mut store = MemoryPages::new(layout, 0.0);
        apply(&operation, &grid, FIELD, &mut executor, &mut store, Feed::WHOLE).unwrap();
    }
}
