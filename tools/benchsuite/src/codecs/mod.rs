//! How small and how fast pages and deltas become, on one core: the product's codec against others.
//!
//! Inputs are the deltas of real strokes on the bundled terrain, that terrain as it is (whole metres) and as an import resamples
//! it, and the rasters in the folder that the environment variable `OROGENY_DATA` names.

mod candidates;
mod filters;
mod inputs;

use std::hint::black_box;

use anyhow::{Result, ensure};

use crate::ground::PAGE_BYTES;
use crate::measure::Times;
use crate::report::{Figure, Report, Unit};
use candidates::{Candidate, Workspace};
use inputs::Input;

/// What is measured of a candidate on an input.
struct Case {
    candidate: Candidate,
    /// The values of each page as this candidate gets them.
    pages: Vec<Vec<u32>>,
    coded: Vec<Vec<u8>>,
    encode: Times,
    decode: Times,
}

pub fn run(report: &mut Report, repeat: usize) -> Result<()> {
    let mut workspace = Workspace::new()?;
    for input in inputs::all(report)? {
        on_input(report, repeat, &input, &mut workspace)?;
    }
    Ok(())
}

fn on_input(report: &mut Report, repeat: usize, input: &Input, workspace: &mut Workspace) -> Result<()> {
    let mut cases = Vec::new();
    for candidate in candidates::all() {
        let pages = input.values(candidate.delta);
        let coded = pages.iter().map(|page| candidate.encode(page, workspace)).collect::<Result<_>>()?;
        let case = Case { candidate, pages, coded, encode: Times::default(), decode: Times::default() };
        case.check_that_nothing_is_lost(input, workspace)?;
        cases.push(case);
    }
    for _ in 0..repeat {
        for case in &mut cases {
            case.measure(workspace)?;
        }
    }
    let raw_bytes = (input.num_pages() * PAGE_BYTES) as f64;
    report.note(format!("{}: {}; every codec is lossless on it", input.name, input.description()));
    for case in cases {
        let coded_bytes: usize = case.coded.iter().map(Vec::len).sum();
        let name = format!("{}, {}", input.name, case.candidate.name);
        let rate = |what: &str, times: &Times| {
            Figure::per_second(format!("{name}, {what}"), Unit::BytesPerSecond, times, raw_bytes, None)
        };
        report.add(Figure::ratio(format!("{name}, ratio"), vec![raw_bytes / coded_bytes as f64]));
        report.add(rate("encode", &case.encode));
        report.add(rate("decode", &case.decode));
    }
    Ok(())
}

impl Case {
    fn check_that_nothing_is_lost(&self, input: &Input, workspace: &mut Workspace) -> Result<()> {
        for (page, coded) in self.pages.iter().zip(&self.coded) {
            let is_same = self.candidate.decode(coded, workspace)? == *page;
            ensure!(is_same, "{} loses something of {}", self.candidate.name, input.name);
        }
        Ok(())
    }

    fn measure(&mut self, workspace: &mut Workspace) -> Result<()> {
        let Self { candidate, pages, coded, encode, decode } = self;
        encode.measure(|| {
            pages.iter().try_for_each(|page| {
                candidate.encode(black_box(page), workspace).map(|bytes| {
                    black_box(bytes);
                })
            })
        })?;
        decode.measure(|| {
            coded.iter().try_for_each(|bytes| {
                candidate.decode(black_box(bytes), workspace).map(|page| {
                    black_box(page);
                })
            })
        })
    }
}
