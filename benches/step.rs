//! The whole simulation step of the crossing, on the CPU and (where there is a device) on Vulkan, by number of agents.
//!
//! `cargo bench --bench step -- cpu/10000` runs one size. Clock time of batches of steps.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    missing_docs,
    reason = "a benchmark stops at the first fault"
)]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use gaitway::sim::{Backend, Simulation};
use gaitway::verify::cases::crossing::crossing;
use std::time::{Duration, Instant};

/// Numbers of agents.
const SIZES: [usize; 3] = [1_000, 10_000, 100_000];

fn step(criterion: &mut Criterion) {
    for (backend, label) in [(Backend::Cpu, "cpu"), (Backend::Vulkan, "vulkan")] {
        let mut group = criterion.benchmark_group(label);
        group
            .sample_size(10)
            .warm_up_time(Duration::from_millis(500))
            .measurement_time(Duration::from_secs(2));
        for agents in SIZES {
            let mut crowd = crossing(agents, 1.0);
            crowd.step.measured = 0;
            let mut simulation = match Simulation::from_store(crowd, backend, None) {
                Ok(simulation) => simulation,
                Err(error) => {
                    println!("skipped: {label}/{agents}: {error}");
                    continue;
                }
            };
            group.throughput(Throughput::Elements(agents as u64));
            group.bench_function(BenchmarkId::from_parameter(agents), |bencher| {
                bencher.iter_custom(|steps| {
                    let begin = Instant::now();
                    simulation.step(u32::try_from(steps).unwrap()).unwrap();
                    begin.elapsed()
                });
            });
        }
        group.finish();
    }
}

criterion_group!(benches, step);
criterion_main!(benches);
