//! The gaze behaviours of the paper (section 4.5) as worked numbers, one test per equation, then one per resolved
//! ambiguity, then what `natural` mode adds.

use crate::common::built::Built;
use gaitway::Emotion;
use gaitway::avatar::{Avatar, ClipFrame};
use gaitway::gait::{JOINT_COUNT, Joint};
use gaitway::kernels::gaze::RATE_LIMIT;
use gaitway::kernels::layout::{Appearance, GazeState, Stance};
use gaitway::kernels::shared::attention::{ENGAGED, VALID};
use gaitway::kernels::shared::body::index::POSE_STRIDE;
use gaitway::kernels::{KernelId, Store};
use gaitway::reference;
use gaitway::reference::body::{CLIP_STRIDE, visible_agents};
use gaitway::sim::bodies::looking_at;
use gaitway::verify::cases::animation::{AVATARS, CLIPS, GAITS, TRAVEL, animation, dispatches};
use gaitway::verify::cases::avatars::{avatar, clip_elements};
use glam::{Quat, Vec3, Vec4};

const NATURAL: u32 = 0;
const PAPER: u32 = 1;
/// Of the made-up avatar 0 standing at the origin with all joints as the model's axes, m.
const NECK: Vec3 = Vec3::new(0.0, 1.45, -0.01);
const EYES: Vec3 = Vec3::new(0.0, 1.63, 0.10);

/// Runs all dispatches on the CPU but those by which bodies differ from their clips.
pub(crate) fn run(store: &mut Store) {
    let is_own = |kernel| matches!(kernel, KernelId::Idle | KernelId::Manner);
    for dispatch in dispatches(store).into_iter().filter(|dispatch| !is_own(dispatch.kernel())) {
        reference::run(dispatch.phase, store, dispatch.immediate);
    }
}

/// One agent of that emotion standing upright at the origin, facing +z, gazing for the first time; everything is seen.
pub(crate) fn standing(emotion: Emotion, mode: u32, user: Vec3) -> Store {
    let mut store = animation(1, 0);
    store.elevation.fill(0.0);
    store.position[0] = [0.0, 0.0];
    store.heading[0] = 0.0;
    store.stance[0] = Stance { phase: store.stance[0].phase, ..Stance::default() };
    store.appearance[0] = Appearance::new(0, emotion as u32, true, 1.0, [0; 4]);
    store.gaits[0] = [0; 4];
    store.gait_weights[0] = [1.0, 0.0, 0.0, 0.0];
    store.gaze_frame[0] = 0;
    store.frame.planes = [[0.0, 0.0, 0.0, 1.0]; 12];
    store.frame.gaze_mode = mode;
    store.frame.user_eyes = user.extend(0.0).to_array();
    let joints = avatar(0, 0).joints;
    let rest = ClipFrame { rotations: joints.map(|joint| joint.rotation), root: joints[0].translation };
    for frame in standing_frames(&mut store) {
        frame.copy_from_slice(&clip_elements(&rest, 0.0));
    }
    store
}

/// The frames of the clips in which the made-up avatar 0 stands.
fn standing_frames(store: &mut Store) -> impl Iterator<Item = &mut [[f32; 4]]> {
    store.clip_frames[GAITS * CLIP_STRIDE..CLIPS * CLIP_STRIDE].chunks_mut(POSE_STRIDE)
}

/// (flexion, rotation) of the neck joint in degrees, for an avatar with the model's axes in every joint.
fn neck_angles(store: &Store) -> (f32, f32) {
    let q = Quat::from_array(store.local_rotations[Joint::Neck as usize]);
    let chin = q * Vec3::Z;
    ((-chin.y).asin().to_degrees(), chin.x.atan2(chin.z).to_degrees())
}

fn neck_of(mut store: Store) -> (f32, f32) {
    run(&mut store);
    neck_angles(&store)
}

fn close(got: f32, want: f32) {
    assert!((got - want).abs() < 0.01, "{got} degrees, not {want}");
}

