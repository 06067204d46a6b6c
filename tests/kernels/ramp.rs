//! Ramp.

use orogeny_brush::CpuExecutor;
use orogeny_field::{
    Brush, BrushType, LevelOnly, PageLayout, PointerSample, ProfileShape, RampAlong, Stroke, Symmetry,
    SymmetryKind,
};
use orogeny_tests::{Feed, Operation, Plane, paint};

use crate::agreement::back_ends_agree;

fn brushes() -> Vec<(&'static str, Brush)> {
    let ramp = Brush::new(BrushType::Ramp, 1.0, 1.0);
    let point = Symmetry { kind: SymmetryKind::Point, centre_m: [90.0, 70.0] };
    vec![
        ("ramp", ramp.clone()),
        ("ramp, smooth, cut", Brush { along: RampAlong::Smooth, only: LevelOnly::Cut, ..ramp.clone() }),
        (
            "ramp, fill, given heights, mirrored",
            Brush {
                only: LevelOnly::Fill,
                height_m: Some(100.0),
                end_height_m: Some(900.0),
                symmetry: Some(point),
                ..ramp
            },
        ),
    ]
}

back_ends_agree!(brushes);

/// Heights along a road through flat ground at 50 m.
fn road(brush: &Brush) -> Plane {
    let layout = PageLayout::new(64).unwrap();
    let points =
        [PointerSample::at(20.0, 40.0), PointerSample::at(50.0, 77.0), PointerSample::at(120.0, 40.0)]
            .to_vec();
    let stroke = Operation::Stroke(Stroke { brush: brush.clone(), seed: 0, points });
    let mut cpu = CpuExecutor::new(layout, 1 << 24, Some(1)).unwrap();
    paint(&Plane::from_fn(140, 80, |_, _| 50.0), 1.0, &[stroke], &mut cpu, layout, Feed::WHOLE).unwrap().plane
}

#[test]
fn a_ramp_is_a_straight_slope_from_the_first_point_to_the_last() {
    let ramp = Brush {
        height_m: Some(10.0),
        end_height_m: Some(110.0),
        shape: ProfileShape::Linear,
        ..Brush::new(BrushType::Ramp, 10.0, 1.0)
    };
    let even = road(&ramp);
    for (x, expected) in [(20, 10.0), (45, 35.0), (70, 60.0), (120, 110.0)] {
        assert!((even.at(x, 40) - expected).abs() < 1.0e-3, "{x}: {}", even.at(x, 40));
    }
    // Halfway across the falloff, halfway to the slope.
    assert!((even.at(70, 45) - 55.0).abs() < 1.0e-3, "{}", even.at(70, 45));
    assert_eq!(even.at(70, 51), 50.0);
    let smooth = road(&Brush { along: RampAlong::Smooth, ..ramp.clone() });
    assert!((smooth.at(45, 40) - (10.0 + 100.0 * 0.15625)).abs() < 1.0e-3, "{}", smooth.at(45, 40));
    let cut = road(&Brush { only: LevelOnly::Cut, ..ramp });
    assert!((cut.at(45, 40) - 35.0).abs() < 1.0e-3 && cut.at(90, 40) == 50.0);
}
