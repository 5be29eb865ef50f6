//! Tables of the kernels that this crate compiles, by scalar, layout and leaf.
//!
//! Functions without type parameters are compiled in this crate, generic ones in the crate
//! that uses them. So each entry is a function of its own, made by a macro. A table is a
//! constant, from which a query takes the one function that its types name: the others do not
//! get into the user's program.
//!
//! Where speed matters most, in closest and any hits of packed trees, the leaf test is inlined. All
//! else has a loop with a dynamic call for each leaf, so that there are only as many loops as
//! layouts, scalars and instruction sets make.

use super::best_first::BestFirst;
use super::box_test::is_ordinary;
use super::lane_test::{LaneLeafTest, Wanted};
use super::leaf_call::{LeafTest, RayState};
use super::recorder::Counters;
use super::visitor::{Any, DynLeaves, Found, PackedLeaves, Query};
use super::{binary, wide};
use crate::geometry::{Ray, Scalar, Slabs};
use crate::layout::{Compact, Encoding, NO_PRIMITIVE, Packed, Reference, WIDTH, WideTree};
use crate::leaf::{FastLeaf, LaneTest, PreciseLeaf, PutOperands, SphereLeaf, WatertightLeaf};
use crate::simd::{Backend, Isa, Kernel, LeafLanes, Routine};
use crate::tree::{Child, Tree};
use core::marker::PhantomData;

/// A wide tree of one encoding.
type Wide<S, F> = WideTree<S, WIDTH, F>;

/// Kernels for leaves whose operands describe their primitives completely, in either encoding.
#[expect(clippy::type_complexity, reason = "a table of functions says what each takes")]
pub struct PackedKernels<S, F> {
    pub closest: fn(&Wide<S, F>, Backend, &dyn PutOperands<S>, &Ray<S>, &mut Found<S>),
    pub any: fn(&Wide<S, F>, Backend, &dyn PutOperands<S>, &Ray<S>) -> bool,
    /// Opens the boxes ahead of a valid ray until the next hit is known.
    pub open:
        fn(&Wide<S, F>, Backend, &dyn PutOperands<S>, &Ray<S>, &mut BestFirst<S, Reference>) -> Counters,
    /// Does the same as `closest` and `any`, and counts the steps.
    pub counted: fn(&Wide<S, F>, Backend, &dyn PutOperands<S>, &Ray<S>, IsClosest) -> (Found<S>, Counters),
}

/// Whether a query is for the closest hit, or for any.
pub type IsClosest = bool;

/// Kernels that test each leaf by a dynamic call.
#[expect(clippy::type_complexity, reason = "a table of functions says what each takes")]
pub struct DynKernels<S, L, B> {
    pub closest: fn(&L, Backend, &mut RayState<S>, &mut dyn LeafTest<S>),
    pub any: fn(&L, Backend, &mut RayState<S>, &mut dyn LeafTest<S>),
    pub open: fn(&L, Backend, &mut RayState<S>, &mut dyn LeafTest<S>, &mut BestFirst<S, B>),
}

/// All kernels for a scalar.
pub trait ScalarKernels: Sized {
    /// The kernels of packed trees, indexed by `leaf::sealed::Kernel`.
    const PACKED: [PackedKernels<Self, Packed>; 4];
    const COMPACT: [PackedKernels<Self, Compact>; 4];
    const PACKED_DYN: DynKernels<Self, Wide<Self, Packed>, Reference>;
    const COMPACT_DYN: DynKernels<Self, Wide<Self, Compact>, Reference>;
    const BINARY: DynKernels<Self, Tree<Self>, Child>;
}

/// The kernels of one encoding of wide trees.
pub trait EncodingKernels<S: Scalar>: Encoding<S, WIDTH> {
    const IN_LANES: [PackedKernels<S, Self>; 4];
    const DYN: DynKernels<S, Wide<S, Self>, Reference>;
}

impl<S: Scalar> EncodingKernels<S> for Packed {
    const IN_LANES: [PackedKernels<S, Self>; 4] = S::PACKED;
    const DYN: DynKernels<S, Wide<S, Self>, Reference> = S::PACKED_DYN;
}

impl<S: Scalar> EncodingKernels<S> for Compact {
    const IN_LANES: [PackedKernels<S, Self>; 4] = S::COMPACT;
    const DYN: DynKernels<S, Wide<S, Self>, Reference> = S::COMPACT_DYN;
}

/// A query of one ray, with the leaf test inlined.
struct Inlined<'q, S, F, T, Q, K> {
    types: PhantomData<(&'q S, F, T, Q, K)>,
}

/// The kernels with a dynamic leaf test, where `Inlined` does not run.
trait Fallback<S, F>: 'static {
    const KERNELS: PackedKernels<S, F>;
}

