//! On one back end no split over batches, pages, budgets, threads or the arrival of samples changes a bit.

use orogeny_brush::Executor;
use orogeny_field::noise::{Noise, NoiseDirection, Normalization, Seeding, Turbulence};
use orogeny_field::{
    Alignment, Alpha, AlphaRotation, AspectGate, Band, Blending, Brush, BrushType, CloneBlend, CloneSource,
    Cloning, DataSource, Droplets, Gate, Jitter, NoiseGate, PageLayout, Pipes, PointerSample, SampleRect,
    SmoothMethod, Smoothing, Symmetry, SymmetryKind, Terrace, Thermal,
};
use orogeny_gpu::Gpu;
use orogeny_tests::{Feed, Operation, Plane, Split, compare, gpu, paint, terrain};

use crate::{LOOP, build_up, cpu_executor, gpu_executor, ledge, raise, roughen, stroke, wash};

const SPACING_M: f64 = 1.0;

/// One after another on one terrain, so that each finds what the last one left.
fn operations() -> Vec<Operation> {
    let fill = Brush { height_m: Some(250.0), ..Brush::new(BrushType::SetHeight, 1.0, 0.25) };
    vec![
        stroke(raise(), &LOOP),
        stroke(wash(), &LOOP),
        stroke(ledge(), &LOOP[2..]),
        stroke(build_up(), &LOOP[..5]),
        Operation::Fill { brush: fill, seed: 0, region: SampleRect::new(30, 10, 300, 90) },
        stroke(roughen(), &LOOP),
        // Back over the first pages after all the others: their weights have been evicted, and come back.
        stroke(wash(), &[LOOP.as_slice(), LOOP.as_slice()].concat()),
    ]
}

/// What a stroke may do beside: chance, copies, pictures, gates, rests, noises that go with instances.
fn further_operations() -> Vec<Operation> {
    let brush = |brush_type, strength| Brush::new(brush_type, 24.0, strength);
    let alpha = |rotation| {
        let source = DataSource::File("a picture".to_owned());
        Some(Alpha { source, angle_deg: 10.0, rotation, is_mirrored: false })
    };
    let band = |min, max, feather| Some(Band { min, max, feather });
    let noise = |seeding, direction| Noise {
        feature_size_m: 40.0,
        octaves: 3,
        turbulence: Turbulence::Ridged,
        seeding,
        direction,
        normalization: Normalization::Off,
        ..Noise::default()
    };
    let follows = Some(NoiseDirection { angle_deg: 0.0, follows_stroke: true, stretch: 3.0 });
    let gate = Gate {
        slope_deg: band(10.0, 70.0, 30.0),
        height_m: band(-1.0e6, 1.0e6, 0.0),
        aspect: Some(AspectGate { angle_deg: 30.0, width_deg: 120.0, feather_deg: 40.0 }),
        noise: Some(NoiseGate {
            noise: noise(Seeding::World, None),
            band: Band { min: 0.0, max: 9.0, feather: 0.5 },
        }),
        ..Gate::default()
    };
    let gated = |brush: Brush| Brush { gate: Some(Box::new(gate.clone())), ..brush };
    let radial = Some(Symmetry { kind: SymmetryKind::Radial { count: 3 }, centre_m: [100.0, 75.0] });
    let resting: Vec<_> = LOOP.iter().chain(&LOOP[4..5]).copied().collect();
    let mut airbrush = stroke(Brush { is_airbrush: true, ..brush(BrushType::Raise, 9.0) }, &resting);
    if let Operation::Stroke(stroke) = &mut airbrush {
        for (index, point) in stroke.points.iter_mut().enumerate() {
            point.time_s = Some(index as f64 * 0.21);
        }
        let last = *stroke.points.last().unwrap();
        stroke.points.push(PointerSample { time_s: last.time_s.map(|time_s| time_s + 0.3), ..last });
    }
    let chance = Brush {
        jitter: Jitter { radius: 0.5, position: 0.8, strength: 0.5 },
        alpha: alpha(AlphaRotation::Random),
        symmetry: radial,
        ..brush(BrushType::Raise, 15.0)
    };
    let level = Brush { flow: 0.3, height_m: Some(120.0), ..gated(brush(BrushType::Level, 0.8)) };
    let stamp = Brush { alpha: alpha(AlphaRotation::Follow), ..brush(BrushType::Stamp, 0.9) };
    let steep = Gate { slope_deg: band(5.0, 40.0, 20.0), ..Gate::default() };
    let rough = Noise { roughness: Some(Box::new(steep)), ..noise(Seeding::World, None) };
    let tilted = Terrace { step_m: 9.0, sharpness: 0.4, tilt_deg: 5.0, tilt_direction_deg: 70.0 };
    vec![
        airbrush,
        stroke(chance, &LOOP[..4]),
        stroke(gated(brush(BrushType::Raise, 8.0)), &LOOP),
        stroke(level, &LOOP),
        stroke(stamp, &LOOP[..4]),
        stroke(Brush { terrace: tilted, ..brush(BrushType::Terrace, 0.7) }, &LOOP),
        stroke(brush(BrushType::Ramp, 0.6), &LOOP[1..4]),
        stroke(Brush { noise: noise(Seeding::Random, None), ..brush(BrushType::Noise, 20.0) }, &LOOP[..3]),
        stroke(Brush { noise: noise(Seeding::World, follows), ..brush(BrushType::Noise, 20.0) }, &LOOP),
        stroke(Brush { noise: rough, ..gated(brush(BrushType::Noise, 20.0)) }, &LOOP),
    ]
}

