//! The triangulation: no cracks, all covered once, as many triangles as said, and no jump as the camera moves.

#![expect(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::panic,
    reason = "helpers of tests, which clippy does not take for tests"
)]

mod common;

use std::collections::{HashMap, HashSet};
use std::sync::LazyLock;

use common::{Hills, area, triangles};
use glam::DVec3;
use orogeny_geomip::{Camera, DetailRule, DrawnTile, MAX_COARSENING, Metric, Tile, select, with_rims};
use proptest::prelude::*;

static HILLS: LazyLock<Hills> = LazyLock::new(|| Hills::new(700, 450, 2.0));

/// A quadtree over the terrain whose leaves differ by at most a level where they touch, split where `wants` says.
fn leaves(hills: &Hills, mut wants: impl FnMut(Tile) -> bool) -> Vec<Tile> {
    let mut leaves = vec![];
    let mut open = vec![Tile::root(&hills.grid)];
    while let Some(tile) = open.pop() {
        if tile.samples(&hills.grid).is_none() {
            continue;
        }
        if tile.level > 0 && wants(tile) { open.extend(tile.children()) } else { leaves.push(tile) }
    }
    loop {
        let too_large = leaves
            .iter()
            .position(|tile| leaves.iter().any(|other| other.level + 1 < tile.level && touch(*tile, *other)));
        let Some(place) = too_large else { return leaves };
        let tile = leaves.swap_remove(place);
        leaves.extend(tile.children().filter(|tile| tile.samples(&hills.grid).is_some()));
    }
}

fn touch(a: Tile, b: Tile) -> bool {
    let (first, second) = (a.origin(), b.origin());
    (0..2).all(|axis| first[axis] <= second[axis] + b.side() && second[axis] <= first[axis] + a.side())
}

/// Checks that tiles make one surface without a crack that covers the terrain once; gives the number of triangles with an area.
fn check(hills: &Hills, drawn: &[DrawnTile]) -> Result<u32, TestCaseError> {
    let key = |place: DVec3| place.to_array().map(f64::to_bits);
    let (mut edges, mut covered, mut num) = (HashSet::new(), 0.0, 0);
    for tile in drawn {
        for triangle in triangles(tile, hills) {
            let corners = triangle.map(key);
            if corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0] {
                continue;
            }
            let area = area(triangle);
            prop_assert!(area >= 0.0, "{area} of {triangle:?} of {tile:?}");
            covered += area;
            num += 1;
            for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                prop_assert!(edges.insert((corners[from], corners[to])), "twice: {triangle:?}");
            }
        }
    }
    let [width, depth] =
        [hills.grid.width(), hills.grid.depth()].map(|num| f64::from(num - 1) * hills.grid.spacing_m());
    prop_assert!((covered / (width * depth) - 1.0).abs() < 1.0e-9, "{covered} of {}", width * depth);
    for (from, to) in &edges {
        let [from_m, to_m] = [from, to].map(|key| DVec3::from_array(key.map(f64::from_bits)));
        let on_border = [0, 2].iter().any(|axis| {
            let last = [width, 0.0, depth][*axis];
            from_m[*axis] == to_m[*axis] && (from_m[*axis] == 0.0 || from_m[*axis] == last)
        });
        prop_assert!(on_border != edges.contains(&(*to, *from)), "a crack from {from_m} to {to_m}");
    }
    Ok(num)
}

fn camera(hills: &Hills) -> impl Strategy<Value = Camera> + use<> {
    let extent = [hills.grid.width(), hills.grid.depth()].map(|num| f64::from(num) * hills.grid.spacing_m());
    // From a metre above the ground to far away.
    (-0.3..1.3_f64, 0.0..8.5_f64, -0.3..1.3_f64).prop_map(move |(x, height, z)| {
        let eye = DVec3::new(x * extent[0], 200.0 + height.exp(), z * extent[1]);
        Camera::looking_at(eye, DVec3::new(extent[0] / 2.0, 0.0, extent[1] / 2.0), 1.0, [1280, 720])
    })
}

