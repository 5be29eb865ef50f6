//! Builds hierarchies: of many sizes, and over input that is nasty; their times, what they allocate, and what they are.
//!
//! `cargo bench --bench builds` prints tables in Markdown. No time is printed before the tree was checked, and its answers
//! compared with the naive reference's. The environment variable `BVHKIT_TRIANGLES` is the largest number of triangles,
//! ten million unless set; `RAYON_NUM_THREADS` tells how many threads all are.

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

/// How much to do.
struct Extent {
    /// Triangles, by name; a surface may have a few less.
    sizes: Vec<usize>,
    /// Triangles of each list of nasty ones.
    nasty: usize,
    /// Tests of one triangle that the naive reference may spend on a list.
    naive_tests: usize,
    /// Triangles that each way to build is timed on, over all repetitions.
    timed: usize,
    /// The least and the largest number of repetitions.
    repetitions: (usize, usize),
}

impl Extent {
    fn bench() -> Self {
        let sizes = vec![10_000, 100_000, 1_000_000, 10_000_000];
        Self { sizes, nasty: 200_000, naive_tests: 100_000_000, timed: 10_000_000, repetitions: (3, 15) }
    }

    /// Just enough to see that everything runs; the larger size is one that threads share.
    fn test() -> Self {
        let sizes = vec![300, 20_000];
        Self { sizes, nasty: 1_000, naive_tests: 1_000_000, timed: 0, repetitions: (2, 2) }
    }

    /// The largest number of triangles, in place of larger ones.
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

/// One thread, and all.
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
    // Before everything else, or its first build would not be the first.
    first::print(&extent, &pools, &methods);
    sizes::print(&extent, &pools, &methods);
    nasty_table::print(&extent, &pools, &methods);
    Ok(())
}
