//! The measured families, one for each kind of primitive.

use crate::primitives::{discs, spheres};
use crate::shared::obvhs::{Peer, Traversal, convert};
use crate::support::scenes::NamedScene;
use crate::tracing::family::{Family, Member};
use crate::tracing::kinds::{self, Kind};
use bvhkit::{Bvh, CompactTree, Fast, Intersect, Precise, Traverse, Tree, Triangle, WideTree};
use obvhs::BvhBuildParams;
use std::rc::Rc;

/// Returns all families over a scene.
///
/// Every layout is measured over fast triangles. They are the quickest to test, so layouts
/// count for most there. The other families have the default layout alone: more would take
/// long to compile and tell little.
pub fn all(scene: &NamedScene, rays: usize) -> Vec<Family> {
    let triangles = &scene.triangles;
    let kinds: Rc<[Kind]> = kinds::all(triangles, scene, rays).into();
    let fast: Vec<_> = triangles.iter().copied().map(Fast).collect();
    let precise: Vec<_> = triangles.iter().copied().map(Precise).collect();
    let (spheres, discs) = (spheres(triangles), discs(triangles));
    let (around, among) = (kinds::all(&spheres, scene, rays), kinds::all(&discs, scene, rays));
    let layouts = vec![
        ours::<_, WideTree>("wide", &fast),
        ours::<_, CompactTree>("compact", &fast),
        ours::<_, Tree>("binary", &fast),
        peer("obvhs BVH2", triangles, Peer::bvh2),
        peer("obvhs CWBVH", triangles, Peer::cwbvh),
    ];
    vec![
        family("Fast", Rc::clone(&kinds), fast, layouts),
        default_layout("Watertight", Rc::clone(&kinds), triangles.clone()),
        default_layout("Precise", kinds, precise),
        default_layout("spheres", around.into(), spheres),
        default_layout("discs", among.into(), discs),
    ]
}

fn family<P: Intersect<Scalar = f32> + 'static>(
    name: &'static str,
    kinds: Rc<[Kind]>,
    primitives: Vec<P>,
    members: Vec<Member>,
) -> Family {
    Family { primitives: name, kinds, naive: Box::new(primitives), members }
}

fn default_layout<P>(name: &'static str, kinds: Rc<[Kind]>, primitives: Vec<P>) -> Family
where
    P: Intersect<Scalar = f32, Payload: Send> + Copy + Send + Sync + 'static,
{
    let member = ours::<_, WideTree>("wide 16", &primitives);
    family(name, kinds, primitives, vec![member])
}

fn ours<P, L>(layout: &'static str, primitives: &[P]) -> Member
where
    P: Intersect<Scalar = f32, Payload: Send> + Copy + Send + Sync + 'static,
    L: Traverse<P> + Sync + 'static,
{
    let builder = Bvh::builder().layout::<L>();
    let bvh = builder.build(primitives.iter().copied()).expect("the coordinates are finite");
    Member { name: layout.into(), ours: true, tracer: Box::new(bvh) }
}

/// Builds a tree of `obvhs` with its medium preset.
fn peer<B: Traversal + Sync + 'static>(
    layout: &'static str,
    triangles: &[Triangle],
    build: fn(BvhBuildParams, &[obvhs::triangle::Triangle]) -> Peer<B>,
) -> Member {
    let peer = build(BvhBuildParams::medium_build(), &convert(triangles));
    Member { name: layout.into(), ours: false, tracer: Box::new(peer) }
}
