//! The hierarchy that users hold, the options of a build, and its errors.

mod builder;
mod compiled;
mod error;
mod facade;
mod job;
mod options;
mod quality;
mod workspace;

pub use builder::Builder;
pub use compiled::CompiledBuild;
pub use error::BuildError;
pub use facade::Bvh;
pub use options::OnInvalid;
pub use quality::Quality;
pub use workspace::Workspace;
