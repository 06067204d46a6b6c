//! Heights that would leave what a terrain holds are clamped, and counted.

use orogeny_field::{Brush, BrushType, MAX_HEIGHT_M, PageLayout, SampleRect};
use orogeny_tests::{Feed, Operation, Plane, gpu, paint};

use crate::executors;

#[test]
fn heights_at_the_limit_are_clamped_and_counted() {
    let layout = PageLayout::new(64).unwrap();
    let gpu = gpu();
    // 10 columns at each limit; the rest have room.
    let plane = Plane::from_fn(100, 90, |x, _| match x {
        0..10 => MAX_HEIGHT_M - 1.0,
        10..20 => -MAX_HEIGHT_M,
        _ => 0.0,
    });
    let fill = |brush_type| Operation::Fill {
        brush: Brush::new(brush_type, 1.0, 5.0),
        seed: 0,
        region: SampleRect::new(5, 0, 50, 90),
    };
    for mut executor in executors(&gpu, layout, 8) {
        let mut run = |brush_type| {
            paint(&plane, 1.0, &[fill(brush_type)], &mut *executor, layout, Feed::WHOLE).unwrap()
        };
        let raised = run(BrushType::Raise);
        assert_eq!(raised.notices[0].num_clamped_heights, 5 * 90);
        assert_eq!(raised.plane.at(4, 0), MAX_HEIGHT_M - 1.0, "outside the region");
        assert_eq!(raised.plane.at(5, 0), MAX_HEIGHT_M);
        assert_eq!(raised.plane.at(10, 0), -MAX_HEIGHT_M + 5.0);
        assert_eq!(raised.plane.at(20, 0), 5.0);
        let lowered = run(BrushType::Lower);
        assert_eq!(lowered.notices[0].num_clamped_heights, 10 * 90);
        assert_eq!(lowered.plane.at(10, 0), -MAX_HEIGHT_M);
        // The count starts anew with each operation.
        let roughened = run(BrushType::Roughen);
        let count = roughened.notices[0].num_clamped_heights;
        assert!(count > 0 && count < 15 * 90, "{count}");
    }
}
