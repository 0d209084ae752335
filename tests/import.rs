//! real data
use gaitway::gait::import::import_file;
use gaitway::gait::*;
use glam::{Quat, Vec3, Mat4, Vec4};
use std::path::PathBuf;

fn data() -> Option<PathBuf> {
    let root = std::env::var_os("GAITWAY_DATA").map(PathBuf::from).unwrap_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data"));
    root.is_dir().then_some(root)
}

/// rotation, scale, rms of b ~ s R a + t
fn fit(a: &[Vec3], b: &[Vec3]) -> (Quat, f32, f32) {
    let n = a.len() as f32;
    let ca = a.iter().copied().sum::<Vec3>() / n; let cb = b.iter().copied().sum::<Vec3>() / n;
    let mut m = [[0.0f32; 3]; 3];
    let (mut va, mut vb) = (0.0, 0.0);
    for (p, q) in a.iter().zip(b) { let p = *p - ca; let q = *q - cb; va += p.length_squared(); vb += q.length_squared();
        for i in 0..3 { for j in 0..3 { m[i][j] += p[i] * q[j]; } } }
    let [[xx,xy,xz],[yx,yy,yz],[zx,zy,zz]] = m;
    let k = Mat4::from_cols(
        Vec4::new(xx+yy+zz, yz-zy, zx-xz, xy-yx),
        Vec4::new(yz-zy, xx-yy-zz, xy+yx, zx+xz),
        Vec4::new(zx-xz, xy+yx, -xx+yy-zz, yz+zy),
        Vec4::new(xy-yx, zx+xz, yz+zy, -xx-yy+zz));
    let shift = (va * vb).sqrt() * 1.1;
    let mut v = Vec4::new(1.0, 0.1, 0.1, 0.1);
    for _ in 0..60 { v = (k * v + v * shift).normalize(); }
    let q = Quat::from_xyzw(v.y, v.z, v.w, v.x);
    let num: f32 = a.iter().zip(b).map(|(p, r)| (q * (*p - ca)).dot(*r - cb)).sum();
    let s = num / va;
    let e: f32 = a.iter().zip(b).map(|(p, r)| (q * (*p - ca) * s - (*r - cb)).length_squared()).sum();
    (q, s, (e / n).sqrt())
}

#[test]
fn experiment_level() {
    let Some(root) = data() else { println!("skipped"); return };
    let takes = import_file(&root.join("egait/cmu.csv")).unwrap();
    for take in &takes {
        let subject = take.name.split('_').next().unwrap();
        let amc = root.join(format!("cmu-asfamc/{subject}/{}.amc", take.name));
        if !amc.is_file() { continue; }
        let real = import_file(&amc).unwrap().remove(0);
        let n = take.poses.len();
        // all joints relative to root, stacked
        let a: Vec<Vec3> = take.poses.iter().flat_map(|p| p.map(|x| x - p[0])).collect();
        let mut best = (Quat::IDENTITY, 0.0, f32::MAX, 0);
        for s in 0..real.poses.len().saturating_sub(4 * n) {
            let b: Vec<Vec3> = (0..n).flat_map(|i| { let p = real.poses[s + 4 * i]; p.map(|x| x - p[0]) }).collect();
            let (q, sc, e) = fit(&a, &b);
            if e < best.2 { best = (q, sc, e, s); }
        }
        let up = best.0.inverse() * Vec3::Y;
        let ang = |q: Quat| (q.inverse() * Vec3::Y).angle_between(up).to_degrees();
        let pitch = |q: Quat| { let v = q.inverse() * Vec3::Y; v.z.atan2(v.y).to_degrees() };
        println!("{} n {} start {} scale {:.3} rms {:.4} up {:.3} | none {:.1} a {:.1} b {:.1} | pitch true {:.1} a {:.1} b {:.1}", take.name, n, best.3, best.1, best.2, up,
            ang(Quat::IDENTITY), ang(import::egait::level_a(&take.poses)), ang(import::egait::level_b(&take.poses)), up.z.atan2(up.y).to_degrees(), pitch(import::egait::level_a(&take.poses)), pitch(import::egait::level_b(&take.poses)));
    }
}
