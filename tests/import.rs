//! real data
use gaitway::gait::import::import_file;
use gaitway::gait::*;
use glam::{Mat4, Quat, Vec3, Vec4};
use std::path::PathBuf;

fn data() -> Option<PathBuf> {
    let root = std::env::var_os("GAITWAY_DATA")
        .map(PathBuf::from)
        .unwrap_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data"));
    root.is_dir().then_some(root)
}

/// rotation, scale, rms of b ~ s R a + t
fn fit(a: &[Vec3], b: &[Vec3]) -> (Quat, f32, f32) {
    let n = a.len() as f32;
    let ca = a.iter().copied().sum::<Vec3>() / n;
    let cb = b.iter().copied().sum::<Vec3>() / n;
    let mut m = [[0.0f32; 3]; 3];
    let (mut va, mut vb) = (0.0, 0.0);
    for (p, q) in a.iter().zip(b) {
        let p = *p - ca;
        let q = *q - cb;
        va += p.length_squared();
        vb += q.length_squared();
        for i in 0..3 {
            for j in 0..3 {
                m[i][j] += p[i] * q[j];
            }
        }
    }
    let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = m;
    let k = Mat4::from_cols(
        Vec4::new(xx + yy + zz, yz - zy, zx - xz, xy - yx),
        Vec4::new(yz - zy, xx - yy - zz, xy + yx, zx + xz),
        Vec4::new(zx - xz, xy + yx, -xx + yy - zz, yz + zy),
        Vec4::new(xy - yx, zx + xz, yz + zy, -xx - yy + zz),
    );
    let shift = (va * vb).sqrt() * 1.1;
    let mut v = Vec4::new(1.0, 0.1, 0.1, 0.1);
    for _ in 0..60 {
        v = (k * v + v * shift).normalize();
    }
    let q = Quat::from_xyzw(v.y, v.z, v.w, v.x);
    let num: f32 = a.iter().zip(b).map(|(p, r)| (q * (*p - ca)).dot(*r - cb)).sum();
    let s = num / va;
    let e: f32 = a.iter().zip(b).map(|(p, r)| (q * (*p - ca) * s - (*r - cb)).length_squared()).sum();
    (q, s, (e / n).sqrt())
}

#[test]
fn experiment_strides() {
    let Some(root) = data() else {
        println!("skipped");
        return;
    };
    let mut trials = std::collections::HashMap::new();
    for l in std::fs::read_to_string(root.join("cmu-asfamc/trials.csv")).unwrap().lines().skip(1) {
        let c: Vec<&str> = l.split(',').collect();
        trials.insert(c[0].to_owned(), c[3].parse::<f32>().unwrap());
    }
    let mut stack = vec![root.join("cmu-asfamc"), root.join("bandai-namco"), root.join("100style")];
    let mut files = vec![];
    while let Some(d) = stack.pop() {
        for f in std::fs::read_dir(d).unwrap() {
            let f = f.unwrap().path();
            if f.is_dir() {
                stack.push(f);
            } else if f.extension().is_some_and(|e| e == "amc" || e == "bvh") {
                files.push(f);
            }
        }
    }
    files.sort();
    let mut cmu = std::collections::HashMap::new();
    for f in files {
        let t = import_file(&f).unwrap().remove(0);
        match stride::strides(&t) {
            Err(e) => println!("{e}"),
            Ok(s) => {
                let v: Vec<f32> = s.iter().map(|s| s.gait.speed).collect();
                // same take on the spot
                let mut c = t.clone();
                for p in &mut c.poses {
                    let r = p[0].with_y(0.0);
                    for x in p.iter_mut() {
                        *x -= r;
                    }
                }
                let b = stride::best(&t).unwrap();
                cmu.insert(t.name.clone(), b.speed);
                let cs =
                    stride::strides(&c).map(|s| s.iter().map(|s| s.gait.speed).sum::<f32>() / s.len() as f32);
                println!(
                    "{} n {} frames {} dur {:.2?} v {:.2?} mean {:.2} trial {:.2?} spot {:.2?} turn {:.0?} mis {:.3?} best {:.2}",
                    t.name,
                    s.len(),
                    t.poses.len(),
                    s.iter().map(|s| s.duration).take(8).collect::<Vec<_>>(),
                    v.iter().take(8).collect::<Vec<_>>(),
                    v.iter().sum::<f32>() / v.len() as f32,
                    trials.get(&t.name),
                    cs.ok(),
                    s.iter().map(|s| s.turn.to_degrees()).take(8).collect::<Vec<_>>(),
                    s.iter().map(|s| s.mismatch).take(8).collect::<Vec<_>>(),
                    b.speed
                );
            }
        }
    }
    for f in ["bml", "cmu", "ewalk", "ict", "sig", "ewalk_untransformed_sample"] {
        for t in import_file(&root.join(format!("egait/{f}.csv"))).unwrap() {
            match stride::strides(&t) {
                Err(e) => println!("{e}"),
                Ok(s) => println!(
                    "{f} {} n {} frames {} dur {:.2?} v {:.2?} cmu {:.2?} mis {:.3} label {:?} {}",
                    t.name,
                    s.len(),
                    t.poses.len(),
                    s.iter().map(|s| s.duration).collect::<Vec<_>>(),
                    s.iter().map(|s| s.gait.speed).collect::<Vec<_>>(),
                    cmu.get(&t.name),
                    s[0].mismatch,
                    t.label,
                    s[0].gait.source
                ),
            }
        }
    }
}
