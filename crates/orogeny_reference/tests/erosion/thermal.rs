//! Slides: what is steeper than its talus comes down.

use orogeny_field::hash::uniform;
use orogeny_field::{Plane, RockLayer, SampleRect, Thermal, ThermalKernel};
use orogeny_reference::field::thermal;

use crate::support::{
    REGION, SENTINEL, assert_near, bits, fixture, fixture_ground, fixture_hardness, hardness_of, highest,
    hilly, lowest, number, part, pieces, plane, rough, spiky, total, windows,
};

/// One iteration of thermal erosion; `out` is what is asked for of a region.
fn thermal_step(
    heights: &Plane,
    hardness: Option<&Plane>,
    out: SampleRect,
    bounds: &SampleRect,
    kernel: &ThermalKernel,
    is_cut: bool,
) -> Plane {
    assert!(heights.rect().contains(&out.grown(thermal::HALO).intersection(bounds)));
    let around = out.grown(1).intersection(bounds);
    let num_channels = if kernel.num_layers == 1 { 1 } else { 2 };
    let mut shares = Plane::with_channels(around, num_channels, SENTINEL);
    let (width, area) = (around.width() as usize, around.area() as usize);
    for z in around.z0..around.z1 {
        for (first, end) in pieces(around.width() as usize, is_cut) {
            let x = around.x0 + first as i32;
            let row = (z - around.z0) as usize * width;
            let (shares, taluses) = shares.samples_mut().split_at_mut(area);
            let taluses = if kernel.num_layers == 1 { &mut [] } else { &mut taluses[row + first..row + end] };
            thermal::shares_row(
                &mut shares[row + first..row + end],
                taluses,
                x,
                z,
                heights,
                hardness,
                bounds,
                kernel,
            );
        }
    }
    assert!(shares.samples()[..area].iter().all(|share| (0.0..=0.125).contains(share)));
    let mut new = Plane::constant(out, SENTINEL);
    for z in out.z0..out.z1 {
        for (first, end) in pieces(out.width() as usize, is_cut) {
            let x = out.x0 + first as i32;
            let new = &mut new.row_mut(z).unwrap()[first..end];
            thermal::heights_row(new, x, z, heights, &shares, bounds, kernel);
        }
    }
    new
}

fn thermal_steps(mut heights: Plane, kernel: &ThermalKernel, iterations: u32) -> Plane {
    let bounds = heights.rect();
    for _ in 0..iterations {
        heights = thermal_step(&heights, None, bounds, &bounds, kernel, false);
    }
    heights
}

fn one_layer(talus_angle_deg: f64, rate: f64, spacing_m: f64) -> ThermalKernel {
    let layers = vec![RockLayer { from_m: 0.0, talus_angle_deg, rate }];
    ThermalKernel::new("erode", &Thermal { layers, iterations: 1 }, spacing_m).unwrap()
}

fn three_layers(spacing_m: f64) -> ThermalKernel {
    let layer = |from_m, talus_angle_deg, rate| RockLayer { from_m, talus_angle_deg, rate };
    let layers = vec![layer(0.0, 20.0, 0.25), layer(850.0, 60.0, 0.1), layer(1000.0, 5.0, 0.2)];
    ThermalKernel::new("erode", &Thermal { layers, iterations: 1 }, spacing_m).unwrap()
}

