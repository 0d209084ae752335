//! Generated walks are walks: planted feet stand still, knees bend forwards, cycles close smoothly.

use gaitway::Emotion;
use gaitway::gait::walker::{Body, FRAMES, STYLE_FIELDS, Sex, WalkerStyle, person, walk};
use gaitway::gait::{Gait, Joint, Pose};
use glam::Vec3;

/// The foot rolls over its heel up to here, then over its ball.
const FLAT: usize = FRAMES / 10;
/// Frames during which the ball of the foot stands in every style; later the foot is on the tips of its toes.
const ON_BALL: usize = FRAMES / 2;
/// Frames during which the foot is on the ground in every style (the shortest stance is 0.57).
const STANCE: usize = FRAMES * 57 / 100;

fn everyone() -> Vec<Gait> {
    let mut gaits = Vec::new();
    for emotion in Emotion::ALL {
        for sex in Sex::ALL {
            gaits.push(walk(&WalkerStyle::preset(emotion, sex), &format!("{emotion} {sex} preset")).unwrap());
            gaits.extend((0..25).map(|index| person(emotion, sex, 99, index).unwrap()));
        }
    }
    gaits
}

/// Position of a foot on ground that passes at the gait's speed, `frame` counted from that foot's strike.
fn on_ground(gait: &Gait, foot: Joint, frame: usize) -> Vec3 {
    let start = if foot == Joint::LeftFoot { 0 } else { FRAMES / 2 };
    let travel = gait.speed * frame as f32 / gait.frame_rate;
    gait.poses[(start + frame) % FRAMES][foot as usize] + Vec3::Z * travel
}

#[test]
fn planted_feet_roll_over_points_of_the_ground() {
    for gait in everyone() {
        for foot in [Joint::LeftFoot, Joint::RightFoot] {
            let flat = (FLAT..FRAMES * 3 / 10)
                .map(|frame| on_ground(&gait, foot, frame))
                .min_by(|a, b| a.y.total_cmp(&b.y))
                .unwrap();
            assert!(flat.y.abs() < 1e-3, "{}: {foot:?} stands at {}", gait.name, flat.y);
            // leg to ankle is 0.246 of the height
            let [knee, ankle] = [foot as usize - 1, foot as usize].map(|joint| gait.poses[0][joint]);
            let height = knee.distance(ankle) / 0.246;
            let [heel, ball] = [-0.037, 0.072].map(|z| flat + Vec3::new(0.0, -0.042, z) * height);
            for frame in 0..=ON_BALL {
                let at = on_ground(&gait, foot, frame);
                let pivot = if frame <= FLAT { heel } else { ball };
                let slip = (at.distance(pivot) - flat.distance(pivot)).abs();
                assert!(slip < 2e-3, "{}: {foot:?} slips {slip} m by frame {frame}", gait.name);
            }
            let lifted = on_ground(&gait, foot, STANCE).y;
            assert!(lifted > 0.04, "{}: heel only {lifted} m up before toe-off", gait.name);
        }
        let lowest =
            gait.poses.iter().flat_map(|pose| pose.iter().map(|joint| joint.y)).fold(f32::MAX, f32::min);
        assert!(lowest > -1e-3, "{}: lowest joint at {lowest}", gait.name);
    }
}

#[test]
fn knees_and_elbows_bend_the_right_way_and_bones_keep_their_length() {
    for gait in everyone() {
        let first = gait.poses[0];
        for (frame, pose) in gait.poses.iter().enumerate() {
            for (hip, forwards) in [(10, true), (13, true), (4, false), (7, false)] {
                let (a, b, c) = (pose[hip], pose[hip + 1], pose[hip + 2]);
                let flexion = 180.0 - (a - b).angle_between(c - b).to_degrees();
                let out = (b - (a + c) * 0.5).z;
                assert!(
                    flexion > 3.0 && flexion < 100.0,
                    "{} frame {frame}: joint {hip} bends {flexion}",
                    gait.name
                );
                assert!(
                    (out > 0.0) == forwards,
                    "{} frame {frame}: joint {hip} bends the wrong way",
                    gait.name
                );
            }
            // All bones but the spine's to the shoulders, which the girdle moves.
            for joint in (1..16).filter(|joint| ![4, 7].contains(joint)) {
                let parent = Joint::PARENT[joint];
                let change = pose[joint].distance(pose[parent]) - first[joint].distance(first[parent]);
                assert!(change.abs() < 1e-5, "{} frame {frame}: bone {joint} changes by {change}", gait.name);
            }
        }
    }
}

