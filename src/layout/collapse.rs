//! The collapse of the binary tree into the wide tree.
//!
//! The plan of the collapse (`collapse_cost`) selects the children of each wide node.
//! Then the first phase places every block (a node or a leaf) in memory, and the second
//! phase writes the blocks.

use super::buffers::Buffers;
use super::collapse_cost::Plan;
use super::node_arena::NodeArena;
use super::shape::{Contents, Kind, Shape};
use super::wide::{MAX_STACK, Reference};
use crate::geometry::{Aabb, Scalar};
use crate::leaf::LEAF_WIDTH;
use crate::memory::Word;
use crate::parallel;
use crate::tree::{Child, MAX_DEPTH, Tree};
use alloc::vec::Vec;
use core::ops::Range;

/// The nodes and leaves of a wide tree, and the reference of its root.
pub struct Collapsed {
    pub(super) arena: NodeArena,
    pub(super) root: Option<Reference>,
}

/// The maximum number of primitives in a subtree that is a section of its own.
///
/// It is small enough to keep threads evenly busy.
const SECTION: u32 = 1 << 12;

/// The prefetch distance for primitives, in blocks.
const AHEAD: usize = 4;

/// A node or a leaf to write, in the order of the memory.
///
/// The type is small, because every node and every leaf has one.
struct Block {
    kind: Kind,
    /// The number of children (at most 16), or the number of slots.
    count: u8,
    /// The first child, by its index in the section's children, or the first slot.
    first: u32,
}

impl Block {
    fn new(kind: Kind, range: Range<usize>) -> Self {
        Self { kind, count: range.len() as u8, first: range.start as u32 }
    }

    fn range(&self) -> Range<usize> {
        self.first as usize..self.first as usize + usize::from(self.count)
    }
}

/// The blocks of the top of the tree or of a subtree, in the order of the memory.
struct Section<S> {
    /// The offset of the section in the arena, in bytes.
    start: usize,
    /// The size of the section, in bytes.
    bytes: usize,
    arena: Vec<Block>,
    /// The children of all nodes of the section, node after node.
    ///
    /// Offsets of blocks count from the start of the section.
    children: Vec<(Aabb<S>, Reference)>,
}

/// The places of all blocks.
struct Arrangement<S> {
    sections: Vec<Section<S>>,
    root: Option<Reference>,
}

/// A binary node or a large leaf that is to become a wide node.
struct Open<S> {
    child: Child,
    aabb: Aabb<S>,
    /// The index in the section's children, or `None` for the section's first node.
    place: Option<usize>,
    depth: usize,
    /// The maximum number of deferred children when the node is visited.
    pending: usize,
}

/// The reason why a collapse fails.
enum Failure {
    /// References cannot address all blocks or slots.
    TooLarge,
    /// A path is too long, or leaves too many deferred children.
    TooDeep,
}

/// A function that selects the children of the wide node made from a binary node.
type RootsOf<'p, S> = &'p (dyn Fn(usize, &mut Vec<(Child, Aabb<S>)>) + Sync);

/// Returns the wide tree with up to `N` children per node.
///
/// Returns `None` if references cannot address all blocks or slots.
///
/// No path through the wide tree leaves more than [`MAX_STACK`] deferred children or is longer than
/// [`MAX_DEPTH`]. The cheapest collapse may have such a path, for example in the tree of a hostile
/// heuristic. Then the tree is collapsed by levels instead. A path of at most `MAX_DEPTH` binary
/// nodes becomes a path of `MAX_DEPTH / log2(N)` wide nodes, and each of them leaves N - 1 deferred
/// children. A leaf of 2^32 primitives adds at most 30 / log2(N) nodes to the path.
pub fn collapse<S: Scalar, const N: usize>(
    tree: &Tree<S>,
    contents: &dyn Contents<S>,
    shape: &Shape<S>,
    buffers: &mut Buffers,
) -> Option<Collapsed> {
    const { assert!((MAX_DEPTH + 30).div_ceil(N.ilog2() as usize) * (N - 1) <= MAX_STACK) }
    let plan = Plan::<S, N>::new(tree, shape.cost, buffers.words());
    let work = Work { plan, contents, shape };
    let arrangement = match work.arrange(&|node, roots| work.plan.cheapest(node, roots)) {
        Err(Failure::TooDeep) => work.arrange(&|node, roots| work.plan.by_levels(node, roots)),
        other => other,
    };
    let Arrangement { sections, root } = arrangement.ok()?;
    let memory = |len| buffers.words_for(len);
    Some(Collapsed { arena: fill(&sections, tree, contents, shape, memory), root })
}

