//! Pages and the deltas of the history: coded bytes with their place.

use std::ops::Range;

use orogeny_field::{FieldId, HeightBounds, PageKey, PageLayout};
use rusqlite::{OptionalExtension as _, Row, params};

use crate::checksum::{self, Checksum};
use crate::database::Database;
use crate::{EntryId, Error, Result, codec};

/// A page as it lies in the file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PageRow {
    pub(crate) key: PageKey,
    pub(crate) info: PageInfo,
    pub(crate) codec: u8,
    pub(crate) bytes: Vec<u8>,
}

/// What the directory says of a page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PageInfo {
    /// The entry whose state it holds; for a page above level 0 the last one of those below it.
    pub(crate) revision: EntryId,
    /// Lowest and highest height at full resolution, within the terrain.
    pub(crate) bounds: HeightBounds,
    /// How far the surface of a page above level 0 is from full resolution, at most; 0 of level 0.
    pub(crate) error_m: f32,
}

/// What an entry did to a page, as it lies in the file: after minus before.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct DeltaRow {
    pub(crate) key: PageKey,
    /// The page's revision before the entry; `None` where it was absent.
    pub(crate) revision_before: Option<EntryId>,
    pub(crate) codec: u8,
    pub(crate) bytes: Vec<u8>,
}

fn key_from_row(row: &Row<'_>, first_column: usize) -> rusqlite::Result<PageKey> {
    Ok(PageKey {
        field: FieldId(row.get(first_column)?),
        level: row.get(first_column + 1)?,
        z: row.get(first_column + 2)?,
        x: row.get(first_column + 3)?,
    })
}

/// From `revision, min_m, max_m, error_m`, the first columns of a row.
fn info_from_row(row: &Row<'_>) -> rusqlite::Result<PageInfo> {
    let bounds = HeightBounds { min_m: row.get(1)?, max_m: row.get(2)? };
    Ok(PageInfo { revision: EntryId(row.get(0)?), bounds, error_m: row.get(3)? })
}

/// The longest blob that is read: longer is damage.
fn max_blob_bytes(layout: PageLayout) -> i64 {
    i64::try_from(codec::max_size_in_bytes(layout.num_samples())).unwrap_or(i64::MAX)
}

/// A page with its bytes.
const PAGE: &str = "SELECT page.revision, page.min_m, page.max_m, page.error_m,
                           page.codec, page.checksum, length(page_data.bytes),
                           CASE WHEN length(page_data.bytes) <= ?5 THEN page_data.bytes END
                    FROM page LEFT JOIN page_data ON page_data.id = page.data
                    WHERE page.field = ?1 AND page.level = ?2 AND page.z = ?3 AND page.x = ?4";

/// The same of a state that is not the file's: bytes that are the same are still there.
const PAST_PAGE: &str = "SELECT page.revision, page.min_m, page.max_m, page.error_m,
                                page.codec, page.checksum, length(coalesce(own.bytes, same.bytes)),
                                CASE WHEN length(coalesce(own.bytes, same.bytes)) <= ?5
                                     THEN coalesce(own.bytes, same.bytes) END
                         FROM temp.page AS page
                         LEFT JOIN temp.page_data AS own ON own.id = page.data
                         LEFT JOIN main.page_data AS same ON same.id = page.data
                         WHERE page.field = ?1 AND page.level = ?2 AND page.z = ?3 AND page.x = ?4";

