//! Bounding volume hierarchies over any primitive, with the split heuristic of your choice, and
//! answers that equal the naive loop's bit for bit.
//!
//! ```
//! use bvhkit::{Bvh, Ray, Triangle};
//!
//! let triangles = vec![
//!     Triangle::new([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
//!     Triangle::new([0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 1.0, 2.0]),
//! ];
//! let bvh = Bvh::build(triangles)?;
//! let ray = Ray::new([0.25, 0.25, -5.0], [0.0, 0.0, 1.0]); // t in [0, infinity]
//! if let Some(hit) = bvh.closest_hit(&ray) {
//!     println!("triangle {} at t = {}", hit.index, hit.t); // its index in the input
//! }
//! let in_shadow = bvh.any_hit(&ray.with_interval(1e-4, 4.0));
//! # assert_eq!((bvh.closest_hit(&ray).unwrap().index, in_shadow), (0, false));
//! # Ok::<(), bvhkit::BuildError>(())
//! ```
//!
//! # The way through
//!
//! ```text
//! primitives -> boxes -> driver, asking a heuristic -> tree -> reinsertion -> layout -> queries -> hits
//! ```
//!
//! - What a tree can hold: [`Primitive`], one method; to be hit by rays, [`Intersect`], one more.
//!   Built in: [`Triangle`], [`TriangleMesh`], [`Sphere`], [`Aabb`].
//! - How exactly a triangle is tested, by type: [`Watertight`], what [`Triangle`] is by itself, [`Fast`]
//!   or [`Precise`]; `docs/accuracy.md` has the errors and the price of each.
//! - How it is built: [`Bvh::build`] for the good default, [`Bvh::builder`] for a [`Quality`], one
//!   of the [`heuristic`]s or your own, how much to [`Optimise`], the leaf size, threads, a time budget, and what to do
//!   with invalid primitives. In memory that earlier ones left: [`Workspace`].
//! - How it lies in memory, by type: [`WideTree`] for speed, what [`Bvh`] has by itself, [`CompactTree`] for few bytes, or the
//!   binary [`Tree`]; and
//!   what it is computed with, [`InstructionSet`], the best that the processor has unless told.
//! - What it answers: [`Bvh::closest_hit`], [`Bvh::any_hit`], [`Bvh::hits`], each with
//!   [`Counters`] on request; [`Bvh::closest_hits`] and [`Bvh::any_hits`] for many rays.
//! - What to test it, or your own, against: [`reference`](mod@reference); with the feature `exact`,
//!   the answer of exact arithmetic too.
//! - What it looks like: [`Bvh::report`], [`Bvh::check`]; how good it is: [`Bvh::epo`], and, by your own rays,
//!   [`Bvh::closest_hit_steps`].
//!
//! # What is promised
//!
//! - **The naive answer.** The hit is that of the loop over all primitives with the same primitive
//!   test: same t bits, same index, the lowest index where several have the same t. It does not
//!   depend on heuristic, leaf size, layout, instruction set or number of threads. How: [`Intersect::intersect`].
//! - **No leaks.** A ray from inside a closed mesh, by more than rounding, hits it, at edges and corners too,
//!   unless its triangles are [`Fast`]: see [`Watertight`].
//! - **No panics on data.** NaN, infinities, empty input, degenerate primitives, absurd options: each
//!   has a documented answer or a typed error, [`BuildError`]. (Your own trait implementations may
//!   panic, of course.)
//! - **Bounded depth.** No leaf is deeper than [`MAX_DEPTH`], whatever heuristic and data; closest
//!   and any hit need no memory but a fixed stack, builds do not recurse.
//! - **Any math library.** Points go in as anything that converts to `[f32; 3]` or `[f64; 3]`, and
//!   come out as arrays.
//!
//! # Features
//!
//! - `rayon` (default): parallel builds; the tree is the same with and without.
//! - `std` (default): the standard library's square root, its clock, the processor's features. Without it the crate is `no_std` + alloc.
//! - `libm`: libm's square root, needed without `std`.
//! - `exact`: the exact oracle, `reference::exact`.
//! - `portable`: [`InstructionSet::Portable`] also where the target has vectors, for tests.
#![no_std]
#![deny(missing_docs)]

extern crate alloc;
#[cfg(feature = "std")]
extern crate std;

mod analysis;
mod builders;
mod bvh;
mod geometry;
mod layout;
mod leaf;
mod memory;
mod parallel;
mod primitive;
mod query;
pub mod reference;
mod simd;
mod traverse;
mod tree;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// The examples of the page on accuracy are tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/accuracy.md")]
struct AccuracyPage;

/// The examples of the page on layouts are tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/layouts.md")]
struct LayoutsPage;

/// The examples of the page on building are tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/building.md")]
struct BuildingPage;

pub use analysis::{InvariantError, LeafSizes, TreeReport};
pub use builders::heuristic;
pub use builders::{BuildControl, InvalidBox, Optimise, OptimiseStats, PrimRef};
pub use bvh::{BuildError, Builder, Bvh, OnInvalid, Quality, Workspace};
pub use geometry::{Aabb, Axis, Ray, RayError, Scalar};
pub use layout::{CompactTree, Layout, WideTree};
pub use leaf::{
    FastLeaf, LEAF_WIDTH, Leaf, OneByOne, Operands, PreciseLeaf, Sieve, Sieved, SphereLeaf, WatertightLeaf,
};
pub use parallel::ThreadPoolError;
pub use primitive::{
    Barycentrics, Corners, Fast, Intersect, MeshError, MeshTriangle, Precise, Primitive, Sphere,
    SurfacePoint, Triangle, TriangleMesh, Watertight,
};
pub use query::{Hit, Hits, Traverse};
pub use simd::{InstructionSet, Lanes};
pub use traverse::{Counters, Recorder};
pub use tree::{MAX_DEPTH, Tree};
