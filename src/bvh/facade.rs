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

/// A bounding volume hierarchy over primitives of type `P`.
///
/// It owns the primitives (`Bvh<Sphere>`) or borrows them (`Bvh<&Sphere>`). Every index that goes
/// in or comes out is the primitive's place in the input.
///
/// Answers are, bit for bit, those of the [`reference`](crate::reference) loop over all
/// primitives. They do not depend on the heuristic, the leaf size, the layout, the instruction set
/// or the number of threads.
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
    /// The primitives, in the order of the input.
    primitives: Vec<P>,
    skipped: Vec<u32>,
}

impl<P: Primitive, L: Layout<P>> Bvh<P, L> {
    pub(crate) fn from_parts(layout: L, backend: Backend, primitives: Vec<P>, skipped: Vec<u32>) -> Self {
        Self { layout, backend, primitives, skipped }
    }

    /// Returns the number of primitives in the tree, without the skipped ones.
    pub fn len(&self) -> usize {
        self.layout.len()
    }

    /// Returns `true` if the tree has no primitives: then nothing is hit.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the box around all primitives in the tree.
    ///
    /// An empty tree has the box [`Aabb::EMPTY`].
    pub fn aabb(&self) -> Aabb<P::Scalar> {
        self.layout.aabb()
    }

    /// Returns the primitive with an input index, a skipped one too.
    ///
    /// Returns `None` if the index is too large.
    #[inline]
    pub fn get(&self, index: usize) -> Option<&P> {
        self.primitives.get(index)
    }

    /// Returns the primitive with an input index, such as that of a hit.
    ///
    /// # Panics
    /// If `index` is not below the number of primitives in the input: see [`get`](Self::get).
    #[inline]
    pub fn primitive(&self, index: usize) -> &P {
        &self.primitives[index]
    }

    /// Returns the primitives in the order of the input, skipped ones included.
    pub fn primitives(&self) -> &[P] {
        &self.primitives
    }

    /// Returns the input indices of the primitives that were skipped as invalid.
    ///
    /// They are in ascending order. See [`OnInvalid::Skip`](crate::OnInvalid::Skip).
    pub fn skipped(&self) -> &[u32] {
        &self.skipped
    }

    /// Gives the hierarchy's memory to a workspace, and returns the primitives.
    ///
    /// The memory serves the next hierarchy that is [built in](crate::Builder::build_in) the
    /// workspace. The primitives are in the order of the input, skipped ones included. You may move
    /// them, for example, and build again.
    pub fn recycle(self, workspace: &mut Workspace<P::Scalar>) -> Vec<P> {
        let tree = self.layout.recycle(&mut workspace.layout);
        workspace.build.reclaim(tree);
        self.primitives
    }

    /// Returns the hierarchy without its primitives, for comparison with another.
    pub fn layout(&self) -> &L {
        &self.layout
    }

    /// Returns the instruction set of queries.
    pub fn instruction_set(&self) -> InstructionSet {
        self.backend.instruction_set()
    }

    /// Returns the shape and the estimated cost of the hierarchy.
    pub fn report(&self) -> TreeReport {
        TreeReport::new(&self.layout)
    }

    /// Returns the number of bytes of everything, primitives included.
    ///
    /// That is nodes, leaves, indices, and the primitives themselves, without the memory that they
    /// own or refer to elsewhere.
    pub fn memory_bytes(&self) -> usize {
        self.layout.bytes()
            + size_of::<P>() * self.primitives.capacity()
            + size_of::<u32>() * self.skipped.capacity()
    }

