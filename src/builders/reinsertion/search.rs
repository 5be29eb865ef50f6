//! The search for the place where a subtree costs least.

use super::parent_links::Linked;
use crate::geometry::Scalar;
use alloc::vec::Vec;

/// A move of a subtree to a place where it costs less.
pub(super) struct Move<S> {
    pub node: u32,
    /// The node's new sibling.
    pub beside: u32,
    /// The decrease of the sum of areas.
    pub gain: S,
}

/// Maximum number of places that a search visits.
///
/// In good trees a search visits 10 to 40 places, and the bound makes no difference beyond noise.
/// Where all boxes overlap, no place can be left out: without a bound, the time of a round would
/// grow with the square of the number of nodes (measured: docs/decisions.md, 9).
const MOST_PLACES: usize = 48;

/// Returns the best move of a node, if a place is better than its own.
///
/// The search goes from the node's parent up to the root, and at each ancestor down into the other
/// side. The gain above a place is known on the way to it, and a place costs at least the node's
/// own area. If the gain above minus this cost does not exceed the best gain so far, the search
/// skips the place and everything below it. `open` is scratch memory, empty before and after.
pub(super) fn best_move<S: Scalar>(
    linked: &Linked<'_, S>,
    node: u32,
    open: &mut Vec<(S, u32)>,
) -> Option<Move<S>> {
    let parent = linked.parent(node);
    if parent == Linked::<S>::ROOT {
        return None;
    }
    let aabb = *linked.aabb(node);
    let area = linked.area_of(&aabb);
    let mut sibling = linked.sibling(node);
    // The box around everything below `pivot`, except the node.
    let mut rest = *linked.aabb(sibling);
    // The parent moves along, so its area is gained.
    let mut gained = linked.area(parent);
    let mut places = 0;
    let (mut best, mut pivot) = (Move { node, beside: node, gain: S::ZERO }, parent);
    loop {
        open.push((gained, sibling));
        while let Some((gained, place)) = open.pop() {
            if gained - area <= best.gain || places == MOST_PLACES {
                continue;
            }
            places += 1;
            let joined = linked.area_of(&linked.aabb(place).union(aabb));
            let gain = gained - joined;
            if gain > best.gain {
                (best.beside, best.gain) = (place, gain);
            }
            if let Some([left, right]) = linked.children(place) {
                let gained = gain + linked.area(place);
                if gained - area > best.gain {
                    open.push((gained, left));
                    open.push((gained, right));
                }
            }
        }
        if pivot == Linked::<S>::ROOT {
            break;
        }
        if pivot != parent {
            rest = rest.union(*linked.aabb(sibling));
            gained = gained + linked.area(pivot) - linked.area_of(&rest);
        }
        sibling = linked.sibling(pivot);
        pivot = linked.parent(pivot);
    }
    (best.gain > S::ZERO && best.beside != linked.sibling(node)).then_some(best)
}
