//! The layers as they are, and the tree of entries with what each did to them.

use rusqlite::{OptionalExtension as _, Row, params};

use crate::checksum::{Checksum, RowHasher};
use crate::database::Database;
use crate::{EntryId, Error, Result};

/// A row of `entry`, without its checksum.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct EntryRow {
    pub(crate) id: EntryId,
    /// `None` for entry 0 only.
    pub(crate) parent: Option<EntryId>,
    pub(crate) operation: String,
    pub(crate) author: String,
    pub(crate) time_unix_ms: i64,
    pub(crate) num_pages: u32,
    pub(crate) delta_bytes: u64,
}

/// Where an entry stands in the tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct EntryLinks {
    pub(crate) id: EntryId,
    pub(crate) parent: Option<EntryId>,
    /// The child that redo goes to.
    pub(crate) next: Option<EntryId>,
    pub(crate) delta_bytes: u64,
}

/// What an entry did to a layer. `None` where the layer did not exist.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct LayerChange {
    pub(crate) layer: u32,
    pub(crate) before: Option<String>,
    pub(crate) after: Option<String>,
}

/// A row of `layer`: the layer as JSON.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct SavedLayer {
    pub(crate) id: u32,
    pub(crate) state: String,
}

impl EntryRow {
    fn checksum(&self) -> Checksum {
        RowHasher::new("entry")
            .number(self.id.0.into())
            .number(self.parent.map_or(-1, |parent| parent.0.into()))
            .bytes(self.operation.as_bytes())
            .bytes(self.author.as_bytes())
            .number(self.time_unix_ms)
            .number(self.num_pages.into())
            .number(self.delta_bytes.cast_signed())
            .finish()
    }

    /// Columns in the order of [`Database::entry`]'s statement.
    fn from_row(row: &Row<'_>) -> rusqlite::Result<(Self, Checksum)> {
        let entry = Self {
            id: EntryId(row.get(0)?),
            parent: row.get::<_, Option<u32>>(1)?.map(EntryId),
            operation: row.get(2)?,
            author: row.get(3)?,
            time_unix_ms: row.get(4)?,
            num_pages: row.get(5)?,
            delta_bytes: row.get::<_, i64>(6)?.cast_unsigned(),
        };
        Ok((entry, row.get(7)?))
    }

    fn checked((entry, checksum): (Self, Checksum)) -> Result<Self> {
        if entry.checksum() == checksum {
            Ok(entry)
        } else {
            let detail = "its record fails its checksum".to_owned();
            Err(Error::DamagedHistory { entry: entry.id, page: None, detail })
        }
    }
}

impl LayerChange {
    fn checksum(&self, entry: EntryId) -> Checksum {
        RowHasher::new("layer_change")
            .number(entry.0.into())
            .number(self.layer.into())
            .optional(self.before.as_deref().map(str::as_bytes))
            .optional(self.after.as_deref().map(str::as_bytes))
            .finish()
    }
}

impl SavedLayer {
    fn checksum(&self) -> Checksum {
        RowHasher::new("layer").number(self.id.into()).bytes(self.state.as_bytes()).finish()
    }
}

