//! Tests against exact arithmetic, and that closed meshes leak nothing. Apart from the others, so that they can also be run as built
//! for one processor alone, where numbers could be fused or reordered.

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