/// A point seen from the neck at `degrees` to the left, `away` metres on the ground, at a height.
fn seen_from_neck(degrees: f32, away: f32, height: f32) -> Vec3 {
    let (s, c) = degrees.to_radians().sin_cos();
    Vec3::new(NECK.x + away * s, height, NECK.z + away * c)
}

#[test]
fn happy_flexion_is_minus_five_degrees() {
    close(neck_of(standing(Emotion::Happy, PAPER, Vec3::new(0.0, 1.6, 2.0))).0, -5.0);
}

#[test]
fn happy_rotation_is_the_angle_between_forward_and_the_user() {
    close(neck_of(standing(Emotion::Happy, PAPER, seen_from_neck(30.0, 2.0, 1.6))).1, 30.0);
}

#[test]
fn angry_flexion_is_the_arcsine_of_rise_over_ground_distance() {
    let user = seen_from_neck(0.0, 2.0, EYES.y - 0.5); // asin(0.5 / 2)
    close(neck_of(standing(Emotion::Angry, PAPER, user)).0, 14.4775);
}

#[test]
fn angry_rotation_is_the_angle_between_forward_and_the_user() {
    close(neck_of(standing(Emotion::Angry, PAPER, seen_from_neck(-45.0, 3.0, 1.6))).1, -45.0);
}

#[test]
fn sad_flexion_is_ten_degrees() {
    close(neck_of(standing(Emotion::Sad, PAPER, Vec3::new(0.0, 1.6, 2.0))).0, 10.0);
}

#[test]
fn sad_rotation_is_zero_wherever_the_user_is() {
    close(neck_of(standing(Emotion::Sad, PAPER, seen_from_neck(60.0, 2.0, 1.6))).1, 0.0);
}

#[test]
fn neutral_keeps_the_angles_of_the_gait() {
    for mode in [NATURAL, PAPER] {
        let mut store = standing(Emotion::Neutral, mode, seen_from_neck(60.0, 2.0, 1.6));
        (store.stance[0].walk_weight, store.stance[0].stride) = (1.0, TRAVEL); // walks
        let mut without = store.clone();
        without.appearance[0].set_gazes(false);
        run(&mut store);
        run(&mut without);
        assert_eq!(store.local_rotations[..POSE_STRIDE], without.local_rotations[..POSE_STRIDE]);
    }
}

#[test]
fn the_height_of_the_floor_that_an_agent_stands_on_counts() {
    // a user on the ground, 6 m before an agent whose eyes are 3 m higher on a bridge; and the other way round
    for (elevation, eyes) in [(3.0, 1.6), (0.0, 4.6)] {
        let user = Vec3::new(0.0, eyes, NECK.z + 6.0);
        let mut store = standing(Emotion::Angry, PAPER, user);
        store.elevation.fill(elevation);
        let rise = EYES.y + elevation - eyes;
        close(neck_of(store).0, (rise / 6.0).asin().to_degrees());
        let mut store = standing(Emotion::Angry, NATURAL, user);
        store.elevation.fill(elevation);
        run(&mut store);
        let (eyes, face) = eyes_and_face(&store, 0, &avatar(0, 0));
        let off = face.angle_between(user - eyes).to_degrees();
        assert!(off < 1.0 && face.y.abs() > 0.4, "{off} degrees off, face {face}");
    }
}

#[test]
fn without_a_user_happy_and_angry_heads_keep_the_angles_of_the_gait_in_either_mode() {
    for (emotion, mode) in
        [Emotion::Happy, Emotion::Angry].map(|e| [(e, NATURAL), (e, PAPER)]).into_iter().flatten()
    {
        let mut alone = standing(emotion, mode, Vec3::new(1.0, 1.6, 2.0));
        let mut seen = alone.clone();
        alone.frame = looking_at(alone.frame, None);
        let mut without = alone.clone();
        without.appearance[0].set_gazes(false);
        for store in [&mut alone, &mut seen, &mut without] {
            run(store);
        }
        assert_eq!(alone.local_rotations[..POSE_STRIDE], without.local_rotations[..POSE_STRIDE]);
        assert_ne!(seen.local_rotations[..POSE_STRIDE], without.local_rotations[..POSE_STRIDE]);
    }
}

