//! The heuristics that every test of agreement uses, one of them hostile.

use super::hostile::Hostile;
use bvhkit::Scalar;
use bvhkit::heuristic::{
    BinnedSah, Clustered, Heuristic, Median, Midpoint, Morton, SahCost, SpatialSah, SweepSah,
};

/// Returns every heuristic of the crate and [`Hostile`], with names for messages.
pub fn all<S: Scalar>() -> Vec<(&'static str, Box<dyn Heuristic<S>>)> {
    // A step is expensive and a test is cheap, so leaves are as large as allowed.
    let lazy = SahCost { traversal: 100.0, intersection: 0.1 };
    let cutting = SpatialSah { overlap: 0.0, growth: 2.0, ..SpatialSah::default() };
    vec![
        ("median", Box::new(Median)),
        ("midpoint", Box::new(Midpoint)),
        ("2 bins", Box::new(BinnedSah::new(2))),
        ("7 bins", Box::new(BinnedSah { bins: 7, cost: lazy })),
        ("32 bins", Box::new(BinnedSah::new(32))),
        ("sweep", Box::new(SweepSah::default())),
        ("Morton", Box::new(Morton)),
        ("spatial", Box::new(cutting)),
        ("clustered", Box::new(Clustered { size: 3, heuristic: cutting })),
        ("hostile", Box::new(Hostile)),
    ]
}
