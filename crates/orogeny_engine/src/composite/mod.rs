//! The composite: what the layer stack comes to.
//!
//! It is worked out where and at the level that is looked at, by [`Compositor`], from the bottom: `rows` reads it row by row,
//! `node` is a layer as it counts, `evaluate` joins them, `content`, `live` and `weights` give what is joined, `cache` keeps what
//! took long, `pages` is where stored pages come from, and `summary` tells bounds without working anything out.
//!
//! Layers whose heights and masks are stored are joined sample by sample, whenever they are looked at. What looks around itself (an effect, a
//! mask by the ground, a Laplacian blend) is worked out in whole pages with as much around them as it looks at, and kept: it is
//! a *barrier*, and what is below it is worked out again only where something below changed.

mod cache;
mod content;
mod evaluate;
mod live;
mod node;
mod pages;
mod rows;
mod samples;
mod stale;
mod summary;
mod weights;

pub(crate) use content::{page_of, stored};
pub(crate) use evaluate::{Change, Compositor, Look, reach};
pub(crate) use live::check;
pub(crate) use node::{
    Live, MAX_GROUP_DEPTH, Node, Stored, image_of, node, nodes, painted_mask, selection, with_groups,
};
pub(crate) use pages::{FieldPages, RecorderPages, RecordingPages, StorePages};
pub(crate) use rows::{Composite, Source, damage_notice, read};
pub(crate) use summary::{summary, usual_error_m};
pub(crate) use weights::check_term;
pub(crate) use weights::gated;