#[test]
fn knees_swing_as_people_s_do() {
    for emotion in Emotion::ALL {
        let gait = walk(&WalkerStyle::preset(emotion, Sex::Female), "test").unwrap();
        let knee =
            |pose: &Pose| 180.0 - (pose[10] - pose[11]).angle_between(pose[12] - pose[11]).to_degrees();
        let swing = gait.poses[STANCE..].iter().map(knee).fold(0.0, f32::max);
        let middle = knee(&gait.poses[FRAMES * 3 / 10]);
        assert!((55.0..78.0).contains(&swing), "{emotion}: {swing} degrees in the swing");
        assert!(middle < 26.0, "{emotion}: {middle} degrees in the middle of the stance");
    }
}

#[test]
fn cycles_close_without_a_jump_of_position_or_velocity() {
    for gait in everyone() {
        let at = |frame: usize, joint: usize| gait.poses[frame % FRAMES][joint];
        for joint in 0..16 {
            let mut steepest: f32 = 0.0;
            let mut sharpest: (f32, usize) = (0.0, 0);
            for frame in 0..FRAMES {
                let (a, b, c) = (at(frame, joint), at(frame + 1, joint), at(frame + 2, joint));
                steepest = steepest.max((b - a).length());
                let bend = (c - b * 2.0 + a).length();
                if bend > sharpest.0 {
                    sharpest = (bend, frame + 1);
                }
            }
            // A jump of velocity shows as a second difference as large as a first one. A knee turns back at the strike.
            let limit = 1.25 * steepest + 0.001;
            assert!(
                sharpest.0 < limit,
                "{}: joint {joint} bends {} m at frame {}, its steepest step is {steepest} m",
                gait.name,
                sharpest.0,
                sharpest.1
            );
        }
    }
}

#[test]
fn walkers_face_forwards_on_the_spot_with_left_on_plus_x() {
    for gait in everyone() {
        let mean: Vec3 = gait.poses.iter().map(|pose| pose[0]).sum::<Vec3>() / FRAMES as f32;
        assert!(mean.x.abs() < 1e-4 && mean.z.abs() < 1e-4, "{}: root at {mean}", gait.name);
        for pose in &gait.poses {
            for joint in [4, 5, 10, 11, 12] {
                assert!(pose[joint].x > pose[joint + 3].x, "{}: joint {joint} is not on the left", gait.name);
            }
        }
        // Left foot strike: the left foot is in front; the left hand is behind the right, or would be if both hung alike.
        let pose = gait.poses[0];
        let behind = |pose: &Pose| pose[9].z - pose[6].z;
        let usual = gait.poses.iter().map(behind).sum::<f32>() / FRAMES as f32;
        assert!(pose[12].z > pose[15].z && behind(&pose) > usual, "{}", gait.name);
    }
}

#[test]
fn the_right_side_does_what_the_left_does_half_a_stride_later() {
    let gait = walk(&WalkerStyle::preset(Emotion::Happy, Sex::Female), "test").unwrap();
    for frame in 0..FRAMES {
        let (now, later) = (gait.poses[frame], gait.poses[(frame + FRAMES / 2) % FRAMES]);
        for joint in Joint::ALL {
            let mirrored = later[joint.mirrored() as usize] * Vec3::new(-1.0, 1.0, 1.0);
            assert!(now[joint as usize].distance(mirrored) < 1e-5, "frame {frame}, {joint:?}");
        }
    }
}

