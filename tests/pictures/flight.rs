//! A flight over real ground: no frame jumps against those around it.

use orogeny_engine::{Flight, Mode, Quiet, ViewRequest};

use crate::views::{difference, frazier};

const NUM_FRAMES: usize = 120;

/// Along a way that goes down to the ground and up again, tiles are taken apart and put together all the time.
fn way(frames: usize) -> Flight {
    let keys = r#"[{"eye": [3000, 4000, 25000], "target": [12000, 1000, 15000]}, {"eye": [9000, 2500, 17000], "target": [15000, 1200, 11000]},
        {"eye": [13000, 3200, 12000], "target": [20000, 1000, 6000]}]"#;
    Flight::from_json(&format!(r#"{{"frames": {frames}, "keys": {keys}}}"#)).unwrap()
}

/// How much each picture differs from the one before it.
fn steps(mode: Mode) -> Vec<f64> {
    let folder = tempfile::tempdir().unwrap();
    let terrain = frazier(folder.path());
    let request = ViewRequest {
        size_px: [96, 54],
        mode,
        has_shadows: false,
        max_error_px: 4.0,
        ..ViewRequest::default()
    };
    let mut view = terrain.view(request.size_px).unwrap();
    let pictures: Vec<_> = way(NUM_FRAMES)
        .frames(&request)
        .map(|request| view.draw(&request, &mut Quiet).unwrap().picture.rgb)
        .collect();
    assert_eq!(pictures.len(), NUM_FRAMES);
    pictures.windows(2).map(|pair| difference(&pair[0], &pair[1]).0).collect()
}

/// The step that stands out most from the larger of those on both sides of it.
fn worst(steps: &[f64]) -> (usize, f64) {
    let stands_out = steps.windows(3).map(|three| three[1] / three[0].max(three[2]).max(0.2));
    stands_out.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap()
}

#[test]
fn nothing_pops_on_a_flight() {
    let steps = steps(Mode::Shaded);
    let (place, times) = worst(&steps);
    assert!(
        times < 1.3,
        "frame {place} jumps: {times} times as much as its neighbours, {:?}",
        &steps[place..place + 3]
    );
    assert!(steps.iter().all(|step| *step > 0.0), "the flight stands still");
}

#[test]
fn a_jump_would_be_seen() {
    let mut steps = vec![3.0; 20];
    steps[7] = 5.0;
    assert_eq!(worst(&steps).0, 6);
    assert!(worst(&steps).1 > 1.3);
}
