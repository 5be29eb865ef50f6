//! The builder: it collects the options of a build, and runs the build.

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

/// The options of a build, made by [`Bvh::builder`].
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
    /// Builds a hierarchy with good defaults: [`Quality::Balanced`], on all threads.
    ///
    /// # Errors
    /// The errors of [`Builder::build`].
    pub fn build(primitives: impl IntoIterator<Item = P>) -> Result<Self, BuildError> {
        Self::builder().build(primitives)
    }

    /// Returns a builder, whose [`build`](Builder::build) makes the hierarchy.
    pub fn builder() -> Builder<P, Quality>
    where
        Quality: Heuristic<P::Scalar>,
    {
        Builder::new()
    }
}

impl<S: Scalar> Tree<S> {
    /// Returns a builder of binary hierarchies over any primitives.
    ///
    /// A primitive needs a box, but no ray test.
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
    /// Sets a preset, in place of the heuristic chosen so far.
    #[must_use]
    pub fn quality(self, quality: Quality) -> Builder<P, Quality, L> {
        self.heuristic(quality)
    }

    /// Sets one of the heuristics in [`heuristic`](crate::heuristic), or your own.
    ///
    /// It replaces the heuristic chosen so far.
    #[must_use]
    pub fn heuristic<G: Heuristic<P::Scalar>>(self, heuristic: G) -> Builder<P, G, L> {
        self.map(|_| heuristic)
    }

    /// Returns the same options with another heuristic or another layout.
    fn map<G, M>(self, change: impl FnOnce(H) -> G) -> Builder<P, G, M> {
        Builder { heuristic: change(self.heuristic), options: self.options, result: PhantomData }
    }

    /// Returns the same options with one of them set.
    fn set(mut self, set: impl FnOnce(&mut Options)) -> Self {
        set(&mut self.options);
        self
    }

    /// Sets the [`Layout`] of the hierarchy in memory.
    ///
    /// The default is the [`WideTree`] with up to 16 children per node.
    ///
    /// ```
    /// use bvhkit::{Bvh, Sphere, Tree};
    /// let spheres = [Sphere::new([0.0; 3], 1.0), Sphere::new([5.0, 0.0, 0.0], 1.0)];
    /// let bvh: Bvh<Sphere, Tree> =
    ///     Bvh::builder().layout::<Tree>().max_leaf_size(1).build(spheres)?;
    /// assert_eq!(bvh.report().inner_nodes, 1);
    /// # Ok::<(), bvhkit::BuildError>(())
    /// ```
    #[must_use]
    pub fn layout<M: Layout<P>>(self) -> Builder<P, H, M> {
        self.map(|heuristic| heuristic)
    }

    /// Sets the instruction set of queries, to compare and to test.
    ///
    /// The default is [`InstructionSet::best`].
    #[must_use]
    pub fn instruction_set(self, instruction_set: InstructionSet) -> Self {
        self.set(|options| options.instruction_set = Some(instruction_set))
    }

    /// Sets the maximum number of primitives in a leaf of the binary tree.
    ///
    /// Any number from 1 on is valid; the number of primitives is the largest with an effect.
    /// Surface area heuristics make smaller leaves where that pays. The default is
    /// [`LEAF_WIDTH`](crate::LEAF_WIDTH), 8, if the leaves of the layout hold so many
    /// primitives side by side, else 4.
    ///
    /// A [`WideTree`] joins leaves where that is cheaper, and divides larger ones. Its own leaves
    /// hold up to `LEAF_WIDTH` primitives, whatever is set here.
    ///
    /// By default, a [cluster](crate::heuristic::Clustered) is one leaf of the binary tree, and
    /// a wide tree makes a node of it. If a size is set, trees of clusters are quicker to
    /// trace, and slower to build.
    #[must_use]
    pub fn max_leaf_size(self, max_leaf_size: usize) -> Self {
        self.set(|options| options.max_leaf_size = Some(max_leaf_size))
    }

    /// Sets the number of threads in a pool that is started for this build.
    ///
    /// 0 means one thread for each core. By default, the build uses the rayon pool that it is
    /// called in, which is quicker for many small builds. Without the feature `rayon`, the build
    /// uses the calling thread. The tree is the same in all cases.
    #[must_use]
    pub fn threads(self, threads: usize) -> Self {
        self.set(|options| options.threads = Some(threads))
    }

