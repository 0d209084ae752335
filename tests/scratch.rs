//! scratch
use gaitway::verify::cases::crossing::*;
use gaitway::gpu::plan::Op;
use gaitway::kernels::BufferId;
use std::time::Instant;
#[test]
fn speed() {
    let gpu = std::env::var("CPU").is_err();
    for n in [1000, 10000, 100000, 1000000] {
        if std::env::var("N").is_ok_and(|x| x.parse::<usize>().unwrap()!=n) {continue}
        let mut store = crossing(n, 1.0);
        let passes = gaitway::sim::order::passes(&store.step);
        if gpu {
            let d = gaitway::gpu::Device::open(None, gaitway::gpu::Validation::Off).unwrap();
            let ids: Vec<_> = { let mut v: Vec<_> = passes.iter().map(|p| p.kernel).collect(); v.sort(); v.dedup(); v };
            let mut e = gaitway::gpu::Engine::new(&d, &store, &ids).unwrap();
            println!("bytes/agent {}", e.bytes() as f64 / n as f64);
            let ops: Vec<Op> = passes.iter().map(|p| Op::Pass(*p)).collect();
            e.run(&ops, |_,_| vec![], false).unwrap();
            let k = (2000000 / n).clamp(2, 100);
            let many: Vec<Op> = (0..k).flat_map(|_| ops.clone()).collect();
            let mut best = vec![];
            for _ in 0..7 { let t = Instant::now(); e.run(&many, |_,_| vec![], false).unwrap(); best.push(t.elapsed().as_secs_f64()*1e3/k as f64); }
            best.sort_by(f64::total_cmp);
            let ts = e.run(&ops, |_,_| vec![], true).unwrap();
            println!("n {n} ms/step med {:.3} min {:.3}", best[3], best[0]);
            for t in ts { println!("   {} {} {:.3}", t.pass.kernel.kernel().name, t.pass.level, t.milliseconds); }
            e.download(&mut store, &[BufferId::Position, BufferId::Velocity]).unwrap();
            println!("{:?}", crossing_quality(&store));
        } else {
            let mut best = vec![]; let mut per = vec![0.0; passes.len()];
            let k = (300000 / n).clamp(1, 100);
            for _ in 0..7 { let t = Instant::now(); for _ in 0..k { for (i,p) in passes.iter().enumerate() { let t=Instant::now(); gaitway::reference::run(p.kernel, &mut store, p.level); per[i]+=t.elapsed().as_secs_f64()*1e3; } } best.push(t.elapsed().as_secs_f64()*1e3/k as f64); }
            best.sort_by(f64::total_cmp);
            println!("cpu n {n} ms/step med {:.3} min {:.3}", best[3], best[0]);
            for (p,t) in passes.iter().zip(&per) { println!("   {} {} {:.3}", p.kernel.kernel().name, p.level, t/(7*k) as f64); }
            println!("{:?}", crossing_quality(&store));
        }
    }
}
