//! The hierarchy that owns its primitives and answers queries.

use super::error::BuildError;
use super::workspace::Workspace;
use crate::analysis::{InvariantError, TreeReport, check, epo};
use crate::builders::{Optimise, OptimiseStats};
use crate::geometry::{Aabb, Ray};
use crate::layout::{Buffers, Layout, WideTree};
use crate::primitive::{Corners, Intersect, Primitive};
use crate::query::{Hit, Hits, Traverse};
use crate::simd::{Backend, InstructionSet};
use crate::traverse::{Counters, Recorder};
use crate::tree::Tree;
use alloc::vec::Vec;
use core::fmt;

/// A bounding volume hierarchy over primitives of type `P`, owned (`Bvh<Sphere>`) or borrowed
/// (`Bvh<&Sphere>`).
///
/// Every index that goes in or comes out is the primitive's place in the input. Answers do not
/// depend on the heuristic, the leaf size, the layout, the instruction set or the number of threads: they are, bit for bit, those of
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
pub struct Bvh<P: Primitive, L: Layout<P> = WideTree<<P as Primitive>::Scalar>> {
    layout: L,
    backend: Backend,
    /// In the order of the input.
    primitives: Vec<P>,
    skipped: Vec<u32>,
}

impl<P: Primitive, L: Layout<P>> Bvh<P, L> {
    pub(crate) fn from_parts(layout: L, backend: Backend, primitives: Vec<P>, skipped: Vec<u32>) -> Self {
        Self { layout, backend, primitives, skipped }
    }

    /// The number of primitives in the tree; skipped ones are not counted.
    pub fn len(&self) -> usize {
        self.layout.len()
    }

    /// No primitives in the tree: nothing will be hit.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The box around all primitives in the tree; [`Aabb::EMPTY`] if there is none.
    pub fn aabb(&self) -> Aabb<P::Scalar> {
        self.layout.aabb()
    }

    /// The primitive with an input index, a skipped one too; none if the index is too large.
    #[inline]
    pub fn get(&self, index: usize) -> Option<&P> {
        self.primitives.get(index)
    }

    /// The primitive that was hit.
    ///
    /// # Panics
    /// If `index` is not below the number of primitives in the input: see [`get`](Self::get).
    #[inline]
    pub fn primitive(&self, index: usize) -> &P {
        &self.primitives[index]
    }

    /// The primitives in the order of the input, skipped ones included.
    pub fn primitives(&self) -> &[P] {
        &self.primitives
    }

    /// The input indices of the primitives that were skipped as invalid, ascending: see
    /// [`OnInvalid::Skip`](crate::OnInvalid::Skip).
    pub fn skipped(&self) -> &[u32] {
        &self.skipped
    }

    /// Leaves the hierarchy's memory to the next that is [built in](Builder::build_in) the workspace, and gives the primitives
    /// back, in the order of the input, skipped ones included: to be moved, say, and built again.
    pub fn recycle(self, workspace: &mut Workspace<P::Scalar>) -> Vec<P> {
        let tree = self.layout.recycle(&mut workspace.layout);
        workspace.build.reclaim(tree);
        self.primitives
    }

    /// The hierarchy without its primitives, to be compared with another.
    pub fn layout(&self) -> &L {
        &self.layout
    }

    /// What queries are computed with.
    pub fn instruction_set(&self) -> InstructionSet {
        self.backend.instruction_set()
    }

    /// The hierarchy's shape and estimated cost.
    pub fn report(&self) -> TreeReport {
        TreeReport::new(&self.layout)
    }

    /// Bytes of everything: nodes, leaves, indices, and the primitives themselves (without what they may
    /// own or refer to elsewhere).
    pub fn memory_bytes(&self) -> usize {
        self.layout.bytes()
            + size_of::<P>() * self.primitives.capacity()
            + size_of::<u32>() * self.skipped.capacity()
    }

    /// Checks every invariant that queries rely on, in O(n log n): for tests and for the wary.
    ///
    /// # Errors
    /// The first invariant found broken. Never for a tree as built, unless a primitive's box
    /// has changed since.
    pub fn check(&self) -> Result<(), InvariantError> {
        let is_skipped = |index: usize| self.skipped.binary_search(&(index as u32)).is_ok();
        let indices = (0..self.primitives.len()).filter(|&index| !is_skipped(index));
        check(&self.layout, indices, |index| self.primitives[index].aabb())
    }
}

