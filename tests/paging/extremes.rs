//! Absurd parameters: a defined result, or a typed error, and never a height that cannot be stored.

use orogeny_field::noise::{Noise, Normalization, Turbulence};
use orogeny_field::{
    Alignment, Alpha, AlphaRotation, Blending, Brush, BrushType, CloneBlend, CloneSource, Cloning, Coverage,
    DataSource, Droplets, FieldId, FillPits, FlowMask, FlowRouting, Jitter, LedgeDirection, LevelOnly,
    PageLayout, PointerSample, PressureTarget, ProfileShape, RainMask, RainShows, RangeMap, RangeMapping,
    SampleRect, SmoothMethod, Smoothing, Stamp, StampMode, Stroke, Terrace, TerrainGrid, is_storable_height,
};
use orogeny_tests::{Feed, Operation, Plane, Random, compare, gpu, paint, terrain};
use proptest::prelude::*;

use crate::{cpu_executor, executors};

fn layout() -> PageLayout {
    PageLayout::new(64).unwrap()
}

/// Any magnitude from 10^low to 10^high, either sign.
fn magnitude(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low..high, any::<bool>()).prop_map(|(exponent, is_negative)| {
        let value = 10.0_f64.powf(exponent);
        if is_negative { -value } else { value }
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 192, ..ProptestConfig::default() })]

    /// One dab against a scalar model in `f64`, which knows no pages, rectangles or `f32`.
    #[test]
    fn a_dab_of_any_radius_anywhere_is_what_a_scalar_model_says(
        radius_m in magnitude(-12.0, 9.0).prop_map(f64::abs),
        centre in prop_oneof![
            [-50.0_f64..150.0, -50.0_f64..150.0],
            [magnitude(0.0, 8.0), magnitude(0.0, 8.0)],
        ],
        strength in prop_oneof![Just(0.0), magnitude(-6.0, 7.0).prop_map(f64::abs)],
        is_smooth: bool,
    ) {
        let plane = terrain::random(100, 90, 3);
        let shape = if is_smooth { ProfileShape::Smooth } else { ProfileShape::Linear };
        let brush = Brush { shape, ..Brush::new(BrushType::Raise, radius_m, strength) };
        let [x_m, z_m] = centre;
        let dab = Stroke { brush, seed: 0, points: vec![PointerSample::at(x_m, z_m)] };
        let mut cpu = cpu_executor(layout(), 64, 1);
        let painted = paint(&plane, 1.0, &[Operation::Stroke(dab)], &mut cpu, layout(), Feed::WHOLE).unwrap();
        for z in 0..90 {
            for x in 0..100 {
                let before = plane.at(x, z);
                let distance_m = (f64::from(x) - x_m).hypot(f64::from(z) - z_m);
                let t = (1.0 - distance_m / radius_m).max(0.0);
                let weight = if is_smooth { t * t * (3.0 - 2.0 * t) } else { t };
                // Under half a sample an instance is left out.
                let amount = if radius_m < 0.5 { 0.0 } else { strength * weight };
                let expected = (f64::from(before) + amount).clamp(-1.0e7, 1.0e7);
                let found = painted.plane.at(x, z);
                if amount == 0.0 && distance_m > radius_m * 1.000_001 {
                    prop_assert_eq!(before.to_bits(), found.to_bits());
                }
                // Distances are rounded to f32 where they are much larger than a sample.
                let slack = 1.0e-6 * strength + 1.0e-6 * expected.abs().max(1.0);
                prop_assert!((f64::from(found) - expected).abs() <= slack, "{x}, {z}: {expected} {found}");
            }
        }
    }
}

/// Every height may be stored; NaN and infinity are told by their bits.
fn assert_storable(plane: &Plane, what: &str) {
    let bad = plane.samples().iter().find(|height| !is_storable_height(**height));
    assert!(bad.is_none(), "{what}: {bad:?}");
}

