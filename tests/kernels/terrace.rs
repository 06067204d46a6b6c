//! Terrace.

use orogeny_brush::CpuExecutor;
use orogeny_field::{Blending, Brush, BrushType, PageLayout, SampleRect, Terrace};
use orogeny_tests::{Feed, Operation, Plane, paint};

use crate::agreement::back_ends_agree;

fn brushes() -> Vec<(&'static str, Brush)> {
    let steps = |step_m, sharpness| Brush {
        terrace: Terrace { step_m, sharpness, ..Terrace::default() },
        ..Brush::new(BrushType::Terrace, 1.0, 1.0)
    };
    let tilted = Terrace { step_m: 7.0, sharpness: 0.5, tilt_deg: 10.0, tilt_direction_deg: 130.0 };
    vec![
        ("terrace", steps(25.0, 0.7)),
        ("terrace, sharp", steps(40.0, 0.95)),
        ("terrace, tilted", Brush { terrace: tilted, ..steps(1.0, 0.0) }),
        ("terrace, build-up", Brush { blending: Blending::BuildUp, ..steps(60.0, 0.3) }),
    ]
}

back_ends_agree!(brushes);

fn filled(terrace: Terrace, ground: &Plane) -> Plane {
    let layout = PageLayout::new(64).unwrap();
    let brush = Brush { terrace, ..Brush::new(BrushType::Terrace, 1.0, 1.0) };
    let fill = Operation::Fill { brush, seed: 0, region: SampleRect::new(0, 0, 1000, 1000) };
    let mut cpu = CpuExecutor::new(layout, 1 << 24, Some(1)).unwrap();
    paint(ground, 1.0, &[fill], &mut cpu, layout, Feed::WHOLE).unwrap().plane
}

#[test]
fn steps_follow_the_closed_form() {
    let slope = Plane::from_fn(100, 8, |x, _| x as f32 * 0.37 - 11.0);
    for sharpness in [0.0, 0.5, 1.0] {
        let found = filled(Terrace { step_m: 5.0, sharpness, ..Terrace::default() }, &slope);
        for x in 0..100 {
            let height = f64::from(slope.at(x, 3));
            let number = (height / 5.0).floor();
            let within = ((height / 5.0 - number - 0.5) / (1.0 - 0.99 * sharpness) + 0.5).clamp(0.0, 1.0);
            let expected = 5.0 * (number + within);
            assert!((f64::from(found.at(x, 3)) - expected).abs() < 1.0e-3, "{sharpness} at {x}: {expected}");
        }
    }
}

#[test]
fn tilted_steps_fall_in_their_direction() {
    // A plane that falls to the east by as much as the steps do is none of their edges' business.
    let terrace = Terrace { step_m: 5.0, sharpness: 1.0, tilt_deg: 20.0, tilt_direction_deg: 0.0 };
    let falling = Plane::from_fn(100, 8, |x, _| 7.5 - x as f32 * 20.0_f32.to_radians().tan());
    let found = filled(terrace, &falling);
    for x in 0..100 {
        assert!(
            (found.at(x, 2) - falling.at(x, 2)).abs() < 0.01,
            "{x}: {} {}",
            found.at(x, 2),
            falling.at(x, 2)
        );
    }
}
