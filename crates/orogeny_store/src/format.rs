//! Everything that is fixed on disk: magic, version, table and column names, connection settings.
//!
//! A terrain is one SQLite database, so that any tool can open it. A checksum covers
//! every row together with its place: the first 16 bytes of blake3 over the table's name and the row's columns.
//!
//! | table | one row is |
//! | --- | --- |
//! | `document` | the terrain: grid, page size, the number of commits, the entry that the history stands at, the last ids given out, what the history takes and may take |
//! | `field` | a sampled plane, what it holds and the value of its absent pages |
//! | `layer` | a layer of the stack as it is now, as JSON |
//! | `page` | the directory: which pages of which level exist, which entry wrote each, its lowest and highest height, how far a coarse one is from full resolution, its checksum and where its bytes are |
//! | `page_data` | the compressed bytes of a page |
//! | `entry` | an operation of the history; a tree, `next` is the child that redo goes to |
//! | `delta` | what an entry did to a page: after minus before |
//! | `layer_change` | what an entry did to a layer: its JSON before and after, NULL where it did not exist |
//! | `blob`, `blob_chunk` | data from outside, named by its blake3 hash, in compressed pieces |
//! | `entry_blob` | which entry needs which data to be done again |
//!
//! Entry 0 is where undoing ends: the terrain as it was made, or as the oldest entry that was dropped left it. A page's
//! `revision` is the entry whose state it holds, so a page that a lost write left behind does not fit its place in the
//! history. Pages above level 0 are made of those below and are in no delta.
//!
//! `docs/file-format.md` describes all of it for other programs.

/// `OROG`: bytes 68..72 of the file.
pub const APPLICATION_ID: i32 = 0x4f52_4f47;

/// The schema below, bytes 60..64 of the file. Files of a newer one are refused.
pub const FORMAT_VERSION: i32 = 4;

/// How terrain files are called: `NAME.orogeny`.
pub const FILE_EXTENSION: &str = "orogeny";

/// Files that belong to an open terrain, by what is added to its name: the log of SQLite, its index, the journal that
/// stands in for them while a terrain is made, and the record of the last commit.
pub(crate) const COMPANION_SUFFIXES: [&str; 4] = ["-wal", "-shm", "-journal", HEAD_SUFFIX];

/// What is added to a terrain's name for the record of its last commit, which also tells who has it open for writing.
pub(crate) const HEAD_SUFFIX: &str = "-head";

/// How long to wait for another process that writes.
pub(crate) const BUSY_TIMEOUT: std::time::Duration = std::time::Duration::from_secs(5);

/// Settings that must come before the first table. Pages of the database, not of the terrain: compressed terrain pages
/// are 10 to 60 kB, for which SQLite's own measurements favour 8 or 16 KiB.
pub(crate) const NEW_FILE_SETTINGS: &str = "PRAGMA page_size = 8192;";

/// Settings of every connection. `fullfsync` matters on macOS only, where a plain fsync does not reach the disk.
pub(crate) const CONNECTION_SETTINGS: &str = "
    PRAGMA foreign_keys = ON;
    PRAGMA synchronous = FULL;
    PRAGMA fullfsync = ON;
    PRAGMA checkpoint_fullfsync = ON;
    PRAGMA trusted_schema = OFF;
    PRAGMA cell_size_check = ON;
    PRAGMA cache_size = -16384;
    PRAGMA journal_size_limit = 67108864;
";

