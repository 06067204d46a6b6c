//! Range map.

use orogeny_brush::CpuExecutor;
use orogeny_field::{Blending, Brush, BrushType, Curve, PageLayout, RangeMap, RangeMapping, SampleRect};
use orogeny_tests::{Feed, Operation, Plane, paint};

use crate::agreement::back_ends_agree;

fn range(mapping: RangeMapping) -> Brush {
    let range_map = RangeMap { low_m: 100.0, high_m: 1100.0, mapping };
    Brush { range_map, ..Brush::new(BrushType::RangeMap, 1.0, 1.0) }
}

fn bent() -> Curve {
    Curve::new("a test", vec![[0.0, 0.0], [0.3, 0.6], [0.7, 0.65], [1.0, 1.0]]).unwrap()
}

fn brushes() -> Vec<(&'static str, Brush)> {
    vec![
        ("range map, bias", range(RangeMapping::Bias(0.3))),
        ("range map, gain", range(RangeMapping::Gain(0.8))),
        ("range map, curve", range(RangeMapping::Curve(bent()))),
        ("range map, build-up", Brush { blending: Blending::BuildUp, ..range(RangeMapping::Bias(0.7)) }),
    ]
}

back_ends_agree!(brushes);

#[test]
fn heights_of_the_range_follow_the_closed_form_and_others_stay() {
    let layout = PageLayout::new(64).unwrap();
    let slope = Plane::from_fn(128, 4, |x, _| x as f32 * 10.0);
    let power = |b: f64, z: f64| z.powf(b.ln() / 0.5_f64.ln());
    let gain = |g: f64, z: f64| {
        if z < 0.5 { power(1.0 - g, 2.0 * z) / 2.0 } else { 1.0 - power(1.0 - g, 2.0 - 2.0 * z) / 2.0 }
    };
    let cases: [(RangeMapping, &dyn Fn(f64) -> f64); 3] = [
        (RangeMapping::Bias(0.2), &|z| power(0.2, z)),
        (RangeMapping::Gain(0.7), &|z| gain(0.7, z)),
        (RangeMapping::Curve(bent()), &|z| bent().value(z)),
    ];
    for (mapping, expected) in cases {
        let fill =
            Operation::Fill { brush: range(mapping.clone()), seed: 0, region: SampleRect::new(0, 0, 128, 4) };
        let mut cpu = CpuExecutor::new(layout, 1 << 24, Some(1)).unwrap();
        let found = paint(&slope, 1.0, &[fill], &mut cpu, layout, Feed::WHOLE).unwrap().plane;
        for x in 0..128 {
            let height = f64::from(slope.at(x, 1));
            let wanted = if (100.0..=1100.0).contains(&height) {
                100.0 + 1000.0 * expected((height - 100.0) / 1000.0)
            } else {
                height
            };
            // A curve is read from 256 entries.
            let found = f64::from(found.at(x, 1));
            assert!((found - wanted).abs() < 0.05, "{mapping:?} at {height}: {wanted}, found {found}");
        }
    }
}
