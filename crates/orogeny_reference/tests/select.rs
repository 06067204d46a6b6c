//! Selections: against SciPy, scikit-image and Matplotlib (`tests/fixtures/select/make.py`), and what holds for all of them.

#![allow(
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test that goes wrong is to fail"
)]

use orogeny_field::{Plane, SampleRect, hash, mirrored};
use orogeny_reference::select::lasso::Lasso;
use orogeny_reference::select::{feather, grow};
use serde_json::Value;

fn plane(rect: SampleRect, value: impl Fn(i32, i32) -> f32) -> Plane {
    let rows = (rect.z0..rect.z1).flat_map(|z| (rect.x0..rect.x1).map(move |x| (x, z)));
    Plane::from_samples(rect, 1, rows.map(|(x, z)| value(x, z)).collect()).unwrap()
}

/// The plane with so many samples more on each side, mirrored at its border; it begins at sample (0, 0).
fn mirrored_around(inner: &Plane, margin: u32) -> Plane {
    let rect = inner.rect();
    let at = |x: i32, z: i32| inner.at(mirrored(x, rect.width()), mirrored(z, rect.depth())).unwrap();
    plane(rect.grown(margin as i32), at)
}

fn grown(plane: &Plane, radius: f64) -> Plane {
    grow::grown(&mirrored_around(plane, grow::reach(radius)), radius)
}

fn shrunk(plane: &Plane, radius: f64) -> Plane {
    grow::shrunk(mirrored_around(plane, grow::reach(radius)), radius)
}

fn feathered(plane: &Plane, sigma: f64) -> Plane {
    feather::feathered(&mirrored_around(plane, feather::reach(sigma)), sigma)
}

/// Hard spots, soft spots, or both.
fn spots(rect: SampleRect, seed: u32, share: f32, is_soft: bool) -> Plane {
    plane(rect, |x, z| {
        let random = |salt: u32| hash::uniform(x as u32, z as u32, seed + salt).abs();
        let is_whole = !is_soft || random(1) < 0.3;
        if random(0) > share { 0.0 } else { if is_whole { 1.0 } else { random(2) } }
    })
}

fn fixture() -> Value {
    serde_json::from_str(include_str!("../../../tests/fixtures/select/select.json")).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}

#[test]
fn selections_are_grown_shrunk_and_feathered_as_by_scipy() {
    let document = fixture();
    let unit = document["unit"].as_f64().unwrap();
    let mut num_results = 0;
    for case in document["cases"].as_array().unwrap() {
        let [width, depth] = ["width", "depth"].map(|name| case[name].as_u64().unwrap() as i32);
        let values = numbers(&case["values"]).into_iter().map(|value| (value / unit) as f32).collect();
        let source = Plane::from_samples(SampleRect::new(0, 0, width, depth), 1, values).unwrap();
        for (radius, expected) in numbers(&case["radii"]).into_iter().zip(case["results"].as_array().unwrap())
        {
            let kind = case["kind"].as_str().unwrap();
            let (found, scale, tolerance) = match kind {
                "grow" => (grown(&source, radius), unit, 0.0),
                "shrink" => (shrunk(&source, radius), unit, 0.0),
                "feather" => (feathered(&source, radius), 1.0, 1.0e-6),
                other => panic!("`{other}`"),
            };
            assert_eq!(found.rect(), source.rect());
            let expected = numbers(expected);
            assert_eq!(expected.len(), found.samples().len());
            for (place, (found, expected)) in found.samples().iter().zip(expected).enumerate() {
                let error = (f64::from(*found) - expected / scale).abs();
                assert!(error <= tolerance, "{kind} by {radius}, sample {place}: {found}, off by {error}");
            }
            num_results += 1;
        }
    }
    assert_eq!(num_results, 8 * 7 + 2 * 3);
}

