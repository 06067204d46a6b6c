//! Less texture memory than the budget promises: work goes on with what there is.
//!
//! A child process takes the limit upon itself (`prlimit` on its address space, of which a software driver takes its textures),
//! so that nothing else suffers from it.

use std::collections::BTreeSet;
use std::process::Command;

use orogeny_brush::{Canvas, Executor, GpuBudget, GpuExecutor, Resources, plan_fill};
use orogeny_field::{Brush, BrushType, FieldId, Page, PageKey, PageLayout, SampleRect, TerrainGrid};
use orogeny_pages::{BoxError, PageStore};
use orogeny_tests::gpu;

const FIELD: FieldId = FieldId(2);
const CHILD: &str = "OROGENY_TEST_SHORT_OF_MEMORY";
/// Pages of 1 MiB: an array of 256 of them is a piece of memory that is either there or not.
const PAGE_SIZE: u32 = 512;
const ARRAY_IN_BYTES: u64 = 256 << 20;

/// Takes pages, looks at them, and keeps none.
struct Looked {
    layout: PageLayout,
    expected_m: f32,
    saved: BTreeSet<PageKey>,
}

impl PageStore for Looked {
    fn layout(&self) -> PageLayout {
        self.layout
    }

    fn constant(&self, _field: FieldId) -> f32 {
        100.0
    }

    fn load(&mut self, _key: &PageKey) -> Result<Option<Page>, BoxError> {
        Ok(None)
    }

    fn load_before(&mut self, _key: &PageKey) -> Result<Option<Page>, BoxError> {
        Ok(None)
    }

    fn save(&mut self, pages: Vec<(PageKey, Page)>) -> Result<(), BoxError> {
        for (key, page) in pages {
            assert!(page.samples().iter().all(|height| *height == self.expected_m), "{key:?}");
            assert!(self.saved.insert(key), "{key:?} was saved twice");
        }
        Ok(())
    }
}

fn fill(executor: &mut GpuExecutor, layout: PageLayout, strength: f64, region: SampleRect) -> usize {
    let grid = TerrainGrid::new(1 << 16, 1 << 16, 1.0).unwrap();
    let brush = Brush::new(BrushType::Raise, 1.0, strength);
    let expected_m = 100.0 + strength as f32;
    let mut store = Looked { layout, expected_m, saved: BTreeSet::new() };
    let canvas = Canvas::heights(grid, layout, FIELD);
    let plan = plan_fill(&brush, 0, canvas, Resources::default(), region, &mut store).unwrap();
    for batch in plan.split(layout, 64) {
        executor.run(&batch, &mut store).unwrap();
    }
    executor.finish(&mut store).unwrap();
    store.saved.len()
}

fn address_space_in_bytes() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmSize:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap() * 1024
}

/// Runs in the child: one array is there, a second fits under the limit, a third does not, though the budget has room for
/// sixteen.
fn paint_short_of_memory() {
    let layout = PageLayout::new(PAGE_SIZE).unwrap();
    let budget = GpuBudget { budget_in_bytes: 2 * 16 * ARRAY_IN_BYTES, layers_per_array: 256 };
    let mut executor = GpuExecutor::new(gpu(), layout, budget).unwrap();
    let side = PAGE_SIZE.cast_signed();
    assert_eq!(fill(&mut executor, layout, 2.0, SampleRect::new(0, 0, 64 * side, side)), 64);
    assert_eq!(executor.texture_size_in_bytes(), ARRAY_IN_BYTES);

    let limit = address_space_in_bytes() + ARRAY_IN_BYTES + ARRAY_IN_BYTES * 9 / 10;
    let limited = Command::new("prlimit")
        .args(["--pid", &std::process::id().to_string(), &format!("--as={limit}")])
        .status()
        .unwrap();
    assert!(limited.success());
    let region = SampleRect::new(0, 2 * side, 64 * side, 12 * side);
    assert_eq!(fill(&mut executor, layout, 3.0, region), 640, "every page once");
    assert_eq!(executor.texture_size_in_bytes(), 2 * ARRAY_IN_BYTES, "the limit was not met");
    assert_eq!(fill(&mut executor, layout, 4.0, SampleRect::new(0, 20 * side, 64 * side, 21 * side)), 64);
}

#[test]
fn the_budget_shrinks_to_the_memory_there_is() {
    if std::env::var_os(CHILD).is_some() {
        return paint_short_of_memory();
    }
    let name = "out_of_memory::the_budget_shrinks_to_the_memory_there_is";
    let child = Command::new(std::env::current_exe().unwrap())
        .args([name, "--exact", "--nocapture", "--test-threads=1"])
        .env(CHILD, "1")
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&child.stdout).into_owned() + &String::from_utf8_lossy(&child.stderr);
    assert!(child.status.success() && said.contains("1 passed"), "{:?}\n{said}", child.status);
}
