//! Erosion: the back ends against each other, and what holds for every simulation.

use orogeny_brush::{CpuExecutor, Executor};
use orogeny_field::{
    Band, Blending, Brush, BrushType, Gate, PageLayout, Pipes, PointerSample, RainMask, RainShows, RockLayer,
    SampleRect, Stroke, Thermal,
};
use orogeny_tests::{Feed, Operation, Plane, paint, terrain};

use crate::agreement::back_ends_agree;

fn thermal(iterations: u32, layers: Vec<RockLayer>) -> Brush {
    Brush { thermal: Thermal { layers, iterations }, ..Brush::new(BrushType::ErodeThermal, 1.0, 1.0) }
}

fn rock(from_m: f64, talus_angle_deg: f64, rate: f64) -> RockLayer {
    RockLayer { from_m, talus_angle_deg, rate }
}

fn fluvial(iterations: u32) -> Brush {
    let pipes = Pipes { iterations, ..Pipes::default() };
    Brush { pipes, ..Brush::new(BrushType::ErodeFluvial, 1.0, 1.0) }
}

/// Harder the higher it is, and where it is steep.
fn hard(brush: Brush) -> Brush {
    let band = |min, max, feather| Some(Band { min, max, feather });
    let gate =
        Gate { height_m: band(300.0, 1.0e6, 400.0), slope_deg: band(0.0, 40.0, 30.0), ..Gate::default() };
    Brush { hardness: Some(Box::new(gate)), ..brush }
}

fn rain_mask(shows: RainShows, to_m: f64) -> Brush {
    let rain_mask = RainMask { shows, from_m: 0.0, to_m };
    let pipes = Pipes { iterations: 10, ..Pipes::default() };
    Brush { rain_mask, pipes, ..Brush::new(BrushType::RainMask, 1.0, 1.0) }
}

fn brushes() -> Vec<(&'static str, Brush)> {
    vec![
        ("thermal", thermal(10, vec![rock(0.0, 30.0, 0.25)])),
        ("thermal, wash", Brush { blending: Blending::Wash, ..thermal(7, vec![rock(0.0, 5.0, 0.2)]) }),
        (
            "thermal, three layers",
            thermal(5, vec![rock(0.0, 40.0, 0.25), rock(100.0, 10.0, 0.1), rock(800.0, 60.0, 0.2)]),
        ),
        ("fluvial", fluvial(10)),
        ("thermal, hard above", hard(thermal(6, vec![rock(0.0, 10.0, 0.25)]))),
        ("fluvial, hard above", hard(fluvial(8))),
        ("rain mask, water", rain_mask(RainShows::Water, 0.05)),
        ("rain mask, wear", rain_mask(RainShows::Wear, 0.001)),
    ]
}

back_ends_agree!(brushes, OneEach);

fn painted(ground: &Plane, spacing_m: f64, operation: Operation, page_size: u32) -> Plane {
    let layout = PageLayout::new(page_size).unwrap();
    let mut cpu = CpuExecutor::new(layout, 1 << 26, Some(2)).unwrap();
    paint(ground, spacing_m, &[operation], &mut cpu as &mut dyn Executor, layout, Feed::WHOLE).unwrap().plane
}

fn filled(ground: &Plane, spacing_m: f64, brush: Brush) -> Plane {
    painted(
        ground,
        spacing_m,
        Operation::Fill { brush, seed: 0, region: SampleRect::new(0, 0, 9000, 9000) },
        64,
    )
}

fn total(plane: &Plane) -> f64 {
    plane.samples().iter().map(|height| f64::from(*height)).sum()
}

fn lowest(plane: &Plane) -> f64 {
    plane.samples().iter().fold(f64::MAX, |lowest, height| lowest.min(f64::from(*height)))
}

