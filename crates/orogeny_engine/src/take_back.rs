//! Taking back one operation from under others: what was done since is done again without it, with the same bits as if it had never
//! been. All of it is one commit.

use std::io::Write as _;

use orogeny_field::PageKey;
use orogeny_store::{Entry, EntryId, EntryState, Recording};

use crate::access::band_bytes;
use crate::apply::{After, Site, apply_all};
use crate::composite::Change;
use crate::import::{RecordedImport, run_import};
use crate::recorded::{LayerIds, Recorded};
use crate::{Applied, Error, LayerReference, Observer, Result, Terrain};

/// The most operations that are done again for one that is taken back.
const MAX_LATER: usize = 256;
/// The most pages that they may have changed: with 256 × 256 samples each, 4 GiB of heights.
const MAX_LATER_PAGES: u64 = 16_384;
/// How many of the operations in the way an error names.
const MAX_NAMED: usize = 5;

/// What taking back, or doing again, one operation came to.
#[derive(Debug, Clone)]
pub struct Redone {
    /// The entries that were made for it, in order.
    pub entries: Vec<EntryId>,
    /// What of fields was changed; `None`: more than that.
    pub(crate) changes: Option<Vec<Change>>,
}

impl Terrain {
    /// Takes back one operation and keeps what was done after it: those operations are done again, in order and by their authors, as
    /// if it had never been done. The ones taken back are left behind as a branch of the history.
    ///
    /// # Errors
    /// [`Error::CannotTakeBack`] where it does not show, where more than 256 operations or 16,384 pages of them would have to be done
    /// again, or where one of them cannot be without it; [`Error::Store`]; [`Error::Cancelled`]. The terrain is then as it was.
    pub fn take_back(&mut self, entry: EntryId, observer: &mut dyn Observer) -> Result<Redone> {
        let log = self.settled()?.log_from(entry)?;
        let refused = |detail: String| Error::CannotTakeBack { entry: entry.0, detail };
        let applied: Vec<&Entry> = log.iter().filter(|entry| entry.state == EntryState::Applied).collect();
        let ([taken, later @ ..], true) =
            (applied.as_slice(), applied.first().is_some_and(|first| first.id == entry))
        else {
            return Err(refused("it is none of those that show".to_owned()));
        };
        if later.is_empty() {
            let undone = self.undo(1)?;
            return Ok(Redone { entries: Vec::new(), changes: self.changed_by_travel(&undone)? });
        }
        check_work(later).map_err(refused)?;
        let mut again = Vec::with_capacity(later.len());
        for entry in later {
            let recorded = Recorded::of(entry).map_err(|detail| in_the_way(taken.id, entry, &detail))?;
            again.push((*entry, recorded));
        }
        let layers_before = self.layers()?.to_vec();
        let redone = self.redo_all(Some(taken), again, observer)?;
        // Layers that come and go, or are made of something else, change more than their pages.
        let changes = redone.changes.filter(|_| self.layers().is_ok_and(|layers| layers == layers_before));
        Ok(Redone { changes, ..redone })
    }

    /// Does again, on top of all that shows, an operation that does not show, as the author that it had.
    ///
    /// # Errors
    /// [`Error::CannotReplay`] where it shows already or cannot be done now; [`Error::Store`]; [`Error::Cancelled`]. The terrain is then
    /// as it was.
    pub fn do_again(&mut self, entry: EntryId, observer: &mut dyn Observer) -> Result<Redone> {
        let log = self.log()?;
        let cannot = |detail: String| Error::CannotReplay { entry: entry.0, detail };
        let undone = log.iter().find(|other| other.id == entry && other.state != EntryState::Applied);
        let Some(undone) = undone else {
            return Err(cannot("it is none of those that were undone".to_owned()));
        };
        let next = log.iter().find(|other| other.state == EntryState::Undone);
        if next.is_some_and(|next| next.id == entry) {
            let redone = self.redo(1)?;
            return Ok(Redone { entries: vec![entry], changes: self.changed_by_travel(&redone)? });
        }
        let recorded = Recorded::of(undone).map_err(cannot)?;
        self.redo_all(None, vec![(undone, recorded)], observer)
    }

    /// What of fields a way through the history changed; `None` where it changed layers too.
    pub(crate) fn changed_by_travel(
        &self,
        travelled: &[orogeny_store::Change],
    ) -> Result<Option<Vec<Change>>> {
        let is_of_fields = travelled.iter().all(|change| !change.layers_changed);
        let layout = self.store()?.layout();
        let pages = travelled.iter().flat_map(|change| Change::of_pages(layout, &change.pages));
        Ok(is_of_fields.then(|| pages.collect()))
    }

