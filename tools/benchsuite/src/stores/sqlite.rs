//! SQLite as the terrain file uses it: write-ahead log, every commit synced, a directory of pages apart from their bytes.

use std::path::Path;

use anyhow::Result;
use rusqlite::{Connection, OptionalExtension as _, params};

use super::{Store, Write};

/// Those of `orogeny_store::format`, which says why.
const SETTINGS: &str = "
    PRAGMA page_size = 8192;
    PRAGMA foreign_keys = ON;
    PRAGMA synchronous = FULL;
    PRAGMA fullfsync = ON;
    PRAGMA checkpoint_fullfsync = ON;
    PRAGMA trusted_schema = OFF;
    PRAGMA cell_size_check = ON;
    PRAGMA cache_size = -16384;
    PRAGMA journal_size_limit = 67108864;
";

/// The tables of the terrain file that hold pages and deltas, with a single number for a page's key.
const SCHEMA: &str = "
    CREATE TABLE IF NOT EXISTS page (place INTEGER PRIMARY KEY, revision INTEGER NOT NULL, data INTEGER NOT NULL) STRICT;
    CREATE TABLE IF NOT EXISTS page_data (id INTEGER PRIMARY KEY, bytes BLOB NOT NULL) STRICT;
    CREATE TABLE IF NOT EXISTS delta (
        id INTEGER PRIMARY KEY, entry INTEGER NOT NULL, place INTEGER NOT NULL, bytes BLOB NOT NULL, UNIQUE (entry, place)
    ) STRICT;
";

struct Sqlite {
    conn: Connection,
}

pub fn open(folder: &Path) -> Result<Box<dyn Store>> {
    let conn = Connection::open(folder.join("pages.sqlite"))?;
    conn.execute_batch(SETTINGS)?;
    conn.query_row("PRAGMA journal_mode = WAL", [], |_| Ok(()))?;
    conn.execute_batch(SCHEMA)?;
    Ok(Box::new(Sqlite { conn }))
}

impl Sqlite {
    fn write(&self, entry: u32, write: &Write) -> rusqlite::Result<()> {
        let Write { place, page, delta } = write;
        let old_data: Option<i64> = self
            .conn
            .prepare_cached("SELECT data FROM page WHERE place = ?1")?
            .query_row([place], |row| row.get(0))
            .optional()?;
        let data = if let Some(data) = old_data {
            let mut update = self.conn.prepare_cached("UPDATE page_data SET bytes = ?2 WHERE id = ?1")?;
            update.execute(params![data, page])?;
            data
        } else {
            self.conn.prepare_cached("INSERT INTO page_data (bytes) VALUES (?1)")?.execute([page])?;
            self.conn.last_insert_rowid()
        };
        self.conn
            .prepare_cached(
                "INSERT INTO page (place, revision, data) VALUES (?1, ?2, ?3)
                 ON CONFLICT DO UPDATE SET revision = excluded.revision, data = excluded.data",
            )?
            .execute(params![place, entry, data])?;
        if let Some(delta) = delta {
            self.conn
                .prepare_cached("INSERT INTO delta (entry, place, bytes) VALUES (?1, ?2, ?3)")?
                .execute(params![entry, place, delta])?;
        }
        Ok(())
    }
}

impl Store for Sqlite {
    fn commit(&mut self, entry: u32, writes: &[Write]) -> Result<()> {
        self.conn.execute_batch("BEGIN IMMEDIATE")?;
        for write in writes {
            self.write(entry, write)?;
        }
        Ok(self.conn.execute_batch("COMMIT")?)
    }

    fn read(&self, place: u32) -> Result<Vec<u8>> {
        Ok(self
            .conn
            .prepare_cached(
                "SELECT bytes FROM page JOIN page_data ON page_data.id = page.data WHERE place = ?1",
            )?
            .query_row([place], |row| row.get(0))?)
    }

    fn close(self: Box<Self>) -> Result<()> {
        self.conn.query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |_| Ok(()))?;
        self.conn.close().map_err(|(_, err)| err.into())
    }
}
