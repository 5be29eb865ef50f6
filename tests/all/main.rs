//! The tests of what is public, all in one program: they compile the same kernels, in many modes for many instruction sets.
//! As twenty programs they took twice as long to compile.
//!
//! Apart from these, `portable` needs a feature, and `workspace` counts what the whole process allocates.

mod common;
mod generate;
#[path = "../../examples/path_tracer/scene/mod.rs"]
#[expect(dead_code, reason = "the renderer's half of the loader")]
mod scene;

mod api;
mod closed_meshes;
mod compact;
mod determinism;
mod exact;
mod exact_grid;
mod extreme_rays;
mod extremes;
mod hostile;
mod invalid_primitives;
mod layouts;
mod many_rays;
mod oracle;
mod properties;
mod random_bits;
mod real_files;
mod spawn;
mod splits;
mod trees;
