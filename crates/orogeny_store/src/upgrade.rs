//! Files of older versions, brought up to date when they are opened for writing: all of it in one transaction, or nothing.
//!
//! A damaged page stays one: it is refused by name, and can be repaired as any other.
//!
//! Version 1 had no levels above full resolution, no bounds of pages, no data from outside and no budget of the history. Version 2 did not
//! say how far a coarse page is from full resolution. Version 3 has the tables of version 4; its layers were all made of heights, which is
//! what a layer is that says nothing else.

use orogeny_field::{FieldId, HeightBounds, PageKey, PageLayout, TerrainGrid};
use rusqlite::params;

use crate::checksum::{Checksum, RowHasher};
use crate::database::Database;
use crate::pyramid::{self, Changed};
use crate::rows::{Document, PageInfo, PageRow};
use crate::stack::Stack;
use crate::{EntryId, Error, Field, FieldKind, Result, codec, content, format};

/// What is made anew of version 1; its rows come from tables that are renamed meanwhile.
const RENAMED: [&str; 3] = ["document", "field", "page"];

/// Brings a file of an older version up to date.
pub(crate) fn to_current(db: &Database, version: i32) -> Result<()> {
    match version {
        ..2 => from_version_1(db),
        2 => from_version_2(db),
        _ => db.in_transaction(|| set_current_version(db)),
    }
}

fn set_current_version(db: &Database) -> Result<()> {
    db.run(&format!("PRAGMA user_version = {}", format::FORMAT_VERSION))
}

/// Makes all coarse pages anew, with their errors; there may be more of them. Those of full resolution stay as they are, with their checksums.
fn from_version_2(db: &Database) -> Result<()> {
    db.in_transaction(|| {
        db.run("ALTER TABLE page ADD COLUMN error_m REAL NOT NULL DEFAULT 0")?;
        let (document, stack) = (db.document()?, Stack::load(db)?);
        let Document { grid, layout, .. } = document;
        let mut pages = Changed::new();
        for field in stack.fields.keys() {
            let keys = db.page_keys(*field)?.into_iter().filter(|key| key.level == 0);
            pages.extend(pyramid::all_of(&grid, layout, keys));
        }
        pyramid::refresh(db, grid, layout, |key| stack.constant(key), pages)?;
        set_current_version(db)
    })
}

/// Brings a file of version 1 up to date.
fn from_version_1(db: &Database) -> Result<()> {
    // Rows name the tables that are made anew, and the new ones in the end.
    db.run("PRAGMA foreign_keys = OFF")?;
    db.in_transaction(|| {
        for table in RENAMED {
            // Without this, SQLite would make those who refer to the table refer to its new name.
            db.run("PRAGMA legacy_alter_table = ON")?;
            db.run(&format!("ALTER TABLE {table} RENAME TO {table}_1"))?;
        }
        create_missing_tables(db)?;
        let document = document(db)?;
        fields(db)?;
        let pages = pages(db, &document)?;
        for table in RENAMED {
            db.run(&format!("DROP TABLE {table}_1"))?;
        }
        db.write_document(&Document { history_bytes: db.history_bytes()?, ..document.clone() })?;
        let stack = Stack::load(db)?;
        pyramid::refresh(db, document.grid, document.layout, |key| stack.constant(key), pages)?;
        set_current_version(db)
    })?;
    db.run("PRAGMA legacy_alter_table = OFF; PRAGMA foreign_keys = ON")
}

/// The tables and indexes of this version that are not there.
fn create_missing_tables(db: &Database) -> Result<()> {
    for statement in format::SCHEMA.split(';').filter(|statement| !statement.trim().is_empty()) {
        let missing = statement.replacen("CREATE TABLE", "CREATE TABLE IF NOT EXISTS", 1).replacen(
            "CREATE INDEX",
            "CREATE INDEX IF NOT EXISTS",
            1,
        );
        db.run(&missing)?;
    }
    Ok(())
}

fn damaged(db: &Database, what: &str) -> Error {
    Error::damaged(db.path(), format!("{what} fails its checksum"))
}

fn document(db: &Database) -> Result<Document> {
    type Row = (i64, i64, f64, [u32; 5], Checksum);
    let (width, depth, spacing_m, numbers, checksum): Row = db
        .statement(
            "SELECT width, depth, spacing_m, page_size, head, last_entry, last_layer, last_field, checksum
             FROM document_1 WHERE id = 1",
        )
        .and_then(|mut statement| {
            statement.query_row([], |row| {
                let numbers = [row.get(3)?, row.get(4)?, row.get(5)?, row.get(6)?, row.get(7)?];
                Ok((row.get(0)?, row.get(1)?, row.get(2)?, numbers, row.get(8)?))
            })
        })
        .map_err(|err| db.fault(err))?;
    let hasher = RowHasher::new("document").number(width).number(depth);
    let hasher = hasher.number(spacing_m.to_bits().cast_signed());
    let expected = numbers.iter().fold(hasher, |hasher, number| hasher.number((*number).into())).finish();
    if expected != checksum {
        return Err(damaged(db, "the row that says what terrain it is"));
    }
    let grid = TerrainGrid::new(width.cast_unsigned(), depth.cast_unsigned(), spacing_m)?;
    let [page_size, head, last_entry, last_layer, last_field] = numbers;
    let document = Document::new(grid, PageLayout::new(page_size)?);
    Ok(Document { sequence: 1, head: EntryId(head), last_entry, last_layer, last_field, ..document })
}

