//! The measured methods of building, and the hierarchies that they build.

use crate::agreement::{Answers, bare};
use bvhkit::heuristic::{Heuristic, SpatialSah};
use bvhkit::{
    Builder, Bvh, CompactTree, Fast, Quality, Ray, Traverse, Tree, TreeReport, Triangle, WideTree, Workspace,
};

/// A primitive in the mode that has the least work beside the build.
pub type Item = Fast<Triangle>;

/// A method of building, on the threads of the pool that it is called in.
pub struct Method {
    pub layout: &'static str,
    pub preset: &'static str,
    build: Box<Build>,
}

/// A build, in the memory of a workspace if there is one.
type Build = dyn Fn(Option<&mut Workspace>, Vec<Item>) -> Box<dyn Built> + Sync;

impl Method {
    /// Builds a hierarchy that keeps the list of triangles.
    ///
    /// So all memory that the build allocates is beside the triangles.
    pub fn build(&self, triangles: Vec<Item>) -> Box<dyn Built> {
        (self.build)(None, triangles)
    }

    /// Builds the same hierarchy in the memory of a workspace.
    pub fn build_in(&self, workspace: &mut Workspace, triangles: Vec<Item>) -> Box<dyn Built> {
        (self.build)(Some(workspace), triangles)
    }
}

/// Returns the methods of all layouts, those of the default layout first.
///
/// In each layout, the default preset is second.
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
    let build = move |workspace: Option<&mut Workspace>, triangles| -> Box<dyn Built> {
        let builder = builder.clone();
        let built = match workspace {
            Some(workspace) => builder.build_in(workspace, triangles),
            None => builder.build(triangles),
        };
        Box::new(built.expect("the coordinates are finite"))
    };
    Method { layout, preset, build: Box::new(build) }
}

/// A hierarchy that was built.
pub trait Built: Send {
    /// Checks the invariants.
    ///
    /// # Panics
    ///
    /// If an invariant is broken.
    fn check(&self, what: &str);
    fn answers(&self, rays: &[Ray]) -> Answers;
    fn report(&self) -> TreeReport;
    /// Returns the bytes of memory, with the triangles.
    fn bytes(&self) -> usize;
    /// Leaves the memory to the workspace and returns the triangles.
    fn recycle(self: Box<Self>, workspace: &mut Workspace) -> Vec<Item>;
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
    fn recycle(self: Box<Self>, workspace: &mut Workspace) -> Vec<Item> {
        (*self).recycle(workspace)
    }
}
