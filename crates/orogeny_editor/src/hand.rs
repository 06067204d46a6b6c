//! What the left button does over the ground.

use orogeny_engine::SelectCombine;
use serde_json::{Value, json};

/// What is in the hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Hand {
    /// The brush.
    #[default]
    Brush,
    /// A rectangle that selects, along the terrain's sides.
    Rectangle,
    /// A line around what is selected.
    Lasso,
    /// A tape that measures.
    Tape,
}

impl Hand {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Brush, Self::Rectangle, Self::Lasso, Self::Tape];

    /// Never changes: what preferences call it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Brush => "brush",
            Self::Rectangle => "rectangle",
            Self::Lasso => "lasso",
            Self::Tape => "tape",
        }
    }

    /// What people call what it does.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::Brush => "Draw with the brush",
            Self::Rectangle => "Select a rectangle",
            Self::Lasso => "Select with a lasso",
            Self::Tape => "Measure",
        }
    }

    /// Whether it selects.
    #[must_use]
    pub const fn selects(self) -> bool {
        matches!(self, Self::Rectangle | Self::Lasso)
    }
}

/// How what is outlined joins what was selected before: with Shift it is added, with Ctrl taken away, with both only what is in both stays.
#[must_use]
pub const fn combine_of(modifiers: egui::Modifiers) -> SelectCombine {
    match (modifiers.shift, modifiers.command) {
        (false, false) => SelectCombine::Replace,
        (true, false) => SelectCombine::Add,
        (false, true) => SelectCombine::Subtract,
        (true, true) => SelectCombine::Intersect,
    }
}

/// The corners of the rectangle along the axes between two places, once around; `[x, z]` in metres.
#[must_use]
pub const fn corners_m([x0, z0]: [f64; 2], [x1, z1]: [f64; 2]) -> [[f64; 2]; 4] {
    [[x0, z0], [x1, z0], [x1, z1], [x0, z1]]
}

/// `[x, z, width, depth]` in metres of the rectangle between two places; `None` where one of its sides is shorter than a length.
#[must_use]
pub fn rectangle_m(from_m: [f64; 2], to_m: [f64; 2], least_m: f64) -> Option<[f64; 4]> {
    let low = [from_m[0].min(to_m[0]), from_m[1].min(to_m[1])];
    let size = [(to_m[0] - from_m[0]).abs(), (to_m[1] - from_m[1]).abs()];
    size.iter().all(|side| *side >= least_m).then_some([low[0], low[1], size[0], size[1]])
}

/// The operation that selects what was outlined; `None` where that is hardly more than a click. What is within `least_m` is one place.
#[must_use]
pub fn select_json(hand: Hand, path_m: &[[f64; 2]], combine: SelectCombine, least_m: f64) -> Option<Value> {
    let shape = match (hand, path_m) {
        (Hand::Rectangle, [from_m, .., to_m]) => json!({"rectangle": rectangle_m(*from_m, *to_m, least_m)?}),
        (Hand::Lasso, path_m) if path_m.len() >= 3 && area_m2(path_m) >= least_m * least_m => {
            json!({"lasso": path_m})
        }
        _ => return None,
    };
    Some(json!({"op": "select", "shape": shape, "combine": combine}))
}

/// The area that a line around it has, square metres, by the rule of the shoelace.
#[must_use]
pub fn area_m2(corners_m: &[[f64; 2]]) -> f64 {
    let next = corners_m.iter().cycle().skip(1);
    let twice: f64 = corners_m.iter().zip(next).map(|([x0, z0], [x1, z1])| x0 * z1 - x1 * z0).sum();
    twice.abs() / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_is_the_same_from_each_of_its_corners() {
        let corners = corners_m([10.0, 40.0], [30.0, 25.0]);
        for (from, to) in [(0, 2), (1, 3), (2, 0), (3, 1)] {
            assert_eq!(rectangle_m(corners[from], corners[to], 1.0), Some([10.0, 25.0, 20.0, 15.0]));
        }
        assert_eq!(rectangle_m([10.0, 40.0], [10.5, 90.0], 1.0), None, "a click is none");
        assert_eq!(area_m2(&corners), 300.0);
        assert_eq!(area_m2(&[[0.0, 0.0], [4.0, 0.0], [0.0, 3.0]]), 6.0);
        assert_eq!(area_m2(&[]), 0.0);
    }
}
