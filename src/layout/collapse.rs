//! From the binary tree to the wide one: which nodes' children become children of one wide node, and which
//! subtrees become one leaf.
//!
//! By dynamic programming over the surface area heuristic (Ylitie, Karras and Laine, Efficient Incoherent Ray Traversal
//! on GPUs Through Compressed Wide BVHs, HPG 2017): for each binary node, the least cost of all that is below it if it
//! is represented by a forest of at most k roots, for each k below N.
//!
//! ```text
//! forest(n, 1)  = min(leaf(n), node(n))
//! forest(n, k)  = min(forest(n, k - 1), split(n, k))
//! split(n, k)   = min over j of forest(left, j) + forest(right, k - j)
//! node(n)       = area(n) * NODE + split(n, N)
//! leaf(n)       = area(n) * LEAF, if its primitives fit into one
//! ```

use super::blocks::Blocks;
use super::wide::{MAX_PENDING, NOBODY, Reference, WideNode, WideTree};
use crate::geometry::{Aabb, Scalar};
use crate::primitive::LEAF_WIDTH;
use crate::tree::{Child, MAX_DEPTH, Tree};
use alloc::vec::Vec;

/// The cost of a node, in units of a packed leaf's test.
const NODE: f32 = 1.0;
/// The cost of a leaf whose primitives are tested side by side.
const PACKED_LEAF: f32 = 0.5;
/// The cost of a primitive in a leaf that asks them one by one.
const PRIMITIVE: f32 = 0.5;

/// What the leaves of a wide tree take of the primitives.
pub(crate) trait Contents<S> {
    /// How many scalars of each primitive.
    fn operands(&self) -> usize;
    /// Writes them, for the primitive with an input index.
    fn put(&self, index: u32, operands: &mut [S]);
    /// The box of the primitive with an input index.
    fn aabb(&self, index: u32) -> Aabb<S>;
}

/// The binary tree with the costs of what it may become.
struct Plan<'t, S, const N: usize> {
    tree: &'t Tree<S>,
    /// For each inner node, by k - 1: the least cost of a forest of at most k roots below it, times the root's area.
    forests: Vec<[f32; N]>,
    /// For each inner node: primitives below it, and its first slot.
    slots: Vec<(u32, u32)>,
    /// 1 / the largest extent.
    scale: S,
    is_packed: bool,
}

impl<'t, S: Scalar, const N: usize> Plan<'t, S, N> {
    fn new(tree: &'t Tree<S>, is_packed: bool) -> Self {
        let count = tree.nodes.len();
        let (forests, slots) = (alloc::vec![[0.0; N]; count], alloc::vec![(0, 0); count]);
        let mut plan = Self { tree, forests, slots, scale: tree.aabb.area_scale(), is_packed };
        // Children come after their parents.
        for index in (0..count).rev() {
            plan.weigh(index);
        }
        plan
    }

    fn weigh(&mut self, index: usize) {
        let node = &self.tree.nodes[index];
        let [left, right] = [0, 1].map(|side| self.forest(node.children[side], node.aabb(side)));
        let [left_slots, right_slots] = node.children.map(|child| self.slots(child));
        let slots = (left_slots.0 + right_slots.0, left_slots.1.min(right_slots.1));
        let area = self.area(&node.aabb(0).union(node.aabb(1)));
        let mut forest = [f32::INFINITY; N];
        for (j, cost) in left.into_iter().enumerate() {
            for (total, other) in forest[1..].iter_mut().skip(j).zip(&right) {
                *total = total.min(cost + other);
            }
        }
        forest[0] = (area * NODE + forest[N - 1]).min(self.leaf_cost(area, slots.0));
        for k in 1..N {
            forest[k] = forest[k].min(forest[k - 1]);
        }
        self.forests[index] = forest;
        self.slots[index] = slots;
    }

    fn area(&self, aabb: &Aabb<S>) -> f32 {
        aabb.scaled_half_area(self.scale).to_f64() as f32
    }

    /// How many primitives are below, and the first slot.
    fn slots(&self, child: Child) -> (u32, u32) {
        if child.is_leaf() { (child.count, child.first) } else { self.slots[child.first as usize] }
    }

    fn leaf_cost(&self, area: f32, count: u32) -> f32 {
        if count as usize > LEAF_WIDTH {
            f32::INFINITY
        } else if self.is_packed {
            area * PACKED_LEAF
        } else {
            area * PRIMITIVE * count as f32
        }
    }

    fn forest(&self, child: Child, aabb: Aabb<S>) -> [f32; N] {
        if child.is_leaf() {
            [self.area(&aabb) * child.count.div_ceil(LEAF_WIDTH as u32) as f32; N]
        } else {
            self.forests[child.first as usize]
        }
    }

