//! Avatars: generated and loaded bodies, driven by gaits. Pictures go to `target/avatar/`.

use crate::raster::{Sheet, rest};
use crate::walker::{Walker, mirrored};
use gaitway::avatar::{Avatar, CLIP_FRAMES, Clip, Sex, generated, retarget, standing};
use gaitway::gait::Joint;
use gaitway::{Emotion, GaitLibrary};
use glam::{Mat4, Quat, Vec3};
use std::path::PathBuf;

const WALKS: [(f32, f32); 4] = [(0.5, 1.5), (0.9, 1.25), (1.35, 1.08), (1.75, 0.95)];

pub(crate) fn picture(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("target/avatar").join(name)
}

pub(crate) fn pose(avatar: &Avatar, clip: &Clip, frame: usize) -> [Mat4; 16] {
    let frame = &clip.frames[frame % CLIP_FRAMES];
    avatar.model_from_joint(&frame.rotations, frame.root)
}

/// What the sole of a foot does over a cycle.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Contact {
    /// Largest slide of a sole vertex on the ground between frames, summed over the time it stays there, m.
    pub(crate) slide: f32,
    /// Lowest and highest "lowest point of this foot" while planted, m.
    pub(crate) low: f32,
    /// Frames in which the foot touches the ground.
    pub(crate) planted: usize,
    /// Highest lowest point during the cycle, m.
    pub(crate) clearance: f32,
    /// Frames in which no foot touches.
    pub(crate) airborne: usize,
}

/// Follows every vertex of a foot in the world (the body advances with phase): a vertex lower than 6 mm counts as
/// touching the ground, and its way while it touches counts as slide.
pub(crate) fn contact(avatar: &Avatar, clip: &Clip) -> Contact {
    let mesh = &avatar.levels[0];
    let mut result = Contact::default();
    let mut touching = [false; CLIP_FRAMES];
    for foot in [Joint::LeftFoot, Joint::RightFoot] {
        let hang = |joint: usize| -> Vec<(usize, Vec3)> {
            let own =
                mesh.vertices.iter().filter(|v| usize::from(v.joints[0]) == joint && v.weights[0] > 0.9);
            own.filter(|v| v.position.y < 0.05).map(|v| (joint, v.position)).collect()
        };
        // A peg leg has no foot.
        let own = hang(foot as usize);
        let vertices = if own.is_empty() { hang(foot as usize - 1) } else { own };
        let ends = |end: fn(f32, f32) -> f32| vertices.iter().map(|(_, p)| p.z).reduce(end).unwrap_or(0.0);
        let (heel, tip) = (ends(f32::min), ends(f32::max));
        let ball = Vec3::new(vertices[0].1.x, 0.0, heel + 0.73 * (tip - heel));
        let at = |frame: usize, (joint, p): (usize, Vec3)| {
            let model = pose(avatar, clip, frame)[joint] * avatar.joints[joint].joint_from_mesh;
            model.transform_point3(with_bent_toes(&model, p, ball, tip - ball.z))
                + Vec3::Z * clip.stride_travel * frame as f32 / CLIP_FRAMES as f32
        };
        let frames: Vec<Vec<Vec3>> =
            (0..=2 * CLIP_FRAMES).map(|frame| vertices.iter().map(|&p| at(frame, p)).collect()).collect();
        let lowest: Vec<f32> =
            frames.iter().map(|f| f.iter().map(|p| p.y).fold(f32::MAX, f32::min)).collect();
        for (frame, &low) in lowest.iter().take(CLIP_FRAMES).enumerate() {
            result.low = result.low.min(low);
            result.clearance = result.clearance.max(low);
            if low < 0.006 {
                result.planted += 1;
                touching[frame] = true;
            }
        }
        for v in 0..vertices.len() {
            let mut slide = 0.0;
            for frame in 1..frames.len() {
                let (a, b) = (frames[frame - 1][v], frames[frame][v]);
                let moved = (b - a).with_y(0.0).length();
                // what passes over the ground faster than a fifth of the walk is in swing, however low
                let stands = moved < 0.2 * clip.stride_travel / CLIP_FRAMES as f32;
                slide = if stands && a.y < 0.006 && b.y < 0.006 { slide + moved } else { 0.0 };
                result.slide = result.slide.max(slide);
            }
        }
    }
    result.airborne = touching.iter().filter(|t| !**t).count();
    result
}

