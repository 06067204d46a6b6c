//! Droplets, filled pits and masks of flow: the back ends against each other, and what holds for every region.

use orogeny_brush::{CpuExecutor, Executor};
use orogeny_field::hash::uniform;
use orogeny_field::{
    Blending, Brush, BrushType, Droplets, FieldId, FillPits, FlowMask, FlowRouting, PageKey, PageLayout,
    PointerSample, SampleRect, Stroke, TerrainGrid,
};
use orogeny_tests::{Feed, Operation, Plane, compare, paint, terrain};

use crate::agreement::{as_mask, back_ends_agree};

fn droplets(per_sample: f64) -> Brush {
    let droplets = Droplets { per_sample, max_steps: 20, ..Droplets::default() };
    Brush { droplets, ..Brush::new(BrushType::ErodeDroplets, 1.0, 1.0) }
}

fn fill_pits(slope_m: f32, max_depth_m: Option<f32>) -> Brush {
    let fill_pits = FillPits { slope_m, max_depth_m };
    Brush { fill_pits, ..Brush::new(BrushType::FillPits, 1.0, 1.0) }
}

fn flow_mask(flow_routing: FlowRouting, from_m2: f32, to_m2: f32) -> Brush {
    let flow_mask = FlowMask { from_m2, to_m2 };
    Brush { flow_routing, flow_mask, ..Brush::new(BrushType::FlowMask, 1.0, 1.0) }
}

fn brushes() -> Vec<(&'static str, Brush)> {
    vec![
        ("fill pits", fill_pits(0.0, None)),
        ("fill pits, sloped, build-up", Brush { blending: Blending::BuildUp, ..fill_pits(0.01, Some(50.0)) }),
        ("droplets", droplets(0.3)),
        ("droplets, wash", Brush { blending: Blending::Wash, ..droplets(1.0) }),
        ("flow mask", flow_mask(FlowRouting::Steepest, 2.0, 5000.0)),
        ("flow mask, shared", flow_mask(FlowRouting::shared(), 0.5, 1.0e6)),
    ]
}

back_ends_agree!(brushes, OneEach);

fn painted(ground: &Plane, spacing_m: f64, operation: Operation, page_size: u32) -> Plane {
    let layout = PageLayout::new(page_size).unwrap();
    let mut cpu = CpuExecutor::new(layout, 1 << 26, Some(2)).unwrap();
    paint(ground, spacing_m, &[operation], &mut cpu as &mut dyn Executor, layout, Feed::WHOLE).unwrap().plane
}

fn filled(ground: &Plane, spacing_m: f64, brush: Brush, region: SampleRect) -> Plane {
    painted(ground, spacing_m, Operation::Fill { brush, seed: 5, region }, 64)
}

/// Values that a brush may change: of the ground, or of a mask with its pattern.
fn canvas(ground: &Plane, brush: &Brush) -> Plane {
    if brush.brush_type.is_for_masks() { as_mask(ground) } else { ground.clone() }
}

fn whole(ground: &Plane) -> SampleRect {
    SampleRect::new(0, 0, ground.width().cast_signed(), ground.depth().cast_signed())
}

/// Samples within a region, but for its border, that have no neighbour as low as themselves.
fn num_pits(plane: &Plane, region: SampleRect) -> usize {
    let is_pit = |x: i32, z: i32| {
        let at = |x: i32, z: i32| plane.at(x.cast_unsigned(), z.cast_unsigned());
        let mut around =
            (-1..=1).flat_map(|dz| (-1..=1).map(move |dx| (dx, dz))).filter(|way| *way != (0, 0));
        around.all(|(dx, dz)| at(x + dx, z + dz) > at(x, z))
    };
    let places =
        (region.z0 + 1..region.z1 - 1).flat_map(|z| (region.x0 + 1..region.x1 - 1).map(move |x| (x, z)));
    places.filter(|(x, z)| is_pit(*x, *z)).count()
}

#[test]
fn a_filled_region_has_no_pit_and_all_else_keeps_its_bits() {
    let ground = Plane::from_fn(150, 130, |x, z| 0.1 * x as f32 + 5.0 * uniform(x, z, 3));
    let region = SampleRect::new(20, 10, 140, 115);
    assert!(num_pits(&ground, region) > 100);
    for slope_m in [0.0, 0.01] {
        let after = filled(&ground, 1.0, fill_pits(slope_m, None), region);
        assert_eq!(num_pits(&after, region), 0, "with a slope of {slope_m} m");
        for z in 0..130 {
            for x in 0..150 {
                let (before, after) = (ground.at(x, z), after.at(x, z));
                let is_inside = (21..139).contains(&x) && (11..114).contains(&z);
                assert!(
                    if is_inside { after >= before } else { after.to_bits() == before.to_bits() },
                    "{x}, {z}"
                );
            }
        }
    }
}

#[test]
fn no_size_of_pages_and_no_way_to_feed_changes_a_bit() {
    let ground = terrain::real(300, 280, 100, 400);
    let region = SampleRect::new(17, 30, 290, 270);
    let points: Vec<_> =
        [[50.0, 60.0], [140.0, 200.0], [220.0, 90.0]].map(|[x, z]| PointerSample::at(x, z)).into();
    for (name, brush) in brushes() {
        let ground = canvas(&ground, &brush);
        let dab = Brush { radius_m: 40.0, falloff_m: 30.0, ..brush.clone() };
        for operation in [
            Operation::Fill { brush, seed: 5, region },
            Operation::Stroke(Stroke { brush: dab, seed: 5, points: points.clone() }),
        ] {
            let first = painted(&ground, 1.0, operation.clone(), 64);
            assert!(compare::bit_equal(&ground, &first).is_err(), "{name} changes nothing");
            for page_size in [256, 512] {
                let other = painted(&ground, 1.0, operation.clone(), page_size);
                compare::bit_equal(&first, &other).unwrap_or_else(|err| panic!("{name}, {page_size}: {err}"));
            }
        }
    }
}

