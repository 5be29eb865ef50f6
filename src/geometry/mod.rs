//! Scalars, boxes and rays: the vocabulary that everything above is written in.

mod aabb;
mod axis;
mod polygon;
mod prepared;
mod ray;
mod scalar;
mod shear;
mod slabs;

pub use aabb::Aabb;
pub use axis::Axis;
pub(crate) use polygon::Polygon;
pub use prepared::PreparedRay;
pub use ray::{Ray, RayError};
pub use scalar::Scalar;
pub(crate) use scalar::{Vector, max, min};
pub(crate) use shear::Shear;
pub(crate) use slabs::Slabs;
