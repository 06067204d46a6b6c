//! NumPy's `.npy`, versions 1 to 3: a Python dictionary, then the array's bytes.
//!
//! Arrays of two dimensions, rows first; integers of 8, 16 and 32 bits and floats of 32 and 64, in either byte order.
//! C order streams. Fortran order holds columns one after another, so it is read whole, within the memory limit.

use std::fs::File;
use std::io::{BufReader, Read};

use super::flat::FlatRows;
use crate::error::{Error, Result};
use crate::format::{ByteOrder, SampleType};
use crate::options::ImportOptions;
use crate::place::Place;
use crate::sample::Decoding;
use crate::source::{Header, RowSource, Source, Spacing};

const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// The longest dictionary that is read, bytes. That of a plain array is under 200.
const MAX_DICTIONARY_BYTES: usize = 1 << 16;

/// Opens an array.
pub(crate) fn open(place: &Place, options: &ImportOptions) -> Result<Source> {
    let (mut reader, bytes) = place.open()?;
    let (dictionary, header_bytes) = read_dictionary(place, &mut reader)?;
    let array = Array::parse(&dictionary).map_err(|reason| place.malformed(reason))?;
    let (sample, byte_order) = sample_type(&array.descr).ok_or_else(|| {
        place.unsupported(format!(
            "arrays of {} are not read; f4, f8, i1, u1, i2, u2, i4 and u4 are",
            array.descr
        ))
    })?;
    let [depth, width] = array.shape[..] else {
        return Err(
            place.unsupported(format!("the array has {} dimensions, 2 are needed", array.shape.len()))
        );
    };
    let (width, depth) = place.check_size(width, depth, options.max_samples_per_side)?;
    let array_bytes = u64::from(width) * u64::from(depth) * u64::from(sample.bytes());
    let expected = header_bytes + array_bytes;
    if expected != bytes {
        return Err(Error::WrongLength { path: place.path.clone(), expected, actual: bytes });
    }

    let decoding = Decoding::new(sample, byte_order);
    let rows: Box<dyn RowSource> = if array.fortran_order {
        place.check_memory(
            "an array in Fortran order",
            array_bytes,
            options.memory_limit_bytes,
            "save it in C order",
        )?;
        Box::new(ColumnRows::read(place, reader, decoding, sample, (width, depth))?)
    } else {
        Box::new(FlatRows::new(reader, decoding, width, place))
    };
    let header = Header {
        width,
        depth,
        sample,
        spacing: Spacing::Unknown,
        georeference: None,
        notices: Vec::new(),
        needs_scan: decoding.may_be_void(),
    };
    Ok(Source { header, rows })
}

/// The dictionary, and the bytes of everything before the array.
fn read_dictionary(place: &Place, reader: &mut BufReader<File>) -> Result<(String, u64)> {
    let mut start = [0; 8];
    reader.read_exact(&mut start).map_err(|err| place.reading(err))?;
    let (magic, version) = start.split_at(MAGIC.len());
    if magic != MAGIC {
        return Err(place.malformed("it does not begin as an array does"));
    }
    let (dictionary_bytes, header_bytes) = match version {
        [1, _] => {
            let mut length = [0; 2];
            reader.read_exact(&mut length).map_err(|err| place.reading(err))?;
            (usize::from(u16::from_le_bytes(length)), 10)
        }
        [2 | 3, _] => {
            let mut length = [0; 4];
            reader.read_exact(&mut length).map_err(|err| place.reading(err))?;
            (u32::from_le_bytes(length) as usize, 12)
        }
        _ => return Err(place.unsupported("versions 1 to 3 of the format are read")),
    };
    if dictionary_bytes > MAX_DICTIONARY_BYTES {
        return Err(place.malformed(format!(
            "its header of {dictionary_bytes} bytes is longer than {MAX_DICTIONARY_BYTES}"
        )));
    }
    let mut dictionary = vec![0; dictionary_bytes];
    reader.read_exact(&mut dictionary).map_err(|err| place.reading(err))?;
    let dictionary = String::from_utf8(dictionary).map_err(|_| place.malformed("its header is not text"))?;
    Ok((dictionary, header_bytes + dictionary_bytes as u64))
}

fn sample_type(descr: &str) -> Option<(SampleType, ByteOrder)> {
    let (order, kind) = descr.split_at_checked(1)?;
    let sample = match kind {
        "u1" => SampleType::U8,
        "i1" => SampleType::I8,
        "u2" => SampleType::U16,
        "i2" => SampleType::I16,
        "u4" => SampleType::U32,
        "i4" => SampleType::I32,
        "f4" => SampleType::F32,
        "f8" => SampleType::F64,
        _ => return None,
    };
    match order {
        "<" => Some((sample, ByteOrder::Little)),
        ">" => Some((sample, ByteOrder::Big)),
        "|" if sample.bytes() == 1 => Some((sample, ByteOrder::Little)),
        _ => None,
    }
}

/// What the dictionary says.
#[derive(Debug, PartialEq)]
struct Array {
    descr: String,
    fortran_order: bool,
    shape: Vec<u64>,
}

