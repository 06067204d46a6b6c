//! Cloned and grabbed ground: the back ends against each other, and what holds for every clone.

use orogeny_brush::{CpuExecutor, Executor};
use orogeny_field::{
    Alignment, Band, Brush, BrushType, CloneBlend, CloneSource, Cloning, DataSource, Gate, PageLayout,
    PointerSample, SampleRect, Stroke, Symmetry, SymmetryKind,
};
use orogeny_tests::{Feed, Operation, Plane, Tolerance, compare, paint, terrain};

use crate::agreement::back_ends_agree;

/// A clone of what lies 30 m east and 20 m south of a place.
fn clone(blend: CloneBlend, source: CloneSource) -> Brush {
    let source = CloneSource { at_m: [130.0, 70.0], to_m: Some([100.0, 50.0]), ..source };
    let cloning = Cloning { source, blend, ..Cloning::default() };
    Brush { cloning, ..Brush::new(BrushType::Clone, 1.0, 1.0) }
}

fn aligned() -> CloneSource {
    CloneSource { alignment: Alignment::Aligned, ..CloneSource::default() }
}

fn turned() -> CloneSource {
    let turned = CloneSource { rotation_deg: 33.0, scale: 1.7, is_mirrored: true, ..CloneSource::default() };
    CloneSource { height_scale: -0.5, height_offset_m: 120.0, ..turned }
}

fn brushes() -> Vec<(&'static str, Brush)> {
    let steep = Gate { slope_deg: Some(Band { min: 5.0, max: 60.0, feather: 20.0 }), ..Gate::default() };
    let weighted = |brush: Brush| Brush {
        cloning: Cloning { num_levels: Some(3), level_weights: vec![1.0, 0.25, 0.0], ..brush.cloning },
        gate: Some(Box::new(steep.clone())),
        ..brush
    };
    let copies = Some(Symmetry { kind: SymmetryKind::Radial { count: 3 }, centre_m: [80.0, 60.0] });
    let data = Some(DataSource::File("a raster".to_owned()));
    vec![
        ("laplacian", clone(CloneBlend::Laplacian, CloneSource::default())),
        ("laplacian, weighted, gated", weighted(clone(CloneBlend::Laplacian, turned()))),
        ("feathered, turned", clone(CloneBlend::Feathered, turned())),
        (
            "laplacian, a region with a feather",
            clone(
                CloneBlend::Laplacian,
                CloneSource { region_m: Some([90.3, 40.0, 77.0, 90.0]), feather_m: 12.5, ..turned() },
            ),
        ),
        ("feathered, mirrored copies", Brush { symmetry: copies, ..clone(CloneBlend::Feathered, aligned()) }),
        (
            "mean-shifted, made smaller",
            clone(CloneBlend::MeanShifted, CloneSource { scale: 0.21, ..aligned() }),
        ),
        ("plain, from data", clone(CloneBlend::Plain, CloneSource { data, ..turned() })),
        (
            "fixed",
            clone(
                CloneBlend::Feathered,
                CloneSource { alignment: Alignment::Fixed, ..CloneSource::default() },
            ),
        ),
        ("grab", Brush::new(BrushType::Grab, 1.0, 1.0)),
        ("grab, copies", Brush { symmetry: copies, ..Brush::new(BrushType::Grab, 1.0, 0.7) }),
    ]
}

back_ends_agree!(brushes);

fn painted(ground: &Plane, operation: Operation) -> Plane {
    let layout = PageLayout::new(64).unwrap();
    let mut cpu = CpuExecutor::new(layout, 1 << 24, Some(2)).unwrap();
    paint(ground, 1.0, &[operation], &mut cpu as &mut dyn Executor, layout, Feed::WHOLE).unwrap().plane
}

fn filled(ground: &Plane, brush: Brush, region: SampleRect) -> Plane {
    painted(ground, Operation::Fill { brush, seed: 0, region })
}

fn stroke(brush: Brush, points: &[[f64; 2]]) -> Operation {
    let points = points.iter().map(|[x, z]| PointerSample::at(*x, *z)).collect();
    Operation::Stroke(Stroke { brush, seed: 0, points })
}