#[test]
fn bodies_have_the_heights_of_people() {
    for (sex, height) in [(Sex::Female, 1.62), (Sex::Male, 1.76)] {
        assert!((Body::mean(sex).height - height).abs() < 1e-9);
        let gait = walk(&WalkerStyle::preset(Emotion::Neutral, sex), "test").unwrap();
        let head = gait.poses.iter().map(|pose| pose[3].y).fold(0.0, f32::max);
        // The head joint is at 0.91 of the height of a standing person; ankles are at 0.042 of it.
        let standing = (0.915 - 0.042) * height as f32;
        assert!(head < standing && head > standing - 0.04, "{sex}: head joint up to {head} of {standing}");
    }
}

#[test]
fn individuals_differ_are_repeatable_and_always_walk() {
    let style = WalkerStyle::preset(Emotion::Angry, Sex::Male);
    assert_eq!(style.vary(1, 2), style.vary(1, 2));
    assert_ne!(style.vary(1, 2), style.vary(1, 3));
    assert_ne!(style.vary(1, 2), style.vary(2, 2));
    for emotion in Emotion::ALL {
        for sex in Sex::ALL {
            for index in 0..400 {
                person(emotion, sex, 7, index).unwrap();
            }
        }
    }
}

#[test]
fn what_hangs_together_in_people_does_so_in_individuals() {
    let usual = WalkerStyle::preset(Emotion::Neutral, Sex::Male);
    let individuals: Vec<_> = (0..2_000).map(|index| usual.vary(5, index)).collect();
    let slope = |of: fn(&WalkerStyle) -> f64, on: fn(&WalkerStyle) -> f64| {
        let pairs = individuals.iter().map(|own| (on(own) - on(&usual), of(own) - of(&usual)));
        let (both, square) = pairs.fold((0.0, 0.0), |(both, square), (x, y)| (both + x * y, square + x * x));
        both / square
    };
    let bend = |style: &WalkerStyle| style.lean + style.slump;
    let slopes = [
        slope(|own| own.arm_forward, bend),
        slope(|own| own.neck_flexion, bend),
        slope(|own| own.arm_forward, |own| own.elbow_flexion),
        slope(|own| own.forward_asymmetry, |own| own.elbow_asymmetry),
    ];
    println!("arms and neck on the trunk, arms on elbows, one arm on its elbow: {slopes:.2?}");
    // E-Gait's people of BML and CMU: the head's pitch follows the chest's by 0.4 to 0.5, so the neck takes back the rest
    let of_people = [[-0.5, -0.3], [-0.6, -0.5], [-0.8, -0.2], [-0.8, -0.2]];
    for (slope, [low, high]) in slopes.into_iter().zip(of_people) {
        assert!((low..high).contains(&slope), "{slopes:?}");
    }
}

#[test]
fn mixtures_lie_between_and_walk() {
    let styles = Emotion::ALL.map(|emotion| WalkerStyle::preset(emotion, Sex::Female));
    let half = WalkerStyle::mix(&[(styles[0], 1.0), (styles[2], 1.0)]).unwrap();
    for field in STYLE_FIELDS {
        let (a, b, mixed) = ((field.get)(&styles[0]), (field.get)(&styles[2]), (field.get)(&half));
        assert!((mixed - 0.5 * (a + b)).abs() < 1e-12, "{}", field.name);
    }
    walk(&half, "bittersweet").unwrap();
    assert_eq!(WalkerStyle::mix(&[]), None);
    assert_eq!(WalkerStyle::mix(&[(styles[1], 0.0)]), Some(styles[1]));
}

#[test]
fn styles_out_of_range_are_refused_with_the_value_and_the_range() {
    let style = WalkerStyle::preset(Emotion::Neutral, Sex::Male);
    for field in STYLE_FIELDS {
        for bad in [f64::NAN, f64::INFINITY, field.range[0] - 0.1, field.range[1] + 0.1] {
            let mut wrong = style;
            (field.set)(&mut wrong, bad);
            let message = walk(&wrong, "wrong").unwrap_err().to_string();
            assert!(message.contains(field.name) && message.contains(&format!("{bad}")), "{message}");
        }
    }
    let message = walk(&WalkerStyle { cycle_time: 2.9, ..style }, "giant steps").unwrap_err().to_string();
    assert!(message.contains("too long for legs"), "{message}");
}
