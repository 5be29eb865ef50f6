//! The invariants that queries rely on, checked one by one, for any layout.

use super::MAX_DEPTH;
use crate::geometry::{Aabb, Scalar};
use crate::layout::{Outline, Part};
use alloc::vec::Vec;
use core::fmt;

/// The first invariant of a hierarchy found broken. One that this crate built has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum InvariantError {
    /// A node refers to a child that does not exist.
    DanglingChild {
        /// The depth at which the child should be.
        depth: usize,
    },
    /// There are more ways to inner nodes than primitives: one is reached twice, or has no primitive below it.
    SharedNode {
        /// The depth of the node that was one too many.
        depth: usize,
    },
    /// A primitive is in no leaf, or in several.
    Coverage {
        /// Its index in the input.
        index: usize,
        /// In how many leaves it is.
        leaves: usize,
    },
    /// A leaf has an index that is not in the input, or was skipped.
    UnknownPrimitive {
        /// The index.
        index: usize,
    },
    /// A leaf is deeper than [`MAX_DEPTH`].
    TooDeep {
        /// Its depth.
        depth: usize,
    },
    /// A box does not contain what is below it.
    LooseBox {
        /// The depth of the node or leaf whose box it is; 0 is that around everything.
        depth: usize,
    },
}

impl fmt::Display for InvariantError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::DanglingChild { depth } => write!(f, "a child at depth {depth} does not exist"),
            Self::SharedNode { depth } => write!(f, "a node at depth {depth} is reached twice, or is empty"),
            Self::Coverage { index, leaves } => {
                write!(f, "primitive {index} is in {leaves} leaves, not in one")
            }
            Self::UnknownPrimitive { index } => write!(f, "a leaf has the unknown primitive {index}"),
            Self::TooDeep { depth } => write!(f, "a leaf has depth {depth}, the bound is {MAX_DEPTH}"),
            Self::LooseBox { depth } => write!(f, "a box at depth {depth} does not contain what is below it"),
        }?;
        f.write_str(": a primitive's box changed after the build, or differs from call to call")
    }
}

impl core::error::Error for InvariantError {}

/// Checks every invariant of a hierarchy over the primitives with `indices`, whose boxes are `aabb_of(index)`.
///
/// Terminates for any content, in O(nodes + primitives): no path is longer than `MAX_DEPTH`. Boxes need not lie in each other, only
/// around all primitives below them, which is what queries rely on: those of a compact tree are rounded outward each by itself.
pub(crate) fn check<S: Scalar, H: Outline<S>>(
    hierarchy: &H,
    indices: impl Iterator<Item = usize>,
    aabb_of: impl Fn(usize) -> Aabb<S>,
) -> Result<(), InvariantError> {
    let mut leaves_of: Vec<Option<u32>> = Vec::new();
    for index in indices {
        leaves_of.resize(leaves_of.len().max(index + 1), None);
        leaves_of[index] = Some(0);
    }
    // A tree has fewer inner nodes than primitives: more must have been seen before.
    let (mut budget, mut error) = (hierarchy.len(), None);
    let mut open: Vec<_> = hierarchy.root().map(|root| (root, hierarchy.aabb(), 0)).into_iter().collect();
    // The boxes on the way to a place, by depth: what is below a place is popped before what was pushed before it.
    let mut path = Vec::with_capacity(MAX_DEPTH + 1);
    while let Some((place, aabb, depth)) = open.pop() {
        if depth > MAX_DEPTH {
            return Err(InvariantError::TooDeep { depth });
        }
        path.truncate(depth);
        path.push(aabb);
        let (mut below, mut is_leaf) = (Aabb::EMPTY, false);
        let exists = hierarchy.open(place, |part| match part {
            Part::Child(aabb, place) => open.push((place, aabb, depth + 1)),
            Part::Primitive(index) => {
                is_leaf = true;
                match leaves_of.get_mut(index as usize) {
                    Some(Some(leaves)) => {
                        *leaves += 1;
                        below = below.union(aabb_of(index as usize));
                    }
                    _ => error = error.or(Some(InvariantError::UnknownPrimitive { index: index as usize })),
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
        if let Some(depth) = path.iter().rposition(|aabb| !aabb.contains(&below)) {
            return Err(InvariantError::LooseBox { depth });
        }
    }
    match leaves_of.iter().position(|leaves| leaves.is_some_and(|leaves| leaves != 1)) {
        Some(index) => {
            Err(InvariantError::Coverage { index, leaves: leaves_of[index].unwrap_or_default() as usize })
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::{Child, Node, Tree};
    use crate::{Bvh, Primitive, Sphere};

    /// More than there are depths, so that a path can be too long without a node too many.
    fn spheres() -> Vec<Sphere> {
        (0..100u8).map(|i| Sphere::new([f32::from(i), f32::from(i % 7), 0.0], 0.25)).collect()
    }

    /// Builds a good tree, breaks it, and says what the check finds.
    fn broken(change: impl FnOnce(&mut Tree)) -> InvariantError {
        let spheres = spheres();
        let bvh = Bvh::builder().layout::<Tree>().max_leaf_size(2).build(&spheres).unwrap();
        let mut tree = bvh.layout().clone();
        let found = |tree: &Tree| check(tree, 0..spheres.len(), |index| spheres[index].aabb());
        assert_eq!(found(&tree), Ok(()));
        change(&mut tree);
        found(&tree).unwrap_err()
    }

    /// The same where no box can be too small for what is moved into it.
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
        assert_eq!(broken(|t| t.nodes[0].planes[0][0][1] += 1.0), InvariantError::LooseBox { depth: 1 });
        assert_eq!(broken(|t| t.aabb.max[1] -= 1.0), InvariantError::LooseBox { depth: 0 });
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
            InvariantError::Coverage { index: 3, leaves: 2 }
        );
        // The root's second child is visited first, and then is visited again.
        assert!(matches!(
            broken_inside(|t| t.nodes[0].children[0] = Child::inner(0)),
            InvariantError::SharedNode { .. }
        ));
        assert_eq!(
            broken_inside(|t| t.nodes[0].children[1] = Child::inner(0)),
            InvariantError::TooDeep { depth: MAX_DEPTH + 1 }
        );
    }

    /// What a check against other primitives than those of the build finds.
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
            assert!(matches!(grown, Err(InvariantError::LooseBox { depth: 1.. })));
        }
    }
}
