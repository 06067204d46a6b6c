//! Where layers count, by the ground below: each thing that a mask may look at, by hand.

use orogeny_engine::{ExportSource, Terrain};
use orogeny_field::{Band, Gate};
use orogeny_store::Store;
use orogeny_tests::Plane;
use serde_json::{Value, json};

use crate::plain::{Ground, Plain, let_through};
use crate::support::{Site, assert_differs, assert_near, fill, name, read};

/// A painted base, something selected, a layer `Sand` of some heights with a painted mask, and `Top`, of 10 m everywhere.
fn ground() -> Site {
    let mut site = Site::usual();
    let brush = |radius: f64, value: f64| json!({"type": "paint_mask", "radius": radius, "falloff": 300, "value": value});
    site.apply(&[
        fill("Base", 180.0, 5),
        json!({"op": "stroke", "target": "selection", "brush": brush(2000.0, 0.8), "points": [[2000, 3000], [5000, 9000]]}),
        json!({"op": "add_layer", "name": "Sand"}),
        fill("Sand", 20.0, 6),
        json!({"op": "set_mask", "layer": "Sand", "from": "nothing"}),
        json!({"op": "stroke", "layer": "Sand", "brush": brush(1500.0, 1.0), "points": [[3000, 3000]]}),
        // So that what lies below `Top` is what is stored, to the bit: ranges may have hard ends then.
        json!({"op": "set_layer", "layer": "Sand", "visible": false}),
        json!({"op": "add_layer", "name": "Top", "height": 10}),
    ]);
    site
}

fn mask(terrain: &Terrain, level: u8) -> Plane {
    read(terrain, &ExportSource::Mask(name("Top")), None, level)
}

/// Gives the worst distance from what is worked out by hand, over all levels.
fn worst(site: &Site, terms: &Value) -> f64 {
    let store = Store::open_to_read(&site.path).unwrap();
    let layers = site.layers();
    let top = site.terrain.layer(Some(&name("Top"))).unwrap();
    let mut worst: f64 = 0.0;
    for level in 0..=site.top_level() {
        let plain = Plain { store: &store, layers: &layers, level };
        let (expected, found) = (plain.masks(top, &plain.below(top)), mask(&site.terrain, level));
        let what = format!("{terms} at level {level}");
        assert!(expected.off < 0.01, "{what}: {} would prove nothing", expected.off);
        worst = worst.max(assert_near(&expected.plane(), &found, expected.off, &what));
        assert!(
            level > 0 || found.samples().iter().any(|weight| *weight != found.at(0, 0)),
            "{what} is the same everywhere"
        );
    }
    worst
}

#[test]
fn each_term_is_what_it_says() {
    let mut site = ground();
    let slope = json!({"min": 4, "max": 9, "feather": 6});
    let cases = [
        json!([{"gate": {"slope": slope}}]),
        json!([{"gate": {"slope": {"min": 3, "max": 90}}}]),
        json!([{"gate": {"height": {"min": 50, "max": 140, "feather": 30}}}]),
        json!([{"gate": {"height": {"min": 50, "max": 140}, "inverted": true}}]),
        json!([{"gate": {"aspect": {"angle": 200, "width": 40, "feather": 50}}}]),
        json!([{"gate": {"aspect": {"angle": -10, "width": 100, "feather": 10}, "slope": slope}}]),
        json!([{"gate": {"curvature": {"min": 0.1, "max": 1000, "feather": 0.3}}}]),
        json!([{"gate": {"selection": true}}]),
        json!([{"gate": {"selection": true, "height": {"min": 80, "max": 900, "feather": 50}, "inverted": true}}]),
        json!([{"gate": {"noise": {"min": 0, "max": 0.4, "feather": 0.3, "pattern": {"feature_size": 900}}}}]),
        json!([{"gate": {"noise": {"min": 0.2, "max": 1, "feather": 0.2, "pattern": {"feature_size": 2000, "turbulence": "ridged", "seed": 9}}}}]),
        // The finest that full resolution shows, of which the coarsest levels show nothing.
        json!([{"gate": {"noise": {"min": 0, "max": 1, "feather": 0.1, "pattern": {"feature_size": 75, "octaves": 1}}}}]),
        json!([{"heights": {"layer": "Sand", "low": -10, "high": 15}}]),
        json!([{"heights": {"layer": "Sand", "low": 15, "high": -10}}]),
        json!([{"mask": "Sand"}]),
        json!([{"mask": "Sand", "invert": true, "curve": [[0, 1], [0.5, 0.2], [1, 0.6]]}]),
        json!([{"mask": "Sand", "blur": 90}, {"gate": {"slope": slope}, "combine": "subtract"}]),
        json!([{"mask": "Sand"}, {"gate": {"selection": true}, "combine": "add"}, {"gate": {"slope": slope}, "combine": "min"}]),
    ];
    let mut worst_of_all: f64 = 0.0;
    for terms in &cases {
        site.apply(&[json!({"op": "set_mask", "layer": "Top", "terms": terms})]);
        worst_of_all = worst_of_all.max(worst(&site, terms));
    }
    println!("{} masks, at most {worst_of_all:e} off", cases.len());
}