fn extreme_brush(random: &mut Random) -> Brush {
    // A custom brush is what its user writes.
    let brush_type = random.one_of(&BrushType::ALL[..BrushType::ALL.len() - 1]);
    assert_ne!(brush_type, BrushType::Custom);
    let shape = random.one_of(&[
        ProfileShape::Power { power: 0.1 },
        ProfileShape::Power { power: 16.0 },
        ProfileShape::Linear,
        ProfileShape::Smooth,
        ProfileShape::Sphere,
        ProfileShape::Tip,
        ProfileShape::Gauss,
        ProfileShape::Sigmoid { steepness: 0.01 },
        ProfileShape::Sigmoid { steepness: 20.0 },
    ]);
    let radius_m = random.one_of(&[f64::MIN_POSITIVE, 1.0e-40, 0.5, 0.500_001, 1.0, 33.0, 1.0e4, 1.0e9]);
    let needs_height = brush_type == BrushType::SetHeight;
    let height_m = random.one_of(&[None, Some(1.0e7), Some(-1.0e7), Some(0.0), Some(1.0e-38)]);
    let scale = random.one_of(&[1.0 / 64.0, 1.0, 64.0]);
    // What is made smaller and spreads over many levels is made of gigabytes around it.
    let laplacian = if scale < 1.0 { CloneBlend::Feathered } else { CloneBlend::Laplacian };
    let blend = random.one_of(&[laplacian, CloneBlend::MeanShifted, CloneBlend::Plain]);
    Brush {
        brush_type,
        radius_m,
        shape,
        falloff_m: radius_m * random.one_of(&[0.0, 1.0e-5, 1.001e-4, 0.01, 1.0]),
        strength: match brush_type.coverage() {
            Coverage::Additive => random.one_of(&[0.0, 1.0e-30, 1.0, 1.0e7]),
            Coverage::Blending => random.one_of(&[0.0, 1.0e-30, 0.5, 1.0]),
        },
        spacing: random.one_of(&[1.0 / 32.0, 0.25, 1.0]),
        pressure: random.one_of(&[PressureTarget::None, PressureTarget::Both, PressureTarget::Radius]),
        blending: random.one_of(&[Blending::Wash, Blending::BuildUp]),
        height_m: if needs_height { height_m.or(Some(-1.0e7)) } else { height_m },
        direction: random.one_of(&[LedgeDirection::Raise, LedgeDirection::Lower]),
        only: random.one_of(&[LevelOnly::Both, LevelOnly::Cut, LevelOnly::Fill]),
        flow: random.one_of(&[0.0, 1.0e-30, 0.5, 1.0]),
        smoothing: Smoothing {
            method: random.one_of(&[SmoothMethod::Gaussian, SmoothMethod::Lattice]),
            width_m: random.one_of(&[None, Some(1.0e-3), Some(512.0)]),
            gain: random.one_of(&[0.0, 1.0, 16.0]),
        },
        jitter: random.one_of(&[Jitter::default(), Jitter { radius: 1.0, position: 4.0, strength: 1.0 }]),
        alpha: (brush_type == BrushType::Stamp).then(|| Alpha {
            source: DataSource::File("a picture".to_owned()),
            angle_deg: 12.0,
            rotation: random.one_of(&[AlphaRotation::Fixed, AlphaRotation::Random]),
            is_mirrored: false,
        }),
        cloning: Cloning {
            source: CloneSource {
                at_m: random.one_of(&[[0.0, 0.0], [50.0, 1.0e9], [-3.0e4, 7.0]]),
                to_m: Some(random.one_of(&[[0.0, 0.0], [-1.0e9, 50.0], [40.0, 3.0e4]])),
                alignment: random.one_of(&[Alignment::Stroke, Alignment::Aligned]),
                rotation_deg: random.one_of(&[0.0, 90.0, -359.9]),
                scale,
                is_mirrored: random.one_of(&[false, true]),
                height_scale: random.one_of(&[-1000.0, 0.0, 1.0]),
                height_offset_m: random.one_of(&[-1.0e7, 0.0]),
                ..CloneSource::default()
            },
            blend,
            num_levels: random.one_of(&[None, Some(1), Some(12)]),
            level_weights: Vec::new(),
        },
        droplets: Droplets {
            per_sample: random.one_of(&[0.0, 2.0]),
            inertia: random.one_of(&[0.0, 0.99]),
            capacity: random.one_of(&[0.0, 64.0]),
            erosion: 1.0,
            deposition: random.one_of(&[0.0, 1.0]),
            gravity: random.one_of(&[0.0, 100.0]),
            radius: random.one_of(&[1, 8]),
            ..Droplets::default()
        },
        fill_pits: FillPits {
            slope_m: random.one_of(&[0.0, 1000.0]),
            max_depth_m: random.one_of(&[None, Some(0.0), Some(2.0e7)]),
        },
        flow_routing: random.one_of(&[
            FlowRouting::Steepest,
            FlowRouting::Shared { exponent: 0.0 },
            FlowRouting::Shared { exponent: 100.0 },
        ]),
        rain_mask: random.one_of(&[
            RainMask { shows: RainShows::Sediment, from_m: 0.0, to_m: 1.0e-300 },
            RainMask { shows: RainShows::Deposits, from_m: 0.0, to_m: 1.0e7 },
        ]),
        flow_mask: random.one_of(&[
            FlowMask { from_m2: 0.001, to_m2: 1.0e18 },
            FlowMask { from_m2: 1.0e17, to_m2: 1.0e18 },
        ]),
        terrace: Terrace {
            step_m: random.one_of(&[1.0e-3, 10.0, 1.0e7]),
            sharpness: random.one_of(&[0.0, 1.0]),
            tilt_deg: random.one_of(&[0.0, 60.0]),
            tilt_direction_deg: 33.0,
        },
        range_map: RangeMap {
            low_m: random.one_of(&[-1.0e7, 0.0]),
            high_m: random.one_of(&[1.0e-30, 1.0e7]),
            mapping: random.one_of(&[
                RangeMapping::Bias(0.01),
                RangeMapping::Bias(0.99),
                RangeMapping::Gain(0.01),
                RangeMapping::Gain(0.99),
            ]),
        },
        stamp: Stamp {
            scale_m: random.one_of(&[-1.0e7, 1.0e7, 0.0]),
            mode: random.one_of(&[StampMode::Add, StampMode::Replace, StampMode::Max, StampMode::Min]),
        },
        noise: Noise {
            turbulence: random.one_of(&Turbulence::ALL),
            octaves: 3,
            elevation: random.one_of(&[-2.0, 4.0]),
            normalization: Normalization::Given {
                offset: random.one_of(&[-1.0e9, 0.0]),
                scale: random.one_of(&[-1.0e9, 1.0, 1.0e9]),
            },
            ..Noise::default()
        },
        ..Brush::new(brush_type, radius_m, 0.5)
    }
}

