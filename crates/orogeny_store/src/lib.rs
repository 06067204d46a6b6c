//! The durable file of a terrain: pages, layers and history, in one SQLite database.
//!
//! - **Nothing acknowledged is lost.** A [`Transaction`] is an operation: its pages, what they were before, and the
//!   operation as JSON reach the disk together before [`Transaction::commit`] returns, or not at all.
//! - **Undo goes back to the beginning**, unless a budget is set. [`Store::undo`] and [`Store::redo`] are exact to the bit, across restarts; what is undone and
//!   left behind stays in [`Store::log`].
//! - **Damage is seen and stays where it is.** Every row carries a checksum that covers its place and generation. A
//!   damaged page is refused by name; the others are not concerned. [`Store::check`] verifies everything.
//! - **Sparse.** A page that was never painted is not there: the field holds its constant. Opening takes time
//!   independent of size.
//!
//! What a page means is for the crates above: here it is a square of `f32` with a [`PageKey`](orogeny_field::PageKey).
//! The file is described in [`format`](mod@format), the coding of pages in [`codec`].
//!
//! ```
//! use orogeny_field::{Page, PageKey, PageLayout, TerrainGrid};
//! use orogeny_store::{NewLayer, NewTerrain, Store};
//!
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("example.orogeny");
//! let base = NewLayer { name: "Base".to_owned(), constant_m: 100.0 };
//! let (grid, layout) = (TerrainGrid::new(4096, 4096, 1.0)?, PageLayout::default());
//! let mut store = Store::create(&path, &NewTerrain { grid, layout, layers: vec![base] })?;
//!
//! let key = PageKey::full_resolution(store.layers()[0].heights, 3, 5);
//! let mut transaction = store.begin()?;
//! transaction.write_pages(&[(key, Page::constant(layout, 120.0))])?;
//! transaction.commit(r#"{"op": "fill"}"#, "someone")?;
//!
//! assert_eq!(store.load_page(&key)?.as_deref(), Some(&Page::constant(layout, 120.0)));
//! store.undo(1)?;
//! assert_eq!(store.load_page(&key)?, None);
//! store.close()?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod blob;
mod budget;
mod cache;
mod check;
mod checksum;
pub mod codec;
mod content;
mod database;
mod error;
pub mod format;
mod head;
mod history;
mod layer;
mod pace;
mod pyramid;
mod recorder;
mod repair;
mod rows;
mod salvage;
mod stack;
mod store;
mod substitute;
mod transaction;
mod upgrade;

pub use blob::BlobHash;
pub use budget::Dropped;
pub use cache::MAX_CACHE_BYTES;
pub use check::CheckReport;
pub use database::Counters;
pub use error::{Error, Holder, Result};
pub use history::{Change, Direction, Entry, EntryId, EntryState, HistorySummary};
pub use layer::{Field, FieldKind, Layer, MAX_LAYER_NAME_BYTES, MadeMask, MadeOf, NewLayer};
pub use pace::GivingWay;
pub use recorder::{Recorder, Recording};
pub use repair::Repaired;
pub use salvage::Salvaged;
pub use store::{NewTerrain, Store};
pub use transaction::{Committed, MAX_OPERATION_BYTES, Transaction};
