//! Erosion against what NumPy makes of the formulas in `f64` (`tests/fixtures/field/make_erosion.py`), and what holds for every
//! field: nothing is lost, no summit grows, slopes come to rest, and no way of cutting the work changes a bit.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "this is a test: a panic is how it fails"
)]

use orogeny_field::hash::{signed_uniform, uniform};
use orogeny_field::{
    DROPLET_BUDGET, DropletKernel, Droplets, Error, Pipes, PipesKernel, Plane, RockLayer, SampleRect,
    Thermal, ThermalKernel,
};
use orogeny_reference::field::{Channel, droplets, pipes, thermal};
use serde_json::Value;

/// What is in a row before it is written: no height, and no part of one.
const SENTINEL: f32 = f32::NAN;
/// How a row is cut when it is: shorter, as long and longer than what is worked on at once.
const CUTS: [usize; 6] = [1, 63, 64, 5, 130, 2];

fn plane(rect: SampleRect, of: impl Fn(i32, i32) -> f32) -> Plane {
    let places = (rect.z0..rect.z1).flat_map(|z| (rect.x0..rect.x1).map(move |x| (x, z)));
    Plane::from_samples(rect, 1, places.map(|(x, z)| of(x, z)).collect()).unwrap()
}

/// A part of a plane.
fn part(whole: &Plane, rect: SampleRect) -> Plane {
    let mut samples = Vec::new();
    for channel in 0..whole.num_channels() {
        for z in rect.z0..rect.z1 {
            let row = whole.channel_row(channel, z).unwrap();
            let first = (rect.x0 - whole.rect().x0) as usize;
            samples.extend_from_slice(&row[first..first + rect.width() as usize]);
        }
    }
    Plane::from_samples(rect, whole.num_channels(), samples).unwrap()
}

fn bits(plane: &Plane) -> Vec<u32> {
    plane.samples().iter().map(|value| value.to_bits()).collect()
}

fn total(plane: &Plane) -> f64 {
    plane.samples().iter().map(|value| f64::from(*value)).sum()
}

fn lowest(plane: &Plane) -> f32 {
    plane.samples().iter().copied().fold(f32::INFINITY, f32::min)
}

fn highest(plane: &Plane) -> f32 {
    plane.samples().iter().copied().fold(f32::NEG_INFINITY, f32::max)
}

/// White noise: as rough as ground can be.
fn rough(rect: SampleRect, seed: u32, relief_m: f32) -> Plane {
    plane(rect, |x, z| 700.0 + relief_m * uniform(x as u32, z as u32, seed))
}

/// Single samples far above and below a plain.
fn spiky(rect: SampleRect, seed: u32) -> Plane {
    plane(rect, |x, z| {
        let chance = uniform(x as u32, z as u32, seed);
        50.0 + if chance > 0.95 {
            900.0
        } else if chance < 0.05 {
            -300.0
        } else {
            chance
        }
    })
}

/// Hills of every size, as in real ground: half as high at half the width.
fn hilly(rect: SampleRect, seed: u32, relief_m: f32) -> Plane {
    plane(rect, |x, z| {
        let mut height_m = 900.0;
        for octave in 0..6 {
            let cell = 64 >> octave;
            let at = |i: i32, j: i32| signed_uniform(i as u32, j as u32, seed + octave);
            let (i, j) = (x.div_euclid(cell), z.div_euclid(cell));
            let (u, v) = (x.rem_euclid(cell) as f32 / cell as f32, z.rem_euclid(cell) as f32 / cell as f32);
            let north = at(i, j) + u * (at(i + 1, j) - at(i, j));
            let south = at(i, j + 1) + u * (at(i + 1, j + 1) - at(i, j + 1));
            height_m += (north + v * (south - north)) * relief_m * 0.5_f32.powi(octave as i32);
        }
        height_m
    })
}

fn hardness_of(rect: SampleRect) -> Plane {
    plane(rect, |x, z| uniform(x as u32, z as u32, 77))
}

