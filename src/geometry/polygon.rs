//! A flat convex polygon that boxes clip.

use super::{Aabb, Scalar, cross, dot};
use alloc::vec::Vec;
use core::mem::swap;

/// The coordinates x, y and z.
type Point = [f64; 3];

/// A flat convex polygon: its corners in order, none if the polygon is empty.
#[derive(Clone, Debug)]
pub(crate) struct Polygon {
    corners: Vec<Point>,
    aabb: Aabb<f64>,
    /// The corners before the last cut, kept to reuse their memory.
    before: Vec<Point>,
}

impl Polygon {
    pub const EMPTY: Self = Self { corners: Vec::new(), aabb: Aabb::EMPTY, before: Vec::new() };

    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    pub fn set(&mut self, corners: &[Point]) {
        self.corners.clear();
        self.corners.extend_from_slice(corners);
        self.bound();
    }

    /// Becomes the part of `whole` inside a box, whose faces count as inside.
    ///
    /// The algorithm is that of Sutherland and Hodgman (1974).
    pub fn set_to_part(&mut self, whole: &Self, within: &Aabb<f64>) {
        self.corners.clear();
        if !whole.aabb.intersection(*within).is_empty() {
            self.corners.extend_from_slice(&whole.corners);
            for axis in 0..3 {
                if whole.aabb.min[axis] < within.min[axis] {
                    self.cut(axis, within.min[axis], 1.0);
                }
                if whole.aabb.max[axis] > within.max[axis] {
                    self.cut(axis, within.max[axis], -1.0);
                }
            }
        }
        self.bound();
    }

    /// Keeps the part above a plane across an axis, or below it if `up` is -1.
    fn cut(&mut self, axis: usize, plane: f64, up: f64) {
        swap(&mut self.corners, &mut self.before);
        self.corners.clear();
        let height = |corner: Point| (corner[axis] - plane) * up;
        let Some(&(mut from)) = self.before.last() else { return };
        for &to in &self.before {
            let (start, end) = (height(from), height(to));
            if (start < 0.0 && end > 0.0) || (start > 0.0 && end < 0.0) {
                let part = start / (start - end);
                let between = |axis: usize| from[axis] + (to[axis] - from[axis]) * part;
                let mut crossing = [between(0), between(1), between(2)];
                // Exactly on the plane, so that boxes below in the tree, with the same face,
                // do not cut again.
                crossing[axis] = plane;
                self.corners.push(crossing);
            }
            if end >= 0.0 {
                self.corners.push(to);
            }
            from = to;
        }
    }

    fn bound(&mut self) {
        self.aabb = Aabb::of_points(self.corners.iter().copied());
    }

    pub fn area(&self) -> f64 {
        let [first, rest @ ..] = &self.corners[..] else { return 0.0 };
        let edge = |corner: &Point| [corner[0] - first[0], corner[1] - first[1], corner[2] - first[2]];
        let normal = rest.windows(2).fold([0.0; 3], |[x, y, z], pair| {
            let [dx, dy, dz] = cross(edge(&pair[0]), edge(&pair[1]));
            [x + dx, y + dy, z + dz]
        });
        0.5 * Scalar::sqrt(dot(normal, normal))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the area of the part of a triangle that is inside a box.
    ///
    /// The corners of the triangle are (0, 0), (4, 0) and (0, 4) at z = 1.
    fn left(min: [f64; 3], max: [f64; 3]) -> f64 {
        let (mut whole, mut part) = (Polygon::EMPTY, Polygon::EMPTY);
        whole.set(&[[0.0, 0.0, 1.0], [4.0, 0.0, 1.0], [0.0, 4.0, 1.0]]);
        assert_eq!(whole.area(), 8.0);
        part.set_to_part(&whole, &Aabb { min, max });
        part.area()
    }

    #[test]
    fn a_box_leaves_what_is_inside() {
        assert_eq!(left([-1.0; 3], [5.0; 3]), 8.0);
        assert_eq!(left([0.0, 0.0, 1.0], [4.0, 4.0, 1.0]), 8.0, "faces are inside");
        assert_eq!(left([0.0; 3], [1.0; 3]), 1.0);
        assert_eq!(left([1.0, 0.0, 0.0], [9.0; 3]), 4.5);
        assert_eq!(left([-9.0, 1.0, 0.0], [9.0; 3]), 4.5);
        assert_eq!(left([0.0; 3], [3.0; 3]), 7.0, "of five corners");
        assert_eq!(left([1.0, 1.0, 0.0], [2.5, 2.5, 9.0]), 1.75, "of six");
    }

    #[test]
    fn a_box_beside_leaves_nothing() {
        assert_eq!(left([0.0, 0.0, 1.5], [4.0, 4.0, 2.0]), 0.0);
        assert_eq!(left([2.5, 2.5, 0.0], [4.0, 4.0, 2.0]), 0.0, "beside the slope, in the triangle's box");
        assert_eq!(left([2.0, 2.0, 0.0], [4.0, 4.0, 2.0]), 0.0, "a corner at the slope");
        assert_eq!(left([4.0, 0.0, 0.0], [5.0; 3]), 0.0, "a face at a corner");
        assert_eq!(left([0.0, -1.0, 0.0], [4.0, 0.0, 2.0]), 0.0, "a face at an edge");
    }
}