#[test]
fn no_parameters_write_a_height_that_cannot_be_stored() {
    let gpu = gpu();
    let mut random = Random::new(17);
    let grid = TerrainGrid::new(100, 90, 1.0).unwrap();
    let mut executors = executors(&gpu, layout(), 8);
    let mut num_cases = 0;
    for seed in 0..120 {
        let brush = extreme_brush(&mut random);
        let plane = terrain::extreme(100, 90, seed);
        let x_m = random.one_of(&[-1.0e8, -20.0, 50.0, 99.0, 3.0e8]);
        let points = [
            PointerSample::at(x_m, 30.0).with_pressure(random.one_of(&[0.0, 1.0e-30, 1.0])),
            PointerSample::at(x_m + 1.0e-4, 30.0),
            PointerSample::at(x_m + 1.0e-2, 30.0).with_pressure(random.one_of(&[0.0, 0.5, 1.0])),
            PointerSample::at(x_m + 20.0, 41.0),
        ];
        // A ramp leads somewhere.
        let is_ramp = brush.brush_type == BrushType::Ramp;
        let num_points = if is_ramp { 4 } else { random.one_of(&[1, 4]) };
        let can_fill =
            !is_ramp && !matches!(brush.brush_type, BrushType::Stamp | BrushType::Smear | BrushType::Grab);
        let points = points[..num_points].to_vec();
        let fill_brush = Brush { height_m: brush.height_m.or(Some(1.0e7)), ..brush.clone() };
        let operations = [
            Operation::Stroke(Stroke { brush, seed: u32::MAX, points }),
            Operation::Fill { brush: fill_brush, seed: 0, region: SampleRect::new(10, -5, 60, 200) },
        ];
        for executor in &mut executors {
            for operation in operations.iter().take(if can_fill { 2 } else { 1 }) {
                let what = format!("{operation:?} on {}", executor.description());
                let operation = std::slice::from_ref(operation);
                let painted =
                    paint(&plane, grid.spacing_m(), operation, &mut **executor, layout(), Feed::WHOLE);
                assert_storable(&painted.unwrap_or_else(|err| panic!("{what}: {err}")).plane, &what);
                num_cases += 1;
            }
        }
        gpu.check().unwrap();
    }
    assert!(num_cases > 400, "{num_cases}");
}

