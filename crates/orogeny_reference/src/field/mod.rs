//! What is made of whole fields, a row at a time.

pub mod coarsen;
