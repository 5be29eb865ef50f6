//! The layouts that queries traverse, made from the binary tree.

mod buffers;
mod collapse;
mod collapse_cost;
mod compact;
mod compiled;
mod encoding;
mod node_arena;
mod packed;
mod quantize;
mod shape;
mod wide;

pub use buffers::Buffers;
pub use collapse::{Collapsed, collapse};
pub(crate) use compact::Compact;
pub use compiled::CompiledLayout;
pub(crate) use encoding::{Encoding, Node as WideNode};
pub(crate) use packed::Packed;
pub use shape::{Contents, Shape};
pub use wide::{CompactTree, WideTree};
pub(crate) use wide::{MAX_STACK, NO_PRIMITIVE, Reference};

use crate::geometry::{Aabb, Scalar, ScalarParts};
use crate::leaf::sealed::LeafKind;
use crate::leaf::{LEAF_WIDTH, Primitives, PutOperands};
use crate::primitive::{Intersect, Primitive};
use crate::simd::prefetch;
use crate::tree::{Child, Node, Tree};
use core::mem::take;

/// The maximum number of children of a node.
///
/// The code is generic over this number. Kernels are compiled for this value alone.
pub(crate) const WIDTH: usize = 16;

/// The arrangement of a hierarchy in memory.
///
/// [`WideTree`], the default, is for speed. [`CompactTree`] is for few bytes. [`Tree`] is
/// the tree as it was built.
///
/// The layout is a type parameter of [`Bvh`](crate::Bvh).
/// [`Builder::layout`](crate::Builder::layout) chooses it. The code of the other layouts is not
/// linked. All layouts give the same answers, bit for bit.
pub trait Layout<P: Primitive>: Outline<P::Scalar> + Send + Sized {
    /// The number of primitives that a leaf tests at once.
    #[doc(hidden)]
    const BLOCK_SIZE: usize;

    /// The maximum number of leaf ranges in a large leaf of the binary tree.
    ///
    /// It is 1 if the layout does not divide leaves.
    #[doc(hidden)]
    const LEAF_RANGES: usize;

    /// The number of bytes to reserve for each primitive.
    ///
    /// It is 0 for a layout that takes no more than the references of the build.
    #[doc(hidden)]
    const RESERVE: usize;

    /// Lays out a tree, whose indices refer to `primitives`.
    ///
    /// Takes from the tree the buffers that the layout keeps. Returns `None` if the tree is too
    /// large for the layout's references.
    #[doc(hidden)]
    fn lay_out(tree: &mut Tree<P::Scalar>, primitives: &[P], buffers: &mut Buffers) -> Option<Self>;

    /// Frees the memory that the layout does not need.
    #[doc(hidden)]
    fn shrink(&mut self);

    /// Leaves the memory of the layout to the next build.
    ///
    /// Buffers that came from a tree return as a tree. The others go to `buffers`.
    #[doc(hidden)]
    fn recycle(self, buffers: &mut Buffers) -> Tree<P::Scalar>;
}

/// The structure of a hierarchy, for code that traces no rays.
#[doc(hidden)]
pub trait Outline<S: Scalar> {
    /// The position of a node or a leaf.
    type Place: Copy;
    /// Returns the place of the root, or `None` if the hierarchy is empty.
    fn root(&self) -> Option<Self::Place>;
    /// Returns the box around all primitives.
    fn aabb(&self) -> Aabb<S>;
    /// Returns the number of primitives in leaves.
    fn len(&self) -> usize;
    /// Returns the number of entries in all leaves.
    ///
    /// A primitive counts once for each leaf that holds it.
    fn references(&self) -> usize;
    /// Returns the memory that the hierarchy takes, in bytes.
    fn bytes(&self) -> usize;
    /// Calls `show` with each item of a node or a leaf.
    ///
    /// Returns false if the hierarchy has no such place.
    fn open(&self, place: Self::Place, show: impl FnMut(Part<S, Self::Place>)) -> bool;
}

impl<S, B> Part<S, B> {
    /// Returns the place of a child, or `None` for a primitive.
    pub fn child(self) -> Option<B> {
        match self {
            Self::Child(_, place) => Some(place),
            Self::Primitive(_) => None,
        }
    }
}

/// An item of a node or a leaf.
#[doc(hidden)]
pub enum Part<S, B> {
    /// A child: its box and its place.
    Child(Aabb<S>, B),
    /// A primitive: its index in the input.
    Primitive(u32),
}

impl<S: Scalar> Outline<S> for Tree<S> {
    type Place = Child;

    fn root(&self) -> Option<Child> {
        Tree::root(self)
    }
    fn aabb(&self) -> Aabb<S> {
        self.aabb
    }
    fn len(&self) -> usize {
        self.primitives
    }
    fn references(&self) -> usize {
        self.indices.len()
    }
    fn bytes(&self) -> usize {
        self.memory_bytes()
    }
    fn open(&self, place: Child, show: impl FnMut(Part<S, Child>)) -> bool {
        if place.is_leaf() {
            let indices = self.indices.get(place.slots());
            indices.map(|indices| indices.iter().copied().map(Part::Primitive).for_each(show)).is_some()
        } else {
            let node = self.nodes.get(place.first as usize);
            let child = |node: &Node<S>, side: usize| Part::Child(node.aabb(side), node.children[side]);
            node.map(|node| [0, 1].map(|side| child(node, side)).into_iter().for_each(show)).is_some()
        }
    }
}

