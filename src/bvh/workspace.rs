//! Memory that one build leaves to the next.

use crate::builders::{self, PrimRef};
use crate::geometry::Scalar;
use crate::layout;
use crate::memory::recast;
use alloc::vec::Vec;
use core::fmt;
use core::mem::take;

/// Memory that builds leave behind and later builds take.
///
/// For programs that build often, such as in each frame. The system hands out new memory page by
/// page, as it is touched, and allocators give large buffers back as soon as they are freed.
/// From about a million primitives on, this takes a quarter to a half of a build.
/// `docs/building.md` has the figures.
///
/// A workspace keeps the memory that [`Builder::build_in`](crate::Builder::build_in) takes from
/// it. It also keeps the memory of hierarchies that are no longer needed, from
/// [`Bvh::recycle`](crate::Bvh::recycle). Hierarchies are the same with and without a
/// workspace. One workspace serves hierarchies of any types with the same scalar and of any
/// sizes, one after another.
///
/// A hierarchy takes its own memory with it, and `recycle` brings it back. No hierarchy gets memory
/// of more than twice the size that it needs. A hierarchy that is larger than all before takes up
/// to an eighth more than it needs, since the next ones may be larger still. A workspace holds
/// about as much memory as its largest build took, see [`bytes`](Self::bytes). After a build that
/// failed, it may hold less. Dropping the workspace frees the memory.
///
/// ```
/// use bvhkit::{Bvh, Quality, Ray, Sphere, Workspace};
///
/// let mut workspace = Workspace::new();
/// let mut spheres: Vec<Sphere> =
///     (0..1000).map(|i| Sphere::new([i as f32, 0.0, 0.0], 0.35)).collect();
/// for frame in 0..3 {
///     let bvh = Bvh::builder().quality(Quality::Fast).build_in(&mut workspace, spheres)?;
///     let up = Ray::new([7.0, -1.0, 0.0], [0.0, 1.0, 0.0]);
///     assert_eq!(bvh.closest_hit(&up).map(|hit| hit.index), (frame < 2).then_some(7));
///     spheres = bvh.recycle(&mut workspace);
///     spheres.iter_mut().for_each(|sphere| sphere.center[0] += 0.3);
/// }
/// # assert!(workspace.bytes() > 0);
/// # Ok::<(), bvhkit::BuildError>(())
/// ```
pub struct Workspace<S: Scalar = f32> {
    pub(crate) build: builders::Buffers<S>,
    pub(crate) layout: layout::Buffers,
    /// Whether the buffers are kept for another build.
    ///
    /// If not, they are freed as soon as they are not needed.
    pub(super) is_kept: bool,
}

impl<S: Scalar> Default for Workspace<S> {
    fn default() -> Self {
        Self { is_kept: true, ..Self::for_one_build() }
    }
}

impl<S: Scalar> fmt::Debug for Workspace<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Workspace").field("bytes", &self.bytes()).finish()
    }
}

impl<S: Scalar> Workspace<S> {
    /// Creates a workspace without memory.
    pub fn new() -> Self {
        Self::default()
    }

    /// Creates the workspace of a build that leaves nothing behind.
    ///
    /// The build frees memory as soon as it does not need it any more.
    pub(super) fn for_one_build() -> Self {
        Self { build: builders::Buffers::default(), layout: layout::Buffers::default(), is_kept: false }
    }

    /// Makes room for `bytes` bytes of references.
    ///
    /// New memory has at least `later` bytes, since nodes and leaves follow the references in it.
    pub(super) fn make_room(&mut self, bytes: usize, later: usize) {
        // A build that failed has left its references.
        self.hand_over();
        let len = |bytes: usize| bytes.div_ceil(size_of::<PrimRef<S>>());
        let kept: Vec<PrimRef<S>> = recast(self.layout.take_words());
        let is_enough = kept.capacity() > 0 && kept.capacity() >= len(bytes);
        // If `later` is 0, nodes and leaves take much less than references,
        // and get their own memory.
        self.layout.keeps_rest = is_enough || (self.is_kept && later == 0);
        self.build.references = if is_enough { kept } else { Vec::with_capacity(len(bytes.max(later))) };
    }

    /// Hands the memory of the references over, since they are not needed any more.
    ///
    /// Optimisation, collapse, nodes and leaves use it.
    pub(super) fn hand_over(&mut self) {
        self.layout.keep_words(recast(take(&mut self.build.references)));
    }

    /// Returns the number of bytes of memory that the workspace keeps.
    pub fn bytes(&self) -> usize {
        self.build.bytes() + self.layout.bytes()
    }
}
