//! Page frames: a header of 40 bytes, little-endian, and the samples.

/// Bytes before the samples.
pub const FRAME_HEADER_BYTES: usize = 40;
const MAGIC: [u8; 4] = *b"OROG";
const VERSION: u16 = 1;
/// The heights of all layers together.
const COMPOSITE: u16 = 0;

/// How samples are sent.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FrameFormat {
    /// 32-bit floats, metres.
    #[default]
    R32,
    /// Two 32-bit floats, the height of 0 and the metres a step, then unsigned 16-bit samples.
    R16,
}

/// What a frame says before its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameHeader {
    /// Level of the page.
    pub level: u8,
    /// How its samples are sent.
    pub format: FrameFormat,
    /// Samples along x.
    pub width: u16,
    /// Samples along z.
    pub depth: u16,
    /// The page, along x.
    pub x: u32,
    /// The page, along z.
    pub z: u32,
    /// As of when it is.
    pub revision: u64,
    /// Bytes that follow.
    pub payload_in_bytes: u32,
}

impl FrameHeader {
    /// As bytes.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; FRAME_HEADER_BYTES] {
        let mut bytes = Vec::with_capacity(FRAME_HEADER_BYTES);
        bytes.extend(MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(COMPOSITE.to_le_bytes());
        bytes.extend([self.level, self.format as u8]);
        bytes.extend(self.width.to_le_bytes());
        bytes.extend(self.depth.to_le_bytes());
        bytes.extend([0; 2]);
        bytes.extend(self.x.to_le_bytes());
        bytes.extend(self.z.to_le_bytes());
        bytes.extend(self.revision.to_le_bytes());
        bytes.extend(self.payload_in_bytes.to_le_bytes());
        let mut header = [0; FRAME_HEADER_BYTES];
        header.iter_mut().zip(bytes).for_each(|(to, from)| *to = from);
        header
    }

    /// Reads a header, and the bytes behind it; `None` for anything that is no frame of this version.
    #[must_use]
    pub fn read(bytes: &[u8]) -> Option<(Self, &[u8])> {
        let (header, payload) = bytes.split_first_chunk::<FRAME_HEADER_BYTES>()?;
        let u16_at = |at: usize| Some(u16::from_le_bytes(*header.get(at..)?.first_chunk()?));
        let u32_at = |at: usize| Some(u32::from_le_bytes(*header.get(at..)?.first_chunk()?));
        let format = match header.get(9)? {
            0 => FrameFormat::R32,
            1 => FrameFormat::R16,
            _ => return None,
        };
        let read = Self {
            level: *header.get(8)?,
            format,
            width: u16_at(10)?,
            depth: u16_at(12)?,
            x: u32_at(16)?,
            z: u32_at(20)?,
            revision: u64::from_le_bytes(*header.get(24..)?.first_chunk()?),
            payload_in_bytes: u32_at(32)?,
        };
        // What is reserved is zero, and the length is that of what follows: so a frame is read in one way alone.
        (read.to_bytes() == *header && read.payload_in_bytes as usize == payload.len())
            .then_some((read, payload))
    }
}