/// A brush of 20 m that clones what lies `by` samples away.
fn shifted(blend: CloneBlend, [x, z]: [f64; 2]) -> Brush {
    let source = CloneSource {
        at_m: [100.0 + x, 50.0 + z],
        to_m: Some([100.0, 50.0]),
        alignment: Alignment::Aligned,
        ..CloneSource::default()
    };
    let cloning = Cloning { source, blend, ..Cloning::default() };
    Brush { cloning, falloff_m: 15.0, ..Brush::new(BrushType::Clone, 20.0, 1.0) }
}

const EVERY_BLEND: [CloneBlend; 4] =
    [CloneBlend::Laplacian, CloneBlend::Feathered, CloneBlend::MeanShifted, CloneBlend::Plain];
const WAY: [[f64; 2]; 3] = [[60.0, 60.0], [100.0, 75.0], [140.0, 60.0]];

#[test]
fn ground_cloned_onto_itself_keeps_its_bits() {
    for ground in
        [terrain::random(200, 150, 4), terrain::extreme(200, 150, 5), terrain::real(200, 150, 90, 10)]
    {
        for blend in EVERY_BLEND {
            let after = painted(&ground, stroke(shifted(blend, [0.0, 0.0]), &WAY));
            // Only a denormal may become 0.
            let least = Tolerance { absolute_m: f64::from(f32::MIN_POSITIVE), ..Tolerance::EXACT };
            compare::within(&ground, &after, |x, z| {
                if ground.at(x, z).is_subnormal() { least } else { Tolerance::EXACT }
            })
            .unwrap_or_else(|err| panic!("{blend:?}: {err}"));
        }
    }
}

#[test]
fn what_is_copied_by_whole_samples_keeps_its_bits_and_the_rest_is_left() {
    let ground = terrain::random(200, 150, 8);
    let region = SampleRect::new(20, 30, 90, 100);
    for blend in [CloneBlend::Feathered, CloneBlend::Plain] {
        let after = filled(&ground, shifted(blend, [63.0, 31.0]), region);
        for z in 0..150_u32 {
            for x in 0..200_u32 {
                let is_inside = (20..90).contains(&x) && (30..100).contains(&z);
                let expected = if is_inside { ground.at(x + 63, z + 31) } else { ground.at(x, z) };
                assert_eq!(after.at(x, z).to_bits(), expected.to_bits(), "{blend:?}: {x}, {z}");
            }
        }
    }
}

#[test]
fn a_laplacian_clone_changes_nothing_beyond_its_spread_and_has_no_step_at_its_edge() {
    // Two plains with their own texture, 200 m apart.
    let texture = terrain::random(256, 256, 3);
    let ground =
        Plane::from_fn(256, 256, |x, z| 0.01 * texture.at(x, z) + if x < 128 { 100.0 } else { 300.0 });
    let brush = |blend| Brush { falloff_m: 0.0, ..shifted(blend, [128.0, 0.0]) };
    let dab = [[64.0, 128.0]];
    let step = |plane: &Plane| {
        let at = |x: u32| plane.at(x, 128) - ground.at(x, 128);
        (30..98).map(|x| (at(x + 1) - at(x)).abs()).fold(0.0, f32::max)
    };
    let plain = painted(&ground, stroke(brush(CloneBlend::Plain), &dab));
    assert!(step(&plain) > 150.0, "{}", step(&plain));
    let blended = painted(&ground, stroke(brush(CloneBlend::Laplacian), &dab));
    let highest = texture.samples().iter().fold(0.0_f32, |highest, height| highest.max(height.abs())) * 0.02;
    assert!(step(&blended) < highest + 30.0, "{} m, texture of {highest} m", step(&blended));
    // 39 samples of the dab are 5 on the third level: it spreads over 2^5 of them.
    let spread = 20 + 32;
    let mut num_changed = 0;
    for z in 0..256_u32 {
        for x in 0..256_u32 {
            let away = x.abs_diff(64).max(z.abs_diff(128));
            let is_changed = ground.at(x, z).to_bits() != blended.at(x, z).to_bits();
            assert!(away <= spread || !is_changed, "{x}, {z}");
            num_changed += usize::from(is_changed);
        }
    }
    assert!(num_changed > 1000, "{num_changed}");
    assert!(blended.at(64, 128) > 200.0, "{} m in the middle", blended.at(64, 128));
}