impl<'q, S: Scalar, F: Encoding<S, WIDTH>, T: LaneTest<S>, Q: PackedQuery<S>, K: Fallback<S, F>> Routine
    for Inlined<'q, S, F, T, Q, K>
{
    type A = &'q Wide<S, F>;
    type B = &'q dyn PutOperands<S>;
    type C = &'q Ray<S>;
    type D = Q::Room<'q>;
    type Output = Q::Answer;
    const HAS_DOUBLED: bool = !S::IS_WIDEST;

    #[inline(always)]
    fn run<I: Isa, W: LeafLanes>(
        isa: I,
        backend: Backend,
        tree: Self::A,
        put: Self::B,
        ray: Self::C,
        room: Self::D,
    ) -> Q::Answer {
        check_operands::<S, F, T>(tree);
        let is_ordinary = is_ordinary(isa, ray);
        if !tree.is_ordinary() || !(is_ordinary || suits::<S, T>(ray)) {
            return Self::run_general(backend, tree, put, ray, room);
        }
        let slabs = Slabs::new(ray);
        let mut visitor = PackedLeaves::<S, T, Q, W>::new(ray, &slabs);
        wide::traverse::<_, _, _, _, true>(isa, tree, ray, &slabs, is_ordinary, &mut visitor);
        visitor.query.answer(room)
    }

    #[cold]
    #[inline(never)]
    fn run_general(backend: Backend, tree: Self::A, put: Self::B, ray: Self::C, room: Self::D) -> Q::Answer {
        Q::run_on(&K::KERNELS, tree, backend, put, ray, room)
    }
}

/// A query that can call its kernel in a table.
trait PackedQuery<S: Scalar>: Query<S> {
    /// The place where the answer is written, if it is not returned.
    type Room<'q>;
    type Answer;

    fn answer(self, room: Self::Room<'_>) -> Self::Answer;

    fn run_on<F>(
        kernels: &PackedKernels<S, F>,
        tree: &Wide<S, F>,
        backend: Backend,
        put: &dyn PutOperands<S>,
        ray: &Ray<S>,
        room: Self::Room<'_>,
    ) -> Self::Answer;
}

impl<S: Scalar> PackedQuery<S> for Found<S> {
    type Room<'q> = &'q mut Self;
    type Answer = ();

    #[inline(always)]
    fn answer(self, room: &mut Self) {
        *room = self;
    }

    fn run_on<F>(
        kernels: &PackedKernels<S, F>,
        tree: &Wide<S, F>,
        backend: Backend,
        put: &dyn PutOperands<S>,
        ray: &Ray<S>,
        room: &mut Self,
    ) {
        (kernels.closest)(tree, backend, put, ray, room);
    }
}

impl<S: Scalar> PackedQuery<S> for Any<S> {
    type Room<'q> = ();
    type Answer = bool;

    #[inline(always)]
    fn answer(self, (): ()) -> bool {
        self.is_hit
    }

    fn run_on<F>(
        kernels: &PackedKernels<S, F>,
        tree: &Wide<S, F>,
        backend: Backend,
        put: &dyn PutOperands<S>,
        ray: &Ray<S>,
        (): (),
    ) -> bool {
        (kernels.any)(tree, backend, put, ray)
    }
}

/// Checks the number of operands: then leaves may be tested as those of `T`.
///
/// # Panics
///
/// Panics if the tree was built of primitives with another number of operands.
#[inline(always)]
fn check_operands<S: Scalar, F: Encoding<S, WIDTH>, T: LaneTest<S>>(tree: &Wide<S, F>) {
    assert!(tree.has_operands(T::OPERANDS), "a tree is queried for what it was built of");
}

/// Whether a ray that is not ordinary is valid, and suits the lanes' test.
#[cold]
#[inline(never)]
fn suits<S: Scalar, T: LaneTest<S>>(ray: &Ray<S>) -> bool {
    ray.validate().is_ok() && T::suits(ray)
}

/// A query of one ray, with a dynamic leaf test.
struct DynWide<'q, S: Scalar, F: Encoding<S, WIDTH>, const IN_ORDER: bool> {
    tree: &'q Wide<S, F>,
    ray: &'q mut RayState<S>,
    leaf_test: &'q mut dyn LeafTest<S>,
}

impl<S: Scalar, F: Encoding<S, WIDTH>, const IN_ORDER: bool> Kernel for DynWide<'_, S, F, IN_ORDER> {
    const IS_WIDE: bool = true;
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) {
        let Self { tree, ray, leaf_test } = self;
        if !ray.ray.is_valid() {
            return;
        }
        ray.steps.rays += 1;
        let (start, slabs) = (ray.ray, ray.slabs);
        let is_ordinary = start.is_ordinary();
        let mut visitor = DynLeaves::<S, IN_ORDER> { leaf_test, ray };
        wide::traverse::<_, _, _, _, false>(isa, tree, &start, &slabs, is_ordinary, &mut visitor);
    }
}

