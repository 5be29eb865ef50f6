//! The build itself, independent of the types of primitive, heuristic and layout.

use super::error::BuildError;
use super::options::{Clock, OnInvalid, Options};
use super::workspace::Workspace;
use crate::builders::heuristic::Heuristic;
use crate::builders::{BuildControl, PrimRef, Progress, ProgressCallback, Rules, build_tree};
use crate::geometry::Scalar;
use crate::layout::Buffers;
use crate::parallel::{PART, Places, concat, in_pool};
use crate::tree::MAX_DEPTH;
use crate::tree::Tree;
use alloc::vec::Vec;
use core::sync::atomic::{AtomicBool, Ordering::Relaxed};
#[cfg(feature = "std")]
use std::time::Instant;

/// The requirements of a layout.
pub struct Needs {
    /// The number of primitives that a leaf tests at once.
    pub block_size: usize,
    /// The number of leaves into which the layout divides a large leaf of the tree.
    pub leaf_ranges: usize,
    /// The number of bytes reserved for each primitive.
    pub reserve: usize,
}

/// A build: its options and its input.
pub struct Job<'j, S: Scalar> {
    pub options: &'j Options,
    pub clock: Clock,
    pub heuristic: &'j dyn Heuristic<S>,
    pub needs: Needs,
    /// The number of primitives.
    pub count: usize,
    /// Writes references to primitives; returns whether all of them are valid.
    ///
    /// The first argument is the index of the first primitive. Each place takes one reference.
    pub refer: &'j Refer<'j, S>,
}

/// Lays out a finished tree.
///
/// Returns `false` if the tree is too large for the layout.
pub type LayOut<'l, S> = &'l mut (dyn FnMut(&mut Tree<S>, &mut Buffers) -> bool + Send);

/// The type of [`Job::refer`].
pub type Refer<'j, S> = dyn Fn(usize, &mut Places<'_, PrimRef<S>>) -> bool + Sync + 'j;

impl<S: Scalar> Job<'_, S> {
    /// Builds the tree and lays it out, on the threads asked for.
    ///
    /// Returns the indices of skipped primitives.
    pub fn run(&self, workspace: &mut Workspace<S>, lay_out: LayOut<'_, S>) -> Result<Vec<u32>, BuildError> {
        let mut done = Ok(Vec::new());
        in_pool(self.options.threads, self.count, &mut || done = self.steps(workspace, lay_out))
            .map_err(BuildError::ThreadPool)?;
        done
    }

    fn steps(&self, workspace: &mut Workspace<S>, lay_out: LayOut<'_, S>) -> Result<Vec<u32>, BuildError> {
        self.make_room(workspace);
        let skipped = self.refer(&mut workspace.build.references)?;
        let Self { options, heuristic, needs, .. } = self;
        let rules = Rules {
            heuristic: *heuristic,
            max_leaf_size: options.max_leaf_size.unwrap_or(needs.block_size.max(4)),
            max_leaf_ranges: if options.max_leaf_size.is_none() { needs.leaf_ranges } else { 1 },
            block_size: needs.block_size,
            max_depth: MAX_DEPTH,
        };
        let control = |progress| self.control(progress);
        let progress = Progress::new(&control);
        let mut tree = build_tree(&mut workspace.build, &rules, &progress).ok_or(BuildError::Stopped)?;
        workspace.hand_over();
        let optimise = options.optimise.or_else(|| heuristic.optimise());
        if let Some(optimise) = optimise.filter(|optimise| optimise.rounds > 0) {
            optimise.run(&mut tree, workspace.layout.words(), &|| progress.poll() == BuildControl::Steady);
        }
        if progress.poll() == BuildControl::Stop {
            return Err(BuildError::Stopped);
        }
        let is_laid_out = lay_out(&mut tree, &mut workspace.layout);
        workspace.build.reclaim(tree);
        if is_laid_out { Ok(skipped) } else { Err(BuildError::TooLarge) }
    }

    /// Makes room for references, the heuristic's additional data, and the layout.
    fn make_room(&self, workspace: &mut Workspace<S>) {
        let (count, size) = (self.count, size_of::<PrimRef<S>>());
        let beside = if self.heuristic.cluster_size() > 1 {
            // Two lists of keys.
            count.saturating_mul(2 * size_of::<u64>())
        } else {
            // No more than the primitives: a heuristic that asks for more gets it when it splits.
            size.saturating_mul(self.heuristic.extra_references(count)).min(size.saturating_mul(count))
        };
        // Where addresses are short, the reserve for the layout may be more memory than there is.
        let later = if size_of::<usize>() >= 8 { self.needs.reserve } else { 0 };
        workspace.make_room(size.saturating_mul(count).saturating_add(beside), later.saturating_mul(count));
    }

    /// Makes references to the valid primitives; returns the indices of skipped ones.
    fn refer(&self, references: &mut Vec<PrimRef<S>>) -> Result<Vec<u32>, BuildError> {
        let is_flawed = AtomicBool::new(false);
        let firsts = (0..self.count).step_by(PART);
        let lens: Vec<_> = firsts.map(|first| PART.min(self.count - first)).collect();
        *references = concat(core::mem::take(references), &lens, &|part, places| {
            if !(self.refer)(part * PART, places) {
                is_flawed.store(true, Relaxed);
            }
        });
        let mut skipped = Vec::new();
        if is_flawed.into_inner() {
            let reasons =
                references.iter().filter_map(|reference| Some((reference.index, reference.invalid_box()?)));
            match self.options.on_invalid {
                OnInvalid::Skip => skipped = reasons.map(|(index, _)| index).collect(),
                OnInvalid::Reject => {
                    if let Some((index, reason)) = reasons.min_by_key(|&(index, _)| index) {
                        return Err(BuildError::InvalidPrimitive { index: index as usize, reason });
                    }
                }
            }
            references.retain(|reference| reference.invalid_box().is_none());
        }
        Ok(skipped)
    }

    /// Returns the stricter answer of the progress callback and the clock.
    fn control(&self, progress: f64) -> BuildControl {
        let callback = self.options.callback.as_ref();
        let control = callback.map_or(BuildControl::Steady, |ProgressCallback(callback)| callback(progress));
        #[cfg(feature = "std")]
        if self.clock.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            return control.max(BuildControl::Hurry);
        }
        control
    }
}