/// The inputs of a collapse, which never change.
struct Work<'w, S, const N: usize> {
    plan: Plan<'w, S, N>,
    contents: &'w dyn Contents<S>,
    shape: &'w Shape<S>,
}

impl<S: Scalar, const N: usize> Work<'_, S, N> {
    /// Places every block: first the top, then the subtrees.
    ///
    /// Each of these subtrees is a section of its own.
    fn arrange(&self, roots_of: RootsOf<'_, S>) -> Result<Arrangement<S>, Failure> {
        let plan = &self.plan;
        let mut top = Section::with_capacity(0);
        let Some(child) = plan.tree.root() else {
            return Ok(Arrangement { sections: Vec::new(), root: None });
        };
        if plan.is_leaf(child, &plan.tree.aabb) {
            let root = top.leaf(plan.slots(child), self.shape)?;
            return Ok(Arrangement { sections: alloc::vec![top], root: Some(root) });
        }
        let root = Open { child, aabb: plan.tree.aabb, place: None, depth: 0, pending: 0 };
        let mut subtrees = Vec::new();
        let is_small = |open: &Open<S>| !open.child.is_leaf() && plan.slots(open.child).0 <= SECTION;
        if is_small(&root) {
            subtrees.push(root);
        } else {
            top.grow(root, self, roots_of, &mut |open| {
                let (small, large) = if is_small(&open) { (Some(open), None) } else { (None, Some(open)) };
                subtrees.extend(small);
                large
            })?;
        }
        let places: Vec<_> = subtrees.iter().map(|subtree| subtree.place).collect();
        let arranged = parallel::map(subtrees, |subtree| {
            let mut section = Section::with_capacity(plan.slots(subtree.child).0 as usize / 5);
            let root = Open { place: None, ..subtree };
            section.grow(root, self, roots_of, &mut Some).map(|()| section)
        });
        let (mut sections, mut end, mut root) =
            (Vec::with_capacity(1 + places.len()), top.bytes, Reference::node(0));
        for (section, place) in arranged.into_iter().zip(places) {
            let start = end.next_multiple_of(NodeArena::ALIGN);
            let section = Section { start, ..section? };
            end = start + section.bytes;
            // A section begins with the node of its root.
            *place.map_or(&mut root, |place| &mut top.children[place].1) = Reference::node(start);
            sections.push(section);
        }
        if end > Reference::LIMIT {
            return Err(Failure::TooLarge);
        }
        sections.insert(0, top);
        Ok(Arrangement { sections, root: Some(root) })
    }
}

