//! scratch
#[test]
fn probe() {
    let d = gaitway::gpu::Device::open(None, gaitway::gpu::Validation::Sync).unwrap();
    println!("{} {}", d.describe(), gaitway::verify::numerics(&d).unwrap());
    drop(d);
    println!("{:#?}", gaitway::gpu::validation_messages());
}
