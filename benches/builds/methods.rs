//! What is measured: ways to build, and what they build.

use crate::agreement::{Answers, bare};
use bvhkit::heuristic::{Heuristic, SpatialSah};
use bvhkit::{Builder, Bvh, CompactTree, Fast, Quality, Ray, Traverse, Tree, TreeReport, Triangle, WideTree};

/// The mode that has the least to do beside the build.
pub type Item = Fast<Triangle>;

/// A way to build, on the threads of the pool that it is called in.
pub struct Method {
    pub layout: &'static str,
    pub preset: &'static str,
    /// Keeps the list, so that what it allocates is all beside the triangles.
    pub build: Box<dyn Fn(Vec<Item>) -> Box<dyn Built> + Sync>,
}

/// The default layout's first, and of each layout the default preset second.
pub fn all() -> Vec<Method> {
    let layouts = [of::<WideTree>("wide"), of::<CompactTree>("compact"), of::<Tree>("binary")];
    layouts.into_iter().flatten().collect()
}

fn of<L: Traverse<Item> + 'static>(layout: &'static str) -> [Method; 4] {
    let builder = || Bvh::builder().layout::<L>();
    [
        method(layout, "`Fast`", builder().quality(Quality::Fast)),
        method(layout, "`Balanced`", builder().quality(Quality::Balanced)),
        method(layout, "`High`", builder().quality(Quality::High)),
        method(layout, "`SpatialSah`", builder().heuristic(SpatialSah::default())),
    ]
}

fn method<H, L>(layout: &'static str, preset: &'static str, builder: Builder<Item, H, L>) -> Method
where
    H: Heuristic<f32> + Clone + 'static,
    L: Traverse<Item> + 'static,
{
    let build = move |triangles| -> Box<dyn Built> {
        Box::new(builder.clone().build(triangles).expect("the coordinates are finite"))
    };
    Method { layout, preset, build: Box::new(build) }
}

/// A hierarchy that was built.
pub trait Built: Send {
    /// # Panics
    /// If an invariant is broken.
    fn check(&self, what: &str);
    fn answers(&self, rays: &[Ray]) -> Answers;
    fn report(&self) -> TreeReport;
    /// With the triangles.
    fn bytes(&self) -> usize;
}

impl<L: Traverse<Item>> Built for Bvh<Item, L> {
    fn check(&self, what: &str) {
        self.check().unwrap_or_else(|error| panic!("{what}: {error}"));
    }
    fn answers(&self, rays: &[Ray]) -> Answers {
        Answers {
            closest: rays.iter().map(|ray| self.closest_hit(ray).map(bare)).collect(),
            any: rays.iter().map(|ray| self.any_hit(ray)).collect(),
        }
    }
    fn report(&self) -> TreeReport {
        self.report()
    }
    fn bytes(&self) -> usize {
        self.memory_bytes()
    }
}