/// Writes every block into a new arena.
fn fill<S: Scalar>(
    sections: &[Section<S>],
    tree: &Tree<S>,
    contents: &dyn Contents<S>,
    shape: &Shape<S>,
    memory: impl FnOnce(usize) -> Vec<Word>,
) -> NodeArena {
    let ranges: Vec<_> =
        sections.iter().map(|section| section.start..section.start + section.bytes).collect();
    NodeArena::filled(memory, &ranges, &|number, part| {
        let Section { start, arena, children, .. } = &sections[number];
        let mut moved = Vec::new();
        let mut end = 0usize;
        for (place, block) in arena.iter().enumerate() {
            // Primitives are stored in the order of the input. Without the prefetch, half of the
            // time goes into waiting for them.
            if let Some(leaf) = arena.get(place + AHEAD).filter(|block| block.kind == Kind::Leaf) {
                tree.indices[leaf.range()].iter().for_each(|&index| contents.prefetch(index));
            }
            let (bytes, align) = shape.extent(block.kind);
            let offset = end.next_multiple_of(align);
            end = offset + bytes;
            match block.kind {
                Kind::Node => {
                    moved.clear();
                    moved.extend(children[block.range()].iter().map(|&(aabb, child)| {
                        let is_block = shape.has_leaves || !child.is_leaf();
                        (aabb, if is_block { child.behind(*start) } else { child })
                    }));
                    (shape.put_node)(part, offset, &moved);
                }
                Kind::Leaf => {
                    shape.put_leaf(part, offset, &tree.indices[block.range()], contents);
                }
            }
        }
    })
}

impl<S: Scalar> Section<S> {
    /// Returns an empty section with room for `arena` blocks and children.
    fn with_capacity(arena: usize) -> Self {
        let (arena, children) = (Vec::with_capacity(arena), Vec::with_capacity(arena));
        Self { start: 0, bytes: 0, arena, children }
    }

    /// Places the blocks below a node: the node, its leaves, then its inner children.
    ///
    /// The inner children follow depth first. Children for which `takes`
    /// returns `None` are left out.
    fn grow<const N: usize>(
        &mut self,
        root: Open<S>,
        work: &Work<'_, S, N>,
        roots_of: RootsOf<'_, S>,
        takes: &mut dyn FnMut(Open<S>) -> Option<Open<S>>,
    ) -> Result<(), Failure> {
        let Work { plan, contents, shape } = work;
        let mut open = alloc::vec![root];
        let (mut roots, mut sorted, mut keys) =
            (Vec::with_capacity(N), Vec::with_capacity(N), Vec::with_capacity(N));
        while let Some(Open { child, aabb, place, depth, pending }) = open.pop() {
            if depth > MAX_DEPTH || pending > MAX_STACK {
                return Err(Failure::TooDeep);
            }
            roots.clear();
            if child.is_leaf() {
                parts((child, aabb), *contents, plan.tree, N, &mut roots);
            } else {
                roots_of(child.first as usize, &mut roots);
                dissolve(&mut roots, plan);
            }
            // The roots are sorted by area, so the largest child is in the highest lane. A query
            // for any hit visits that lane first.
            sort_by_area(&roots, plan, &mut keys, &mut sorted);
            let first = self.children.len();
            let node = Block::new(Kind::Node, first..first + roots.len());
            let offset = self.push(node, shape);
            if let Some(place) = place {
                self.children[place].1 = Reference::node(offset);
            }
            for &(child, aabb) in &sorted {
                let reference = if plan.is_leaf(child, &aabb) {
                    self.leaf(plan.slots(child), shape)?
                } else {
                    let (place, pending) = (Some(self.children.len()), pending + roots.len() - 1);
                    open.extend(takes(Open { child, aabb, place, depth: depth + 1, pending }));
                    Reference::NONE
                };
                self.children.push((aabb, reference));
            }
            if self.bytes > Reference::LIMIT {
                return Err(Failure::TooLarge);
            }
        }
        Ok(())
    }

    /// Appends a block, and returns its offset in the section.
    fn push(&mut self, block: Block, shape: &Shape<S>) -> usize {
        let (bytes, align) = shape.extent(block.kind);
        let offset = self.bytes.next_multiple_of(align);
        self.bytes = offset + bytes;
        self.arena.push(block);
        offset
    }

    fn leaf(&mut self, (count, first): (u32, u32), shape: &Shape<S>) -> Result<Reference, Failure> {
        if !shape.has_leaves {
            return Reference::of_slots(first, count).ok_or(Failure::TooLarge);
        }
        let slots = first as usize..first as usize + count as usize;
        Ok(Reference::leaf(self.push(Block::new(Kind::Leaf, slots), shape)))
    }
}

