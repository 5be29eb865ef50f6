//! Tests of reused workspaces: they give the same hierarchies as new memory.

#[path = "../benches/builds/memory.rs"]
mod memory;
mod common {
    pub mod heuristics;
    pub mod hostile;
    pub mod scattered;
}

use bvhkit::heuristic::Heuristic;
use bvhkit::{
    BuildControl, BuildError, Builder, Bvh, CompactTree, Fast, Layout, OnInvalid, Quality, Scalar, Tree,
    Triangle, WideTree, Workspace,
};
use common::{heuristics, scattered};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

fn triangles<S: Scalar>(n: usize) -> Vec<Fast<Triangle<S>>> {
    scattered::triangles(n).into_iter().map(Fast).collect()
}

/// Locks out the other tests: one of them counts the allocations of all threads.
fn turn() -> MutexGuard<'static, ()> {
    static TURN: Mutex<()> = Mutex::new(());
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Asserts that builds in new memory and in `workspace` give the same hierarchy.
fn assert_same<S: Scalar, H: Heuristic<S> + Clone, L: Layout<Fast<Triangle<S>>> + PartialEq>(
    what: &str,
    builder: &Builder<Fast<Triangle<S>>, H, L>,
    triangles: &[Fast<Triangle<S>>],
    workspace: &mut Workspace<S>,
) {
    let new = builder.clone().build(triangles.iter().copied()).unwrap();
    let old = builder.clone().build_in(workspace, triangles.iter().copied()).unwrap();
    assert!(new.layout() == old.layout(), "{what}, {} triangles", triangles.len());
    old.check().unwrap_or_else(|error| panic!("{what}: {error}"));
    assert!(old.recycle(workspace) == triangles, "{what}: the primitives come back");
}

/// Calls [`assert_same`] with every preset and heuristic.
fn assert_all_same<S: Scalar, L: Layout<Fast<Triangle<S>>> + PartialEq>(
    layout: &str,
    triangles: &[Fast<Triangle<S>>],
    workspace: &mut Workspace<S>,
) {
    for quality in [Quality::Fast, Quality::Balanced, Quality::High] {
        let builder = Builder::<_, _, Tree<S>>::layout::<L>(Tree::builder().quality(quality));
        assert_same(&format!("{layout}, {quality:?}"), &builder, triangles, workspace);
    }
    for (name, heuristic) in &heuristics::all() {
        let builder = Tree::builder().heuristic(&**heuristic).max_leaf_size(2).layout::<L>();
        assert_same(&format!("{layout}, {name}"), &builder, triangles, workspace);
    }
}

/// All builds share a workspace, so its memory comes from other sizes and layouts.
#[test]
fn hierarchies_are_the_same_in_memory_that_others_left() {
    fn with<S: Scalar>(sizes: &[usize]) {
        let mut workspace = Workspace::<S>::new();
        for &size in sizes {
            let triangles = triangles(size);
            assert_all_same::<S, WideTree<S>>("wide", &triangles, &mut workspace);
            assert_all_same::<S, CompactTree<S>>("compact", &triangles, &mut workspace);
            assert_all_same::<S, Tree<S>>("binary", &triangles, &mut workspace);
        }
    }
    let _turn = turn();
    with::<f32>(&[300, 12_000, 0, 1, 9, 5_000, 20_000, 40]);
    with::<f64>(&[300, 6_000, 40]);
}

#[test]
fn a_workspace_is_good_for_more_after_a_build_that_failed() {
    let good = triangles::<f32>(10_000);
    let mut bad = good.clone();
    bad[7].0.a[1] = f32::NAN;
    let mut workspace = Workspace::new();
    let _turn = turn();
    for _ in 0..2 {
        let stopped =
            Bvh::builder().progress(|_| BuildControl::Stop).build_in(&mut workspace, good.iter().copied());
        assert_eq!(stopped.unwrap_err(), BuildError::Stopped);
        let rejected = Bvh::builder().build_in(&mut workspace, bad.iter().copied());
        assert!(matches!(rejected, Err(BuildError::InvalidPrimitive { index: 7, .. })));
        let skipping = Bvh::builder().on_invalid(OnInvalid::Skip);
        let rest = skipping.clone().build_in(&mut workspace, bad.iter().copied()).unwrap();
        assert_eq!(rest.skipped(), [7]);
        assert!(rest.layout() == skipping.build(bad.iter().copied()).unwrap().layout());
        assert_eq!(rest.recycle(&mut workspace).len(), bad.len());
        assert_same("after failures", &Bvh::builder(), &good, &mut workspace);
    }
}

