//! Samples as files store them, and heights.
//!
//! Between a decoder and the nodata policy a sample with no usable height is NaN, and only that: [`clean`] is the
//! one door, and it looks at bits.

use crate::format::{ByteOrder, SampleType};
use crate::options::MAX_HEIGHT_M;

/// The mark of a sample with no usable height.
pub(crate) const NO_HEIGHT: f32 = f32::NAN;

/// A height as it may be delivered: NaN, infinities and magnitudes above [`MAX_HEIGHT_M`] become [`NO_HEIGHT`],
/// denormals and −0 become +0.
pub(crate) fn clean(height_m: f32) -> f32 {
    const EXPONENT: u32 = 0x7f80_0000;
    match height_m.to_bits() & EXPONENT {
        0 => 0.0,
        EXPONENT => NO_HEIGHT,
        _ if height_m.abs() > MAX_HEIGHT_M => NO_HEIGHT,
        _ => height_m,
    }
}

/// Turns stored samples into heights.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Decoding {
    sample: SampleType,
    byte_order: ByteOrder,
    /// The stored value that means "no data".
    void: Option<f64>,
    /// Metres of the stored 0, and metres per step.
    scale: Option<(f64, f64)>,
}

impl Decoding {
    /// Samples that are metres.
    pub fn new(sample: SampleType, byte_order: ByteOrder) -> Self {
        Self { sample, byte_order, void: None, scale: None }
    }

    /// Makes one stored value mean "no data". Of f32 samples it is the f32 nearest to `void`.
    #[expect(clippy::cast_possible_truncation, reason = "f32 samples are compared as f32")]
    pub fn with_void(mut self, void: Option<f64>) -> Self {
        self.void = match self.sample {
            SampleType::F32 => void.map(|void| f64::from(void as f32)),
            _ => void,
        };
        self
    }

    /// Maps 0 to the greatest sample to a range of heights in metres.
    pub fn with_range(mut self, range_m: Option<(f64, f64)>) -> Self {
        self.scale = match (range_m, self.sample.range_maximum()) {
            (Some((low, high)), Some(maximum)) => Some((low, (high - low) / f64::from(maximum))),
            _ => None,
        };
        self
    }

    /// A factor on stored heights: metres per unit.
    pub fn with_unit(mut self, metres: f64) -> Self {
        if metres != 1.0 {
            self.scale = Some((0.0, metres));
        }
        self
    }

    /// Whether a sample can turn out to have no usable height.
    pub fn may_be_void(&self) -> bool {
        self.void.is_some() || self.sample.bytes() >= 4
    }

    /// Bytes in a row of `width` samples.
    pub fn row_bytes(&self, width: u32) -> u64 {
        u64::from(width) * u64::from(self.sample.bytes())
    }

    /// Turns stored bytes into heights, as many as both hold.
    pub fn decode(&self, bytes: &[u8], heights_m: &mut [f32]) {
        match self.sample {
            SampleType::U8 => self.each(bytes, heights_m, |[byte]: [u8; 1]| f64::from(byte)),
            SampleType::I8 => self.each(bytes, heights_m, |bytes| f64::from(i8::from_le_bytes(bytes))),
            SampleType::U16 => self.each(bytes, heights_m, |bytes| f64::from(u16::from_le_bytes(bytes))),
            SampleType::I16 => self.each(bytes, heights_m, |bytes| f64::from(i16::from_le_bytes(bytes))),
            SampleType::U32 => self.each(bytes, heights_m, |bytes| f64::from(u32::from_le_bytes(bytes))),
            SampleType::I32 => self.each(bytes, heights_m, |bytes| f64::from(i32::from_le_bytes(bytes))),
            SampleType::F32 => self.each(bytes, heights_m, |bytes| f64::from(f32::from_le_bytes(bytes))),
            SampleType::F64 => self.each(bytes, heights_m, f64::from_le_bytes),
        }
    }