/// What looks at neighbours, over page borders and the terrain's.
fn neighbourhood_operations() -> Vec<Operation> {
    let smooth = |method, blending, width_m| Brush {
        smoothing: Smoothing { method, width_m: Some(width_m), ..Smoothing::default() },
        blending,
        ..Brush::new(BrushType::Smooth, 24.0, 0.7)
    };
    let steep = Gate { slope_deg: Some(Band { min: 5.0, max: 60.0, feather: 20.0 }), ..Gate::default() };
    let gated = Brush { gate: Some(Box::new(steep)), ..smooth(SmoothMethod::Gaussian, Blending::Wash, 9.0) };
    let sharpen = Brush {
        symmetry: Some(Symmetry { kind: SymmetryKind::Point, centre_m: [90.0, 80.0] }),
        ..Brush::new(BrushType::Sharpen, 18.0, 0.3)
    };
    let gate_of_hardness = gated.gate.clone();
    let clone = |blend, source| Brush {
        cloning: Cloning {
            source: CloneSource { at_m: [130.0, 20.0], to_m: Some([40.0, 70.0]), ..source },
            blend,
            ..Cloning::default()
        },
        ..Brush::new(BrushType::Clone, 18.0, 0.9)
    };
    let turned = CloneSource { rotation_deg: 25.0, scale: 0.4, is_mirrored: true, ..CloneSource::default() };
    let fixed = CloneSource { alignment: Alignment::Fixed, ..CloneSource::default() };
    let copies = Some(Symmetry { kind: SymmetryKind::Point, centre_m: [90.0, 80.0] });
    vec![
        stroke(clone(CloneBlend::Laplacian, CloneSource::default()), &LOOP),
        stroke(clone(CloneBlend::MeanShifted, turned.clone()), &LOOP[..4]),
        stroke(clone(CloneBlend::Feathered, fixed), &LOOP[2..]),
        stroke(Brush { symmetry: copies, ..Brush::new(BrushType::Grab, 40.0, 0.8) }, &LOOP[1..3]),
        Operation::Fill {
            brush: Brush { gate: gated.gate.clone(), ..clone(CloneBlend::Laplacian, turned) },
            seed: 0,
            region: SampleRect::new(50, 5, 140, 120),
        },
        stroke(smooth(SmoothMethod::Gaussian, Blending::BuildUp, 2.5), &LOOP),
        stroke(sharpen, &LOOP[..4]),
        stroke(gated, &LOOP),
        stroke(Brush::new(BrushType::Smear, 20.0, 0.8), &LOOP),
        stroke(smooth(SmoothMethod::Lattice, Blending::BuildUp, 4.0), &LOOP[1..]),
        Operation::Fill {
            brush: smooth(SmoothMethod::Gaussian, Blending::BuildUp, 21.0),
            seed: 0,
            region: SampleRect::new(30, 10, 190, 140),
        },
        stroke(
            Brush {
                thermal: Thermal { iterations: 12, ..Thermal::default() },
                hardness: gate_of_hardness.clone(),
                ..Brush::new(BrushType::ErodeThermal, 26.0, 0.6)
            },
            &LOOP,
        ),
        stroke(
            Brush {
                pipes: Pipes { iterations: 9, ..Pipes::default() },
                ..Brush::new(BrushType::ErodeFluvial, 26.0, 0.8)
            },
            &LOOP[2..],
        ),
        stroke(droplets(0.9), &LOOP),
        stroke(Brush { symmetry: copies, ..Brush::new(BrushType::FillPits, 30.0, 0.8) }, &LOOP[1..]),
        Operation::Fill { brush: droplets(0.7), seed: 9, region: SampleRect::new(20, 15, 195, 130) },
        stroke(
            smooth(SmoothMethod::Gaussian, Blending::Wash, 3.0),
            &[LOOP.as_slice(), LOOP.as_slice()].concat(),
        ),
    ]
}

