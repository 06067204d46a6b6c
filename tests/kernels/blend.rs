//! Smooth, sharpen, smear: what looks at neighbours.

use orogeny_brush::{CpuExecutor, Executor};
use orogeny_field::{
    Blending, Brush, BrushType, PageLayout, PointerSample, SampleRect, SmoothMethod, Smoothing, Stroke,
    mirrored,
};
use orogeny_tests::{Feed, Operation, Plane, paint, terrain};

use crate::agreement::back_ends_agree;

fn smooth(method: SmoothMethod, blending: Blending) -> Brush {
    let smoothing = Smoothing { method, ..Smoothing::default() };
    Brush { smoothing, blending, ..Brush::new(BrushType::Smooth, 1.0, 0.5) }
}

fn brushes() -> Vec<(&'static str, Brush)> {
    let sharpen = |gain| Brush {
        smoothing: Smoothing { gain, ..Smoothing::default() },
        ..Brush::new(BrushType::Sharpen, 1.0, 0.5)
    };
    vec![
        ("smooth", smooth(SmoothMethod::Gaussian, Blending::BuildUp)),
        ("smooth, wash", smooth(SmoothMethod::Gaussian, Blending::Wash)),
        ("smooth, lattice", smooth(SmoothMethod::Lattice, Blending::BuildUp)),
        ("sharpen", sharpen(1.0)),
        ("sharpen, wash", Brush { blending: Blending::Wash, ..sharpen(0.5) }),
        ("smear", Brush::new(BrushType::Smear, 1.0, 0.5)),
    ]
}

back_ends_agree!(brushes);

fn cpu(layout: PageLayout) -> CpuExecutor {
    CpuExecutor::new(layout, 1 << 24, Some(2)).unwrap()
}

fn painted(ground: &Plane, operation: Operation) -> Plane {
    let layout = PageLayout::new(64).unwrap();
    paint(ground, 1.0, &[operation], &mut cpu(layout) as &mut dyn Executor, layout, Feed::WHOLE)
        .unwrap()
        .plane
}

fn filled(ground: &Plane, brush: Brush) -> Plane {
    painted(ground, Operation::Fill { brush, seed: 0, region: SampleRect::new(0, 0, 10_000, 10_000) })
}

fn with_width(brush: Brush, width_m: f64) -> Brush {
    Brush { smoothing: Smoothing { width_m: Some(width_m), ..brush.smoothing }, strength: 1.0, ..brush }
}

fn stroke(brush: Brush, points: &[[f64; 2]]) -> Operation {
    let points = points.iter().map(|[x, z]| PointerSample::at(*x, *z)).collect();
    Operation::Stroke(Stroke { brush, seed: 0, points })
}

#[test]
fn smoothing_keeps_a_plane_a_plane_away_from_the_border() {
    let ground = Plane::from_fn(220, 190, |x, z| 300.0 + 1.5 * x as f32 - 0.75 * z as f32);
    let range = 1.5 * 219.0 + 0.75 * 189.0;
    for method in [SmoothMethod::Gaussian, SmoothMethod::Lattice] {
        for width in [1.0, 4.0, 9.0, 15.0] {
            let smoothed = filled(&ground, with_width(smooth(method, Blending::BuildUp), width));
            let support = 75;
            for z in support..190 - support {
                for x in support..220 - support {
                    let change = (smoothed.at(x, z) - ground.at(x, z)).abs();
                    assert!(change <= 1.0e-5 * range, "{method:?} {width}: {change} m at {x}, {z}");
                }
            }
            let corner = (smoothed.at(0, 0) - ground.at(0, 0)).abs();
            assert!(corner > 0.1, "{method:?} {width}: nothing was smoothed at the corner: {corner}");
        }
    }
}

