//! The triangle modes, so that a claim can be tested in each of them.

use bvhkit::{Barycentrics, Fast, Intersect, Precise, Scalar, Triangle, Watertight};
use std::fmt::Debug;

/// A triangle in a mode, made from a plain one.
///
/// A plain [`Triangle`] is itself in the watertight mode.
pub trait Mode:
    Intersect<Payload = Barycentrics<<Self as Mode>::Number>, Scalar = Self::Number> + Copy + Debug
{
    /// The scalar, under a name that needs no path through the supertraits.
    type Number: Scalar;

    fn of(triangle: Triangle<Self::Number>) -> Self;
}

macro_rules! modes {
    ($($mode:ident of $scalar:ty;)*) => {
        $(impl Mode for $mode<Triangle<$scalar>> {
            type Number = $scalar;
            fn of(triangle: Triangle<$scalar>) -> Self {
                $mode(triangle)
            }
        })*
    };
}

modes! {
    Fast of f32;
    Watertight of f32;
    Precise of f32;
    Fast of f64;
    Watertight of f64;
}
