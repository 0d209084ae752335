//! Claims about eyes: they look where they should, before the head does, hold still, move on, and blink.

use crate::paper_gaze::{run, standing};
use gaitway::Emotion;
use gaitway::kernels::layout::{GazeState, Stance};
use gaitway::kernels::shared::attention::VALID;
use gaitway::kernels::shared::body::index::{
    HEAD, LEFT_EYE, LIDS, PALETTE_STRIDE, RIG_EYEBALL, RIG_STRIDE, RIGHT_EYE, SPINE,
};
use gaitway::kernels::{Phase, Store};
use gaitway::reference;
use gaitway::verify::cases::animation::{TRAVEL, animation};
use glam::{Mat4, Vec3, Vec4};

const NATURAL: u32 = 0;
const PAPER: u32 = 1;
/// Of the made-up avatar 0: centres of its eyeballs at rest, m.
const EYES: [Vec3; 2] = [Vec3::new(0.03, 1.63, 0.08), Vec3::new(-0.03, 1.63, 0.08)];

/// So far from the agent, so many degrees to its left, at a height, m.
fn seen(degrees: f32, away: f32, height: f32) -> Vec3 {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    Vec3::new(away * sine, height, away * cosine)
}

/// World from mesh of a joint of the only agent.
fn matrix(store: &Store, joint: usize) -> Mat4 {
    let rows = &store.palettes[joint * 3..joint * 3 + 3];
    Mat4::from_cols(rows[0].into(), rows[1].into(), rows[2].into(), Vec4::W).transpose()
}

/// Centre and direction of each eye, world, m.
fn looks(store: &Store) -> [(Vec3, Vec3); 2] {
    [0, 1].map(|side| {
        let eye = matrix(store, [LEFT_EYE, RIGHT_EYE][side]);
        (eye.transform_point3(EYES[side]), eye.transform_vector3(Vec3::Z).normalize())
    })
}

/// How many degrees the eye that is farther off misses a point by.
fn off(store: &Store, point: Vec3) -> f32 {
    looks(store).map(|(at, way)| way.angle_between(point - at).to_degrees()).into_iter().fold(0.0, f32::max)
}

/// The same moment at another time, ms.
fn at_time(store: &mut Store, time: u32) {
    store.frame.gaze_time = time;
    reference::run(Phase::Eyes, store, 0);
}

#[test]
fn eyes_of_an_agent_near_by_go_between_the_users_eyes_and_mouth() {
    for user in [seen(0.0, 1.2, 1.65), seen(40.0, 2.0, 1.5), seen(-60.0, 2.9, 1.8)] {
        let mut store = standing(Emotion::Angry, NATURAL, user);
        run(&mut store);
        let across = user.with_y(0.0).normalize().cross(Vec3::Y) * 0.032;
        let parts = [user + across, user - across, user - Vec3::Y * 0.07];
        let (mut hits, mut dwells, mut before) = ([0; 3], Vec::new(), (3, 0));
        for time in (0..60_000).step_by(10) {
            at_time(&mut store, time);
            let Some(part) = (0..3).find(|part| off(&store, parts[*part]) < 0.3) else { continue };
            hits[part] += 1;
            if part != before.0 {
                dwells.push(time - before.1);
                before = (part, time);
            }
        }
        assert!(hits.iter().sum::<u32>() > 5_400, "on the way for 50 ms of 900 at most: {hits:?}");
        assert!(hits.iter().all(|hits| *hits > 600), "{hits:?}");
        assert!(dwells[1..].iter().all(|dwell| *dwell >= 290), "{dwells:?}");
    }
}

#[test]
fn from_farther_away_both_eyes_meet_between_the_users_eyes() {
    for (user, turned) in
        [(seen(20.0, 3.3, 1.7), 0.0), (seen(-50.0, 5.0, 1.2), 0.8), (seen(0.0, 7.5, 1.6), 3.0)]
    {
        let mut store = standing(Emotion::Angry, NATURAL, user);
        store.heading[0] = turned;
        let turn = Mat4::from_rotation_y(turned);
        store.frame.user_eyes = turn.transform_point3(user).extend(0.0).to_array();
        run(&mut store);
        for time in (0..10_000).step_by(100) {
            at_time(&mut store, time);
            let off = off(&store, turn.transform_point3(user));
            assert!(off < 1.0, "{off} degrees off at {time} ms");
        }
    }
}

