//! scratch
use gaitway::verify::cases::step;
#[test]
fn kernels_agree() {
    let d = gaitway::gpu::Device::open(None, gaitway::gpu::Validation::Sync).unwrap();
    for n in [0, 1, 63, 64, 65, 1000, 20000] {
        let mut store = step::crowd(n, 7);
        for round in 0..3 {
            let passes = gaitway::sim::order::passes(&store.step);
            for c in gaitway::verify::compare_passes(&d, &store, &passes).unwrap() {
                println!("{n} {round} {:?}", c);
            }
            for pass in passes { gaitway::reference::run(pass.kernel, &mut store, pass.level); }
            store.step.step_index += 1;
        }
    }
    drop(d);
    println!("{:#?}", gaitway::gpu::validation_messages());
}
