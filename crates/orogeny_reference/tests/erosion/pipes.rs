//! Running water: rain, flows through pipes, and the rock that they carry.

use orogeny_field::hash::uniform;
use orogeny_field::{Pipes, PipesKernel, Plane, SampleRect};
use orogeny_reference::field::{Channel, pipes};

use crate::support::{
    REGION, SENTINEL, assert_near, bits, fixture, fixture_ground, fixture_hardness, hardness_of, highest,
    hilly, lowest, number, part, pieces, plane, rough, spiky, total, windows,
};

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
