//! What a brush makes of a plane, by the CPU executor, all at once.

use orogeny_brush::{CpuExecutor, resolved};
use orogeny_field::{PageLayout, Procedure, SampleRect};
use orogeny_tests::{Feed, Operation, paint};

use super::{Plain, Sheet};

/// `None` where its features are all too fine for the level.
pub fn brushed(plain: &Plain<'_>, procedure: &Procedure, ground: &Sheet) -> Option<Sheet> {
    assert_eq!(ground.off, 0.0, "what steps and powers make of what is off has no bound");
    let layout = PageLayout::new(1024).unwrap();
    let plane = ground.plane();
    let region = SampleRect::new(0, 0, plane.width() as i32, plane.depth() as i32);
    let brush = resolved(&procedure.brush);
    let fill = Operation::Fill { brush, seed: procedure.seed, region };
    let mut executor = CpuExecutor::new(layout, 64 << 20, Some(1)).unwrap();
    let painted = paint(&plane, plain.grid().spacing_m(), &[fill], &mut executor, layout, Feed::WHOLE);
    match painted {
        Err(orogeny_brush::Error::Field(orogeny_field::Error::FeatureSize { .. })) if plain.level > 0 => None,
        painted => Some(Sheet::of(&painted.unwrap().plane)),
    }
}
