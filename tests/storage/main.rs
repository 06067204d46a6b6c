//! What happens to a terrain file when processes are killed, disks fill up, folders cannot be written and others write.
//!
//! Each test that needs another process starts this binary again, in the role that an environment variable names.

#![cfg(test)]
#![cfg(unix)]

mod disk_full;
mod kill;
mod lock;
mod permissions;
mod support;
