//! The check of everything: every row, every page, every delta, and whether they fit together.

use std::collections::BTreeMap;
use std::path::Path;

use orogeny_field::{PageKey, SampleRect};
use rayon::prelude::*;

use crate::EntryId;
use crate::head::Head;
use crate::history::Tree;
use crate::pyramid::{self, Plane};
use crate::rows::SavedLayer;
use crate::{Error, Result, Store, content};

/// What [`Store::check`] looked at and found.
#[derive(Debug, Default)]
pub struct CheckReport {
    /// Pages that were read and decoded.
    pub num_pages: u64,
    /// History entries, the terrain's creation included.
    pub num_entries: u64,
    /// Deltas that were read and decoded.
    pub num_deltas: u64,
    /// Pieces of data from outside that were read and compared with their names.
    pub num_blobs: u64,
    /// Everything that is wrong. Empty for a whole terrain.
    pub problems: Vec<Error>,
}

/// How many page keys are held at once.
const KEYS_PER_READ: u32 = 4096;

impl Store {
    /// Opens a terrain for reading and checks all of it, whether it holds everything that was acknowledged too.
    ///
    /// # Errors
    /// When the file cannot be opened at all.
    pub fn check_file(path: &Path) -> Result<CheckReport> {
        let acknowledged = Head::read(path)?;
        let store = Self::open_to_read_whatever_was_lost(path)?;
        let lost = store.document.check_commit(store.path(), acknowledged.as_ref());
        let mut report = store.check()?;
        report.keep(lost);
        Ok(report)
    }

    /// Reads and verifies the whole terrain as it was last committed; memory stays bounded, except for the history's
    /// own list. Damage is no error here: it is what the report lists.
    ///
    /// # Errors
    /// When the file cannot be read at all.
    pub fn check(&self) -> Result<CheckReport> {
        self.db.in_snapshot(|| {
            let mut report = CheckReport::default();
            let structure = self.db.structural_problems();
            let lines = report.keep(structure).unwrap_or_default();
            report.problems.extend(lines.into_iter().map(|line| Error::damaged(self.path(), line)));
            let pages = self.check_pages(&mut report);
            report.keep(pages);
            let levels = self.check_levels(&mut report);
            report.keep(levels);
            let blobs = self.check_blobs(&mut report);
            report.keep(blobs);
            let history = self.check_history(&mut report);
            report.keep(history);
            let fit = self.check_fit(&mut report);
            report.keep(fit);
            Ok(report)
        })
    }

    fn check_pages(&self, report: &mut CheckReport) -> Result<()> {
        let (grid, layout) = (self.grid(), self.layout());
        let mut last = None;
        loop {
            let keys = self.db.page_keys_after(last, KEYS_PER_READ)?;
            let Some(last_key) = keys.last() else { return Ok(()) };
            last = Some(*last_key);
            let (keys, beyond): (Vec<_>, Vec<_>) =
                keys.into_iter().partition(|key| layout.has_page(&grid, key));
            let beyond =
                beyond.into_iter().map(|key| Error::damaged_page(key, "the terrain has no such page"));
            report.problems.extend(beyond);
            self.check_each(
                report,
                &keys,
                |key| self.db.page(layout, key),
                |page| {
                    let Some(page) = page else { return Ok(()) };
                    let content = content::decode_page(layout, page)?;
                    let bounds = content::bounds_of(&grid, layout, &page.key, &content.page);
                    // Above full resolution they are compared with what they are made of.
                    if page.key.level > 0 || bounds == content.bounds {
                        return Ok(());
                    }
                    Err(Error::damaged_page(page.key, "its lowest and highest height are not what it says"))
                },
            );
            report.num_pages += keys.len() as u64;
        }
    }

    /// Whether the pages above full resolution are what those below them make.
    fn check_levels(&self, report: &mut CheckReport) -> Result<()> {
        let (grid, layout) = (self.grid(), self.layout());
        for key in self.db.pages_made_of_nothing()? {
            report
                .problems
                .push(Error::damaged_page(key, "there is nothing below it that it could be made of"));
        }
        let mut last = None;
        loop {
            let keys = self.db.page_keys_after(last, KEYS_PER_READ)?;
            let Some(last_key) = keys.last() else { return Ok(()) };
            last = Some(*last_key);
            // As if all that is there had just been painted.
            for level in 1..=layout.top_level(&grid) {
                let below = keys.iter().copied().filter(|key| key.level == level - 1);
                let below = pyramid::all_of(&grid, layout, below);
                let above = pyramid::pages_above(&grid, layout, level, &below);
                report.problems.extend(above.keys().filter_map(|key| self.check_made_page(key).err()));
            }
        }
    }

