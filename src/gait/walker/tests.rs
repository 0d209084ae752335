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
#[test]
fn kinks() {
    for e in Emotion::ALL { for s in Sex::ALL {
        let g = walk(&WalkerStyle::preset(e, s), "x").unwrap();
        for j in [6, 11, 12] {
            let at = |f: usize| g.poses[f % FRAMES][j];
            let steep = (0..FRAMES).map(|f| (at(f+1)-at(f)).length()).fold(0.0, f32::max);
            let (b, f) = (0..FRAMES).map(|f| ((at(f+2)-at(f+1)*2.0+at(f)).length(), f+1)).fold((0.0,0), |a, b| if b.0>a.0 {b} else {a});
            println!("kink {e} {s} {j} {:.3} at {f}", b/steep);
        }
    }}
}