fn rule() -> impl Strategy<Value = DetailRule> {
    let metric = prop_oneof![Just(Metric::Roughness), Just(Metric::FromAbove)];
    (metric, 0.5..40.0_f64).prop_map(|(metric, max_error_px)| DetailRule { metric, max_error_px })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn any_details_on_any_quadtree_make_one_surface(
        (wants, details) in (prop::collection::vec(any::<bool>(), 64), prop::collection::vec(0.0..4.0_f32, 64)),
    ) {
        let mut wants = wants.into_iter().cycle();
        let leaves = leaves(&HILLS, |_| wants.next().unwrap());
        let details = leaves.iter().zip(details.iter().cycle());
        let drawn = with_rims(details.map(|(tile, more)| (*tile, f32::from(tile.level) + more)).collect());
        check(&HILLS, &drawn)?;
    }

    #[test]
    fn with_no_vertex_on_its_way_there_are_as_many_triangles_as_said(
        wants in prop::collection::vec(any::<bool>(), 64), details in prop::collection::vec(0..=MAX_COARSENING, 64),
    ) {
        // A terrain of whole tiles, where none has vertices beyond the border.
        static SQUARE: LazyLock<Hills> = LazyLock::new(|| Hills::new(513, 513, 1.0));
        let mut wants = wants.into_iter().cycle();
        let leaves = leaves(&SQUARE, |_| wants.next().unwrap());
        let details = leaves.iter().zip(details.iter().cycle());
        let drawn = with_rims(details.map(|(tile, more)| (*tile, f32::from(tile.level + more))).collect());
        let num = check(&SQUARE, &drawn)?;
        prop_assert_eq!(num, drawn.iter().map(DrawnTile::num_triangles).sum::<u32>());
    }

    #[test]
    fn what_a_camera_asks_for_makes_one_surface(camera in camera(&HILLS), rule in rule()) {
        let drawn = select(&HILLS.grid, &camera, &rule, &*HILLS, usize::MAX);
        let levels: HashMap<Tile, u8> = drawn.iter().map(|drawn| (drawn.tile, drawn.tile.level)).collect();
        for (tile, level) in &levels {
            for (other, other_level) in &levels {
                prop_assert!(!touch(*tile, *other) || level.abs_diff(*other_level) <= 1, "{tile:?} and {other:?}");
            }
        }
        check(&HILLS, &drawn)?;
    }

    #[test]
    fn the_surface_has_no_jump_as_the_camera_moves(
        from in camera(&HILLS), to in camera(&HILLS), rule in rule(), seed in any::<u32>(),
    ) {
        let points: Vec<_> = (0..12)
            .map(|number| {
                let along = |axis, num: u32| f64::from(orogeny_field::hash::uniform(number, axis, seed)) * f64::from(num - 1) * 2.0;
                [along(0, HILLS.grid.width()), along(1, HILLS.grid.depth())]
            })
            .collect();
        let heights = |way: f64| {
            let eye = from.eye_m().lerp(to.eye_m(), way);
            let camera = Camera::looking_at(eye, eye + DVec3::X, 1.0, [1280, 720]);
            let drawn = select(&HILLS.grid, &camera, &rule, &*HILLS, usize::MAX);
            points.iter().map(|point| height_at(&drawn, *point)).collect::<Vec<_>>()
        };
        let jump = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // Where it changes most, ever more closely: a jump stays as high as it is.
        let ways: Vec<_> = (0..=16).map(|step| (f64::from(step) / 16.0, heights(f64::from(step) / 16.0))).collect();
        let largest = ways.windows(2).max_by(|a, b| jump(&a[0].1, &a[1].1).total_cmp(&jump(&b[0].1, &b[1].1))).unwrap();
        let (mut first, mut last) = (largest[0].clone(), largest[1].clone());
        for _ in 0..40 {
            let middle = f64::midpoint(first.0, last.0);
            let middle = (middle, heights(middle));
            if jump(&first.1, &middle.1) > jump(&middle.1, &last.1) { last = middle } else { first = middle }
        }
        let left = jump(&first.1, &last.1);
        prop_assert!(left < 0.01, "{left} m at {} of the way", first.0);
    }
}

/// The height of the drawn surface.
fn height_at(drawn: &[DrawnTile], [x, z]: [f64; 2]) -> f64 {
    let spacing_m = HILLS.grid.spacing_m();
    for tile in drawn {
        let Some([first, last]) = tile.tile.samples(&HILLS.grid) else { continue };
        let is_in = |place: f64, axis: usize| {
            (f64::from(first[axis]) * spacing_m..=f64::from(last[axis]) * spacing_m).contains(&place)
        };
        if !is_in(x, 0) || !is_in(z, 1) {
            continue;
        }
        for [a, b, c] in triangles(tile, &HILLS) {
            let whole = area([a, b, c]);
            let point = DVec3::new(x, 0.0, z);
            let weights = [area([point, b, c]), area([a, point, c]), area([a, b, point])];
            if whole > 0.0 && weights.iter().all(|weight| *weight >= -1.0e-9) {
                return (weights[0] * a.y + weights[1] * b.y + weights[2] * c.y) / whole;
            }
        }
    }
    panic!("nothing is drawn at {x}, {z}");
}

#[test]
fn a_terrain_of_one_sample_and_one_of_a_row_are_drawn_too() {
    for (width, depth) in [(1, 1), (1, 300), (300, 1), (2, 2)] {
        let hills = Hills::new(width, depth, 1.0);
        let camera = Camera::looking_at(DVec3::new(0.0, 500.0, 0.0), DVec3::ZERO, 1.0, [100, 100]);
        let drawn = select(&hills.grid, &camera, &DetailRule::default(), &hills, usize::MAX);
        assert!(!drawn.is_empty(), "{width} x {depth}");
        let covered: f64 = drawn.iter().flat_map(|tile| triangles(tile, &hills)).map(area).sum();
        assert!(
            (covered - ((width - 1) * (depth - 1)) as f64).abs() < 1.0e-6,
            "{width} x {depth}: {covered}"
        );
    }
}

#[test]
fn flat_ground_has_few_triangles_by_roughness_and_many_from_above() {
    let camera = Camera::looking_at(
        DVec3::new(900.0, 260.0, 100.0),
        DVec3::new(1300.0, 200.0, 100.0),
        1.0,
        [1280, 720],
    );
    let num = |metric| -> u32 {
        let rule = DetailRule { metric, max_error_px: 2.0 };
        select(&HILLS.grid, &camera, &rule, &*HILLS, usize::MAX)
            .iter()
            // Beyond the cliff and its ring it is a plain.
            .filter(|drawn| drawn.tile.origin()[0] > 500 && drawn.tile.origin()[1] < 100)
            .map(DrawnTile::num_triangles)
            .sum()
    };
    let (rough, above) = (num(Metric::Roughness), num(Metric::FromAbove));
    assert!(rough > 0 && rough * 8 < above, "{rough} and {above}");
}