#[test]
fn a12_paper_mode_clamps_the_arcsine_and_natural_mode_takes_the_arctangent() {
    // rise 0.5 over 1 m: 30 degrees by the paper's arcsin
    let lower = seen_from_neck(0.0, 1.0, EYES.y - 0.5);
    close(neck_of(standing(Emotion::Angry, PAPER, lower)).0, 30.0);
    // rise 1.2 over 1 m: no arcsin; clamped to 90, then to the neck's 45
    let far_below = seen_from_neck(0.0, 1.0, EYES.y - 1.2);
    close(neck_of(standing(Emotion::Angry, PAPER, far_below)).0, 45.0);
    // natural: the slope of the line of sight itself, 26.6 degrees for 0.5 over 1 m from where the eyes end up
    let mut store = standing(Emotion::Angry, NATURAL, lower);
    run(&mut store);
    let (eyes, face) = eyes_and_face(&store, 0, &avatar(0, 0));
    let down = (eyes.y - lower.y).atan2(Vec3::new(lower.x - eyes.x, 0.0, lower.z - eyes.z).length());
    close((-face.y).asin().to_degrees(), down.to_degrees());
}

#[test]
fn a13_sad_heads_go_down_and_happy_ones_up() {
    for mode in [NATURAL, PAPER] {
        let user = Vec3::new(0.0, 1.63, 3.0);
        let face_of = |emotion| {
            let mut store = standing(emotion, mode, user);
            run(&mut store);
            eyes_and_face(&store, 0, &avatar(0, 0)).1
        };
        assert!(face_of(Emotion::Sad).y < -0.17, "mode {mode}");
        assert!(face_of(Emotion::Happy).y > 0.08, "mode {mode}");
    }
}

#[test]
fn a14_rotation_is_signed_left_positive_about_the_vertical() {
    for emotion in [Emotion::Happy, Emotion::Angry] {
        for height in [0.4, 1.6, 2.4] {
            close(neck_of(standing(emotion, PAPER, seen_from_neck(20.0, 2.0, height))).1, 20.0);
            close(neck_of(standing(emotion, PAPER, seen_from_neck(-20.0, 2.0, height))).1, -20.0);
        }
    }
}

#[test]
fn a14_rotation_is_counted_from_the_torso_not_from_the_heading() {
    let mut store = standing(Emotion::Angry, PAPER, seen_from_neck(50.0, 4.0, EYES.y));
    let turned = Quat::from_rotation_y(20.0_f32.to_radians());
    for frame in standing_frames(&mut store) {
        frame[Joint::Spine as usize] = turned.to_array();
    }
    // the neck turns with the torso by less than a centimetre
    let rotation = neck_of(store).1;
    assert!((rotation - 30.0).abs() < 0.2, "{rotation}");
}

#[test]
fn a15_rotation_is_seen_from_the_neck_and_flexion_from_the_height_of_the_eyes() {
    let mut store = standing(Emotion::Angry, PAPER, Vec3::new(0.3, 1.63, 2.0));
    for frame in standing_frames(&mut store) {
        frame[JOINT_COUNT][0] += 0.3; // sways 0.3 m to the left: the user is straight ahead of the neck
        frame[JOINT_COUNT][1] -= 0.2; // and crouches
    }
    let (flexion, rotation) = neck_of(store);
    close(rotation, 0.0);
    close(flexion, (-0.2_f32 / 2.01).asin().to_degrees());
    // a person of half the size has their eyes at half the height
    let mut store = standing(Emotion::Angry, PAPER, seen_from_neck(0.0, 2.0, EYES.y));
    store.appearance[0].scale = 0.5;
    close(neck_of(store).0, ((EYES.y * 0.5 - EYES.y) / (2.0 + NECK.z * 0.5)).asin().to_degrees());
}

