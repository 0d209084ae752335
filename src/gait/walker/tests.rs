use super::*;
#[test]
fn looks() {
    for e in Emotion::ALL {
        for s in Sex::ALL {
            let st = WalkerStyle::preset(e, s);
            let g = walk(&st, "x").unwrap();
            let knee: Vec<i32> = g
                .poses
                .iter()
                .map(|p| {
                    let a = (p[10] - p[11]).angle_between(p[12] - p[11]).to_degrees();
                    (180.0 - a) as i32
                })
                .collect();
            let minr = g.poses.iter().map(|p| p[0].y).fold(9.0, f32::min);
            let maxr = g.poses.iter().map(|p| p[0].y).fold(0.0, f32::max);
            println!(
                "{e} {s} root {minr:.3}..{maxr:.3} head {:.3} stride {:.3} knee {knee:?}",
                g.poses[20][3].y,
                g.stride_length()
            );
        }
    }
}
