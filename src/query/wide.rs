//! The traversal loop of the wide trees.
//!
//! ```text
//! step: an inner node tests the boxes of all its children at once
//!         none met   pop
//!         one met    it is next
//!         more met   the nearest is next, the others go on the stack by entry distance, the nearest on top;
//!                    if any hit will do, they go there as they lie in the node, and the last is next
//!       a leaf tests its primitives, all at once if they are packed, then pop
//! pop:  entries beyond the visitor's limit, which may have shrunk since, are dropped
//! ```

use super::ahead::Ahead;
use super::children::{Distances, last, nearest, next_lane};
use super::counters::Recorder;
use super::pending::{Memory, Pending};
use super::slab_lanes::SlabLanes;
use super::{Traverse, Visitor, flights};
use crate::geometry::{PreparedRay, Ray, Scalar, Shear};
use crate::layout::{Form, Outline, Reference, WideNode, WideTree};
use crate::primitive::{Found, Intersect, LEAF_WIDTH, Leaf, Operands};
use crate::simd::{Count, Kept, Lanes, Width};
use core::ops::ControlFlow;
use fearless_simd::Simd;

impl<P: Intersect, const N: usize, F: Form<P::Scalar, N>> Traverse<P> for WideTree<P::Scalar, N, F>
where
    Count<N>: Width,
{
    const IS_WIDE: bool = true;

    #[inline(always)]
    fn traverse<I: Simd>(
        &self,
        isa: I,
        prepared: &PreparedRay<P::Scalar>,
        ray: &Ray<P::Scalar>,
        visitor: &mut impl Visitor<P>,
        recorder: &mut impl Recorder,
    ) {
        let Some(mut next) = first(self, prepared, visitor.limit()) else { return };
        // A copy: all of the prepared ray would lie in memory else.
        let shear = prepared.shear;
        let ray: WideRay<'_, _, Row<P::Scalar, I, N>> =
            WideRay::new::<P, F, N>(isa, self, prepared, ray, &shear);
        let mut memory = Memory::new();
        let mut pending = Pending::new(&mut memory, 0);
        while let Some(place) = step(isa, self, next, &ray, &mut pending, visitor, recorder) {
            next = place;
        }
    }

    #[inline(always)]
    fn open_ahead<I: Simd>(
        &self,
        isa: I,
        ray: &PreparedRay<P::Scalar>,
        primitives: &[P],
        ahead: &mut Ahead<P, Reference>,
        recorder: &mut impl Recorder,
    ) {
        let (prepared, shear) = (*ray, ray.shear);
        let ray: WideRay<'_, _, Row<P::Scalar, I, N>> =
            WideRay::new::<P, F, N>(isa, self, &prepared, ray, &shear);
        while let Some(place) = ahead.next_box() {
            if place.is_leaf() {
                recorder.leaf();
                // It goes on to the leaf's end whatever it finds.
                let visitor = &mut ahead.visitor(primitives, prepared.t_max);
                let _ = leaf::<P, _, _, _, F, N>(isa, self, place, &ray, visitor, recorder);
            } else {
                recorder.node();
                let node = self.node(place);
                let (near, mut met) = ray.lanes.enter(node, ray.ray, prepared.t_max);
                let mut entries = Distances([P::Scalar::ZERO; 16]);
                near.store(&mut entries.0);
                while met != 0 {
                    let lane = next_lane(&mut met);
                    let child = node.children()[lane % N];
                    // Most that is met will be opened, and others before it, so there is time to fetch it: all hits of
                    // 300,000 triangles take a quarter to two fifths less.
                    F::prefetch(self, child);
                    ahead.add(child, entries.0[lane % 16]);
                }
            }
        }
    }

    #[inline(always)]
    fn traverse_in_turns<'r, I: Simd, V: Visitor<P>>(
        &self,
        isa: I,
        rays: impl Iterator<Item = (usize, &'r Ray<P::Scalar>)>,
        start: impl Fn(&Ray<P::Scalar>) -> V,
        finish: impl FnMut(usize, V),
    ) {
        flights::traverse_in_turns(self, isa, rays, start, finish);
    }
}