/// A valley along z that falls to the south, 20 m on either side of its line.
fn valley() -> Plane {
    Plane::from_fn(201, 300, |x, z| 2.0 * (x as f32 - 100.0).abs() - 0.1 * z as f32)
}

#[test]
fn a_flow_mask_is_1_along_a_valley_and_0_on_its_ridge() {
    let layout = PageLayout::new(64).unwrap();
    let (ground, mask, heights) = (valley(), FieldId(2), FieldId(1));
    let brush = flow_mask(FlowRouting::Steepest, 500.0, 10_000.0);
    let mut store = ground.to_pages(layout, heights);
    let canvas = orogeny_brush::Canvas {
        field: mask,
        is_mask: true,
        ..orogeny_brush::Canvas::heights(TerrainGrid::new(201, 300, 1.0).unwrap(), layout, heights)
    };
    let resources = orogeny_brush::Resources::default();
    let batch = orogeny_brush::plan_fill(&brush, 0, canvas, resources, whole(&ground), &mut store).unwrap();
    let mut cpu = CpuExecutor::new(layout, 1 << 26, Some(2)).unwrap();
    for piece in batch.split(layout, 4) {
        cpu.run(&piece, &mut store).unwrap();
    }
    cpu.finish(&mut store).unwrap();
    let of_field = |field, x: u32, z: u32| {
        let page = &store.pages_unsorted()[&PageKey::full_resolution(field, x / 64, z / 64)];
        page.row(z % 64, x % 64, x % 64 + 1).unwrap()[0]
    };
    let after = Plane::from_fn(201, 300, |x, z| of_field(mask, x, z));
    for z in 0..299 {
        // 200 m² a metre of the valley: 500 m² after two, 10,000 m² after 50.
        let line = after.at(100, z);
        let expected = if z >= 52 { 1.0 } else { line };
        assert_eq!(line, expected, "{z}");
        assert!(z < 4 || line > 0.0, "{z}: {line}");
        for x in [1, 20, 60, 140, 199] {
            assert_eq!(after.at(x, z), 0.0, "{x}, {z}");
        }
    }
    let heights_after = Plane::from_fn(201, 300, |x, z| of_field(heights, x, z));
    compare::bit_equal(&ground, &heights_after).unwrap();
}

#[test]
fn droplets_keep_all_rock_and_give_the_same_bits_twice() {
    let ground = terrain::real(210, 190, 300, 200);
    let brush = Brush { droplets: Droplets::default(), ..Brush::new(BrushType::ErodeDroplets, 1.0, 1.0) };
    let after = filled(&ground, 10.0, brush.clone(), whole(&ground));
    let total = |plane: &Plane| plane.samples().iter().map(|height| f64::from(*height)).sum::<f64>();
    let lowest = ground.samples().iter().fold(f64::MAX, |lowest, height| lowest.min(f64::from(*height)));
    let mass = total(&ground) - lowest * 210.0 * 190.0;
    let change = (total(&after) - total(&ground)).abs() / mass;
    assert!(change < 1.0e-3, "{change} of the mass");
    let moved = after.samples().iter().zip(ground.samples()).filter(|(a, b)| (*a - *b).abs() > 0.2).count();
    assert!(moved > 2000, "{moved} samples moved");
    compare::bit_equal(&after, &filled(&ground, 10.0, brush.clone(), whole(&ground))).unwrap();
    let other = painted(&ground, 10.0, Operation::Fill { brush, seed: 6, region: whole(&ground) }, 64);
    assert!(compare::bit_equal(&after, &other).is_err(), "another seed changes nothing");
}

#[test]
fn a_stroke_changes_only_what_it_reaches() {
    let ground = terrain::real(200, 180, 50, 60);
    for (name, brush) in brushes() {
        let ground = canvas(&ground, &brush);
        let brush = Brush { radius_m: 30.0, falloff_m: 20.0, ..brush };
        let points = vec![PointerSample::at(90.0, 80.0)];
        let after = painted(&ground, 1.0, Operation::Stroke(Stroke { brush, seed: 0, points }), 64);
        let mut num_changed = 0;
        for z in 0..180_u32 {
            for x in 0..200_u32 {
                let distance = (f64::from(x) - 90.0).hypot(f64::from(z) - 80.0);
                let is_changed = ground.at(x, z).to_bits() != after.at(x, z).to_bits();
                assert!(distance < 30.0 || !is_changed, "{name}: {x}, {z}");
                num_changed += usize::from(is_changed);
            }
        }
        assert!(num_changed > 5, "{name}: {num_changed}");
    }
}

#[test]
fn a_region_of_too_many_samples_is_refused_with_their_number() {
    let layout = PageLayout::default();
    let grid = TerrainGrid::new(1 << 14, 1 << 14, 1.0).unwrap();
    let canvas = orogeny_brush::Canvas::heights(grid, layout, FieldId(1));
    for (_, brush) in brushes() {
        let mut store = orogeny_pages::MemoryPages::new(layout, 0.0);
        let mut plan = |region| {
            orogeny_brush::plan_fill(
                &brush,
                0,
                canvas,
                orogeny_brush::Resources::default(),
                region,
                &mut store,
            )
        };
        let err = plan(grid.bounds()).unwrap_err().to_string();
        for word in [brush.brush_type.name(), "268435456", "67108864", "`region`"] {
            assert!(err.contains(word), "{err}");
        }
        plan(SampleRect::new(0, 0, 1 << 13, 1 << 13)).unwrap();
    }
}
