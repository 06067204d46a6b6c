//! Measurements with their spread.

use std::num::NonZero;
use std::time::Instant;

/// Repeated measurements of one thing, in seconds.
#[derive(Debug, Clone, Default)]
pub struct Times {
    seconds: Vec<f64>,
}

/// The middle one of repeated measurements, and how far they lie apart.
#[derive(Debug, Clone, Copy)]
pub struct Spread {
    pub median: f64,
    pub lowest: f64,
    pub highest: f64,
}

impl Times {
    /// Measures one run.
    pub fn measure<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        self.seconds.push(start.elapsed().as_secs_f64());
        result
    }

    /// Adds what was measured elsewhere.
    pub fn add(&mut self, seconds: f64) {
        self.seconds.push(seconds);
    }

    /// Whether nothing was measured.
    pub const fn is_empty(&self) -> bool {
        self.seconds.is_empty()
    }

    /// The middle one.
    pub fn median_s(&self) -> f64 {
        self.spread_s().median
    }

    /// The time under which this share of all lies.
    pub fn percentile_s(&self, share: f64) -> f64 {
        let mut seconds = self.seconds.clone();
        seconds.sort_by(f64::total_cmp);
        let at = (seconds.len().saturating_sub(1) as f64 * share).round() as usize;
        seconds.get(at).copied().unwrap_or(f64::NAN)
    }

    /// The middle one, the fastest and the slowest.
    pub fn spread_s(&self) -> Spread {
        Spread::of(self.seconds.clone())
    }

    /// What `amount` in each measured time comes to in a second.
    pub fn per_second(&self, amount: f64) -> Spread {
        let Spread { median, lowest, highest } = self.spread_s();
        Spread { median: amount / median, lowest: amount / highest, highest: amount / lowest }
    }
}

impl Spread {
    /// Of measurements; not a number where there are none.
    pub fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let at = |value: Option<&f64>| value.copied().unwrap_or(f64::NAN);
        Self {
            median: at(values.get(values.len() / 2)),
            lowest: at(values.first()),
            highest: at(values.last()),
        }
    }
}

/// One thread, and as many as there are cores.
///
/// # Errors
/// When the system does not tell how many cores there are.
pub fn thread_counts() -> std::io::Result<Vec<usize>> {
    let mut counts = vec![1, std::thread::available_parallelism().map(NonZero::get)?];
    counts.dedup();
    Ok(counts)
}
