//! Every kernel by name, on the CPU and (where there is a device) on Vulkan.
//!
//! `cargo bench --bench kernels` runs all, `cargo bench --bench kernels -- vulkan/velocity_orca` one. Times on Vulkan are
//! those of the device's timestamps. `GAITWAY_BENCH_AGENTS` sets the size, 10,000 by default.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    missing_docs,
    reason = "a benchmark stops at the first fault"
)]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use gaitway::bench::Sequence;
use gaitway::kernels::KernelId;
use gaitway::sim::Backend;
use std::time::Duration;

fn agents() -> usize {
    std::env::var("GAITWAY_BENCH_AGENTS").map_or(10_000, |text| text.parse().unwrap())
}

fn kernels(criterion: &mut Criterion) {
    let agents = agents();
    for (backend, label) in [(Backend::Cpu, "cpu"), (Backend::Vulkan, "vulkan")] {
        let mut group = criterion.benchmark_group(label);
        group
            .sample_size(10)
            .warm_up_time(Duration::from_millis(300))
            .measurement_time(Duration::from_secs(1));
        group.throughput(Throughput::Elements(agents as u64));
        for kernel in KernelId::ALL {
            let name = kernel.kernel().name;
            let mut sequence = match Sequence::with(kernel, agents, backend, None) {
                Ok(sequence) => sequence,
                Err(error) => {
                    println!("skipped: {label}/{name}: {error}");
                    continue;
                }
            };
            group.bench_function(BenchmarkId::new(name, agents), |bencher| {
                bencher.iter_custom(|runs| {
                    let mut total = 0.0;
                    for _ in 0..runs {
                        let times = sequence.run().unwrap();
                        let own = times.iter().filter(|(phase, _)| phase.kernel() == kernel);
                        total += own.map(|(_, ms)| ms).sum::<f64>();
                    }
                    // a device whose clock does not tick between two stamps gives 0, which criterion refuses
                    Duration::from_secs_f64((total * 1e-3).max(1e-9))
                });
            });
        }
        group.finish();
    }
}

/// The proof of careful division and root: none may come out wrong.
fn careful(criterion: &mut Criterion) {
    use gaitway::verify::careful::{wrong_quotients, wrong_roots};
    const CASES: u64 = 1 << 20;
    let mut group = criterion.benchmark_group("careful");
    group.sample_size(10).throughput(Throughput::Elements(CASES));
    let mut next = (0..).map(|round| round * CASES % 0x8000_0000);
    group.bench_function("square_root", |bencher| {
        bencher.iter(|| {
            let first = next.next().unwrap();
            assert_eq!(wrong_roots(first..first + CASES), 0);
        });
    });
    let mut next = (0..).map(|round| round * CASES);
    group.bench_function("division", |bencher| {
        bencher.iter(|| {
            let first = next.next().unwrap();
            assert_eq!(wrong_quotients(first..first + CASES), 0);
        });
    });
    group.finish();
}

criterion_group!(benches, kernels, careful);
criterion_main!(benches);