/// A frame of samples, row by row. `header` says all but how many bytes follow.
pub(crate) fn encode(header: FrameHeader, heights: &[f32]) -> Vec<u8> {
    let payload_in_bytes = match header.format {
        FrameFormat::R32 => heights.len() * 4,
        FrameFormat::R16 => heights.len() * 2 + 8,
    };
    // A page has 2^16 samples.
    let header = FrameHeader { payload_in_bytes: payload_in_bytes as u32, ..header };
    let mut bytes = Vec::with_capacity(FRAME_HEADER_BYTES + payload_in_bytes);
    bytes.extend(header.to_bytes());
    match header.format {
        FrameFormat::R32 if cfg!(target_endian = "little") => {
            bytes.extend(bytemuck::cast_slice::<f32, u8>(heights))
        }
        FrameFormat::R32 => bytes.extend(heights.iter().flat_map(|height_m| height_m.to_le_bytes())),
        FrameFormat::R16 => {
            let (low, high) =
                heights.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), height| {
                    (low.min(*height), high.max(*height))
                });
            let (low, step) = if low < high { (low, (high - low) / f32::from(u16::MAX)) } else { (low, 0.0) };
            bytes.extend(low.to_le_bytes());
            bytes.extend(step.to_le_bytes());
            let per_step = if step > 0.0 { 1.0 / step } else { 0.0 };
            let coded = heights.iter().map(|height| ((height - low) * per_step).round() as u16);
            bytes.extend(coded.flat_map(u16::to_le_bytes));
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn header(
        format: FrameFormat,
        (width, depth): (u16, u16),
        at: (u8, u32, u32),
        revision: u64,
    ) -> FrameHeader {
        let (level, x, z) = at;
        FrameHeader { level, format, width, depth, x, z, revision, payload_in_bytes: 0 }
    }

    #[test]
    fn the_bytes_are_those_of_the_documentation() {
        let frame = encode(header(FrameFormat::R32, (2, 1), (3, 5, 7), 258), &[1.0, -2.0]);
        let expected: Vec<u8> = [
            b"OROG".as_slice(),
            &[1, 0, 0, 0, 3, 0, 2, 0, 1, 0, 0, 0, 5, 0, 0, 0, 7, 0, 0, 0],
            &[2, 1, 0, 0, 0, 0, 0, 0, 8, 0, 0, 0, 0, 0, 0, 0],
            &[0, 0, 128, 63, 0, 0, 0, 192],
        ]
        .concat();
        assert_eq!(frame, expected);
    }

    proptest! {
        #[test]
        fn what_is_written_is_read(
            side in (1_u16..=20, 1_u16..=20), at in any::<(u8, u32, u32)>(), revision: u64,
            seed in -1e5_f32..1e5, span in 0_f32..1e4,
        ) {
            let count = usize::from(side.0) * usize::from(side.1);
            let heights: Vec<f32> = (0..count).map(|k| seed + span * ((k * 7919) % 101) as f32 / 101.0).collect();
            let frame = encode(header(FrameFormat::R32, side, at, revision), &heights);
            let (read, payload) = FrameHeader::read(&frame).unwrap();
            prop_assert_eq!(read.revision, revision);
            prop_assert_eq!((read.width, read.depth, read.level, read.x, read.z), (side.0, side.1, at.0, at.1, at.2));
            let back: Vec<f32> = payload.chunks(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect();
            prop_assert_eq!(&back, &heights);

            let frame = encode(header(FrameFormat::R16, side, at, revision), &heights);
            let (read, payload) = FrameHeader::read(&frame).unwrap();
            prop_assert_eq!(read.format, FrameFormat::R16);
            let float = |at: usize| f32::from_le_bytes(payload[at..at + 4].try_into().unwrap());
            let (low, step) = (float(0), float(4));
            for (coded, height) in payload[8..].chunks(2).zip(&heights) {
                let coded = u16::from_le_bytes(coded.try_into().unwrap());
                // Half a step, and what floats of this size round by.
                let error = (low + step * f32::from(coded) - height).abs();
                prop_assert!(error <= step * 0.51 + seed.abs().max(1.0) * 4.0 * f32::EPSILON, "{error} of {step}");
            }
        }

        #[test]
        fn nothing_else_is_a_frame(bytes in proptest::collection::vec(any::<u8>(), 0..120), cut in 0_usize..48, flip in 0_usize..40) {
            if let Some((header, payload)) = FrameHeader::read(&bytes) {
                prop_assert_eq!(&bytes[..40], &header.to_bytes()[..]);
                prop_assert_eq!(payload.len(), header.payload_in_bytes as usize);
            }
            let frame = encode(header(FrameFormat::R32, (2, 1), (0, 0, 0), 1), &[1.0, 2.0]);
            prop_assert!(FrameHeader::read(&frame[..cut.min(frame.len() - 1)]).is_none());
            let mut claimed = frame;
            // A length of up to 4 GiB that is not there, or another magic, version or reserved byte.
            if (0..8).contains(&flip) || (14..16).contains(&flip) || flip >= 32 {
                claimed[flip] ^= 0xff;
                prop_assert!(FrameHeader::read(&claimed).is_none(), "byte {}", flip);
            }
        }
    }
}
