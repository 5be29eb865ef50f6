//! Layout functions that this crate compiles for `f32` and for `f64`.
//!
//! See `builders::compiled`.

use super::{Buffers, Collapsed, Contents, Shape, WIDTH, collapse};
use crate::geometry::Scalar;
use crate::tree::Tree;

/// The layout functions of a scalar.
pub trait CompiledLayout: Sized {
    /// Returns the wide tree whose nodes have up to [`WIDTH`] children.
    fn collapse(
        tree: &Tree<Self>,
        contents: &dyn Contents<Self>,
        shape: &Shape<Self>,
        buffers: &mut Buffers,
    ) -> Option<Collapsed>
    where
        Self: Scalar;
}

macro_rules! compiled_here {
    ($($scalar:ty)*) => {$(
        impl CompiledLayout for $scalar {
            #[inline(never)]
            fn collapse(
                tree: &Tree<Self>,
                contents: &dyn Contents<Self>,
                shape: &Shape<Self>,
                buffers: &mut Buffers,
            ) -> Option<Collapsed> {
                collapse::<Self, WIDTH>(tree, contents, shape, buffers)
            }
        }
    )*};
}

compiled_here!(f32 f64);
