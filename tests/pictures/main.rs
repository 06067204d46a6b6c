//! What is drawn: against the geometry on the CPU, against pictures that people have looked at, and against itself from elsewhere, later, and with
//! less memory.

#![cfg(test)]
mod budget;
mod flight;
mod golden;
mod ground;
mod surface;
mod views;
