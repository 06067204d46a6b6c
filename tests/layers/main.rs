//! The layer stack: what it comes to, against whole planes worked out plainly; what must be the same whichever way it comes about; caches
//! that hold nothing stale after whatever is done; a history that leads back exactly; kept effects that know when they are stale.

#![cfg(test)]

mod back_ends;
mod budget;
mod collapse;
mod failing;
mod gates;
mod history;
mod incremental;
mod kinds;
mod plain;
mod properties;
mod random;
mod rich;
mod stacks;
mod stale;
mod support;
