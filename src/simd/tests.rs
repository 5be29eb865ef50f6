//! Tests all vector operations against the plain operations on scalars.
//!
//! Every operation of every vector type of every instruction set that the processor has gives, lane
//! by lane, the bits of the scalar operation.

use super::{Backend, Halves, InstructionSet, Isa, Kernel, KernelLanes, Lanes};
use crate::geometry::Scalar;
use alloc::vec::Vec;

/// Returns scalars on which nearly equal operations differ.
///
/// Over all turns of two tables, each scalar is beside each.
fn table<S: Scalar>(turn: usize) -> [S; 16] {
    let third = S::ONE / S::from_f64(3.0);
    let nan = S::from_f64(f64::NAN);
    let values = [
        S::ZERO,
        -S::ZERO,
        S::ONE,
        -S::from_f64(2.25),
        nan,
        S::INFINITY,
        S::NEG_INFINITY,
        S::ZERO.next_up(),
        -S::ZERO.next_up(),
        S::MAX,
        -S::MAX,
        third,
        third.next_up(),
        -third,
        S::from_f64(1e10),
        S::from_f64(-1e-30),
    ];
    core::array::from_fn(|lane| values[(lane + turn) % 16])
}

/// The operands of one turn.
struct Operands<S> {
    a: [S; 16],
    b: [S; 16],
    c: [S; 16],
}

/// The results of the operations: rounded scalars, copied scalars, and masks.
#[derive(Debug, Default)]
struct Results<S> {
    rounded: Vec<S>,
    moved: Vec<S>,
    masks: Vec<u32>,
}

impl<S: Scalar> Results<S> {
    /// Compares two results.
    ///
    /// The payload and the sign of a computed NaN are not guaranteed, those of a copied NaN are.
    fn assert_same(&self, other: &Self, of: &str) {
        let rounded = |x: S| if x.is_nan() { u64::MAX } else { x.to_ordered_bits() };
        let same = |a: &[S], b: &[S], bits: &dyn Fn(S) -> u64| {
            assert_eq!(a.len(), b.len(), "{of}");
            for (i, (&a, &b)) in a.iter().zip(b).enumerate() {
                assert_eq!(bits(a), bits(b), "{of}, {i}: {a:?} {b:?}");
            }
        };
        same(&self.rounded, &other.rounded, &rounded);
        same(&self.moved, &other.moved, &S::to_ordered_bits);
        assert_eq!(self.masks, other.masks, "{of}");
    }
}

/// Returns the results of the first `count` lanes, computed by scalars.
fn expected<S: Scalar>(operands: &Operands<S>, count: usize) -> Results<S> {
    let Operands { a, b, c } = operands;
    let mut results = Results::default();
    let lanes = |f: &dyn Fn(usize) -> S| (0..count).map(f).collect::<Vec<S>>();
    let mask = |f: &dyn Fn(usize) -> bool| (0..count).map(|k| u32::from(f(k)) << k).sum::<u32>();
    results.rounded.extend(lanes(&|k| a[k] + b[k]));
    results.rounded.extend(lanes(&|k| a[k] - b[k]));
    results.rounded.extend(lanes(&|k| a[k] * b[k]));
    results.rounded.extend(lanes(&|k| a[k] / b[k]));
    results.rounded.extend(lanes(&|k| a[k].sqrt()));
    // Nothing is fused.
    results.rounded.extend(lanes(&|k| a[k] * b[k] + c[k]));
    results.moved.extend(lanes(&|k| a[k]));
    results.moved.extend(lanes(&|_| a[0]));
    results.moved.extend(lanes(&|k| S::from_f64(f64::from(BYTES[k]))));
    results.moved.extend(lanes(&|k| a[k].abs()));
    results.moved.extend(lanes(&|k| if a[k] < b[k] { a[k] } else { b[k] }));
    results.moved.extend(lanes(&|k| if a[k] > b[k] { a[k] } else { b[k] }));
    results.moved.extend(lanes(&|k| if a[k] < b[k] { a[k] } else { c[k] }));
    results.masks.push(mask(&|k| a[k] < b[k]));
    results.masks.push(mask(&|k| a[k] <= b[k]));
    results.masks.push(mask(&|k| !is_less(a[k], b[k])));
    results.masks.push(mask(&|k| a[k] <= b[k] && a[k] < c[k]));
    results.masks.push(mask(&|k| a[k] <= b[k] || a[k] < c[k]));
    results.masks.push(mask(&|k| !(a[k] <= b[k] || a[k] < c[k])));
    // The operations that may compare bits.
    let [x, y] = [a, b].map(|row| row.map(positive));
    results.moved.extend(lanes(&|k| if x[k] > y[k] { x[k] } else { y[k] }));
    results.moved.extend(lanes(&|k| if x[k] < y[k] { x[k] } else { y[k] }));
    results.masks.push(mask(&|k| x[k] <= y[k]));
    results.masks.push(mask(&|k| x[k] <= -x[k].next_up()));
    results
}

