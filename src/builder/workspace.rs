//! Memory that one build leaves to the next.

use crate::build;
use crate::geometry::Scalar;
use crate::layout;

/// Memory that builds leave behind and later ones take: for who builds often, such as each frame.
///
/// Memory that is new to a process is handed out by the system page by page, as it is touched, and allocators give large buffers
/// back as soon as they are freed: from about a million primitives on that is a quarter to a half of a build. The README has
/// the figures. A workspace keeps what [`Builder::build_in`](crate::Builder::build_in) takes from it, and what
/// [`Bvh::recycle`](crate::Bvh::recycle) gives to it of a hierarchy that is no longer needed. Hierarchies are the same with and
/// without; of any types and sizes, one after another.
///
/// It holds as much as its largest build took: see [`bytes`](Self::bytes). Dropping it frees that. After a build that failed it may
/// hold less.
///
/// ```
/// use bvhkit::{Bvh, Quality, Ray, Sphere, Workspace};
///
/// let mut workspace = Workspace::new();
/// let mut spheres: Vec<Sphere> = (0..1000).map(|i| Sphere::new([i as f32, 0.0, 0.0], 0.4)).collect();
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
#[derive(Debug)]
pub struct Workspace<S: Scalar = f32> {
    pub(crate) build: build::Buffers<S>,
    pub(crate) layout: layout::Buffers,
    /// No other build will need what is in it.
    is_for_one: bool,
}

impl<S: Scalar> Default for Workspace<S> {
    fn default() -> Self {
        let (build, layout) = (build::Buffers::default(), layout::Buffers::default());
        Self { build, layout, is_for_one: false }
    }
}

impl<S: Scalar> Workspace<S> {
    /// Without memory yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Of a build that leaves nothing behind.
    pub(super) fn for_one() -> Self {
        Self { is_for_one: true, ..Self::default() }
    }

    /// Frees what the layout, which follows, does not need, if no build comes after.
    pub(super) fn tree_is_built(&mut self) {
        if self.is_for_one {
            self.build = build::Buffers::default();
        }
    }

    /// Bytes of memory that it keeps.
    pub fn bytes(&self) -> usize {
        self.build.bytes() + self.layout.bytes()
    }
}