#[test]
fn thermal_erosion_matches_numpy() {
    let (rect, iterations, cases) = fixture("thermal.json");
    for case in cases {
        let layers = case["layers"].as_array().unwrap().iter().map(|layer| RockLayer {
            from_m: number(&layer["from"]),
            talus_angle_deg: number(&layer["talus_angle"]),
            rate: number(&layer["rate"]),
        });
        let thermal = Thermal { layers: layers.collect(), iterations };
        let kernel = ThermalKernel::new("erode", &thermal, number(&case["spacing"])).unwrap();
        let hardness = fixture_hardness(rect, &case);
        let before = fixture_ground(rect);
        let mut heights = before.clone();
        for _ in 0..iterations {
            heights = thermal_step(&heights, hardness.as_ref(), rect, &rect, &kernel, false);
        }
        let range = f64::from(highest(&before) - lowest(&before));
        assert_near(&heights, &case["heights"], 1.0e-6 * range, &format!("{} layers", thermal.layers.len()));
        assert!((total(&heights) - total(&before)).abs() < 1.0e-2);
        assert!(heights.samples().iter().zip(before.samples()).any(|(new, old)| (new - old).abs() > 1.0));
    }
}

#[test]
fn thermal_erosion_keeps_its_mass() {
    let rect = SampleRect::new(-40, 7, 59, 90);
    for (name, ground) in
        [("rough", rough(rect, 3, 200.0)), ("spiky", spiky(rect, 4)), ("hilly", hilly(rect, 5, 300.0))]
    {
        for kernel in [one_layer(35.0, 0.25, 2.0), one_layer(0.0, 0.25, 2.0), three_layers(4.0)] {
            let above = |plane: &Plane| total(plane) - f64::from(lowest(&ground)) * rect.area() as f64;
            let after = thermal_steps(ground.clone(), &kernel, 100);
            let change = (above(&after) - above(&ground)) / above(&ground);
            println!("{name}: {change:.1e} of the mass");
            assert!(change.abs() < 1.0e-5, "{name}: {change}");
            assert_ne!(bits(&after), bits(&ground), "{name}");
        }
    }
}

/// Every height stays within those of the 3 x 3 samples around it, to the bit: what rounding could add is far below a talus.
/// At an angle of 0 there is none, and an ulp is.
#[test]
fn thermal_erosion_makes_no_new_extremum() {
    let rect = SampleRect::new(0, 0, 80, 70);
    let mut num_at_their_limit = 0;
    for mut heights in [rough(rect, 3, 200.0), rough(rect, 9, 1.0e5), spiky(rect, 4), hilly(rect, 5, 300.0)] {
        for (angle, spacing, num_ulps) in [(35.0, 2.0, 0), (1.0, 1.0, 0), (0.0, 1.0, 1)] {
            let kernel = one_layer(angle, 0.25, spacing);
            for _ in 0..20 {
                let new = thermal_step(&heights, None, rect, &rect, &kernel, false);
                for z in rect.z0..rect.z1 {
                    for x in rect.x0..rect.x1 {
                        let around = (z - 1..=z + 1)
                            .flat_map(|z| (x - 1..=x + 1).map(move |x| (x, z)))
                            .filter_map(|(x, z)| heights.at(x, z));
                        let (mut low, mut high) = around
                            .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), height| {
                                (low.min(height), high.max(height))
                            });
                        for _ in 0..num_ulps {
                            (low, high) = (low.next_down(), high.next_up());
                        }
                        let height = new.at(x, z).unwrap();
                        assert!((low..=high).contains(&height), "{height} of {low}..{high}, {angle} degrees");
                        num_at_their_limit += u32::from(height == low || height == high);
                    }
                }
                heights = new;
            }
        }
    }
    assert!(num_at_their_limit > 0);
}