/// The tables of versions 3 and 4.
pub(crate) const SCHEMA: &str = "
    CREATE TABLE document (
        id         INTEGER PRIMARY KEY CHECK (id = 1),
        width      INTEGER NOT NULL,
        depth      INTEGER NOT NULL,
        spacing_m  REAL NOT NULL,
        page_size  INTEGER NOT NULL,
        sequence   INTEGER NOT NULL,
        head       INTEGER NOT NULL REFERENCES entry (id) DEFERRABLE INITIALLY DEFERRED,
        last_entry INTEGER NOT NULL,
        last_layer INTEGER NOT NULL,
        last_field INTEGER NOT NULL,
        floor      INTEGER NOT NULL,
        history_bytes  INTEGER NOT NULL,
        history_budget INTEGER,
        checksum   BLOB NOT NULL
    ) STRICT;

    CREATE TABLE field (
        id       INTEGER PRIMARY KEY,
        kind     TEXT NOT NULL,
        constant REAL NOT NULL,
        checksum BLOB NOT NULL
    ) STRICT;

    CREATE TABLE layer (
        id       INTEGER PRIMARY KEY,
        state    TEXT NOT NULL,
        checksum BLOB NOT NULL
    ) STRICT;

    CREATE TABLE page (
        field    INTEGER NOT NULL REFERENCES field (id),
        level    INTEGER NOT NULL,
        z        INTEGER NOT NULL,
        x        INTEGER NOT NULL,
        revision INTEGER NOT NULL,
        min_m    REAL NOT NULL,
        max_m    REAL NOT NULL,
        codec    INTEGER NOT NULL,
        data     INTEGER NOT NULL,
        checksum BLOB NOT NULL,
        error_m  REAL NOT NULL DEFAULT 0,
        PRIMARY KEY (field, level, z, x)
    ) STRICT, WITHOUT ROWID;

    CREATE TABLE page_data (
        id    INTEGER PRIMARY KEY,
        bytes BLOB NOT NULL
    ) STRICT;

    CREATE TABLE entry (
        id           INTEGER PRIMARY KEY,
        parent       INTEGER REFERENCES entry (id),
        next         INTEGER REFERENCES entry (id) DEFERRABLE INITIALLY DEFERRED,
        operation    TEXT NOT NULL,
        author       TEXT NOT NULL,
        time_unix_ms INTEGER NOT NULL,
        num_pages    INTEGER NOT NULL,
        delta_bytes  INTEGER NOT NULL,
        checksum     BLOB NOT NULL
    ) STRICT;

    CREATE INDEX entry_parent ON entry (parent);
    CREATE INDEX entry_next ON entry (next);

    CREATE TABLE delta (
        id              INTEGER PRIMARY KEY,
        entry           INTEGER NOT NULL REFERENCES entry (id) DEFERRABLE INITIALLY DEFERRED,
        field           INTEGER NOT NULL REFERENCES field (id),
        level           INTEGER NOT NULL,
        z               INTEGER NOT NULL,
        x               INTEGER NOT NULL,
        revision_before INTEGER,
        codec           INTEGER NOT NULL,
        checksum        BLOB NOT NULL,
        bytes           BLOB NOT NULL,
        UNIQUE (entry, field, level, z, x)
    ) STRICT;

    CREATE TABLE layer_change (
        entry    INTEGER NOT NULL REFERENCES entry (id) DEFERRABLE INITIALLY DEFERRED,
        layer    INTEGER NOT NULL,
        before   TEXT,
        after    TEXT,
        checksum BLOB NOT NULL,
        PRIMARY KEY (entry, layer)
    ) STRICT, WITHOUT ROWID;

    CREATE TABLE blob (
        id         INTEGER PRIMARY KEY,
        hash       BLOB NOT NULL UNIQUE,
        size       INTEGER NOT NULL,
        num_chunks INTEGER NOT NULL,
        checksum   BLOB NOT NULL
    ) STRICT;

    CREATE TABLE blob_chunk (
        id       INTEGER PRIMARY KEY,
        blob     INTEGER NOT NULL REFERENCES blob (id),
        number   INTEGER NOT NULL,
        checksum BLOB NOT NULL,
        bytes    BLOB NOT NULL,
        UNIQUE (blob, number)
    ) STRICT;

    CREATE TABLE entry_blob (
        entry INTEGER NOT NULL REFERENCES entry (id) DEFERRABLE INITIALLY DEFERRED,
        blob  INTEGER NOT NULL REFERENCES blob (id),
        PRIMARY KEY (entry, blob)
    ) STRICT, WITHOUT ROWID;

    CREATE INDEX entry_blob_blob ON entry_blob (blob);
";

/// Tables of a connection that reads the terrain as of another entry than the one that the history stands at. By their names they hide
/// the file's, so every statement means them; they are the connection's own, and go with its transaction. The bytes of pages that are
/// as in the file stay there: `page_data` holds those of the others, under numbers that the file does not use.
pub(crate) const PAST_TABLES: &str = "
    CREATE TEMP TABLE document AS SELECT * FROM main.document;
    CREATE UNIQUE INDEX temp.past_document ON document (id);

    CREATE TEMP TABLE layer AS SELECT * FROM main.layer;
    CREATE UNIQUE INDEX temp.past_layer ON layer (id);

    CREATE TEMP TABLE page AS SELECT * FROM main.page;
    CREATE UNIQUE INDEX temp.past_page ON page (field, level, z, x);

    CREATE TEMP TABLE page_data (id INTEGER PRIMARY KEY, bytes BLOB NOT NULL);
    INSERT INTO temp.page_data (id, bytes) SELECT coalesce(max(id), 0) + 1, x'' FROM main.page_data;
";