#[test]
fn a_fill_keeps_all_rock() {
    let ground = terrain::real(210, 190, 300, 200);
    for (name, brush) in [("thermal", thermal(100, vec![rock(0.0, 20.0, 0.25)])), ("fluvial", fluvial(100))] {
        // Full strength: what a fill blends by is its strength, with nothing of a pass about it.
        let after = filled(&ground, 10.0, brush);
        let (mass, limit) = (
            total(&ground) - lowest(&ground) * 210.0 * 190.0,
            if name == "thermal" { 1.0e-5 } else { 1.0e-3 },
        );
        let change = (total(&after) - total(&ground)).abs() / mass;
        assert!(change < limit, "{name}: {change} of the mass");
        let moved =
            after.samples().iter().zip(ground.samples()).filter(|(a, b)| (*a - *b).abs() > 0.5).count();
        assert!(moved > 500, "{name}: {moved} samples moved");
    }
}

#[test]
fn thermal_erosion_leaves_no_slope_above_its_angle_and_makes_no_new_extremum() {
    let ground =
        Plane::from_fn(
            32,
            32,
            |x, z| if (10..20).contains(&x) && (12..22).contains(&z) { 20.0 } else { 0.0 },
        );
    let talus = 45.0;
    let after = filled(&ground, 1.0, thermal(1000, vec![rock(0.0, talus, 0.25)]));
    let mut steepest: f32 = 0.0;
    for z in 0..32 {
        for x in 0..31 {
            steepest = steepest.max((after.at(x, z) - after.at(x + 1, z)).abs());
            steepest = steepest.max((after.at(z, x) - after.at(z, x + 1)).abs());
        }
    }
    assert!((0.9..=1.03).contains(&steepest), "{steepest} taluses");
    assert!(after.samples().iter().all(|height| (0.0..=20.0).contains(height)));
}

/// What lies within the stroke is as though the whole terrain had eroded; what lies beyond keeps its bits.
#[test]
fn a_brush_shows_a_part_of_what_the_whole_terrain_would_become() {
    let ground = terrain::real(300, 280, 100, 400);
    for brush in [thermal(40, vec![rock(0.0, 15.0, 0.25)]), fluvial(40)] {
        let all = filled(&ground, 10.0, brush.clone());
        let dab = Brush { radius_m: 600.0, falloff_m: 100.0, ..brush };
        let points = vec![PointerSample::at(1400.0, 1300.0)];
        let stroke = Operation::Stroke(Stroke { brush: dab, seed: 0, points });
        for page_size in [64, 256, 512] {
            let after = painted(&ground, 10.0, stroke.clone(), page_size);
            for z in 0..280 {
                for x in 0..300 {
                    let distance = (f64::from(x) - 140.0).hypot(f64::from(z) - 130.0);
                    let (before, here, whole) = (ground.at(x, z), after.at(x, z), all.at(x, z));
                    if distance < 49.9 {
                        assert_eq!(here.to_bits(), whole.to_bits(), "{x}, {z}");
                    } else if distance >= 60.0 {
                        assert_eq!(here.to_bits(), before.to_bits(), "{x}, {z}");
                    }
                }
            }
        }
    }
}

/// What is wholly hard keeps its bits, whatever slides or runs down beside it lies on it.
#[test]
fn nothing_is_taken_of_what_is_hard() {
    let ground = terrain::real(160, 150, 120, 420);
    let (lowest, highest) = ground
        .samples()
        .iter()
        .fold((f32::MAX, f32::MIN), |(low, high), height| (low.min(*height), high.max(*height)));
    let middle = f64::from(lowest + highest) / 2.0;
    let above = Gate { height_m: Some(Band { min: middle, max: 1.0e6, feather: 0.0 }), ..Gate::default() };
    for brush in [thermal(60, vec![rock(0.0, 10.0, 0.25)]), fluvial(60)] {
        let name = brush.brush_type.name();
        let soft = filled(&ground, 10.0, brush.clone());
        let hard = filled(&ground, 10.0, Brush { hardness: Some(Box::new(above.clone())), ..brush });
        let (mut num_worn, mut num_spared) = (0, 0);
        for (before, (soft, hard)) in ground.samples().iter().zip(soft.samples().iter().zip(hard.samples())) {
            if f64::from(*before) >= middle {
                assert!(hard >= before, "{name}: {before} m became {hard} m");
                num_worn += usize::from(soft < before);
                num_spared += usize::from(hard == before);
            }
        }
        assert!(num_worn > 1000 && num_spared > 1000, "{name}: {num_worn} were worn, {num_spared} spared");
    }
}
