//! Both back ends come to the same stacks, within what their kernels may differ by.

use orogeny_engine::{Adapter, Settings, Terrain};
use orogeny_tests::child::is_long;
use orogeny_tests::compare;
use serde_json::json;

use crate::random::Maker;
use crate::rich;
use crate::support::{Site, assert_near, composite, range_m, settings, told};

/// How far apart they may be, as a share of the range: a hundred thousandth for each filter, a ten-thousandth of a noise, and what gates make
/// of that.
const SHARE: f64 = 3.0e-4;

/// Compares the composite of a file as both back ends work it out. Gives how many planes, and of these how many differ in some bit.
fn compared(site: &Site, what: &str) -> [usize; 2] {
    let on = |adapter| Terrain::open_to_read(&site.path, Settings { adapter, ..settings() }).unwrap();
    let (cpu, gpu) = (on(Adapter::Cpu), on(Adapter::Software));
    let [mut num, mut num_different] = [0; 2];
    for level in 0..=site.top_level() {
        let (expected, found) = (composite(&cpu, level), composite(&gpu, level));
        let tolerance = SHARE * range_m(&expected);
        assert_near(&expected, &found, tolerance, &format!("{what} at level {level}"));
        num += 1;
        num_different += usize::from(compare::bit_equal(&expected, &found).is_err());
    }
    [num, num_different]
}

#[test]
fn both_back_ends_agree() {
    let mut sums = compared(&rich::site(), "the rich stack");
    for seed in 0..if is_long() { 20 } else { 1 } {
        let mut site = Site::new([150, 97], 25.0, 64);
        let mut maker = Maker::new(0xbac_0000 + seed, &site.terrain.grid());
        site.apply(&[json!({"op": "fill", "layer": "Base", "brush": maker.noise(150.0)})]);
        for _ in 0..5 {
            let add = maker.add(&site.layers());
            site.apply(&[add]);
        }
        let found = compared(&site, &format!("seed {seed}: {}", told(&site.layers())));
        sums = [sums[0] + found[0], sums[1] + found[1]];
    }
    let [num, num_different] = sums;
    println!("{num} planes, {num_different} of them not bit by bit");
    // Had the GPU done nothing of it, none would differ.
    assert!(num_different > 0);
}