    /// Sets the reinsertion that improves the tree after the build.
    ///
    /// It works for every heuristic. By default, the heuristic decides. Of the [presets](Quality),
    /// `Balanced` and `High` reinsert; other heuristics of this crate do not. [`Optimise::NONE`]
    /// switches the reinsertion of a preset off.
    #[must_use]
    pub fn optimise(self, optimise: Optimise) -> Self {
        self.set(|options| options.optimise = Some(optimise))
    }

    /// Sets the progress callback, which controls how the build goes on.
    ///
    /// The build calls `callback` with its progress, from 0 to 1, at least once every few thousand
    /// primitives, from several threads. It goes on as the returned [`BuildControl`] says.
    /// Optimisation calls `callback` too, with 1. The layout, which follows, does not.
    ///
    /// ```
    /// use bvhkit::{Bvh, BuildError, BuildControl, Sphere};
    /// let spheres: Vec<Sphere> =
    ///     (0..50_000).map(|i| Sphere::new([i as f32, 0.0, 0.0], 0.4)).collect();
    /// let cancelled =
    ///     |progress| if progress > 0.5 { BuildControl::Stop } else { BuildControl::Steady };
    /// assert_eq!(
    ///     Bvh::builder().progress(cancelled).build(&spheres).unwrap_err(),
    ///     BuildError::Stopped
    /// );
    /// ```
    #[must_use]
    pub fn progress(self, callback: impl Fn(f64) -> BuildControl + Send + Sync + 'static) -> Self {
        self.set(|options| options.callback = Some(ProgressCallback(Arc::new(callback))))
    }

    /// Sets the time after which the build hurries, counted from the call of `build`.
    ///
    /// [`BuildControl::Hurry`] describes the effect. The result is always a valid tree. The
    /// shortest build takes about as long as one with [`Quality::Fast`], which has no optimisation.
    ///
    /// ```
    /// use bvhkit::{Bvh, Ray, Sphere};
    /// use std::time::Duration;
    /// let spheres: Vec<Sphere> =
    ///     (0..50_000).map(|i| Sphere::new([i as f32, 0.0, 0.0], 0.4)).collect();
    /// let bvh = Bvh::builder().time_budget(Duration::ZERO).build(&spheres)?;
    /// assert_eq!(bvh.closest_hit(&Ray::new([7.0, -1.0, 0.0], [0.0, 1.0, 0.0])).unwrap().index, 7);
    /// # Ok::<(), bvhkit::BuildError>(())
    /// ```
    #[cfg(feature = "std")]
    #[must_use]
    pub fn time_budget(self, budget: Duration) -> Self {
        self.set(|options| options.time_budget = Some(budget))
    }

    /// Sets the treatment of invalid primitives; the default is [`OnInvalid::Reject`].
    #[must_use]
    pub fn on_invalid(self, on_invalid: OnInvalid) -> Self {
        self.set(|options| options.on_invalid = on_invalid)
    }

    /// Builds the hierarchy over `primitives`.
    ///
    /// The input is a list, an array, `&mesh`, any iterator of primitives, or references to them.
    /// Empty input gives an empty hierarchy, which nothing hits.
    ///
    /// The time is O(n log n) for the heuristics of this crate, except
    /// [`SweepSah`](crate::heuristic::SweepSah). For any heuristic, it is at most
    /// [`MAX_DEPTH`](crate::MAX_DEPTH) times O(n), plus the time of the heuristic itself.
    ///
    /// # Errors
    /// [`BuildError`], whose messages name the fault, its place and the remedy.
    pub fn build(self, primitives: impl IntoIterator<Item = P>) -> Result<Bvh<P, L>, BuildError> {
        self.build_in(&mut Workspace::for_one_build(), primitives)
    }

    /// Builds the same hierarchy as [`build`](Self::build), in memory of earlier builds.
    ///
    /// The memory comes from the [`Workspace`]. [`Bvh::recycle`] brings it back.
    ///
    /// # Errors
    /// The errors of [`build`](Self::build).
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

/// Collects at most 2^32 - 1 items of an iterator.
fn collect<P>(primitives: impl Iterator<Item = P>) -> Result<Vec<P>, BuildError> {
    let limit = u32::MAX as usize;
    let check = |count| if count > limit { Err(BuildError::TooManyPrimitives { count }) } else { Ok(()) };
    check(primitives.size_hint().0)?;
    let collected: Vec<P> = primitives.take(limit.saturating_add(1)).collect();
    check(collected.len())?;
    Ok(collected)
}
