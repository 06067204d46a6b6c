//! Level and set height.

use orogeny_field::{Blending, Brush, BrushType, LevelOnly};

use crate::agreement::back_ends_agree;
use crate::numpy::assert_stroke_matches;

fn brushes() -> Vec<(&'static str, Brush)> {
    let level = Brush::new(BrushType::Level, 1.0, 1.0);
    let build_up = Brush { blending: Blending::BuildUp, ..level.clone() };
    let set_height = Brush { height_m: Some(-73.25), ..Brush::new(BrushType::SetHeight, 1.0, 1.0) };
    vec![
        ("level, wash", level.clone()),
        ("level, wash, cut", Brush { only: LevelOnly::Cut, ..level.clone() }),
        ("level, wash, fill", Brush { only: LevelOnly::Fill, height_m: Some(300.0), ..level }),
        ("level, build-up", Brush { height_m: Some(1_250.75), ..build_up.clone() }),
        ("level, build-up, cut", Brush { only: LevelOnly::Cut, ..build_up.clone() }),
        ("level, build-up, fill", Brush { only: LevelOnly::Fill, ..build_up }),
        ("set height, wash", set_height.clone()),
        ("set height, build-up", Brush { blending: Blending::BuildUp, ..set_height }),
    ]
}

back_ends_agree!(brushes);

#[test]
fn matches_numpy() {
    assert_stroke_matches("level_wash");
    assert_stroke_matches("level_build_up");
    assert_stroke_matches("set_height");
}
