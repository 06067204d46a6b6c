//! Few colours for a picture of many: median cut (Heckbert 1982).

use std::collections::HashMap;

/// Colours of a palette at most.
const MAX_COLOURS: usize = 256;

/// A picture as places in a palette.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Indexed {
    /// Red, green and blue of each colour.
    pub(crate) palette: Vec<u8>,
    /// One a pixel.
    pub(crate) indices: Vec<u8>,
}

/// A colour and how many pixels have it.
type Counted = ([u8; 3], u64);

impl Indexed {
    /// Of red, green and blue, pixel by pixel.
    pub(crate) fn of(rgb: &[u8]) -> Self {
        let (pixels, _) = rgb.as_chunks::<3>();
        let mut counts: HashMap<[u8; 3], u64> = HashMap::new();
        for pixel in pixels {
            *counts.entry(*pixel).or_default() += 1;
        }
        let mut all: Vec<Counted> = counts.into_iter().collect();
        // The order of a hash map is not the same twice.
        all.sort_unstable();
        let mut boxes = vec![all];
        while boxes.len() < MAX_COLOURS {
            let widest = boxes.iter().enumerate().max_by_key(|(_, colours)| urgency(colours));
            let Some((index, _)) = widest.filter(|(_, colours)| colours.len() > 1) else { break };
            let (low, high) = halves(boxes.swap_remove(index));
            boxes.extend([low, high]);
        }
        let mut palette = Vec::with_capacity(3 * boxes.len());
        let mut place_of = HashMap::new();
        for (place, colours) in (0..=u8::MAX).zip(&boxes) {
            palette.extend(mean(colours));
            place_of.extend(colours.iter().map(|(colour, _)| (*colour, place)));
        }
        let indices = pixels.iter().map(|pixel| place_of.get(pixel).copied().unwrap_or_default()).collect();
        Self { palette, indices }
    }
}

/// The channel in which colours differ the most, and by how much.
fn widest_channel(colours: &[Counted]) -> (usize, u8) {
    let mut low = [u8::MAX; 3];
    let mut high = [0; 3];
    for (colour, _) in colours {
        for ((low, high), channel) in low.iter_mut().zip(&mut high).zip(colour) {
            (*low, *high) = ((*low).min(*channel), (*high).max(*channel));
        }
    }
    let extents = high.iter().zip(low).map(|(high, low)| high.saturating_sub(low));
    extents.enumerate().max_by_key(|(_, extent)| *extent).unwrap_or_default()
}

/// Which box is cut next: one of many pixels that differ much. A few odd pixels may keep a colour that is not quite theirs.
fn urgency(colours: &[Counted]) -> u64 {
    let num_pixels: u64 = colours.iter().map(|(_, count)| count).sum();
    let (_, extent) = widest_channel(colours);
    num_pixels.isqrt() * u64::from(extent) * u64::from(extent)
}

/// Cuts where half of the pixels lie on each side; neither half is empty where there are two colours.
fn halves(mut colours: Vec<Counted>) -> (Vec<Counted>, Vec<Counted>) {
    let (channel, _) = widest_channel(&colours);
    colours.sort_by_key(|(colour, _)| colour.get(channel).copied());
    let half = colours.iter().map(|(_, count)| count).sum::<u64>() / 2;
    let mut before = 0;
    let middle = colours.iter().take_while(|(_, count)| {
        before += count;
        before <= half
    });
    let middle = middle.count().clamp(1, colours.len().saturating_sub(1).max(1));
    let high = colours.split_off(middle.min(colours.len()));
    (colours, high)
}

fn mean(colours: &[Counted]) -> [u8; 3] {
    let num_pixels: u64 = colours.iter().map(|(_, count)| count).sum();
    let mut sums = [num_pixels / 2; 3];
    for (colour, count) in colours {
        for (sum, channel) in sums.iter_mut().zip(colour) {
            *sum += count * u64::from(*channel);
        }
    }
    sums.map(|sum| (sum / num_pixels.max(1)) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn back(indexed: &Indexed) -> Vec<u8> {
        let colour = |index: &u8| indexed.palette[3 * *index as usize..][..3].to_vec();
        indexed.indices.iter().flat_map(colour).collect()
    }

    #[test]
    fn few_colours_stay_as_they_are() {
        let rgb: Vec<u8> = (0..100_u8).flat_map(|k| [k, 255 - k, 7]).collect();
        assert_eq!(back(&Indexed::of(&rgb)), rgb);
        assert_eq!(back(&Indexed::of(&[1, 2, 3])), [1, 2, 3]);
        assert!(Indexed::of(&[]).indices.is_empty());
    }

    #[test]
    fn many_colours_stay_near() {
        let rgb: Vec<u8> = (0..60_000_u32).flat_map(|k| [(k % 256) as u8, (k / 256) as u8, 0]).collect();
        let indexed = Indexed::of(&rgb);
        assert!(indexed.palette.len() <= 3 * MAX_COLOURS);
        let worst = back(&indexed).iter().zip(&rgb).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
        assert!(worst <= 24, "{worst}");
    }
}