/// A stopped build is an error, and a build that ends is a whole hierarchy.
///
/// The progress callback stops the build at its first call, then at its second, and so on, with
/// every heuristic and two presets.
#[test]
fn builds_stop_wherever_they_are_told_to() {
    fn with<H: Heuristic<f32> + Clone, L: Layout<Fast<Triangle>> + PartialEq>(
        what: &str,
        builder: &Builder<Fast<Triangle>, H, L>,
        triangles: &[Fast<Triangle>],
        workspace: &mut Workspace,
    ) {
        let whole = builder.clone().build(triangles.iter().copied()).unwrap();
        for stop in 0.. {
            let asked = Arc::new(AtomicUsize::new(0));
            let asks = asked.clone();
            let watcher = move |_| {
                if asks.fetch_add(1, Relaxed) < stop { BuildControl::Steady } else { BuildControl::Stop }
            };
            match builder.clone().progress(watcher).build_in(workspace, triangles.iter().copied()) {
                Err(error) => assert_eq!(error, BuildError::Stopped, "{what}, {stop}"),
                Ok(bvh) => {
                    assert!(asked.load(Relaxed) <= stop && bvh.layout() == whole.layout(), "{what}, {stop}");
                    return;
                }
            }
        }
    }
    let _turn = turn();
    let mut workspace = Workspace::new();
    for size in [1, 9, 1_000, 12_000] {
        let triangles = triangles(size);
        for (name, heuristic) in &heuristics::all() {
            let builder = Bvh::builder().heuristic(&**heuristic).threads(1);
            with(name, &builder, &triangles, &mut workspace);
            with(name, &builder.layout::<Tree>(), &triangles, &mut workspace);
        }
        for quality in [Quality::Fast, Quality::Balanced] {
            let builder = Bvh::builder().quality(quality).threads(1);
            with(&format!("{quality:?}"), &builder, &triangles, &mut workspace);
        }
    }
}

/// Later builds reuse the buffers of earlier ones.
///
/// The test measures the peak of allocated bytes on one thread. Each build allocates and frees its
/// lists of tasks; the buffers stay.
#[test]
fn later_builds_take_the_memory_of_earlier_ones() {
    fn is_shared_by_threads<T: Send + Sync>(_: &T) {}
    let _turn = turn();
    let triangles = triangles::<f32>(100_000);
    for quality in [Quality::Fast, Quality::Balanced] {
        let mut workspace = Workspace::new();
        is_shared_by_threads(&workspace);
        let builder = Bvh::builder().quality(quality).threads(1);
        // Builds over `count` triangles. Returns the peak of new memory, the bytes of the
        // hierarchy, and the bytes in the workspace before and after the hierarchy is recycled.
        let mut peak = |count: usize| {
            let input = triangles[..count].to_vec();
            let (bvh, peak) = memory::peak(|| builder.clone().build_in(&mut workspace, input).unwrap());
            let (bytes, left) = (bvh.report().memory_bytes, workspace.bytes());
            bvh.recycle(&mut workspace);
            (peak as f64, bytes, left, workspace.bytes())
        };
        let (first, ..) = peak(90_000);
        let mut kept = 0;
        // A small build keeps the buffers that are too large for it. An input that grows a little
        // does not need new memory each time.
        for count in [90_000, 100, 0, 90_000, 91_000, 92_000, 93_000] {
            let (peak, bytes, left, now) = peak(count);
            assert!(count < 92_000 || now == kept, "{quality:?}, {count}: other memory");
            kept = now;
            assert!(count == 91_000 || peak < 0.35 * first, "{quality:?}, {count}: {peak}, at first {first}");
            assert!(bytes < 100 * count + 2_000, "{quality:?}, {count}: {bytes} bytes");
            assert!(
                count > 100 || left == now,
                "{quality:?}, {count}: a small one has none of a large one's"
            );
        }
        assert!(workspace.bytes() > 70 * 90_000, "{} bytes kept", workspace.bytes());
        let small = triangles[..100].iter().copied();
        let binary = builder.layout::<Tree>().build_in(&mut workspace, small).unwrap();
        assert!(binary.report().memory_bytes < 20_000, "a small one has none of a large one's");
    }
}

/// Buffers that are not kept are freed as soon as possible.
///
/// References are stored in memory that is reserved for the layout, and a build does
/// not touch all of that memory.
#[test]
fn a_build_without_a_workspace_peaks_no_higher_than_it_has_to() {
    let _turn = turn();
    let triangles = triangles::<f32>(100_000);
    for (quality, most) in [(Quality::Fast, 95), (Quality::Balanced, 115)] {
        let input = triangles.clone();
        let builder = Bvh::builder().quality(quality).threads(1);
        let (_bvh, peak) = memory::peak(|| builder.build(input).unwrap());
        assert!(peak < most * triangles.len(), "{quality:?}: {peak}");
    }
}