/// Where a ray begins, if it has to.
#[inline(always)]
pub(super) fn first<S: Scalar, F: Form<S, N>, const N: usize>(
    tree: &WideTree<S, N, F>,
    ray: &PreparedRay<S>,
    limit: S,
) -> Option<Reference> {
    let root = tree.root()?;
    // The boxes of a node's children will tell whether it is met.
    if root.is_leaf() {
        // A copy, and no closure: a reference would keep the prepared ray in memory on every other way.
        let slabs = ray.slabs;
        let entry = slabs.entry(&tree.aabb())?;
        let is_met = entry <= limit;
        if !is_met {
            return None;
        }
    }
    Some(root)
}

/// A scalar for each child of a node.
pub(super) type Row<S, I, const N: usize> = <Count<N> as Width>::Lanes<S, I>;

/// A ray as the loops have it.
pub(super) struct WideRay<'r, S: Scalar, L> {
    ray: &'r Ray<S>,
    prepared: &'r PreparedRay<S>,
    /// For leaves.
    shear: Kept<'r, Shear<S>>,
    /// For nodes.
    lanes: SlabLanes<S, L>,
    /// The leaves' tests in lanes are good for it.
    suits: bool,
    /// The tree is large.
    fetches: bool,
}

impl<'r, S: Scalar, L: Lanes<S>> WideRay<'r, S, L> {
    /// `prepared` and `ray` are the same ray, and `shear` is that ray's.
    #[inline(always)]
    pub fn new<P: Intersect<Scalar = S>, F: Form<S, N>, const N: usize>(
        isa: L::Isa,
        tree: &WideTree<S, N, F>,
        prepared: &'r PreparedRay<S>,
        ray: &'r Ray<S>,
        shear: &'r Shear<S>,
    ) -> Self {
        let lanes = SlabLanes::new(isa, &prepared.slabs, ray);
        let suits = tree.is_ordinary() && <P::Leaf as Leaf<_, _>>::suits(prepared);
        Self { ray, prepared, shear: Kept::new(shear), lanes, suits, fetches: tree.is_large() }
    }

    /// For one of several rays, which have time for what they need to come.
    #[inline(always)]
    pub fn in_turns(self) -> Self {
        Self { fetches: false, ..self }
    }

    /// Asks for what will be popped next but for what the next step pushes: it has that step's time to come. On an Intel Xeon
    /// closest hits were 1.00 to 1.05 times as quick (random rays 1.04 to 1.14), any hits 0.98 to 1.05, in trees of 13 to 17 MB. In
    /// trees that the cache holds they are as much slower on a Zen 5 machine.
    #[inline(always)]
    fn fetch_top<F: Form<S, N>, const N: usize>(&self, tree: &WideTree<S, N, F>, pending: &Pending<'_, S>) {
        if self.fetches
            && let Some(place) = pending.top()
        {
            F::prefetch(tree, place);
        }
    }
}

/// Visits a place, and tells which is next, if any is.
#[inline(always)]
pub(super) fn step<P: Intersect, L, V: Visitor<P>, R: Recorder, F: Form<P::Scalar, N>, const N: usize>(
    isa: L::Isa,
    tree: &WideTree<P::Scalar, N, F>,
    place: Reference,
    ray: &WideRay<'_, P::Scalar, L>,
    pending: &mut Pending<'_, P::Scalar>,
    visitor: &mut V,
    recorder: &mut R,
) -> Option<Reference>
where
    L: Lanes<P::Scalar>,
    Count<N>: Width,
{
    if place.is_leaf() {
        recorder.leaf();
        if leaf::<P, _, _, _, F, N>(isa, tree, place, ray, visitor, recorder).is_break() {
            return None;
        }
    } else {
        recorder.node();
        let node = tree.node(place);
        let (near, met) = ray.lanes.enter(node, ray.ray, visitor.limit());
        if met != 0 {
            if met & (met - 1) == 0 {
                return Some(node.children()[met.trailing_zeros() as usize % N]);
            }
            let next = if V::IN_ORDER {
                nearest(node, near, met, ray.lanes.t_min, pending)
            } else {
                last::<_, L, N>(isa, node, met, pending)
            };
            ray.fetch_top(tree, pending);
            return Some(next);
        }
    }
    let next = if V::IN_ORDER { pending.pop_before(visitor.limit()) } else { pending.pop() };
    ray.fetch_top(tree, pending);
    next
}