impl Database {
    pub(crate) fn insert_entry(&self, entry: &EntryRow) -> Result<()> {
        self.conn
            .prepare_cached(
                "INSERT INTO entry (id, parent, operation, author, time_unix_ms, num_pages, delta_bytes, checksum)
                 VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)",
            )
            .and_then(|mut statement| {
                statement.execute(params![
                    entry.id.0,
                    entry.parent.map(|parent| parent.0),
                    entry.operation,
                    entry.author,
                    entry.time_unix_ms,
                    entry.num_pages,
                    entry.delta_bytes.cast_signed(),
                    entry.checksum(),
                ])
            })
            .map_err(|err| self.fault(err))?;
        Ok(())
    }

    /// Makes `next` the entry that redo goes to from `entry`.
    pub(crate) fn set_next(&self, entry: EntryId, next: EntryId) -> Result<()> {
        self.conn
            .prepare_cached("UPDATE entry SET next = ?2 WHERE id = ?1")
            .and_then(|mut statement| statement.execute(params![entry.0, next.0]))
            .map_err(|err| self.fault(err))?;
        Ok(())
    }

    /// The entry that redo goes to from `entry`.
    pub(crate) fn next_of(&self, entry: EntryId) -> Result<Option<EntryId>> {
        self.conn
            .prepare_cached("SELECT next FROM entry WHERE id = ?1")
            .and_then(|mut statement| statement.query_row([entry.0], |row| row.get::<_, Option<u32>>(0)))
            .map(|next| next.map(EntryId))
            .map_err(|err| self.fault(err))
    }

    pub(crate) fn entry(&self, id: EntryId) -> Result<EntryRow> {
        self.conn
            .prepare_cached(
                "SELECT id, parent, operation, author, time_unix_ms, num_pages, delta_bytes, checksum
                 FROM entry WHERE id = ?1",
            )
            .and_then(|mut statement| statement.query_row([id.0], EntryRow::from_row).optional())
            .map_err(|err| self.fault(err))?
            .ok_or_else(|| Error::DamagedHistory {
                entry: id,
                page: None,
                detail: "its record is missing".to_owned(),
            })
            .and_then(EntryRow::checked)
    }

    /// Calls `visit` with each entry, oldest first, entry 0 included. One that fails its checksum comes as the error.
    pub(crate) fn for_each_entry(&self, mut visit: impl FnMut(Result<EntryRow>) -> Result<()>) -> Result<()> {
        let mut statement = self
            .conn
            .prepare(
                "SELECT id, parent, operation, author, time_unix_ms, num_pages, delta_bytes, checksum
                 FROM entry ORDER BY id",
            )
            .map_err(|err| self.fault(err))?;
        let mut rows = statement.query([]).map_err(|err| self.fault(err))?;
        while let Some(row) = rows.next().map_err(|err| self.fault(err))? {
            visit(EntryRow::checked(EntryRow::from_row(row).map_err(|err| self.fault(err))?))?;
        }
        Ok(())
    }

    /// How all entries hang together, oldest first, without reading the operations.
    pub(crate) fn entry_links(&self) -> Result<Vec<EntryLinks>> {
        self.conn
            .prepare("SELECT id, parent, next, delta_bytes FROM entry ORDER BY id")
            .and_then(|mut statement| {
                let links = statement.query_map([], |row| {
                    Ok(EntryLinks {
                        id: EntryId(row.get(0)?),
                        parent: row.get::<_, Option<u32>>(1)?.map(EntryId),
                        next: row.get::<_, Option<u32>>(2)?.map(EntryId),
                        delta_bytes: row.get::<_, i64>(3)?.cast_unsigned(),
                    })
                })?;
                links.collect()
            })
            .map_err(|err| self.fault(err))
    }

    pub(crate) fn insert_layer_change(&self, entry: EntryId, change: &LayerChange) -> Result<()> {
        self.conn
            .execute(
                "INSERT INTO layer_change (entry, layer, before, after, checksum) VALUES (?1, ?2, ?3, ?4, ?5)",
                params![entry.0, change.layer, change.before, change.after, change.checksum(entry)],
            )
            .map_err(|err| self.fault(err))?;
        Ok(())
    }

    pub(crate) fn layer_changes(&self, entry: EntryId) -> Result<Vec<LayerChange>> {
        let rows: Vec<(LayerChange, Checksum)> = self
            .conn
            .prepare_cached(
                "SELECT layer, before, after, checksum FROM layer_change WHERE entry = ?1 ORDER BY layer",
            )
            .and_then(|mut statement| {
                let rows = statement.query_map([entry.0], |row| {
                    let change = LayerChange { layer: row.get(0)?, before: row.get(1)?, after: row.get(2)? };
                    Ok((change, row.get(3)?))
                })?;
                rows.collect()
            })
            .map_err(|err| self.fault(err))?;
        let checked = rows.into_iter().map(|(change, checksum)| {
            if change.checksum(entry) == checksum {
                Ok(change)
            } else {
                let detail = format!("its change of layer {} fails its checksum", change.layer);
                Err(Error::DamagedHistory { entry, page: None, detail })
            }
        });
        checked.collect()
    }

    /// Writes the layer as it is now; `None` removes it.
    pub(crate) fn set_layer(&self, id: u32, state: Option<&str>) -> Result<()> {
        let written = match state {
            Some(state) => {
                let layer = SavedLayer { id, state: state.to_owned() };
                self.conn.execute(
                    "INSERT INTO layer (id, state, checksum) VALUES (?1, ?2, ?3)
                     ON CONFLICT (id) DO UPDATE SET state = excluded.state, checksum = excluded.checksum",
                    params![id, layer.state, layer.checksum()],
                )
            }
            None => self.conn.execute("DELETE FROM layer WHERE id = ?1", [id]),
        };
        written.map_err(|err| self.fault(err))?;
        Ok(())
    }

    pub(crate) fn saved_layers(&self) -> Result<Vec<SavedLayer>> {
        let rows: Vec<(SavedLayer, Checksum)> = self
            .conn
            .prepare("SELECT id, state, checksum FROM layer ORDER BY id")
            .and_then(|mut statement| {
                let rows = statement.query_map([], |row| {
                    Ok((SavedLayer { id: row.get(0)?, state: row.get(1)? }, row.get(2)?))
                })?;
                rows.collect()
            })
            .map_err(|err| self.fault(err))?;
        let checked = rows.into_iter().map(|(layer, checksum)| {
            if layer.checksum() == checksum {
                Ok(layer)
            } else {
                Err(Error::damaged(self.path(), format!("layer {} fails its checksum", layer.id)))
            }
        });
        checked.collect()
    }
}
