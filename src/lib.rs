//! Bounding volume hierarchies over any primitive.
#![no_std]
#![deny(missing_docs)]

extern crate alloc;
#[cfg(feature = "std")]
extern crate std;

mod build;
mod builder;
mod bvh;
mod geometry;
mod primitive;
mod query;
pub mod reference;
mod simd;
mod tree;

pub use build::heuristic;
pub use build::{PrimRef, ThreadPoolError};
pub use builder::{BuildError, Builder, Flaw, OnInvalid, Quality};
pub use bvh::Bvh;
pub use geometry::{Aabb, Axis, Ray, RayError, Scalar};
pub use primitive::{
    Barycentrics, Intersect, MeshError, MeshTriangle, Primitive, Sphere, Triangle, TriangleMesh,
};
pub use query::{Counters, Hit, Hits, Recorder};
pub use tree::{InvariantError, LeafSizes, MAX_DEPTH, Tree, TreeReport};
