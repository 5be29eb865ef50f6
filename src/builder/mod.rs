//! The options of a build, and what may be wrong with its input.

mod error;
mod quality;
mod workspace;

pub use error::BuildError;
pub use quality::Quality;
pub use workspace::Workspace;

use crate::build::heuristic::Heuristic;
use crate::build::{Optimise, Pace, PrimRef, Rules, Watch, Watcher, build_tree};
use crate::bvh::Bvh;
use crate::geometry::Scalar;
use crate::layout::{Layout, WideTree};
use crate::parallel::{self, in_pool};
use crate::primitive::Primitive;
use crate::simd::{Backend, InstructionSet, prefetch_ahead};
use crate::tree::{MAX_DEPTH, Tree};
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::marker::PhantomData;
use core::sync::atomic::{AtomicBool, Ordering::Relaxed};
#[cfg(feature = "std")]
use std::time::{Duration, Instant};

/// What to do with a primitive whose box has a NaN, an infinity, or a minimum above its maximum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum OnInvalid {
    /// Fail with [`BuildError::InvalidPrimitive`], which names the first.
    #[default]
    Reject,
    /// Leave it out, so that nothing hits it, and list it in [`Bvh::skipped`]. The others keep
    /// their indices.
    Skip,
}

/// The options of a build; from [`Bvh::builder`].
///
/// ```
/// use bvhkit::heuristic::Median;
/// use bvhkit::{Bvh, OnInvalid, Quality, Sphere, Tree};
///
/// let spheres: Vec<Sphere> = (0..100).map(|i| Sphere::new([i as f32, 0.0, 0.0], 0.5)).collect();
/// let quick = Bvh::builder().quality(Quality::Fast).build(&spheres)?;
/// let simple = Bvh::builder().heuristic(Median).max_leaf_size(1).threads(1).layout::<Tree>();
/// assert_eq!(simple.build(&spheres)?.report().max_depth, 7);
///
/// let broken = [Sphere::new([0.0; 3], 1.0), Sphere::new([f32::NAN; 3], 1.0)];
/// let error = Bvh::build(&broken).unwrap_err();
/// assert_eq!(
///     error.to_string(),
///     "primitive 1 has a bounding box with a NaN: repair it, or build with OnInvalid::Skip"
/// );
/// let rest = Bvh::builder().on_invalid(OnInvalid::Skip).build(&broken)?;
/// assert_eq!((rest.len(), rest.skipped()), (1, &[1][..]));
/// # Ok::<(), bvhkit::BuildError>(())
/// ```
#[derive(Debug)]
pub struct Builder<P: Primitive, H = Quality, L = WideTree<<P as Primitive>::Scalar>> {
    heuristic: H,
    max_leaf_size: Option<usize>,
    threads: Option<usize>,
    on_invalid: OnInvalid,
    optimise: Option<Optimise>,
    watcher: Option<Watcher>,
    #[cfg(feature = "std")]
    time_budget: Option<Duration>,
    instruction_set: Option<InstructionSet>,
    result: PhantomData<fn() -> (P, L)>,
}

impl<P: Primitive, H: Clone, L> Clone for Builder<P, H, L> {
    fn clone(&self) -> Self {
        Self { heuristic: self.heuristic.clone(), watcher: self.watcher.clone(), ..*self }
    }
}

impl<P: Primitive, L> Builder<P, Quality, L> {
    pub(crate) fn new() -> Self {
        Self {
            heuristic: Quality::default(),
            max_leaf_size: None,
            threads: None,
            on_invalid: OnInvalid::default(),
            optimise: None,
            watcher: None,
            #[cfg(feature = "std")]
            time_budget: None,
            instruction_set: None,
            result: PhantomData,
        }
    }
}

impl<S: Scalar> Tree<S> {
    /// Options for a binary hierarchy over anything with a box, rays or no rays.
    ///
    /// ```
    /// use bvhkit::{Aabb, Primitive, Tree};
    ///
    /// struct Region(Aabb);
    /// impl Primitive for Region {
    ///     type Scalar = f32;
    ///     fn aabb(&self) -> Aabb {
    ///         self.0
    ///     }
    /// }
    ///
    /// let bvh = Tree::builder().build([Region(Aabb::new([0.0; 3], [1.0; 3]))])?;
    /// assert_eq!(bvh.aabb(), Aabb::new([0.0; 3], [1.0; 3]));
    /// # Ok::<(), bvhkit::BuildError>(())
    /// ```
    pub fn builder<P: Primitive<Scalar = S>>() -> Builder<P, Quality, Self> {
        Builder::new()
    }
}

