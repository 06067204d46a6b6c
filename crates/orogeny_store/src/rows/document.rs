//! The terrain itself and its fields.

use std::collections::BTreeMap;

use orogeny_field::{FieldId, PageLayout, TerrainGrid};
use rusqlite::{OptionalExtension as _, params};

use crate::checksum::{Checksum, RowHasher};
use crate::database::Database;
use crate::head::LastCommit;
use crate::layer::{Field, FieldKind};
use crate::{EntryId, Error, Result};

/// The one row of `document`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Document {
    pub(crate) grid: TerrainGrid,
    pub(crate) layout: PageLayout,
    /// How many commits there were.
    pub(crate) sequence: u64,
    /// Where the history stands.
    pub(crate) head: EntryId,
    /// The last ids given out; none is ever given twice, whatever is undone or dropped.
    pub(crate) last_entry: u32,
    pub(crate) last_layer: u32,
    pub(crate) last_field: u32,
    /// The last entry that was dropped from below the kept ones: pages of that revision and older have no history.
    pub(crate) floor: EntryId,
    /// What the history takes in the file: deltas, operations and data from outside, in bytes.
    pub(crate) history_bytes: u64,
    /// What it may take; `None`: whatever it comes to.
    pub(crate) history_budget: Option<u64>,
}

impl Document {
    /// Of a new terrain, before its first commit.
    pub(crate) const fn new(grid: TerrainGrid, layout: PageLayout) -> Self {
        Self {
            grid,
            layout,
            sequence: 0,
            head: EntryId::CREATION,
            last_entry: 0,
            last_layer: 0,
            last_field: 0,
            floor: EntryId::CREATION,
            history_bytes: 0,
            history_budget: None,
        }
    }

    pub(crate) fn last_commit(&self) -> LastCommit {
        LastCommit { sequence: self.sequence, hash: self.checksum() }
    }

    pub(crate) fn next_entry(&mut self) -> Result<EntryId> {
        next("history entry", &mut self.last_entry).map(EntryId)
    }

    pub(crate) fn next_layer(&mut self) -> Result<u32> {
        next("layer", &mut self.last_layer)
    }

    pub(crate) fn next_field(&mut self) -> Result<FieldId> {
        next("field", &mut self.last_field).map(FieldId)
    }

    fn checksum(&self) -> Checksum {
        RowHasher::new("document")
            .number(self.grid.width().into())
            .number(self.grid.depth().into())
            .number(self.grid.spacing_m().to_bits().cast_signed())
            .number(self.layout.size().into())
            .number(self.head.0.into())
            .number(self.last_entry.into())
            .number(self.last_layer.into())
            .number(self.last_field.into())
            .number(self.sequence.cast_signed())
            .number(self.floor.0.into())
            .number(self.history_bytes.cast_signed())
            .number(self.history_budget.map_or(-1, u64::cast_signed))
            .finish()
    }
}

fn next(what: &'static str, last: &mut u32) -> Result<u32> {
    *last = last.checked_add(1).ok_or(Error::NumbersUsedUp { what, limit: u32::MAX })?;
    Ok(*last)
}

fn field_checksum(id: FieldId, kind: FieldKind, constant: f32) -> Checksum {
    RowHasher::new("field")
        .number(id.0.into())
        .bytes(kind.name().as_bytes())
        .number(constant.to_bits().into())
        .finish()
}

