//! The reference against what NumPy makes of the specification (`fixtures/brush/make.py`), in `f64`.

use orogeny_brush::{CpuExecutor, CurveSegment, Pen, Spacing, StrokeSampler};
use orogeny_field::{
    Brush, Falloff, FieldId, PageLayout, PointerSample, Profile, ProfileShape, Stroke, TerrainGrid,
};
use orogeny_reference::{falloff, hash};
use orogeny_tests::{Feed, Operation, Plane, Reach, compare, paint, plan, repository};
use serde_json::Value;

fn fixture(name: &str) -> Value {
    let path = repository().join("tests/fixtures/brush").join(name);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|err| panic!("{}: {err}", path.display()));
    serde_json::from_str(&text).unwrap()
}

fn array(value: &Value) -> &[Value] {
    let array = value.as_array().unwrap();
    assert!(!array.is_empty(), "an empty fixture proves nothing");
    array
}

fn numbers(value: &Value) -> Vec<f64> {
    array(value).iter().map(|number| number.as_f64().unwrap()).collect()
}

fn profile(case: &Value) -> Profile {
    let parameter = case["parameter"].as_f64().unwrap();
    let shape = match case["profile"].as_str().unwrap() {
        "linear" => ProfileShape::Linear,
        "smooth" => ProfileShape::Smooth,
        "sphere" => ProfileShape::Sphere,
        "tip" => ProfileShape::Tip,
        "gauss" => ProfileShape::Gauss,
        "power" => ProfileShape::Power { power: parameter },
        "sigmoid" => ProfileShape::Sigmoid { steepness: parameter },
        other => panic!("no profile `{other}`"),
    };
    Profile { shape, falloff_ratio: case["falloff_ratio"].as_f64().unwrap() }
}

#[test]
fn weights_match() {
    let fixture = fixture("falloff.json");
    let places = numbers(&fixture["r"]);
    let mut worst: f64 = 0.0;
    for case in array(&fixture["cases"]) {
        let profile = profile(case);
        let falloff = Falloff::from(profile.clone());
        let weights = numbers(&case["weights"]);
        assert_eq!(weights.len(), places.len());
        for (r, expected) in places.iter().zip(weights) {
            let found = f64::from(falloff::weight(*r as f32, &falloff));
            // `1 - r` is rounded to half a unit in the last place of 1, and a slope of F = 0.3 R magnifies that. Where a root
            // has its vertical tangent, at a sphere's edge and a tip's point, it is magnified without end.
            let is_steep = match profile.shape {
                ProfileShape::Sphere => expected < 0.05,
                ProfileShape::Tip => expected > 0.99,
                _ => false,
            };
            let tolerance = f64::from(f32::EPSILON) * if is_steep { 160.0 } else { 8.0 };
            let distance = (found - expected).abs();
            worst = worst.max(distance / tolerance);
            assert!(distance <= tolerance, "{profile:?} at {r}: NumPy {expected}, found {found}");
        }
    }
    println!("weights: worst {worst:.3} of the tolerance");
}

#[test]
fn integrals_of_the_profiles_match() {
    for case in array(&fixture("falloff.json")["cases"]) {
        let profile = profile(case);
        let expected = case["integral"].as_f64().unwrap();
        let spacing = Spacing::new(&profile, 1000.0, 0.25);
        // `share` is the spacing over the integral.
        let found = spacing.distance / 1000.0 / spacing.share;
        assert!((found / expected - 1.0).abs() < 1.0e-6, "{profile:?}: NumPy {expected}, found {found}");
    }
}

#[test]
fn hashes_match() {
    let fixture = fixture("hash.json");
    let rows = array(&fixture);
    for row in rows {
        let [x, z, seed, expected] =
            [0, 1, 2, 3].map(|place| u32::try_from(row[place].as_u64().unwrap()).unwrap());
        assert_eq!(hash::hash(x, z, seed), expected, "hash({x}, {z}, {seed})");
        let uniform = row[4].as_f64().unwrap();
        assert_eq!(f64::from(hash::uniform(x, z, seed)), uniform, "uniform({x}, {z}, {seed})");
        assert_eq!(f64::from(hash::signed_uniform(x, z, seed)), 2.0 * uniform - 1.0);
    }
    assert!(rows.len() >= 60);
}

