//! Scalars, boxes and rays: the vocabulary of all other modules.

mod aabb;
mod axis;
mod polygon;
mod ray;
mod ray_frame;
mod scalar;
mod slabs;
mod vector;

pub use aabb::Aabb;
pub use axis::Axis;
pub(crate) use polygon::Polygon;
pub use ray::{Ray, RayError};
pub(crate) use ray_frame::RayFrame;
pub use scalar::Scalar;
pub use scalar::ScalarParts;
pub(crate) use scalar::{max, min};
pub(crate) use slabs::Slabs;
pub(crate) use vector::{cross, dot};
