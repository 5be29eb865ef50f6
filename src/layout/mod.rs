//! The memory that queries walk, made from the binary tree.

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

/// Children of a node. The code is generic over it; kernels are compiled for this one.
pub(crate) const WIDTH: usize = 16;

/// How a hierarchy lies in memory: [`WideTree`], the default, for speed; [`CompactTree`], for few bytes; [`Tree`], as it was
/// built.
///
/// A type parameter of [`Bvh`](crate::Bvh), chosen by [`Builder::layout`](crate::Builder::layout). What is not chosen
/// is not linked. Answers are the same bits in all.
pub trait Layout<P: Primitive>: Outline<P::Scalar> + Send + Sized {
    /// How many primitives a leaf tests at once.
    #[doc(hidden)]
    const BLOCK_SIZE: usize;

    /// Into how many leaves it divides a large one of the tree that has runs.
    #[doc(hidden)]
    const LEAF_RANGES: usize;

    /// How many bytes are reserved for each primitive, if it may take more than references do.
    #[doc(hidden)]
    const RESERVE: usize;

    /// Lays out a tree over the primitives with its indices, and takes from it what is kept.
    #[doc(hidden)]
    fn lay_out(tree: &mut Tree<P::Scalar>, primitives: &[P], buffers: &mut Buffers) -> Option<Self>;

    /// Gives back memory that it does not need.
    #[doc(hidden)]
    fn shrink(&mut self);

    /// Leaves its memory to the next, what was taken from a tree as one.
    #[doc(hidden)]
    fn recycle(self, buffers: &mut Buffers) -> Tree<P::Scalar>;
}

/// What there is to know about any hierarchy without a ray.
#[doc(hidden)]
pub trait Outline<S: Scalar> {
    /// Where a node or a leaf lies.
    type Place: Copy;
    /// None if it is empty.
    fn root(&self) -> Option<Self::Place>;
    /// The box around everything.
    fn aabb(&self) -> Aabb<S>;
    /// Primitives in leaves.
    fn len(&self) -> usize;
    /// The same, each as often as it is in a leaf.
    fn references(&self) -> usize;
    /// Bytes of memory.
    fn bytes(&self) -> usize;
    /// Shows what is in a place, one by one. False if there is no such place.
    fn open(&self, place: Self::Place, show: impl FnMut(Part<S, Self::Place>)) -> bool;
}

impl<S, B> Part<S, B> {
    /// The place of a child.
    pub fn child(self) -> Option<B> {
        match self {
            Self::Child(_, place) => Some(place),
            Self::Primitive(_) => None,
        }
    }
}

/// What is in a node or in a leaf.
#[doc(hidden)]
pub enum Part<S, B> {
    /// A child with its box.
    Child(Aabb<S>, B),
    /// A primitive, by its index in the input.
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
    /// Where operands have to be gathered first, each counts.
    const BLOCK_SIZE: usize =
        if F::COPIES && <P::Leaf as LeafKind<_, P::Payload>>::OPERANDS > 0 { LEAF_WIDTH } else { 1 };
    const LEAF_RANGES: usize = WIDTH;
    /// Bytes for leaves of five primitives, and for nodes whose children have eight each: the maximum
    /// of split trees in the scenes of `docs/building.md`. The build returns unused bytes.
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

    /// Every place that a reference can tell of, and the ends of the range, opened in small trees: nothing beyond their memory is read.
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