    fn each<const N: usize>(&self, bytes: &[u8], heights_m: &mut [f32], value: impl Fn([u8; N]) -> f64) {
        let (samples, _) = bytes.as_chunks::<N>();
        for (&sample, height_m) in samples.iter().zip(heights_m) {
            let mut sample = sample;
            if self.byte_order == ByteOrder::Big {
                sample.reverse();
            }
            *height_m = self.height_m(value(sample));
        }
    }

    /// The height of a stored value.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "heights are f32; what overflows is caught as infinite"
    )]
    fn height_m(&self, value: f64) -> f32 {
        if self.void == Some(value) {
            return NO_HEIGHT;
        }
        let height_m = match self.scale {
            Some((zero_m, step_m)) => zero_m + value * step_m,
            None => value,
        };
        clean(height_m as f32)
    }
}

/// Turns heights into samples to store, rounding to the nearest.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Encoding {
    sample: SampleType,
    byte_order: ByteOrder,
    /// Metres of the stored 0, metres per step.
    scale: (f64, f64),
    /// The least and the greatest stored value.
    bounds: (f64, f64),
}

impl Encoding {
    /// Samples of this type, over this range of heights if it is given.
    pub fn new(sample: SampleType, byte_order: ByteOrder, range_m: Option<(f64, f64)>) -> Self {
        let bounds = match sample {
            SampleType::U8 => (0.0, f64::from(u8::MAX)),
            SampleType::I8 => (f64::from(i8::MIN), f64::from(i8::MAX)),
            SampleType::U16 => (0.0, f64::from(u16::MAX)),
            // The least is every other program's mark of a void.
            SampleType::I16 => (f64::from(i16::MIN) + 1.0, f64::from(i16::MAX)),
            SampleType::U32 => (0.0, f64::from(u32::MAX)),
            SampleType::I32 => (f64::from(i32::MIN), f64::from(i32::MAX)),
            SampleType::F32 | SampleType::F64 => (f64::from(f32::MIN), f64::from(f32::MAX)),
        };
        let scale = range_m.map_or((0.0, 1.0), |(low, high)| (low, (high - low) / bounds.1));
        Self { sample, byte_order, scale, bounds }
    }

    /// The lowest and the highest height that fit, metres.
    pub fn range_m(&self) -> (f64, f64) {
        let (zero_m, step_m) = self.scale;
        (zero_m + self.bounds.0 * step_m, zero_m + self.bounds.1 * step_m)
    }

    /// Height between neighbouring samples, metres; 0 where heights are stored as they are.
    pub fn step_m(&self) -> f64 {
        if self.is_float() { 0.0 } else { self.scale.1 }
    }

    /// Whether a height fits once rounded.
    pub fn fits(&self, height_m: f32) -> bool {
        let stored = self.stored(height_m);
        stored >= self.bounds.0 && stored <= self.bounds.1
    }

    /// How far the stored height is from the height, metres.
    pub fn error_m(&self, height_m: f32) -> f64 {
        let (zero_m, step_m) = self.scale;
        (zero_m + self.stored(height_m) * step_m - f64::from(height_m)).abs()
    }

