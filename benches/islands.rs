//! Steps of 64 crowds of 200 people: together, as islands, and one after another.
//!
//! `cargo bench --bench islands -- vulkan` runs one backend. Clock time of batches of steps.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    missing_docs,
    reason = "a benchmark stops at the first fault"
)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use gaitway::Scene;
use gaitway::sim::{Backend, Islands};
use std::time::{Duration, Instant};

const CROWDS: u64 = 64;
const AGENTS: u32 = 200;

fn islands(criterion: &mut Criterion) {
    for (backend, label) in [(Backend::Cpu, "cpu"), (Backend::Vulkan, "vulkan")] {
        let scene = |seed| Scene::load("crossing")?.agents(AGENTS).seed(seed).backend(backend).build();
        let scenes: Vec<Scene> = (1..=CROWDS).map(scene).collect::<gaitway::Result<_>>().unwrap();
        let mut crowds = Islands::default();
        let started = scenes.iter().try_for_each(|scene| scene.start_in(&mut crowds).map(|_| ()));
        if let Err(error) = started {
            println!("skipped: {label}: {error}");
            continue;
        }
        let mut group = criterion.benchmark_group(label);
        group
            .sample_size(10)
            .warm_up_time(Duration::from_millis(500))
            .measurement_time(Duration::from_secs(5))
            .throughput(Throughput::Elements(CROWDS * u64::from(AGENTS)));
        group.bench_function("together", |bencher| {
            bencher.iter_custom(|steps| {
                let begin = Instant::now();
                crowds.step(u32::try_from(steps).unwrap()).unwrap();
                begin.elapsed()
            });
        });
        group.bench_function("one after another", |bencher| {
            bencher.iter_custom(|steps| {
                let begin = Instant::now();
                for crowd in crowds.crowds_mut() {
                    crowd.step(u32::try_from(steps).unwrap()).unwrap();
                    crowd.finish().unwrap();
                }
                begin.elapsed()
            });
        });
        group.finish();
    }
}

criterion_group!(benches, islands);
criterion_main!(benches);
