//! Every heuristic, leaf size, kind of primitive and scalar against the naive loop.
//!
//! `PROPTEST_CASES` sets the number of scenes for each property.

use crate::common::agreement::assert_agreement;
use crate::common::answers::Payload;
use crate::common::at_hits::at_hits;
use crate::common::modes::Mode;
use crate::generate::primitives::{Corners, boxes, discs, spheres, triangles};
use crate::generate::rays::{Aim, aims};
use crate::generate::scenes::soup;
use bvhkit::{
    Barycentrics, Fast, Intersect, Precise, Scalar, Triangle, TriangleMesh, Watertight, WatertightLeaf,
};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

fn check<S: Scalar, P: Intersect<Scalar = S, Payload: Payload>>(
    soup: &[Corners<S>],
    aims: &[Aim],
    primitives: &[P],
) -> usize {
    let rays = aims.iter().map(|aim| aim.ray(soup)).collect();
    assert_agreement(primitives, &at_hits(primitives, rays))
}

/// Checks triangles in mode `M`.
fn check_mode<M: Mode>(soup: &[Corners<M::Number>], aims: &[Aim]) -> usize {
    check(soup, aims, &triangles(soup).into_iter().map(M::of).collect::<Vec<_>>())
}

/// Checks the same triangles through an index buffer, with reversed winding.
fn check_mesh<S: Scalar>(soup: &[Corners<S>], aims: &[Aim]) -> usize {
    let faces: Vec<_> = (0..soup.len() as u32).map(|i| [3 * i + 2, 3 * i + 1, 3 * i]).collect();
    let mesh = TriangleMesh::new(soup.as_flattened(), &faces).unwrap();
    check(soup, aims, &mesh.iter().collect::<Vec<_>>())
}

/// Checks triangles behind two pointers, as in a scene of different primitives.
fn check_boxed<S: Scalar>(soup: &[Corners<S>], aims: &[Aim]) -> usize {
    type Dyn<'a, S> = dyn Intersect<Scalar = S, Payload = Barycentrics<S>, Leaf = WatertightLeaf> + 'a;
    let owned = triangles(soup);
    let boxed: Vec<Box<Dyn<'_, S>>> =
        owned.iter().map(|triangle: &Triangle<S>| Box::new(triangle) as Box<Dyn<'_, S>>).collect();
    check(soup, aims, &boxed)
}

/// Defines a property for each scalar and kind of primitive.
macro_rules! properties {
    ($($name:ident: $scalar:ty, $check:expr;)*) => {
        proptest! {
            #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
            $(
                #[test]
                fn $name(soup in soup::<$scalar>(), aims in aims()) {
                    let check: fn(&[Corners<$scalar>], &[Aim]) -> usize = $check;
                    check(&soup, &aims);
                }
            )*
        }
    };
}

properties! {
    fast_triangles_f32: f32, check_mode::<Fast<Triangle>>;
    fast_triangles_f64: f64, check_mode::<Fast<Triangle<f64>>>;
    watertight_triangles_f32: f32, check_mode::<Watertight<Triangle>>;
    watertight_triangles_f64: f64, check_mode::<Watertight<Triangle<f64>>>;
    precise_triangles: f32, check_mode::<Precise<Triangle>>;
    mesh_triangles_f32: f32, check_mesh;
    mesh_triangles_f64: f64, check_mesh;
    spheres_f32: f32, |soup, aims| check(soup, aims, &spheres(soup));
    spheres_f64: f64, |soup, aims| check(soup, aims, &spheres(soup));
    boxes_f32: f32, |soup, aims| check(soup, aims, &boxes(soup));
    boxes_f64: f64, |soup, aims| check(soup, aims, &boxes(soup));
    sloppy_discs_f32: f32, |soup, aims| check(soup, aims, &discs(soup));
    sloppy_discs_f64: f64, |soup, aims| check(soup, aims, &discs(soup));
    boxed_references_f32: f32, check_boxed;
    boxed_references_f64: f64, check_boxed;
}

/// Generated rays hit often: rays that miss prove little.
#[test]
fn the_aims_are_good() {
    let mut runner = TestRunner::deterministic();
    let mut hits = [0; 4];
    for _ in 0..50 {
        let soup = soup::<f32>().new_tree(&mut runner).unwrap().current();
        let aims = aims().new_tree(&mut runner).unwrap().current();
        hits[0] += check_mode::<Fast<Triangle>>(&soup, &aims);
        hits[1] += check(&soup, &aims, &spheres(&soup));
        hits[2] += check(&soup, &aims, &boxes(&soup));
        hits[3] += check(&soup, &aims, &discs(&soup));
    }
    assert!(hits.iter().all(|&hits| hits > 300), "{hits:?}");
}