impl Database {
    /// A page, its checksum verified; `None` where the terrain has no such page.
    pub(crate) fn page(&self, layout: PageLayout, key: &PageKey) -> Result<Option<PageRow>> {
        type Columns = (PageInfo, u8, Checksum, Option<i64>, Option<Vec<u8>>);
        let columns: Option<Columns> = self
            .statement(if self.is_past() { PAST_PAGE } else { PAGE })
            .and_then(|mut statement| {
                statement
                    .query_row(params![key.field.0, key.level, key.z, key.x, max_blob_bytes(layout)], |row| {
                        Ok((info_from_row(row)?, row.get(4)?, row.get(5)?, row.get(6)?, row.get(7)?))
                    })
                    .optional()
            })
            .map_err(|err| match self.fault(err) {
                Error::Damaged { detail, .. } => Error::damaged_page(*key, detail),
                err => err,
            })?;
        let Some((info, codec, checksum, length, bytes)) = columns else { return Ok(None) };
        let Some(bytes) = bytes else {
            let detail = length.map_or_else(
                || "its bytes are missing".to_owned(),
                |length| format!("it has {length} bytes, more than any page can have"),
            );
            return Err(Error::damaged_page(*key, detail));
        };
        if checksum::of_page(key, &info, codec, &bytes) != checksum {
            return Err(Error::damaged_page(*key, "it fails its checksum"));
        }
        self.counters.read(&bytes);
        Ok(Some(PageRow { key: *key, info, codec, bytes }))
    }

    /// What the directory says of a page, without reading the page; `None` where there is none.
    pub(crate) fn page_info(&self, key: &PageKey) -> Result<Option<PageInfo>> {
        self.statement(
            "SELECT revision, min_m, max_m, error_m FROM page WHERE field = ?1 AND level = ?2 AND z = ?3 AND x = ?4",
        )
        .and_then(|mut statement| {
            statement
                .query_row(params![key.field.0, key.level, key.z, key.x], info_from_row)
                .optional()
        })
        .map_err(|err| self.fault(err))
    }

    /// How many pages a field has at full resolution.
    pub(crate) fn num_pages(&self, field: FieldId) -> Result<u64> {
        self.statement("SELECT count(*) FROM page WHERE field = ?1 AND level = 0")
            .and_then(|mut statement| statement.query_row([field.0], |row| row.get::<_, i64>(0)))
            .map(i64::cast_unsigned)
            .map_err(|err| self.fault(err))
    }

    /// The pages of a level of a field whose columns and rows lie in these ranges, in the order of their keys.
    pub(crate) fn page_keys_in(
        &self,
        field: FieldId,
        level: u8,
        rows: Range<u32>,
        columns: Range<u32>,
    ) -> Result<Vec<PageKey>> {
        self.statement(
            "SELECT field, level, z, x FROM page
             WHERE field = ?1 AND level = ?2 AND z >= ?3 AND z < ?4 AND x >= ?5 AND x < ?6 ORDER BY z, x",
        )
        .and_then(|mut statement| {
            let place = params![field.0, level, rows.start, rows.end, columns.start, columns.end];
            statement.query_map(place, |row| key_from_row(row, 0))?.collect()
        })
        .map_err(|err| self.fault(err))
    }

    /// The pages of a field at all levels, in the order of their keys.
    pub(crate) fn page_keys(&self, field: FieldId) -> Result<Vec<PageKey>> {
        self.statement("SELECT field, level, z, x FROM page WHERE field = ?1 ORDER BY level, z, x")
            .and_then(|mut statement| statement.query_map([field.0], |row| key_from_row(row, 0))?.collect())
            .map_err(|err| self.fault(err))
    }

    /// As [`Self::page_keys`], at full resolution, up to where the directory is damaged, with what that is.
    pub(crate) fn page_keys_as_far_as_possible(
        &self,
        field: FieldId,
        problems: &mut Vec<String>,
    ) -> Vec<PageKey> {
        let mut keys = Vec::new();
        let read = self
            .statement("SELECT field, level, z, x FROM page WHERE field = ?1 AND level = 0 ORDER BY z, x")
            .and_then(|mut statement| {
                let mut rows = statement.query([field.0])?;
                while let Some(row) = rows.next()? {
                    keys.push(key_from_row(row, 0)?);
                }
                Ok(())
            });
        if let Err(err) = read {
            problems.push(format!("the pages of field {} end in damage: {err}", field.0));
        }
        keys
    }

