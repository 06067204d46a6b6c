//! What each brush does to a row of heights, given the amount at each sample.
//!
//! Every `row` returns the number of heights that had to be clamped to what a terrain holds. `raise` also lowers, and
//! `level` also sets a height: the planner gives them the sign and the target.

pub mod blend;
pub mod ledge;
pub mod level;
pub mod mask;
pub mod noise;
pub mod raise;
pub mod ramp;
pub mod range_map;
pub mod roughen;
pub mod stamp;
pub mod terrace;
