//! What a kernel refuses to be made of.

use orogeny_field::{DropletKernel, Droplets, Error, Pipes, PipesKernel, RockLayer, Thermal, ThermalKernel};

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
    assert_eq!(droplets(Droplets { radius: 9, ..Droplets::default() }), "erosion_radius");
    assert_eq!(droplets(Droplets { max_steps: 0, ..Droplets::default() }), "max_steps");
    // A step that is too long to be stable is cut to the longest that is.
    let hasty = Pipes { time_step_s: Some(100.0), ..Pipes::default() };
    assert_eq!(PipesKernel::new("erode", &hasty, 7.0), PipesKernel::new("erode", &Pipes::default(), 7.0));
}
