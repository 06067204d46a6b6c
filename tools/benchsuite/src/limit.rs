//! The machine's own limit: how fast memory can be copied.

use std::hint::black_box;
use std::thread;

use crate::measure::Times;

/// Samples of each of the two arrays: 512 MiB, beyond any cache.
const NUM_SAMPLES: usize = 128 << 20;

/// Two arrays to copy between.
pub struct CopyLimit {
    from: Vec<f32>,
    to: Vec<f32>,
}

impl CopyLimit {
    pub fn new() -> Self {
        Self { from: vec![1.0; NUM_SAMPLES], to: vec![0.0; NUM_SAMPLES] }
    }

    /// Bytes read and written by one copy.
    pub const fn bytes() -> f64 {
        (NUM_SAMPLES * 8) as f64
    }

    /// One copy with a plain load and store loop on so many threads.
    pub fn copy(&mut self, times: &mut Times, num_threads: usize) {
        let share = NUM_SAMPLES.div_ceil(num_threads);
        times.measure(|| {
            thread::scope(|scope| {
                for (from, to) in self.from.chunks(share).zip(self.to.chunks_mut(share)) {
                    scope.spawn(move || copy_loop(from, to));
                }
            });
        });
        black_box(&self.to);
    }
}

/// The addition keeps it a loop: a plain copy becomes a call of the C library, whose stores go past the cache.
#[inline(never)]
fn copy_loop(from: &[f32], to: &mut [f32]) {
    for (from, to) in from.iter().zip(to) {
        *to = *from + 1.0;
    }
}
