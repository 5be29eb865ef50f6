//! The options of a build, and what may be wrong with its input.

use crate::build::heuristic::{BinnedSah, BuildNode, Heuristic, Split};
use crate::build::{Flaw, PrimRef, Rules, build_tree};
use crate::bvh::Bvh;
use crate::geometry::Scalar;
use crate::layout::{Layout, WideTree};
use crate::parallel::{ThreadPoolError, in_pool};
use crate::primitive::Primitive;
use crate::simd::{Backend, InstructionSet};
use crate::tree::Tree;
use alloc::vec::Vec;
use core::fmt;
use core::marker::PhantomData;

/// How much time a build may take for how quick a tree.
///
/// A preset chooses a heuristic: [`BinnedSah`] with more or fewer bins. The README has the figures.
/// To choose for yourself: [`Builder::heuristic`].
///
/// [`SweepSah`](crate::heuristic::SweepSah), which tries every split, is none of them: on six scenes
/// its trees are 1 to 7 % better than those of 32 bins on four and 2 to 45 % worse on two, where
/// greedy exactness misleads, and take 2 to 3 times as long to build.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Quality {
    /// 8 bins: the quickest build of those that weigh surface areas.
    Fast,
    /// 16 bins.
    #[default]
    Balanced,
    /// 32 bins.
    High,
}

impl<S: Scalar> Heuristic<S> for Quality {
    fn split(&self, node: &BuildNode<'_, S>) -> Split<S> {
        match self {
            Self::Fast => BinnedSah::new(8).split(node),
            Self::Balanced => BinnedSah::new(16).split(node),
            Self::High => BinnedSah::new(32).split(node),
        }
    }
}

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

/// Why a build failed.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum BuildError {
    /// A primitive has a box that is no place in space, and [`OnInvalid::Reject`] is in force.
    InvalidPrimitive {
        /// Its index in the input.
        index: usize,
        /// What is wrong with it.
        flaw: Flaw,
    },
    /// More primitives than 32 bits can number, 2^32 - 1. Found before anything is allocated if the
    /// input tells its length.
    TooManyPrimitives {
        /// How many there are at least.
        count: usize,
    },
    /// `max_leaf_size` is 0.
    ZeroLeafSize,
    /// The layout needs more memory than its references can tell apart: see [`WideTree`] and
    /// [`CompactTree`](crate::CompactTree).
    TooLarge,
    /// The processor, or this build of the crate, does not have the instruction set asked for.
    NoInstructionSet(InstructionSet),
    /// The threads asked for could not be had.
    ThreadPool(ThreadPoolError),
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InvalidPrimitive { index, flaw } => {
                let what = match flaw {
                    Flaw::NanBox => "a bounding box with a NaN",
                    Flaw::InfiniteBox => "a bounding box with an infinite bound",
                    Flaw::InvertedBox => "a bounding box whose minimum is above its maximum",
                };
                write!(f, "primitive {index} has {what}: repair it, or build with OnInvalid::Skip")
            }
            Self::TooManyPrimitives { count } => {
                write!(f, "{count} primitives or more, but indices have 32 bits: split the scene")
            }
            Self::ZeroLeafSize => {
                f.write_str("max_leaf_size is 0, but a leaf has a primitive: give 1 or more")
            }
            Self::TooLarge => {
                f.write_str("the layout exceeds 16 GiB: use the layout Tree, or split the scene")
            }
            Self::NoInstructionSet(set) => {
                write!(f, "no {set} here: InstructionSet::available() tells what there is")
            }
            Self::ThreadPool(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for BuildError {}

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
    instruction_set: Option<InstructionSet>,
    result: PhantomData<fn() -> (P, L)>,
}

impl<P: Primitive, H: Clone, L> Clone for Builder<P, H, L> {
    fn clone(&self) -> Self {
        Self { heuristic: self.heuristic.clone(), ..*self }
    }
}

impl<P: Primitive, L> Builder<P, Quality, L> {
    pub(crate) fn new() -> Self {
        Self {
            heuristic: Quality::default(),
            max_leaf_size: None,
            threads: None,
            on_invalid: OnInvalid::default(),
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
        let Self { max_leaf_size, threads, on_invalid, instruction_set, result, .. } = self;
        Builder { heuristic, max_leaf_size, threads, on_invalid, instruction_set, result }
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
        let Self { heuristic, max_leaf_size, threads, on_invalid, instruction_set, .. } = self;
        Builder { heuristic, max_leaf_size, threads, on_invalid, instruction_set, result: PhantomData }
    }

    /// What queries are computed with, [`InstructionSet::best`] unless set: to compare and to test.
    #[must_use]
    pub fn instruction_set(self, instruction_set: InstructionSet) -> Self {
        Self { instruction_set: Some(instruction_set), ..self }
    }

    /// The largest number of primitives in a leaf of the binary tree: unless set, [`LEAF_WIDTH`](crate::LEAF_WIDTH), 8,
    /// where leaves have so many side by side, else 4; surface area heuristics make smaller ones where that pays. Any
    /// number from 1 on; above the number of primitives it means that number. A [`WideTree`] joins leaves where that is
    /// cheaper, and divides larger ones: its own hold up to `LEAF_WIDTH`, whatever is set here.
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
        if self.max_leaf_size == Some(0) {
            return Err(BuildError::ZeroLeafSize);
        }
        let backend = match self.instruction_set {
            Some(set) => Backend::of(set).ok_or(BuildError::NoInstructionSet(set))?,
            None => Backend::best(),
        };
        let primitives = collect(primitives.into_iter())?;
        let (layout, skipped) =
            in_pool(self.threads, || self.lay_out(&primitives)).map_err(BuildError::ThreadPool)??;
        Ok(Bvh::from_parts(layout, backend, primitives, skipped))
    }

    /// The layout, and the indices of skipped primitives.
    fn lay_out(&self, primitives: &[P]) -> Result<(L, Vec<u32>), BuildError> {
        let References { mut valid, skipped } = self.references(primitives)?;
        let block_size = L::BLOCK_SIZE;
        let max_leaf_size = self.max_leaf_size.unwrap_or(block_size.max(4));
        let tree = build_tree(&mut valid, &Rules { heuristic: &self.heuristic, max_leaf_size, block_size });
        drop(valid);
        let layout = L::lay_out(tree, primitives).ok_or(BuildError::TooLarge)?;
        Ok((layout, skipped))
    }

    fn references(&self, primitives: &[P]) -> Result<References<P::Scalar>, BuildError> {
        let (mut valid, mut skipped) = (Vec::with_capacity(primitives.len()), Vec::new());
        for (index, primitive) in (0..).zip(primitives) {
            let reference = PrimRef::new(primitive.aabb(), index);
            match (reference.flaw(), self.on_invalid) {
                (None, _) => valid.push(reference),
                (Some(_), OnInvalid::Skip) => skipped.push(index),
                (Some(flaw), OnInvalid::Reject) => {
                    return Err(BuildError::InvalidPrimitive { index: index as usize, flaw });
                }
            }
        }
        Ok(References { valid, skipped })
    }
}

/// What there is to build from: references to the valid primitives, and the indices of the others.
struct References<S> {
    valid: Vec<PrimRef<S>>,
    skipped: Vec<u32>,
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