impl Array {
    /// Reads the Python dictionary: exactly the keys `descr`, `fortran_order` and `shape`, in any order.
    fn parse(dictionary: &str) -> Result<Self, String> {
        let mut text = Text { rest: dictionary };
        let (mut descr, mut fortran_order, mut shape) = (None, None, None);
        text.expect('{')?;
        while !text.eat('}') {
            let key = text.string()?;
            text.expect(':')?;
            match key {
                "descr" => descr = Some(text.string()?.to_owned()),
                "fortran_order" => fortran_order = Some(text.boolean()?),
                "shape" => shape = Some(text.shape()?),
                key => return Err(format!("its header has an unknown key `{key}`")),
            }
            if !text.eat(',') {
                text.expect('}')?;
                break;
            }
        }
        match (descr, fortran_order, shape) {
            (Some(descr), Some(fortran_order), Some(shape)) if text.is_at_end() => {
                Ok(Self { descr, fortran_order, shape })
            }
            _ => {
                Err("its header must have descr, fortran_order and shape, and nothing after them".to_owned())
            }
        }
    }
}

/// What is left to read of a Python literal.
struct Text<'a> {
    rest: &'a str,
}

impl<'a> Text<'a> {
    fn eat(&mut self, token: char) -> bool {
        self.rest = self.rest.trim_start();
        match self.rest.strip_prefix(token) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn expect(&mut self, token: char) -> Result<(), String> {
        if self.eat(token) { Ok(()) } else { Err(format!("its header lacks a `{token}`")) }
    }

    /// A string without escapes.
    fn string(&mut self) -> Result<&'a str, String> {
        let quote = if self.eat('\'') {
            '\''
        } else if self.eat('"') {
            '"'
        } else {
            return Err(
                "its header has no plain string where one must be: arrays of records are not read".to_owned()
            );
        };
        let (string, rest) = self.rest.split_once(quote).ok_or("its header has a string without an end")?;
        self.rest = rest;
        Ok(string)
    }

    fn boolean(&mut self) -> Result<bool, String> {
        self.rest = self.rest.trim_start();
        for (word, value) in [("True", true), ("False", false)] {
            if let Some(rest) = self.rest.strip_prefix(word) {
                self.rest = rest;
                return Ok(value);
            }
        }
        Err("its header's fortran_order is neither True nor False".to_owned())
    }

    fn shape(&mut self) -> Result<Vec<u64>, String> {
        let mut shape = Vec::new();
        self.expect('(')?;
        while !self.eat(')') {
            self.rest = self.rest.trim_start();
            let end = self.rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(self.rest.len());
            let (digits, rest) = self.rest.split_at(end);
            shape.push(
                digits.parse().map_err(|_| "its header's shape has a side that is no number".to_owned())?,
            );
            self.rest = rest;
            if !self.eat(',') {
                self.expect(')')?;
                break;
            }
        }
        Ok(shape)
    }

    fn is_at_end(&self) -> bool {
        self.rest.trim().is_empty()
    }
}

/// Rows of an array that holds columns.
struct ColumnRows {
    bytes: Vec<u8>,
    decoding: Decoding,
    sample_bytes: usize,
    column_bytes: usize,
    /// Where the next row's sample is in every column.
    offset: usize,
    /// One row as stored.
    row: Vec<u8>,
    place: Place,
}

impl ColumnRows {
    fn read(
        place: &Place,
        mut reader: BufReader<File>,
        decoding: Decoding,
        sample: SampleType,
        (width, depth): (u32, u32),
    ) -> Result<Self> {
        let sample_bytes = sample.bytes() as usize;
        let column_bytes = depth as usize * sample_bytes;
        let mut bytes = vec![0; width as usize * column_bytes];
        reader.read_exact(&mut bytes).map_err(|err| place.reading(err))?;
        Ok(Self {
            bytes,
            decoding,
            sample_bytes,
            column_bytes,
            offset: 0,
            row: Vec::new(),
            place: place.clone(),
        })
    }
}

impl RowSource for ColumnRows {
    fn read_row(&mut self, row: &mut [f32]) -> Result<()> {
        self.row.clear();
        for column in self.bytes.chunks_exact(self.column_bytes) {
            let sample = column
                .get(self.offset..self.offset + self.sample_bytes)
                .ok_or_else(|| self.place.truncated())?;
            self.row.extend_from_slice(sample);
        }
        self.offset += self.sample_bytes;
        self.decoding.decode(&self.row, row);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn numpy_dictionaries_are_understood() {
        let text = "{'descr': '<f4', 'fortran_order': False, 'shape': (13, 20), }          \n";
        let array = Array::parse(text).unwrap();
        assert_eq!(array, Array { descr: "<f4".to_owned(), fortran_order: false, shape: vec![13, 20] });
        let other = "{\"shape\":(5,),\"fortran_order\":True,\"descr\":\"|u1\"}";
        assert_eq!(Array::parse(other).unwrap().shape, [5]);
        for bad in [
            "",
            "{}",
            "{'descr': '<f4', 'fortran_order': False}",
            "{'descr': [('x', '<f4')], 'fortran_order': False, 'shape': (1, 1)}",
            "{'descr': '<f4', 'fortran_order': 0, 'shape': (1, 1)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (1, -1)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 99999999999999999999999)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1)} x",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1), 'more': 'x'}",
        ] {
            assert!(Array::parse(bad).is_err(), "{bad}");
        }
    }

    proptest! {
        #[test]
        fn no_header_panics(text in ".{0,80}") {
            let _ = Array::parse(&text);
        }
    }
}