/// A best-first search along a valid ray, with a dynamic leaf test.
struct OpenWide<'q, S: Scalar, F: Encoding<S, WIDTH>> {
    tree: &'q Wide<S, F>,
    ray: &'q mut RayState<S>,
    leaf_test: &'q mut dyn LeafTest<S>,
    ahead: &'q mut BestFirst<S, Reference>,
}

impl<S: Scalar, F: Encoding<S, WIDTH>> Kernel for OpenWide<'_, S, F> {
    const IS_WIDE: bool = true;
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) {
        let Self { tree, ray, leaf_test, ahead } = self;
        wide::open(isa, tree, ahead, &mut DynLeaves { leaf_test, ray });
    }
}

/// Runs a query of one ray whose leaf test is `LaneLeafTest`.
#[inline(always)]
fn with_lane_test<S: Scalar, F: EncodingKernels<S>, T: LaneTest<S>>(
    tree: &Wide<S, F>,
    backend: Backend,
    put: &dyn PutOperands<S>,
    ray: &Ray<S>,
    wanted: Wanted,
    kernel: impl FnOnce(&mut RayState<S>, &mut dyn LeafTest<S>),
) -> (Found<S>, Counters) {
    check_operands::<S, F, T>(tree);
    let mut state = RayState::new(ray);
    if ray.is_valid() {
        let suits = tree.is_ordinary() && T::suits(ray);
        kernel(&mut state, &mut LaneLeafTest::<S, T>::new(put, wanted, suits.then_some(backend)));
    }
    (Found { t: state.ray.t_max, index: state.index, details: state.details }, state.steps)
}

/// Makes the kernels with a dynamic leaf test.
///
/// They are for a scalar, an encoding and a test.
macro_rules! dynamic {
    ($scalar:ty, $encoding:ty, $test:ty) => {{
        type Tree = Wide<$scalar, $encoding>;
        type Put<'a> = &'a dyn PutOperands<$scalar>;

        #[inline(never)]
        fn closest(
            tree: &Tree,
            backend: Backend,
            put: Put<'_>,
            ray: &Ray<$scalar>,
            found: &mut Found<$scalar>,
        ) {
            *found = counted(tree, backend, put, ray, true).0;
        }
        #[inline(never)]
        fn any(tree: &Tree, backend: Backend, put: Put<'_>, ray: &Ray<$scalar>) -> bool {
            counted(tree, backend, put, ray, false).0.index != NO_PRIMITIVE
        }
        #[inline(never)]
        fn open(
            tree: &Tree,
            backend: Backend,
            put: Put<'_>,
            ray: &Ray<$scalar>,
            ahead: &mut BestFirst<$scalar, Reference>,
        ) -> Counters {
            with_lane_test::<_, $encoding, $test>(tree, backend, put, ray, Wanted::All, |ray, leaf_test| {
                (<$encoding as EncodingKernels<$scalar>>::DYN.open)(tree, backend, ray, leaf_test, ahead);
            })
            .1
        }
        #[inline(never)]
        fn counted(
            tree: &Tree,
            backend: Backend,
            put: Put<'_>,
            ray: &Ray<$scalar>,
            is_closest: IsClosest,
        ) -> (Found<$scalar>, Counters) {
            const KERNELS: DynKernels<$scalar, Tree, Reference> =
                <$encoding as EncodingKernels<$scalar>>::DYN;
            let (wanted, kernel) =
                if is_closest { (Wanted::Closest, KERNELS.closest) } else { (Wanted::Any, KERNELS.any) };
            with_lane_test::<_, $encoding, $test>(tree, backend, put, ray, wanted, |ray, leaf_test| {
                kernel(tree, backend, ray, leaf_test)
            })
        }
        PackedKernels { closest, any, open, counted }
    }};
}

/// Makes the kernels whose closest and any hits have the leaf test inlined.
///
/// They are for a scalar, an encoding and a test.
macro_rules! inlined {
    ($scalar:ty, $encoding:ty, $test:ty) => {{
        type Tree = Wide<$scalar, $encoding>;
        type Put<'a> = &'a dyn PutOperands<$scalar>;
        struct Dynamic;
        impl Fallback<$scalar, $encoding> for Dynamic {
            const KERNELS: PackedKernels<$scalar, $encoding> = dynamic!($scalar, $encoding, $test);
        }

        #[inline(never)]
        fn closest(
            tree: &Tree,
            backend: Backend,
            put: Put<'_>,
            ray: &Ray<$scalar>,
            found: &mut Found<$scalar>,
        ) {
            backend.call::<Inlined<'_, $scalar, $encoding, $test, Found<$scalar>, Dynamic>>(
                tree, put, ray, found,
            );
        }
        #[inline(never)]
        fn any(tree: &Tree, backend: Backend, put: Put<'_>, ray: &Ray<$scalar>) -> bool {
            backend.call::<Inlined<'_, $scalar, $encoding, $test, Any<$scalar>, Dynamic>>(tree, put, ray, ())
        }
        PackedKernels { closest, any, ..<Dynamic as Fallback<_, _>>::KERNELS }
    }};
}