#[test]
fn a16_happy_flexion_is_constant_in_paper_mode_and_five_degrees_above_the_user_in_natural_mode() {
    for height in [0.8, 1.63, 2.2] {
        let user = Vec3::new(0.0, height, 2.0);
        close(neck_of(standing(Emotion::Happy, PAPER, user)).0, -5.0);
        let mut store = standing(Emotion::Happy, NATURAL, user);
        run(&mut store);
        let (eyes, face) = eyes_and_face(&store, 0, &avatar(0, 0));
        let line = (user - eyes).normalize();
        let above = face.y.asin().to_degrees() - line.y.asin().to_degrees();
        assert!((above - 5.0).abs() < 0.5, "{above} degrees above the line of sight");
    }
}

#[test]
fn a17_the_neck_turns_at_most_seventy_degrees_and_a_user_behind_is_not_followed() {
    let behind = seen_from_neck(150.0, 2.0, 1.6);
    close(neck_of(standing(Emotion::Angry, PAPER, behind)).1, 70.0);
    close(neck_of(standing(Emotion::Angry, PAPER, seen_from_neck(-150.0, 2.0, 1.6))).1, -70.0);
    close(neck_of(standing(Emotion::Angry, PAPER, seen_from_neck(0.0, 0.5, 3.0))).0, -45.0);
    let (flexion, rotation) = neck_of(standing(Emotion::Angry, NATURAL, behind));
    close(flexion, 0.0);
    close(rotation, 0.0);
    for side in [-1.0, 1.0] {
        let mut store = standing(Emotion::Angry, NATURAL, seen_from_neck(85.0 * side, 0.6, 0.2));
        run(&mut store);
        let (_, face) = eyes_and_face(&store, 0, &avatar(0, 0));
        close(face.x.atan2(face.z).to_degrees(), 70.0 * side);
        close((-face.y).asin().to_degrees(), 45.0);
    }
}

#[test]
fn a17_a_user_on_the_same_spot_leaves_the_head_as_it_was() {
    for mode in [NATURAL, PAPER] {
        for remembered in [true, false] {
            let mut store = standing(Emotion::Angry, mode, Vec3::new(NECK.x, 2.5, NECK.z + 0.004));
            if remembered {
                store.gaze_frame[0] = (store.frame.frame_index - 1) | VALID | ENGAGED;
                store.gaze_state[0] = GazeState { flexion: 0.2, rotation: 0.4, ..GazeState::default() };
            }
            run(&mut store);
            let (_, face) = eyes_and_face(&store, 0, &avatar(0, 0));
            let want = if remembered { (11.459, 22.918) } else { (0.0, 0.0) };
            close((-face.y).asin().to_degrees(), want.0);
            close(face.x.atan2(face.z).to_degrees(), want.1);
        }
    }
}

/// World position of the eyes and unit direction of the face of the agent in a slot, by glam.
fn eyes_and_face(store: &Store, slot: usize, avatar: &Avatar) -> (Vec3, Vec3) {
    let built = Built::new(store, slot, avatar);
    let head = built.joints()[Joint::Head as usize];
    let face = avatar.joints[Joint::Head as usize].joint_from_mesh.transform_vector3(Vec3::Z);
    let eyes = head.transform_point3(avatar.eyes_in_head * built.head_size());
    (eyes, head.transform_vector3(face).normalize())
}

