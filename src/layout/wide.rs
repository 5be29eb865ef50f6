//! The wide trees: nodes of up to N children, whose boxes are tested all at once, and leaves of up to 8 primitives.
//!
//! A node has rows of planes: x min, x max, y min, y max, z min, z max. The ray's sign chooses between rows of minima and of
//! maxima, as an address. How planes and leaves are written is the tree's [`Encoding`].

use super::compact::Compact;
use super::encoding::{Encoding, Node};
use super::node_arena::NodeArena;
use super::packed::Packed;
use crate::analysis::TreeReport;
use crate::geometry::{Aabb, Scalar};
use crate::leaf::LEAF_WIDTH;
use crate::simd::Window;
use core::fmt;

/// Where a block lies: its offset in units of 8 bytes, and bit 31 for leaves. A leaf that is no block: bit 31, its number of
/// primitives less 1 in three bits, its first slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct Reference(u32);

impl Reference {
    /// As numbers.
    #[inline(always)]
    pub(crate) fn bits(references: &[Self]) -> &[u32] {
        // SAFETY: a reference is a transparent u32.
        unsafe { core::slice::from_raw_parts(references.as_ptr().cast(), references.len()) }
    }

    /// As numbers.
    #[inline(always)]
    pub(crate) fn window(references: &mut Window<Self>) -> &mut Window<u32> {
        // SAFETY: a reference is a transparent u32, and any is valid.
        unsafe { &mut *core::ptr::from_mut(references).cast() }
    }

    const LEAF: u32 = 1 << 31;
    /// In blocks of this size, in bytes, and smaller ones every place has a reference.
    pub(super) const LIMIT: usize = (Self::LEAF as usize).saturating_mul(NodeArena::UNIT);

    /// None yet.
    pub(super) const NONE: Self = Self(0);

    pub(crate) fn node(offset: usize) -> Self {
        Self((offset / NodeArena::UNIT) as u32)
    }

    pub(crate) fn leaf(offset: usize) -> Self {
        Self((offset / NodeArena::UNIT) as u32 | Self::LEAF)
    }

    /// The same so many bytes further on.
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

    /// Bits of a first slot.
    const SLOT_BITS: u32 = 31 - LEAF_WIDTH.ilog2();

    /// A leaf of slots, if they are not too many to tell apart.
    pub(super) fn of_slots(first: u32, count: u32) -> Option<Self> {
        let is_leaf = first < 1 << Self::SLOT_BITS && (1..=LEAF_WIDTH as u32).contains(&count);
        is_leaf.then_some(Self(Self::LEAF | (count - 1) << Self::SLOT_BITS | first))
    }

    /// The first slot, and how many there are.
    #[inline(always)]
    pub(super) fn slots(self) -> (usize, usize) {
        let first = self.0 & ((1 << Self::SLOT_BITS) - 1);
        (first as usize, ((self.0 & !Self::LEAF) >> Self::SLOT_BITS) as usize + 1)
    }
}

/// The layout for speed: a tree of nodes with up to 16 children, whose boxes are tested all at once, and of leaves of up to 8
/// primitives, side by side if operands of them lie there. 16 is the only `N` that can be built and traced.
///
/// At most 16 GiB. On 279,163 triangles of sponza it takes 61 bytes a triangle.
///
/// 16 is the best width measured, with AVX-512 and with AVX2: see `docs/performance.md`, and
/// `docs/decisions.md`, 5.
///
/// Every reference that can be reached from the root refers to a node or a leaf inside of the tree: only
/// `layout::collapse` writes any, for blocks that it has allocated and slots that there are.
#[derive(Clone)]
pub struct WideTree<S = f32, const N: usize = 16, F = Packed> {
    pub(super) arena: NodeArena,
    pub(super) encoding: F,
    /// None for an empty tree.
    pub(super) root: Option<Reference>,
    pub(super) aabb: Aabb<S>,
    /// Primitives in leaves.
    pub(super) len: usize,
    /// The same, each as often as it is in a leaf.
    pub(super) references: usize,
    /// All coordinates are below `Scalar::LARGE_AREA`.
    pub(super) is_ordinary: bool,
}