/// The point of a foot after its toes bent, as `palette` bends them: straight on, or half the way down to the ground from the ball.
fn with_bent_toes(foot: &Mat4, p: Vec3, ball: Vec3, toes: f32) -> Vec3 {
    if p.z <= ball.z {
        return p;
    }
    let down = (-foot.transform_vector3(Vec3::Z).y).clamp(0.0, 0.95).asin();
    let to_ground = (0.5 * foot.transform_point3(ball).y / toes).clamp(0.0, 1.0).asin();
    ball + Quat::from_rotation_x(to_ground.min(down) - down) * (p - ball)
}

#[test]
fn planted_feet_stand_still_on_both_bodies_at_every_speed() {
    for sex in Sex::ALL {
        let avatar = generated(sex);
        for (speed, time) in WALKS {
            let clip = retarget(&Walker::at(speed, time).gait(), &avatar).unwrap();
            let c = contact(&avatar, &clip);
            println!("{} {speed} m/s: travel {:.3} {c:?}", avatar.name, clip.stride_travel);
            assert!(c.slide < 0.02, "{} at {speed} m/s: a planted vertex slides {} m", avatar.name, c.slide);
            assert!(c.low > -0.012, "{} at {speed} m/s: a sole sinks to {} m", avatar.name, c.low);
            assert_eq!(c.airborne, 0, "{} at {speed} m/s floats", avatar.name);
            assert!((0.03..0.3).contains(&c.clearance), "feet are lifted {} m", c.clearance);
            assert!((64..96).contains(&c.planted), "{} of 128 foot frames are planted", c.planted);
            assert!((clip.speed - clip.stride_travel / time).abs() < 1e-4);
        }
    }
}

/// Largest difference of a clip's rotations between neighbouring frames, radians, the loop included.
pub(crate) fn roughness(clip: &Clip) -> f32 {
    let n = clip.frames.len();
    let step = |i: usize, j: usize| {
        let (a, b) = (clip.frames[i].rotations[j], clip.frames[(i + 1) % n].rotations[j]);
        assert!(a.dot(b) > 0.0, "frames {i} and {} of joint {j} are in different hemispheres", (i + 1) % n);
        assert!((a.length() - 1.0).abs() < 1e-4);
        a.angle_between(b)
    };
    (0..n).flat_map(|i| (0..16).map(move |j| (i, j))).map(|(i, j)| step(i, j)).fold(0.0, f32::max)
}

#[test]
fn clips_loop_smoothly_and_bodies_keep_their_shape() {
    for sex in Sex::ALL {
        let avatar = generated(sex);
        for (speed, time) in WALKS {
            let gait = Walker::at(speed, time).gait();
            let clip = retarget(&gait, &avatar).unwrap();
            assert_eq!(clip.frames.len(), CLIP_FRAMES);
            let rough = roughness(&clip);
            // the gait's own knees turn by up to 0.25 before they strike
            assert!(rough < 0.3, "{} at {speed} m/s turns {rough} rad in a 64th of a cycle", avatar.name);
            for frame in 0..CLIP_FRAMES {
                let model = pose(&avatar, &clip, frame).map(|m| m.w_axis.truncate());
                let at = |joint: Joint| model[joint as usize];
                let head = at(Joint::Head).y / avatar.height;
                assert!((0.83..0.91).contains(&head), "head at {head} of the height");
                for joint in [Joint::LeftHip, Joint::LeftShoulder, Joint::LeftFoot, Joint::LeftHand] {
                    assert!(at(joint).x > at(joint.mirrored()).x, "{} is on the right", joint.name());
                }
                for hip in [Joint::LeftHip, Joint::RightHip] {
                    let [hip, knee, foot] = [0, 1, 2].map(|k| model[hip as usize + k]);
                    let bend = (knee - hip).cross(foot - knee).x;
                    assert!(bend > -1e-4, "a knee bends backwards in frame {frame}: {bend}");
                }
            }
        }
    }
}