/// Replaces large leaves by their leaf ranges while there is room in the node.
///
/// The leaf with the largest area is replaced first. Each replacement saves the rays a step (rays
/// take 1 % fewer steps).
fn dissolve<S: Scalar, const N: usize>(roots: &mut Vec<(Child, Aabb<S>)>, plan: &Plan<'_, S, N>) {
    loop {
        let fits = |&(place, leaf): &(usize, Child)| {
            // The number of leaf ranges is at least the number of full leaves. This test comes
            // first, because the search for the leaf ranges takes time.
            let has_room = |leaf_ranges: usize| roots.len() - 1 + leaf_ranges <= N;
            let fits = has_room(leaf.count.div_ceil(LEAF_WIDTH as u32) as usize) && {
                let leaf_ranges = plan.tree.leaf_ranges(leaf).len();
                leaf_ranges > 0 && has_room(leaf_ranges)
            };
            fits.then(|| (place, plan.area(&roots[place].1)))
        };
        let leaves = roots.iter().map(|&(root, _)| root).enumerate();
        // The only leaf range of a leaf range is the range itself. The test of the size
        // prevents another replacement.
        let large = leaves.filter(|(_, root)| root.is_leaf() && root.count as usize > LEAF_WIDTH);
        let largest = large.filter_map(|leaf| fits(&leaf)).max_by(|(_, a), (_, b)| a.total_cmp(b));
        let Some((place, _)) = largest else { return };
        let (leaf, within) = roots.swap_remove(place);
        roots.extend(leaf_ranges(plan.tree, leaf, within));
    }
}

/// Returns the leaf ranges that the build cut a leaf into, with their boxes.
///
/// There are none if the build did not cut the leaf.
fn leaf_ranges<S: Scalar>(
    tree: &Tree<S>,
    leaf: Child,
    within: Aabb<S>,
) -> impl ExactSizeIterator<Item = (Child, Aabb<S>)> {
    tree.leaf_ranges(leaf).iter().map(move |run| (run.leaf, run.aabb.within(within)))
}

/// Writes the roots to `sorted`, the smallest area first.
///
/// `keys` is scratch memory.
fn sort_by_area<S: Scalar, const N: usize>(
    roots: &[(Child, Aabb<S>)],
    plan: &Plan<'_, S, N>,
    keys: &mut Vec<u64>,
    sorted: &mut Vec<(Child, Aabb<S>)>,
) {
    keys.clear();
    // Roots of equal area stay in their order.
    let key = |(place, (_, aabb)): (u64, &(Child, Aabb<S>))| plan.area(aabb).to_ordered_bits() << 32 | place;
    keys.extend((0..).zip(roots).map(key));
    keys.sort_unstable();
    sorted.clear();
    sorted.extend(keys.iter().map(|&key| roots[key as u32 as usize]));
}

/// Appends at most `n` parts of a leaf that is too large for one block.
///
/// The parts are the leaf ranges that the build cut the leaf into. A leaf without leaf ranges is
/// divided into equal parts.
fn parts<S: Scalar>(
    (leaf, within): (Child, Aabb<S>),
    contents: &dyn Contents<S>,
    tree: &Tree<S>,
    n: usize,
    roots: &mut Vec<(Child, Aabb<S>)>,
) {
    let leaf_ranges = leaf_ranges(tree, leaf, within);
    debug_assert!(leaf_ranges.len() <= n);
    if leaf_ranges.len() > 0 {
        roots.extend(leaf_ranges);
        return;
    }
    let slots = leaf.slots();
    let size = slots.len().div_ceil(n).max(LEAF_WIDTH);
    for first in slots.clone().step_by(size) {
        let part = first..(first + size).min(slots.end);
        let aabb = part.clone().fold(Aabb::EMPTY, |aabb, slot| aabb.union(contents.aabb(tree.indices[slot])));
        roots.push((Child::leaf(part), aabb.within(within)));
    }
}
