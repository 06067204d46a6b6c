//! The codecs that are compared.

use anyhow::{Context as _, Result};
use orogeny_store::codec;
use zstd::bulk::{Compressor, Decompressor};

use super::filters::Filter;
use crate::ground::{PAGE_BYTES, SIDE};

/// As the product.
const ZSTD_LEVEL: i32 = 1;

/// How a change of a page becomes values.
#[derive(Clone, Copy)]
pub enum Delta {
    /// The wrapping difference of ordered integers.
    Ordered,
    /// The exclusive or of the bits.
    Xor,
}

/// One way of coding a page.
pub struct Candidate {
    pub name: &'static str,
    pub delta: Delta,
    coding: Coding,
}

enum Coding {
    Filtered(Filter, Compression),
    /// `orogeny_store::codec`, as it is called when pages are written.
    Product,
}

enum Compression {
    Lz4,
    Zstd,
}

/// What every candidate may reuse from page to page, as the product does.
pub struct Workspace {
    residuals: Vec<u32>,
    bytes: Vec<u8>,
    coded: Vec<u8>,
    compressor: Compressor<'static>,
    decompressor: Decompressor<'static>,
}

impl Workspace {
    pub fn new() -> Result<Self> {
        let bound =
            zstd::compress_bound(PAGE_BYTES).max(lz4_flex::block::get_maximum_output_size(PAGE_BYTES));
        Ok(Self {
            residuals: vec![0; SIDE * SIDE],
            bytes: vec![0; PAGE_BYTES],
            coded: vec![0; bound],
            compressor: Compressor::new(ZSTD_LEVEL)?,
            decompressor: Decompressor::new()?,
        })
    }
}

pub fn all() -> Vec<Candidate> {
    use Coding::{Filtered, Product};
    use Compression::{Lz4, Zstd};
    use Delta::{Ordered, Xor};
    let candidate = |name, delta, coding| Candidate { name, delta, coding };
    vec![
        candidate("zstd 1", Ordered, Filtered(Filter::None, Zstd)),
        candidate("XOR shuffle zstd 1", Xor, Filtered(Filter::Shuffle, Zstd)),
        candidate("shuffle zstd 1", Ordered, Filtered(Filter::Shuffle, Zstd)),
        candidate("Lorenzo shuffle lz4", Ordered, Filtered(Filter::LorenzoShuffle, Lz4)),
        candidate("Lorenzo shuffle zstd 1 (codec 1)", Ordered, Filtered(Filter::LorenzoShuffle, Zstd)),
        candidate("Lorenzo shift shuffle zstd 1", Ordered, Filtered(Filter::LorenzoShiftShuffle, Zstd)),
        candidate("the product", Ordered, Product),
    ]
}

impl Candidate {
    pub fn encode(&self, values: &[u32], workspace: &mut Workspace) -> Result<Vec<u8>> {
        let Coding::Filtered(filter, compression) = &self.coding else {
            return Ok(codec::encode(values, SIDE)?);
        };
        let Workspace { residuals, bytes, coded, compressor, .. } = workspace;
        let shift = filter.apply(values, residuals, bytes);
        let size_in_bytes = match compression {
            Compression::Lz4 => lz4_flex::block::compress_into(bytes, coded)?,
            Compression::Zstd => compressor.compress_to_buffer(bytes, coded.as_mut_slice())?,
        };
        let mut page = Vec::with_capacity(1 + size_in_bytes);
        page.push(shift);
        page.extend_from_slice(coded.get(..size_in_bytes).unwrap_or_default());
        Ok(page)
    }

    pub fn decode(&self, coded: &[u8], workspace: &mut Workspace) -> Result<Vec<u32>> {
        let Coding::Filtered(filter, compression) = &self.coding else {
            return Ok(codec::decode(codec::WRITTEN, coded, SIDE)?);
        };
        let Workspace { bytes, decompressor, .. } = workspace;
        let (shift, coded) = coded.split_first().context("there are no bytes")?;
        match compression {
            Compression::Lz4 => lz4_flex::block::decompress_into(coded, bytes)?,
            Compression::Zstd => decompressor.decompress_to_buffer(coded, bytes.as_mut_slice())?,
        };
        let mut values = vec![0; SIDE * SIDE];
        filter.undo(*shift, bytes, &mut values);
        Ok(values)
    }
}