/// The layout for few bytes, where a scene outgrows the cache or the memory: a [`WideTree`] whose nodes keep their children's
/// boxes in 8 bits a plane, rounded outward, and whose leaves are indices.
///
/// On 279,163 triangles of sponza it takes 8.3 bytes a triangle, where a [`WideTree`] takes 61; all in, 44.3 with
/// triangles that it owns, 16.3 with borrowed ones.
///
/// ```text
/// node:    origin and scale of a grid on each axis; places of N children's planes, a byte each; N references
/// indices: of all primitives, 4 bytes each
/// ```
///
/// Answers are the same bits, since boxes only grow. Closest hits are found at 0.60 to 0.81 of the [`WideTree`]'s rate, any hits at 0.58
/// to 0.71 (sponza and dragon, which still fit the cache): planes are computed from their places, and leaves
/// fetch what they need of their primitives from where those lie. So it pays to have them in an order in which neighbours in space
/// are neighbours in memory, as those of most files are.
///
/// At most 2^28 primitives. 16 children a node are better than 8, in time and in bytes.
///
/// ```
/// use bvhkit::{Bvh, CompactTree, Triangle};
///
/// let triangles = vec![Triangle::new([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])];
/// let bvh: Bvh<&Triangle, CompactTree> = Bvh::builder().layout().build(&triangles)?;
/// # Ok::<(), bvhkit::BuildError>(())
/// ```
///
/// After Ylitie, Karras and Laine, Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs, HPG 2017.
pub type CompactTree<S = f32, const N: usize = 16> = WideTree<S, N, Compact>;

/// No path through a tree leaves more children behind.
pub(crate) const MAX_STACK: usize = 448;

/// No primitive has this index.
pub(crate) const NO_PRIMITIVE: u32 = u32::MAX;

/// The same nodes and leaves in the same places.
impl<S: Scalar, const N: usize, F: Encoding<S, N>> PartialEq for WideTree<S, N, F> {
    fn eq(&self, other: &Self) -> bool {
        self.root == other.root
            && self.aabb == other.aabb
            && self.encoding == other.encoding
            && self.arena.words() == other.arena.words()
    }
}

impl<S: Scalar, const N: usize, F: Encoding<S, N>> fmt::Debug for WideTree<S, N, F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("WideTree").field("report", &TreeReport::new(self)).finish_non_exhaustive()
    }
}

/// In bytes: rays through a larger tree are taken to wait for memory. Below lies a kitchen of 3.5 MB, where fetching ahead gains
/// nothing on an Intel Xeon and loses on a Zen 5 machine, above are those of 13 MB and more, where it gains; what lies between was
/// not measured.
const LARGE: usize = 4 << 20;

impl<S: Scalar, const N: usize, F: Encoding<S, N>> WideTree<S, N, F> {
    /// Whether rays wait for memory, so that it pays to fetch ahead what they will need.
    #[inline(always)]
    pub(crate) fn is_large(&self) -> bool {
        self.arena.len() > LARGE
    }

    /// Whether all coordinates are below `Scalar::LARGE_AREA`: then lanes may be tested.
    #[inline(always)]
    pub(crate) fn is_ordinary(&self) -> bool {
        self.is_ordinary
    }

    /// Scalars of each primitive that lie in its leaf, or would be gathered.
    #[inline(always)]
    pub(crate) fn operands(&self) -> usize {
        self.encoding.operands()
    }

    /// Whether leaves have so many of each primitive, or will have them gathered.
    #[inline(always)]
    pub(crate) fn has_operands(&self, operands: usize) -> bool {
        self.encoding.has_operands(operands)
    }

    /// # Safety
    /// `reference` is that of one of the tree's nodes: its root, or a child of one of them.
    #[inline(always)]
    pub(crate) unsafe fn node(&self, reference: Reference) -> &F::Node {
        // SAFETY: nodes are any bytes, and one lies there, by the caller's word.
        unsafe { self.arena.get(reference.offset()) }
    }

    /// The node at any place; none if there is no room for one.
    pub(super) fn node_at(&self, reference: Reference) -> Option<&F::Node> {
        let offset = reference.offset();
        let fits = offset.checked_add(size_of::<F::Node>())? <= self.arena.len()
            && offset.is_multiple_of(F::Node::ALIGN);
        // SAFETY: nodes are any bytes, and these lie inside of the blocks, aligned, as was just asked.
        fits.then(|| unsafe { self.arena.get(offset) })
    }
}