#[test]
fn eyes_reach_the_user_long_before_the_head_does() {
    for (degrees, eyes_within, lead) in [(20.0, 1, 15), (50.0, 30, 15)] {
        let user = seen(degrees, 4.0, 1.63);
        let mut store = standing(Emotion::Angry, NATURAL, user);
        store.frame.frame_time = 1.0 / 72.0;
        store.gaze_frame[0] = (store.frame.frame_index - 1) | VALID;
        store.gaze_state[0] = GazeState::default(); // the head rests ahead
        let mut arrived = [None; 2]; // eyes, head: frames
        for frame in 1..200 {
            run(&mut store);
            store.frame.frame_index += 1;
            let face = matrix(&store, HEAD).transform_vector3(Vec3::Z);
            let [(left, _), (right, _)] = looks(&store);
            let head_off = face.angle_between(user - (left + right) * 0.5).to_degrees();
            for (arrived, off) in arrived.iter_mut().zip([off(&store, user), head_off]) {
                if off < 1.0 {
                    arrived.get_or_insert(frame);
                }
            }
        }
        let [Some(eyes), Some(head)] = arrived else { panic!("never arrived: {arrived:?}") };
        println!("{degrees} degrees: eyes after {} ms, head after {} ms", eyes * 1000 / 72, head * 1000 / 72);
        assert!(eyes <= eyes_within && eyes + lead <= head, "{degrees} degrees: {eyes} and {head} frames");
    }
}

/// How far the upper lids are turned down against the head, radians.
fn lids(store: &Store) -> f32 {
    let turned = matrix(store, HEAD).inverse() * matrix(store, LIDS);
    let forward = turned.transform_vector3(Vec3::Z);
    (-forward.y).atan2(forward.z)
}

#[test]
fn blinks_come_every_two_to_six_seconds_and_last_a_seventh_of_one() {
    let mut store = standing(Emotion::Neutral, PAPER, Vec3::ZERO);
    run(&mut store);
    let (mut gaps, mut begun, mut shut) = (Vec::new(), None, 0);
    let mut was_open = true;
    for time in (0..300_000_u32).step_by(10) {
        at_time(&mut store, time);
        let lids = lids(&store);
        let is_open = lids < 0.01;
        shut += u32::from(lids > 0.7);
        match (was_open, is_open, begun) {
            (true, false, Some(before)) => {
                gaps.push(time - before);
                begun = Some(time);
            }
            (true, false, None) => begun = Some(time),
            (false, true, Some(before)) => {
                assert!((120..=160).contains(&(time - before)), "{}", time - before);
            }
            _ => {}
        }
        was_open = is_open;
    }
    assert!(gaps.iter().all(|gap| (1_990..=6_010).contains(gap)), "{gaps:?}");
    assert!((60..90).contains(&gaps.len()), "{} in five minutes", gaps.len());
    assert!(gaps.iter().any(|gap| *gap < 3_000) && gaps.iter().any(|gap| *gap > 5_000), "regular: {gaps:?}");
    assert!(shut >= u32::try_from(gaps.len()).unwrap(), "lids close");
}

#[test]
fn sad_eyes_rest_on_the_ground_two_to_four_metres_ahead_and_others_do_not() {
    for walk in [0.0, 1.0] {
        let mut store = standing(Emotion::Sad, NATURAL, seen(0.0, 2.0, 1.6));
        store.heading[0] = 2.1;
        store.stance[0] = Stance { walk_weight: walk, stride: TRAVEL, ..store.stance[0] };
        run(&mut store);
        for time in (0..30_000).step_by(50) {
            at_time(&mut store, time);
            for (at, way) in looks(&store) {
                let reach = at.y / -way.y;
                let spot = at + way * reach;
                assert!(reach > 0.0 && (2.0..4.0).contains(&spot.length()), "{spot} at {time} ms");
                let aside = Vec3::new(2.1_f32.sin(), 0.0, 2.1_f32.cos()).angle_between(spot.with_y(0.0));
                assert!(aside.to_degrees() < 22.0, "{} degrees aside", aside.to_degrees());
            }
        }
        // without a gaze by emotion, and with faces at rest, they look as neutral people do
        store.frame.expression = 0.0;
        store.appearance[0].set_gazes(false);
        run(&mut store);
        let bare = store.palettes.clone();
        store.appearance[0].set_emotion(Emotion::Neutral as u32);
        run(&mut store);
        assert_eq!(bits(&bare), bits(&store.palettes));
        assert!(looks(&store)[0].1.y > -0.2);
    }
}

fn bits(rows: &[[f32; 4]]) -> Vec<[u32; 4]> {
    rows.iter().map(|row| row.map(f32::to_bits)).collect()
}

