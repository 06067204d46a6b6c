//! Stamp, and alpha bitmaps, which all brushes may have.

use orogeny_brush::CpuExecutor;
use orogeny_field::{
    Alpha, AlphaRotation, Blending, Brush, BrushType, DataSource, FieldId, Jitter, PageLayout, PointerSample,
    ProfileShape, Stamp, StampMode, Stroke, Symmetry, SymmetryKind,
};
use orogeny_tests::{Feed, Operation, Plane, compare, paint};

use crate::agreement::back_ends_agree;

fn alpha(rotation: AlphaRotation, angle_deg: f64, is_mirrored: bool) -> Option<Alpha> {
    Some(Alpha { source: DataSource::File("a picture".to_owned()), angle_deg, rotation, is_mirrored })
}

fn brushes() -> Vec<(&'static str, Brush)> {
    let stamp = |mode, rotation| Brush {
        stamp: Stamp { scale_m: 140.0, mode },
        alpha: alpha(rotation, 0.0, false),
        ..Brush::new(BrushType::Stamp, 1.0, 1.0)
    };
    let raise =
        Brush { alpha: alpha(AlphaRotation::Follow, 30.0, true), ..Brush::new(BrushType::Raise, 1.0, 1.0) };
    let level =
        Brush { alpha: alpha(AlphaRotation::Random, 0.0, false), ..Brush::new(BrushType::Level, 1.0, 1.0) };
    let radial = Symmetry { kind: SymmetryKind::Radial { count: 3 }, centre_m: [80.0, 80.0] };
    vec![
        ("stamp, add", stamp(StampMode::Add, AlphaRotation::Fixed)),
        (
            "stamp, replace",
            Brush { height_m: Some(77.0), ..stamp(StampMode::Replace, AlphaRotation::Follow) },
        ),
        (
            "stamp, max, jittered",
            Brush {
                jitter: Jitter { radius: 0.4, position: 0.7, strength: 0.5 },
                ..stamp(StampMode::Max, AlphaRotation::Random)
            },
        ),
        (
            "stamp, min, radial",
            Brush { symmetry: Some(radial), ..stamp(StampMode::Min, AlphaRotation::Follow) },
        ),
        ("raise with alpha", raise),
        ("level with alpha, wash with flow", Brush { flow: 0.4, ..level.clone() }),
        ("level with alpha, build-up", Brush { blending: Blending::BuildUp, ..level }),
    ]
}

back_ends_agree!(brushes);

fn dab(brush: Brush, at: [f64; 2]) -> Plane {
    let layout = PageLayout::new(64).unwrap();
    let [x, z] = at;
    let stroke = Stroke { brush, seed: 5, points: vec![PointerSample::at(x, z)] };
    let mut cpu = CpuExecutor::new(layout, 1 << 24, Some(1)).unwrap();
    let ground = Plane::from_fn(121, 121, |_, _| 100.0);
    paint(&ground, 1.0, &[Operation::Stroke(stroke)], &mut cpu, layout, Feed::WHOLE).unwrap().plane
}

fn hard(mode: StampMode) -> Brush {
    Brush {
        stamp: Stamp { scale_m: 30.0, mode },
        alpha: alpha(AlphaRotation::Fixed, 0.0, false),
        shape: ProfileShape::Linear,
        falloff_m: 0.0,
        ..Brush::new(BrushType::Stamp, 40.0, 1.0)
    }
}

#[test]
fn a_stamp_is_its_bitmap_over_the_ground_under_it() {
    let bitmap = orogeny_tests::resources(&hard(StampMode::Add), FieldId(0)).alpha.unwrap();
    let stamped = dab(hard(StampMode::Add), [60.0, 60.0]);
    // Pixel (i, j) of 37 x 23 lies in the middle of its share of the square.
    for (i, j) in [(18, 11), (10, 8), (25, 15), (12, 16)] {
        let x = 60.0 - 40.0 + 80.0 * (f64::from(i) + 0.5) / 37.0;
        let z = 60.0 - 40.0 + 80.0 * (f64::from(j) + 0.5) / 23.0;
        let found = stamped.at(x.round() as u32, z.round() as u32);
        // The nearest sample is up to half a sample off, a quarter of a pixel along x.
        let near = [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)].map(|(di, dj)| bitmap.pixel(i + di, j + dj));
        let (low, high) =
            (near.iter().copied().fold(f32::MAX, f32::min), near.iter().copied().fold(0.0, f32::max));
        let range = 100.0 + 30.0 * low - 1.0e-3..=100.0 + 30.0 * high + 1.0e-3;
        assert!(range.contains(&found), "{i}, {j}: {found} not in {range:?}");
    }
    let replaced = dab(Brush { height_m: None, ..hard(StampMode::Replace) }, [60.0, 60.0]);
    compare::within(&stamped, &replaced, |_, _| orogeny_tests::Tolerance {
        ulps: 4.0,
        of_m: 130.0,
        absolute_m: 0.0,
    })
    .unwrap();
    let lower = dab(Brush { height_m: Some(500.0), ..hard(StampMode::Min) }, [60.0, 60.0]);
    assert!(lower.samples().iter().all(|height| *height == 100.0), "nothing of it lies under the ground");
}

#[test]
fn copies_in_a_mirror_are_mirror_images() {
    let axis = Symmetry { kind: SymmetryKind::Axis { angle_deg: 90.0 }, centre_m: [60.0, 0.0] };
    for rotation in [AlphaRotation::Fixed, AlphaRotation::Random] {
        let brush = Brush {
            alpha: alpha(rotation, 20.0, false),
            radius_m: 25.0,
            symmetry: Some(axis),
            ..hard(StampMode::Add)
        };
        let both = dab(brush, [30.0, 55.0]);
        let mut num_changed = 0;
        for z in 0..121 {
            for x in 0..60 {
                let (here, there) = (both.at(x, z), both.at(120 - x, z));
                assert!((here - there).abs() < 0.05, "{rotation:?} at {x}, {z}: {here} {there}");
                num_changed += u32::from(here != 100.0);
            }
        }
        assert!(num_changed > 1500, "{num_changed}");
    }
}