#[test]
fn natural_gaze_hits_the_users_eyes_whatever_the_gait_and_the_rig() {
    let (mut gazing, mut worst) = (0, 0.0_f32);
    for seed in [0, 8, 16] {
        let mut store = animation(1000, seed);
        store.elevation.fill(0.0);
        store.frame.planes = [[0.0, 0.0, 0.0, 1.0]; 12];
        for agent in 0..1000 {
            store.appearance[agent].set_emotion(Emotion::Angry as u32);
            store.appearance[agent].set_gazes(true);
            store.appearance[agent].set_bodiless(false);
            store.gaze_frame[agent] = 0; // starts at the target
        }
        run(&mut store);
        let avatars: Vec<Avatar> = (0..AVATARS).map(|number| avatar(number, seed)).collect();
        let user = Vec4::from_array(store.frame.user_eyes).truncate();
        for (slot, agent) in visible_agents(&store.visible).iter().enumerate() {
            let agent = *agent as usize;
            let GazeState { flexion, rotation, .. } = store.gaze_state[agent];
            let at_limit = rotation.abs() > 50_f32.to_radians() || flexion.abs() > 44.9_f32.to_radians();
            if store.gaze_frame[agent] & ENGAGED == 0 || at_limit {
                continue;
            }
            let (eyes, face) =
                eyes_and_face(&store, slot, &avatars[store.appearance[agent].avatar() as usize]);
            let off = face.angle_between(user - eyes).to_degrees();
            let away = eyes.distance(user);
            assert!(off < 1.0, "agent {agent}, seed {seed}: {off} degrees off at {away} m");
            gazing += 1;
            worst = worst.max(off);
        }
    }
    println!("{gazing} gazes, worst {worst} degrees off");
    assert!(gazing > 150, "only {gazing} agents gaze: the case tests little");
}

/// Runs `pictures` frames, moving the user by the given function, and returns (flexion, rotation) of the face in each, radians.
fn film(store: &mut Store, pictures: u32, user: impl Fn(u32) -> Vec3) -> Vec<(f32, f32)> {
    (0..pictures)
        .map(|picture| {
            store.frame.user_eyes = user(picture).extend(0.0).to_array();
            run(store);
            store.frame.frame_index += 1;
            let (_, face) = eyes_and_face(store, 0, &avatar(0, 0));
            ((-face.y).asin(), face.x.atan2(face.z))
        })
        .collect()
}

#[test]
fn natural_gaze_moves_smoothly_never_faster_than_its_limit_and_arrives_without_overshoot() {
    let mut store = standing(Emotion::Angry, NATURAL, Vec3::ZERO);
    let time = 1.0 / 72.0;
    store.frame.frame_time = time;
    let angles =
        film(&mut store, 200, |picture| seen_from_neck(if picture < 10 { -60.0 } else { 60.0 }, 3.0, 1.63));
    assert!(angles[0].1 < -1.0, "a gaze that begins unseen starts at its target");
    let steps: Vec<f32> = angles.windows(2).map(|pair| pair[1].1 - pair[0].1).collect();
    let fastest = steps.iter().copied().fold(0.0, f32::max);
    assert!(fastest <= RATE_LIMIT * time * 1.001, "{} rad/s", fastest / time);
    assert!(fastest > RATE_LIMIT * time * 0.9, "120 degrees are worth hurrying");
    assert!(steps[10..].iter().all(|step| *step > -1e-4), "turned back");
    assert!((angles[199].1.to_degrees() - 60.0).abs() < 0.5, "{}", angles[199].1.to_degrees());
    let jerk = steps.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f32::max);
    assert!(jerk < 0.5 * RATE_LIMIT * time, "speed jumps by {} rad/s", jerk / time);
}

#[test]
fn natural_gaze_engages_within_the_field_of_regard_and_lets_go_ten_degrees_later() {
    let engaged_at = |start: f32, end: f32| {
        let mut store = standing(Emotion::Angry, NATURAL, Vec3::ZERO);
        (0..=100u16)
            .map(|picture| {
                let degrees = start + (end - start) * f32::from(picture) / 100.0;
                film(&mut store, 1, |_| seen_from_neck(degrees, 3.0, 1.63));
                (degrees, store.gaze_frame[0] & ENGAGED != 0)
            })
            .collect::<Vec<_>>()
    };
    let lost = engaged_at(60.0, 120.0).into_iter().find(|(_, engaged)| !engaged).unwrap().0;
    let found = engaged_at(120.0, 60.0).into_iter().find(|(_, engaged)| *engaged).unwrap().0;
    assert!((lost - 100.0).abs() < 1.0, "let go at {lost} degrees");
    assert!((found - 90.0).abs() < 1.0, "engaged at {found} degrees");
}

