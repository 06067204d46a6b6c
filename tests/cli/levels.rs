//! Coarser levels, exported: each sample the mean around its own of the level below, `[1 2 1]² / 16`.

use crate::program::Folder;

const RECIPE: &str = r#"{"operations": [
    {"op": "stroke", "brush": {"type": "raise", "radius": 150, "strength": 70}, "points": [[30, 40], [420, 210, 0.5]]},
    {"op": "fill", "brush": {"type": "roughen", "strength": 5}, "seed": 3}
]}"#;

struct Level {
    width: usize,
    depth: usize,
    heights: Vec<f32>,
}

fn level(folder: &Folder, number: u64) -> Level {
    let exported = folder.succeed(&format!("export t.orogeny level.r32 --level {number}"));
    let [width, depth] = ["width", "depth"].map(|side| exported[side].as_u64().unwrap() as usize);
    let heights = folder.heights("level.r32");
    assert_eq!(heights.len(), width * depth);
    Level { width, depth, heights }
}

impl Level {
    /// The sample there, or on the edge where that is beyond it.
    fn at(&self, x: isize, z: isize) -> f64 {
        let along = |place: isize, side: usize| place.clamp(0, side as isize - 1) as usize;
        f64::from(self.heights[along(z, self.depth) * self.width + along(x, self.width)])
    }

    /// The mean around a sample, as it is written on paper.
    fn mean(&self, x: usize, z: usize) -> f64 {
        let weights = [(-1, 1.0), (0, 2.0), (1, 1.0)];
        let (x, z) = (2 * x as isize, 2 * z as isize);
        let around =
            weights.iter().flat_map(|(dz, wz)| weights.map(|(dx, wx)| wz * wx * self.at(x + dx, z + dz)));
        around.sum::<f64>() / 16.0
    }

    fn assert_is_above(&self, below: &Self, what: &str) {
        assert_eq!((self.width, self.depth), (below.width.div_ceil(2), below.depth.div_ceil(2)), "{what}");
        for (index, height_m) in self.heights.iter().enumerate() {
            let (x, z) = (index % self.width, index / self.width);
            let expected = below.mean(x, z);
            // Sums of sixteen numbers in f32.
            let tolerance = 1.0e-6 * expected.abs().max(1.0);
            assert!(
                (f64::from(*height_m) - expected).abs() <= tolerance,
                "{what}: {x}, {z}: {height_m}, not {expected}"
            );
        }
    }
}

#[test]
fn each_level_is_the_mean_of_the_one_below_at_any_size() {
    for (width, depth, num_levels) in
        [(600, 514, 2), (601, 257, 2), (513, 300, 2), (1025, 63, 3), (77, 40, 0)]
    {
        let folder = Folder::new();
        folder.succeed(&format!("new t.orogeny --size {width}x{depth} --spacing 1 --height 10"));
        folder.write("recipe.json", RECIPE);
        folder.succeed("apply t.orogeny recipe.json");
        assert_eq!(folder.succeed("info t.orogeny")["num_levels_above"], num_levels, "{width} x {depth}");
        let mut below = level(&folder, 0);
        folder.succeed("export t.orogeny full.r32");
        assert_eq!(folder.heights("full.r32"), below.heights);
        for number in 1..=num_levels {
            let above = level(&folder, number);
            above.assert_is_above(&below, &format!("{width} x {depth}, level {number}"));
            below = above;
        }
        folder.fail(
            &format!("export t.orogeny no.r32 --level {}", num_levels + 1),
            &[&format!("no level {}", num_levels + 1), &format!("coarsest is {num_levels}")],
        );
        folder.fail("export t.orogeny no.r32 --level 200", &["no level 200"]);
        assert_eq!(folder.run("export t.orogeny no.r32 --level -1").code, Some(2));
    }
}

#[test]
fn a_region_of_a_level_is_that_part_of_it() {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 700x601 --spacing 0.5 --height 10");
    folder.write("recipe.json", RECIPE);
    folder.succeed("apply t.orogeny recipe.json");
    let whole = level(&folder, 1);
    // Samples 100..300 and 50..151: of level 1, those that lie on an even one.
    folder.succeed("export t.orogeny part.r32 --level 1 --region 50,25,100,50.5");
    let part = folder.heights("part.r32");
    assert_eq!(part.len(), 100 * 51);
    for (index, height_m) in part.iter().enumerate() {
        let (x, z) = (50 + index % 100, 25 + index / 100);
        assert_eq!(*height_m, whole.heights[z * whole.width + x], "{x}, {z}");
    }
}

#[test]
#[should_panic(expected = "not")]
fn a_height_that_is_not_the_mean_is_seen() {
    let below = Level { width: 4, depth: 4, heights: vec![1.0; 16] };
    let above = Level { width: 2, depth: 2, heights: vec![1.0, 1.0, 1.0, 1.00001] };
    above.assert_is_above(&below, "it");
}