#[test]
fn polygons_are_those_of_scikit_image_and_matplotlib() {
    let document = fixture();
    let polygons = document["polygons"].as_array().unwrap();
    assert_eq!(polygons.len(), 5);
    for polygon in polygons {
        let points: Vec<[f64; 2]> = polygon["points"]
            .as_array()
            .unwrap()
            .iter()
            .map(|point| [numbers(point)[0], numbers(point)[1]])
            .collect();
        let mut found = Plane::constant(SampleRect::new(0, 0, 40, 32), 0.0);
        let lasso = Lasso::new(&points);
        lasso.fill(&mut found);
        for (z, row) in (0..).zip(polygon["rows"].as_array().unwrap()) {
            let row_found: String =
                found.row(z).unwrap().iter().map(|value| if *value == 1.0 { '#' } else { '.' }).collect();
            assert_eq!(row_found, row.as_str().unwrap(), "row {z} of {points:?}");
            let bounds = lasso.bounds();
            let is_inside = |x: i32| bounds.contains(&SampleRect::new(x, z, x + 1, z + 1));
            assert!((0..40).all(|x| is_inside(x) || found.at(x, z) == Some(0.0)));
        }
        // From the last point to the first, and beginning elsewhere, it is the same polygon.
        let mut other_way = points.clone();
        other_way.reverse();
        other_way.rotate_left(1);
        let mut again = Plane::constant(found.rect(), 0.0);
        Lasso::new(&other_way).fill(&mut again);
        assert_eq!(again, found);
    }
}

/// Every sample by the definition.
fn by_definition(source: &Plane, radius: f64, rect: SampleRect, better: fn(f32, f32) -> f32) -> Plane {
    let reach = radius as i32;
    plane(rect, |x, z| {
        let offsets = (-reach..=reach).flat_map(|dz| (-reach..=reach).map(move |dx| (dx, dz)));
        let within = offsets.filter(|(dx, dz)| f64::from(dx * dx + dz * dz) <= radius * radius);
        within.map(|(dx, dz)| source.at(x + dx, z + dz).unwrap()).reduce(better).unwrap()
    })
}

#[test]
fn growing_is_the_largest_and_shrinking_the_smallest_value_within_the_radius() {
    let rect = SampleRect::new(-30, 12, 370, 90);
    for (seed, (share, is_soft)) in (0..).zip([
        (0.0, false),
        (0.003, false),
        (0.003, true),
        (0.5, true),
        (0.997, false),
        (1.0, true),
        (1.0, false),
    ]) {
        let source = spots(rect, 10 * seed, share, is_soft);
        for radius in [0.0, 0.9, 1.0, 3.7, 12.0, 20.0] {
            let found = grow::grown(&source, radius);
            assert_eq!(found.rect(), rect.grown(-(radius as i32)));
            assert_eq!(found, by_definition(&source, radius, found.rect(), f32::max), "{share}, {radius}");
            let found = grow::shrunk(source.clone(), radius);
            assert_eq!(found, by_definition(&source, radius, found.rect(), f32::min), "{share}, {radius}");
        }
    }
}

/// By the bits: both zeros are told apart.
fn assert_part(part: &Plane, whole: &Plane, what: &str) {
    let rect = part.rect();
    assert!(!rect.is_empty() && whole.rect().contains(&rect));
    for z in rect.z0..rect.z1 {
        for x in rect.x0..rect.x1 {
            let (a, b) = (part.at(x, z).unwrap(), whole.at(x, z).unwrap());
            assert_eq!(a.to_bits(), b.to_bits(), "{what}: {x}, {z}: {a} and {b}");
        }
    }
}

fn part_of(source: &Plane, rect: SampleRect) -> Plane {
    plane(rect, |x, z| source.at(x, z).unwrap())
}

#[test]
fn a_part_has_the_bits_of_the_whole() {
    let rect = SampleRect::new(5, -40, 805, 110);
    let source = spots(rect, 3, 0.02, true);
    let star = [[20.0, 3.5], [700.0, 44.0], [31.5, -38.0], [400.0, 90.0], [733.3, -20.0]];
    let lasso = Lasso::new(&star);
    let mut whole_lasso = Plane::constant(rect, 0.0);
    lasso.fill(&mut whole_lasso);
    for part in [(5, -40, 100, 60), (300, -30, 700, 110), (450, 0, 560, 80)] {
        let part = SampleRect::new(part.0, part.1, part.2, part.3);
        let piece = part_of(&source, part);
        for amount in [1.0, 4.5, 17.0] {
            assert_part(&grow::grown(&piece, amount), &grow::grown(&source, amount), "grown");
            let shrunk = grow::shrunk(source.clone(), amount);
            assert_part(&grow::shrunk(piece.clone(), amount), &shrunk, "shrunk");
            let sigma = amount / 2.0;
            assert_part(&feather::feathered(&piece, sigma), &feather::feathered(&source, sigma), "feathered");
        }
        let mut piece = Plane::constant(part, 0.0);
        lasso.fill(&mut piece);
        assert_part(&piece, &whole_lasso, "lasso");
    }
}