#[inline(always)]
fn leaf<P: Intersect, L, V: Visitor<P>, R: Recorder, F: Form<P::Scalar, N>, const N: usize>(
    isa: L::Isa,
    tree: &WideTree<P::Scalar, N, F>,
    leaf: Reference,
    ray: &WideRay<'_, P::Scalar, L>,
    visitor: &mut V,
    recorder: &mut R,
) -> ControlFlow<()>
where
    L: Lanes<P::Scalar>,
    Count<N>: Width,
{
    let operands = <P::Leaf as Leaf<P::Scalar, P::Payload>>::OPERANDS;
    let indices = F::indices(tree, leaf, operands);
    for (lane, &index) in indices.iter().enumerate() {
        if F::has(leaf, lane, index) {
            recorder.primitive();
        }
    }
    if !F::tests_at_once(operands) {
        for (lane, &index) in indices.iter().enumerate() {
            if !F::has(leaf, lane, index) {
                break;
            }
            visitor.primitive(index, ray.prepared)?;
        }
        return ControlFlow::Continue(());
    }
    let mut room = F::room();
    let rows = F::rows(tree, leaf, visitor.primitives(), &mut room);
    let operands = Operands::<_, <Count<N> as Width>::Leaf<P::Scalar, L::Isa>>::new(isa, rows);
    let found = if ray.suits {
        // Leaves of others may have a use for all of the ray.
        if <P::Leaf as Leaf<_, _>>::SETTLES {
            // But for the axes: of those that are read again a compiler does not know that they are three at most.
            let shear = Shear { axes: ray.prepared.shear.axes, ..*ray.shear.get() };
            let prepared = PreparedRay::of_parts(ray.prepared, ray.prepared.slabs, shear);
            P::Leaf::test(&operands, &prepared, visitor.limit())
        } else {
            P::Leaf::test(&operands, ray.prepared, visitor.limit())
        }
    } else {
        let lanes = indices.iter().enumerate().rev();
        let all = lanes.fold(0, |all, (lane, &index)| all << 1 | u32::from(F::has(leaf, lane, index)));
        Found::to_be_asked(all, &operands)
    };
    if found.sure != 0 {
        visitor.found(&found, indices)?;
    }
    let mut unsure = found.unsure;
    if unsure == 0 {
        return ControlFlow::Continue(());
    }
    if <P::Leaf as Leaf<_, _>>::SETTLES {
        let (told, flow) = ask_anew(*visitor, unsure, indices, ray.ray);
        *visitor = told;
        return flow;
    }
    while unsure != 0 {
        let lane = next_lane(&mut unsure) % LEAF_WIDTH;
        // The lanes of a user's leaf may be any.
        if F::has(leaf, lane, indices[lane]) {
            visitor.primitive(indices[lane], ray.prepared)?;
        }
    }
    ControlFlow::Continue(())
}

/// Asks the primitives of some lanes about a ray that is prepared anew, with a copy of the visitor: a reference to either
/// would keep it in memory on every other way, with all that most rays do not need of a prepared one.
#[cold]
#[inline(never)]
fn ask_anew<P: Intersect, V: Visitor<P>>(
    mut visitor: V,
    mut lanes: u32,
    indices: &[u32; LEAF_WIDTH],
    ray: &Ray<P::Scalar>,
) -> (V, ControlFlow<()>) {
    let prepared = ray.prepare();
    while lanes != 0 {
        let index = indices[next_lane(&mut lanes) % LEAF_WIDTH];
        if visitor.primitive(index, &prepared).is_break() {
            return (visitor, ControlFlow::Break(()));
        }
    }
    (visitor, ControlFlow::Continue(()))
}
