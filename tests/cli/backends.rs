//! The same recipe on the CPU back end and on a software driver.

use crate::program::Folder;

/// Metres. `kernels.md` allows (4 + 2√K) units in the last place of a height under 1024 m, K being under 100 here: 24 units of
/// 6.1e-5 m.
const TOLERANCE_M: f32 = 24.0 * 6.1035e-5;

const RECIPE: &str = r#"{"operations": [
    {"op": "stroke", "brush": {"type": "raise", "radius": 90, "strength": 60}, "points": [[40, 40], [300, 270, 0.6], [520, 200]]},
    {"op": "stroke", "brush": {"type": "ledge", "radius": 70, "strength": 15}, "points": [[100, 400], [500, 380]]},
    {"op": "stroke", "brush": {"type": "level", "radius": 40, "falloff": 20}, "points": [[60, 200], [300, 250], [560, 230]]},
    {"op": "fill", "brush": {"type": "roughen", "strength": 2}, "seed": 3, "region": [300, 300, 250, 200]}
]}"#;

fn heights_on(adapter: &str) -> (String, Vec<f32>) {
    let folder = Folder::new();
    folder.succeed("new t.orogeny --size 600x520 --spacing 1 --height 500");
    folder.write("recipe.json", RECIPE);
    let applied = folder.succeed(&format!("apply t.orogeny recipe.json --adapter {adapter} --page-budget 4"));
    folder.succeed("export t.orogeny now.r32");
    (applied["backend"].as_str().unwrap().to_owned(), folder.heights("now.r32"))
}

/// The largest difference; both have changed the terrain.
fn largest_difference(a: &[f32], b: &[f32]) -> f32 {
    assert_eq!(a.len(), b.len());
    assert!([a, b].iter().all(|heights| heights.iter().any(|height_m| *height_m != 500.0)));
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn both_back_ends_give_the_same_terrain() {
    let (cpu, on_cpu) = heights_on("cpu");
    let (gpu, on_gpu) = heights_on("software");
    assert!(cpu.starts_with("CPU") && gpu.starts_with("GPU"), "{cpu}, {gpu}");
    let difference_m = largest_difference(&on_cpu, &on_gpu);
    assert!(difference_m <= TOLERANCE_M, "{difference_m} m apart");
}

#[test]
fn the_comparison_sees_one_height_that_differs() {
    let a = vec![501.0; 9];
    let mut b = a.clone();
    b[4] += 2.0 * TOLERANCE_M;
    assert!(largest_difference(&a, &b) > TOLERANCE_M);
}