#[test]
fn hips_follow_the_gait_within_a_centimetre() {
    let library = GaitLibrary::built_in().unwrap();
    for gait in library.gaits() {
        let avatar = generated(Sex::Male);
        let clip = retarget(gait, &avatar).unwrap();
        let scale = clip.stride_travel / gait.stride_travel();
        let hips = [Joint::LeftHip as usize, Joint::RightHip as usize];
        let higher = |frame: usize| {
            let model = pose(&avatar, &clip, frame);
            let drawn = hips.map(|hip| model[hip].w_axis.y).iter().sum::<f32>();
            let own = hips.map(|hip| gait.poses[frame][hip].y).iter().sum::<f32>();
            0.5 * (drawn - scale * own)
        };
        assert_eq!(gait.poses.len(), CLIP_FRAMES);
        let all: Vec<f32> = (0..CLIP_FRAMES).map(higher).collect();
        let [low, high] =
            [all.iter().copied().fold(f32::MAX, f32::min), all.iter().copied().fold(f32::MIN, f32::max)];
        assert!(high - low < 0.02, "{}: hips move by {} m against the gait", gait.name, high - low);
    }
}

#[test]
fn arms_and_back_point_where_the_gait_points() {
    let gait = Walker { slump: 0.3, frames: CLIP_FRAMES, ..Walker::at(0.9, 1.25) }.gait();
    let avatar = generated(Sex::Male);
    let clip = retarget(&gait, &avatar).unwrap();
    for frame in [0, 13, 32, 50] {
        let model = pose(&avatar, &clip, frame).map(|m| m.w_axis.truncate());
        for (from, to) in [(4, 5), (5, 6), (7, 8), (8, 9)] {
            let wanted = (gait.poses[frame][to] - gait.poses[frame][from]).normalize();
            let found = (model[to] - model[from]).normalize();
            // The arms may be spread a little for a broader body.
            assert!(wanted.angle_between(found) < 0.15, "joint {to} frame {frame}: {wanted} {found}");
        }
        let back = (model[Joint::Neck as usize] - model[Joint::Root as usize]).normalize();
        assert!((back.z.asin() - 0.3).abs() < 0.08, "back leans {} rad", back.z.asin());
    }
}

#[test]
fn a_mirrored_gait_gives_a_mirrored_clip() {
    for sex in Sex::ALL {
        let avatar = generated(sex);
        let gait = Walker::at(1.2, 1.1).gait();
        let clip = retarget(&gait, &avatar).unwrap();
        let other = retarget(&mirrored(&gait), &avatar).unwrap();
        assert!((clip.stride_travel - other.stride_travel).abs() < 1e-5);
        for (a, b) in clip.frames.iter().zip(&other.frames) {
            assert!((a.root * Vec3::new(-1.0, 1.0, 1.0)).distance(b.root) < 1e-4);
            for joint in Joint::ALL {
                let q = a.rotations[joint as usize];
                let mirror = Quat::from_xyzw(q.x, -q.y, -q.z, q.w);
                let angle = mirror.angle_between(b.rotations[joint.mirrored() as usize]);
                assert!(angle < 2e-3, "{} differs by {angle} rad", joint.name());
            }
        }
    }
}

#[test]
fn metres_scale_with_the_leg_and_time_does_not() {
    let avatar = generated(Sex::Female);
    let small = Walker { size: 0.5, ..Walker::at(0.6, 1.0) };
    let large = Walker { size: 2.0, ..Walker::at(2.4, 1.0) };
    let (small, large) =
        (retarget(&small.gait(), &avatar).unwrap(), retarget(&large.gait(), &avatar).unwrap());
    assert!((small.stride_travel - large.stride_travel).abs() < 1e-4);
    for (a, b) in small.frames.iter().zip(&large.frames) {
        assert!(a.root.distance(b.root) < 1e-4);
    }
}

