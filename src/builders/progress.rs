//! Progress, and what its watcher says.

use alloc::sync::Arc;
use core::fmt;
use core::sync::atomic::{AtomicU8, AtomicUsize, Ordering::Relaxed};

/// How a build goes on: what the watcher of [`Builder::progress`](crate::Builder::progress) answers. A build that was told to
/// hurry may still be told to stop, but not to be steady again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum BuildControl {
    /// As it was.
    Steady,
    /// With whatever is done: of what is not divided yet the tree is that of [`Morton`](crate::heuristic::Morton)'s curve,
    /// and optimisation ends. A valid tree, coarser by what a sorting is coarser than the heuristic.
    Hurry,
    /// Not at all: [`BuildError::Stopped`](crate::BuildError::Stopped).
    Stop,
}

/// Who is told how far a build is, from 0 to 1.
#[derive(Clone)]
pub(crate) struct ProgressCallback(pub Arc<dyn Fn(f64) -> BuildControl + Send + Sync>);

impl fmt::Debug for ProgressCallback {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("ProgressCallback")
    }
}

/// How far a build is.
pub(crate) struct Progress<'w> {
    watcher: &'w (dyn Fn(f64) -> BuildControl + Sync),
    total: AtomicUsize,
    placed: AtomicUsize,
    /// The strictest answer so far, as a number.
    pace: AtomicU8,
}

impl<'w> Progress<'w> {
    pub fn new(watcher: &'w (dyn Fn(f64) -> BuildControl + Sync)) -> Self {
        Self {
            watcher,
            total: AtomicUsize::new(1),
            placed: AtomicUsize::new(0),
            pace: AtomicU8::new(BuildControl::Steady as u8),
        }
    }

    /// There are so many references.
    pub fn begin(&self, total: usize) {
        self.total.store(total, Relaxed);
    }

    /// `count` more have found their leaves.
    pub fn place(&self, count: usize) {
        self.placed.fetch_add(count, Relaxed);
    }

    /// Tells how far the build is, and asks how it goes on.
    pub fn poll(&self) -> BuildControl {
        let pace = match self.pace() {
            BuildControl::Stop => BuildControl::Stop,
            // More references than primitives may be placed.
            _ => {
                (self.watcher)((self.placed.load(Relaxed) as f64 / self.total.load(Relaxed) as f64).min(1.0))
            }
        };
        self.pace.fetch_max(pace as u8, Relaxed);
        self.pace()
    }

    /// The strictest answer so far.
    fn pace(&self) -> BuildControl {
        match self.pace.load(Relaxed) {
            0 => BuildControl::Steady,
            1 => BuildControl::Hurry,
            _ => BuildControl::Stop,
        }
    }
}