/// All fields of version 1 hold heights.
fn fields(db: &Database) -> Result<()> {
    let rows: Vec<(u32, f32, Checksum)> = db
        .statement("SELECT id, constant, checksum FROM field_1 ORDER BY id")
        .and_then(|mut statement| {
            statement.query_map([], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?)))?.collect()
        })
        .map_err(|err| db.fault(err))?;
    for (id, constant, checksum) in rows {
        let row = RowHasher::new("field").number(id.into()).number(constant.to_bits().into());
        if row.finish() != checksum {
            return Err(damaged(db, &format!("field {id}")));
        }
        db.insert_field(FieldId(id), Field { kind: FieldKind::Heights, constant })?;
    }
    Ok(())
}

/// Gives the pages that are there, all of them changed.
fn pages(db: &Database, document: &Document) -> Result<Changed> {
    let Document { grid, layout, .. } = *document;
    let keys: Vec<PageKey> = db
        .statement("SELECT field, level, z, x FROM page_1 WHERE level = 0 ORDER BY field, z, x")
        .and_then(|mut statement| {
            let key = |row: &rusqlite::Row<'_>| {
                Ok(PageKey {
                    field: FieldId(row.get(0)?),
                    level: row.get(1)?,
                    z: row.get(2)?,
                    x: row.get(3)?,
                })
            };
            statement.query_map([], key)?.collect()
        })
        .map_err(|err| db.fault(err))?;
    // One that no terrain has is not taken along.
    let keys: Vec<_> = keys.into_iter().filter(|key| layout.has_page(&grid, key)).collect();
    for key in &keys {
        let Some((row, data, checksum)) = page(db, layout, key)? else {
            // Its bytes are missing, or make no sense.
            let info = PageInfo { revision: EntryId::CREATION, bounds: HeightBounds::of(0.0), error_m: 0.0 };
            db.insert_damaged_page(*key, info)?;
            continue;
        };
        let hasher = RowHasher::new("page").place(key).number(row.info.revision.0.into());
        let is_whole = hasher.number(row.codec.into()).bytes(&row.bytes).finish() == checksum;
        match content::decode_page(layout, &row) {
            Ok(content) if is_whole => {
                let bounds = content::bounds_of(&grid, layout, key, &content.page);
                db.insert_page_info(&PageRow { info: PageInfo { bounds, ..row.info }, ..row }, data)?;
            }
            _ => db.insert_damaged_page_info(&row, data)?,
        }
    }
    Ok(pyramid::all_of(&grid, layout, keys))
}

/// A page of version 1, the number of its bytes, and its checksum; `None` where they are not what they must be.
fn page(db: &Database, layout: PageLayout, key: &PageKey) -> Result<Option<(PageRow, i64, Checksum)>> {
    let page = db.statement(
        "SELECT revision, codec, data, checksum, bytes FROM page_1 JOIN page_data ON page_data.id = page_1.data
         WHERE field = ?1 AND level = ?2 AND z = ?3 AND x = ?4 AND length(bytes) <= ?5",
    )
    .and_then(|mut statement| {
        let max_bytes = codec::max_size_in_bytes(layout.num_samples());
        let place = params![key.field.0, key.level, key.z, key.x, i64::try_from(max_bytes).unwrap_or(i64::MAX)];
        statement.query_row(place, |row| {
            let revision = EntryId(row.get(0)?);
            let info = PageInfo { revision, bounds: HeightBounds::of(0.0), error_m: 0.0 };
            let page = PageRow { key: *key, info, codec: row.get(1)?, bytes: row.get(4)? };
            Ok((page, row.get(2)?, row.get(3)?))
        })
    });
    match page {
        Ok(page) => Ok(Some(page)),
        // The row is not there, or is not what it must be. A file that is damaged as such is refused as a whole.
        Err(
            rusqlite::Error::QueryReturnedNoRows
            | rusqlite::Error::InvalidColumnType(..)
            | rusqlite::Error::FromSqlConversionFailure(..)
            | rusqlite::Error::IntegralValueOutOfRange(..),
        ) => Ok(None),
        Err(err) => Err(db.fault(err)),
    }
}