impl<P: Primitive> Layout<P> for Tree<P::Scalar> {
    const BLOCK_SIZE: usize = 1;
    const LEAF_RANGES: usize = 1;
    const RESERVE: usize = 0;

    fn lay_out(tree: &mut Self, _: &[P], _: &mut Buffers) -> Option<Self> {
        Some(take(tree))
    }

    fn shrink(&mut self) {}

    fn recycle(self, _: &mut Buffers) -> Self {
        self
    }
}

impl<S: Scalar, const N: usize, F: Encoding<S, N>> Outline<S> for WideTree<S, N, F> {
    type Place = Reference;

    fn root(&self) -> Option<Reference> {
        self.root
    }
    fn aabb(&self) -> Aabb<S> {
        self.aabb
    }
    fn len(&self) -> usize {
        self.len
    }
    fn references(&self) -> usize {
        self.references
    }
    fn bytes(&self) -> usize {
        self.arena.bytes() + self.encoding.bytes()
    }
    fn open(&self, place: Reference, show: impl FnMut(Part<S, Reference>)) -> bool {
        if place.is_leaf() {
            let Some(indices) = F::indices_at(self, place) else { return false };
            let indices = indices.iter().copied().enumerate();
            let indices = indices.filter(|&(lane, index)| F::has(place, lane, index));
            indices.map(|(_, index)| Part::Primitive(index)).for_each(show);
        } else {
            let Some(node) = self.node_at(place) else { return false };
            let children = (0..N).filter_map(|lane| node.child(lane));
            children.map(|(aabb, place)| Part::Child(aabb, place)).for_each(show);
        }
        true
    }
}

impl<P: Intersect, F: Encoding<P::Scalar, WIDTH>> Layout<P> for WideTree<P::Scalar, WIDTH, F> {
    /// 8 for packed leaves with operands, else 1.
    ///
    /// Where operands have to be gathered first, each primitive costs time.
    const BLOCK_SIZE: usize =
        if F::COPIES && <P::Leaf as LeafKind<_, P::Payload>>::OPERANDS > 0 { LEAF_WIDTH } else { 1 };
    const LEAF_RANGES: usize = WIDTH;
    /// Bytes per primitive, if leaves hold five and children of nodes hold eight each.
    ///
    /// In the scenes of `docs/building.md`, trees that are built by splits take no more bytes than
    /// these. The build frees unused bytes.
    const RESERVE: usize = if <Self as Layout<P>>::BLOCK_SIZE > 1 {
        let leaf = <P::Leaf as LeafKind<_, P::Payload>>::OPERANDS * size_of::<[P::Scalar; LEAF_WIDTH]>()
            + size_of::<[u32; LEAF_WIDTH]>();
        leaf / 5 + size_of::<F::Node>() / (8 * WIDTH)
    } else {
        0
    };

    fn lay_out(tree: &mut Tree<P::Scalar>, primitives: &[P], buffers: &mut Buffers) -> Option<Self> {
        let operands = <P::Leaf as LeafKind<_, P::Payload>>::OPERANDS;
        let shape = Shape::of::<WIDTH, F>(operands);
        let Collapsed { arena, root } = P::Scalar::collapse(tree, &primitives, &shape, buffers)?;
        let Tree { aabb, .. } = *tree;
        let (len, references) = (tree.len(), tree.indices.len());
        let encoding = F::new(&mut tree.indices, operands);
        let coordinates = [aabb.min, aabb.max];
        let is_ordinary = coordinates.as_flattened().iter().all(|x| x.abs() < P::Scalar::LARGE_AREA);
        Some(Self { arena, root, aabb, len, references, encoding, is_ordinary })
    }

    fn shrink(&mut self) {
        self.arena.shrink();
    }

    fn recycle(self, buffers: &mut Buffers) -> Tree<P::Scalar> {
        buffers.keep_words(self.arena.into_words());
        Tree { indices: self.encoding.into_indices(), ..Tree::default() }
    }
}

impl<P: Intersect> Contents<P::Scalar> for &[P] {
    fn put(&self, indices: &[u32], rows: &mut [[P::Scalar; LEAF_WIDTH]]) {
        Primitives(self).put_rows(indices, rows);
    }
    fn aabb(&self, index: u32) -> Aabb<P::Scalar> {
        self[index as usize].aabb()
    }
    fn prefetch(&self, index: u32) {
        let primitive = self.as_ptr().wrapping_add(index as usize).cast();
        prefetch(primitive, size_of::<P>().min(128));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Bvh, Sphere};

    /// Opens the first and the last places of the range of references, in small trees.
    ///
    /// No read leaves the memory of the tree.
    #[test]
    fn any_place_can_be_opened_in_any_tree() {
        fn open<L: Layout<Sphere> + Outline<f32, Place = Reference>>(count: u8) {
            let spheres = (0..count).map(|i| Sphere::new([f32::from(i), 0.0, 0.0], 0.3));
            let bvh = Bvh::builder().layout::<L>().build(spheres.collect::<alloc::vec::Vec<_>>()).unwrap();
            let (mut opened, end) = (0, u32::MAX as usize * 8);
            for offset in (0..1 << 14).step_by(8).chain((end - (1 << 12)..=end).step_by(8)) {
                for place in [Reference::node(offset), Reference::leaf(offset)] {
                    opened += usize::from(bvh.layout().open(place, |_| ()));
                }
            }
            assert!(count == 0 || opened > 0);
        }
        for count in [0, 1, 100] {
            open::<WideTree>(count);
            open::<CompactTree>(count);
        }
    }
}
