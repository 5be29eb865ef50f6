//! Where to split a node: the seam for one's own ideas, and the classic ones.
//!
//! | heuristic | splits | paper |
//! |---|---|---|
//! | [`Median`] | longest axis, equal halves | Kay and Kajiya 1986 |
//! | [`Midpoint`] | longest axis, equal lengths | |
//! | [`BinnedSah`] | the cheapest of some planes by the surface area heuristic | Wald 2007 |
//! | [`SweepSah`] | the cheapest of all splits by the same | MacDonald and Booth 1990 |
//! | [`SpatialSah`] | those of [`BinnedSah`], or a plane that cuts references in two | Stich et al. 2009 |
//! | [`Morton`] | where the highest bit changes along a space-filling curve | Lauterbach et al. 2009 |
//! | [`Clustered`] | as another one, down to clusters of neighbours along that curve | |

mod bin_grid;
mod binned_sah;
mod bins;
mod clustered;
mod median;
mod midpoint;
mod morton;
mod proposal;
mod sah;
mod spatial_sah;
mod sweep_sah;

pub use binned_sah::BinnedSah;
pub use clustered::Clustered;
pub use median::Median;
pub use midpoint::Midpoint;
pub use morton::Morton;
pub(super) use morton::{codes, new_codes};
pub(crate) use proposal::{Own, Proposal};
pub use sah::SahCost;
pub use spatial_sah::SpatialSah;
pub use sweep_sah::SweepSah;

use super::Optimise;
use super::reference::{PrimRef, centroids};
use crate::geometry::{Aabb, Axis, Scalar};
use alloc::vec::Vec;

/// Decides how a node is split: one pure function.
///
/// What it proposes is only a proposal. The driver splits in equal halves instead where a side would
/// be empty, where the depth bound ([`MAX_DEPTH`](crate::MAX_DEPTH)) would be broken, or where a leaf
/// is proposed for more than [`max_leaf_size`](BuildNode::max_leaf_size) primitives. So a bad
/// heuristic makes a slow tree, never a broken one.
///
/// Called from several threads at once, and by reference: builders are compiled once, in this
/// crate, whatever the heuristic. `&dyn Heuristic<f32>` is one too, for a choice at run time.
///
/// ```
/// use bvhkit::heuristic::{BuildNode, Heuristic, Split};
/// use bvhkit::{Bvh, Ray, Sphere};
///
/// /// Splits the axis along which centroids spread most, at their mean.
/// struct Mean;
///
/// impl Heuristic<f32> for Mean {
///     fn split(&self, node: &BuildNode<f32>) -> Split<f32> {
///         if node.references.len() <= node.max_leaf_size {
///             return Split::Leaf;
///         }
///         let axis = node.centroids().longest_axis();
///         let sum: f32 = node.references.iter().map(|r| r.centroid()[axis.index()]).sum();
///         Split::Plane { axis, position: sum / node.references.len() as f32 }
///     }
/// }
///
/// let spheres: Vec<Sphere> = (0..50).map(|i| Sphere::new([(i * i) as f32, 0.0, 0.0], 0.5)).collect();
/// let bvh = Bvh::builder().heuristic(Mean).max_leaf_size(2).build(&spheres)?;
/// assert!(bvh.any_hit(&Ray::new([49.0, -9.0, 0.0], [0.0, 1.0, 0.0])));
/// println!("{}", bvh.report());
/// # Ok::<(), bvhkit::BuildError>(())
/// ```
pub trait Heuristic<S: Scalar>: Sync {
    /// Proposes how to split `node`, which has at least two references.
    fn split(&self, node: &BuildNode<'_, S>) -> Split<S>;

    /// The same, with what this crate's own heuristics know beside.
    #[doc(hidden)]
    fn proposal(&self, node: &BuildNode<'_, S>, _: Own) -> Proposal<S> {
        self.split(node).into()
    }

    /// Instead of splits: a code for each reference, its place along a curve through `scene`, the box around
    /// everything. References are sorted by their codes, equal ones as in the input, and each node is split where
    /// the highest bit changes, in one pass from the leaves up (Lauterbach et al. 2009; Apetrei 2014). As many codes as
    /// references, or they do not count. See [`Morton`].
    fn codes(&self, _references: &[PrimRef<S>], _scene: &Aabb<S>) -> Option<Vec<u64>> {
        None
    }

    /// How many neighbours are split as one, at the most: 1 for none. See [`Clustered`].
    fn cluster_size(&self) -> usize {
        1
    }

    /// What follows the build, unless [`Builder::optimise`](crate::Builder::optimise) says otherwise: nothing.
    fn optimise(&self) -> Option<Optimise> {
        None
    }

    /// How many more references than primitives there may be, by [`Split::Spatial`]: memory for them is asked for at once.
    fn extra_references(&self, _primitives: usize) -> usize {
        0
    }
}

impl<S: Scalar, H: Heuristic<S> + ?Sized> Heuristic<S> for &H {
    fn split(&self, node: &BuildNode<'_, S>) -> Split<S> {
        (**self).split(node)
    }

