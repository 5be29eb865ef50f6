//! The tests of the public API, in one program.
//!
//! They compile the same kernels, in many modes and for many instruction sets. As fifteen programs
//! they would take twice as long to compile.
//!
//! Other programs are separate: `exact` also runs as built for a single processor, `portable` needs
//! a feature, and `workspace` counts the allocations of the whole process.

#[path = "../common"]
mod common {
    pub mod agreement;
    pub mod aimed;
    pub mod alone;
    pub mod answers;
    pub mod at_hits;
    pub mod heuristics;
    pub mod hostile;
    pub mod in_every_mode;
    pub mod modes;
    pub mod naive;
    pub mod range;
    pub mod rays;
    pub mod scattered;
    pub mod soups;
    pub mod textbook;
}
#[path = "../generate"]
mod generate {
    pub mod numbers;
    pub mod primitives;
    pub mod rays;
    pub mod scenes;
}
#[path = "../../examples/path_tracer/scene/mod.rs"]
#[expect(dead_code, reason = "the renderer's half of the loader")]
mod scene;

mod api;
mod compact;
mod determinism;
mod extreme_rays;
mod extremes;
mod hostile;
mod invalid_primitives;
mod layouts;
mod many_rays;
mod properties;
mod random_bits;
mod real_files;
mod safe_arguments;
mod spawn;
mod splits;
mod trees;
