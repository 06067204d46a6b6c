//! Data from outside that recorded operations need to be done again: imported files, later bitmaps and custom brushes. It is
//! named by its blake3 hash, so the same data is kept once, and lies in compressed pieces, so it may be larger than memory.

use std::fmt;
use std::io::{Read, Write};

use crate::rows::BlobRow;
use crate::{Error, Result, Store, Transaction};

/// Bytes of a piece, uncompressed.
const CHUNK_BYTES: usize = 4 << 20;

/// As for pages: most files are compressed already, or compress at any level.
const ZSTD_LEVEL: i32 = 1;

/// What data from outside is named by: its blake3 hash.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct BlobHash(pub [u8; 32]);

impl BlobHash {
    /// Of data in memory.
    #[must_use]
    pub fn of(data: &[u8]) -> Self {
        Self(*blake3::hash(data).as_bytes())
    }

    /// From its hexadecimal digits, as recorded operations have them.
    #[must_use]
    pub fn from_hex(hex: &str) -> Option<Self> {
        blake3::Hash::from_hex(hex).ok().map(|hash| Self(*hash.as_bytes()))
    }
}

impl fmt::Display for BlobHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&blake3::Hash::from_bytes(self.0).to_hex())
    }
}

impl fmt::Debug for BlobHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Transaction<'_> {
    /// Keeps data from outside with the entry that is [recorded](Self::record) next, and gives its name. Data that is there
    /// already is not kept twice.
    ///
    /// # Errors
    /// [`Error::Blob`] when `data` cannot be read; after any error the transaction can only be dropped.
    pub fn keep_blob(&mut self, data: &mut dyn Read) -> Result<BlobHash> {
        self.refuse_after_failure()?;
        let result = self.write_blob(data);
        self.fail_with(result)
    }

    /// Keeps data from outside that is there already with the entry that is [recorded](Self::record) next too, and gives its size
    /// in bytes.
    ///
    /// # Errors
    /// [`Error::UnknownBlob`]; after any other error the transaction can only be dropped.
    pub fn keep_known_blob(&mut self, hash: &BlobHash) -> Result<u64> {
        self.refuse_after_failure()?;
        let db = self.database();
        let known = db.blob(hash)?.ok_or_else(|| Error::UnknownBlob { hash: hash.to_string() })?;
        let kept = db.insert_entry_blob(self.entry(), known.id).map(|()| known.size);
        self.fail_with(kept)
    }

    /// Writes data from outside, with that kept here, to `to`.
    ///
    /// # Errors
    /// As [`Store::read_blob`].
    pub fn read_blob(&self, hash: &BlobHash, to: &mut dyn Write) -> Result<()> {
        self.store().read_blob(hash, to)
    }

    fn write_blob(&self, data: &mut dyn Read) -> Result<BlobHash> {
        let db = self.database();
        let unreadable = |err: std::io::Error| Error::Blob { hash: String::new(), detail: err.to_string() };
        let id = db.insert_blob()?;
        let mut hasher = blake3::Hasher::new();
        let mut chunk = Vec::with_capacity(CHUNK_BYTES);
        let (mut size, mut num_chunks) = (0, 0);
        loop {
            chunk.clear();
            (&mut *data).take(CHUNK_BYTES as u64).read_to_end(&mut chunk).map_err(unreadable)?;
            if chunk.is_empty() {
                break;
            }
            hasher.update(&chunk);
            let bytes = zstd::bulk::compress(&chunk, ZSTD_LEVEL).map_err(unreadable)?;
            db.insert_blob_chunk(id, num_chunks, &bytes)?;
            size += chunk.len() as u64;
            num_chunks += 1;
        }
        let hash = BlobHash(*hasher.finalize().as_bytes());
        let kept = if let Some(there) = db.blob(&hash)? {
            db.delete_blob(id)?;
            there
        } else {
            let blob = BlobRow { id, hash, size, num_chunks };
            db.finish_blob(&blob)?;
            blob
        };
        db.insert_entry_blob(self.entry(), kept.id)?;
        Ok(hash)
    }
}

impl Store {
    /// Writes data from outside to `to`.
    ///
    /// # Errors
    /// [`Error::UnknownBlob`]; [`Error::Blob`] when it is damaged or `to` does not take it.
    pub fn read_blob(&self, hash: &BlobHash, to: &mut dyn Write) -> Result<()> {
        let blob = self.db.blob(hash)?.ok_or_else(|| Error::UnknownBlob { hash: hash.to_string() })?;
        self.copy_blob(&blob, to)
    }

    /// As [`Self::read_blob`], for a row at hand.
    pub(crate) fn copy_blob(&self, blob: &BlobRow, to: &mut dyn Write) -> Result<()> {
        let wrong = |detail: String| Error::Blob { hash: blob.hash.to_string(), detail };
        let mut hasher = blake3::Hasher::new();
        let mut size = 0;
        for number in 0..blob.num_chunks {
            let bytes = self.db.blob_chunk(blob, number, CHUNK_BYTES + CHUNK_BYTES / 128 + 1024)?;
            let chunk = zstd::bulk::decompress(&bytes, CHUNK_BYTES).map_err(|err| wrong(err.to_string()))?;
            hasher.update(&chunk);
            size += chunk.len() as u64;
            to.write_all(&chunk).map_err(|err| wrong(err.to_string()))?;
        }
        let hash = BlobHash(*hasher.finalize().as_bytes());
        if hash == blob.hash && size == blob.size {
            Ok(())
        } else {
            Err(wrong(format!("what is there of it has {size} bytes and the hash {hash}")))
        }
    }
}
