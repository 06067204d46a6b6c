//! Numbered constants: what Rust passes to a pipeline by number means the same in WGSL.

use orogeny_brush::Stage;
use orogeny_field::{FalloffFormula, WeightMode};
use orogeny_shaders::shader;

type Numbered = Vec<(String, u32)>;

/// The constants that stand, line by line, after the override of the given name.
fn constants_of(wgsl: &str, name: &str) -> Numbered {
    let start = format!("override {name}: u32");
    let lines = wgsl.lines().skip_while(|line| !line.starts_with(&start)).skip(1);
    let constants = lines.map_while(|line| {
        let (name, number) = line.strip_prefix("const ")?.split_once(" = ")?;
        Some((name.to_owned(), number.split_once("u;")?.0.parse().ok()?))
    });
    constants.collect()
}

/// `HardEdge` as `HARD_EDGE`.
fn shouted(variant: &str) -> String {
    let mut shouted = String::new();
    for (place, letter) in variant.chars().enumerate() {
        if letter.is_uppercase() && place > 0 {
            shouted.push('_');
        }
        shouted.push(letter.to_ascii_uppercase());
    }
    shouted
}

/// All variants; a new one does not compile before it is added.
fn formulas() -> Numbered {
    use FalloffFormula::{Gauss, HardEdge, Linear, Power, Sigmoid, Smooth, Sphere, Tip};
    let all = [HardEdge, Linear, Smooth, Sphere, Tip, Gauss, Power, Sigmoid];
    for formula in all {
        match formula {
            HardEdge | Linear | Smooth | Sphere | Tip | Gauss | Power | Sigmoid => {}
        }
    }
    all.map(|formula| (shouted(&format!("{formula:?}")), formula as u32)).to_vec()
}

fn modes() -> Numbered {
    use WeightMode::{BuildUp, Direct, Wash};
    let all = [Direct, BuildUp, Wash];
    for mode in all {
        match mode {
            Direct | BuildUp | Wash => {}
        }
    }
    all.map(|mode| (shouted(&format!("{mode:?}")), mode as u32)).to_vec()
}

#[test]
fn the_constants_of_every_kernel_are_the_numbers_of_the_enums() {
    for stage in Stage::ALL {
        let wgsl = &shader(stage.stem()).unwrap().wgsl;
        assert_eq!(constants_of(wgsl, "FALLOFF_FORMULA"), formulas(), "{}", stage.stem());
        assert_eq!(constants_of(wgsl, "WEIGHT_MODE"), modes(), "{}", stage.stem());
    }
}

#[test]
fn a_swapped_a_missing_and_a_renamed_constant_are_seen() {
    let wgsl = &shader("brush/raise").unwrap().wgsl;
    for (good, bad) in [
        ("const GAUSS = 5u;", "const GAUSS = 6u;"),
        ("const WASH = 2u;", ""),
        ("const TIP = 4u;", "const SPIKE = 4u;"),
    ] {
        assert!(wgsl.contains(good), "{good}");
        let broken = wgsl.replace(good, bad);
        let same = constants_of(&broken, "FALLOFF_FORMULA") == formulas()
            && constants_of(&broken, "WEIGHT_MODE") == modes();
        assert!(!same, "{bad}");
    }
    assert!(constants_of(wgsl, "NO_SUCH_OVERRIDE").is_empty());
}