#[test]
fn slopes_come_to_rest_at_their_talus() {
    let rect = SampleRect::new(0, 0, 32, 32);
    let kernel = one_layer(40.0, 0.25, 3.0);
    let talus_m = kernel.layers[0].talus_m;
    let tower =
        plane(rect, |x, z| if (14..18).contains(&x) && (14..18).contains(&z) { 20.0 * talus_m } else { 0.0 });
    let cliff = plane(rect, |x, _| if x < 16 { 20.0 * talus_m } else { 0.0 });
    for (name, ground) in [("rough", rough(rect, 8, 20.0 * talus_m)), ("tower", tower), ("cliff", cliff)] {
        let after = thermal_steps(ground.clone(), &kernel, 5_000);
        let mut steepest = 0.0_f32;
        for z in 0..32 {
            for x in 0..32 {
                for (dx, dz, longer) in
                    [(1, 0, 1.0), (0, 1, 1.0), (1, 1, 2.0_f32.sqrt()), (-1, 1, 2.0_f32.sqrt())]
                {
                    if let Some(other) = after.at(x + dx, z + dz) {
                        steepest = steepest.max((after.at(x, z).unwrap() - other).abs() / (talus_m * longer));
                    }
                }
            }
        }
        println!("{name}: {steepest} taluses");
        assert!(steepest < 1.01, "{name}: {steepest}");
        // Not flattened: what was too steep is as steep as it may be.
        assert!(steepest > 0.9, "{name}: {steepest}");
    }
}

#[test]
fn ground_below_its_talus_keeps_its_bits() {
    let rect = SampleRect::new(0, 0, 150, 40);
    let kernel = one_layer(30.0, 0.25, 2.0);
    let gentle = plane(rect, |x, z| {
        0.8 * kernel.layers[0].talus_m * (0.6 * x as f32 + 0.7 * z as f32)
            + 0.05 * uniform(x as u32, z as u32, 5)
            - 33.0
    });
    assert_eq!(bits(&thermal_steps(gentle.clone(), &kernel, 3)), bits(&gentle));
    // Steep, but too hard to give way.
    let hard = Plane::constant(rect, 1.0);
    let steep = rough(rect, 6, 100.0);
    assert_eq!(bits(&thermal_step(&steep, Some(&hard), rect, &rect, &kernel, false)), bits(&steep));
    assert_ne!(bits(&thermal_step(&steep, None, rect, &rect, &kernel, false)), bits(&steep));
}

#[test]
fn a_mirrored_field_erodes_to_its_mirror_image() {
    let rect = SampleRect::new(0, 0, 77, 77);
    let kernel = three_layers(4.0);
    let ground = hilly(rect, 5, 300.0);
    let across = plane(rect, |x, z| ground.at(76 - x, z).unwrap());
    let turned = plane(rect, |x, z| ground.at(z, 76 - x).unwrap());
    let eroded = thermal_steps(ground, &kernel, 7);
    let expected = plane(rect, |x, z| eroded.at(76 - x, z).unwrap());
    assert_eq!(bits(&thermal_steps(across, &kernel, 7)), bits(&expected));
    let expected = plane(rect, |x, z| eroded.at(z, 76 - x).unwrap());
    assert_eq!(bits(&thermal_steps(turned, &kernel, 7)), bits(&expected));
}

#[test]
fn no_way_of_cutting_thermal_erosion_changes_a_bit() {
    const ITERATIONS: i32 = 6;
    let ground = hilly(REGION.grown(9), 5, 300.0);
    let hardness = hardness_of(REGION.grown(9));
    for kernel in [one_layer(20.0, 0.25, 4.0), three_layers(4.0)] {
        for hardness in [None, Some(&hardness)] {
            let mut whole = part(&ground, REGION);
            // What lies around a region is not looked at, whether a plane holds it or not.
            let mut cut = ground.clone();
            for _ in 0..ITERATIONS {
                whole = thermal_step(&whole, hardness, REGION, &REGION, &kernel, false);
                cut = thermal_step(&cut, hardness, REGION, &REGION, &kernel, true);
            }
            assert_eq!(bits(&cut), bits(&whole));
            for window in windows() {
                let grown = |left: i32| window.grown(thermal::HALO * left).intersection(&REGION);
                let mut heights = part(&ground, grown(ITERATIONS));
                for left in (0..ITERATIONS).rev() {
                    heights = thermal_step(&heights, hardness, grown(left), &REGION, &kernel, left % 2 == 0);
                }
                assert_eq!(bits(&heights), bits(&part(&whole, window)), "{window:?}");
            }
        }
    }
}