impl<P: Primitive, H: Heuristic<P::Scalar>, L: Layout<P>> Builder<P, H, L> {
    /// A preset, in place of the heuristic chosen so far.
    #[must_use]
    pub fn quality(self, quality: Quality) -> Builder<P, Quality, L> {
        self.heuristic(quality)
    }

    /// One of [`heuristic`](crate::heuristic)'s, or your own, in place of the one chosen so far.
    #[must_use]
    pub fn heuristic<G: Heuristic<P::Scalar>>(self, heuristic: G) -> Builder<P, G, L> {
        self.map(|_| heuristic)
    }

    /// The same with another heuristic or another layout.
    fn map<G, M>(self, change: impl FnOnce(H) -> G) -> Builder<P, G, M> {
        Builder {
            heuristic: change(self.heuristic),
            max_leaf_size: self.max_leaf_size,
            threads: self.threads,
            on_invalid: self.on_invalid,
            optimise: self.optimise,
            watcher: self.watcher,
            #[cfg(feature = "std")]
            time_budget: self.time_budget,
            instruction_set: self.instruction_set,
            result: PhantomData,
        }
    }

    /// How the hierarchy lies in memory, in place of the [`WideTree`] of 16: another [`Layout`].
    ///
    /// ```
    /// use bvhkit::{Bvh, Sphere, Tree};
    /// let spheres = [Sphere::new([0.0; 3], 1.0), Sphere::new([5.0, 0.0, 0.0], 1.0)];
    /// let bvh: Bvh<Sphere, Tree> = Bvh::builder().layout::<Tree>().max_leaf_size(1).build(spheres)?;
    /// assert_eq!(bvh.report().inner_nodes, 1);
    /// # Ok::<(), bvhkit::BuildError>(())
    /// ```
    #[must_use]
    pub fn layout<M: Layout<P>>(self) -> Builder<P, H, M> {
        self.map(|heuristic| heuristic)
    }

    /// What queries are computed with, [`InstructionSet::best`] unless set: to compare and to test.
    #[must_use]
    pub fn instruction_set(self, instruction_set: InstructionSet) -> Self {
        Self { instruction_set: Some(instruction_set), ..self }
    }

    /// The largest number of primitives in a leaf of the binary tree: unless set, [`LEAF_WIDTH`](crate::LEAF_WIDTH), 8,
    /// where leaves have so many side by side, else 4; surface area heuristics make smaller ones where that pays. Any
    /// number from 1 on; above the number of primitives it means that number. A [`WideTree`] joins leaves where that is
    /// cheaper, and divides larger ones: its own hold up to `LEAF_WIDTH`, whatever is set here. Unless it is set, a
    /// [cluster](crate::heuristic::Clustered) is one leaf of the binary tree, which a wide tree makes a node of: setting it makes
    /// quicker trees of clusters, more slowly.
    #[must_use]
    pub fn max_leaf_size(self, max_leaf_size: usize) -> Self {
        Self { max_leaf_size: Some(max_leaf_size), ..self }
    }

    /// Builds with a pool of `threads` threads that is started for this build, 0 meaning one for each
    /// core. Unless set, the build uses rayon's pool that it is called in, which is quicker for many
    /// small builds. Without the feature `rayon` builds use the
    /// calling thread. The tree is the same in all cases.
    #[must_use]
    pub fn threads(self, threads: usize) -> Self {
        Self { threads: Some(threads), ..self }
    }

    /// Makes the tree better once it is built, whatever the heuristic. Unless set, it is as the heuristic says:
    /// [presets](Quality) are optimised, others are not; [`Optimise::NONE`] keeps presets from it.
    #[must_use]
    pub fn optimise(self, optimise: Optimise) -> Self {
        Self { optimise: Some(optimise), ..self }
    }