#[test]
fn eyes_that_look_ahead_hold_still_while_the_head_nods_and_move_on_within_three_seconds() {
    let mut store = standing(Emotion::Neutral, NATURAL, Vec3::ZERO);
    store.stance[0].walk_weight = 1.0;
    run(&mut store);
    let mut moves = 0;
    for time in (0..60_000).step_by(500) {
        // far from a change, another phase of the gait leaves the eyes where they are in the world
        at_time(&mut store, time);
        let [(_, way), _] = looks(&store);
        store.stance[0].phase = store.stance[0].phase.wrapping_add(0x1000_0000);
        run(&mut store);
        let [(_, then), _] = looks(&store);
        assert!(way.angle_between(then).to_degrees() < 0.3, "{}", way.angle_between(then).to_degrees());
        at_time(&mut store, time + 3_000);
        moves += u32::from(looks(&store)[0].1.angle_between(then) > 1e-4);
    }
    assert_eq!(moves, 120);
}

#[test]
fn in_paper_mode_eyes_stay_straight_in_the_head() {
    for emotion in [Emotion::Happy, Emotion::Angry, Emotion::Sad, Emotion::Neutral] {
        let mut store = standing(emotion, PAPER, seen(30.0, 2.0, 1.5));
        run(&mut store);
        for time in (0..20_000).step_by(70) {
            at_time(&mut store, time);
            for eye in [LEFT_EYE, RIGHT_EYE] {
                assert_eq!(store.palettes[eye * 3..eye * 3 + 3], store.palettes[HEAD * 3..HEAD * 3 + 3]);
            }
        }
    }
}

#[test]
fn without_eyeballs_and_by_coarser_meshes_nothing_is_written() {
    let whole = || standing(Emotion::Angry, NATURAL, seen(0.0, 2.0, 1.5));
    let mut with = whole();
    run(&mut with);
    let mut without = whole();
    without.rig[RIG_EYEBALL] = [0.0; 4];
    let mut coarse = whole();
    coarse.frame.level_distance[0] = 0.0;
    for mut store in [without, coarse] {
        assert_eq!(store.rig.len(), 2 * RIG_STRIDE);
        run(&mut store);
        let (own, eyes) = store.palettes[..PALETTE_STRIDE].split_at(LEFT_EYE * 3);
        assert!(eyes.iter().flatten().all(|number| number.is_nan()));
        assert_eq!(bits(own), bits(&with.palettes[..LEFT_EYE * 3]));
    }
}

#[test]
fn eyes_stay_within_their_reach_whatever_there_is_to_see() {
    let mut turned = 0.0_f32;
    for seed in 0..8 {
        let mut store = animation(400, seed);
        run(&mut store);
        for palette in store.palettes.chunks_exact(PALETTE_STRIDE).take_while(|rows| !rows[0][0].is_nan()) {
            if palette[LEFT_EYE * 3][0].is_nan() {
                continue;
            }
            let of = |joint: usize| {
                let rows = &palette[joint * 3..joint * 3 + 3];
                Mat4::from_cols(rows[0].into(), rows[1].into(), rows[2].into(), Vec4::W).transpose()
            };
            let forward = of(HEAD).transform_vector3(Vec3::Z);
            for eye in [LEFT_EYE, RIGHT_EYE] {
                let away = of(eye).transform_vector3(Vec3::Z).angle_between(forward).to_degrees();
                assert!(away < 36.0, "{away} degrees, seed {seed}");
                turned = turned.max(away);
            }
        }
    }
    assert!(turned > 20.0, "the case tests little");
}

#[test]
fn the_trunk_takes_part_in_turns_beyond_45_degrees_and_the_face_points_as_before() {
    let turned = |degrees: f32, mode: u32| {
        let user = seen(degrees, 3.0, 1.63);
        let mut store = standing(Emotion::Angry, mode, user);
        run(&mut store);
        let yaw = |joint: usize| {
            let way = matrix(&store, joint).transform_vector3(Vec3::Z);
            way.x.atan2(way.z).to_degrees()
        };
        (yaw(SPINE), yaw(HEAD))
    };
    for side in [-1.0, 1.0] {
        for (degrees, trunk) in [(30.0, 0.0), (44.0, 0.0), (55.0, 4.0), (65.0, 8.0), (85.0, 10.0)] {
            let (spine, face) = turned(side * degrees, NATURAL);
            assert!((side * spine - trunk).abs() < 0.4, "{degrees}: {spine}");
            assert!((side * face - degrees.min(70.0)).abs() < 1.0, "{degrees}: {face}");
            assert!(turned(side * degrees, PAPER).0.abs() < 1e-3, "the paper turns the neck alone");
        }
    }
}