    /// Checks every invariant that queries rely on, in O(n log n).
    ///
    /// For tests, and for cautious programs.
    ///
    /// # Errors
    /// The first broken invariant. A tree as built breaks none, unless a
    /// primitive's box has changed since.
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
    /// Returns the end-point overlap (EPO), a cost that the SAH cost does not see.
    ///
    /// A ray that ends on a surface visits all nodes around the end point, whether or not
    /// the surface is below them (Aila, Karras and Laine, On Quality Metrics of Bounding
    /// Volume Hierarchies, HPG 2013).
    ///
    /// The EPO is a sum over nodes, over the area of all triangles. Each node adds its
    /// cost times the area inside its box of the triangles that are not below it. So the
    /// EPO is the mean cost of such nodes for a point anywhere on the surface. Costs are
    /// those of [`TreeReport::sah_cost`]: 1 for an inner node, and 1 for a primitive in a
    /// leaf. So both measures have one unit. The paper predicts times by a mean of the
    /// two, weighted scene by scene.
    ///
    /// The EPO is 0 where no box has a part of a triangle that is not below it. Its
    /// maximum is the sum of all costs.
    ///
    /// - Triangles in the same place count each.
    /// - A box counts as far as it is inside all boxes above it: rays reach it only there. In a
    ///   [`CompactTree`](crate::CompactTree), it may stick out.
    /// - A part of a triangle in a face of a box is inside the box.
    ///
    /// The computation cuts each triangle with the boxes that it meets, in `f64`. It takes
    /// some microseconds per triangle, more than the build: O(n log n) for small triangles,
    /// O(n^2) for triangles that meet everything. It runs on all threads, and gives the same
    /// bits on any number of them.
    ///
    /// ```
    /// use bvhkit::heuristic::{Median, SweepSah};
    /// use bvhkit::{Bvh, Triangle};
    ///
    /// // A floor of large triangles, and small ones all over it.
    /// let at = |x: f32, y: f32, size: f32| {
    ///     Triangle::new([x, y, 0.0], [x + size, y, 0.0], [x, y + size, size])
    /// };
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
    /// Improves the tree by reinsertion, on the pool of the calling thread.
    ///
    /// See [`Tree::optimise`].
    pub fn optimise(&mut self, optimise: &Optimise) -> OptimiseStats {
        self.layout.optimise(optimise)
    }

    /// Returns the same hierarchy in another layout.
    ///
    /// ```
    /// use bvhkit::heuristic::Median;
    /// use bvhkit::{Bvh, Optimise, Ray, Sphere, Tree};
    ///
    /// let spheres: Vec<Sphere> =
    ///     (0..100).map(|i| Sphere::new([i as f32, 0.0, 0.0], 0.4)).collect();
    /// let mut binary = Bvh::builder().heuristic(Median).layout::<Tree>().build(&spheres)?;
    /// binary.optimise(&Optimise::default());
    /// let wide: Bvh<&Sphere> = binary.into_layout()?;
    /// assert_eq!(
    ///     wide.closest_hit(&Ray::new([7.0, -1.0, 0.0], [0.0, 1.0, 0.0])).unwrap().index,
    ///     7
    /// );
    /// # Ok::<(), bvhkit::BuildError>(())
    /// ```
    ///
    /// # Errors
    /// [`BuildError::TooLarge`], if the layout cannot address so much memory.
    pub fn into_layout<L: Layout<P>>(self) -> Result<Bvh<P, L>, BuildError> {
        let Self { layout: mut tree, backend, primitives, skipped } = self;
        let layout =
            L::lay_out(&mut tree, &primitives, &mut Buffers::default()).ok_or(BuildError::TooLarge)?;
        Ok(Bvh { layout, backend, primitives, skipped })
    }
}

impl<P: Primitive, L: Layout<P>> fmt::Debug for Bvh<P, L> {
    /// Writes the report of the tree; calls no method of the primitives.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Bvh").field("report", &self.report()).finish_non_exhaustive()
    }
}

impl<P: Intersect, L: Traverse<P>> Bvh<P, L> {
    /// Returns the hit with the smallest t in the ray's interval.
    ///
    /// Of several hits with equal t, it is that of the primitive with the lowest index. An invalid
    /// ray has no hit: see [`Ray::validate`].
    #[inline]
    pub fn closest_hit(&self, ray: &Ray<P::Scalar>) -> Option<Hit<P::Scalar, P::Payload>> {
        self.layout.closest_hit(self.backend, &self.primitives, ray)
    }

    /// Returns the [`closest_hit`](Self::closest_hit), and tells `recorder` each step.
    ///
    /// The recorder is [`Counters`](crate::Counters), or your own.
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

    /// Returns whether the ray hits anything in its interval.
    ///
    /// The answer is that of `closest_hit(ray).is_some()`, but the first hit found ends the search.
    #[inline]
    pub fn any_hit(&self, ray: &Ray<P::Scalar>) -> bool {
        self.layout.any_hit(self.backend, &self.primitives, ray)
    }