/// Returns the results of vectors.
#[inline(always)]
fn computed<S: Scalar, L: Lanes<S>>(isa: L::Isa, operands: &Operands<S>) -> Results<S> {
    assert!(L::COUNT <= 16);
    let mut results = Results::default();
    // SAFETY: a row has sixteen scalars, and no vector has more lanes.
    let load = |row: &[S; 16]| unsafe { L::load(isa, row.as_ptr()) };
    let [a, b, c] = [load(&operands.a), load(&operands.b), load(&operands.c)];
    let lanes = |vector: L| {
        let mut scalars = [S::from_f64(-7.0); 16];
        vector.store(&mut scalars);
        for (k, scalar) in scalars[..L::COUNT].iter().enumerate() {
            assert_eq!(vector.lane(k).to_ordered_bits(), scalar.to_ordered_bits());
        }
        assert!(scalars[L::COUNT..].iter().all(|&x| x == S::from_f64(-7.0)));
        scalars.into_iter().take(L::COUNT)
    };
    for vector in [a + b, a - b, a * b, a / b, a.sqrt(), a * b + c] {
        results.rounded.extend(lanes(vector));
    }
    // SAFETY: `BYTES` has sixteen bytes, and no vector has more lanes.
    let bytes = unsafe { L::load_bytes(isa, BYTES.as_ptr()) };
    for vector in [a, L::splat(isa, operands.a[0]), bytes, a.abs(), a.min(b), a.max(b), a.select(a.lt(b), c)]
    {
        results.moved.extend(lanes(vector));
    }
    let either = a.le(b) | a.lt(c);
    for mask in [a.lt(b), a.le(b), !a.lt(b), a.le(b) & a.lt(c), either, !either] {
        results.masks.push(L::bits(mask));
    }
    let [x, y] = [load(&operands.a.map(positive)), load(&operands.b.map(positive))];
    results.moved.extend(lanes(x.later(y)));
    results.moved.extend(lanes(x.earlier(y)));
    let below = load(&operands.a.map(|x| -positive(x).next_up()));
    results.masks.extend([L::bits(x.not_after(y)), L::bits(x.not_after(below))]);
    // Only this operation may be fused, so its result is one of two.
    let fused = lanes(a.mul_add(b, c)).zip(lanes(a * b + c)).enumerate();
    for (k, (fused, twice)) in fused {
        let (a, b, c) = (operands.a[k], operands.b[k], operands.c[k]);
        let once = rounded_once(a, b, c);
        let same = |x: S| x == fused || (x.is_nan() && fused.is_nan());
        assert!(same(once) || same(twice), "{a:?} * {b:?} + {c:?}: {fused:?} {once:?} {twice:?}");
    }
    results
}

/// Returns `a * b + c`, rounded once.
fn rounded_once<S: Scalar>(a: S, b: S, c: S) -> S {
    #[cfg(feature = "std")]
    let (narrow, wide) = (f32::mul_add, f64::mul_add);
    #[cfg(not(feature = "std"))]
    let (narrow, wide) = (libm::fmaf, libm::fma);
    let (a, b, c) = (a.to_f64(), b.to_f64(), c.to_f64());
    S::from_f64(if S::IS_WIDEST { wide(a, b, c) } else { f64::from(narrow(a as f32, b as f32, c as f32)) })
}

/// Returns a number that is not NaN and has a plus sign.
fn positive<S: Scalar>(x: S) -> S {
    if x.is_nan() { S::ONE } else { x.abs() }
}

const BYTES: [u8; 16] = [0, 1, 2, 127, 128, 129, 254, 255, 3, 5, 250, 64, 32, 16, 8, 200];

struct All<'a, S>(&'a Operands<S>);

impl<S: Scalar> Kernel for All<'_, S> {
    const IS_WIDE: bool = true;
    type Output = [Results<S>; 4];

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> Self::Output {
        let row = self.0;
        // SAFETY: a row has sixteen scalars, and eight are read.
        let whole = unsafe { S::Times8::<I>::load(isa, row.a.as_ptr()) };
        let [first, second] = whole.to_halves();
        let (mut scalars, mut halves) = ([S::ZERO; 8], [S::ZERO; 8]);
        S::Times8::<I>::of_halves([first, second]).store(&mut scalars);
        first.store(&mut halves[..4]);
        second.store(&mut halves[4..]);
        for (k, x) in row.a[..8].iter().enumerate() {
            assert_eq!([scalars[k], halves[k]].map(S::to_ordered_bits), [x.to_ordered_bits(); 2]);
        }
        [
            computed::<S, S::Times4<I>>(isa, row),
            computed::<S, S::Times8<I>>(isa, row),
            computed::<S, S::Times16<I>>(isa, row),
            computed::<S, S::Times8Doubled<I>>(isa, row),
        ]
    }
}

fn check<S: Scalar>() {
    let counts = [4, 8, 16, 8];
    for backend in InstructionSet::available().filter_map(Backend::of) {
        for turns in 0..16 * 16 {
            let (turn, apart) = (turns / 16, turns % 16);
            let (a, b, c) = (table::<S>(turn), table(turn + apart), table(3 * turn + 5 * apart));
            let operands = Operands { a, b, c };
            for (results, count) in backend.run(All(&operands)).iter().zip(counts) {
                results.assert_same(&expected(&operands, count), &alloc::format!("{backend:?} {count}"));
            }
        }
    }
}

#[test]
fn vectors_give_the_bits_of_scalars() {
    check::<f32>();
    check::<f64>();
}

#[test]
fn the_best_is_the_last_of_those_available() {
    assert_eq!(InstructionSet::available().last(), Some(InstructionSet::best()));
    for set in InstructionSet::available() {
        assert_eq!(Backend::of(set).unwrap().instruction_set(), set);
    }
}

fn is_less<S: Scalar>(a: S, b: S) -> bool {
    a < b
}