fn droplets(strength: f64) -> Brush {
    let droplets = Droplets { per_sample: 0.2, max_steps: 20, ..Droplets::default() };
    Brush { droplets, ..Brush::new(BrushType::ErodeDroplets, 22.0, strength) }
}

fn ground() -> Plane {
    terrain::random(200, 150, 5)
}

fn painted(operations: &[Operation], executor: &mut dyn Executor, layout: PageLayout, feed: Feed) -> Plane {
    paint(&ground(), SPACING_M, operations, executor, layout, feed).unwrap().plane
}

fn layout(size: u32) -> PageLayout {
    PageLayout::new(size).unwrap()
}

/// Every way to feed; the first is the plainest.
fn feeds() -> Vec<Feed> {
    let mut feeds = Vec::new();
    for split in [Split::Whole, Split::TwoHalves, Split::SampleBySample] {
        for max_batch in [usize::MAX, 7, 1] {
            feeds.push(Feed { split, max_batch });
        }
    }
    assert_eq!(feeds[0], Feed::WHOLE);
    feeds
}

fn assert_equal(expected: &Plane, found: &Plane, what: &str) {
    compare::bit_equal(expected, found).unwrap_or_else(|mismatch| panic!("{what}: {mismatch}"));
}

/// `make` gives an executor for a page size and a budget in pages.
fn assert_no_split_matters(
    operations: &[Operation],
    make: impl Fn(PageLayout, u64) -> Box<dyn Executor>,
    feeds: &[Feed],
) {
    let mut num_runs = 0;
    let painted = |executor: &mut dyn Executor, layout, feed| painted(operations, executor, layout, feed);
    let expected = painted(&mut *make(layout(256), 1000), layout(256), Feed::WHOLE);
    assert!(compare::bit_equal(&ground(), &expected).is_err(), "nothing was painted");
    for (size, budget) in [(64, 4), (64, 1000), (256, 4), (256, 1000), (1024, 1000)] {
        // One executor for all feeds: what stays resident does not matter either.
        let mut executor = make(layout(size), if size == 1024 { 4 } else { budget });
        for feed in feeds {
            let found = painted(&mut *executor, layout(size), *feed);
            assert_equal(&expected, &found, &format!("pages of {size}, a budget of {budget}, {feed:?}"));
            num_runs += 1;
        }
        let again = painted(&mut *executor, layout(size), feeds[0]);
        assert_equal(&expected, &again, "the same once more");
    }
    assert_eq!(num_runs, 5 * feeds.len());
}

#[test]
fn on_the_cpu_with_one_thread() {
    let make = |layout, pages| Box::new(cpu_executor(layout, pages, 1)) as Box<dyn Executor>;
    assert_no_split_matters(&operations(), make, &feeds());
    assert_no_split_matters(&further_operations(), make, &feeds());
    assert_no_split_matters(&neighbourhood_operations(), make, &feeds());
}

#[test]
fn on_the_cpu_with_two_threads_and_the_same_as_with_one() {
    let make = |layout, pages| Box::new(cpu_executor(layout, pages, 2)) as Box<dyn Executor>;
    assert_no_split_matters(&operations(), make, &feeds()[..3]);
    for operations in [operations(), further_operations(), neighbourhood_operations()] {
        let [one, two] = [1, 2].map(|threads| {
            painted(&operations, &mut cpu_executor(layout(64), 1000, threads), layout(64), Feed::WHOLE)
        });
        assert_equal(&one, &two, "one thread and two");
    }
}

#[test]
fn on_the_gpu() {
    let gpu: Gpu = gpu();
    let make = |layout, pages| Box::new(gpu_executor(&gpu, layout, pages)) as Box<dyn Executor>;
    assert_no_split_matters(&operations(), make, &feeds());
    assert_no_split_matters(&further_operations(), make, &feeds()[..2]);
    assert_no_split_matters(&neighbourhood_operations(), make, &feeds()[..2]);
    gpu.check().unwrap();
}

#[test]
fn two_devices_give_the_same_bits() {
    let [one, two] = [gpu(), gpu()]
        .map(|gpu| painted(&operations(), &mut gpu_executor(&gpu, layout(64), 8), layout(64), Feed::WHOLE));
    assert_equal(&one, &two, "two devices");
}