    /// Tells `watcher` how far the build of the tree is, from 0 to 1, every few thousand primitives at the most and from
    /// several threads, and goes on as it answers. Optimisation asks on, at 1; the layout, which follows, does not.
    ///
    /// ```
    /// use bvhkit::{Bvh, BuildError, Pace, Sphere};
    /// let spheres: Vec<Sphere> = (0..50_000).map(|i| Sphere::new([i as f32, 0.0, 0.0], 0.4)).collect();
    /// let cancelled = |progress| if progress > 0.5 { Pace::Stop } else { Pace::Steady };
    /// assert_eq!(Bvh::builder().watch(cancelled).build(&spheres).unwrap_err(), BuildError::Stopped);
    /// ```
    #[must_use]
    pub fn watch(self, watcher: impl Fn(f64) -> Pace + Send + Sync + 'static) -> Self {
        Self { watcher: Some(Watcher(Arc::new(watcher))), ..self }
    }

    /// This long after `build` is called it hurries: see [`Pace::Hurry`]. A valid tree is always the result, and no less
    /// time is taken for it than a build with [`Quality::Fast`] takes without its optimisation.
    ///
    /// ```
    /// use bvhkit::{Bvh, Ray, Sphere};
    /// use std::time::Duration;
    /// let spheres: Vec<Sphere> = (0..50_000).map(|i| Sphere::new([i as f32, 0.0, 0.0], 0.4)).collect();
    /// let bvh = Bvh::builder().time_budget(Duration::ZERO).build(&spheres)?;
    /// assert_eq!(bvh.closest_hit(&Ray::new([7.0, -1.0, 0.0], [0.0, 1.0, 0.0])).unwrap().index, 7);
    /// # Ok::<(), bvhkit::BuildError>(())
    /// ```
    #[cfg(feature = "std")]
    #[must_use]
    pub fn time_budget(self, budget: Duration) -> Self {
        Self { time_budget: Some(budget), ..self }
    }

    /// What to do with invalid primitives, [`OnInvalid::Reject`] unless set.
    #[must_use]
    pub fn on_invalid(self, on_invalid: OnInvalid) -> Self {
        Self { on_invalid, ..self }
    }

    /// Builds the hierarchy over a list, an array, `&mesh`, any iterator of primitives, or
    /// references to them. O(n log n) for the heuristics of this crate but
    /// [`SweepSah`](crate::heuristic::SweepSah), at most [`MAX_DEPTH`](crate::MAX_DEPTH) times O(n)
    /// plus what the heuristic itself takes for any.
    ///
    /// No input at all gives an empty hierarchy, which nothing hits.
    ///
    /// # Errors
    /// [`BuildError`], whose messages say what is wrong, where, and what to do.
    pub fn build(self, primitives: impl IntoIterator<Item = P>) -> Result<Bvh<P, L>, BuildError> {
        self.build_in(&mut Workspace::for_one_build(), primitives)
    }

    /// The same hierarchy as [`build`](Self::build) makes, in memory that earlier builds have left behind: see [`Workspace`]. What it
    /// lies in comes back by [`Bvh::recycle`].
    ///
    /// # Errors
    /// As [`build`](Self::build).
    pub fn build_in(
        self,
        workspace: &mut Workspace<P::Scalar>,
        primitives: impl IntoIterator<Item = P>,
    ) -> Result<Bvh<P, L>, BuildError> {
        if self.max_leaf_size == Some(0) {
            return Err(BuildError::ZeroLeafSize);
        }
        let backend = match self.instruction_set {
            Some(set) => Backend::of(set).ok_or(BuildError::NoInstructionSet(set))?,
            None => Backend::best(),
        };
        let pace = self.pace();
        let primitives = collect(primitives.into_iter())?;
        let (layout, skipped) =
            in_pool(self.threads, primitives.len(), || self.lay_out(&primitives, &pace, workspace))
                .map_err(BuildError::ThreadPool)??;
        drop(pace);
        Ok(Bvh::from_parts(layout, backend, primitives, skipped))
    }

