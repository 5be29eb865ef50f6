//! The progress of a build, and the answers of the progress callback.

use alloc::sync::Arc;
use core::fmt;
use core::sync::atomic::{AtomicU8, AtomicUsize, Ordering::Relaxed};

/// How a build continues: the answer of a progress callback.
///
/// See [`Builder::progress`](crate::Builder::progress). After `Hurry` the callback may still answer
/// `Stop`, but a later `Steady` has no effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum BuildControl {
    /// Continue as before.
    Steady,
    /// Finish quickly, with a coarser tree.
    ///
    /// Subtrees that are not begun yet follow the curve of [`Morton`](crate::heuristic::Morton),
    /// and optimisation ends. The tree is valid. These subtrees are coarser than those of the
    /// heuristic, as sorting along a curve is coarser than its splits.
    Hurry,
    /// Stop: the build fails with [`BuildError::Stopped`](crate::BuildError::Stopped).
    Stop,
}

/// The progress callback, which is called with the progress, from 0 to 1.
#[derive(Clone)]
pub(crate) struct ProgressCallback(pub Arc<dyn Fn(f64) -> BuildControl + Send + Sync>);

impl fmt::Debug for ProgressCallback {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("ProgressCallback")
    }
}

/// The progress of a build.
pub(crate) struct Progress<'w> {
    callback: &'w (dyn Fn(f64) -> BuildControl + Sync),
    total: AtomicUsize,
    placed: AtomicUsize,
    /// The strictest answer so far, as a number.
    control: AtomicU8,
}

impl<'w> Progress<'w> {
    pub fn new(callback: &'w (dyn Fn(f64) -> BuildControl + Sync)) -> Self {
        Self {
            callback,
            total: AtomicUsize::new(1),
            placed: AtomicUsize::new(0),
            control: AtomicU8::new(BuildControl::Steady as u8),
        }
    }

    /// Sets the number of references of the build.
    pub fn begin(&self, total: usize) {
        self.total.store(total, Relaxed);
    }

    /// Adds `count` references that have reached their leaves.
    pub fn place(&self, count: usize) {
        self.placed.fetch_add(count, Relaxed);
    }

    /// Calls the progress callback, and returns the strictest answer so far.
    pub fn poll(&self) -> BuildControl {
        let control = match self.control() {
            BuildControl::Stop => BuildControl::Stop,
            // With extra references, more may be placed than there are primitives.
            _ => {
                (self.callback)((self.placed.load(Relaxed) as f64 / self.total.load(Relaxed) as f64).min(1.0))
            }
        };
        self.control.fetch_max(control as u8, Relaxed);
        self.control()
    }

    /// Returns the strictest answer so far.
    fn control(&self) -> BuildControl {
        match self.control.load(Relaxed) {
            0 => BuildControl::Steady,
            1 => BuildControl::Hurry,
            _ => BuildControl::Stop,
        }
    }
}