#[test]
fn natural_gaze_ends_beyond_eight_metres_and_hands_the_head_back_to_the_gait() {
    let mut store = standing(Emotion::Angry, NATURAL, Vec3::ZERO);
    film(&mut store, 3, |_| seen_from_neck(40.0, 7.9, 1.63));
    assert!(store.gaze_frame[0] & ENGAGED != 0);
    film(&mut store, 3, |_| seen_from_neck(40.0, 8.4, 1.63));
    assert!(store.gaze_frame[0] & ENGAGED != 0, "hysteresis of half a metre");
    let angles = film(&mut store, 150, |_| seen_from_neck(40.0, 8.6, 1.63));
    assert!(store.gaze_frame[0] & ENGAGED == 0);
    assert!(angles[0].1 > 0.6, "let go with a jerk");
    let mut without = store.clone();
    without.appearance[0].set_gazes(false);
    run(&mut store);
    run(&mut without);
    assert_eq!(store.local_rotations[..POSE_STRIDE], without.local_rotations[..POSE_STRIDE]);
    // and back in range it starts from where the gait holds the head
    let angles = film(&mut store, 2, |_| seen_from_neck(40.0, 5.0, 1.63));
    assert!(angles[0].1 < 0.1, "snapped to {} rad", angles[0].1);
}

#[test]
fn a_gaze_that_missed_a_picture_starts_afresh_at_its_target() {
    for (missed, starts_at) in [(1, -60.0), (2, 60.0)] {
        let mut store = standing(Emotion::Angry, NATURAL, Vec3::ZERO);
        film(&mut store, 1, |_| seen_from_neck(-60.0, 3.0, 1.63));
        store.frame.frame_index += missed - 1;
        let angles = film(&mut store, 1, |_| seen_from_neck(60.0, 3.0, 1.63));
        let degrees = angles[0].1.to_degrees();
        assert!((degrees - starts_at).abs() < 4.0, "missed {missed}: {degrees} degrees");
    }
}

#[test]
fn natural_gaze_stays_on_the_user_while_the_body_walks() {
    let mut store = standing(Emotion::Angry, NATURAL, Vec3::ZERO);
    (store.stance[0].walk_weight, store.stance[0].stride) = (1.0, TRAVEL);
    store.gaits[0][0] = 1;
    let user = seen_from_neck(15.0, 3.0, 1.5);
    let mut worst = 0.0_f32;
    for picture in 0..300 {
        store.stance[0].phase = store.stance[0].phase.wrapping_add(u32::MAX / 72); // one stride a second
        film(&mut store, 1, |_| user);
        let (eyes, face) = eyes_and_face(&store, 0, &avatar(0, 0));
        if picture > 100 {
            worst = worst.max(face.angle_between(user - eyes).to_degrees());
        }
    }
    assert!(worst < 3.0, "{worst} degrees off while walking");
    println!("{worst} degrees off at worst while walking");
}

#[test]
fn a_sad_head_that_hangs_lower_is_not_lifted_in_natural_mode() {
    let mut store = standing(Emotion::Sad, NATURAL, Vec3::new(0.0, 1.6, 2.0));
    for frame in standing_frames(&mut store) {
        frame[Joint::Neck as usize] = Quat::from_rotation_x(25.0_f32.to_radians()).to_array();
    }
    run(&mut store);
    let (_, face) = eyes_and_face(&store, 0, &avatar(0, 0));
    close((-face.y).asin().to_degrees(), 25.0);
}