    /// Up to `limit` pages of all fields that come after `last`.
    pub(crate) fn page_keys_after(&self, last: Option<PageKey>, limit: u32) -> Result<Vec<PageKey>> {
        let (field, level, z, x) =
            last.map_or((-1, -1, -1, -1), |k| (k.field.0.into(), k.level.into(), k.z.into(), k.x.into()));
        self.statement(
            "SELECT field, level, z, x FROM page WHERE (field, level, z, x) > (?1, ?2, ?3, ?4)
                 ORDER BY field, level, z, x LIMIT ?5",
        )
        .and_then(|mut statement| {
            let columns: [i64; 5] = [field, level, z, x, limit.into()];
            statement.query_map(columns, |row| key_from_row(row, 0))?.collect()
        })
        .map_err(|err| self.fault(err))
    }

    /// Writes a page, new or not.
    pub(crate) fn write_page(&self, page: &PageRow) -> Result<()> {
        self.counters.wrote(&page.bytes);
        self.write_page_row(page).map_err(|err| self.fault(err))
    }

    fn write_page_row(&self, page: &PageRow) -> rusqlite::Result<()> {
        let key = &page.key;
        let old_data: Option<i64> = self
            .statement("SELECT data FROM page WHERE field = ?1 AND level = ?2 AND z = ?3 AND x = ?4")?
            .query_row(params![key.field.0, key.level, key.z, key.x], |row| row.get(0))
            .optional()?;
        let data = if let Some(data) = old_data {
            let sql = if self.is_past() {
                "INSERT OR REPLACE INTO page_data (id, bytes) VALUES (?1, ?2)"
            } else {
                "UPDATE page_data SET bytes = ?2 WHERE id = ?1"
            };
            self.statement(sql)?.execute(params![data, page.bytes])?;
            data
        } else {
            self.statement("INSERT INTO page_data (bytes) VALUES (?1)")?.insert([&page.bytes])?
        };
        self.write_page_info(page, data)
    }

    /// Puts into the directory a page whose bytes lie there already, under the number `data`.
    pub(crate) fn insert_page_info(&self, page: &PageRow, data: i64) -> Result<()> {
        self.write_page_info(page, data).map_err(|err| self.fault(err))
    }

    /// As [`Self::insert_page_info`], for a page that is damaged and is to stay so: with a checksum that nothing has.
    pub(crate) fn insert_damaged_page_info(&self, page: &PageRow, data: i64) -> Result<()> {
        self.insert_page_info(page, data)?;
        let key = &page.key;
        self.statement(
            "UPDATE page SET checksum = zeroblob(16) WHERE field = ?1 AND level = ?2 AND z = ?3 AND x = ?4",
        )
        .and_then(|mut statement| statement.execute(params![key.field.0, key.level, key.z, key.x]))
        .map_err(|err| self.fault(err))?;
        Ok(())
    }

    /// Puts a page into the directory that is there and cannot be made.
    pub(crate) fn insert_damaged_page(&self, key: PageKey, info: PageInfo) -> Result<()> {
        let insert = self.statement("INSERT INTO page_data (bytes) VALUES (x'')");
        let data = insert.and_then(|mut statement| statement.insert([])).map_err(|err| self.fault(err))?;
        let row = PageRow { key, info, codec: codec::WRITTEN, bytes: Vec::new() };
        self.insert_damaged_page_info(&row, data)
    }

    fn write_page_info(&self, page: &PageRow, data: i64) -> rusqlite::Result<()> {
        let PageRow { key, info, codec, bytes } = page;
        let PageInfo { revision, bounds, error_m } = info;
        let checksum = checksum::of_page(key, info, *codec, bytes);
        self.statement(
            "INSERT INTO page (field, level, z, x, revision, min_m, max_m, codec, data, checksum, error_m)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11)
             ON CONFLICT DO UPDATE SET revision = excluded.revision, min_m = excluded.min_m, max_m = excluded.max_m,
                                       codec = excluded.codec, data = excluded.data, checksum = excluded.checksum,
                                       error_m = excluded.error_m",
        )?
        .execute(params![
            key.field.0,
            key.level,
            key.z,
            key.x,
            revision.0,
            bounds.min_m,
            bounds.max_m,
            codec,
            data,
            checksum,
            error_m
        ])?;
        Ok(())
    }

