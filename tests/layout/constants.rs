//! Numbered constants: what Rust passes to a pipeline by number means the same in WGSL.

use orogeny_brush::Stage;
use orogeny_field::noise::{Basis, Turbulence};
use orogeny_field::{FalloffFormula, RangeFormula, StampMode, WeightMode};
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

/// All variants of an enum with their numbers; a new one does not compile before it is added.
macro_rules! numbered {
    ($name:ident, $prefix:literal, $type:ident { $($variant:ident),* $(,)? }) => {
        fn $name() -> Numbered {
            let all = [$($type::$variant),*];
            for variant in all {
                match variant {
                    $($type::$variant => {})*
                }
            }
            all.map(|variant| (format!("{}{}", $prefix, shouted(&format!("{variant:?}"))), variant as u32)).to_vec()
        }
    };
}

numbered!(
    formulas,
    "",
    FalloffFormula { HardEdge, Linear, Smooth, Sphere, Tip, Gauss, Power, Sigmoid, Curve }
);
numbered!(modes, "", WeightMode { Direct, BuildUp, Wash });
numbered!(bases, "", Basis { Gradient, Value, Worley, Simplex, Simplex3d, Sparse });
numbered!(
    turbulences,
    "",
    Turbulence { Fbm, Billowy, Ridged, Quilez, Erosive, Jordan, Heterogeneous, Multiplicative, Hybrid }
);
numbered!(ranges, "RANGE_", RangeFormula { Bias, Gain, Curve });
numbered!(stamps, "STAMP_", StampMode { Replace, Add, Max, Min });

#[test]
fn the_constants_of_single_kernels_are_the_numbers_of_their_enums() {
    let of = |stem, name| constants_of(&shader(stem).unwrap().wgsl, name);
    assert_eq!(of("brush/noise", "NOISE_BASIS"), bases());
    assert_eq!(of("brush/noise", "HAS_TRANSFER"), turbulences());
    assert_eq!(of("brush/range_map", "RANGE_FORMULA"), ranges());
    assert_eq!(of("brush/stamp", "STAMP_MODE"), stamps());
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