impl<P, L> Bvh<P, L>
where
    P: Primitive + Corners<Scalar = <P as Primitive>::Scalar>,
    L: Layout<P>,
{
    /// The end-point overlap, what the SAH cost does not see (Aila, Karras and Laine, On Quality Metrics of Bounding Volume
    /// Hierarchies, HPG 2013): a ray that ends on a surface visits all nodes around that point, the surface below them or
    /// not.
    ///
    /// The sum over nodes of their cost times the area of the triangles in their boxes that are not below them, over the
    /// area of all triangles: the mean cost of such nodes for a point anywhere on the surface. Costs are those of
    /// [`TreeReport::sah_cost`], 1 for an inner node and for a primitive in a leaf, so both have one unit; the paper
    /// predicts times by a mean of the two, weighted scene by scene. From 0, where no box has a part of a triangle that is not below it, to
    /// the sum of all costs. Triangles in the same place count each. A box counts as far as it lies in all those above it, where alone rays
    /// get to it: in a [`CompactTree`](crate::CompactTree) it may stick out. A part in a face of a box is inside.
    ///
    /// Computed in `f64`, by cutting each triangle with the boxes that it meets: some microseconds a triangle, which is more
    /// than it took to build, in O(n log n) for small triangles and in O(n^2) for those that meet everything. On all
    /// threads; the same bits on any number of them.
    ///
    /// ```
    /// use bvhkit::heuristic::{Median, SweepSah};
    /// use bvhkit::{Bvh, Triangle};
    ///
    /// // A floor of large triangles, and small ones all over it.
    /// let at = |x: f32, y: f32, size: f32| Triangle::new([x, y, 0.0], [x + size, y, 0.0], [x, y + size, size]);
    /// let triangles: Vec<Triangle> = (0..1000)
    ///     .map(|i| at((i * i % 97) as f32, (i % 89) as f32, if i % 50 == 0 { 40.0 } else { 0.5 }))
    ///     .collect();
    /// let median = Bvh::builder().heuristic(Median).build(&triangles)?;
    /// let sweep = Bvh::builder().heuristic(SweepSah::default()).build(&triangles)?;
    /// println!("median: SAH cost {:.2}, EPO {:.2}", median.report().sah_cost, median.epo());
    /// assert!(sweep.epo() < median.epo());
    /// # Ok::<(), bvhkit::BuildError>(())
    /// ```
    pub fn epo(&self) -> f64 {
        let Self { layout, primitives, .. } = self;
        epo(layout, |index| primitives[index].corners())
    }
}

impl<P: Primitive> Bvh<P, Tree<P::Scalar>> {
    /// Makes the tree better: see [`Tree::optimise`]. On the calling thread's pool.
    pub fn optimise(&mut self, optimise: &Optimise) -> OptimiseStats {
        self.layout.optimise(optimise)
    }

    /// The same hierarchy in another layout.
    ///
    /// ```
    /// use bvhkit::heuristic::Median;
    /// use bvhkit::{Bvh, Optimise, Ray, Sphere, Tree};
    ///
    /// let spheres: Vec<Sphere> = (0..100).map(|i| Sphere::new([i as f32, 0.0, 0.0], 0.4)).collect();
    /// let mut binary = Bvh::builder().heuristic(Median).layout::<Tree>().build(&spheres)?;
    /// binary.optimise(&Optimise::default());
    /// let wide: Bvh<&Sphere> = binary.into_layout()?;
    /// assert_eq!(wide.closest_hit(&Ray::new([7.0, -1.0, 0.0], [0.0, 1.0, 0.0])).unwrap().index, 7);
    /// # Ok::<(), bvhkit::BuildError>(())
    /// ```
    ///
    /// # Errors
    /// [`BuildError::TooLarge`].
    pub fn into_layout<L: Layout<P>>(self) -> Result<Bvh<P, L>, BuildError> {
        let Self { layout: mut tree, backend, primitives, skipped } = self;
        let layout =
            L::lay_out(&mut tree, &primitives, &mut Buffers::default()).ok_or(BuildError::TooLarge)?;
        Ok(Bvh { layout, backend, primitives, skipped })
    }
}

impl<P: Primitive, L: Layout<P>> fmt::Debug for Bvh<P, L> {
    /// The tree's report; nothing is asked of the primitives.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Bvh").field("report", &self.report()).finish_non_exhaustive()
    }
}

impl<P: Intersect, L: Traverse<P>> Bvh<P, L> {
    /// The hit with the smallest t in the ray's interval; of several with equal t, that of the
    /// primitive with the lowest index. None for an invalid ray: see [`Ray::validate`].
    #[inline]
    pub fn closest_hit(&self, ray: &Ray<P::Scalar>) -> Option<Hit<P::Scalar, P::Payload>> {
        self.layout.closest_hit(self.backend, &self.primitives, ray)
    }

    /// As [`closest_hit`](Self::closest_hit), telling `recorder` of each step:
    /// [`Counters`](crate::Counters), or your own.
    #[inline]
    pub fn closest_hit_with(
        &self,
        ray: &Ray<P::Scalar>,
        recorder: &mut impl Recorder,
    ) -> Option<Hit<P::Scalar, P::Payload>> {
        if !recorder.records() {
            return self.closest_hit(ray);
        }
        let (hit, steps) = self.layout.counted_closest_hit(self.backend, &self.primitives, ray);
        steps.tell(recorder);
        hit
    }

