//! The hierarchy that owns its primitives and answers queries.

use crate::build::heuristic::Heuristic;
use crate::builder::{BuildError, Builder, Quality};
use crate::geometry::{Aabb, Ray};
use crate::primitive::{Intersect, Primitive};
use crate::query::{Hit, Hits, Recorder, Scene, any_hit, closest_hit};
use crate::tree::{InvariantError, Tree, TreeReport};
use alloc::vec::Vec;
use core::fmt;

/// A bounding volume hierarchy over primitives of type `P`, owned (`Bvh<Sphere>`) or borrowed
/// (`Bvh<&Sphere>`).
///
/// Every index that goes in or comes out is the primitive's place in the input. Answers do not
/// depend on the heuristic, the leaf size or the number of threads: they are, bit for bit, those of
/// the [`reference`](crate::reference) loop over all primitives.
///
/// ```
/// use bvhkit::{Bvh, Ray, Triangle};
///
/// let triangles: Vec<Triangle> = (0..1000)
///     .map(|i| {
///         let z = i as f32;
///         Triangle::new([-1.0, -1.0, z], [1.0, -1.0, z], [0.0, 1.0, z])
///     })
///     .collect();
/// let bvh = Bvh::build(triangles)?;
///
/// let ray = Ray::new([0.0, 0.0, 499.5], [0.0, 0.0, 1.0]);
/// let hit = bvh.closest_hit(&ray).expect("the ray points at 500 triangles");
/// assert_eq!((hit.index, hit.t), (500, 0.5));
/// assert!(!bvh.any_hit(&ray.with_interval(0.0, 0.25)));
/// assert_eq!(bvh.hits(&ray).map(|hit| hit.index).take(3).collect::<Vec<_>>(), [500, 501, 502]);
/// # Ok::<(), bvhkit::BuildError>(())
/// ```
#[derive(Clone)]
pub struct Bvh<P: Primitive> {
    tree: Tree<P::Scalar>,
    /// In the order of the tree's slots, for locality; skipped ones last.
    primitives: Vec<P>,
    /// The slot of each input index: the inverse of `tree.indices`.
    slots: Vec<u32>,
}

impl<P: Primitive> Bvh<P> {
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

    /// `tree` and `primitives` in the order of its slots.
    pub(crate) fn from_parts(tree: Tree<P::Scalar>, mut primitives: Vec<P>) -> Self {
        let mut slots = alloc::vec![0; tree.indices.len()];
        for (slot, &index) in (0..).zip(&tree.indices) {
            slots[index as usize] = slot;
        }
        // Follows the cycles of the permutation: each swap puts one primitive in its place.
        let mut target = slots.clone();
        for place in 0..target.len() {
            while target[place] as usize != place {
                let slot = target[place] as usize;
                primitives.swap(place, slot);
                target.swap(place, slot);
            }
        }
        Self { tree, primitives, slots }
    }

    /// The number of primitives in the tree; skipped ones are not counted.
    pub fn len(&self) -> usize {
        self.tree.len()
    }

    /// No primitives in the tree: nothing will be hit.
    pub fn is_empty(&self) -> bool {
        self.tree.is_empty()
    }

    /// The box around all primitives in the tree; [`Aabb::EMPTY`] if there is none.
    pub fn aabb(&self) -> Aabb<P::Scalar> {
        self.tree.aabb()
    }

    /// The primitive with an input index, a skipped one too; none if the index is too large.
    #[inline]
    pub fn get(&self, index: usize) -> Option<&P> {
        self.primitives.get(*self.slots.get(index)? as usize)
    }

    /// The primitive that was hit.
    ///
    /// # Panics
    /// If `index` is not below the number of primitives in the input: see [`get`](Self::get).
    #[inline]
    pub fn primitive(&self, index: usize) -> &P {
        &self.primitives[self.slots[index] as usize]
    }

    /// The primitives in the order of the input, skipped ones included.
    pub fn primitives(&self) -> impl ExactSizeIterator<Item = &P> {
        self.slots.iter().map(|&slot| &self.primitives[slot as usize])
    }

    /// The input indices of the primitives that were skipped as invalid, ascending: see
    /// [`OnInvalid::Skip`](crate::OnInvalid::Skip).
    pub fn skipped(&self) -> &[u32] {
        &self.tree.indices[self.tree.len()..]
    }

    /// The tree, to be compared with another.
    pub fn tree(&self) -> &Tree<P::Scalar> {
        &self.tree
    }

    /// The tree's shape and estimated cost.
    pub fn report(&self) -> TreeReport {
        self.tree.report()
    }

    /// Bytes of everything: nodes, indices, and the primitives themselves (without what they may
    /// own elsewhere).
    pub fn memory_bytes(&self) -> usize {
        self.report().memory_bytes
            + size_of::<P>() * self.primitives.len()
            + size_of::<u32>() * self.slots.len()
    }

    /// Checks every invariant that queries rely on, in O(n): for tests and for the wary.
    ///
    /// # Errors
    /// The first invariant found broken. Never for a tree as built, unless a primitive's box
    /// has changed since.
    pub fn check(&self) -> Result<(), InvariantError> {
        self.tree.check(|slot| self.primitives[slot].aabb())
    }
}

impl<P: Primitive> fmt::Debug for Bvh<P> {
    /// The tree's report; nothing is asked of the primitives.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Bvh").field("report", &self.report()).finish_non_exhaustive()
    }
}

impl<P: Intersect> Bvh<P> {
    /// The hit with the smallest t in the ray's interval; of several with equal t, that of the
    /// primitive with the lowest index. None for an invalid ray: see [`Ray::validate`].
    #[inline]
    pub fn closest_hit(&self, ray: &Ray<P::Scalar>) -> Option<Hit<P::Scalar, P::Payload>> {
        closest_hit(self.scene(), ray, &mut ())
    }

    /// As [`closest_hit`](Self::closest_hit), telling `recorder` of each step:
    /// [`Counters`](crate::Counters), or your own.
    #[inline]
    pub fn closest_hit_with(
        &self,
        ray: &Ray<P::Scalar>,
        recorder: &mut impl Recorder,
    ) -> Option<Hit<P::Scalar, P::Payload>> {
        closest_hit(self.scene(), ray, recorder)
    }

    /// Whether anything is hit in the ray's interval: the same as `closest_hit(ray).is_some()`,
    /// but content with any hit.
    #[inline]
    pub fn any_hit(&self, ray: &Ray<P::Scalar>) -> bool {
        any_hit(self.scene(), ray, &mut ())
    }

    /// As [`any_hit`](Self::any_hit), telling `recorder` of each step.
    #[inline]
    pub fn any_hit_with(&self, ray: &Ray<P::Scalar>, recorder: &mut impl Recorder) -> bool {
        any_hit(self.scene(), ray, recorder)
    }

    /// All hits in the ray's interval by increasing t, those with equal t by index: one for each
    /// primitive hit, its first. Lazy: only as much of the tree is visited as it takes to be sure
    /// of the hits asked for.
    pub fn hits(&self, ray: &Ray<P::Scalar>) -> Hits<'_, P> {
        Hits::new(self.scene(), ray, ())
    }

    /// As [`hits`](Self::hits), telling `recorder` of each step.
    pub fn hits_with<'a, R: Recorder>(
        &'a self,
        ray: &Ray<P::Scalar>,
        recorder: &'a mut R,
    ) -> Hits<'a, P, &'a mut R> {
        Hits::new(self.scene(), ray, recorder)
    }

    #[inline(always)]
    fn scene(&self) -> Scene<'_, P> {
        Scene { tree: &self.tree, primitives: &self.primitives }
    }
}
