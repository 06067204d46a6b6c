//! Data from outside, in pieces, and which entries need it.

use rusqlite::{OptionalExtension as _, params};

use crate::blob::BlobHash;
use crate::checksum::{Checksum, RowHasher};
use crate::database::Database;
use crate::{EntryId, Error, Result};

/// A row of `blob`, without its checksum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct BlobRow {
    /// What pieces and entries name it by.
    pub(crate) id: i64,
    pub(crate) hash: BlobHash,
    /// Bytes of the data.
    pub(crate) size: u64,
    pub(crate) num_chunks: u32,
}

impl BlobRow {
    fn checksum(&self) -> Checksum {
        RowHasher::new("blob")
            .bytes(&self.hash.0)
            .number(self.size.cast_signed())
            .number(self.num_chunks.into())
            .finish()
    }
}

fn chunk_checksum(blob: i64, number: u32, bytes: &[u8]) -> Checksum {
    RowHasher::new("blob_chunk").number(blob).number(number.into()).bytes(bytes).finish()
}

impl Database {
    /// Makes room for data whose hash is known only when all of it has been read; until then it stands under its number.
    pub(crate) fn insert_blob(&self) -> Result<i64> {
        self.statement(
            "INSERT INTO blob (hash, size, num_chunks, checksum)
             VALUES (CAST('unfinished ' || (SELECT coalesce(max(id), 0) + 1 FROM blob) AS BLOB), 0, 0, x'')",
        )
        .and_then(|mut statement| statement.insert([]))
        .map_err(|err| self.fault(err))
    }

    pub(crate) fn finish_blob(&self, blob: &BlobRow) -> Result<()> {
        self.statement("UPDATE blob SET hash = ?2, size = ?3, num_chunks = ?4, checksum = ?5 WHERE id = ?1")
            .and_then(|mut statement| {
                let BlobRow { id, hash, size, num_chunks } = blob;
                statement.execute(params![id, hash.0, size.cast_signed(), num_chunks, blob.checksum()])
            })
            .map_err(|err| self.fault(err))?;
        Ok(())
    }

    /// Removes data that turned out to be there already.
    pub(crate) fn delete_blob(&self, id: i64) -> Result<()> {
        for sql in ["DELETE FROM blob_chunk WHERE blob = ?1", "DELETE FROM blob WHERE id = ?1"] {
            self.statement(sql)
                .and_then(|mut statement| statement.execute([id]))
                .map_err(|err| self.fault(err))?;
        }
        Ok(())
    }

    pub(crate) fn insert_blob_chunk(&self, blob: i64, number: u32, bytes: &[u8]) -> Result<()> {
        self.statement("INSERT INTO blob_chunk (blob, number, checksum, bytes) VALUES (?1, ?2, ?3, ?4)")
            .and_then(|mut statement| {
                statement.execute(params![blob, number, chunk_checksum(blob, number, bytes), bytes])
            })
            .map_err(|err| self.fault(err))?;
        Ok(())
    }

    pub(crate) fn blob(&self, hash: &BlobHash) -> Result<Option<BlobRow>> {
        let blobs = self.blobs_where("WHERE hash = ?1", params![hash.0])?;
        blobs.into_iter().next().transpose()
    }

    /// All data from outside; what fails its checksum as the error.
    pub(crate) fn blobs(&self) -> Result<Vec<Result<BlobRow>>> {
        self.blobs_where("ORDER BY id", params![])
    }

    fn blobs_where(&self, condition: &str, values: &[&dyn rusqlite::ToSql]) -> Result<Vec<Result<BlobRow>>> {
        type Row = (i64, Vec<u8>, i64, u32, Vec<u8>);
        let rows: Vec<Row> = self
            .statement(&format!("SELECT id, hash, size, num_chunks, checksum FROM blob {condition}"))
            .and_then(|mut statement| {
                let row = |row: &rusqlite::Row<'_>| {
                    Ok((row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?, row.get(4)?))
                };
                statement.query_map(values, row)?.collect()
            })
            .map_err(|err| self.fault(err))?;
        let checked = rows.into_iter().map(|(id, hash, size, num_chunks, checksum)| {
            let hash = <[u8; 32]>::try_from(hash).map(BlobHash).unwrap_or_default();
            let blob = BlobRow { id, hash, size: size.cast_unsigned(), num_chunks };
            if blob.checksum().as_slice() == checksum {
                Ok(blob)
            } else {
                Err(Error::Blob {
                    hash: hash.to_string(),
                    detail: "its record fails its checksum".to_owned(),
                })
            }
        });
        Ok(checked.collect())
    }

    /// One piece, compressed, its checksum verified.
    pub(crate) fn blob_chunk(&self, blob: &BlobRow, number: u32, max_bytes: usize) -> Result<Vec<u8>> {
        type Row = (Checksum, Option<Vec<u8>>);
        let damaged = |detail: &str| Error::Blob {
            hash: blob.hash.to_string(),
            detail: format!("piece {number} of {} {detail}", blob.num_chunks),
        };
        let row: Option<Row> = self
            .statement(
                "SELECT checksum, CASE WHEN length(bytes) <= ?3 THEN bytes END FROM blob_chunk
                 WHERE blob = ?1 AND number = ?2",
            )
            .and_then(|mut statement| {
                let place = params![blob.id, number, i64::try_from(max_bytes).unwrap_or(i64::MAX)];
                statement.query_row(place, |row| Ok((row.get(0)?, row.get(1)?))).optional()
            })
            .map_err(|err| self.fault(err))?;
        let (checksum, bytes) = row.ok_or_else(|| damaged("is missing"))?;
        let bytes = bytes.ok_or_else(|| damaged("is longer than any can be"))?;
        if chunk_checksum(blob.id, number, &bytes) == checksum {
            Ok(bytes)
        } else {
            Err(damaged("fails its checksum"))
        }
    }

    /// Notes that an entry needs data to be done again.
    pub(crate) fn insert_entry_blob(&self, entry: EntryId, blob: i64) -> Result<()> {
        self.statement("INSERT OR IGNORE INTO entry_blob (entry, blob) VALUES (?1, ?2)")
            .and_then(|mut statement| statement.execute(params![entry.0, blob]))
            .map_err(|err| self.fault(err))?;
        Ok(())
    }
}
