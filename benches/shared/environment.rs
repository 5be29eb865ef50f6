//! The environment variables of the benches.

use super::file;
use crate::support::scenes::NamedScene;
use anyhow::Result;
use std::path::Path;

/// Loads the scene whose file the variable `BVHKIT_SCENE` names, if it is set.
pub fn scene() -> Result<Option<NamedScene>> {
    std::env::var_os("BVHKIT_SCENE").map(|path| file::scene(Path::new(&path))).transpose()
}