#[test]
fn a_wide_blur_is_a_gaussian() {
    let mut site = ground();
    let mut worst_of_all: f64 = 0.0;
    let sources = [json!({"mask": "Sand"}), json!({"gate": {"height": {"min": 90, "max": 900}}})];
    let mut num = 0;
    for source in sources {
        for samples in [5.0, 8.3, 21.0, 60.0] {
            let mut term = source.clone();
            term["blur"] = (samples * 25.0).into();
            let terms = json!([term]);
            site.apply(&[json!({"op": "set_mask", "layer": "Top", "terms": terms})]);
            worst_of_all = worst_of_all.max(worst(&site, &terms));
            num += 1;
        }
    }
    println!("{num} blurs, at most {worst_of_all:e} off");
    assert!(worst_of_all > 1.0e-5, "a pyramid is not quite a Gaussian");
}

#[test]
fn a_picture_lies_where_its_gate_has_it() {
    let mut site = ground();
    let pixels: Vec<u8> = (0..35_u32).map(|pixel| (pixel * 89 % 256) as u8).collect();
    let file = site.file("picture.png");
    let mut encoder = png::Encoder::new(std::fs::File::create(&file).unwrap(), 7, 5);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header().unwrap().write_image_data(&pixels).unwrap();
    let [x_m, z_m, width_m, depth_m] = [1000.0, 2500.0, 5000.0, 7000.0];
    let image = json!({"file": file, "region": [x_m, z_m, width_m, depth_m]});
    site.apply(&[json!({"op": "set_mask", "layer": "Top", "terms": [{"gate": {"image": image}}]})]);
    let pixel = |x: i32, z: i32| f64::from(pixels[(z.clamp(0, 4) * 7 + x.clamp(0, 6)) as usize]) / 255.0;
    for level in 0..=site.top_level() {
        let found = mask(&site.terrain, level);
        let spacing_m = 25.0 * f64::from(1 << level);
        let expected = Plane::from_fn(found.width(), found.depth(), |x, z| {
            let along = |place: u32, first_m: f64, side_m: f64, pixels: f64| {
                (f64::from(place) * spacing_m - first_m) / side_m * pixels - 0.5
            };
            let (x, z) = (along(x, x_m, width_m, 7.0), along(z, z_m, depth_m, 5.0));
            let (column, row) = (x.floor() as i32, z.floor() as i32);
            let lerp = |a: f64, b: f64, share: f64| a + share * (b - a);
            let of_row = |row: i32| lerp(pixel(column, row), pixel(column + 1, row), x - x.floor());
            lerp(of_row(row), of_row(row + 1), z - z.floor()) as f32
        });
        assert_near(&expected, &found, 1.0e-5, &format!("level {level}"));
    }
    assert_differs(&mask(&site.terrain, 0), &Plane::from_fn(300, 517, |_, _| 1.0), "the picture");
}

#[test]
fn the_slopes_of_known_ground_are_let_through() {
    let band = |min, max, feather| Some(Band { min, max, feather });
    let on = |slope, curvature_per_km| Ground { height_m: 50.0, slope, curvature_per_km };
    let steep = Gate { slope_deg: band(40.0, 50.0, 10.0), ..Gate::default() };
    assert_eq!(let_through(&steep, &on([1.0, 0.0], 0.0)), 1.0);
    assert_eq!(let_through(&steep, &on([0.0, 0.0], 0.0)), 0.0);
    assert!((let_through(&steep, &on([0.0, -35.0_f64.to_radians().tan()], 0.0)) - 0.5).abs() < 1.0e-12);
    let east = Gate {
        aspect: Some(orogeny_field::AspectGate { angle_deg: 0.0, width_deg: 30.0, feather_deg: 0.0 }),
        ..Gate::default()
    };
    assert_eq!(
        (let_through(&east, &on([-0.2, 0.0], 0.0)), let_through(&east, &on([0.2, 0.0], 0.0))),
        (1.0, 0.0)
    );
}