    fn proposal(&self, node: &BuildNode<'_, S>, own: Own) -> Proposal<S> {
        (**self).proposal(node, own)
    }

    fn codes(&self, references: &[PrimRef<S>], scene: &Aabb<S>) -> Option<Vec<u64>> {
        (**self).codes(references, scene)
    }

    fn cluster_size(&self) -> usize {
        (**self).cluster_size()
    }

    fn optimise(&self) -> Option<Optimise> {
        (**self).optimise()
    }

    fn extra_references(&self, primitives: usize) -> usize {
        (**self).extra_references(primitives)
    }
}

/// A node to be split, as a heuristic sees it.
#[derive(Clone, Copy, Debug)]
pub struct BuildNode<'a, S = f32> {
    /// The box around its primitives.
    pub aabb: Aabb<S>,
    /// Its primitives, at least two, in no particular order. Of one that was cut, its part; or, in a build of
    /// [clusters](Heuristic::cluster_size), clusters, whose indices are numbers of their own.
    pub references: &'a [PrimRef<S>],
    /// Its depth; the root has 0.
    pub depth: usize,
    /// The largest number of references for which [`Split::Leaf`] is accepted.
    pub max_leaf_size: usize,
    /// How many references a leaf tests at once: 8 where primitives are packed side by side, else 1.
    pub block_size: usize,
    /// The box around everything.
    pub scene: Aabb<S>,
    /// How many more references there may be below than there are: what [`Split::Spatial`] may add.
    pub extra_references: usize,
}

impl<S: Scalar> BuildNode<'_, S> {
    /// The box around the primitives' centroids: O(n), for those who ask.
    pub fn centroids(&self) -> Aabb<S> {
        centroids(self.references)
    }
}

/// What a heuristic proposes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Split<S = f32> {
    /// No split: make a leaf.
    Leaf,
    /// Left, the references with `centroid()[axis] < position`; right, the others.
    Plane {
        /// The axis across which the plane lies.
        axis: Axis,
        /// The plane's coordinate on it.
        position: S,
    },
    /// Left, the `left` references with the smallest `centroid()[axis]`, equal ones by index.
    Count {
        /// The axis along which to count.
        axis: Axis,
        /// How many go left.
        left: usize,
    },
    /// Left, what lies below `position`; right, what lies above. References whose boxes are on both sides are cut in
    /// two, or go to one side as a whole where that is cheaper (Stich, Friedrich and Dietrich, Spatial Splits in Bounding
    /// Volume Hierarchies, HPG 2009). Taken only if [`extra_references`](BuildNode::extra_references) has room for all that are on both sides.
    Spatial {
        /// The axis across which the plane lies.
        axis: Axis,
        /// The plane's coordinate on it.
        position: S,
    },
}
