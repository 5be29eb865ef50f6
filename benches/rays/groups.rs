//! Criterion's groups, one for each kind of ray and scene.
//!
//! The rays are traced on one thread and in their natural order.

use crate::shared::criterion::flat_group;
use crate::tracing::family::Family;
use crate::tracing::tracer::Way;
use criterion::{Criterion, Throughput};

pub fn measure(criterion: &mut Criterion, scene: &str, families: &[Family]) {
    for (number, kind) in families[0].kinds.iter().enumerate() {
        let name = format!("{}/{scene}", kind.name);
        let mut group = flat_group(criterion, name, kind.natural.len());
        for family in families {
            let kind = &family.kinds[number];
            group.throughput(Throughput::Elements(kind.natural.len() as u64));
            for member in &family.members {
                for way in Way::ALL {
                    if let Some(mut job) = member.tracer.job(kind.query, way, &kind.natural) {
                        let name = format!("{} {} {}", family.primitives, member.name, way.name());
                        group.bench_function(name, |bencher| bencher.iter(|| job(None)));
                    }
                }
            }
        }
        group.finish();
    }
}