    /// The roots that stand for the children of a binary node, at most N, with their boxes.
    fn roots(&self, node: usize, roots: &mut Vec<(Child, Aabb<S>)>) {
        // What is still to be split, with how many roots it may have.
        let mut open = Vec::with_capacity(MAX_DEPTH + 1);
        self.split(node, N, &mut open);
        while let Some((child, aabb, k)) = open.pop() {
            if child.is_leaf() {
                roots.push((child, aabb));
                continue;
            }
            let forest = &self.forests[child.first as usize];
            // The fewest roots for that cost.
            let fewest = (1..=k).find(|&fewer| forest[fewer - 1] <= forest[k - 1]).unwrap_or(k);
            if fewest == 1 {
                roots.push((child, aabb));
            } else {
                self.split(child.first as usize, fewest, &mut open);
            }
        }
    }

    /// Divides k roots among the two children of a node.
    fn split(&self, node: usize, k: usize, open: &mut Vec<(Child, Aabb<S>, usize)>) {
        let node = &self.tree.nodes[node];
        let [left, right] = [0, 1].map(|side| self.forest(node.children[side], node.aabb(side)));
        let cost = |j: usize| left[j - 1] + right[k - j - 1];
        let best = (1..k).fold(1, |best, j| if cost(j) < cost(best) { j } else { best });
        open.push((node.children[1], node.aabb(1), k - best));
        open.push((node.children[0], node.aabb(0), best));
    }

    /// All that is a number of levels below a binary node, or a leaf before: as many as N has room for.
    fn level(&self, node: usize, roots: &mut Vec<(Child, Aabb<S>)>) {
        let mut open = alloc::vec![(Child::inner(node), self.tree.aabb, 0)];
        while let Some((child, aabb, depth)) = open.pop() {
            if depth == N.ilog2() || (depth > 0 && self.is_leaf(child, &aabb)) || child.is_leaf() {
                roots.push((child, aabb));
            } else {
                let node = &self.tree.nodes[child.first as usize];
                open.extend([1, 0].map(|side| (node.children[side], node.aabb(side), depth + 1)));
            }
        }
    }

    /// Whether all below a binary node is to be one leaf, if it is a root.
    fn is_leaf(&self, child: Child, aabb: &Aabb<S>) -> bool {
        let (count, _) = self.slots(child);
        count as usize <= LEAF_WIDTH
            && (child.is_leaf()
                || self.leaf_cost(self.area(aabb), count) <= self.forests[child.first as usize][0])
    }
}

/// A part of the binary tree that is to become a block.
struct Open<S> {
    child: Child,
    aabb: Aabb<S>,
    /// The parent's place and the lane, where its reference goes; none for the root.
    parent: Option<(usize, usize)>,
    depth: usize,
    /// How many children of the nodes above it may be waiting when it is visited.
    pending: usize,
}

/// Why there is no wide tree.
enum Failure {
    /// Its references cannot tell so many places apart.
    TooLarge,
    /// A path through it is too long, or leaves too many children waiting.
    TooDeep,
}

impl<S: Scalar, const N: usize> WideTree<S, N> {
    /// None if the references cannot tell so many places apart.
    ///
    /// No path through it leaves more than [`MAX_PENDING`] children behind or is longer than [`MAX_DEPTH`]: if the cheapest
    /// collapse has one, as that of a hostile heuristic's tree may, the tree is collapsed by levels instead. Then a path of
    /// at most `MAX_DEPTH` binary nodes becomes one of `MAX_DEPTH / log2(N)`, which leaves N - 1 children at each; and a
    /// leaf of 2^32 primitives adds no more than 30 / log2(N) to it.
    pub(crate) fn new(tree: &Tree<S>, contents: &impl Contents<S>) -> Option<Self> {
        const { assert!((MAX_DEPTH + 30).div_ceil(N.ilog2() as usize) * (N - 1) <= MAX_PENDING) }
        let plan = Plan::new(tree, contents.operands() > 0);
        let cheapest = |node, roots: &mut _| plan.roots(node, roots);
        let by_levels = |node, roots: &mut _| plan.level(node, roots);
        match Self::collapse(&plan, cheapest, contents) {
            Err(Failure::TooDeep) => Self::collapse(&plan, by_levels, contents).ok(),
            other => other.ok(),
        }
    }

