//! Checks of the invariants that queries rely on, one by one, for any layout.

use crate::geometry::{Aabb, Scalar};
use crate::layout::{Outline, Part};
use crate::tree::MAX_DEPTH;
use alloc::vec::Vec;
use core::fmt;

/// The first broken invariant of a hierarchy.
///
/// A hierarchy as built by this crate breaks none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum InvariantError {
    /// A node refers to a child that does not exist.
    DanglingChild {
        /// The depth of the missing child.
        depth: usize,
    },
    /// An inner node is shared or empty.
    ///
    /// There are more paths to inner nodes than references in leaves. So a node is reached twice,
    /// or has no primitive below it.
    SharedNode {
        /// The depth of the first node beyond that number.
        depth: usize,
    },
    /// The boxes on the paths to a primitive do not cover its own box.
    ///
    /// The primitive is in no leaf, or a ray may miss the box of one of its leaves, or
    /// of a node above that leaf.
    Coverage {
        /// The index of the primitive in the input.
        index: usize,
        /// The number of leaves that have the primitive.
        leaves: usize,
    },
    /// A leaf has an index that is not in the input, or was skipped.
    UnknownPrimitive {
        /// The index.
        index: usize,
    },
    /// A leaf, or an inner node, is deeper than [`MAX_DEPTH`].
    TooDeep {
        /// The depth of that leaf or node.
        depth: usize,
    },
}

impl fmt::Display for InvariantError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::DanglingChild { depth } => write!(f, "a child at depth {depth} does not exist"),
            Self::SharedNode { depth } => write!(f, "a node at depth {depth} is reached twice, or is empty"),
            Self::Coverage { index, leaves } => {
                write!(
                    f,
                    "primitive {index} is in {leaves} leaves, on the ways to which boxes do not cover its own"
                )
            }
            Self::UnknownPrimitive { index } => write!(f, "a leaf has the unknown primitive {index}"),
            Self::TooDeep { depth } => write!(f, "a leaf has depth {depth}, the bound is {MAX_DEPTH}"),
        }?;
        f.write_str(": a primitive's box changed after the build, or differs from call to call")
    }
}

impl core::error::Error for InvariantError {}

/// Checks every invariant of a hierarchy over the primitives with `indices`.
///
/// `aabb_of(index)` is the box of a primitive. The check terminates for any content. The walk over
/// a valid hierarchy takes O(nodes + references).
///
/// Boxes need not be inside one another. They must contain all that is below them: queries rely on
/// no more. The boxes of a compact tree are rounded outward, each by itself.
pub(crate) fn check<S: Scalar, H: Outline<S>>(
    hierarchy: &H,
    indices: impl Iterator<Item = usize>,
    aabb_of: impl Fn(usize) -> Aabb<S>,
) -> Result<(), InvariantError> {
    let mut is_known: Vec<bool> = Vec::new();
    for index in indices {
        is_known.resize(is_known.len().max(index + 1), false);
        is_known[index] = true;
    }
    // Each primitive found in a leaf, and the intersection of all boxes on the path to it.
    let mut places: Vec<(usize, Aabb<S>)> = Vec::new();
    // A tree has fewer inner nodes than references: beyond that, a node is shared or empty.
    let (mut budget, mut error) = (hierarchy.references(), None);
    let mut open: Vec<_> = hierarchy.root().map(|root| (root, hierarchy.aabb(), 0)).into_iter().collect();
    while let Some((place, within, depth)) = open.pop() {
        if depth > MAX_DEPTH {
            return Err(InvariantError::TooDeep { depth });
        }
        let mut is_leaf = false;
        let exists = hierarchy.open(place, |part| match part {
            Part::Child(aabb, place) => open.push((place, aabb.intersection(within), depth + 1)),
            Part::Primitive(index) => {
                is_leaf = true;
                let index = index as usize;
                if is_known.get(index) == Some(&true) {
                    places.push((index, within));
                } else {
                    error = error.or(Some(InvariantError::UnknownPrimitive { index }));
                }
            }
        });
        if !exists {
            return Err(InvariantError::DanglingChild { depth });
        }
        if let Some(error) = error {
            return Err(error);
        }
        if !is_leaf {
            budget = budget.checked_sub(1).ok_or(InvariantError::SharedNode { depth })?;
        }
    }
    places.sort_by_key(|&(index, _)| index);
    let mut rest = places.as_slice();
    for index in (0..is_known.len()).filter(|&index| is_known[index]) {
        let (of_this, of_others) = rest.split_at(rest.partition_point(|&(other, _)| other <= index));
        rest = of_others;
        if of_this.is_empty() || !is_covered(aabb_of(index), of_this) {
            return Err(InvariantError::Coverage { index, leaves: of_this.len() });
        }
    }
    Ok(())
}

