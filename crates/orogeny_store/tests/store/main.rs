//! The store as its users see it: opening, operations, history, damage, and a model that it is compared with.
//! What needs a process of its own (kills, locks, permissions, full disks) is in the workspace's `tests/storage`.

#![cfg(test)]

mod blobs;
mod budget;
mod damage;
mod history;
mod levels;
mod model;
mod opening;
mod operations;
mod readers;
mod recorder;
mod repair;
mod support;
mod taken_back;
mod upgrade;
