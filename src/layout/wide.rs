//! Wide trees: nodes of up to N children, and leaves of up to 8 primitives.
//!
//! The boxes of a node's children are tested all at once. A node has rows of planes: x min, x max,
//! y min, y max, z min, z max. The sign of the ray's direction chooses between the rows of minima
//! and of maxima, as an address. The tree's [`Encoding`] defines how planes and leaves are written.

use super::compact::Compact;
use super::encoding::{Encoding, Node};
use super::node_arena::NodeArena;
use super::packed::Packed;
use crate::geometry::{Aabb, Scalar};
use crate::leaf::LEAF_WIDTH;
use crate::simd::Window;

/// A reference to a node or a leaf.
///
/// For a block it is the offset in units of 8 bytes, and bit 31 for leaves. For a leaf that is a
/// range of slots it is bit 31, the number of primitives less 1 in three bits, and the first slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct Reference(u32);

impl Reference {
    /// Returns the references as integers.
    #[inline(always)]
    pub(crate) fn bits(references: &[Self]) -> &[u32] {
        // SAFETY: `Reference` is a transparent `u32`.
        unsafe { core::slice::from_raw_parts(references.as_ptr().cast(), references.len()) }
    }

    /// Returns the window as a window of integers.
    #[inline(always)]
    pub(crate) fn window(references: &mut Window<Self>) -> &mut Window<u32> {
        // SAFETY: `Reference` is a transparent `u32`, and any `u32` is a valid reference.
        unsafe { &mut *core::ptr::from_mut(references).cast() }
    }

    const LEAF: u32 = 1 << 31;
    /// The maximum size of an arena whose blocks all have a reference, in bytes.
    pub(super) const LIMIT: usize = (Self::LEAF as usize).saturating_mul(NodeArena::UNIT);

    /// A placeholder where there is no reference yet.
    pub(super) const NONE: Self = Self(0);

    pub(crate) fn node(offset: usize) -> Self {
        Self((offset / NodeArena::UNIT) as u32)
    }

    pub(crate) fn leaf(offset: usize) -> Self {
        Self((offset / NodeArena::UNIT) as u32 | Self::LEAF)
    }

    /// Returns the reference to the block that is `bytes` bytes further on.
    pub(super) fn behind(self, bytes: usize) -> Self {
        Self(self.0 + (bytes / NodeArena::UNIT) as u32)
    }

    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    #[inline(always)]
    pub(super) fn offset(self) -> usize {
        (self.0 & !Self::LEAF) as usize * NodeArena::UNIT
    }

    /// The number of bits of a first slot.
    const SLOT_BITS: u32 = 31 - LEAF_WIDTH.ilog2();

    /// Returns the leaf of these slots, or `None` if a reference cannot hold them.
    pub(super) fn of_slots(first: u32, count: u32) -> Option<Self> {
        let is_leaf = first < 1 << Self::SLOT_BITS && (1..=LEAF_WIDTH as u32).contains(&count);
        is_leaf.then_some(Self(Self::LEAF | (count - 1) << Self::SLOT_BITS | first))
    }

    /// Returns the first slot, and the number of slots.
    #[inline(always)]
    pub(super) fn slots(self) -> (usize, usize) {
        let first = self.0 & ((1 << Self::SLOT_BITS) - 1);
        (first as usize, ((self.0 & !Self::LEAF) >> Self::SLOT_BITS) as usize + 1)
    }
}

/// The layout for speed: a tree of nodes with up to 16 children.
///
/// The boxes of a node's children are tested all at once. Leaves hold up to 8 primitives, side
/// by side if the leaves store operands of them. 16 is the only `N` that can be built and
/// traced. It is the best width measured, with AVX-512 and with AVX2: see `docs/performance.md`,
/// and `docs/decisions.md`, 5.
///
/// A tree takes at most 16 GiB. On sponza (279,163 triangles) it takes 61 bytes per triangle.
///
/// Every reference that is reachable from the root refers to a node or a leaf inside the tree: only
/// `layout::collapse` writes references, to blocks that it has allocated and to slots that exist.
#[derive(Clone)]
pub struct WideTree<S = f32, const N: usize = 16, F = Packed> {
    pub(super) arena: NodeArena,
    pub(super) encoding: F,
    /// The root, or `None` for an empty tree.
    pub(super) root: Option<Reference>,
    pub(super) aabb: Aabb<S>,
    /// The number of primitives in leaves.
    pub(super) len: usize,
    /// The number of entries in all leaves.
    ///
    /// A primitive counts once for each leaf that holds it.
    pub(super) references: usize,
    /// Whether all coordinates are below `Scalar::LARGE_AREA` in absolute value.
    pub(super) is_ordinary: bool,
}

