//! Split heuristics: the interface for your own, and the classic ones.
//!
//! | heuristic | splits | paper |
//! |---|---|---|
//! | [`Median`] | longest axis, equal halves | Kay and Kajiya 1986 |
//! | [`Midpoint`] | longest axis, equal lengths | |
//! | [`BinnedSah`] | the cheapest of some planes by the surface area heuristic | Wald 2007 |
//! | [`SweepSah`] | the cheapest of all splits by the same heuristic | MacDonald and Booth 1990 |
//! | [`SpatialSah`] | as [`BinnedSah`], or a plane that cuts references | Stich et al. 2009 |
//! | [`Morton`] | at the highest changing bit along the Morton curve | Lauterbach et al. 2009 |
//! | [`Clustered`] | as another heuristic, down to clusters of neighbours along that curve | |

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
/// The split is only a proposal. The driver splits into equal halves instead where a side would be
/// empty, where the depth bound ([`MAX_DEPTH`](crate::MAX_DEPTH)) would be broken, or where a leaf
/// is proposed for more than [`max_leaf_size`](BuildNode::max_leaf_size) primitives. So a bad
/// heuristic makes a slow tree, never a broken one.
///
/// Several threads call a heuristic at once. Builders take it by reference: they are compiled
/// once, in this crate, for all heuristics. `&dyn Heuristic<f32>` is a heuristic too, for a
/// choice at run time.
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
/// let spheres: Vec<Sphere> =
///     (0..50).map(|i| Sphere::new([(i * i) as f32, 0.0, 0.0], 0.5)).collect();
/// let bvh = Bvh::builder().heuristic(Mean).max_leaf_size(2).build(&spheres)?;
/// assert!(bvh.any_hit(&Ray::new([49.0, -9.0, 0.0], [0.0, 1.0, 0.0])));
/// println!("{}", bvh.report());
/// # Ok::<(), bvhkit::BuildError>(())
/// ```
pub trait Heuristic<S: Scalar>: Sync {
    /// Proposes how to split `node`, which has at least two references.
    fn split(&self, node: &BuildNode<'_, S>) -> Split<S>;

    /// Proposes a split, with its sides if the heuristic knows them.
    ///
    /// Only the heuristics of this crate know the sides.
    #[doc(hidden)]
    fn proposal(&self, node: &BuildNode<'_, S>, _: Own) -> Proposal<S> {
        self.split(node).into()
    }

    /// Returns a code for each reference, in place of splits; `None` by default.
    ///
    /// A code is a place along a curve through `scene`, the box around the whole scene. References
    /// are sorted by their codes, equal codes in the order of the input. Each node is split where
    /// the highest bit changes, in one pass from the leaves up (Lauterbach et al. 2009; Apetrei
    /// 2014). The codes are ignored if there are not as many as references. See [`Morton`].
    fn codes(&self, _references: &[PrimRef<S>], _scene: &Aabb<S>) -> Option<Vec<u64>> {
        None
    }

    /// Returns the maximum number of neighbours that are split as one.
    ///
    /// 1, the default, means no clusters. See [`Clustered`].
    fn cluster_size(&self) -> usize {
        1
    }

    /// Returns the optimisation that follows the build; `None` by default.
    ///
    /// [`Builder::optimise`](crate::Builder::optimise) overrides it.
    fn optimise(&self) -> Option<Optimise> {
        None
    }

    /// Returns the maximum number of extra references, 0 by default.
    ///
    /// [`Split::Spatial`] makes them: there may be more references than primitives, by this number.
    /// The build asks for their memory at once.
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
    /// The box around the node's references.
    pub aabb: Aabb<S>,
    /// The node's references, at least two, in no particular order.
    ///
    /// If a primitive was cut, its reference has a part of its box. In a build of
    /// [clusters](Heuristic::cluster_size) the references are clusters, and their indices are the
    /// numbers of the clusters.
    pub references: &'a [PrimRef<S>],
    /// The node's depth; the root has 0.
    pub depth: usize,
    /// The largest number of references for which [`Split::Leaf`] is accepted.
    pub max_leaf_size: usize,
    /// The number of references that a leaf tests at once.
    ///
    /// 8 in packed leaves, where primitives are side by side; otherwise 1.
    pub block_size: usize,
    /// The box around the whole scene.
    pub scene: Aabb<S>,
    /// Maximum number of references that [`Split::Spatial`] may add below.
    pub extra_references: usize,
}

impl<S: Scalar> BuildNode<'_, S> {
    /// Returns the box around the references' centroids, in O(n).
    pub fn centroids(&self) -> Aabb<S> {
        centroids(self.references)
    }
}

/// A proposal of a heuristic.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Split<S = f32> {
    /// No split: the node becomes a leaf.
    Leaf,
    /// A plane: references with `centroid()[axis] < position` go left.
    ///
    /// The others go right.
    Plane {
        /// The axis that the plane is perpendicular to.
        axis: Axis,
        /// The plane's coordinate on the axis.
        position: S,
    },
    /// A number: the `left` references with the smallest centroids go left.
    ///
    /// Centroids are compared by `centroid()[axis]`, equal ones by index. The others go right.
    Count {
        /// The axis along which centroids are compared.
        axis: Axis,
        /// The number of references that go left.
        left: usize,
    },
    /// A plane in space: the part below `position` goes left, the part above right.
    ///
    /// References whose boxes are on both sides are cut in two, or go to one side as a whole
    /// where that is cheaper (Stich, Friedrich and Dietrich, Spatial Splits in Bounding
    /// Volume Hierarchies, HPG 2009). The split is taken only if
    /// [`extra_references`](BuildNode::extra_references) has room for all references that
    /// are on both sides.
    Spatial {
        /// The axis that the plane is perpendicular to.
        axis: Axis,
        /// The plane's coordinate on the axis.
        position: S,
    },
}
