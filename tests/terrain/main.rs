//! What the engine keeps of a terrain, whatever happens to it: kills in mid-stroke, logs that lose their end, flipped bits,
//! failing disks, ten thousand strokes, a million samples a side, a history that may not grow, commits behind the painting.
//!
//! All on the CPU back end. Each test that needs another process starts this binary again, in the role that an environment
//! variable names.

#![cfg(test)]
#![cfg(unix)]

mod behind;
mod budget;
mod flipped;
mod kill;
mod painter;
mod scale;
mod small_disk;
mod support;
mod torn;
mod vast;

// Faults at the level of system calls, by strace.
#[cfg(target_os = "linux")]
mod writes_fail;