/// Makes the kernels for leaves of any primitive, for a scalar and an encoding.
macro_rules! dyn_leaves {
    ($scalar:ty, $encoding:ty) => {{
        type Tree = Wide<$scalar, $encoding>;
        type Test<'a> = &'a mut dyn LeafTest<$scalar>;

        #[inline(never)]
        fn closest(tree: &Tree, backend: Backend, ray: &mut RayState<$scalar>, leaf_test: Test<'_>) {
            backend.run(DynWide::<_, _, true> { tree, ray, leaf_test });
        }
        #[inline(never)]
        fn any(tree: &Tree, backend: Backend, ray: &mut RayState<$scalar>, leaf_test: Test<'_>) {
            backend.run(DynWide::<_, _, false> { tree, ray, leaf_test });
        }
        #[inline(never)]
        fn open(
            tree: &Tree,
            backend: Backend,
            ray: &mut RayState<$scalar>,
            leaf_test: Test<'_>,
            ahead: &mut BestFirst<$scalar, Reference>,
        ) {
            backend.run(OpenWide { tree, ray, leaf_test, ahead });
        }
        DynKernels { closest, any, open }
    }};
}

/// Makes the kernels for a scalar's binary tree.
///
/// They test two boxes at a time, with the instructions that every processor of the target has.
macro_rules! binary {
    ($scalar:ty) => {{
        type T = Tree<$scalar>;
        type Test<'a> = &'a mut dyn LeafTest<$scalar>;

        #[inline(never)]
        fn closest(tree: &T, _: Backend, ray: &mut RayState<$scalar>, leaf_test: Test<'_>) {
            if ray.ray.is_valid() {
                ray.steps.rays += 1;
                let _ = binary::traverse(tree, ray, leaf_test);
            }
        }
        #[inline(never)]
        fn open(
            tree: &T,
            _: Backend,
            ray: &mut RayState<$scalar>,
            leaf_test: Test<'_>,
            ahead: &mut BestFirst<$scalar, Child>,
        ) {
            binary::open(tree, ahead, ray, leaf_test);
        }
        // Nearer children come first in any-hit queries too.
        DynKernels { closest, any: closest, open }
    }};
}

impl ScalarKernels for f32 {
    const PACKED: [PackedKernels<Self, Packed>; 4] = [
        inlined!(f32, Packed, FastLeaf),
        inlined!(f32, Packed, WatertightLeaf),
        inlined!(f32, Packed, PreciseLeaf),
        inlined!(f32, Packed, SphereLeaf),
    ];
    const COMPACT: [PackedKernels<Self, Compact>; 4] = [
        dynamic!(f32, Compact, FastLeaf),
        dynamic!(f32, Compact, WatertightLeaf),
        dynamic!(f32, Compact, PreciseLeaf),
        dynamic!(f32, Compact, SphereLeaf),
    ];
    const PACKED_DYN: DynKernels<Self, Wide<Self, Packed>, Reference> = dyn_leaves!(f32, Packed);
    const COMPACT_DYN: DynKernels<Self, Wide<Self, Compact>, Reference> = dyn_leaves!(f32, Compact);
    const BINARY: DynKernels<Self, Tree, Child> = binary!(f32);
}

/// `f64` has no `Precise` triangles: the watertight kernels fill their place.
impl ScalarKernels for f64 {
    const PACKED: [PackedKernels<Self, Packed>; 4] = {
        const WATERTIGHT: PackedKernels<f64, Packed> = inlined!(f64, Packed, WatertightLeaf);
        [inlined!(f64, Packed, FastLeaf), WATERTIGHT, WATERTIGHT, dynamic!(f64, Packed, SphereLeaf)]
    };
    const COMPACT: [PackedKernels<Self, Compact>; 4] = {
        const WATERTIGHT: PackedKernels<f64, Compact> = dynamic!(f64, Compact, WatertightLeaf);
        [dynamic!(f64, Compact, FastLeaf), WATERTIGHT, WATERTIGHT, dynamic!(f64, Compact, SphereLeaf)]
    };
    const PACKED_DYN: DynKernels<Self, Wide<Self, Packed>, Reference> = dyn_leaves!(f64, Packed);
    const COMPACT_DYN: DynKernels<Self, Wide<Self, Compact>, Reference> = dyn_leaves!(f64, Compact);
    const BINARY: DynKernels<Self, Tree<f64>, Child> = binary!(f64);
}