#[test]
fn smoothing_never_leaves_the_range_of_the_ground() {
    for (ground, name) in
        [(terrain::extreme(150, 130, 3), "extreme"), (terrain::random(150, 130, 4), "random")]
    {
        let bounds = |plane: &Plane| {
            let heights = || plane.samples().iter().copied();
            (heights().fold(f32::MAX, f32::min), heights().fold(f32::MIN, f32::max))
        };
        let (lowest, highest) = bounds(&ground);
        for method in [SmoothMethod::Gaussian, SmoothMethod::Lattice] {
            for width in [0.3, 1.0, 3.9, 6.0, 30.0] {
                for blending in [Blending::BuildUp, Blending::Wash] {
                    let brush = with_width(smooth(method, blending), width);
                    let brush = Brush { radius_m: 40.0, falloff_m: 10.0, ..brush };
                    for after in [
                        filled(&ground, brush.clone()),
                        painted(&ground, stroke(brush, &[[20.0, 20.0], [120.0, 100.0], [30.0, 110.0]])),
                    ] {
                        let (low, high) = bounds(&after);
                        assert!(
                            low >= lowest && high <= highest,
                            "{name}, {method:?} {width} {blending:?}: {low}..{high} of {lowest}..{highest}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn a_constant_keeps_its_bits() {
    let ground = Plane::from_fn(130, 100, |_, _| 8_848.86);
    for (name, brush) in brushes() {
        let brush = Brush { radius_m: 30.0, falloff_m: 20.0, ..brush };
        let after = painted(&ground, stroke(brush, &[[10.0, 10.0], [100.0, 60.0], [5.0, 90.0]]));
        assert_eq!(after, ground, "{name}");
    }
}

#[test]
fn sharpening_is_smoothing_the_other_way() {
    let ground = terrain::random(120, 100, 8);
    let smoothed = filled(&ground, with_width(smooth(SmoothMethod::Gaussian, Blending::BuildUp), 3.0));
    let sharpen = Brush::new(BrushType::Sharpen, 1.0, 1.0);
    let sharpen = Brush { smoothing: Smoothing { gain: 0.7, ..sharpen.smoothing }, ..sharpen };
    let sharpened = filled(&ground, with_width(sharpen, 3.0));
    for z in 0..100 {
        for x in 0..120 {
            let expected = ground.at(x, z) + 0.7 * (ground.at(x, z) - smoothed.at(x, z));
            assert!((sharpened.at(x, z) - expected).abs() < 1.0e-3, "{x}, {z}");
        }
    }
}

/// A wash is one filter of the ground before the stroke, however often the stroke passes: half of the way is half of it.
#[test]
fn a_wash_over_a_place_again_changes_nothing_more_and_build_up_does() {
    let ground = terrain::random(128, 64, 12);
    let once = [[10.0, 32.0], [118.0, 32.0]];
    let thrice = [once, [once[1], once[0]], once].concat();
    let brush = |blending| Brush {
        radius_m: 12.0,
        falloff_m: 12.0,
        strength: 0.5,
        ..with_width(smooth(SmoothMethod::Gaussian, blending), 2.0)
    };
    let wash = |points: &[[f64; 2]]| painted(&ground, stroke(brush(Blending::Wash), points));
    let (one, three) = (wash(&once), wash(&thrice));
    let all = filled(&ground, with_width(smooth(SmoothMethod::Gaussian, Blending::Wash), 2.0));
    for x in 20..108 {
        let way = all.at(x, 32) - ground.at(x, 32);
        let share = |after: &Plane| (after.at(x, 32) - ground.at(x, 32)) / way;
        if way.abs() > 0.5 {
            // Between two instances a little less than at them; never more than the strength.
            assert!((0.46..=0.501).contains(&share(&one)), "{x}: {}", share(&one));
            assert!((0.46..=0.501).contains(&share(&three)), "{x}: {}", share(&three));
        }
    }
    let bend = |plane: &Plane, x: u32| plane.at(x - 1, 32) - 2.0 * plane.at(x, 32) + plane.at(x + 1, 32);
    let roughness = |plane: &Plane| (21..107).map(|x| bend(plane, x).abs()).sum::<f32>();
    let build_up =
        |points: &[[f64; 2]]| roughness(&painted(&ground, stroke(brush(Blending::BuildUp), points)));
    assert!(build_up(&thrice) < 0.8 * build_up(&once));
}

#[test]
fn smear_drags_a_step_along_the_stroke_and_only_there() {
    let ground = Plane::from_fn(200, 80, |x, _| if x < 60 { 100.0 } else { 0.0 });
    let brush = Brush { strength: 1.0, falloff_m: 10.0, ..Brush::new(BrushType::Smear, 20.0, 1.0) };
    let after = painted(&ground, stroke(brush, &[[40.0, 40.0], [140.0, 40.0]]));
    assert!(after.at(120, 40) > 90.0, "{} m at the stroke's centre", after.at(120, 40));
    assert!(after.at(190, 40) == 0.0 && after.at(120, 70) == 0.0 && after.at(40, 5) == 100.0);
    for z in 0..80 {
        for x in 0..200 {
            assert!((0.0..=100.0).contains(&after.at(x, z)), "{x}, {z}: {}", after.at(x, z));
        }
    }
}

/// The lattice's spline from its formula, in `f64`.
#[test]
fn the_lattice_is_the_uniform_b_spline_over_every_so_many_samples() {
    let ground = terrain::random(90, 70, 21);
    let spacing = 8;
    let smoothed = filled(&ground, with_width(smooth(SmoothMethod::Lattice, Blending::BuildUp), 7.0));
    let basis = |t: f64| {
        let [a, b] = [1.0 - t, t];
        [a.powi(3), 3.0 * b.powi(3) - 6.0 * b * b + 4.0, 3.0 * a.powi(3) - 6.0 * a * a + 4.0, b.powi(3)]
            .map(|w| w / 6.0)
    };
    for z in 0..70_i32 {
        for x in 0..90_i32 {
            let (wx, wz) = (basis(f64::from(x % spacing) / 8.0), basis(f64::from(z % spacing) / 8.0));
            let mut expected = 0.0;
            for (dz, wz) in (-1..3).zip(wz) {
                for (dx, wx) in (-1..3).zip(wx) {
                    let (x, z) = ((x / spacing + dx) * spacing, (z / spacing + dz) * spacing);
                    let height = ground.at(mirrored(x, 90).unsigned_abs(), mirrored(z, 70).unsigned_abs());
                    expected += wx * wz * f64::from(height);
                }
            }
            let found = f64::from(smoothed.at(x.unsigned_abs(), z.unsigned_abs()));
            assert!((found - expected).abs() < 1.0e-3, "{x}, {z}: {found} and {expected}");
        }
    }
}
