//! End-point overlap: the cost of boxes around surface that is not below them.

use crate::geometry::{Aabb, Polygon, Scalar, ScalarParts};
use crate::layout::{Outline, Part};
use crate::parallel;
use alloc::vec::Vec;

/// The number of triangles in a task.
///
/// The sums of tasks are added in order: the result does not depend on the number of threads.
const CHUNK: usize = 256;

/// A node in depth-first order: all nodes below it follow.
struct Node {
    aabb: Aabb<f64>,
    depth: usize,
    /// The index of the next node that is not below it.
    end: usize,
    cost: f64,
}

/// A primitive in a leaf.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    index: u32,
    leaf: usize,
}

/// Returns the end-point overlap: see [`Bvh::epo`](crate::Bvh::epo).
///
/// It is a sum over nodes, over the area of all the surface. Each node adds its cost times the area
/// of the surface that is inside its box, but not below it.
pub(crate) fn epo<S: Scalar, H: Outline<S>>(
    hierarchy: &H,
    corners: impl Fn(usize) -> [[S; 3]; 3] + Sync,
) -> f64 {
    let root = hierarchy.aabb();
    let coordinates = [root.min, root.max].into_iter().flatten().map(|x| x.to_f64().abs());
    // The scale keeps areas from overflow; as a power of two, it rounds nothing.
    let scale = coordinates.fold(0.0, f64::max).inverse_power_of_two();
    let scaled = |point: [S; 3]| point.map(|x| x.to_f64() * scale);

    let (nodes, places) = in_order(hierarchy, |aabb| Aabb { min: scaled(aabb.min), max: scaled(aabb.max) });
    let levels = nodes.iter().map(|node| node.depth + 2).max().unwrap_or(0);
    let triangles: Vec<&[Place]> = places.chunk_by(|a, b| a.index == b.index).collect();
    let sums = parallel::map(triangles.chunks(CHUNK).collect(), |triangles: &[&[Place]]| {
        let mut parts = alloc::vec![Polygon::EMPTY; levels];
        let (mut cost, mut area) = (0.0, 0.0);
        for places in triangles {
            parts[0].set(&corners(places[0].index as usize).map(&scaled));
            let own = parts[0].area();
            // False if the area is NaN.
            if own > 0.0 {
                cost += foreign_cost(&nodes, places, &mut parts);
                area += own;
            }
        }
        (cost, area)
    });
    let (cost, area) = sums.into_iter().fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
    if area > 0.0 { cost / area } else { 0.0 }
}

/// Returns the sum of cost times area over the nodes that a triangle is not below.
///
/// The area is that of the triangle's part in the node's box. `parts` has the triangle, and room
/// for the rest of it at each depth.
fn foreign_cost(nodes: &[Node], places: &[Place], parts: &mut [Polygon]) -> f64 {
    let (mut sum, mut number) = (0.0, 0);
    while let Some(node) = nodes.get(number) {
        let (above, below) = parts.split_at_mut(node.depth + 1);
        let part = &mut below[0];
        part.set_to_part(&above[node.depth], &node.aabb);
        let next = places.partition_point(|place| place.leaf < number);
        let is_own = places.get(next).is_some_and(|place| place.leaf < node.end);
        let area = if is_own { 0.0 } else { part.area() };
        sum += node.cost * area;
        let is_done = part.is_empty() || (!is_own && area == 0.0);
        number = if is_done { node.end } else { number + 1 };
    }
    sum
}

/// Returns all nodes, depth first, and the primitives in leaves, by index.
fn in_order<S: Scalar, H: Outline<S>>(
    hierarchy: &H,
    scaled: impl Fn(Aabb<S>) -> Aabb<f64>,
) -> (Vec<Node>, Vec<Place>) {
    let (mut nodes, mut places): (Vec<Node>, _) = (Vec::new(), Vec::new());
    let mut path: Vec<usize> = Vec::new();
    let mut open: Vec<_> = hierarchy.root().map(|root| (root, hierarchy.aabb(), 0)).into_iter().collect();
    while let Some((place, aabb, depth)) = open.pop() {
        let number = nodes.len();
        path.drain(depth..).for_each(|done| nodes[done].end = number);
        path.push(number);
        let mut primitives = 0;
        hierarchy.open(place, |part| match part {
            Part::Child(aabb, place) => open.push((place, aabb, depth + 1)),
            Part::Primitive(index) => {
                primitives += 1;
                places.push(Place { index, leaf: number });
            }
        });
        // The same costs as in the SAH cost.
        let cost = if primitives > 0 { f64::from(primitives) } else { 1.0 };
        nodes.push(Node { aabb: scaled(aabb), depth, end: 0, cost });
    }
    let end = nodes.len();
    path.into_iter().for_each(|done| nodes[done].end = end);
    places.sort_unstable();
    (nodes, places)
}

#[cfg(test)]
mod tests;
