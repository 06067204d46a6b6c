//! A device that does not answer in time: the work is refused, the client is told, and a new device goes on.

use std::time::Duration;

use orogeny_brush::{GpuBudget, GpuExecutor};
use orogeny_field::{Brush, BrushType, FieldId, PageLayout, TerrainGrid};
use orogeny_pages::MemoryPages;
use orogeny_tests::{Feed, apply, gpu};

use crate::stroke;

const FIELD: FieldId = FieldId(1);

/// A time that no device keeps stands for a driver that hangs: work goes on behind it, unseen.
#[test]
fn a_device_that_hangs_is_seen_and_a_new_one_does_the_work() {
    let layout = PageLayout::default();
    let grid = TerrainGrid::new(2048, 2048, 1.0).unwrap();
    let budget = GpuBudget { budget_in_bytes: 1 << 30, layers_per_array: 256 };
    let long = stroke(Brush::new(BrushType::Raise, 400.0, 9.0), &[[300.0, 300.0], [1700.0, 1700.0]]);

    let hung = gpu().with_timeout(Duration::from_micros(1));
    let mut executor = GpuExecutor::new(hung, layout, budget).unwrap();
    let mut store = MemoryPages::new(layout, 5.0);
    let err = apply(&long, &grid, FIELD, &mut executor, &mut store, Feed::WHOLE).unwrap_err();
    assert!(matches!(err.gpu(), Some(orogeny_gpu::Error::Timeout { .. })), "{err}");
    assert!(!err.is_device_lost());
    assert!(store.pages_unsorted().is_empty(), "nothing of it was saved");
    drop(executor);

    let mut executor = GpuExecutor::new(gpu(), layout, budget).unwrap();
    apply(&long, &grid, FIELD, &mut executor, &mut store, Feed::WHOLE).unwrap();
    assert!(!store.pages_unsorted().is_empty());
}