#[test]
fn a_mean_shifted_clone_leaves_the_mean_as_it_is() {
    let ground = terrain::real(256, 256, 700, 300);
    let brush = |blend| Brush { falloff_m: 30.0, radius_m: 40.0, ..shifted(blend, [60.0, 100.0]) };
    let way = [[60.0, 60.0], [100.0, 80.0]];
    let change = |blend| {
        let after = painted(&ground, stroke(brush(blend), &way));
        let changes = || after.samples().iter().zip(ground.samples()).map(|(a, b)| f64::from(a - b));
        (changes().sum::<f64>().abs(), changes().map(f64::abs).sum::<f64>())
    };
    let (feathered, _) = change(CloneBlend::Feathered);
    let (shifted, moved) = change(CloneBlend::MeanShifted);
    assert!(
        shifted < 0.01 * moved && shifted < 0.1 * feathered,
        "{shifted} of {moved}, {feathered} unshifted"
    );
}

#[test]
fn a_stroke_of_one_source_begins_anew_and_an_aligned_one_goes_on() {
    let ground = terrain::random(200, 150, 21);
    let brush = |alignment| {
        let brush = shifted(CloneBlend::Plain, [40.0, 30.0]);
        let source = CloneSource { alignment, ..brush.cloning.source };
        Brush { cloning: Cloning { source, ..brush.cloning }, ..brush }
    };
    // The source's place, (140, 80), comes to the stroke's first point, or to (100, 50).
    let anew = painted(&ground, stroke(brush(Alignment::Stroke), &[[50.0, 60.0], [70.0, 60.0]]));
    let assert_near = |found: f32, expected: f32| assert!((found - expected).abs() < 1.0e-3, "{found}");
    assert_near(anew.at(50, 60), ground.at(140, 80));
    assert_near(anew.at(77, 66), ground.at(167, 86));
    let on = painted(&ground, stroke(brush(Alignment::Aligned), &[[50.0, 60.0], [70.0, 60.0]]));
    assert_near(on.at(77, 66), ground.at(117, 96));
    // Each instance copies the same: the last one lies whole.
    let fixed = painted(&ground, stroke(brush(Alignment::Fixed), &[[50.0, 60.0], [90.0, 60.0]]));
    assert_near(fixed.at(90, 60), ground.at(140, 80));
    assert_near(fixed.at(81, 55), ground.at(131, 75));
}

#[test]
fn what_lies_beyond_the_sources_border_is_not_copied() {
    let ground = terrain::random(200, 150, 2);
    let region = SampleRect::new(0, 0, 200, 150);
    for blend in EVERY_BLEND {
        let after = filled(&ground, shifted(blend, [150.0, 0.0]), region);
        let is_left = |x: u32| (0..150).all(|z| after.at(x, z).to_bits() == ground.at(x, z).to_bits());
        assert!(!is_left(10), "{blend:?}");
        let first = if blend == CloneBlend::Laplacian { 200 } else { 50 };
        assert!((first..200).all(is_left), "{blend:?}");
    }
    let plain = filled(&ground, shifted(CloneBlend::Plain, [150.0, 0.0]), region);
    assert_eq!(plain.at(49, 70), ground.at(199, 70));
}