/// The layout for few bytes: a [`WideTree`] with boxes of 8 bits per plane.
///
/// It is for scenes that are larger than the cache or the memory. Nodes keep the boxes of their
/// children in 8 bits per plane, rounded outward. Leaves are indices. On sponza it takes 8.3 bytes
/// per triangle (measured: docs/decisions.md, 24), without the triangles.
///
/// ```text
/// node:    origin and scale of a grid on each axis;
///          quantized planes of N children, a byte each; N references
/// indices: of all primitives, 4 bytes each
/// ```
///
/// The answers are those of a [`WideTree`], bit for bit, because boxes only grow. Rays are slower
/// in scenes that still fit the cache: nodes compute their planes from quantized planes, and leaves
/// fetch operands from the primitives. So store primitives in an order in which neighbours in space
/// are neighbours in memory, as they are in most files.
///
/// A tree holds at most 2^28 primitives, extra references of spatial splits included. 16 children
/// per node are better than 8, in time and in bytes.
///
/// ```
/// use bvhkit::{Bvh, CompactTree, Triangle};
///
/// let triangles = vec![Triangle::new([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])];
/// let bvh: Bvh<&Triangle, CompactTree> = Bvh::builder().layout().build(&triangles)?;
/// # Ok::<(), bvhkit::BuildError>(())
/// ```
///
/// The format follows Ylitie, Karras and Laine, Efficient Incoherent Ray Traversal on GPUs Through
/// Compressed Wide BVHs, HPG 2017.
pub type CompactTree<S = f32, const N: usize = 16> = WideTree<S, N, Compact>;

/// The maximum number of deferred children on the path to any node; sizes the stack.
///
/// The node itself may defer as many as it has children: the stack has room for them beyond this.
pub(crate) const MAX_STACK: usize = 448;

/// An index that no primitive has.
pub(crate) const NO_PRIMITIVE: u32 = u32::MAX;

/// Trees are equal if they have the same nodes and leaves in the same places.
impl<S: Scalar, const N: usize, F: Encoding<S, N>> PartialEq for WideTree<S, N, F> {
    fn eq(&self, other: &Self) -> bool {
        self.root == other.root
            && self.aabb == other.aabb
            && self.encoding == other.encoding
            && self.arena.words() == other.arena.words()
    }
}

/// The size above which rays are taken to wait for memory, in bytes.
///
/// Prefetching pays off in trees of 13 MB and more, and not in small trees
/// (measured: docs/decisions.md, 27).
const LARGE: usize = 4 << 20;

impl<S: Scalar, const N: usize, F: Encoding<S, N>> WideTree<S, N, F> {
    /// Returns whether rays wait for memory, so that prefetching pays off.
    #[inline(always)]
    pub(crate) fn is_large(&self) -> bool {
        self.arena.len() > LARGE
    }

    /// Returns whether all coordinates are below `Scalar::LARGE_AREA`.
    ///
    /// If they are, leaves may be tested in lanes.
    #[inline(always)]
    pub(crate) fn is_ordinary(&self) -> bool {
        self.is_ordinary
    }

    /// Returns the number of operands of each primitive that a leaf stores.
    #[inline(always)]
    pub(crate) fn operands(&self) -> usize {
        self.encoding.operands()
    }

    /// Returns whether a leaf test gets `operands` operands of each primitive.
    ///
    /// Either the leaves store them, or the test gathers them.
    #[inline(always)]
    pub(crate) fn has_operands(&self, operands: usize) -> bool {
        self.encoding.has_operands(operands)
    }

    /// Returns the node of a reference.
    ///
    /// # Safety
    ///
    /// `reference` is the tree's root or a child of one of its nodes, and refers to a node.
    #[inline(always)]
    pub(crate) unsafe fn node(&self, reference: Reference) -> &F::Node {
        // SAFETY: any bytes are a node, by the contract of `Node`. The caller
        // ensures that a node is there.
        unsafe { self.arena.get(reference.offset()) }
    }

    /// Returns the node at any reference, or `None` if no node fits there.
    pub(super) fn node_at(&self, reference: Reference) -> Option<&F::Node> {
        let offset = reference.offset();
        let fits = offset.checked_add(size_of::<F::Node>())? <= self.arena.len()
            && offset.is_multiple_of(F::Node::ALIGN);
        // SAFETY: any bytes are a node, by the contract of `Node`. These are inside the arena and
        // aligned, as checked above.
        fits.then(|| unsafe { self.arena.get(offset) })
    }
}