#[test]
fn arc_lengths_and_the_places_of_instances_match() {
    for case in array(&fixture("curve.json")) {
        let points: Vec<[f64; 2]> =
            array(&case["points"]).iter().map(|point| numbers(point).try_into().unwrap()).collect();
        let lengths = numbers(&case["lengths"]);
        assert_eq!(lengths.len(), points.len() - 1);
        let total: f64 = lengths.iter().sum();
        for (index, expected) in lengths.iter().enumerate() {
            let before = index.checked_sub(1).map(|before| points[before]);
            let after = points.get(index + 2).copied();
            let segment = CurveSegment::new(before, points[index], points[index + 1], after);
            let found = segment.length();
            // The specification asks for 1 %.
            assert!(
                (found / expected - 1.0).abs() < 5.0e-4,
                "piece {index}: NumPy {expected}, found {found}"
            );
        }

        let spacing = case["spacing"].as_f64().unwrap();
        let mut sampler = StrokeSampler::new(spacing, spacing);
        for point in points {
            sampler.push(point, Pen::FULL, None).unwrap();
        }
        sampler.finish();
        let expected = array(&case["places"]);
        for (index, expected) in expected.iter().enumerate() {
            let [x, z]: [f64; 2] = numbers(expected).try_into().unwrap();
            let [found_x, found_z] = sampler.next_place().unwrap().unwrap().position;
            let distance = (found_x - x).hypot(found_z - z);
            assert!(distance < 5.0e-4 * total, "place {index}: {distance} from NumPy's, of {total}");
        }
        assert_eq!(sampler.next_place().unwrap(), None);
    }
}

/// A whole stroke, from pointer samples to pages on the CPU, within the tolerance between back ends and what the `f32`
/// fractions of an instance's place lose.
pub fn assert_stroke_matches(name: &str) {
    let fixture = fixture("strokes.json");
    let case = &fixture["cases"][name];
    let size = ["width", "depth"].map(|side| u32::try_from(fixture[side].as_u64().unwrap()).unwrap());
    let plane = |heights: &Value| {
        Plane::new(size[0], size[1], numbers(heights).into_iter().map(|height| height as f32).collect())
    };
    let (before, expected) = (plane(&fixture["ground"]), plane(&case["heights"]));
    let spacing_m = fixture["spacing_m"].as_f64().unwrap();

    let mut brush = case["stroke"].as_object().unwrap_or_else(|| panic!("no stroke `{name}`")).clone();
    let points: Vec<PointerSample> = serde_json::from_value(brush.remove("points").unwrap()).unwrap();
    let seed = u32::try_from(brush.remove("seed").unwrap().as_u64().unwrap()).unwrap();
    let stroke = Stroke { brush: Brush::from_json(&brush).unwrap(), seed, points };
    let (strength, operation) = (stroke.brush.strength, Operation::Stroke(stroke));

    let layout = PageLayout::new(64).unwrap();
    let grid = TerrainGrid::new(size[0].into(), size[1].into(), spacing_m).unwrap();
    let mut store = before.to_pages(layout, FieldId(0));
    let batches = plan(&operation, &grid, FieldId(0), &mut store, Feed::WHOLE).unwrap();
    let reach = Reach::of(&batches, &before);
    assert!(reach.most_instances() > 5, "{name}: {}", reach.most_instances());

    let mut cpu = CpuExecutor::new(layout, 1 << 24, Some(1)).unwrap();
    let painted = paint(&before, spacing_m, &[operation], &mut cpu, layout, Feed::WHOLE).unwrap();
    let agreement = compare::within(&expected, &painted.plane, |x, z| {
        let mut tolerance = reach.tolerance(x, z, before.at(x, z), expected.at(x, z));
        // Where an instance lies along the curve is solved for to about 1e-6 of a radius; an edge may be seen either way.
        tolerance.absolute_m += 3.0e-6 * strength.max(40.0);
        tolerance
    });
    let agreement = agreement.unwrap_or_else(|mismatch| panic!("{name}: {mismatch}"));
    assert!(compare::bit_equal(&before, &painted.plane).is_err(), "{name}: nothing was painted");
    println!("{name}: worst {:.3} of the tolerance", agreement.worst.share());
}