    /// Replaces `bytes` by the stored samples. A height that does not fit is stored as the nearest that does.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the value is rounded and within the type's bounds"
    )]
    pub fn encode(&self, heights_m: &[f32], bytes: &mut Vec<u8>) {
        bytes.clear();
        for &height_m in heights_m {
            let stored = self.stored(height_m).clamp(self.bounds.0, self.bounds.1);
            match self.sample {
                SampleType::U8 => self.push(bytes, (stored as u8).to_le_bytes()),
                SampleType::I8 => self.push(bytes, (stored as i8).to_le_bytes()),
                SampleType::U16 => self.push(bytes, (stored as u16).to_le_bytes()),
                SampleType::I16 => self.push(bytes, (stored as i16).to_le_bytes()),
                SampleType::U32 => self.push(bytes, (stored as u32).to_le_bytes()),
                SampleType::I32 => self.push(bytes, (stored as i32).to_le_bytes()),
                SampleType::F32 => self.push(bytes, height_m.to_le_bytes()),
                SampleType::F64 => self.push(bytes, f64::from(height_m).to_le_bytes()),
            }
        }
    }

    fn push<const N: usize>(&self, bytes: &mut Vec<u8>, mut sample: [u8; N]) {
        if self.byte_order == ByteOrder::Big {
            sample.reverse();
        }
        bytes.extend_from_slice(&sample);
    }

    /// The stored value of a height, before bounds.
    fn stored(&self, height_m: f32) -> f64 {
        let (zero_m, step_m) = self.scale;
        let exact = (f64::from(height_m) - zero_m) / step_m;
        if self.is_float() { exact } else { exact.round() }
    }

    fn is_float(&self) -> bool {
        matches!(self.sample, SampleType::F32 | SampleType::F64)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn only_usable_heights_pass() {
        for unusable in [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.000_001e7, -2.0e7, f32::MAX]
        {
            assert!(clean(unusable).is_nan(), "{unusable}");
        }
        for zero in [0.0, -0.0, f32::MIN_POSITIVE / 2.0, -f32::from_bits(1)] {
            assert_eq!(clean(zero).to_bits(), 0, "{zero}");
        }
        for usable in [1.0e7, -1.0e7, f32::MIN_POSITIVE, 8848.86] {
            assert_eq!(clean(usable), usable);
        }
    }

    #[test]
    fn a_void_written_in_decimals_is_the_nearest_f32() {
        let decoding = Decoding::new(SampleType::F32, ByteOrder::Little).with_void(Some(-9999.1));
        let bytes = [-9999.1_f32, -9999.0].map(f32::to_le_bytes).concat();
        let mut heights_m = [0.0; 2];
        decoding.decode(&bytes, &mut heights_m);
        assert!(heights_m[0].is_nan() && heights_m[1] == -9999.0, "{heights_m:?}");
    }

    #[test]
    fn a_range_maps_its_ends_exactly() {
        for (sample, low, high) in
            [(SampleType::U8, vec![0], vec![255]), (SampleType::U16, vec![0, 0], vec![255, 255])]
        {
            let decoding = Decoding::new(sample, ByteOrder::Little).with_range(Some((-100.0, 900.0)));
            let mut height_m = [0.0];
            decoding.decode(&low, &mut height_m);
            assert_eq!(height_m, [-100.0]);
            decoding.decode(&high, &mut height_m);
            assert_eq!(height_m, [900.0]);
        }
    }

    proptest! {
        #[test]
        fn whole_metres_survive_every_integer_type(height in -127_i8..=127, big_endian: bool) {
            let byte_order = if big_endian { ByteOrder::Big } else { ByteOrder::Little };
            for sample in [SampleType::I8, SampleType::I16, SampleType::I32, SampleType::F32, SampleType::F64] {
                let (mut bytes, mut back) = (Vec::new(), [0.0]);
                Encoding::new(sample, byte_order, None).encode(&[f32::from(height)], &mut bytes);
                Decoding::new(sample, byte_order).decode(&bytes, &mut back);
                prop_assert_eq!(back, [f32::from(height)]);
            }
        }

        #[test]
        fn a_ranged_height_comes_back_within_half_a_step(fraction in 0.0_f64..=1.0, low in -5e3_f64..5e3, extent in 0.1_f64..1e4) {
            let range_m = Some((low, low + extent));
            let height_m = (low + fraction * extent) as f32;
            for sample in [SampleType::U8, SampleType::U16] {
                let encoding = Encoding::new(sample, ByteOrder::Little, range_m);
                let (mut bytes, mut back) = (Vec::new(), [0.0_f32]);
                prop_assert!(encoding.fits(height_m));
                encoding.encode(&[height_m], &mut bytes);
                Decoding::new(sample, ByteOrder::Little).with_range(range_m).decode(&bytes, &mut back);
                // Half a step, and the last place of a height near 15 km.
                let tolerance_m = encoding.step_m() / 2.0 + 0.002;
                prop_assert!((f64::from(back[0]) - f64::from(height_m)).abs() <= tolerance_m);
            }
        }
    }
}
