//! Every struct that a shader binds has the layout of its Rust mirror, and every numbered constant its Rust number.
//!
//! The shaders' side is naga's reflection; a struct without a mirror fails, and so does a mirror without a struct.

#![cfg(test)]

mod constants;
mod structs;