    fn collapse(
        plan: &Plan<'_, S, N>,
        roots_of: impl Fn(usize, &mut Vec<(Child, Aabb<S>)>),
        contents: &impl Contents<S>,
    ) -> Result<Self, Failure> {
        let tree = plan.tree;
        let coordinates = [tree.aabb.min, tree.aabb.max];
        let mut wide = Self {
            blocks: Blocks::default(),
            root: None,
            aabb: tree.aabb,
            operands: contents.operands(),
            len: tree.len(),
            is_ordinary: coordinates.as_flattened().iter().all(|x| x.abs() < S::LARGE_AREA),
        };
        let Some(root) = tree.root() else { return Ok(wide) };
        let mut open = alloc::vec![Open { child: root, aabb: tree.aabb, parent: None, depth: 0, pending: 0 }];
        let mut roots = Vec::with_capacity(N);
        let mut values = alloc::vec![S::ZERO; wide.operands];
        while let Some(Open { child, aabb, parent, depth, pending }) = open.pop() {
            if depth > MAX_DEPTH || pending > MAX_PENDING {
                return Err(Failure::TooDeep);
            }
            let reference = if plan.is_leaf(child, &aabb) {
                wide.push_leaf(plan, child, contents, &mut values)
            } else {
                let offset = wide.blocks.allocate(size_of::<WideNode<S, N>>(), Self::NODE_ALIGN);
                roots.clear();
                if child.is_leaf() {
                    parts(child, contents, &tree.indices, N, &mut roots);
                } else {
                    roots_of(child.first as usize, &mut roots);
                }
                // The child to begin with in the highest lane: from there it is taken first if any hit will do.
                roots.sort_by(|(_, a), (_, b)| plan.area(a).total_cmp(&plan.area(b)));
                let mut node = WideNode::<S, N>::EMPTY;
                for (lane, &(child, aabb)) in roots.iter().enumerate() {
                    let is_leaf = plan.is_leaf(child, &aabb);
                    let reference = if is_leaf {
                        wide.push_leaf(plan, child, contents, &mut values)
                    } else {
                        Reference::NONE
                    };
                    node.put(lane, aabb, reference);
                    if !is_leaf {
                        let pending = pending + roots.len() - 1;
                        open.push(Open {
                            child,
                            aabb,
                            parent: Some((offset, lane)),
                            depth: depth + 1,
                            pending,
                        });
                    }
                }
                // SAFETY: a node is any bytes.
                *unsafe { wide.blocks.get_mut(offset) } = node;
                Reference::node(offset)
            };
            match parent {
                Some((offset, lane)) => {
                    // SAFETY: a node is any bytes.
                    let node: &mut WideNode<S, N> = unsafe { wide.blocks.get_mut(offset) };
                    node.children[lane] = reference;
                }
                None => wide.root = Some(reference),
            }
            if wide.blocks.len() > Reference::LIMIT {
                return Err(Failure::TooLarge);
            }
        }
        wide.blocks.shrink_to_fit();
        Ok(wide)
    }

    /// Rows of planes that are as long as a line begin with one.
    const NODE_ALIGN: usize = if size_of::<[S; N]>() >= 64 { 64 } else { 32 };

    fn push_leaf(
        &mut self,
        plan: &Plan<'_, S, N>,
        child: Child,
        contents: &impl Contents<S>,
        values: &mut [S],
    ) -> Reference {
        let rows = Self::operand_bytes(self.operands);
        let align = if self.operands > 0 { size_of::<[S; LEAF_WIDTH]>().min(64) } else { 32 };
        let offset = self.blocks.allocate(rows + size_of::<[u32; LEAF_WIDTH]>(), align);
        let (count, first) = plan.slots(child);
        let slots = first as usize..first as usize + count as usize;
        let mut indices = [NOBODY; LEAF_WIDTH];
        indices[..slots.len()].copy_from_slice(&plan.tree.indices[slots]);
        for (lane, &index) in indices.iter().enumerate() {
            if index == NOBODY {
                values.fill(S::from_f64(f64::NAN));
            } else {
                contents.put(index, values);
            }
            for (row, &value) in values.iter().enumerate() {
                // SAFETY: scalars are any bytes.
                let row: &mut [S; LEAF_WIDTH] =
                    unsafe { self.blocks.get_mut(offset + Self::operand_bytes(row)) };
                row[lane] = value;
            }
        }
        // SAFETY: indices are any bytes.
        *unsafe { self.blocks.get_mut(offset + rows) } = indices;
        Reference::leaf(offset)
    }
}

/// A leaf too large for one block, as at most `n` equal parts.
fn parts<S: Scalar>(
    leaf: Child,
    contents: &impl Contents<S>,
    indices: &[u32],
    n: usize,
    roots: &mut Vec<(Child, Aabb<S>)>,
) {
    let slots = leaf.slots();
    let size = slots.len().div_ceil(n).max(LEAF_WIDTH);
    for first in slots.clone().step_by(size) {
        let part = first..(first + size).min(slots.end);
        let aabb = part.clone().fold(Aabb::EMPTY, |aabb, slot| aabb.union(contents.aabb(indices[slot])));
        roots.push((Child::leaf(part), aabb));
    }
}
