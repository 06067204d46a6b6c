//! Runs one CPU kernel once, so that its instructions can be counted: `instructions KERNEL`, or `instructions` to list them.
//!
//! `cargo xtask instructions` runs each under callgrind, which counts within [`measured`] only, and compares the counts with those that
//! are kept in `counts.json`. A count is the same whatever else the machine does, so a kernel that became slower by a few
//! hundredths is seen where times would not show it. What is counted is the code for AVX2: callgrind knows no AVX-512.

#![expect(clippy::print_stdout, reason = "the kernels' names are what is asked for")]

mod brushes;
mod fields;
mod noises;
mod regions;

use std::hint::black_box;

use anyhow::bail;

/// What is counted.
type Work = Box<dyn FnMut()>;

/// A kernel on data of its own.
pub struct Kernel {
    name: &'static str,
    /// Makes the data, which is not counted, and gives the work, which is.
    prepare: fn() -> anyhow::Result<Work>,
}

fn main() -> anyhow::Result<()> {
    let kernels =
        || [brushes::KERNELS, noises::KERNELS, fields::KERNELS, regions::KERNELS].into_iter().flatten();
    let Some(wanted) = std::env::args().nth(1) else {
        kernels().for_each(|kernel| println!("{}", kernel.name));
        return Ok(());
    };
    let Some(kernel) = kernels().find(|kernel| kernel.name == wanted) else {
        bail!("there is no kernel `{wanted}`; without a name they are listed");
    };
    let mut work = (kernel.prepare)()?;
    // Whatever is looked up once, such as what the processor can do, is not counted.
    work();
    measured(&mut work);
    Ok(())
}

/// What is counted; callgrind knows it by its name.
#[inline(never)]
fn measured(work: &mut dyn FnMut()) {
    black_box(work)();
}

/// Samples a row, and rows, that a kernel of rows works on.
const WIDTH: usize = 1024;
const DEPTH: usize = 32;

/// Values that no compiler knows, and that are the same each time.
fn rough(number: usize) -> f32 {
    300.0 + 50.0 * orogeny_field::hash::uniform((number % WIDTH) as u32, (number / WIDTH) as u32, 1)
}

/// So many of them.
fn rough_values(num: usize) -> Vec<f32> {
    (0..num).map(rough).collect()
}

/// The same, brought within 0..1.
fn rough_weights(num: usize) -> Vec<f32> {
    (0..num).map(|number| rough(number) / 400.0).collect()
}
