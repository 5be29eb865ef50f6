//! Comparison of all answers, before anything is timed.

use super::family::{Family, Member};
use super::kinds::Kind;
use super::tracer::{Query, Way};
use crate::shared::agreement::{Answers, Hit, assert_exact};
use bvhkit::Ray;

/// The result of a check with one kind of ray.
pub struct Check {
    /// The number of rays that the naive reference answers too.
    pub sample: usize,
    /// For each member, the number of those rays on which it differs visibly.
    pub differ: Vec<usize>,
    /// The share of all rays that hit.
    pub hit: f64,
}

/// Checks a family and returns one check for each kind of ray.
///
/// # Panics
///
/// If ours do not agree, bit for bit, with the naive reference and with each other: in both
/// queries, one by one and in batches, in both orders; or if all hits differ.
pub fn check(scene: &str, family: &Family, naive_tests: usize) -> Vec<Check> {
    let tests = naive_tests / family.kinds.len();
    family.kinds.iter().map(|kind| check_kind(scene, family, kind, tests)).collect()
}

fn check_kind(scene: &str, family: &Family, kind: &Kind, naive_tests: usize) -> Check {
    let Kind { natural, shuffled, order, .. } = kind;
    let step = (natural.len() * family.naive.count()).div_ceil(naive_tests).max(1);
    let places: Vec<usize> = (0..natural.len()).step_by(step).collect();
    let sample: Vec<Ray> = places.iter().map(|&place| natural[place]).collect();
    let naive = family.naive.answers(&sample);
    let ours = answers(&family.members[0], Way::Single, natural);
    let hits = ours.any.iter().filter(|&&any| any).count();
    let mut check =
        Check { sample: sample.len(), differ: Vec::new(), hit: hits as f64 / natural.len() as f64 };
    for member in &family.members {
        let what = |way: Way| {
            format!("{} {}, {} {} on {scene}", family.primitives, member.name, way.name(), kind.name)
        };
        if member.ours {
            for way in Way::ALL {
                let (on_natural, on_shuffled) =
                    (answers(member, way, natural), answers(member, way, shuffled));
                assert_exact(&what(way), &sample, &naive, &select(&on_natural, &places));
                assert_exact(&what(way), natural, &ours, &on_natural);
                assert_exact(&what(way), shuffled, &select(&ours, order), &on_shuffled);
            }
        }
        if kind.query == Query::All {
            assert_all_hits(&what(Way::Single), family, member, &sample);
        }
        let on_sample = answers(member, Way::Single, &sample);
        check.differ.push(family.naive.disagreements(&sample, &naive, &on_sample).visible());
    }
    check
}

fn answers(member: &Member, way: Way, rays: &[Ray]) -> Answers {
    let mut answers = Answers::default();
    for query in [Query::Closest, Query::Any] {
        let mut job = member.tracer.job(query, way, rays).expect("the others than ours are asked one by one");
        job(Some(&mut answers));
    }
    answers
}

fn select(answers: &Answers, places: &[usize]) -> Answers {
    Answers {
        closest: places.iter().map(|&place| answers.closest[place]).collect(),
        any: places.iter().map(|&place| answers.any[place]).collect(),
    }
}

fn assert_all_hits(what: &str, family: &Family, member: &Member, rays: &[Ray]) {
    let bits = |hits: &[Hit]| hits.iter().map(|hit| (hit.t.to_bits(), hit.index)).collect::<Vec<_>>();
    for ray in rays {
        let Some(actual) = member.tracer.all_hits(ray) else { return };
        let expected = family.naive.all_hits(ray);
        assert!(
            bits(&expected) == bits(&actual),
            "{what}: {ray:?} should hit {expected:?}, but the answer is {actual:?}"
        );
    }
}
