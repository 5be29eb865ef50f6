//! Asserts that every tree answers as the naive loop does, bit for bit.

use super::answers::Payload;
use super::heuristics;
use super::naive::Naive;
use bvhkit::{Bvh, Intersect, Optimise, Ray, Tree};

/// Maximum leaf sizes: small, ordinary, and one leaf for everything.
const LEAF_SIZES: [usize; 5] = [1, 2, 4, 8, usize::MAX];

/// Compares trees with the naive loop and returns the number of hits.
///
/// Builds with every heuristic and leaf size, in the binary and the default layout, and checks each
/// tree. Invalid primitives are skipped.
pub fn assert_agreement<P: Intersect<Payload: Payload>>(primitives: &[P], rays: &[Ray<P::Scalar>]) -> usize {
    let naive = Naive::new(primitives, rays);
    for (name, heuristic) in heuristics::all() {
        for max_leaf_size in LEAF_SIZES {
            let builder = Bvh::builder().heuristic(&*heuristic).max_leaf_size(max_leaf_size);
            let optimise = Optimise { share: 0.5, rounds: 2 };
            let builder = if [2, 8].contains(&max_leaf_size) { builder.optimise(optimise) } else { builder };
            let options = format_args!("{name}, leaves of {max_leaf_size}");
            naive.assert_same(builder.clone(), options);
            let bvh = naive.assert_same(builder.layout::<Tree<P::Scalar>>(), options);
            let report = bvh.report();
            assert_eq!(report.leaves, if bvh.is_empty() { 0 } else { report.inner_nodes + 1 });
            assert!(report.leaf_sizes.max <= max_leaf_size);
        }
    }
    naive.hits()
}
