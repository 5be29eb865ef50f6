//! The wide tree: nodes of up to N children, whose boxes are tested all at once, and leaves whose primitives
//! lie side by side.
//!
//! ```text
//! blocks: | node | leaf leaf leaf | node | leaf ... |      depth first, leaves right behind their node
//! node:   planes of N children: x min, x max, y min, y max, z min, z max; N references
//! leaf:   operands of 8 primitives, row by row; their 8 indices
//! ```
//!
//! The ray's sign chooses between rows of minima and of maxima, as an address. Children that there are not
//! have boxes that no ray meets, primitives that there are not have operands NaN.

use super::blocks::Blocks;
use crate::geometry::{Aabb, Scalar};
use crate::primitive::LEAF_WIDTH;
use crate::simd::Window;
use crate::tree::TreeReport;
use core::fmt;

/// Where a block lies: its offset in units of 8 bytes, and bit 31 for leaves.
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
    pub(super) const LIMIT: usize = (Self::LEAF as usize).saturating_mul(Blocks::UNIT);

    /// None yet.
    pub(super) const NONE: Self = Self(0);

    pub fn node(offset: usize) -> Self {
        Self((offset / Blocks::UNIT) as u32)
    }

    pub fn leaf(offset: usize) -> Self {
        Self((offset / Blocks::UNIT) as u32 | Self::LEAF)
    }

    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    #[inline(always)]
    fn offset(self) -> usize {
        (self.0 & !Self::LEAF) as usize * Blocks::UNIT
    }
}

/// An inner node.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct WideNode<S, const N: usize> {
    /// By axis; minima, then maxima.
    pub planes: [[[S; N]; 2]; 3],
    pub children: [Reference; N],
}

const _: () = assert!(size_of::<WideNode<f32, 16>>() == 448 && size_of::<WideNode<f64, 16>>() == 832);
const _: () = assert!(size_of::<WideNode<f32, 8>>() == 224 && size_of::<WideNode<f64, 8>>() == 416);

impl<S: Scalar, const N: usize> WideNode<S, N> {
    /// A node without children.
    pub const EMPTY: Self =
        Self { planes: [[[S::INFINITY; N], [S::NEG_INFINITY; N]]; 3], children: [Reference::NONE; N] };

    pub fn put(&mut self, lane: usize, aabb: Aabb<S>, child: Reference) {
        for axis in 0..3 {
            self.planes[axis][0][lane] = aabb.min[axis];
            self.planes[axis][1][lane] = aabb.max[axis];
        }
        self.children[lane] = child;
    }

    /// The box and the place of a child; none if there is none in this lane.
    pub fn child(&self, lane: usize) -> Option<(Aabb<S>, Reference)> {
        let aabb =
            Aabb { min: self.planes.map(|axis| axis[0][lane]), max: self.planes.map(|axis| axis[1][lane]) };
        (!aabb.is_empty()).then_some((aabb, self.children[lane]))
    }
}

/// The layout for speed: a tree of nodes with up to `N` children, 4, 8 or 16, whose boxes are tested all at once, and of
/// leaves of up to 8 primitives, side by side if their type has a [`Leaf`](crate::Leaf) of its own.
///
/// At most 16 GiB. On 279,163 triangles of sponza it takes 63 bytes a triangle.
///
/// 16 is the best that was found, with AVX-512 and with AVX2: see the README.
///
/// Every reference that can be reached from the root refers to a node or a leaf inside of the blocks: only
/// `layout::collapse` writes any, for blocks that it has allocated.
#[derive(Clone)]
pub struct WideTree<S = f32, const N: usize = 16> {
    pub(super) blocks: Blocks,
    /// None for an empty tree.
    pub(super) root: Option<Reference>,
    pub(super) aabb: Aabb<S>,
    /// How many scalars of each primitive lie in its leaf.
    pub(super) operands: usize,
    /// Primitives in leaves.
    pub(super) len: usize,
    /// The same, each as often as it is in a leaf.
    pub(super) references: usize,
    /// All coordinates are below `Scalar::LARGE_AREA`.
    pub(super) is_ordinary: bool,
}

/// A leaf.
#[derive(Clone, Copy)]
pub(crate) struct LeafBlock<'a, S> {
    /// A row for each operand.
    pub operands: &'a [[S; LEAF_WIDTH]],
    /// The input's indices of the primitives, [`NOBODY`] where there is none.
    pub indices: &'a [u32; LEAF_WIDTH],
}

/// No path through a tree leaves more children behind.
pub(crate) const MAX_PENDING: usize = 448;

/// No primitive has this index.
pub(crate) const NOBODY: u32 = u32::MAX;

/// The same nodes and leaves in the same places.
impl<S: Scalar, const N: usize> PartialEq for WideTree<S, N> {
    fn eq(&self, other: &Self) -> bool {
        self.root == other.root
            && self.aabb == other.aabb
            && self.blocks.as_bytes() == other.blocks.as_bytes()
    }
}

impl<S: Scalar, const N: usize> fmt::Debug for WideTree<S, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("WideTree").field("report", &TreeReport::new(self)).finish_non_exhaustive()
    }
}

impl<S: Scalar, const N: usize> WideTree<S, N> {
    /// The bytes of a leaf's operands.
    pub(super) const fn operand_bytes(operands: usize) -> usize {
        operands * size_of::<[S; LEAF_WIDTH]>()
    }

    /// See [`Leaf::suits`](crate::Leaf).
    #[inline(always)]
    pub(crate) fn is_ordinary(&self) -> bool {
        self.is_ordinary
    }

    #[inline(always)]
    pub(crate) fn node(&self, reference: Reference) -> &WideNode<S, N> {
        // SAFETY: scalars and references are any bytes, and a node lies there: see the type.
        unsafe { self.blocks.get(reference.offset()) }
    }

    /// Asks for a node or a leaf to be brought into the cache.
    #[inline(always)]
    pub(crate) fn prefetch(&self, reference: Reference) {
        self.blocks.prefetch(reference.offset(), size_of::<WideNode<S, N>>());
    }

    /// `operands` is the tree's, known to the compiler.
    #[inline(always)]
    pub(crate) fn leaf(&self, reference: Reference, operands: usize) -> LeafBlock<'_, S> {
        debug_assert_eq!(self.operands, operands);
        let offset = reference.offset();
        // SAFETY: scalars and indices are any bytes, and a leaf lies there: see the type. It begins with its
        // operands' rows, and its indices follow them.
        unsafe {
            LeafBlock {
                operands: self.blocks.get_slice(offset, operands),
                indices: self.blocks.get(offset + Self::operand_bytes(operands)),
            }
        }
    }
}
