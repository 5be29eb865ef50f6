//! The Pareto front: the points that no other beats in both respects.

/// Returns the indices of the points on the Pareto front, from left to right.
///
/// A point is on the front if no other with at most its x has at least its y. Of
/// equal points, one is on the front.
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| points[a].0.total_cmp(&points[b].0).then(points[b].1.total_cmp(&points[a].1)));
    let mut best = f64::NEG_INFINITY;
    order.retain(|&place| {
        let is_better = points[place].1 > best;
        best = best.max(points[place].1);
        is_better
    });
    order
}

#[cfg(test)]
mod tests {
    use super::front;

    #[test]
    fn beaten_points_are_left_out() {
        let points = [(3.0, 3.0), (1.0, 1.0), (2.0, 0.5), (2.0, 2.0), (3.0, 2.5), (4.0, 3.0)];
        assert_eq!(front(&points), [1, 3, 0]);
        assert!(front(&[]).is_empty());
    }
}
