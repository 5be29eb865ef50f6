//! Memory that one build leaves to the next.

use crate::builders::{self, PrimRef};
use crate::geometry::Scalar;
use crate::layout;
use crate::memory::recast;
use alloc::vec::Vec;
use core::fmt;
use core::mem::take;

/// Memory that builds leave behind and later ones take: for who builds often, such as each frame.
///
/// Memory that is new to a process is handed out by the system page by page, as it is touched, and allocators give large buffers
/// back as soon as they are freed: from about a million primitives on that is a quarter to a half of a build.
/// `docs/building.md` has the figures. A workspace keeps what
/// [`Builder::build_in`](crate::Builder::build_in) takes from it, and what
/// [`Bvh::recycle`](crate::Bvh::recycle) gives to it of a hierarchy that is no longer needed. Hierarchies are the same with and
/// without; of any types with the same scalar and any sizes, one after another.
///
/// A hierarchy takes its own memory with it, and brings it back by `recycle`. It gets none that is more than twice what it needs;
/// one that is larger than all before takes up to an eighth more than it needs, since it may go on to grow. A workspace holds
/// about as much as its largest build took, see [`bytes`](Self::bytes), after a build that failed perhaps less. Dropping it
/// frees that.
///
/// ```
/// use bvhkit::{Bvh, Quality, Ray, Sphere, Workspace};
///
/// let mut workspace = Workspace::new();
/// let mut spheres: Vec<Sphere> = (0..1000).map(|i| Sphere::new([i as f32, 0.0, 0.0], 0.35)).collect();
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
    /// For another build; else they are freed as soon as they are not needed.
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
    /// Without memory yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Of a build that leaves nothing behind, and frees what it does not need any more.
    pub(super) fn for_one_build() -> Self {
        Self { build: builders::Buffers::default(), layout: layout::Buffers::default(), is_kept: false }
    }

    /// Makes room for references, in bytes; for `later` bytes in memory that is made for them, where blocks will follow them.
    pub(super) fn make_room(&mut self, bytes: usize, later: usize) {
        // What a build that failed has left.
        self.hand_over();
        let len = |bytes: usize| bytes.div_ceil(size_of::<PrimRef<S>>());
        let kept: Vec<PrimRef<S>> = recast(self.layout.take_words());
        let is_enough = kept.capacity() > 0 && kept.capacity() >= len(bytes);
        // Blocks that take much less than references do have memory of their own.
        self.layout.keeps_rest = is_enough || (self.is_kept && later == 0);
        self.build.references = if is_enough { kept } else { Vec::with_capacity(len(bytes.max(later))) };
    }

    /// References are not needed any more: what they lie in is memory for optimisation, collapse and blocks.
    pub(super) fn hand_over(&mut self) {
        self.layout.keep_words(recast(take(&mut self.build.references)));
    }

    /// Bytes of memory that it keeps.
    pub fn bytes(&self) -> usize {
        self.build.bytes() + self.layout.bytes()
    }
}