#[test]
fn every_contour_moves_and_a_soft_edge_keeps_its_width() {
    let rect = SampleRect::new(0, 0, 120, 5);
    // Ten samples from everything to nothing.
    let edge = plane(rect, |x, _| (1.0 - (x - 50) as f32 / 10.0).clamp(0.0, 1.0));
    for radius in [1, 7, 30] {
        let (grown, shrunk) = (grown(&edge, f64::from(radius)), shrunk(&edge, f64::from(radius)));
        for x in 0..120 {
            assert_eq!(grown.at(x, 2), edge.at((x - radius).max(0), 2));
            assert_eq!(shrunk.at(x, 2), edge.at((x + radius).min(119), 2));
        }
    }
    // What is shrunk and grown again is within what it was, and the other way round.
    let source = spots(SampleRect::new(0, 0, 90, 70), 8, 0.4, true);
    let opened = grown(&shrunk(&source, 2.5), 2.5);
    let closed = shrunk(&grown(&source, 2.5), 2.5);
    for ((value, opened), closed) in source.samples().iter().zip(opened.samples()).zip(closed.samples()) {
        assert!(opened <= value && value <= closed);
    }
}

#[test]
fn a_feather_keeps_what_is_level_and_stays_within_its_values() {
    for level in [0.0, 0.3, 1.0] {
        let source = Plane::constant(SampleRect::new(0, 0, 700, 70), level);
        assert!(feather::feathered(&source, 6.3).samples().iter().all(|value| *value == level));
    }
    let source = spots(SampleRect::new(0, 0, 400, 90), 4, 0.5, true);
    let soft = feather::feathered(&source, 8.0);
    assert_eq!(soft.rect(), source.rect().grown(-(feather::reach(8.0) as i32)));
    assert!(soft.samples().iter().all(|value| (0.0..=1.0).contains(value)));
    assert_eq!(feather::feathered(&source, 0.0), source);
}

#[test]
fn a_polygon_around_a_rectangle_has_its_samples_and_neighbours_share_none() {
    let rect = SampleRect::new(0, 0, 30, 20);
    let filled = |points: &[[f64; 2]]| {
        let mut plane = Plane::constant(rect, 0.0);
        Lasso::new(points).fill(&mut plane);
        plane
    };
    let around = |x0: f64, z0: f64, x1: f64, z1: f64| [[x0, z0], [x1, z0], [x1, z1], [x0, z1]];
    // Near edges on a sample are inside, also where rounding left them a little beyond it; far ones are not.
    let found = filled(&around(3.0 + 1.0e-9, 2.0, 11.0, 7.0 + 1.0e-9));
    assert_eq!(
        found,
        plane(rect, |x, z| if (3..11).contains(&x) && (2..7).contains(&z) { 1.0 } else { 0.0 })
    );
    assert_eq!(Lasso::new(&around(3.0, 2.0, 11.0, 7.0)).bounds(), SampleRect::new(3, 2, 11, 7));
    // Triangles around a point, through samples and between them.
    let ring: Vec<[f64; 2]> =
        vec![[0.0, 0.0], [29.0, 0.0], [29.0, 9.5], [22.0, 19.0], [7.3, 19.0], [0.0, 12.0]];
    let whole = filled(&ring);
    let mut sum = vec![0.0; whole.samples().len()];
    for (place, point) in ring.iter().enumerate() {
        let triangle = filled(&[[11.0, 8.0], *point, ring[(place + 1) % ring.len()]]);
        sum.iter_mut().zip(triangle.samples()).for_each(|(sum, value)| *sum += value);
    }
    assert_eq!(sum, whole.samples());
    // A polygon that encloses nothing, and one far away.
    assert!(filled(&[[3.0, 3.0], [20.0, 3.0], [9.0, 3.0]]).samples().iter().all(|value| *value == 0.0));
    assert!(filled(&around(1.0e9, 0.0, 1.1e9, 50.0)).samples().iter().all(|value| *value == 0.0));
    assert!(filled(&around(-1.0e9, -1.0e9, 1.0e9, 1.0e9)).samples().iter().all(|value| *value == 1.0));
}
