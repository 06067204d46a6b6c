//! Paint and erase masks.

use orogeny_brush::CpuExecutor;
use orogeny_field::{Blending, Brush, BrushType, PageLayout, PointerSample, ProfileShape, Stroke};
use orogeny_tests::{Feed, Operation, Plane, paint};

use crate::agreement::back_ends_agree;

fn brushes() -> Vec<(&'static str, Brush)> {
    let paint_mask = Brush { mask_value: 0.8, ..Brush::new(BrushType::PaintMask, 1.0, 1.0) };
    let erase = Brush::new(BrushType::EraseMask, 1.0, 1.0);
    vec![
        ("paint mask", paint_mask.clone()),
        ("paint mask, build-up", Brush { blending: Blending::BuildUp, ..paint_mask }),
        ("erase mask", erase.clone()),
        ("erase mask, flow", Brush { flow: 0.3, ..erase }),
    ]
}

back_ends_agree!(brushes);

#[test]
fn a_mask_goes_to_its_value_and_back_to_0_and_stays_within_0_to_1() {
    let layout = PageLayout::new(64).unwrap();
    let stroke = |brush_type, mask_value| {
        let brush = Brush { mask_value, shape: ProfileShape::Linear, ..Brush::new(brush_type, 10.0, 1.0) };
        Operation::Stroke(Stroke { brush, seed: 0, points: vec![PointerSample::at(30.0, 30.0)] })
    };
    let mut cpu = CpuExecutor::new(layout, 1 << 24, Some(1)).unwrap();
    let mut run = |operations: &[Operation], ground: f32| {
        let plane = Plane::from_fn(64, 64, |_, _| ground);
        paint(&plane, 1.0, operations, &mut cpu, layout, Feed::WHOLE).unwrap().plane
    };
    let painted = run(&[stroke(BrushType::PaintMask, 0.75)], 0.0);
    assert_eq!((painted.at(30, 30), painted.at(35, 30), painted.at(41, 30)), (0.75, 0.375, 0.0));
    let erased = run(&[stroke(BrushType::EraseMask, 0.0)], 1.0);
    assert_eq!((erased.at(30, 30), erased.at(35, 30), erased.at(41, 30)), (0.0, 0.5, 1.0));
    // What lies outside by accident comes back.
    let clamped = run(&[stroke(BrushType::PaintMask, 1.0)], 7.0);
    assert_eq!((clamped.at(30, 30), clamped.at(35, 30)), (1.0, 1.0));
}
