//! The memory that queries walk, made from the binary tree.

mod blocks;
mod buffers;
mod collapse;
mod compact;
mod form;
mod grid;
mod packed;
mod plan;
mod wide;

pub(crate) use buffers::Buffers;
pub(crate) use collapse::Contents;
pub(crate) use form::{Form, Node as WideNode};
#[cfg(test)]
pub(crate) use packed::Packed;
pub use wide::{CompactTree, WideTree};
pub(crate) use wide::{MAX_PENDING, Reference};

use crate::geometry::{Aabb, Scalar};
use crate::primitive::{Intersect, LEAF_WIDTH, Leaf, Primitive};
use crate::simd::{Count, Width, prefetch};
use crate::tree::{Child, Node, Tree};
use alloc::vec::Vec;
use core::mem::take;

/// How a hierarchy lies in memory: [`WideTree`], the default, for speed; [`CompactTree`], for few bytes; [`Tree`], as it was
/// built.
///
/// A type parameter of [`Bvh`](crate::Bvh), chosen by [`Builder::layout`](crate::Builder::layout). What is not chosen
/// is not compiled. Answers are the same bits in all.
pub trait Layout<P: Primitive>: Outline<P::Scalar> + Send + Sized {
    /// How many primitives a leaf tests at once.
    #[doc(hidden)]
    const BLOCK_SIZE: usize;

    /// Into how many leaves it divides a large one of the tree that has runs.
    #[doc(hidden)]
    const RUNS: usize;

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
    const RUNS: usize = 1;
    const RESERVE: usize = 0;

    fn lay_out(tree: &mut Self, _: &[P], _: &mut Buffers) -> Option<Self> {
        Some(take(tree))
    }

    fn shrink(&mut self) {}

    fn recycle(self, _: &mut Buffers) -> Self {
        self
    }
}

impl<S: Scalar, const N: usize, F: Form<S, N>> Outline<S> for WideTree<S, N, F> {
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
        self.blocks.bytes() + self.form.bytes()
    }
    fn open(&self, place: Reference, show: impl FnMut(Part<S, Reference>)) -> bool {
        if place.is_leaf() {
            let indices = F::indices(self, place, self.form.operands()).iter().copied().enumerate();
            let indices = indices.filter(|&(lane, index)| F::has(place, lane, index));
            indices.map(|(_, index)| Part::Primitive(index)).for_each(show);
        } else {
            let node = self.node(place);
            let children = (0..N).filter_map(|lane| node.child(lane));
            children.map(|(aabb, place)| Part::Child(aabb, place)).for_each(show);
        }
        true
    }
}

impl<P: Intersect, const N: usize, F: Form<P::Scalar, N>> Layout<P> for WideTree<P::Scalar, N, F>
where
    Count<N>: Width,
{
    /// Where operands have to be gathered first, each counts.
    const BLOCK_SIZE: usize = if F::COPIES && <P::Leaf as Leaf<_, _>>::OPERANDS > 0 { LEAF_WIDTH } else { 1 };
    const RUNS: usize = N;
    /// For leaves of five primitives, and nodes whose children have eight each: what trees of splits take at the most in the README's
    /// scenes. What is not needed goes back.
    const RESERVE: usize = if <Self as Layout<P>>::BLOCK_SIZE > 1 {
        let leaf = <P::Leaf as Leaf<_, P::Payload>>::OPERANDS * size_of::<[P::Scalar; LEAF_WIDTH]>()
            + size_of::<[u32; LEAF_WIDTH]>();
        leaf / 5 + size_of::<F::Node>() / (8 * N)
    } else {
        0
    };

    fn lay_out(tree: &mut Tree<P::Scalar>, primitives: &[P], buffers: &mut Buffers) -> Option<Self> {
        Self::new(tree, &primitives, buffers)
    }

    fn shrink(&mut self) {
        self.blocks.shrink();
    }

    fn recycle(self, buffers: &mut Buffers) -> Tree<P::Scalar> {
        buffers.keep_words(self.blocks.into_words());
        Tree { indices: self.form.into_indices(), ..Tree::default() }
    }
}

impl<P: Intersect> Contents<P::Scalar> for &[P] {
    fn operands(&self) -> usize {
        <P::Leaf as Leaf<_, _>>::OPERANDS
    }
    fn put(&self, indices: &[u32], rows: &mut [[P::Scalar; LEAF_WIDTH]]) {
        // Of a size that the compiler knows, so that few operands stay in registers on their way: through memory, where they are
        // written in parts of one size and read in parts of another, a quick build took a fifteenth longer.
        let (mut few, mut many) = ([P::Scalar::ZERO; 16], Vec::new());
        let values = few.get_mut(..<P::Leaf as Leaf<_, _>>::OPERANDS).unwrap_or_else(|| {
            many.resize(<P::Leaf as Leaf<_, _>>::OPERANDS, P::Scalar::ZERO);
            &mut many
        });
        for (lane, &index) in indices.iter().enumerate() {
            self[index as usize].put_operands(values);
            for (row, &value) in rows.iter_mut().zip(&*values) {
                row[lane] = value;
            }
        }
        for row in rows {
            row[indices.len()..].fill(P::Scalar::from_f64(f64::NAN));
        }
    }
    fn aabb(&self, index: u32) -> Aabb<P::Scalar> {
        self[index as usize].aabb()
    }
    fn prefetch(&self, index: u32) {
        let primitive = self.as_ptr().wrapping_add(index as usize).cast();
        prefetch(primitive, size_of::<P>().min(128));
    }
}
