//! Tests against exact arithmetic, and tests that closed meshes do not leak.
//!
//! They are a program of their own, so that they can also run as built for a single processor, for
//! which the compiler could fuse or reorder operations.

#[path = "../common"]
mod common {
    pub mod aimed;
    pub mod answers;
    pub mod closed;
    pub mod heuristics;
    pub mod hostile;
    pub mod in_every_mode;
    pub mod integers;
    pub mod modes;
    pub mod range;
    pub mod rational;
}

mod closed_meshes;
mod grid;
mod oracle;
mod small_integers;