    /// Returns [`any_hit`](Self::any_hit), and tells `recorder` each step.
    #[inline]
    pub fn any_hit_with(&self, ray: &Ray<P::Scalar>, recorder: &mut impl Recorder) -> bool {
        if !recorder.records() {
            return self.any_hit(ray);
        }
        let (is_hit, steps) = self.layout.counted_any_hit(self.backend, &self.primitives, ray);
        steps.tell(recorder);
        is_hit
    }

    /// Writes the [`closest_hit`](Self::closest_hit) of each ray, the same bits.
    ///
    /// The answer of `rays[i]` is written to `hits[i]`. If one list is longer than the other, the
    /// rest of it is left alone.
    ///
    /// ```
    /// use bvhkit::{Bvh, Ray, Sphere};
    /// let bvh = Bvh::build((0..100).map(|i| Sphere::new([i as f32, 0.0, 0.0], 0.4)))?;
    /// let rays: Vec<Ray> =
    ///     (0..50).map(|i| Ray::new([2.0 * i as f32, -1.0, 0.0], [0.0, 1.0, 0.0])).collect();
    /// let mut hits = vec![None; rays.len()];
    /// bvh.closest_hits(&rays, &mut hits);
    /// assert!((0..50).all(|i| hits[i].is_some_and(|hit| hit.index == 2 * i)));
    /// # Ok::<(), bvhkit::BuildError>(())
    /// ```
    pub fn closest_hits(&self, rays: &[Ray<P::Scalar>], hits: &mut [Option<Hit<P::Scalar, P::Payload>>]) {
        self.layout.closest_hits(self.backend, &self.primitives, rays, hits);
    }

    /// Writes [`any_hit`](Self::any_hit) of each ray.
    ///
    /// The answer of `rays[i]` is written to `hits[i]`, as by [`closest_hits`](Self::closest_hits).
    pub fn any_hits(&self, rays: &[Ray<P::Scalar>], hits: &mut [bool]) {
        self.layout.any_hits(self.backend, &self.primitives, rays, hits);
    }

    /// Counts the steps of [`closest_hit`](Self::closest_hit) for these rays.
    ///
    /// The counters have the totals and the [means](Counters::nodes_per_ray): a measure of
    /// the tree by your own rays.
    ///
    /// ```
    /// use bvhkit::heuristic::Median;
    /// use bvhkit::{Bvh, Ray, Sphere};
    ///
    /// let spheres: Vec<Sphere> =
    ///     (0..1000).map(|i| Sphere::new([(i * i) as f32, 0.0, 0.0], 9.0)).collect();
    /// let rays: Vec<Ray> =
    ///     (0..100).map(|i| Ray::new([1e4 * i as f32, 0.0, -20.0], [0.0, 0.0, 1.0])).collect();
    ///
    /// let steps = Bvh::build(&spheres)?.closest_hit_steps(&rays);
    /// let (nodes, tests) = (steps.nodes_per_ray(), steps.primitives_per_ray());
    /// println!("{nodes:.1} nodes, {tests:.1} tests per ray");
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

    /// Counts the steps of [`any_hit`](Self::any_hit) for these rays.
    pub fn any_hit_steps(&self, rays: &[Ray<P::Scalar>]) -> Counters {
        let mut counters = Counters::default();
        for ray in rays {
            counters += self.layout.counted_any_hit(self.backend, &self.primitives, ray).1;
        }
        counters
    }

    /// Returns all hits in the ray's interval by increasing t, equal ones by index.
    ///
    /// Each primitive that is hit has one hit, its first. The iterator is lazy: it visits only as
    /// much of the tree as the hits asked for require.
    pub fn hits(&self, ray: &Ray<P::Scalar>) -> Hits<'_, P, L> {
        Hits::new(&self.layout, self.backend, &self.primitives, ray, ())
    }

    /// Returns the [`hits`](Self::hits), and tells `recorder` each step.
    pub fn hits_with<'a, R: Recorder>(
        &'a self,
        ray: &Ray<P::Scalar>,
        recorder: &'a mut R,
    ) -> Hits<'a, P, L, &'a mut R> {
        Hits::new(&self.layout, self.backend, &self.primitives, ray, recorder)
    }
}
