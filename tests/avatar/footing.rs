//! People who stop, turn, go in curves, up ramps and stairs: what the kernels `integrate`, `elevate` and `feet` make of it.

use super::stroll::{PICTURES, Seen, Walker, watch, watch_all};
use gaitway::Emotion;
use gaitway::gait::{Joint, walker};
use glam::Vec3;

fn woman(emotion: Emotion, share: f32) -> Walker {
    Walker::person(emotion, walker::Sex::Female, share)
}

/// A walker that stops at a phase of the stride, and what is seen in the four seconds after it.
fn stopped(emotion: Emotion, phase: u32) -> (Walker, Seen) {
    let mut walker = woman(emotion, 1.0);
    let speed = walker.speed;
    watch(&mut walker, speed, 3.0);
    while walker.store.stance[0].phase.wrapping_sub(phase).cast_signed().unsigned_abs() > 1 << 26 {
        walker.go([0.0, speed]);
    }
    let seen = watch(&mut walker, 0.0, 4.0);
    (walker, seen)
}

/// Whether a foot on the ground moves by less than `mean` m a picture, and none sinks in by more than `sinks` m.
fn are_planted(what: &str, seen: &Seen, [mean, slide, sinks]: [f32; 3]) {
    let (moves, _) = seen.moves;
    println!("{what}: {moves} m a picture, {} m in all, low {}", seen.slide, seen.lowest);
    assert!(moves < mean, "{what}: feet on the ground move by {moves} m a picture, {mean} at most");
    assert!(seen.slide < slide, "{what}: a foot moves by {} m, {slide} at most", seen.slide);
    assert!(seen.lowest > -sinks, "{what}: {} m in the ground, {sinks} at most", -seen.lowest);
}

/// Whether both feet are under a walker that stands.
fn is_settled(what: &str, walker: &Walker) {
    let own = walker.store.stance[0];
    assert!(own.walk_weight == 0.0, "{what}: {own:?} still walks");
    let off = [own.left, own.right].map(|[x, z]| x.hypot(z));
    assert!(off.into_iter().all(|off| off < 0.02), "{what}: feet are {off:?} m off");
    assert!(own.turns.into_iter().all(|turn| turn.abs() < 0.1), "{what}: feet point {:?} rad off", own.turns);
    for foot in [Joint::LeftFoot, Joint::RightFoot] {
        let lowest = walker.sole(foot).iter().map(|point| point.y).fold(1.0, f32::min);
        assert!(lowest.abs() < 0.002, "{what}: a foot is {lowest} m above the ground");
    }
}

#[test]
fn who_stops_finishes_the_step_and_stands_with_both_feet_under_the_body() {
    for (emotion, part) in Emotion::ALL.into_iter().flat_map(|e| (0..8u32).map(move |part| (e, part))) {
        let (walker, seen) = stopped(emotion, part << 29);
        let what = format!("{emotion}, phase {part} of 8");
        are_planted(&what, &seen, [0.0001, 0.02, 0.003]);
        is_settled(&what, &walker);
        assert!(seen.strides < 1.8, "{what}: {} strides on the spot", seen.strides);
    }
}

#[test]
fn who_turns_on_the_spot_steps() {
    for emotion in Emotion::ALL {
        let (mut walker, _) = stopped(emotion, 0);
        // slower than anybody walks, to the right
        let seen = watch_all(&mut walker, |time| if time < 2.0 { [-0.06, -0.01] } else { [0.0, 0.0] }, 5.0);
        are_planted(emotion.name(), &seen, [0.00015, 0.12, 0.003]);
        is_settled(emotion.name(), &walker);
        let turned = walker.store.heading[0];
        assert!((turned + 1.735).abs() < 0.01 && seen.strides > 1.0, "{emotion}: {turned} rad, {seen:?}");
    }
}

#[test]
fn who_goes_in_circles_plants_the_feet() {
    for (emotion, radius) in Emotion::ALL.into_iter().flat_map(|e| [1.0, 2.0, 5.0].map(|radius| (e, radius)))
    {
        let mut walker = woman(emotion, 0.8);
        let speed = 0.8 * walker.speed;
        let way = |time: f32| {
            let (sine, cosine) = (time * speed / radius).sin_cos();
            [speed * sine, speed * cosine]
        };
        let seen = watch_all(&mut walker, way, 10.0);
        are_planted(&format!("{emotion}, circle of {radius} m"), &seen, [0.00012, 0.02, 0.003]);
    }
}

/// How far the lean tilts the trunk, to the left and ahead of its way, degrees.
fn leans(walker: &mut Walker, way: Vec3) -> [f32; 2] {
    let trunk = |walker: &Walker| {
        let at = walker.joints().map(|joint| joint.w_axis.truncate());
        let up = at[Joint::Neck as usize] - at[Joint::Spine as usize];
        [Vec3::Y.cross(way), way].map(|axis| up.dot(axis).atan2(up.y).to_degrees())
    };
    let leaning = trunk(walker);
    let own = std::mem::take(&mut walker.store.stance[0].lean);
    walker.draw();
    let upright = trunk(walker);
    walker.store.stance[0].lean = own;
    walker.draw();
    [0, 1].map(|axis| leaning[axis] - upright[axis])
}