    /// The layout, and the indices of skipped primitives.
    fn lay_out(
        &self,
        primitives: &[P],
        pace: &(dyn Fn(f64) -> Pace + Sync),
        workspace: &mut Workspace<P::Scalar>,
    ) -> Result<(L, Vec<u32>), BuildError> {
        self.make_room(primitives.len(), workspace);
        let skipped = self.refer(primitives, &mut workspace.build.references)?;
        let block_size = L::BLOCK_SIZE;
        let rules = Rules {
            heuristic: &self.heuristic,
            max_leaf_size: self.max_leaf_size.unwrap_or(block_size.max(4)),
            max_runs: if self.max_leaf_size.is_none() { L::RUNS } else { 1 },
            block_size,
            max_depth: MAX_DEPTH,
        };
        let watch = Watch::new(pace);
        let mut tree = build_tree(&mut workspace.build, &rules, &watch).ok_or(BuildError::Stopped)?;
        workspace.hand_over();
        let optimise = self.optimise.or_else(|| self.heuristic.optimise());
        if let Some(optimise) = optimise.filter(|optimise| optimise.rounds > 0) {
            optimise.run(&mut tree, workspace.layout.words(), || watch.ask() == Pace::Steady);
        }
        if watch.ask() == Pace::Stop {
            return Err(BuildError::Stopped);
        }
        let layout = L::lay_out(&mut tree, primitives, &mut workspace.layout);
        workspace.build.reclaim(tree);
        let mut layout = layout.ok_or(BuildError::TooLarge)?;
        if !workspace.layout.keeps_rest {
            layout.shrink();
        }
        Ok((layout, skipped))
    }

    /// For references, what the heuristic wants beside them, and what is made of them.
    fn make_room(&self, count: usize, workspace: &mut Workspace<P::Scalar>) {
        let size = size_of::<PrimRef<P::Scalar>>();
        let beside = if self.heuristic.cluster_size() > 1 {
            // Two lists of keys.
            count.saturating_mul(2 * size_of::<u64>())
        } else {
            // A heuristic that asks for very much gets it when it splits.
            size.saturating_mul(self.heuristic.spare(count)).min(size.saturating_mul(count))
        };
        // Where addresses are short, memory for later may be more than there is.
        let later = if size_of::<usize>() >= 8 { L::RESERVE } else { 0 };
        workspace.make_room(size.saturating_mul(count).saturating_add(beside), later.saturating_mul(count));
    }

    /// What the watcher says, and the clock.
    fn pace(&self) -> impl Fn(f64) -> Pace + Sync + '_ {
        #[cfg(feature = "std")]
        let deadline = self.time_budget.and_then(|budget| Instant::now().checked_add(budget));
        move |progress| {
            let pace = self.watcher.as_ref().map_or(Pace::Steady, |Watcher(watcher)| watcher(progress));
            #[cfg(feature = "std")]
            if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                return pace.max(Pace::Hurry);
            }
            pace
        }
    }

    /// Makes references to the valid primitives; the indices of the others.
    fn refer(
        &self,
        primitives: &[P],
        references: &mut Vec<PrimRef<P::Scalar>>,
    ) -> Result<Vec<u32>, BuildError> {
        let is_flawed = AtomicBool::new(false);
        parallel::collect(primitives, references, |index, primitive| {
            prefetch_ahead(primitive);
            let reference = PrimRef::new(primitive.aabb(), index as u32);
            if reference.flaw().is_some() {
                is_flawed.store(true, Relaxed);
            }
            reference
        });
        let mut skipped = Vec::new();
        if is_flawed.into_inner() {
            let flaws = references.iter().filter_map(|reference| Some((reference.index, reference.flaw()?)));
            match self.on_invalid {
                OnInvalid::Skip => skipped = flaws.map(|(index, _)| index).collect(),
                OnInvalid::Reject => {
                    if let Some((index, flaw)) = flaws.min_by_key(|&(index, _)| index) {
                        return Err(BuildError::InvalidPrimitive { index: index as usize, flaw });
                    }
                }
            }
            references.retain(|reference| reference.flaw().is_none());
        }
        Ok(skipped)
    }
}

/// At most 2^32 - 1 items of an iterator.
fn collect<P>(primitives: impl Iterator<Item = P>) -> Result<Vec<P>, BuildError> {
    let limit = u32::MAX as usize;
    let check = |count| if count > limit { Err(BuildError::TooManyPrimitives { count }) } else { Ok(()) };
    check(primitives.size_hint().0)?;
    let collected: Vec<P> = primitives.take(limit.saturating_add(1)).collect();
    check(collected.len())?;
    Ok(collected)
}
