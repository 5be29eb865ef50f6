//! The builder: options, then a build.

use super::compiled::CompiledBuild;
use super::error::BuildError;
use super::facade::Bvh;
use super::job::{Job, Needs};
use super::options::{OnInvalid, Options};
use super::quality::Quality;
use super::workspace::Workspace;
use crate::builders::heuristic::Heuristic;
use crate::builders::{BuildControl, Optimise, PrimRef, ProgressCallback};
use crate::geometry::Scalar;
use crate::layout::{Layout, WideTree};
use crate::primitive::{Intersect, Primitive};
use crate::simd::{InstructionSet, prefetch_ahead};
use crate::tree::Tree;
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::marker::PhantomData;
#[cfg(feature = "std")]
use std::time::Duration;

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
    options: Options,
    result: PhantomData<fn() -> (P, L)>,
}

impl<P: Primitive, H: Clone, L> Clone for Builder<P, H, L> {
    fn clone(&self) -> Self {
        Self { heuristic: self.heuristic.clone(), options: self.options.clone(), result: PhantomData }
    }
}

impl<P: Primitive, L> Builder<P, Quality, L> {
    pub(crate) fn new() -> Self {
        Self { heuristic: Quality::default(), options: Options::default(), result: PhantomData }
    }
}

impl<P: Intersect> Bvh<P> {
    /// Builds with the good defaults: [`Quality::Balanced`], on all threads.
    ///
    /// # Errors
    /// As [`Builder::build`].
    pub fn build(primitives: impl IntoIterator<Item = P>) -> Result<Self, BuildError> {
        Self::builder().build(primitives)
    }

    /// Options, then [`build`](Builder::build).
    pub fn builder() -> Builder<P, Quality>
    where
        Quality: Heuristic<P::Scalar>,
    {
        Builder::new()
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
        Builder { heuristic: change(self.heuristic), options: self.options, result: PhantomData }
    }

    /// The same with an option set.
    fn set(mut self, set: impl FnOnce(&mut Options)) -> Self {
        set(&mut self.options);
        self
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
        self.set(|options| options.instruction_set = Some(instruction_set))
    }

    /// The largest number of primitives in a leaf of the binary tree: unless set, [`LEAF_WIDTH`](crate::LEAF_WIDTH), 8,
    /// where leaves have so many side by side, else 4; surface area heuristics make smaller ones where that pays. Any
    /// number from 1 on; above the number of primitives it means that number. A [`WideTree`] joins leaves where that is
    /// cheaper, and divides larger ones: its own hold up to `LEAF_WIDTH`, whatever is set here. Unless it is set, a
    /// [cluster](crate::heuristic::Clustered) is one leaf of the binary tree, which a wide tree makes a node of: setting it makes
    /// quicker trees of clusters, more slowly.
    #[must_use]
    pub fn max_leaf_size(self, max_leaf_size: usize) -> Self {
        self.set(|options| options.max_leaf_size = Some(max_leaf_size))
    }

    /// Builds with a pool of `threads` threads that is started for this build, 0 meaning one for each
    /// core. Unless set, the build uses rayon's pool that it is called in, which is quicker for many
    /// small builds. Without the feature `rayon` builds use the
    /// calling thread. The tree is the same in all cases.
    #[must_use]
    pub fn threads(self, threads: usize) -> Self {
        self.set(|options| options.threads = Some(threads))
    }

    /// Makes the tree better once it is built, whatever the heuristic. Unless set, it is as the heuristic says:
    /// [presets](Quality) are optimised, others are not; [`Optimise::NONE`] keeps presets from it.
    #[must_use]
    pub fn optimise(self, optimise: Optimise) -> Self {
        self.set(|options| options.optimise = Some(optimise))
    }

    /// Tells `watcher` how far the build of the tree is, from 0 to 1, every few thousand primitives at the most and from
    /// several threads, and goes on as it answers. Optimisation asks on, at 1; the layout, which follows, does not.
    ///
    /// ```
    /// use bvhkit::{Bvh, BuildError, BuildControl, Sphere};
    /// let spheres: Vec<Sphere> = (0..50_000).map(|i| Sphere::new([i as f32, 0.0, 0.0], 0.4)).collect();
    /// let cancelled = |progress| if progress > 0.5 { BuildControl::Stop } else { BuildControl::Steady };
    /// assert_eq!(Bvh::builder().progress(cancelled).build(&spheres).unwrap_err(), BuildError::Stopped);
    /// ```
    #[must_use]
    pub fn progress(self, watcher: impl Fn(f64) -> BuildControl + Send + Sync + 'static) -> Self {
        self.set(|options| options.watcher = Some(ProgressCallback(Arc::new(watcher))))
    }

    /// This long after `build` is called it hurries: see [`BuildControl::Hurry`]. A valid tree is always the result, and no less
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
        self.set(|options| options.time_budget = Some(budget))
    }

    /// What to do with invalid primitives, [`OnInvalid::Reject`] unless set.
    #[must_use]
    pub fn on_invalid(self, on_invalid: OnInvalid) -> Self {
        self.set(|options| options.on_invalid = on_invalid)
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
        let clock = self.options.clock();
        let backend = self.options.backend()?;
        let primitives = collect(primitives.into_iter())?;
        let job = Job {
            options: &self.options,
            clock,
            heuristic: &self.heuristic,
            needs: Needs { block_size: L::BLOCK_SIZE, leaf_ranges: L::LEAF_RANGES, reserve: L::RESERVE },
            count: primitives.len(),
            refer: &|first, places| {
                let mut are_valid = true;
                places.extend(primitives[first..].iter().zip(first as u32..).map(|(primitive, index)| {
                    prefetch_ahead(primitive);
                    let aabb = primitive.aabb();
                    are_valid &= aabb.is_valid();
                    PrimRef::new(aabb, index)
                }));
                are_valid
            },
        };
        let mut layout: Option<L> = None;
        let skipped = CompiledBuild::build(&job, workspace, &mut |tree, buffers| {
            layout = L::lay_out(tree, &primitives, buffers);
            if let Some(layout) = layout.as_mut().filter(|_| !buffers.keeps_rest) {
                layout.shrink();
            }
            layout.is_some()
        })?;
        let layout = layout.ok_or(BuildError::TooLarge)?;
        Ok(Bvh::from_parts(layout, backend, primitives, skipped))
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
