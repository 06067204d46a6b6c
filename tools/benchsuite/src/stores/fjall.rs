//! fjall: a log-structured tree with the values apart from the keys, as it advises for large values; else its own defaults.

use std::path::Path;

use anyhow::{Context as _, Result};
use fjall::{Database, Keyspace, KeyspaceCreateOptions, KvSeparationOptions, PersistMode};

use super::{Store, Write};

struct Fjall {
    database: Database,
    pages: Keyspace,
    deltas: Keyspace,
}

pub fn open(folder: &Path) -> Result<Box<dyn Store>> {
    let database = Database::builder(folder.join("pages.fjall")).open()?;
    let options =
        || KeyspaceCreateOptions::default().with_kv_separation(Some(KvSeparationOptions::default()));
    let (pages, deltas) = (database.keyspace("pages", options)?, database.keyspace("deltas", options)?);
    Ok(Box::new(Fjall { database, pages, deltas }))
}

impl Store for Fjall {
    fn commit(&mut self, entry: u32, writes: &[Write]) -> Result<()> {
        let mut batch = self.database.batch().durability(Some(PersistMode::SyncAll));
        for Write { place, page, delta } in writes {
            // Keys are ordered by their bytes.
            batch.insert(&self.pages, place.to_be_bytes(), page.as_slice());
            if let Some(delta) = delta {
                let key = [entry.to_be_bytes(), place.to_be_bytes()].concat();
                batch.insert(&self.deltas, key, delta.as_slice());
            }
        }
        Ok(batch.commit()?)
    }

    fn read(&self, place: u32) -> Result<Vec<u8>> {
        Ok(self.pages.get(place.to_be_bytes())?.context("there is no such page")?.to_vec())
    }

    fn close(self: Box<Self>) -> Result<()> {
        Ok(self.database.persist(PersistMode::SyncAll)?)
    }
}