#[test]
fn a_grabbed_peak_goes_along_and_leaves_no_other_behind() {
    let peak = |x: u32, z: u32| (100.0 - (f64::from(x) - 70.0).hypot(f64::from(z) - 75.0)).max(0.0) as f32;
    let ground =
        Plane::from_fn(256, 150, |x, z| if peak(x, z) > 85.0 { 40.0 * (peak(x, z) - 85.0) } else { 0.0 });
    let brush = Brush { falloff_m: 20.0, ..Brush::new(BrushType::Grab, 40.0, 1.0) };
    let after = painted(&ground, stroke(brush.clone(), &[[70.0, 75.0], [100.0, 60.0], [170.0, 75.0]]));
    let highest = |plane: &Plane, columns: std::ops::Range<u32>| {
        columns.flat_map(|x| (0..150).map(move |z| (x, z))).map(|(x, z)| plane.at(x, z)).fold(0.0, f32::max)
    };
    assert!((after.at(170, 75) - ground.at(70, 75)).abs() < 1.0e-3);
    assert!(highest(&after, 0..120) < 1.0, "{} m are left behind", highest(&after, 0..120));
    assert!((highest(&after, 0..256) - highest(&ground, 0..256)).abs() < 1.0e-3);
    // Half of the strength is half of the way.
    let half =
        painted(&ground, stroke(Brush { strength: 0.5, ..brush.clone() }, &[[70.0, 75.0], [170.0, 75.0]]));
    assert!((half.at(120, 75) - ground.at(70, 75)).abs() < 1.0e-3);
    let nowhere = painted(&ground, stroke(brush, &[[70.0, 75.0]]));
    compare::bit_equal(&ground, &nowhere).unwrap();
}

/// A warp in one direction keeps the order of what lies in it: nothing folds over.
#[test]
fn grabbed_ground_never_folds_over() {
    let ground = Plane::from_fn(300, 100, |x, _| x as f32);
    for (falloff_m, way) in [(40.0, 20.0), (40.0, 200.0), (5.0, 90.0), (0.0, 60.0)] {
        let brush = Brush { falloff_m, ..Brush::new(BrushType::Grab, 40.0, 1.0) };
        let after = painted(&ground, stroke(brush, &[[60.0, 50.0], [60.0 + way, 50.0]]));
        let is_rising = |z: u32| (0..299).all(|x| after.at(x + 1, z) >= after.at(x, z) - 1.0e-3);
        assert!((0..100).all(is_rising), "a slope of {falloff_m} m, {way} m");
        assert!((after.at((60.0 + way) as u32, 50) - 60.0).abs() < 1.0e-3);
    }
}

/// Three pyramids by OpenCV, as Burt and Adelson have them, against two.
#[test]
fn a_laplacian_clone_is_what_opencv_makes_of_source_ground_and_mask() {
    let text = include_str!("../fixtures/field/blend.json");
    let blended: serde_json::Value = serde_json::from_str(text).unwrap();
    let number = |name: &str| blended[name].as_f64().unwrap();
    let numbers = |value: &serde_json::Value| -> Vec<f64> {
        value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
    };
    let (side, first) = (number("side") as u32, number("first") as u32);
    let dst = numbers(&blended["dst"]);
    let ground = Plane::from_fn(side, side, |x, z| dst[(z * side + x) as usize] as f32);
    let centre = f64::from(side) / 2.0;
    let source = CloneSource {
        at_m: [centre + number("offset"), centre],
        to_m: Some([centre, centre]),
        ..CloneSource::default()
    };
    let cloning = Cloning {
        source,
        blend: CloneBlend::Laplacian,
        num_levels: Some(number("num_levels") as u32),
        level_weights: numbers(&blended["level_weights"]),
    };
    let shape = orogeny_field::ProfileShape::Linear;
    let brush = Brush { cloning, shape, ..Brush::new(BrushType::Clone, number("radius"), 1.0) };
    let after = painted(&ground, stroke(brush, &[[centre, centre]]));
    let (mut worst, mut largest): (f32, f32) = (0.0, 0.0);
    let rows: Vec<_> = blended["rows"].as_array().unwrap().iter().map(numbers).collect();
    for (z, row) in (first..).zip(&rows) {
        for (x, expected) in (first..).zip(row) {
            worst = worst.max((after.at(x, z) - *expected as f32).abs());
            largest = largest.max((*expected as f32 - ground.at(x, z)).abs());
        }
    }
    assert!(!rows.is_empty() && largest > 30.0, "{largest}");
    println!("worst {worst} m of changes up to {largest} m");
    assert!(worst < 1.0e-3, "{worst} m");
}
