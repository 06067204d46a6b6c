//! The terrain itself and its fields.

use std::collections::BTreeMap;

use orogeny_field::{FieldId, PageLayout, TerrainGrid};
use rusqlite::{OptionalExtension as _, params};

use crate::checksum::{Checksum, RowHasher};
use crate::database::Database;
use crate::{EntryId, Error, Result};

/// The one row of `document`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Document {
    pub(crate) grid: TerrainGrid,
    pub(crate) layout: PageLayout,
    /// Where the history stands.
    pub(crate) head: EntryId,
    /// The last ids given out; none is ever given twice, whatever is undone or dropped.
    pub(crate) last_entry: u32,
    pub(crate) last_layer: u32,
    pub(crate) last_field: u32,
}

impl Document {
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
            .finish()
    }
}

fn next(what: &'static str, last: &mut u32) -> Result<u32> {
    *last = last.checked_add(1).ok_or(Error::NumbersUsedUp { what, limit: u32::MAX })?;
    Ok(*last)
}

fn field_checksum(id: FieldId, constant: f32) -> Checksum {
    RowHasher::new("field").number(id.0.into()).number(constant.to_bits().into()).finish()
}

impl Database {
    pub(crate) fn insert_document(&self, document: &Document) -> Result<()> {
        self.conn
            .execute(
                "INSERT INTO document (id, width, depth, spacing_m, page_size, head, last_entry, last_layer,
                                       last_field, checksum)
                 VALUES (1, ?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)",
                params![
                    document.grid.width(),
                    document.grid.depth(),
                    document.grid.spacing_m(),
                    document.layout.size(),
                    document.head.0,
                    document.last_entry,
                    document.last_layer,
                    document.last_field,
                    document.checksum(),
                ],
            )
            .map_err(|err| self.fault(err))?;
        Ok(())
    }

    /// Writes what changes: the place in the history and the last ids.
    pub(crate) fn update_document(&self, document: &Document) -> Result<()> {
        self.conn
            .prepare_cached(
                "UPDATE document SET head = ?1, last_entry = ?2, last_layer = ?3, last_field = ?4, checksum = ?5",
            )
            .and_then(|mut statement| {
                statement.execute(params![
                    document.head.0,
                    document.last_entry,
                    document.last_layer,
                    document.last_field,
                    document.checksum(),
                ])
            })
            .map_err(|err| self.fault(err))?;
        Ok(())
    }

    pub(crate) fn document(&self) -> Result<Document> {
        type Row = (i64, i64, f64, u32, u32, u32, u32, u32, Checksum);
        let row: Row = self
            .conn
            .prepare_cached(
                "SELECT width, depth, spacing_m, page_size, head, last_entry, last_layer, last_field, checksum
                 FROM document WHERE id = 1",
            )
            .and_then(|mut statement| {
                statement
                    .query_row([], |row| {
                        Ok((
                            row.get(0)?,
                            row.get(1)?,
                            row.get(2)?,
                            row.get(3)?,
                            row.get(4)?,
                            row.get(5)?,
                            row.get(6)?,
                            row.get(7)?,
                            row.get(8)?,
                        ))
                    })
                    .optional()
            })
            .map_err(|err| self.fault(err))?
            .ok_or_else(|| Error::damaged(self.path(), "it does not say how large the terrain is"))?;
        let (width, depth, spacing_m, page_size, head, last_entry, last_layer, last_field, checksum) = row;
        let wrong = |err: orogeny_field::Error| Error::damaged(self.path(), err.to_string());
        let document = Document {
            grid: TerrainGrid::new(width.cast_unsigned(), depth.cast_unsigned(), spacing_m).map_err(wrong)?,
            layout: PageLayout::new(page_size).map_err(wrong)?,
            head: EntryId(head),
            last_entry,
            last_layer,
            last_field,
        };
        if document.checksum() != checksum {
            return Err(Error::damaged(
                self.path(),
                "the row that says what terrain it is fails its checksum",
            ));
        }
        Ok(document)
    }

    pub(crate) fn insert_field(&self, id: FieldId, constant: f32) -> Result<()> {
        self.conn
            .execute(
                "INSERT INTO field (id, constant, checksum) VALUES (?1, ?2, ?3)",
                params![id.0, constant, field_checksum(id, constant)],
            )
            .map_err(|err| self.fault(err))?;
        Ok(())
    }

    /// The constants of all fields, those of undone layers too.
    pub(crate) fn field_constants(&self) -> Result<BTreeMap<FieldId, f32>> {
        let rows: Vec<(u32, f32, Checksum)> = self
            .conn
            .prepare("SELECT id, constant, checksum FROM field ORDER BY id")
            .and_then(|mut statement| {
                statement.query_map([], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?)))?.collect()
            })
            .map_err(|err| self.fault(err))?;
        let checked = rows.into_iter().map(|(id, constant, checksum)| {
            let id = FieldId(id);
            if field_checksum(id, constant) == checksum && orogeny_field::is_storable_height(constant) {
                Ok((id, constant))
            } else {
                Err(Error::damaged(self.path(), format!("field {} fails its checksum", id.0)))
            }
        });
        checked.collect()
    }
}
