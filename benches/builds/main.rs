//! Times builds of many sizes and over nasty input, with their memory and depth.
//!
//! `cargo bench --bench builds` prints tables in Markdown. No time is printed before the tree is
//! checked and its answers are compared with those of the naive reference.
//!
//! The environment variable `BVHKIT_TRIANGLES` is the largest number of triangles, ten million by
//! default. `RAYON_NUM_THREADS` is the number of threads where all are used.

mod check;
mod first;
mod memory;
mod methods;
mod nasty;
mod nasty_table;
mod sizes;

#[path = "../shared/agreement.rs"]
#[expect(dead_code, reason = "none but this crate's trees are built, which do not disagree")]
mod agreement;
#[path = "../shared/columns.rs"]
mod columns;
#[path = "../shared/extent.rs"]
mod extent;
#[path = "../../tests/support/scenes/mod.rs"]
#[expect(dead_code, reason = "some scenes are enough")]
mod scenes;
#[path = "../shared/timing.rs"]
#[expect(dead_code, reason = "no rays are timed")]
mod timing;

use anyhow::{Context, Result};
use rayon::{ThreadPool, ThreadPoolBuilder};

/// The amount of work.
struct Extent {
    /// Numbers of triangles. A surface may have a few less.
    sizes: Vec<usize>,
    /// Triangles of each nasty list.
    nasty: usize,
    /// Tests of one triangle that the naive reference may spend on a list.
    naive_tests: usize,
    /// Triangles that each method builds over for its times, in all repetitions.
    timed: usize,
    /// The smallest and the largest number of repetitions.
    repetitions: (usize, usize),
}

impl Extent {
    fn bench() -> Self {
        let sizes = vec![10_000, 100_000, 1_000_000, 10_000_000];
        Self { sizes, nasty: 200_000, naive_tests: 100_000_000, timed: 10_000_000, repetitions: (3, 15) }
    }

    /// Returns just enough work to see that everything runs.
    ///
    /// The larger size is one that threads share.
    fn test() -> Self {
        let sizes = vec![300, 20_000];
        Self { sizes, nasty: 1_000, naive_tests: 1_000_000, timed: 0, repetitions: (2, 2) }
    }

    /// Replaces numbers of triangles above `largest` by `largest`.
    fn limit(&mut self, largest: usize) {
        for size in self.sizes.iter_mut().chain([&mut self.nasty]) {
            *size = largest.min(*size);
        }
        self.sizes.dedup();
    }

    fn repetitions(&self, triangles: usize) -> usize {
        (self.timed / triangles).clamp(self.repetitions.0, self.repetitions.1)
    }
}

/// A pool of one thread, and a pool of all.
type Pools = [ThreadPool; 2];

fn main() -> Result<()> {
    let mut extent = if extent::is_bench() {
        Extent::bench()
    } else {
        println!("To see that everything runs: times of so few builds tell nothing.");
        Extent::test()
    };
    if let Some(largest) = std::env::var_os("BVHKIT_TRIANGLES") {
        let largest = largest.to_str().and_then(|number| number.parse().ok()).filter(|&number| number > 0);
        extent.limit(largest.context("BVHKIT_TRIANGLES is a number of triangles, from 1 on")?);
    }
    let pool = |threads| ThreadPoolBuilder::new().num_threads(threads).build();
    let pools = [pool(1)?, pool(0)?];
    let methods = methods::all();
    // First, because its first build has to be the first of the process.
    first::print(&extent, &pools, &methods);
    sizes::print(&extent, &pools, &methods);
    nasty_table::print(&extent, &pools, &methods);
    Ok(())
}