/// Figures: 3 to 6 degrees into acceleration, 3 into curves.
#[test]
fn bodies_lean_into_acceleration_and_curves() {
    let mut walker = woman(Emotion::Neutral, 1.0);
    let own = walker.speed;
    watch(&mut walker, own, 3.0);
    let straight = leans(&mut walker, Vec3::Z);
    assert!(straight.iter().all(|lean| lean.abs() < 0.1), "{straight:?}");
    watch(&mut walker, 0.0, 4.0);
    let mut most = 0.0_f32;
    for picture in 0..180_u16 {
        walker.go([0.0, own * (f32::from(picture) / 150.0).min(1.0)]);
        let [_, ahead] = leans(&mut walker, Vec3::Z);
        most = most.max(ahead);
    }
    assert!((3.0..6.0).contains(&most), "a walker that sets off leans by {most} degrees");
    let mut aside = 0.0;
    for picture in 0..1200_u16 {
        let (sine, cosine) = (f32::from(picture) / PICTURES * own / 2.5).sin_cos();
        walker.go([own * sine, own * cosine]);
        if picture >= 600 {
            let [left, _] = leans(&mut walker, Vec3::new(sine, 0.0, cosine));
            aside += left / 600.0;
        }
    }
    assert!((2.0..4.0).contains(&aside), "in a curve to the left {aside} degrees");
}

/// Yaw of head, trunk and the mean of both feet against the first way, to the left, rad.
fn yaws(walker: &Walker) -> [f32; 3] {
    let joints = walker.joints();
    let yaw = |joint: Joint| {
        let mesh = joints[joint as usize] * walker.avatar.joints[joint as usize].joint_from_mesh;
        let ahead = mesh.transform_vector3(Vec3::Z);
        ahead.x.atan2(ahead.z)
    };
    let feet = 0.5 * (yaw(Joint::LeftFoot) + yaw(Joint::RightFoot));
    [yaw(Joint::Head), yaw(Joint::Spine), feet]
}

#[test]
fn the_head_turns_before_the_trunk_and_the_trunk_before_the_feet() {
    let mut walker = woman(Emotion::Neutral, 1.0);
    let own = walker.speed;
    watch(&mut walker, own, 2.0);
    let mut half = [None; 3];
    for picture in 0..240_u16 {
        walker.go([own * 0.707, own * 0.707]);
        for (half, yaw) in half.iter_mut().zip(yaws(&walker)) {
            if yaw > std::f32::consts::FRAC_PI_8 && half.is_none() {
                *half = Some(f32::from(picture) / PICTURES);
            }
        }
    }
    let [head, trunk, feet] = half.map(|time| time.expect("all of the body turns"));
    println!("half of the turn: head {head} s, trunk {trunk} s, feet {feet} s");
    assert!(trunk - head > 0.04 && feet - trunk > 0.04, "head {head} s, trunk {trunk} s, feet {feet} s");
}

/// On ramps that rise and fall by a tenth.
#[test]
fn feet_lie_on_ramps() {
    for (emotion, slope) in Emotion::ALL.into_iter().flat_map(|e| [0.1, -0.1].map(|slope| (e, slope))) {
        let mut walker = woman(emotion, 1.0);
        let speed = walker.speed;
        walker.lay(&[([-50.0, -50.0, 50.0, 50.0], [0.0, slope, 0.0])]);
        watch(&mut walker, speed, 2.0);
        let seen = watch(&mut walker, speed, 6.0);
        are_planted(&format!("{emotion}, slope {slope}"), &seen, [0.0002, 0.03, 0.005]);
    }
}

#[test]
fn feet_are_put_on_stairs() {
    for (emotion, rise) in Emotion::ALL.into_iter().flat_map(|e| [0.16, -0.16].map(|rise| (e, rise))) {
        let steps = (0..12_u8).map(|number| {
            let near = 3.0 + 0.32 * f32::from(number);
            ([-5.0, near, 5.0, near + 0.32], [0.0, 0.0, rise * f32::from(number + 1)])
        });
        let mut walker = woman(emotion, 0.4);
        let speed = 0.4 * walker.speed;
        let floors: Vec<_> = std::iter::once(([-5.0, -5.0, 5.0, 3.0], [0.0; 3])).chain(steps).collect();
        walker.lay(&floors);
        let mut before: Option<[Vec3; 16]> = None;
        let (mut most, mut planted, mut off) = (0.0_f32, 0.0, 0.0);
        while walker.store.position[0][1] < 6.0 {
            walker.go([0.0, speed]);
            let now = walker.joints().map(|joint| joint.w_axis.truncate());
            let moves = before.iter().flatten().zip(&now).map(|(a, b)| a.distance(*b));
            most = moves.fold(most, f32::max);
            before = Some(now);
            for (foot, later) in [(Joint::LeftFoot, 0), (Joint::RightFoot, 1 << 31)] {
                let since = walker.store.stance[0].phase.wrapping_add(later) >> 24;
                if (0x20..0x80).contains(&since) {
                    let ankle = now[foot as usize];
                    let lowest = walker.sole(foot).iter().map(|point| point.y).fold(9.0, f32::min);
                    planted += 1.0;
                    off += f32::from(u8::from((lowest - walker.floor(ankle)).abs() > 0.01));
                }
            }
        }
        println!("{emotion}, steps of {rise} m: joints move by {most} m a picture, {off} of {planted} off");
        assert!(most < 0.06, "{emotion}, {rise}: a joint moves by {most} m in a picture");
        // where a foot comes down is foreseen within a centimetre or two, which matters at edges
        assert!(off < 0.2 * planted, "{emotion}, {rise}: feet are off their steps in {off} of {planted}");
    }
}
