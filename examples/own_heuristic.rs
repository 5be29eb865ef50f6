//! A user's own split heuristic, which is one method.
//!
//! `cargo run --release --example own_heuristic`

use bvhkit::heuristic::{BuildNode, Heuristic, Median, Split};
use bvhkit::{Bvh, Ray, Sphere};

/// Splits the axis on which centroids spread most, at their mean.
struct Mean;

impl Heuristic<f32> for Mean {
    fn split(&self, node: &BuildNode<'_>) -> Split {
        if node.references.len() <= node.max_leaf_size {
            return Split::Leaf;
        }
        let axis = node.centroids().longest_axis();
        let sum: f32 = node.references.iter().map(|r| r.centroid()[axis.index()]).sum();
        Split::Plane { axis, position: sum / node.references.len() as f32 }
    }
}

fn main() -> Result<(), bvhkit::BuildError> {
    // Spheres along a line, with growing gaps.
    let spheres: Vec<Sphere> = (0..1000).map(|i| Sphere::new([(i * i) as f32, 0.0, 0.0], 9.0)).collect();
    let mean = Bvh::builder().heuristic(Mean).build(&spheres)?;
    let median = Bvh::builder().heuristic(Median).build(&spheres)?;
    let rays: Vec<Ray> =
        (0..10_000).map(|x| Ray::new([x as f32 * 100.0, 0.0, -9.0], [0.0, 0.0, 1.0])).collect();
    for (name, bvh) in [("mean", mean), ("median", median)] {
        let steps = bvh.any_hit_steps(&rays);
        let [nodes, tests] = [steps.nodes_per_ray(), steps.primitives_per_ray()];
        println!("{name}: {nodes:.2} nodes and {tests:.2} tests per ray\n{}\n", bvh.report());
    }
    Ok(())
}