    fn check_made_page(&self, key: &PageKey) -> Result<()> {
        let plane = Plane { grid: self.grid(), layout: self.layout(), constant: self.stack.constant(key) };
        let expected = pyramid::made_from_scratch(&self.db, &plane, *key);
        let found = content::content(&self.db, plane.layout, key);
        // What is damaged itself is reported as such already.
        let (Ok(expected), Ok(found)) = (expected, found) else { return Ok(()) };
        let is_same = match (&expected, &found) {
            (None, None) => true,
            (Some(expected), Some(found)) => {
                let rect =
                    content::changed_rect(plane.layout, key, expected.page.samples(), found.page.samples());
                rect == SampleRect::EMPTY
                    && expected.bounds == found.bounds
                    && expected.error_m == found.error_m
                    && expected.revision == found.revision
            }
            _ => false,
        };
        if is_same {
            Ok(())
        } else {
            Err(Error::damaged_page(*key, "it is not what the pages below it make"))
        }
    }

    fn check_blobs(&self, report: &mut CheckReport) -> Result<()> {
        for blob in self.db.blobs()? {
            report.num_blobs += 1;
            let whole = blob.and_then(|blob| self.copy_blob(&blob, &mut std::io::sink()));
            report.keep(whole);
        }
        Ok(())
    }

    fn check_history(&self, report: &mut CheckReport) -> Result<()> {
        let mut entries = Vec::new();
        self.db.for_each_entry(EntryId::CREATION, |entry| {
            report.num_entries += 1;
            if let Some(entry) = report.keep(entry) {
                entries.push((entry.id, entry.num_pages));
            }
            Ok(())
        })?;
        for (entry, num_pages) in entries {
            let changes = self.db.layer_changes(entry);
            report.keep(changes);
            let keys = self.db.delta_keys(entry)?;
            if keys.len() != num_pages as usize {
                let detail = format!("it changed {num_pages} pages, the history has {} of them", keys.len());
                report.problems.push(Error::DamagedHistory { entry, page: None, detail });
            }
            let layout = self.layout();
            self.check_each(
                report,
                &keys,
                |key| self.db.delta(layout, entry, key),
                |delta| content::decode_delta(layout, entry, delta).map(|_| ()),
            );
            report.num_deltas += keys.len() as u64;
        }
        Ok(())
    }

    /// Whether pages and layers are what the applied entries left.
    fn check_fit(&self, report: &mut CheckReport) -> Result<()> {
        let document = self.db.document()?;
        for (key, is_in_directory) in self.db.pages_that_contradict_the_history()? {
            let detail = match (is_in_directory, self.db.page_info(&key)?) {
                // Reported from the directory's side.
                (false, Some(info)) if info.revision > document.floor => continue,
                (_, Some(info)) => {
                    format!("the history does not lead to its state, that of entry {}", info.revision)
                }
                (_, None) => "the history has it, the terrain has not".to_owned(),
            };
            report.problems.push(Error::damaged_page(key, detail));
        }
        let states = Tree::load(&self.db).and_then(|tree| tree.states(&self.db));
        report.keep(states);
        let (counted, said) = (self.db.history_bytes()?, document.history_bytes);
        if counted != said {
            let detail = format!("its history takes {counted} bytes, it says {said}");
            report.problems.push(Error::damaged(self.path(), detail));
        }
        let mut applied = Vec::new();
        let mut at = Some(document.head);
        while let Some(entry) = at {
            applied.push(entry);
            at = self.db.entry(entry)?.parent.filter(|parent| *parent < entry);
        }
        let mut expected: BTreeMap<u32, Option<String>> = BTreeMap::new();
        for entry in applied.into_iter().rev() {
            expected
                .extend(self.db.layer_changes(entry)?.into_iter().map(|change| (change.layer, change.after)));
        }
        let expected = expected.into_iter().filter_map(|(id, state)| Some(SavedLayer { id, state: state? }));
        if !expected.eq(self.db.saved_layers()?) {
            let detail = "the layers are not what the history leads to";
            report.problems.push(Error::damaged(self.path(), detail));
        }
        Ok(())
    }

    /// Reads rows one by one, in batches, and decodes each batch on all cores.
    fn check_each<Row: Send + Sync>(
        &self,
        report: &mut CheckReport,
        keys: &[PageKey],
        read: impl Fn(&PageKey) -> Result<Row>,
        decode: impl Fn(&Row) -> Result<()> + Sync,
    ) {
        for batch in keys.chunks(content::pages_per_batch(self.layout())) {
            let rows: Vec<Row> = batch.iter().filter_map(|key| report.keep(read(key))).collect();
            report.problems.par_extend(rows.par_iter().filter_map(|row| decode(row).err()));
        }
    }
}

impl CheckReport {
    /// Lists what went wrong, and goes on.
    fn keep<T>(&mut self, result: Result<T>) -> Option<T> {
        result.map_err(|problem| self.problems.push(problem)).ok()
    }
}