/// Returns whether the boxes of `places` cover `aabb`.
///
/// They do if one of them contains it. They also do if a face of one of them cuts it into two
/// parts, and they cover both parts.
fn is_covered<S: Scalar>(aabb: Aabb<S>, places: &[(usize, Aabb<S>)]) -> bool {
    let mut open = alloc::vec![aabb];
    while let Some(aabb) = open.pop() {
        if places.iter().any(|(_, place)| place.contains(&aabb)) {
            continue;
        }
        let faces = places.iter().flat_map(|(_, place)| {
            (0..3).flat_map(|axis| [(axis, place.min[axis]), (axis, place.max[axis])])
        });
        let mut inside = faces.filter(|&(axis, face)| aabb.min[axis] < face && face < aabb.max[axis]);
        let Some((axis, face)) = inside.next() else { return false };
        let (mut below, mut above) = (aabb, aabb);
        (below.max[axis], above.min[axis]) = (face, face);
        open.extend([below, above]);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::{Child, Node, Tree};
    use crate::{Bvh, Primitive, Sphere};

    /// Returns more spheres than `MAX_DEPTH`.
    ///
    /// So a path can be too long before nodes are too many.
    fn spheres() -> Vec<Sphere> {
        (0..100u8).map(|i| Sphere::new([f32::from(i), f32::from(i % 7), 0.0], 0.25)).collect()
    }

    /// Builds a valid tree, breaks it, and returns the error that the check finds.
    fn broken(change: impl FnOnce(&mut Tree)) -> InvariantError {
        let spheres = spheres();
        let bvh = Bvh::builder().layout::<Tree>().max_leaf_size(2).build(&spheres).unwrap();
        let mut tree = bvh.layout().clone();
        let found = |tree: &Tree| check(tree, 0..spheres.len(), |index| spheres[index].aabb());
        assert_eq!(found(&tree), Ok(()));
        change(&mut tree);
        found(&tree).unwrap_err()
    }

    /// Does the same with boxes around everything.
    ///
    /// So no box is too small for a primitive that is moved into it.
    fn broken_inside(change: impl FnOnce(&mut Tree)) -> InvariantError {
        broken(|tree| {
            let everything = Node::new([tree.aabb; 2]).planes;
            tree.nodes.iter_mut().for_each(|node| node.planes = everything);
            change(tree);
        })
    }

    fn leaf_of(tree: &mut Tree) -> &mut Child {
        tree.nodes.iter_mut().flat_map(|node| &mut node.children).find(|child| child.is_leaf()).unwrap()
    }

    #[test]
    fn each_broken_invariant_is_named() {
        let is_loose = |found| matches!(found, InvariantError::Coverage { leaves: 1, .. });
        assert!(is_loose(broken(|t| t.nodes[0].planes[0][0][1] += 1.0)));
        assert!(is_loose(broken(|t| t.aabb.max[1] -= 1.0)));
        assert!(matches!(broken(|t| leaf_of(t).first = 777), InvariantError::DanglingChild { .. }));
        assert_eq!(
            broken(|t| t.nodes[0].children[0] = Child::inner(500)),
            InvariantError::DanglingChild { depth: 1 }
        );
        assert_eq!(broken(|t| t.indices[3] = 999), InvariantError::UnknownPrimitive { index: 999 });
        assert_eq!(
            broken_inside(|t| *t.indices.iter_mut().find(|index| **index == 3).unwrap() = 4),
            InvariantError::Coverage { index: 3, leaves: 0 }
        );
        assert_eq!(
            broken_inside(|t| *t.indices.iter_mut().find(|index| **index == 4).unwrap() = 3),
            InvariantError::Coverage { index: 4, leaves: 0 }
        );
        // The walk visits the root's second child first, and again by way of the first child.
        assert!(matches!(
            broken_inside(|t| t.nodes[0].children[0] = Child::inner(0)),
            InvariantError::SharedNode { .. }
        ));
        assert_eq!(
            broken_inside(|t| t.nodes[0].children[1] = Child::inner(0)),
            InvariantError::TooDeep { depth: MAX_DEPTH + 1 }
        );
    }

    #[test]
    fn parts_of_a_box_cover_it_only_together() {
        let aabb = |min: [f32; 2], max: [f32; 2]| Aabb::new([min[0], min[1], 0.0], [max[0], max[1], 1.0]);
        let (left, right) = (aabb([0.0, 0.0], [1.0, 2.0]), aabb([1.0, 0.0], [3.0, 2.0]));
        let corner = aabb([2.0, 1.0], [3.0, 2.0]);
        let covers = |places: &[Aabb]| {
            let places: Vec<_> = places.iter().map(|&place| (0, place)).collect();
            is_covered(aabb([0.0, 0.0], [3.0, 2.0]), &places)
        };
        assert!(covers(&[left, right]) && covers(&[right, corner, left]));
        assert!(!covers(&[left, corner]) && !covers(&[right]) && !covers(&[]));
    }

    /// Checks a layout against the primitives of the build, and three other lists.
    fn mismatches<H: Outline<f32>>(layout: &H) -> [Result<(), InvariantError>; 4] {
        let spheres = spheres();
        let grown = |index: usize| Sphere { radius: if index == 7 { 9.0 } else { 0.25 }, ..spheres[index] };
        let same = |index: usize| spheres[index].aabb();
        [
            check(layout, 0..100, same),
            check(layout, 0..101, same),
            check(layout, (0..100).filter(|&index| index != 42), same),
            check(layout, 0..100, |index| grown(index).aabb()),
        ]
    }

    #[test]
    fn other_primitives_than_those_of_the_build_are_found_in_any_layout() {
        let (wide, binary) =
            (Bvh::build(spheres()).unwrap(), Bvh::builder().layout::<Tree>().build(spheres()));
        for found in [mismatches(wide.layout()), mismatches(binary.unwrap().layout())] {
            let [same, more, fewer, grown] = found;
            assert_eq!(same, Ok(()));
            assert_eq!(more, Err(InvariantError::Coverage { index: 100, leaves: 0 }));
            assert_eq!(fewer, Err(InvariantError::UnknownPrimitive { index: 42 }));
            assert_eq!(grown, Err(InvariantError::Coverage { index: 7, leaves: 1 }));
        }
    }
}