    /// Does operations of the history again in one commit, after going back to before `taken`.
    fn redo_all(
        &mut self,
        taken: Option<&Entry>,
        again: Vec<(&Entry, Recorded)>,
        observer: &mut dyn Observer,
    ) -> Result<Redone> {
        self.flush()?;
        let max_band_bytes = band_bytes(self.settings().page_budget_in_bytes);
        let redone = self.record(observer, After::Commit, |site, recording| {
            let mut redone = Redone { entries: Vec::new(), changes: Some(Vec::new()) };
            if let Some(taken) = taken {
                let pages = recording.go_back_to(taken.parent)?;
                note(&mut redone, site, &pages);
            }
            let mut ids = LayerIds::new();
            for (entry, recorded) in again {
                let fail = |err: Error| match (err, taken) {
                    (Error::Cancelled, _) => Error::Cancelled,
                    // The machine's faults are not the operations'.
                    (err, _) if err.is_fault() => err,
                    (err, Some(taken)) => in_the_way(taken.id, entry, &err.to_string()),
                    (err, None) => Error::CannotReplay { entry: entry.id.0, detail: err.to_string() },
                };
                let made = recorded.made_layer();
                let (applied, pages) =
                    redo(entry, recorded, &ids, max_band_bytes, site, recording).map_err(fail)?;
                ids.extend(made.zip(applied.made_layer));
                redone.entries.push(applied.entry);
                note(&mut redone, site, &pages);
                match (&mut redone.changes, applied.change) {
                    (Some(changes), Some(change)) => changes.push(change),
                    (changes, None) => *changes = None,
                    (None, _) => {}
                }
            }
            Ok(redone)
        })?;
        self.flush()?;
        Ok(redone)
    }
}

/// Does one operation again; gives also the pages that were changed past the executor.
fn redo(
    entry: &Entry,
    mut recorded: Recorded,
    ids: &LayerIds,
    max_band_bytes: u64,
    site: &mut Site<'_>,
    recording: &mut Recording<'_>,
) -> Result<(Applied, Vec<PageKey>)> {
    let cannot = |detail: String| Error::CannotReplay { entry: entry.id.0, detail };
    // Those that were not made again have the ids that they had.
    recorded.name_layers(|id| Some(ids.get(&id).copied().unwrap_or(id))).map_err(cannot)?;
    match recorded {
        Recorded::Operation(operation) => {
            let mut applied = apply_all(&[operation], &entry.author, site, recording)?;
            let applied = applied.pop().ok_or_else(|| cannot("it does nothing".to_owned()))?;
            Ok((applied, Vec::new()))
        }
        Recorded::Import(import) => redo_import(entry, import, max_band_bytes, site, recording),
    }
}

fn redo_import(
    entry: &Entry,
    import: RecordedImport,
    max_band_bytes: u64,
    site: &mut Site<'_>,
    recording: &mut Recording<'_>,
) -> Result<(Applied, Vec<PageKey>)> {
    let cannot = |detail: String| Error::CannotReplay { entry: entry.id.0, detail };
    let layer = match &import.new_layer {
        Some(name) => name.clone(),
        None => {
            let reference = LayerReference::Id(import.layer);
            crate::terrain::find_layer(recording.layers(), Some(&reference))?.name.clone()
        }
    };
    let folder = tempfile::tempdir().map_err(|err| cannot(err.to_string()))?;
    let read = |hash, mut file: std::fs::File| {
        Ok(recording.with_transaction(move |transaction| {
            transaction.read_blob(&hash, &mut file)?;
            // Errors of the disk show at the latest here.
            Ok(file.flush().is_ok())
        })?)
        .and_then(|is_whole| {
            if is_whole { Ok(()) } else { Err(cannot("its data could not be unpacked".to_owned())) }
        })
    };
    let request = import.request(folder.path(), layer, read).map_err(cannot)?;
    let mut raster = orogeny_formats::open(&request.file, &request.options)?;
    let imported = run_import(
        recording,
        &mut raster,
        &request,
        site.grid,
        &entry.author,
        max_band_bytes,
        &mut *site.observer,
    )?;
    let made_layer = imported.made_layer.then_some(imported.layer.id);
    Ok((Applied::import(imported.entry, made_layer, imported.pages.len()), imported.pages))
}

/// Pages were changed past the executor.
fn note(redone: &mut Redone, site: &mut Site<'_>, pages: &[PageKey]) {
    let changes = Change::of_pages(site.layout, pages);
    site.executor.forget(pages);
    site.compositor.forget(&site.grid, site.layout, &changes);
    if let Some(all) = &mut redone.changes {
        all.extend(changes);
    }
}

fn check_work(later: &[&Entry]) -> std::result::Result<(), String> {
    let num_pages: u64 = later.iter().map(|entry| u64::from(entry.num_pages)).sum();
    if later.len() <= MAX_LATER && num_pages <= MAX_LATER_PAGES {
        return Ok(());
    }
    let named: Vec<_> = later.iter().take(MAX_NAMED).map(|entry| named(entry)).collect();
    let more = match later.len() - named.len() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    Err(format!(
        "{} operations that changed {num_pages} pages were done since, of which at most {MAX_LATER} and {MAX_LATER_PAGES} are done \
         again: {}{more}; undo those first, or go back to an earlier entry",
        later.len(),
        named.join(", ")
    ))
}

fn named(entry: &Entry) -> String {
    if entry.author.is_empty() {
        format!("{}", entry.id)
    } else {
        format!("{} by {}", entry.id, entry.author)
    }
}

fn in_the_way(taken: EntryId, later: &Entry, detail: &str) -> Error {
    let detail = format!("entry {} cannot be done without it: {detail}; undo that one first", named(later));
    Error::CannotTakeBack { entry: taken.0, detail }
}