impl Database {
    /// Writes the one row, or what of it changes: all but the size.
    pub(crate) fn write_document(&self, document: &Document) -> Result<()> {
        self.statement(
            "INSERT INTO document (id, width, depth, spacing_m, page_size, sequence, head, last_entry, last_layer,
                                   last_field, floor, history_bytes, history_budget, checksum)
             VALUES (1, ?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13)
             ON CONFLICT (id) DO UPDATE SET
                 sequence = excluded.sequence, head = excluded.head, last_entry = excluded.last_entry,
                 last_layer = excluded.last_layer, last_field = excluded.last_field, floor = excluded.floor,
                 history_bytes = excluded.history_bytes, history_budget = excluded.history_budget,
                 checksum = excluded.checksum",
        )
        .and_then(|mut statement| {
            statement.execute(params![
                document.grid.width(),
                document.grid.depth(),
                document.grid.spacing_m(),
                document.layout.size(),
                document.sequence.cast_signed(),
                document.head.0,
                document.last_entry,
                document.last_layer,
                document.last_field,
                document.floor.0,
                document.history_bytes.cast_signed(),
                document.history_budget.map(u64::cast_signed),
                document.checksum(),
            ])
        })
        .map_err(|err| self.fault(err))?;
        Ok(())
    }

    /// The document as its row says, whether its checksum holds or not comes second.
    pub(crate) fn document_unchecked(&self) -> Result<(Document, bool)> {
        struct Row {
            size: (i64, i64, f64, u32),
            sequence: i64,
            ids: [u32; 5],
            history: (i64, Option<i64>),
            checksum: Vec<u8>,
        }
        let row: Row = self
            .statement(
                "SELECT width, depth, spacing_m, page_size, sequence, head, last_entry, last_layer, last_field, floor,
                        history_bytes, history_budget, checksum
                 FROM document WHERE id = 1",
            )
            .and_then(|mut statement| {
                statement
                    .query_row([], |row| {
                        Ok(Row {
                            size: (row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?),
                            sequence: row.get(4)?,
                            ids: [row.get(5)?, row.get(6)?, row.get(7)?, row.get(8)?, row.get(9)?],
                            history: (row.get(10)?, row.get(11)?),
                            checksum: row.get(12)?,
                        })
                    })
                    .optional()
            })
            .map_err(|err| self.fault(err))?
            .ok_or_else(|| Error::damaged(self.path(), "it does not say how large the terrain is"))?;
        let (width, depth, spacing_m, page_size) = row.size;
        let [head, last_entry, last_layer, last_field, floor] = row.ids;
        let (history_bytes, history_budget) = row.history;
        let wrong = |err: orogeny_field::Error| Error::damaged(self.path(), err.to_string());
        let document = Document {
            grid: TerrainGrid::new(width.cast_unsigned(), depth.cast_unsigned(), spacing_m).map_err(wrong)?,
            layout: PageLayout::new(page_size).map_err(wrong)?,
            sequence: row.sequence.cast_unsigned(),
            head: EntryId(head),
            last_entry,
            last_layer,
            last_field,
            floor: EntryId(floor),
            history_bytes: history_bytes.cast_unsigned(),
            history_budget: history_budget.map(i64::cast_unsigned),
        };
        let is_whole = document.checksum() == *row.checksum;
        Ok((document, is_whole))
    }

    pub(crate) fn document(&self) -> Result<Document> {
        match self.document_unchecked()? {
            (document, true) => Ok(document),
            (_, false) => {
                Err(Error::damaged(self.path(), "the row that says what terrain it is fails its checksum"))
            }
        }
    }

    pub(crate) fn insert_field(&self, id: FieldId, field: Field) -> Result<()> {
        let Field { kind, constant } = field;
        self.statement("INSERT INTO field (id, kind, constant, checksum) VALUES (?1, ?2, ?3, ?4)")
            .and_then(|mut statement| {
                statement.execute(params![id.0, kind.name(), constant, field_checksum(id, kind, constant)])
            })
            .map_err(|err| self.fault(err))?;
        Ok(())
    }

    /// All fields, those of undone layers too.
    pub(crate) fn fields(&self) -> Result<BTreeMap<FieldId, Field>> {
        let mut problems = Vec::new();
        let fields = self.fields_as_found(&mut problems)?;
        match problems.into_iter().next() {
            Some(problem) => Err(Error::damaged(self.path(), problem)),
            None => Ok(fields),
        }
    }

    /// As [`Self::fields`], whatever fails its checksum, with what that is.
    pub(crate) fn fields_as_found(&self, problems: &mut Vec<String>) -> Result<BTreeMap<FieldId, Field>> {
        type Row = (u32, String, f32, Vec<u8>);
        let rows: Vec<Row> = self
            .statement("SELECT id, kind, constant, checksum FROM field ORDER BY id")
            .and_then(|mut statement| {
                let row = |row: &rusqlite::Row<'_>| Ok((row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?));
                statement.query_map([], row)?.collect()
            })
            .map_err(|err| self.fault(err))?;
        let mut fields = BTreeMap::new();
        for (id, kind, constant, checksum) in rows {
            let (id, known_kind) = (FieldId(id), FieldKind::from_name(&kind));
            let is_storable = orogeny_field::is_storable_height(constant);
            let is_whole = known_kind.is_some_and(|kind| field_checksum(id, kind, constant) == *checksum);
            if !is_whole || !is_storable {
                problems.push(format!("field {} fails its checksum", id.0));
            }
            if is_storable {
                fields.insert(id, Field { kind: known_kind.unwrap_or(FieldKind::Heights), constant });
            }
        }
        Ok(fields)
    }
}
