//! What happens to a terrain file when processes are killed, disks fill up or fail, the power goes, folders cannot be
//! written and others write.
//!
//! Each test that needs another process starts this binary again, in the role that an environment variable names.

#![cfg(test)]
#![cfg(unix)]

mod disk_full;
mod kill;
mod lock;
mod permissions;
mod support;

// Faults at the level of system calls, by strace.
#[cfg(target_os = "linux")]
mod disk;
#[cfg(target_os = "linux")]
mod inject;
#[cfg(target_os = "linux")]
mod lost_write;
#[cfg(target_os = "linux")]
mod power_loss;
#[cfg(target_os = "linux")]
mod recording;
#[cfg(target_os = "linux")]
mod script;
#[cfg(target_os = "linux")]
mod strace_call;
#[cfg(target_os = "linux")]
mod strace_log;
#[cfg(target_os = "linux")]
mod trace;
