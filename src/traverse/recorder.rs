//! Counters of the steps of queries, which are free if unused.

use core::ops::AddAssign;

/// A receiver of the steps of a query.
///
/// The steps are told when the query is done: all nodes, then all leaves, then all primitives. A
/// query for all hits tells them each time that the next hit is known. `()` records nothing and
/// costs nothing. A recorded query takes a slower way to the same answer.
pub trait Recorder {
    /// A valid ray sets out.
    #[inline(always)]
    fn ray(&mut self) {}
    /// An inner node is visited: the boxes of its children are tested.
    #[inline(always)]
    fn node(&mut self) {}
    /// A leaf is visited.
    #[inline(always)]
    fn leaf(&mut self) {}
    /// A primitive is tested.
    #[inline(always)]
    fn primitive(&mut self) {}
    /// Whether it records anything.
    #[doc(hidden)]
    #[inline(always)]
    fn records(&self) -> bool {
        true
    }
}

impl Recorder for () {
    #[inline(always)]
    fn records(&self) -> bool {
        false
    }
}

impl<R: Recorder + ?Sized> Recorder for &mut R {
    #[inline(always)]
    fn ray(&mut self) {
        (**self).ray();
    }
    #[inline(always)]
    fn node(&mut self) {
        (**self).node();
    }
    #[inline(always)]
    fn leaf(&mut self) {
        (**self).leaf();
    }
    #[inline(always)]
    fn primitive(&mut self) {
        (**self).primitive();
    }
    #[inline(always)]
    fn records(&self) -> bool {
        (**self).records()
    }
}

/// Counts of rays and of the nodes, leaves and primitives that they visited.
///
/// For many rays at once there are [`Bvh::closest_hit_steps`](crate::Bvh::closest_hit_steps) and
/// [`Bvh::any_hit_steps`](crate::Bvh::any_hit_steps).
///
/// # Examples
///
/// ```
/// use bvhkit::{Bvh, Counters, Ray, Sphere};
/// let bvh = Bvh::build((0..1000).map(|i| Sphere::new([i as f32, 0.0, 0.0], 0.4)))?;
/// let mut counters = Counters::default();
/// bvh.closest_hit_with(&Ray::new([70.0, -2.0, 0.0], [0.0, 1.0, 0.0]), &mut counters);
/// assert_eq!(counters.rays, 1);
/// assert!(counters.primitives < 10);
/// # Ok::<(), bvhkit::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// The number of valid rays.
    pub rays: u64,
    /// The number of inner nodes visited.
    pub nodes: u64,
    /// The number of leaves visited.
    pub leaves: u64,
    /// The number of primitives tested.
    pub primitives: u64,
}

impl Counters {
    /// Returns the mean number of inner nodes visited by a ray, 0 without rays.
    pub fn nodes_per_ray(&self) -> f64 {
        self.per_ray(self.nodes)
    }

    /// Returns the mean number of leaves visited by a ray, 0 without rays.
    pub fn leaves_per_ray(&self) -> f64 {
        self.per_ray(self.leaves)
    }

    /// Returns the mean number of primitives tested with a ray, 0 without rays.
    pub fn primitives_per_ray(&self) -> f64 {
        self.per_ray(self.primitives)
    }

    /// Tells a recorder of this many steps.
    pub(crate) fn tell(&self, recorder: &mut impl Recorder) {
        (0..self.rays).for_each(|_| recorder.ray());
        (0..self.nodes).for_each(|_| recorder.node());
        (0..self.leaves).for_each(|_| recorder.leaf());
        (0..self.primitives).for_each(|_| recorder.primitive());
    }

    fn per_ray(&self, count: u64) -> f64 {
        count as f64 / self.rays.max(1) as f64
    }
}

impl Recorder for Counters {
    #[inline(always)]
    fn ray(&mut self) {
        self.rays += 1;
    }
    #[inline(always)]
    fn node(&mut self) {
        self.nodes += 1;
    }
    #[inline(always)]
    fn leaf(&mut self) {
        self.leaves += 1;
    }
    #[inline(always)]
    fn primitive(&mut self) {
        self.primitives += 1;
    }
}

impl AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.nodes += other.nodes;
        self.leaves += other.leaves;
        self.primitives += other.primitives;
    }
}
