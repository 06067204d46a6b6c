//! What a strength means (section 3 of the kernel specification): one straight pass changes its centre line by it, wherever
//! the instances lie between the samples.

use orogeny_brush::CpuExecutor;
use orogeny_field::{Blending, Brush, BrushType, PageLayout, PointerSample, ProfileShape, Stroke};
use orogeny_tests::{Feed, Operation, Plane, paint};

const SIZE: u32 = 150;
const NUM_PHASES: u32 = 8;

/// From where to where a pass goes, and the samples on its way.
type Line = ([f64; 2], [f64; 2], fn(u32) -> (u32, u32));

/// The heights on the centre line of straight passes over flat ground, away from their ends: along x, along z and along the
/// diagonal, at several phases.
fn centre_line(brush: &Brush) -> Vec<f64> {
    let layout = PageLayout::new(64).unwrap();
    let mut cpu = CpuExecutor::new(layout, 1 << 24, Some(1)).unwrap();
    let flat = Plane::from_fn(SIZE, SIZE, |_, _| 0.0);
    let mut heights = Vec::new();
    for phase in 0..NUM_PHASES {
        let shift = f64::from(phase) / f64::from(NUM_PHASES) * brush.radius_m * brush.spacing;
        let (start, end) = (5.0 + shift, f64::from(SIZE) - 5.0 + shift);
        let directions: [Line; 3] = [
            ([start, 70.0], [end, 70.0], |k| (k, 70)),
            ([70.0, start], [70.0, end], |k| (70, k)),
            ([start, start], [end, end], |k| (k, k)),
        ];
        for (from, to, on_line) in directions {
            let points = [from, to].map(|[x, z]| PointerSample::at(x, z)).to_vec();
            let stroke = Operation::Stroke(Stroke { brush: brush.clone(), seed: 0, points });
            let painted = paint(&flat, 1.0, &[stroke], &mut cpu, layout, Feed::WHOLE).unwrap().plane;
            let far_from_ends = brush.radius_m.ceil() as u32 + 12;
            heights.extend((far_from_ends..SIZE - far_from_ends).map(|k| {
                let (x, z) = on_line(k);
                f64::from(painted.at(x, z))
            }));
        }
    }
    assert!(heights.len() > 500, "{}", heights.len());
    heights
}

fn worst_share(heights: &[f64], wanted: f64) -> f64 {
    heights.iter().map(|height| (height / wanted - 1.0).abs()).fold(0.0, f64::max)
}

/// Shape, falloff over radius, and the bound: 1 % for the gentle ones, 2 % for the rest.
const PROFILES: [(ProfileShape, f64, f64); 11] = [
    (ProfileShape::Linear, 1.0, 0.01),
    (ProfileShape::Linear, 0.5, 0.01),
    (ProfileShape::Smooth, 1.0, 0.01),
    (ProfileShape::Smooth, 0.5, 0.01),
    (ProfileShape::Gauss, 1.0, 0.01),
    (ProfileShape::Gauss, 0.5, 0.01),
    (ProfileShape::Power { power: 1.0 }, 0.75, 0.01),
    (ProfileShape::Power { power: 4.0 }, 1.0, 0.02),
    (ProfileShape::Sphere, 1.0, 0.02),
    (ProfileShape::Tip, 1.0, 0.02),
    (ProfileShape::Sigmoid { steepness: 3.0 }, 1.0, 0.02),
];

fn brush(
    brush_type: BrushType,
    (shape, falloff_ratio, _): &(ProfileShape, f64, f64),
    strength: f64,
) -> Brush {
    // No whole number of samples, so that the phases differ along the line as well.
    let radius_m = 21.37;
    let shape = shape.clone();
    Brush { shape, falloff_m: radius_m * falloff_ratio, ..Brush::new(brush_type, radius_m, strength) }
}

#[test]
fn a_straight_pass_raises_its_centre_line_by_the_strength() {
    for profile in PROFILES {
        let worst = worst_share(&centre_line(&brush(BrushType::Raise, &profile, 12.0)), 12.0);
        println!("{:?}: {:.3} %", profile.0, worst * 100.0);
        assert!(worst <= profile.2, "{profile:?}: {worst}");
    }
}

/// A hard edge comes and goes as a whole instance, so it is the profile with the most ripple: R/32 leaves 1/64 each way.
#[test]
fn a_straight_pass_with_a_hard_edge_keeps_within_two_percent() {
    let hard = brush(BrushType::Raise, &(ProfileShape::Linear, 0.0, 0.02), 12.0);
    let worst = worst_share(&centre_line(&hard), 12.0);
    assert!(worst <= 0.02, "{worst}");
}

#[test]
fn a_straight_pass_of_a_building_up_brush_blends_by_the_strength() {
    for profile in PROFILES {
        for strength in [0.1, 0.6, 0.95] {
            let brush = Brush {
                blending: Blending::BuildUp,
                height_m: Some(1000.0),
                ..brush(BrushType::Level, &profile, strength)
            };
            let worst = worst_share(&centre_line(&brush), strength * 1000.0);
            assert!(worst <= profile.2, "{profile:?} by {strength}: {worst}");
        }
    }
}

#[test]
fn the_strength_does_not_depend_on_the_spacing() {
    for spacing in [1.0 / 32.0, 0.1, 0.25, 0.5] {
        let brush = Brush { spacing, ..brush(BrushType::Lower, &PROFILES[2], 5.0) };
        let worst = worst_share(&centre_line(&brush), -5.0);
        assert!(worst <= 0.011, "{spacing}: {worst}");
    }
}