    /// Whether anything is hit in the ray's interval: the same as `closest_hit(ray).is_some()`,
    /// but content with any hit.
    #[inline]
    pub fn any_hit(&self, ray: &Ray<P::Scalar>) -> bool {
        self.layout.any_hit(self.backend, &self.primitives, ray)
    }

    /// As [`any_hit`](Self::any_hit), telling `recorder` of each step.
    #[inline]
    pub fn any_hit_with(&self, ray: &Ray<P::Scalar>, recorder: &mut impl Recorder) -> bool {
        if !recorder.records() {
            return self.any_hit(ray);
        }
        let (is_hit, steps) = self.layout.counted_any_hit(self.backend, &self.primitives, ray);
        steps.tell(recorder);
        is_hit
    }

    /// [`closest_hit`](Self::closest_hit) of each ray, the same bits, in the place of the same number. If there are more
    /// rays than places or more places than rays, the others are left alone.
    ///
    /// ```
    /// use bvhkit::{Bvh, Ray, Sphere};
    /// let bvh = Bvh::build((0..100).map(|i| Sphere::new([i as f32, 0.0, 0.0], 0.4)))?;
    /// let rays: Vec<Ray> = (0..50).map(|i| Ray::new([2.0 * i as f32, -1.0, 0.0], [0.0, 1.0, 0.0])).collect();
    /// let mut hits = vec![None; rays.len()];
    /// bvh.closest_hits(&rays, &mut hits);
    /// assert!((0..50).all(|i| hits[i].is_some_and(|hit| hit.index == 2 * i)));
    /// # Ok::<(), bvhkit::BuildError>(())
    /// ```
    pub fn closest_hits(&self, rays: &[Ray<P::Scalar>], hits: &mut [Option<Hit<P::Scalar, P::Payload>>]) {
        self.layout.closest_hits(self.backend, &self.primitives, rays, hits);
    }

    /// [`any_hit`](Self::any_hit) of each ray, in the place of the same number; as
    /// [`closest_hits`](Self::closest_hits).
    pub fn any_hits(&self, rays: &[Ray<P::Scalar>], hits: &mut [bool]) {
        self.layout.any_hits(self.backend, &self.primitives, rays, hits);
    }

    /// What [`closest_hit`](Self::closest_hit) visits for these rays, in all and by
    /// [mean](Counters::nodes_per_ray): a tree weighed by your own rays.
    ///
    /// ```
    /// use bvhkit::heuristic::Median;
    /// use bvhkit::{Bvh, Ray, Sphere};
    ///
    /// let spheres: Vec<Sphere> = (0..1000).map(|i| Sphere::new([(i * i) as f32, 0.0, 0.0], 9.0)).collect();
    /// let rays: Vec<Ray> = (0..100).map(|i| Ray::new([1e4 * i as f32, 0.0, -20.0], [0.0, 0.0, 1.0])).collect();
    ///
    /// let steps = Bvh::build(&spheres)?.closest_hit_steps(&rays);
    /// println!("{:.1} nodes, {:.1} tests per ray", steps.nodes_per_ray(), steps.primitives_per_ray());
    /// assert_eq!(steps.rays, 100);
    /// // Rays for both questions, such as a renderer has, are added up.
    /// let mut median = Bvh::builder().heuristic(Median).build(&spheres)?.closest_hit_steps(&rays);
    /// median += Bvh::builder().heuristic(Median).build(&spheres)?.any_hit_steps(&rays);
    /// assert_eq!(median.rays, 200);
    /// # Ok::<(), bvhkit::BuildError>(())
    /// ```
    pub fn closest_hit_steps(&self, rays: &[Ray<P::Scalar>]) -> Counters {
        let mut counters = Counters::default();
        for ray in rays {
            counters += self.layout.counted_closest_hit(self.backend, &self.primitives, ray).1;
        }
        counters
    }

    /// The same for [`any_hit`](Self::any_hit).
    pub fn any_hit_steps(&self, rays: &[Ray<P::Scalar>]) -> Counters {
        let mut counters = Counters::default();
        for ray in rays {
            counters += self.layout.counted_any_hit(self.backend, &self.primitives, ray).1;
        }
        counters
    }

    /// All hits in the ray's interval by increasing t, those with equal t by index: one for each
    /// primitive hit, its first. Lazy: only as much of the tree is visited as it takes to be sure
    /// of the hits asked for.
    pub fn hits(&self, ray: &Ray<P::Scalar>) -> Hits<'_, P, L> {
        Hits::new(&self.layout, self.backend, &self.primitives, ray, ())
    }

    /// As [`hits`](Self::hits), telling `recorder` of each step.
    pub fn hits_with<'a, R: Recorder>(
        &'a self,
        ray: &Ray<P::Scalar>,
        recorder: &'a mut R,
    ) -> Hits<'a, P, L, &'a mut R> {
        Hits::new(&self.layout, self.backend, &self.primitives, ray, recorder)
    }
}