/// A damaged page may hold a NaN; a kernel does not pass it on where it writes.
#[test]
fn a_kernel_writes_no_nan_even_over_one() {
    let gpu = gpu();
    let bad = [f32::NAN, -f32::NAN, f32::from_bits(0x7f80_0001), f32::INFINITY, f32::NEG_INFINITY];
    for brush_type in BrushType::ALL.into_iter().filter(|brush_type| *brush_type != BrushType::Custom) {
        for blending in [Blending::Wash, Blending::BuildUp] {
            let plane =
                Plane::from_fn(100, 90, |x, z| if (x + z) % 7 == 0 { bad[(x % 5) as usize] } else { 10.0 });
            let brush = Brush {
                height_m: Some(50.0),
                blending,
                falloff_m: 0.0,
                // A clone of what is there, so that all of it is written.
                cloning: Cloning {
                    source: CloneSource { at_m: [50.0, 50.0], ..CloneSource::default() },
                    ..Cloning::default()
                },
                alpha: (brush_type == BrushType::Stamp).then(|| Alpha {
                    source: DataSource::File("a picture".to_owned()),
                    angle_deg: 0.0,
                    rotation: AlphaRotation::Fixed,
                    is_mirrored: false,
                }),
                ..Brush::new(brush_type, 1.0e3, 0.5)
            };
            let points = vec![PointerSample::at(50.0, 50.0), PointerSample::at(60.0, 60.0)];
            let stroke = Operation::Stroke(Stroke { brush, seed: 0, points });
            for mut executor in executors(&gpu, layout(), 8) {
                let what = format!("{stroke:?} on {}", executor.description());
                let painted =
                    paint(&plane, 1.0, std::slice::from_ref(&stroke), &mut *executor, layout(), Feed::WHOLE);
                let painted = painted.unwrap();
                assert_storable(&painted.plane, &what);
                // A mask is clamped to 0..1 as a matter of course.
                let is_counted = painted.notices[0].num_clamped_heights > 0;
                assert_ne!(is_counted, brush_type.is_for_masks(), "{what}: not counted");
            }
        }
    }
    gpu.check().unwrap();
}

