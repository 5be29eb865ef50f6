//! A macro that repeats a test in each mode.

/// Defines a test for each mode from a function that is generic over the mode.
macro_rules! in_every_mode {
    ($($name:ident)*) => {
        $(mod $name {
            use bvhkit::{Fast, Precise, Triangle, Watertight};

            #[test]
            fn fast_f32() {
                super::$name::<Fast<Triangle>>();
            }
            #[test]
            fn fast_f64() {
                super::$name::<Fast<Triangle<f64>>>();
            }
            #[test]
            fn watertight_f32() {
                super::$name::<Watertight<Triangle>>();
            }
            #[test]
            fn watertight_f64() {
                super::$name::<Watertight<Triangle<f64>>>();
            }
            #[test]
            fn precise() {
                super::$name::<Precise<Triangle>>();
            }
        })*
    };
}
pub(crate) use in_every_mode;
