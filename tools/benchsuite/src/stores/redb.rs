//! redb: copy-on-write trees in one file. Its own defaults, which sync each commit.

use std::path::Path;

use anyhow::{Context as _, Result};
use redb::{Database, Durability, ReadableDatabase as _, TableDefinition};

use super::{Store, Write};

const PAGES: TableDefinition<'_, u32, &[u8]> = TableDefinition::new("pages");
const DELTAS: TableDefinition<'_, (u32, u32), &[u8]> = TableDefinition::new("deltas");

struct Redb {
    database: Database,
}

pub fn open(folder: &Path) -> Result<Box<dyn Store>> {
    Ok(Box::new(Redb { database: Database::create(folder.join("pages.redb"))? }))
}

impl Store for Redb {
    fn commit(&mut self, entry: u32, writes: &[Write]) -> Result<()> {
        let mut transaction = self.database.begin_write()?;
        transaction.set_durability(Durability::Immediate)?;
        {
            let mut pages = transaction.open_table(PAGES)?;
            let mut deltas = transaction.open_table(DELTAS)?;
            for Write { place, page, delta } in writes {
                pages.insert(place, page.as_slice())?;
                if let Some(delta) = delta {
                    deltas.insert((entry, *place), delta.as_slice())?;
                }
            }
        }
        Ok(transaction.commit()?)
    }

    fn read(&self, place: u32) -> Result<Vec<u8>> {
        let pages = self.database.begin_read()?.open_table(PAGES)?;
        Ok(pages.get(place)?.context("there is no such page")?.value().to_vec())
    }

    fn close(self: Box<Self>) -> Result<()> {
        Ok(())
    }
}