#[test]
fn what_reaches_nothing_changes_nothing() {
    let gpu = gpu();
    let plane = terrain::extreme(100, 90, 1);
    let at = |x, z| vec![PointerSample::at(x, z), PointerSample::at(x + 5.0, z)];
    let faint = PointerSample::at(50.0, 50.0).with_pressure(0.0);
    let cases = [
        (
            "no pressure",
            Brush { pressure: PressureTarget::Both, ..Brush::new(BrushType::Raise, 20.0, 9.0) },
            vec![faint],
        ),
        ("a tiny radius", Brush::new(BrushType::Raise, 0.499, 9.0), at(50.0, 50.0)),
        ("far outside", Brush::new(BrushType::Raise, 20.0, 9.0), at(-1.0e7, 1.0e8)),
        ("just outside", Brush::new(BrushType::Level, 20.0, 1.0), at(-26.0, 50.0)),
    ];
    for (name, brush, points) in cases {
        for mut executor in executors(&gpu, layout(), 8) {
            let stroke = Operation::Stroke(Stroke { brush: brush.clone(), seed: 0, points: points.clone() });
            let painted = paint(&plane, 1.0, &[stroke], &mut *executor, layout(), Feed::WHOLE).unwrap();
            compare::bit_equal(&plane, &painted.plane)
                .unwrap_or_else(|mismatch| panic!("{name}: {mismatch}"));
        }
    }
}

#[test]
fn points_that_are_no_place_and_fills_without_a_height_are_refused() {
    let plane = terrain::random(100, 90, 1);
    let mut cpu = cpu_executor(layout(), 8, 1);
    let mut refused = |operation| {
        paint(&plane, 1.0, &[operation], &mut cpu, layout(), Feed::WHOLE).expect_err("it was taken")
    };
    for x_m in [f64::NAN, f64::INFINITY, 1.0e12] {
        let points = vec![PointerSample::at(5.0, 5.0), PointerSample::at(x_m, 5.0)];
        let brush = Brush::new(BrushType::Raise, 9.0, 1.0);
        let err = refused(Operation::Stroke(Stroke { brush, seed: 0, points }));
        assert!(
            matches!(err, orogeny_brush::Error::Field(orogeny_field::Error::Point { index: 1, .. })),
            "{err}"
        );
    }
    for brush_type in [BrushType::Level, BrushType::Ledge] {
        let brush = Brush::new(brush_type, 9.0, 1.0);
        let err = refused(Operation::Fill { brush, seed: 0, region: SampleRect::new(0, 0, 10, 10) });
        assert!(
            matches!(err, orogeny_brush::Error::Field(orogeny_field::Error::MissingField { .. })),
            "{err}"
        );
    }
}

#[test]
fn a_stroke_of_one_point_at_the_far_corner_of_the_largest_terrain_touches_one_page() {
    let grid = TerrainGrid::new(1 << 20, 1 << 20, 0.25).unwrap();
    let last_m = f64::from((1 << 20) - 1) * 0.25;
    let field = FieldId(0);
    let brush = Brush::new(BrushType::Raise, 10.0, 16.0);
    let operation =
        Operation::Stroke(Stroke { brush, seed: 0, points: vec![PointerSample::at(last_m - 0.1, last_m)] });
    let gpu = gpu();
    let layout = PageLayout::default();
    for mut executor in executors(&gpu, layout, 8) {
        let mut store = orogeny_pages::MemoryPages::new(layout, 0.0);
        orogeny_tests::apply(&operation, &grid, field, &mut *executor, &mut store, Feed::WHOLE).unwrap();
        let pages = store.pages_unsorted();
        assert_eq!(pages.len(), 1, "{}", executor.description());
        let page = pages.values().next().unwrap();
        // 0.1 m and 0.15 m from the centre, of 10: t = 0.99 and 0.985 of `smooth`.
        let [last, left] = [255, 254].map(|x| page.row(255, x, x + 1).unwrap()[0]);
        assert!((last - 16.0 * 0.999_702).abs() < 1.0e-4, "{last}");
        assert!((left - 16.0 * 0.999_332).abs() < 1.0e-4, "{left}");
    }
}
