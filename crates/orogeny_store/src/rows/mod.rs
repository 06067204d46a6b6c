//! Every statement of SQL that reads or writes rows, as typed functions of the [`Database`](crate::database::Database).
//!
//! Rows are checked here: what leaves these functions fits its checksum. Blobs are measured before they are read.

mod blobs;
mod document;
mod history;
mod pages;

pub(crate) use blobs::BlobRow;
pub(crate) use document::Document;
pub(crate) use history::{EntryLinks, EntryRow, LayerChange, SavedLayer};
pub(crate) use pages::{DeltaRow, PageInfo, PageRow};
