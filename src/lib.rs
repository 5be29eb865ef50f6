//! Bounding volume hierarchies for ray tracing, over any primitive.
//!
//! The split heuristic is your choice. The answers equal those of the naive loop over
//! all primitives, bit for bit.
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
//! # Overview
//!
//! ```text
//! primitives -> boxes -> driver + heuristic -> tree -> reinsertion -> layout -> queries -> hits
//! ```
//!
//! - Primitives: a tree needs one method, [`Primitive`]. Rays need one more, [`Intersect`]. Built
//!   in: [`Triangle`], [`TriangleMesh`], [`Sphere`], [`Aabb`].
//! - Tests of a triangle, by type: [`Watertight`], the mode of a plain [`Triangle`], [`Fast`], or
//!   [`Precise`]. `docs/accuracy.md` has the errors and the price of each.
//! - Building: [`Bvh::build`] has good defaults. [`Bvh::builder`] sets a [`Quality`], one of the
//!   [`heuristic`]s or your own, the amount of reinsertion ([`Optimise`]), the leaf size,
//!   threads, a time budget, and the treatment of invalid primitives. A [`Workspace`] reuses the
//!   memory of earlier builds.
//! - Layouts, by type: [`WideTree`], the default of [`Bvh`], for speed; [`CompactTree`] for few
//!   bytes; or the binary [`Tree`]. Queries use the best [`InstructionSet`] that the processor has,
//!   unless another one is set.
//! - Queries: [`Bvh::closest_hit`], [`Bvh::any_hit`], [`Bvh::hits`], each with [`Counters`] on
//!   request; [`Bvh::closest_hits`] and [`Bvh::any_hits`] for many rays.
//! - Tests of this crate's hierarchies, or of your own: [`reference`](mod@reference) has the naive
//!   answers; with the feature `exact`, it has the answers of exact arithmetic too.
//! - Inspection: [`Bvh::report`] and [`Bvh::check`]. Quality: [`Bvh::epo`], and
//!   [`Bvh::closest_hit_steps`] with your own rays.
//!
//! # Promises
//!
//! - **The naive answer.** A query returns the hit of the loop over all primitives with the
//!   same primitive test: the same bits of t and the same index, the lowest index where
//!   several primitives have the same t. The answer does not depend on the heuristic, the leaf
//!   size, the layout, the instruction set or the number of threads. [`Intersect::intersect`]
//!   has the rule behind this.
//! - **No leaks.** A ray from inside a closed mesh, by more than rounding, hits the mesh, at edges
//!   and corners too, unless its triangles are [`Fast`]: see [`Watertight`].
//! - **No panics on data.** NaN, infinities, empty input, degenerate primitives and absurd options
//!   each have a documented answer or a typed error, [`BuildError`]. Your own trait
//!   implementations may panic.
//! - **Bounded depth.** No leaf is deeper than [`MAX_DEPTH`], whatever the heuristic and the data.
//!   Closest and any hits use a fixed stack and no other memory. Builds do not recurse.
//! - **Any math library.** Points go in as any type that converts to `[f32; 3]` or
//!   `[f64; 3]`, and come out as arrays.
//!
//! # Features
//!
//! - `rayon` (default): parallel builds. The tree is the same without it.
//! - `std` (default): the square root and the clock of the standard library, and detection of the
//!   processor's instruction sets. Without `std`, the crate is `no_std` + alloc.
//! - `libm`: the square root of libm, required without `std`.
//! - `exact`: the oracle in exact arithmetic, `reference::exact`.
//! - `portable`: [`InstructionSet::Portable`] also on targets with vectors, for tests.
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

/// Runs the examples of the README as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// Runs the examples of the page on accuracy as tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/accuracy.md")]
struct AccuracyPage;

/// Runs the examples of the page on layouts as tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/layouts.md")]
struct LayoutsPage;

/// Runs the examples of the page on building as tests.
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