fn fixture(name: &str) -> (SampleRect, u32, Vec<Value>) {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fixtures/field").join(name);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|err| panic!("{}: {err}", path.display()));
    let file: Value = serde_json::from_str(&text).unwrap();
    let cases = file["cases"].as_array().unwrap().clone();
    assert!(!cases.is_empty(), "an empty fixture proves nothing");
    let rect = SampleRect::new(0, 0, number(&file["width"]) as i32, number(&file["depth"]) as i32);
    (rect, number(&file["iterations"]) as u32, cases)
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// The ground of the fixtures.
fn fixture_ground(rect: SampleRect) -> Plane {
    plane(rect, |x, z| {
        let (x, z) = (i64::from(x), i64::from(z));
        let mixed = (x * 7919 + z * 104_729 + x * z * 31) % 65_536;
        (((x - 9).pow(2) + 2 * (z - 12).pow(2)) as f64 * 0.25 + mixed as f64 / 4096.0 + 100.0) as f32
    })
}

fn fixture_hardness(rect: SampleRect, case: &Value) -> Option<Plane> {
    case["hard"].as_bool().unwrap().then(|| plane(rect, |x, z| ((x + 2 * z) % 5) as f32 / 4.0))
}

fn assert_near(found: &Plane, expected: &Value, tolerance_m: f64, what: &str) {
    let expected = expected.as_array().unwrap();
    assert_eq!(expected.len(), found.samples().len());
    let mut worst: f64 = 0.0;
    for (found, expected) in found.samples().iter().zip(expected) {
        worst = worst.max((f64::from(*found) - number(expected)).abs());
        assert!(found.is_finite());
    }
    assert!(worst <= tolerance_m, "{what}: {worst} m");
}

/// Rows, cut or whole.
fn pieces(width: usize, is_cut: bool) -> Vec<(usize, usize)> {
    let mut lengths = CUTS.iter().cycle();
    let mut pieces = Vec::new();
    let mut first = 0;
    while first < width {
        let length = if is_cut { *lengths.next().unwrap() } else { width };
        pieces.push((first, width.min(first + length)));
        first += length;
    }
    pieces
}

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

/// Windows of a region: within, at a side, in a corner.
fn windows() -> [SampleRect; 3] {
    [SampleRect::new(30, 20, 101, 40), SampleRect::new(-3, 31, 5, 48), SampleRect::new(90, 40, 147, 68)]
}

const REGION: SampleRect = SampleRect { x0: -3, z0: 5, x1: 147, z1: 68 };

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

/// What there is between two iterations of running water.
#[derive(Clone)]
struct Flood {
    terrain: Plane,
    water: Plane,
    sediment: Plane,
    flux: Plane,
}

impl Flood {
    fn new(terrain: Plane) -> Self {
        let rect = terrain.rect();
        let none = Plane::constant(rect, 0.0);
        Self { terrain, water: none.clone(), sediment: none, flux: Plane::with_channels(rect, 4, 0.0) }
    }

    /// One iteration; `out` is what is asked for of a region.
    fn step(
        &self,
        hardness: Option<&Plane>,
        out: SampleRect,
        bounds: &SampleRect,
        kernel: &PipesKernel,
        is_cut: bool,
    ) -> Self {
        assert!(self.terrain.rect().contains(&out.grown(pipes::HALO).intersection(bounds)));
        let around = out.grown(1).intersection(bounds);
        let mut flux = part(&self.flux, around);
        let (width, area) = (around.width() as usize, around.area() as usize);
        for (row, z) in (around.z0..around.z1).enumerate() {
            for (first, end) in pieces(width, is_cut) {
                let x = around.x0 + first as i32;
                let mut channels = flux.samples_mut().chunks_mut(area);
                let mut next = || &mut channels.next().unwrap()[row * width + first..row * width + end];
                let flows = [next(), next(), next(), next()];
                pipes::flux_row(
                    flows,
                    x,
                    z,
                    Channel(&self.terrain, 0),
                    Channel(&self.water, 0),
                    bounds,
                    kernel,
                );
            }
        }
        let state = pipes::State {
            terrain: Channel(&self.terrain, 0),
            water: Channel(&self.water, 0),
            sediment: Channel(&self.sediment, 0),
        };
        let blank = Plane::constant(out, SENTINEL);
        let (mut terrain, mut water, mut sediment) = (blank.clone(), blank.clone(), blank);
        for z in out.z0..out.z1 {
            for (first, end) in pieces(out.width() as usize, is_cut) {
                let x = out.x0 + first as i32;
                let row = pipes::StateRow {
                    terrain: &mut terrain.row_mut(z).unwrap()[first..end],
                    water: &mut water.row_mut(z).unwrap()[first..end],
                    sediment: &mut sediment.row_mut(z).unwrap()[first..end],
                };
                pipes::ground_row(row, x, z, &state, &flux, hardness, bounds, kernel);
            }
        }
        Self { terrain, water, sediment, flux: part(&flux, out) }
    }

    fn steps(mut self, kernel: &PipesKernel, iterations: u32) -> Self {
        let rect = self.terrain.rect();
        for _ in 0..iterations {
            self = self.step(None, rect, &rect, kernel, false);
        }
        self
    }

    fn rock(&self) -> f64 {
        total(&self.terrain) + total(&self.sediment)
    }

    fn assert_same(&self, other: &Self, what: &str) {
        for (name, one, other) in [
            ("terrain", &self.terrain, &other.terrain),
            ("water", &self.water, &other.water),
            ("sediment", &self.sediment, &other.sediment),
            ("flux", &self.flux, &other.flux),
        ] {
            assert_eq!(bits(one), bits(other), "{what}: {name}");
        }
    }
}

#[test]
fn pipes_match_numpy() {
    let (rect, iterations, cases) = fixture("pipes.json");
    for case in cases {
        let of = |name: &str| number(&case[name]);
        let pipes = Pipes {
            rain_m_per_s: of("rain"),
            evaporation_per_s: of("evaporation"),
            capacity_s_per_m: of("capacity"),
            dissolving_per_s: of("dissolving"),
            deposition_per_s: of("deposition"),
            min_slope_deg: of("min_slope"),
            friction_per_s: of("friction"),
            gravity_m_per_s2: of("gravity"),
            pipe_area_m2: Some(of("pipe_area")),
            time_step_s: Some(of("time_step")),
            iterations,
        };
        let kernel = PipesKernel::new("erode", &pipes, of("spacing")).unwrap();
        let hardness = fixture_hardness(rect, &case);
        let ground = fixture_ground(rect);
        let mut flood = Flood::new(ground.clone());
        for _ in 0..iterations {
            flood = flood.step(hardness.as_ref(), rect, &rect, &kernel, false);
        }
        let range = f64::from(highest(&ground) - lowest(&ground));
        let what = format!("{} m apart", of("spacing"));
        assert_near(&flood.terrain, &case["terrain"], 1.0e-5 * range, &format!("terrain, {what}"));
        let depth = f64::from(highest(&flood.water));
        assert_near(&flood.water, &case["water"], 1.0e-4 * depth, &format!("water, {what}"));
        let load = f64::from(highest(&flood.sediment));
        // In every iteration the sediment takes up what the height was rounded by: half an ulp of it.
        let ulp = highest(&ground).next_up() - highest(&ground);
        let tolerance = 1.0e-4 * load + 0.5 * f64::from(ulp) * f64::from(iterations);
        assert_near(&flood.sediment, &case["sediment"], tolerance, &format!("sediment, {what}"));
        assert!(load > 1.0e-3);
    }
}

#[test]
fn water_and_rock_are_kept_and_nothing_blows_up() {
    let rect = SampleRect::new(3, -5, 99, 75);
    for spacing_m in [1.0, 4.0, 30.0] {
        for (name, ground) in [
            ("hilly", hilly(rect, 5, 12.0 * spacing_m as f32)),
            ("rough", rough(rect, 6, 3.0 * spacing_m as f32)),
            ("spiky", spiky(rect, 4)),
        ] {
            let what = format!("{name}, {spacing_m} m apart");
            let kernel = PipesKernel::new("erode", &Pipes::default(), spacing_m).unwrap();
            let (rock, mut water) = (total(&ground), 0.0);
            let mut flood = Flood::new(ground.clone());
            for _ in 0..300 {
                flood = flood.step(None, rect, &rect, &kernel, false);
                water = (water + f64::from(kernel.rain_m) * rect.area() as f64) * f64::from(kernel.staying);
                assert!(flood.water.samples().iter().all(|depth| *depth >= 0.0), "{what}");
                assert!(flood.sediment.samples().iter().all(|load| *load >= 0.0), "{what}");
            }
            let off = total(&flood.water) / water - 1.0;
            assert!(off.abs() < 1.0e-5, "{what}: water {off:e}");
            let relief = f64::from(highest(&ground) - lowest(&ground)) * rect.area() as f64;
            let off = (flood.rock() - rock) / relief;
            assert!(off.abs() < 1.0e-7, "{what}: rock {off:e} of the relief");
            // Neither pits nor towers: the ground stays within what it was, but for lakes that fill.
            let rise = highest(&flood.terrain) - highest(&ground);
            assert!(rise <= 0.0 && lowest(&flood.terrain) >= lowest(&ground), "{what}: {rise}");
            assert!(highest(&flood.water) < highest(&ground) - lowest(&ground), "{what}");
            let mut settled = flood.terrain.clone();
            pipes::settle_row(settled.samples_mut(), flood.sediment.samples());
            let off = (total(&settled) - rock) / relief;
            println!(
                "{what}: rock {off:.1e} of the relief once settled, {:.3} m of water",
                highest(&flood.water)
            );
            assert!(off.abs() < 1.0e-6, "{what}: rock {off:e} of the relief once settled");
            assert_ne!(bits(&settled), bits(&ground), "{what}");
        }
    }
}

#[test]
fn rain_alone_is_all_the_water_there_is() {
    let rect = SampleRect::new(0, 0, 70, 50);
    let pipes = Pipes { evaporation_per_s: 0.0, ..Pipes::default() };
    let kernel = PipesKernel::new("erode", &pipes, 10.0).unwrap();
    let flood = Flood::new(hilly(rect, 5, 100.0)).steps(&kernel, 200);
    let expected = 200.0 * f64::from(kernel.rain_m) * rect.area() as f64;
    assert!((total(&flood.water) / expected - 1.0).abs() < 1.0e-5, "{}", total(&flood.water) / expected);
    // It has run together.
    assert!(f64::from(highest(&flood.water)) > 5.0 * expected / rect.area() as f64);
}

#[test]
fn a_lake_at_rest_stays_as_it_is() {
    let rect = SampleRect::new(0, 0, 90, 40);
    let dry = Pipes { rain_m_per_s: 0.0, evaporation_per_s: 0.0, ..Pipes::default() };
    let kernel = PipesKernel::new("erode", &dry, 8.0).unwrap();
    // Both are exact, and so is their sum.
    let mut flood =
        Flood::new(plane(rect, |x, z| 100.0 + (uniform(x as u32, z as u32, 2) * 64.0).floor() / 4.0));
    flood.water = plane(rect, |x, z| 120.0 - flood.terrain.at(x, z).unwrap());
    let after = flood.clone().steps(&kernel, 20);
    after.assert_same(&flood, "a lake");
}

#[test]
fn evaporation_leaves_the_sediment_behind() {
    let rect = SampleRect::new(0, 0, 20, 20);
    let pipes =
        Pipes { rain_m_per_s: 0.0, evaporation_per_s: 10.0, deposition_per_s: 0.0, ..Pipes::default() };
    let kernel = PipesKernel::new("erode", &pipes, 30.0).unwrap();
    let mut flood = Flood::new(Plane::constant(rect, 5.0));
    flood.water = Plane::constant(rect, 1.0);
    flood.sediment = rough(rect, 3, 1.0);
    let after = flood.clone().steps(&kernel, 40);
    assert_eq!(highest(&after.water), 0.0);
    assert!((total(&after.sediment) / total(&flood.sediment) - 1.0).abs() < 1.0e-6);
}

#[test]
fn what_is_too_hard_is_not_taken_up() {
    let rect = SampleRect::new(0, 0, 90, 40);
    let kernel = PipesKernel::new("erode", &Pipes::default(), 10.0).unwrap();
    let ground = hilly(rect, 5, 100.0);
    let hard = Plane::constant(rect, 1.0);
    let half = plane(rect, |x, _| if x < 45 { 1.0 } else { 0.0 });
    let (mut on_hard, mut on_half) = (Flood::new(ground.clone()), Flood::new(ground.clone()));
    for _ in 0..30 {
        on_hard = on_hard.step(Some(&hard), rect, &rect, &kernel, false);
        on_half = on_half.step(Some(&half), rect, &rect, &kernel, false);
    }
    assert_eq!(bits(&on_hard.terrain), bits(&ground));
    assert_eq!(highest(&on_hard.sediment), 0.0);
    // Where it is hard, ground may be laid down but not taken.
    let changes = |columns: std::ops::Range<i32>| {
        let places = columns.flat_map(|x| (0..40).map(move |z| (x, z)));
        places.map(|(x, z)| on_half.terrain.at(x, z).unwrap() - ground.at(x, z).unwrap()).fold(0.0, f32::min)
    };
    assert_eq!(changes(0..45), 0.0);
    assert!(changes(45..90) < -0.01);
}

/// Rain on a slope with a shallow trough: the trough is dug deeper than the ground beside it.
#[test]
fn water_digs_where_it_runs_together() {
    let rect = SampleRect::new(0, 0, 61, 90);
    let ground = plane(rect, |x, z| {
        200.0 - 2.0 * z as f32 + 0.1 * (x - 30).pow(2) as f32 + 0.1 * uniform(x as u32, z as u32, 4)
    });
    let kernel = PipesKernel::new("erode", &Pipes::default(), 10.0).unwrap();
    let flood = Flood::new(ground.clone()).steps(&kernel, 300);
    let dug = |columns: std::ops::Range<i32>| {
        let places = columns.clone().flat_map(|x| (20..60).map(move |z| (x, z)));
        let sum: f32 = places.map(|(x, z)| ground.at(x, z).unwrap() - flood.terrain.at(x, z).unwrap()).sum();
        sum / (columns.len() * 40) as f32
    };
    let (trough, side) = (dug(29..32), dug(8..15));
    assert!(trough > 1.2 * side.max(0.1), "{trough} m in the trough, {side} m beside it");
}

#[test]
fn no_way_of_cutting_pipes_changes_a_bit() {
    const ITERATIONS: i32 = 6;
    let kernel = PipesKernel::new("erode", &Pipes { rain_m_per_s: 0.1, ..Pipes::default() }, 10.0).unwrap();
    let ground = hilly(REGION.grown(9), 5, 100.0);
    let hardness = hardness_of(REGION.grown(9));
    for hardness in [None, Some(&hardness)] {
        // In the middle of it: with water, sediment and flows.
        let start = Flood::new(part(&ground, REGION)).steps(&kernel, 20);
        let (mut whole, mut cut) = (start.clone(), start.clone());
        // What lies around a region is not looked at, whether a plane holds it or not.
        cut.terrain = plane(ground.rect(), |x, z| start.terrain.at(x, z).unwrap_or(-1.0e6));
        for _ in 0..ITERATIONS {
            whole = whole.step(hardness, REGION, &REGION, &kernel, false);
            cut = cut.step(hardness, REGION, &REGION, &kernel, true);
        }
        cut.assert_same(&whole, "rows cut");
        assert!(highest(&whole.sediment) > 0.0);
        for window in windows() {
            let grown = |left: i32| window.grown(pipes::HALO * left).intersection(&REGION);
            let of = |flood: &Flood, rect: SampleRect| Flood {
                terrain: part(&flood.terrain, rect),
                water: part(&flood.water, rect),
                sediment: part(&flood.sediment, rect),
                flux: part(&flood.flux, rect),
            };
            let mut flood = of(&start, grown(ITERATIONS));
            for left in (0..ITERATIONS).rev() {
                flood = flood.step(hardness, grown(left), &REGION, &kernel, left % 2 == 0);
            }
            flood.assert_same(&of(&whole, window), &format!("{window:?}"));
        }
    }
}

fn droplet_kernel(droplets: &Droplets, spacing_m: f64) -> DropletKernel {
    DropletKernel::new("erode", droplets, spacing_m).unwrap()
}

/// The sums of droplets, traced in an order.
fn round_of(
    heights: &Plane,
    bounds: &SampleRect,
    kernel: &DropletKernel,
    indices: impl Iterator<Item = u32>,
) -> Vec<i32> {
    let mut sums = vec![0; bounds.area() as usize];
    for index in indices {
        droplets::trace(index, 3, heights, bounds, kernel, |x, z, units| {
            let end = x + units.len() as i32;
            assert!(bounds.contains(&SampleRect::new(x, z, end, z + 1)), "{x}..{end}, {z}");
            let place = (z - bounds.z0) as usize * bounds.width() as usize + (x - bounds.x0) as usize;
            droplets::add(&mut sums[place..], units);
        });
    }
    sums
}

#[test]
fn a_droplet_neither_wins_nor_loses_rock() {
    let rect = SampleRect::new(-20, 30, 77, 101);
    for radius in 1..=8 {
        let kernel = droplet_kernel(&Droplets { radius, ..Droplets::default() }, 10.0);
        let weights: f32 = kernel.disc.iter().flat_map(|part| part.weights).sum();
        assert!((weights - 1.0).abs() < 1.0e-5, "{weights}");
        for ground in [hilly(rect, 5, 100.0), rough(rect, 6, 30.0), spiky(rect, 2)] {
            let mut num_that_moved = 0;
            for index in 0..200 {
                let sums = round_of(&ground, &rect, &kernel, index..index + 1);
                assert_eq!(sums.iter().sum::<i32>(), 0);
                num_that_moved += u32::from(sums.iter().any(|sum| *sum != 0));
            }
            assert!(num_that_moved > 100, "{num_that_moved}");
        }
    }
}

#[test]
fn the_order_of_droplets_does_not_matter() {
    let rect = SampleRect::new(-20, 30, 77, 101);
    let kernel = droplet_kernel(&Droplets::default(), 10.0);
    let ground = hilly(rect, 5, 100.0);
    let forwards = round_of(&ground, &rect, &kernel, 0..4096);
    assert_eq!(round_of(&ground, &rect, &kernel, (0..4096).rev()), forwards);
    let shuffled = (0..4096).map(|index| (index * 2731 + 17) % 4096);
    assert_eq!(round_of(&ground, &rect, &kernel, shuffled), forwards);
}

/// A full round of the greediest droplets, all in one small place, as high as ground can be.
#[test]
fn sums_of_a_round_do_not_wrap() {
    let rect = SampleRect::new(0, 0, 6, 5);
    let greedy = Droplets { capacity: 64.0, erosion: 1.0, radius: 1, max_steps: 1024, ..Droplets::default() };
    let kernel = droplet_kernel(&greedy, 1000.0);
    let cliff = plane(rect, |x, z| 1.0e7 - 1.0e6 * (x + z) as f32);
    let mut largest = 0;
    for index in 0..4096 {
        let sums = round_of(&cliff, &rect, &kernel, index..index + 1);
        largest = largest.max(sums.iter().map(|sum| sum.abs()).max().unwrap());
    }
    assert!(largest > DROPLET_BUDGET / 4, "{largest}");
    // Half a metre, in 2^-16 m, is what a height of 1e7 m may have left from the round before.
    assert!(i64::from(largest) * 4096 + 32_768 < i64::from(i32::MAX), "{largest}");
    round_of(&cliff, &rect, &kernel, 0..4096);
}

/// Heights above 128 m are multiples of 2^-16 m: nothing at all may be lost, whatever it is added to.
#[test]
fn changes_too_small_for_a_height_are_kept_for_later() {
    let mut heights: Vec<f32> = (0..100).map(|index| 130.0 + 97.0 * (index * index) as f32).collect();
    let before: f64 = heights.iter().map(|height| f64::from(*height)).sum();
    let mut changes = vec![0; 100];
    let mut given = 0;
    for round in 0..1000 {
        for (index, change) in (0_i32..).zip(&mut changes) {
            let units = (index * 31 + round * 17) % 7 - 2;
            *change += units;
            given += i64::from(units);
        }
        droplets::settle_row(&mut heights, &mut changes);
    }
    let after: f64 = heights.iter().map(|height| f64::from(*height)).sum();
    let left: i64 = changes.iter().map(|change| i64::from(*change)).sum();
    assert_eq!((after - before) * 65_536.0, (given - left) as f64);
    assert!(given > 50_000);
    // Of the highest, at 950,000 m, an ulp is 4,096 units.
    assert!(changes.iter().all(|change| change.abs() <= 2048), "{changes:?}");
}

#[test]
fn droplets_carry_rock_downhill_and_keep_it() {
    let rect = SampleRect::new(0, 0, 128, 128);
    let kernel = droplet_kernel(&Droplets::default(), 10.0);
    let ground = hilly(rect, 5, 100.0);
    let mut heights = ground.clone();
    droplets::run(&mut heights, &kernel, 16_384, 0);
    let off = (total(&heights) - total(&ground))
        / f64::from(highest(&ground) - lowest(&ground))
        / rect.area() as f64;
    assert!(off.abs() < 1.0e-7, "{off:e} of the relief");
    let energy = |plane: &Plane| plane.samples().iter().map(|height| f64::from(*height).powi(2)).sum::<f64>();
    assert!(energy(&heights) < energy(&ground));
    let change = heights.samples().iter().zip(ground.samples()).map(|(new, old)| (new - old).abs());
    let largest = change.fold(0.0, f32::max);
    assert!(largest > 0.5 && largest < 50.0, "{largest} m");
    // Later rounds are others.
    let mut later = ground.clone();
    droplets::run(&mut later, &kernel, 16_384, 1000);
    assert_ne!(bits(&later), bits(&heights));
    // On a plain there is no way to go.
    let plain = Plane::constant(rect, 300.0);
    let mut same = plain.clone();
    droplets::run(&mut same, &kernel, 1000, 0);
    assert_eq!(bits(&same), bits(&plain));
}

#[test]
fn a_droplet_sees_no_further_than_its_reach() {
    let bounds = SampleRect::new(-50, 10, 250, 230);
    let ground = hilly(bounds, 5, 100.0);
    let kernel = droplet_kernel(&Droplets { max_steps: 20, ..Droplets::default() }, 10.0);
    let reach = kernel.reach() as i32;
    let mut num_within = 0;
    for index in 0..500 {
        let [x, z] = droplets::start(index, 3, &bounds, &kernel);
        assert!(bounds.contains(&SampleRect::new(x, z, x + 2, z + 2)));
        let window = SampleRect::new(x, z, x + 1, z + 1).grown(reach).intersection(&bounds);
        let mut seen = Vec::new();
        droplets::trace(index, 3, &ground, &bounds, &kernel, |x, z, units| {
            seen.push((x, z, units.to_vec()));
            for (x, units) in (x..).zip(units) {
                assert!(*units == 0 || window.contains(&SampleRect::new(x, z, x + 1, z + 1)));
            }
        });
        let mut seen_in_window = Vec::new();
        droplets::trace(index, 3, &part(&ground, window), &bounds, &kernel, |x, z, units| {
            seen_in_window.push((x, z, units.to_vec()));
        });
        assert_eq!(seen_in_window, seen, "droplet {index}");
        num_within += u32::from(bounds.grown(-reach).contains(&window));
    }
    assert!(num_within > 50, "{num_within}");
}

#[test]
fn values_beyond_their_limits_are_named() {
    let field_of = |result: Result<(), Error>| match result {
        Err(Error::BrushValue { brush: "erode", field, .. }) => field,
        other => panic!("{other:?}"),
    };
    let layer = RockLayer { from_m: 0.0, talus_angle_deg: 30.0, rate: 0.2 };
    let thermal = |layers: Vec<RockLayer>| {
        field_of(ThermalKernel::new("erode", &Thermal { layers, iterations: 5 }, 1.0).map(|_| ()))
    };
    assert_eq!(thermal(vec![]), "layers");
    assert_eq!(thermal(vec![layer; 9]), "layers");
    assert_eq!(thermal(vec![RockLayer { rate: 0.26, ..layer }]), "rate");
    assert_eq!(thermal(vec![RockLayer { talus_angle_deg: f64::NAN, ..layer }]), "talus_angle");
    let above = |from_m| RockLayer { from_m, ..layer };
    assert_eq!(thermal(vec![layer, above(50.0), above(40.0)]), "from");
    let pipes = |pipes: Pipes| field_of(PipesKernel::new("erode", &pipes, 1.0).map(|_| ()));
    assert_eq!(pipes(Pipes { gravity_m_per_s2: 0.0, ..Pipes::default() }), "gravity");
    assert_eq!(pipes(Pipes { rain_m_per_s: f64::INFINITY, ..Pipes::default() }), "rain");
    let droplets = |droplets: Droplets| field_of(DropletKernel::new("erode", &droplets, 1.0).map(|_| ()));
    assert_eq!(droplets(Droplets { radius: 9, ..Droplets::default() }), "radius");
    assert_eq!(droplets(Droplets { max_steps: 0, ..Droplets::default() }), "max_steps");
    // A step that is too long to be stable is cut to the longest that is.
    let hasty = Pipes { time_step_s: Some(100.0), ..Pipes::default() };
    assert_eq!(PipesKernel::new("erode", &hasty, 7.0), PipesKernel::new("erode", &Pipes::default(), 7.0));
}
