//! Every brush on both back ends, and both against what NumPy makes of the specification.
//!
//! One file a stage; [`agreement`] is the comparison that they share.

#![cfg(test)]

mod agreement;
mod blend;
mod centre_line;
mod cloning;
mod drainage;
mod erosion;
mod ledge;
mod level;
mod mask;
mod noise;
mod numpy;
mod raise;
mod ramp;
mod range_map;
mod roughen;
mod stamp;
mod terrace;