#[test]
fn standing_bodies_keep_both_feet_flat_and_hands_by_their_sides() {
    for sex in Sex::ALL {
        let avatar = generated(sex);
        for (emotion, stance) in Emotion::ALL.into_iter().flat_map(|e| [0, 1, 2].map(|stance| (e, stance))) {
            let clip = standing(&avatar, emotion, stance);
            assert_eq!((clip.frames.len(), clip.stride_travel, clip.speed), (CLIP_FRAMES, 0.0, 0.0));
            let c = contact(&avatar, &clip);
            assert!(c.planted == 2 * CLIP_FRAMES && c.slide < 0.002 && c.low > -0.002, "{emotion} {c:?}");
            assert!(roughness(&clip) < 0.04, "{emotion}: {}", roughness(&clip));
            let model = pose(&avatar, &clip, 0).map(|m| m.w_axis.truncate());
            assert!(model[Joint::LeftHand as usize].y < model[Joint::Root as usize].y + 0.05);
            assert!(model[Joint::Head as usize].y > 0.85 * avatar.height);
        }
    }
}

#[test]
fn unusable_gaits_are_refused_with_the_value_found() {
    let avatar = generated(Sex::Male);
    let good = Walker::at(1.2, 1.1).gait();
    let refused = |change: &dyn Fn(&mut gaitway::gait::Gait)| {
        let mut gait = good.clone();
        change(&mut gait);
        retarget(&gait, &avatar).unwrap_err().to_string()
    };
    assert!(refused(&|g| g.poses.truncate(3)).contains("has 3 frames"));
    assert!(refused(&|g| g.poses[7][5].x = f32::NAN).contains("frame 7: joint left_elbow"));
    assert!(refused(&|g| g.frame_rate = 0.0).contains("0 Hz"));
    assert!(refused(&|g| g.speed = -1.0).contains("-1 m/s"));
    assert!(
        refused(&|g| g.poses.iter_mut().flatten().for_each(|p| *p = Vec3::Y)).contains("legs are 0 m long")
    );
    let mut legless = avatar.clone();
    legless.joints[Joint::LeftKnee as usize].translation = Vec3::ZERO;
    assert!(retarget(&good, &legless).unwrap_err().to_string().contains("left_hip"));
    assert_eq!(standing(&legless, Emotion::Sad, 1).frames.len(), CLIP_FRAMES);
}

#[test]
fn draws_the_bodies() {
    let mut sheet = Sheet::new(4.8, 1.9, 300.0);
    let mut faces = Sheet::new(2.0, 0.5, 900.0);
    for sex in Sex::ALL {
        let avatar = generated(sex);
        for turn in [0.0, 0.7, 1.57, 3.1] {
            sheet.draw(&avatar, 0, &rest(&avatar), turn, 0.6, -0.05);
        }
        for turn in [0.0, 0.7, 1.57, 3.1] {
            faces.draw(&avatar, 0, &rest(&avatar), turn, 0.25, avatar.height - 0.42);
        }
    }
    sheet.save(&picture("bodies.png"));
    faces.save(&picture("faces.png"));
    let mut levels = Sheet::new(3.6, 1.9, 300.0);
    for sex in Sex::ALL {
        let avatar = generated(sex);
        for level in 0..3 {
            levels.draw(&avatar, level, &rest(&avatar), 0.5, 0.6, -0.05);
        }
    }
    levels.save(&picture("levels.png"));
    for sex in Sex::ALL {
        let avatar = generated(sex);
        let clip = retarget(&Walker::at(1.35, 1.08).gait(), &avatar).unwrap();
        let mut walk = Sheet::new(7.2, 1.9, 220.0);
        for frame in 0..8 {
            walk.draw(&avatar, 0, &clip.frames[frame * 8], 1.57, 0.9, -0.05);
        }
        walk.save(&picture(&format!("walk-{}.png", avatar.name)));
        let mut front = Sheet::new(5.4, 1.9, 260.0);
        for frame in 0..5 {
            front.draw(&avatar, 0, &clip.frames[frame * 8], 0.4, 0.9, -0.05);
        }
        front.draw(&avatar, 0, &standing(&avatar, Emotion::Neutral, 0).frames[0], 0.4, 0.9, -0.05);
        front.save(&picture(&format!("front-{}.png", avatar.name)));
    }
}