    /// Removes a page: the field holds its constant there.
    pub(crate) fn delete_page(&self, key: &PageKey) -> Result<()> {
        let place = params![key.field.0, key.level, key.z, key.x];
        self.statement(
            "DELETE FROM page_data WHERE id =
                 (SELECT data FROM page WHERE field = ?1 AND level = ?2 AND z = ?3 AND x = ?4)",
        )
        .and_then(|mut statement| statement.execute(place))
        .and_then(|_| {
            self.statement("DELETE FROM page WHERE field = ?1 AND level = ?2 AND z = ?3 AND x = ?4")
        })
        .and_then(|mut statement| statement.execute(place))
        .map_err(|err| self.fault(err))?;
        Ok(())
    }

    /// Writes what `entry` did to a page, in place of what was there from the same entry.
    pub(crate) fn write_delta(&self, entry: EntryId, delta: &DeltaRow) -> Result<()> {
        let DeltaRow { key, revision_before, codec, bytes } = delta;
        self.counters.wrote(bytes);
        self.statement(
            "INSERT INTO delta (entry, field, level, z, x, revision_before, codec, checksum, bytes)
                 VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)
                 ON CONFLICT (entry, field, level, z, x) DO UPDATE
                 SET revision_before = excluded.revision_before, codec = excluded.codec,
                     checksum = excluded.checksum, bytes = excluded.bytes",
        )
        .and_then(|mut statement| {
            statement.execute(params![
                entry.0,
                key.field.0,
                key.level,
                key.z,
                key.x,
                revision_before.map(|revision| revision.0),
                codec,
                checksum::of_delta(entry, key, *revision_before, *codec, bytes),
                bytes,
            ])
        })
        .map_err(|err| self.fault(err))?;
        Ok(())
    }

    pub(crate) fn delete_delta(&self, entry: EntryId, key: &PageKey) -> Result<()> {
        self.statement(
            "DELETE FROM delta WHERE entry = ?1 AND field = ?2 AND level = ?3 AND z = ?4 AND x = ?5",
        )
        .and_then(|mut statement| statement.execute(params![entry.0, key.field.0, key.level, key.z, key.x]))
        .map_err(|err| self.fault(err))?;
        Ok(())
    }

    /// What `entry` did to a page, its checksum verified.
    pub(crate) fn delta(&self, layout: PageLayout, entry: EntryId, key: &PageKey) -> Result<DeltaRow> {
        type Columns = (Option<u32>, u8, Checksum, i64, Option<Vec<u8>>);
        let damaged = |detail: String| Error::DamagedHistory { entry, page: Some(*key), detail };
        let columns: Option<Columns> = self.statement(
                "SELECT revision_before, codec, checksum, length(bytes), CASE WHEN length(bytes) <= ?6 THEN bytes END
                 FROM delta WHERE entry = ?1 AND field = ?2 AND level = ?3 AND z = ?4 AND x = ?5",
            )
            .and_then(|mut statement| {
                statement
                    .query_row(
                        params![entry.0, key.field.0, key.level, key.z, key.x, max_blob_bytes(layout)],
                        |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?, row.get(4)?)),
                    )
                    .optional()
            })
            .map_err(|err| match self.fault(err) {
                Error::Damaged { detail, .. } => damaged(detail),
                err => err,
            })?;
        let (revision_before, codec, checksum, length, bytes) =
            columns.ok_or_else(|| damaged("its delta is missing".to_owned()))?;
        let bytes = bytes
            .ok_or_else(|| damaged(format!("its delta has {length} bytes, more than any page can have")))?;
        let revision_before = revision_before.map(EntryId);
        if checksum::of_delta(entry, key, revision_before, codec, &bytes) != checksum {
            return Err(damaged("its delta fails its checksum".to_owned()));
        }
        self.counters.read(&bytes);
        Ok(DeltaRow { key: *key, revision_before, codec, bytes })
    }

    /// The pages that `entry` changed, in the order of their keys.
    pub(crate) fn delta_keys(&self, entry: EntryId) -> Result<Vec<PageKey>> {
        self.statement("SELECT field, level, z, x FROM delta WHERE entry = ?1 ORDER BY field, level, z, x")
            .and_then(|mut statement| statement.query_map([entry.0], |row| key_from_row(row, 0))?.collect())
            .map_err(|err| self.fault(err))
    }

    /// The entries that changed a page, oldest first, whether they show or not.
    pub(crate) fn entries_of_page(&self, key: &PageKey) -> Result<Vec<EntryId>> {
        self.statement(
            "SELECT entry FROM delta WHERE field = ?1 AND level = ?2 AND z = ?3 AND x = ?4 ORDER BY entry",
        )
        .and_then(|mut statement| {
            let place = params![key.field.0, key.level, key.z, key.x];
            statement.query_map(place, |row| row.get(0).map(EntryId))?.collect()
        })
        .map_err(|err| self.fault(err))
    }

    /// How many pages `entry` changed, and the bytes of its deltas.
    pub(crate) fn delta_totals(&self, entry: EntryId) -> Result<(u32, u64)> {
        self.statement("SELECT count(*), coalesce(sum(length(bytes)), 0) FROM delta WHERE entry = ?1")
            .and_then(|mut statement| {
                statement.query_row([entry.0], |row| Ok((row.get(0)?, row.get::<_, i64>(1)?.cast_unsigned())))
            })
            .map_err(|err| self.fault(err))
    }

    /// Pages whose revision is not the last applied entry that changed them, by comparison of the directory with the
    /// history; `true` marks those that the directory has.
    pub(crate) fn pages_that_contradict_the_history(&self) -> Result<Vec<(PageKey, bool)>> {
        const LAST_CHANGES: &str = "SELECT field, level, z, x, max(entry) FROM delta
                                    WHERE entry IN applied GROUP BY field, level, z, x";
        // What entries left that were dropped since has no history.
        const DIRECTORY: &str = "SELECT field, level, z, x, revision FROM page
                                 WHERE level = 0 AND revision > (SELECT floor FROM document)";
        let mut found = Vec::new();
        for (left, right, is_in_directory) in
            [(DIRECTORY, LAST_CHANGES, true), (LAST_CHANGES, DIRECTORY, false)]
        {
            let sql = format!(
                "WITH RECURSIVE applied (id) AS (
                     SELECT head FROM document
                     UNION SELECT parent FROM entry JOIN applied USING (id) WHERE parent IS NOT NULL
                 )
                 {left} EXCEPT {right} LIMIT 1000"
            );
            let keys: Vec<PageKey> = self
                .statement(&sql)
                .and_then(|mut statement| statement.query_map([], |row| key_from_row(row, 0))?.collect())
                .map_err(|err| self.fault(err))?;
            found.extend(keys.into_iter().map(|key| (key, is_in_directory)));
        }
        Ok(found)
    }

    /// Pages above level 0 over which nothing lies that they could be made of, at most a hundred.
    pub(crate) fn pages_made_of_nothing(&self) -> Result<Vec<PageKey>> {
        self.statement(
            "SELECT field, level, z, x FROM page AS above WHERE level > 0 AND NOT EXISTS
             (SELECT 1 FROM page AS below WHERE below.field = above.field AND below.level = above.level - 1
              AND below.z BETWEEN 2 * above.z - 1 AND 2 * above.z + 2
              AND below.x BETWEEN 2 * above.x - 1 AND 2 * above.x + 2) LIMIT 100",
        )
        .and_then(|mut statement| statement.query_map([], |row| key_from_row(row, 0))?.collect())
        .map_err(|err| self.fault(err))
    }

    /// What SQLite's own check of the file finds, at most a hundred lines.
    pub(crate) fn structural_problems(&self) -> Result<Vec<String>> {
        let lines = |sql: &str| -> rusqlite::Result<Vec<String>> {
            self.statement(sql)?.query_map([], |row| row.get(0))?.collect()
        };
        let mut problems = lines("PRAGMA integrity_check(100)").map_err(|err| self.fault(err))?;
        problems.retain(|line| line != "ok");
        let broken_links = lines(
            "SELECT 'a row of ' || \"table\" || ' names a row of ' || parent || ' that does not exist'
             FROM pragma_foreign_key_check LIMIT 100",
        );
        problems.extend(broken_links.map_err(|err| self.fault(err))?);
        Ok(problems)
    }
}
