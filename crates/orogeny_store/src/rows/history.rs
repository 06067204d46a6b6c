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
        self.statement(
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
    pub(crate) fn set_next(&self, entry: EntryId, next: Option<EntryId>) -> Result<()> {
        self.statement("UPDATE entry SET next = ?2 WHERE id = ?1")
            .and_then(|mut statement| statement.execute(params![entry.0, next.map(|next| next.0)]))
            .map_err(|err| self.fault(err))?;
        Ok(())
    }

    /// The entry that redo goes to from `entry`.
    pub(crate) fn next_of(&self, entry: EntryId) -> Result<Option<EntryId>> {
        self.statement("SELECT next FROM entry WHERE id = ?1")
            .and_then(|mut statement| statement.query_row([entry.0], |row| row.get::<_, Option<u32>>(0)))
            .map(|next| next.map(EntryId))
            .map_err(|err| self.fault(err))
    }

    pub(crate) fn entry(&self, id: EntryId) -> Result<EntryRow> {
        self.statement(
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

    /// Calls `visit` with each entry from one on, oldest first. One that fails its checksum comes as the error.
    pub(crate) fn for_each_entry(
        &self,
        first: EntryId,
        mut visit: impl FnMut(Result<EntryRow>) -> Result<()>,
    ) -> Result<()> {
        let mut statement = self
            .statement(
                "SELECT id, parent, operation, author, time_unix_ms, num_pages, delta_bytes, checksum
                 FROM entry WHERE id >= ?1 ORDER BY id",
            )
            .map_err(|err| self.fault(err))?;
        let mut rows = statement.query([first.0]).map_err(|err| self.fault(err))?;
        while let Some(row) = rows.next().map_err(|err| self.fault(err))? {
            visit(EntryRow::checked(EntryRow::from_row(row).map_err(|err| self.fault(err))?))?;
        }
        Ok(())
    }

    /// How all entries hang together, oldest first, without reading the operations.
    pub(crate) fn entry_links(&self) -> Result<Vec<EntryLinks>> {
        self.statement("SELECT id, parent, next FROM entry ORDER BY id")
            .and_then(|mut statement| {
                let links = statement.query_map([], |row| {
                    Ok(EntryLinks {
                        id: EntryId(row.get(0)?),
                        parent: row.get::<_, Option<u32>>(1)?.map(EntryId),
                        next: row.get::<_, Option<u32>>(2)?.map(EntryId),
                    })
                })?;
                links.collect()
            })
            .map_err(|err| self.fault(err))
    }

    /// The children of an entry, oldest first.
    pub(crate) fn children_of(&self, entry: EntryId) -> Result<Vec<EntryId>> {
        self.statement("SELECT id FROM entry WHERE parent = ?1 ORDER BY id")
            .and_then(|mut statement| {
                statement.query_map([entry.0], |row| row.get(0).map(EntryId))?.collect()
            })
            .map_err(|err| self.fault(err))
    }

    /// What an entry takes in the file, in bytes: its deltas, its operation, and data from outside that no other entry
    /// needs.
    pub(crate) fn entry_bytes(&self, entry: EntryId) -> Result<u64> {
        let count = |sql: &str| {
            self.statement(sql)
                .and_then(|mut statement| statement.query_row([entry.0], |row| row.get::<_, i64>(0)))
                .map(i64::cast_unsigned)
                .map_err(|err| self.fault(err))
        };
        let deltas = count("SELECT coalesce(sum(length(bytes)), 0) FROM delta WHERE entry = ?1")?;
        let operation =
            count("SELECT coalesce(sum(length(CAST(operation AS BLOB))), 0) FROM entry WHERE id = ?1")?;
        let blobs = count(
            "SELECT coalesce(sum(length(bytes)), 0) FROM blob_chunk WHERE blob IN
             (SELECT blob FROM entry_blob AS mine WHERE entry = ?1 AND NOT EXISTS
              (SELECT 1 FROM entry_blob AS other WHERE other.blob = mine.blob AND other.entry <> ?1))",
        )?;
        Ok(deltas + operation + blobs)
    }

    /// What all of the history takes in the file, in bytes, summed up anew.
    pub(crate) fn history_bytes(&self) -> Result<u64> {
        self.statement(
            "SELECT (SELECT coalesce(sum(length(bytes)), 0) FROM delta)
                  + (SELECT coalesce(sum(length(CAST(operation AS BLOB))), 0) FROM entry WHERE id <> 0)
                  + (SELECT coalesce(sum(length(bytes)), 0) FROM blob_chunk)",
        )
        .and_then(|mut statement| statement.query_row([], |row| row.get::<_, i64>(0)))
        .map(i64::cast_unsigned)
        .map_err(|err| self.fault(err))
    }

    /// Removes an entry that has no children, with its deltas and what only it needs. Whoever redid to it no longer does.
    pub(crate) fn delete_entry(&self, entry: EntryId) -> Result<()> {
        for sql in [
            "DELETE FROM delta WHERE entry = ?1",
            "DELETE FROM layer_change WHERE entry = ?1",
            "UPDATE entry SET next = NULL WHERE next = ?1",
            "DELETE FROM blob_chunk WHERE blob IN
             (SELECT blob FROM entry_blob AS mine WHERE entry = ?1 AND NOT EXISTS
              (SELECT 1 FROM entry_blob AS other WHERE other.blob = mine.blob AND other.entry <> ?1))",
            "DELETE FROM entry_blob WHERE entry = ?1",
            "DELETE FROM entry WHERE id = ?1",
        ] {
            self.statement(sql)
                .and_then(|mut statement| statement.execute([entry.0]))
                .map_err(|err| self.fault(err))?;
        }
        self.statement("DELETE FROM blob WHERE id NOT IN (SELECT blob FROM entry_blob)")
            .and_then(|mut statement| statement.execute([]))
            .map_err(|err| self.fault(err))?;
        Ok(())
    }

    /// Puts an entry on top of another one than before.
    pub(crate) fn set_parent(&self, entry: EntryId, parent: EntryId) -> Result<()> {
        let row = EntryRow { parent: Some(parent), ..self.entry(entry)? };
        self.statement("UPDATE entry SET parent = ?2, checksum = ?3 WHERE id = ?1")
            .and_then(|mut statement| statement.execute(params![entry.0, parent.0, row.checksum()]))
            .map_err(|err| self.fault(err))?;
        Ok(())
    }

    /// Makes what an entry did to the layers part of what `base` did.
    pub(crate) fn fold_layer_changes(&self, entry: EntryId, base: EntryId) -> Result<()> {
        for change in self.layer_changes(entry)? {
            self.set_layer_change(base, &LayerChange { before: None, ..change })?;
        }
        // Data that a layer is made of is needed as long as the layer is: its state names it.
        self.statement(
            "INSERT OR IGNORE INTO entry_blob (entry, blob)
             SELECT ?2, blob FROM entry_blob JOIN blob ON blob.id = blob WHERE entry = ?1 AND EXISTS
             (SELECT 1 FROM layer_change AS kept WHERE kept.entry = ?2 AND instr(kept.after, lower(hex(hash))) > 0)",
        )
        .and_then(|mut statement| statement.execute([entry.0, base.0]))
        .map_err(|err| self.fault(err))?;
        Ok(())
    }

    pub(crate) fn insert_layer_change(&self, entry: EntryId, change: &LayerChange) -> Result<()> {
        self.statement(
            "INSERT INTO layer_change (entry, layer, before, after, checksum) VALUES (?1, ?2, ?3, ?4, ?5)",
        )
        .and_then(|mut statement| {
            let checksum = change.checksum(entry);
            statement.execute(params![entry.0, change.layer, change.before, change.after, checksum])
        })
        .map_err(|err| self.fault(err))?;
        Ok(())
    }

    /// As [`Self::insert_layer_change`], in place of what the same entry did to the layer before.
    pub(crate) fn set_layer_change(&self, entry: EntryId, change: &LayerChange) -> Result<()> {
        self.statement("DELETE FROM layer_change WHERE entry = ?1 AND layer = ?2")
            .and_then(|mut statement| statement.execute(params![entry.0, change.layer]))
            .map_err(|err| self.fault(err))?;
        self.insert_layer_change(entry, change)
    }

    pub(crate) fn layer_changes(&self, entry: EntryId) -> Result<Vec<LayerChange>> {
        let rows: Vec<(LayerChange, Checksum)> = self
            .statement(
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
                self.statement(
                    "INSERT INTO layer (id, state, checksum) VALUES (?1, ?2, ?3)
                     ON CONFLICT (id) DO UPDATE SET state = excluded.state, checksum = excluded.checksum",
                )
                .and_then(|mut statement| statement.execute(params![id, layer.state, layer.checksum()]))
            }
            None => self
                .statement("DELETE FROM layer WHERE id = ?1")
                .and_then(|mut statement| statement.execute([id])),
        };
        written.map_err(|err| self.fault(err))?;
        Ok(())
    }

    pub(crate) fn saved_layers(&self) -> Result<Vec<SavedLayer>> {
        let mut problems = Vec::new();
        let layers = self.layer_states_as_found(&mut problems)?;
        match problems.into_iter().next() {
            Some(problem) => Err(Error::damaged(self.path(), problem)),
            None => Ok(layers.into_iter().map(|(id, state)| SavedLayer { id, state }).collect()),
        }
    }

    /// The layers' ids and JSON, whatever fails its checksum, with what that is.
    pub(crate) fn layer_states_as_found(&self, problems: &mut Vec<String>) -> Result<Vec<(u32, String)>> {
        let rows: Vec<(u32, String, Vec<u8>)> = self
            .statement("SELECT id, state, checksum FROM layer ORDER BY id")
            .and_then(|mut statement| {
                statement.query_map([], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?)))?.collect()
            })
            .map_err(|err| self.fault(err))?;
        let mut layers = Vec::with_capacity(rows.len());
        for (id, state, checksum) in rows {
            let layer = SavedLayer { id, state };
            if layer.checksum() != *checksum {
                problems.push(format!("layer {id} fails its checksum"));
            }
            layers.push((id, layer.state));
        }
        Ok(layers)
    }
}
