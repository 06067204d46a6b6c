//! Brushes with all that has to be found out for them found out.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use orogeny_field::noise::{Noise, Normalization};
use orogeny_field::{Brush, BrushType, Gate};
use orogeny_reference::noise::normalization;

/// The same brush with all that has to be found out for it found out: what its noises are normalised by.
#[must_use]
pub fn resolved(brush: &Brush) -> Brush {
    let mut brush = brush.clone();
    if brush.brush_type == BrushType::Noise {
        resolve(&mut brush.noise);
    }
    for gate in [&mut brush.gate, &mut brush.hardness].into_iter().flatten() {
        resolve_gate(gate);
    }
    brush
}

/// Finds out what the noise of a gate that belongs to no brush is normalised by.
pub fn resolve_gate(gate: &mut Gate) {
    if let Some(noise) = &mut gate.noise {
        resolve(&mut noise.noise);
    }
}

/// Normalising takes tens of milliseconds, and the next stroke most often has the same noise.
static NORMALIZED: Mutex<VecDeque<(Noise, Normalization)>> = Mutex::new(VecDeque::new());
const MAX_NORMALIZED: usize = 64;

fn resolve(noise: &mut Noise) {
    if noise.normalization != Normalization::Wanted {
        return;
    }
    // A thread that failed while it had the list leaves it whole: it is only pushed to.
    let known = |list: &VecDeque<(Noise, Normalization)>| {
        list.iter().find(|(known, _)| known == noise).map(|(_, numbers)| *numbers)
    };
    let lock = || NORMALIZED.lock().unwrap_or_else(PoisonError::into_inner);
    let found = known(&lock());
    let numbers = found.unwrap_or_else(|| {
        let (offset, scale) = normalization(noise);
        let numbers = Normalization::Given { offset, scale };
        let mut list = lock();
        list.truncate(MAX_NORMALIZED - 1);
        list.push_front((noise.clone(), numbers));
        numbers
    });
    noise.normalization = numbers;
}
