//! What is committed: coded pages of the bundled terrain under real strokes, and their deltas.

use std::collections::HashMap;

use anyhow::{Result, ensure};
use orogeny_store::codec;

use super::{COMMIT_SIZES, NUM_COMMITS};
use crate::ground::{self, Ground, SIDE, Sampling};

/// Copies of the bundled terrain, each with strokes of its own: more pages than the largest commit.
const NUM_COPIES: u32 = 80;

/// A page to be replaced.
pub struct Write {
    pub place: u32,
    pub page: Vec<u8>,
    /// What was done to it; none where it is new.
    pub delta: Option<Vec<u8>>,
}

/// Everything that is committed.
pub struct Work {
    ground: Vec<Write>,
    /// The pages that the first strokes on the copies changed, and those that the second did. One of the two is smooth and
    /// one noisy, by turns from copy to copy.
    strokes: [Vec<Write>; 2],
}

/// What a store must hold after some commits.
#[derive(Default)]
pub struct Live<'work> {
    pages: HashMap<u32, &'work [u8]>,
    num_bytes_of_deltas: usize,
}

impl Work {
    pub fn new() -> Result<Self> {
        let ground = ground::bundled(Sampling::AsTheyAre)?;
        let mut work = Self { ground: Vec::new(), strokes: [Vec::new(), Vec::new()] };
        let pages = ground.ordered().iter().map(|page| encoded(page)).collect::<Result<Vec<_>>>()?;
        let num_pages = u32::try_from(pages.len())?;
        for copy in 0..NUM_COPIES {
            let first = copy * num_pages;
            let new = |(place, page): (u32, &Vec<u8>)| Write { place, page: page.clone(), delta: None };
            work.ground.extend((first..).zip(&pages).map(new));
            work.add_strokes(&ground, copy, first)?;
        }
        let enough = COMMIT_SIZES.into_iter().max().unwrap_or_default();
        ensure!(work.strokes.iter().all(|writes| writes.len() >= enough), "the strokes change too few pages");
        Ok(work)
    }

    fn add_strokes(&mut self, ground: &Ground, copy: u32, first: u32) -> Result<()> {
        let mut brushes = [ground::raise(), ground::roughen()];
        brushes.rotate_left(copy as usize % 2);
        for (writes, changes) in self.strokes.iter_mut().zip(ground.paint(&brushes, copy)?) {
            for (place, change) in changes {
                writes.push(Write {
                    place: first + place,
                    page: encoded(&change.after)?,
                    delta: Some(encoded(&codec::difference(&change.after, Some(&change.before)))?),
                });
            }
        }
        Ok(())
    }

    /// The pages that are there before the first stroke.
    pub fn ground(&self) -> &[Write] {
        &self.ground
    }

    /// The pages of a commit; those of each entry begin somewhere else.
    pub fn commit(&self, entry: u32, num_pages: usize) -> &[Write] {
        let [first, second] = &self.strokes;
        let strokes = if entry.is_multiple_of(2) { second } else { first };
        let start = (entry as usize * 317) % (strokes.len() - num_pages + 1);
        strokes.get(start..start + num_pages).unwrap_or_default()
    }

    /// The commits after the ground: entry and number of pages.
    pub fn commits() -> impl Iterator<Item = (u32, usize)> {
        (1..).zip(COMMIT_SIZES.into_iter().cycle().take(NUM_COMMITS))
    }

    /// The commit with the most bytes.
    pub fn longest_commit(&self) -> &[Write] {
        let commits = Self::commits().map(|(entry, size)| self.commit(entry, size));
        commits.max_by_key(|writes| num_bytes(writes)).unwrap_or_default()
    }

    /// Where a page might lie in a file of all changed pages, and its length.
    pub fn start_and_length(&self, place: u32) -> (u64, usize) {
        let [writes, _] = &self.strokes;
        let index = place as usize % writes.len();
        let start = writes.iter().take(index).map(Write::num_bytes).sum::<usize>() as u64;
        (start, writes.get(index).map_or(0, |write| write.page.len()))
    }

    /// Bytes of a commit of so many pages, over all entries.
    pub fn mean_bytes_of_commit(&self, num_pages: usize) -> f64 {
        let bytes: Vec<usize> = Self::commits()
            .filter(|(_, size)| *size == num_pages)
            .map(|(entry, size)| num_bytes(self.commit(entry, size)))
            .collect();
        bytes.iter().sum::<usize>() as f64 / bytes.len() as f64
    }

    /// Pages in no order, always the same ones.
    pub fn random_places(&self, count: usize) -> impl Iterator<Item = u32> {
        let num_places = self.ground.len() as u64;
        let mut state = 0x0bad_cafe_u64;
        std::iter::repeat_with(move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % num_places) as u32
        })
        .take(count)
    }

    /// What it is, for people.
    pub fn description(&self) -> String {
        let mean = |bytes: usize, count: usize| bytes as f64 / count as f64 / 1.0e3;
        let strokes = || self.strokes.iter().flatten();
        let num_writes = strokes().count();
        format!(
            "{} pages of {:.0} kB; after a stroke {:.0} kB, its delta {:.0} kB (means)",
            self.ground.len(),
            mean(num_bytes(&self.ground), self.ground.len()),
            mean(strokes().map(|write| write.page.len()).sum(), num_writes),
            mean(strokes().map(|write| write.delta.as_ref().map_or(0, Vec::len)).sum(), num_writes),
        )
    }
}

impl Write {
    fn num_bytes(&self) -> usize {
        self.page.len() + self.delta.as_ref().map_or(0, Vec::len)
    }
}

impl<'work> Live<'work> {
    pub fn commit(&mut self, writes: &'work [Write]) {
        for write in writes {
            self.pages.insert(write.place, &write.page);
            self.num_bytes_of_deltas += write.delta.as_ref().map_or(0, Vec::len);
        }
    }

    pub fn page(&self, place: u32) -> Option<&'work [u8]> {
        self.pages.get(&place).copied()
    }

    /// Bytes of pages and deltas that are still of use.
    pub fn num_bytes(&self) -> usize {
        self.pages.values().map(|page| page.len()).sum::<usize>() + self.num_bytes_of_deltas
    }
}

fn num_bytes(writes: &[Write]) -> usize {
    writes.iter().map(Write::num_bytes).sum()
}

fn encoded(values: &[u32]) -> Result<Vec<u8>> {
    Ok(codec::encode(values, SIDE)?)
}
