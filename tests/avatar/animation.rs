//! What the animation kernels must do: `cull`, `compact`, `pose`, `gaze`, `palette`, `skin`; `eyes` have their own file.
//! The paper's equations for the gaze have their own file, `paper_gaze.rs`.

use crate::common::built::Built;
use gaitway::avatar::{Avatar, CLIP_FRAMES, Material, Vertex};
use gaitway::gait::{JOINT_COUNT, Joint};
use gaitway::kernels::layout::{Appearance, MeshRange, Stance};
use gaitway::kernels::shared::body::index::{
    FACE_STRIDE, FIST_NORMAL, HEAD, LEFT_EYE, NECK, PALETTE_STRIDE, POSE_STRIDE, RIG_EYEBALL, RIG_STRIDE,
    SKIN_JOINTS, SPINE, VERTEX_STRIDE,
};
use gaitway::kernels::shared::body::{MATERIAL_BITS, NONE};
use gaitway::kernels::shared::standing::STANCES;
use gaitway::kernels::{KernelId, Store};
use gaitway::reference;
use gaitway::reference::body::{CLIP_STRIDE, PARENTS, visible_agents, visible_slots};
use gaitway::reference::exact::unit_f32;
use gaitway::reference::pose::weight_phase;
use gaitway::reference::standing::stance_of;
use gaitway::verify::cases::animation::{AVATARS, GAITS, TRAVEL, animation, dispatches};
use gaitway::verify::cases::avatars::{avatar, vertex_elements};
use glam::{Quat, Vec3, Vec4};

/// The same people, all on the ground: what is tested here stands at one height.
fn on_the_ground(mut store: Store) -> Store {
    store.elevation.fill(0.0);
    store
}

/// Runs all dispatches on the CPU.
fn run(store: &mut Store) {
    for dispatch in dispatches(store) {
        reference::run(dispatch.phase, store, dispatch.immediate);
    }
}

/// The same without what bodies do that is not in their clips.
fn run_clips_only(store: &mut Store) {
    let is_own = |kernel| matches!(kernel, KernelId::Idle | KernelId::Manner);
    for dispatch in dispatches(store).into_iter().filter(|dispatch| !is_own(dispatch.kernel())) {
        reference::run(dispatch.phase, store, dispatch.immediate);
    }
}

fn ran(agents: usize, seed: u32) -> Store {
    let mut store = on_the_ground(animation(agents, seed));
    run(&mut store);
    store
}

/// `VkDrawIndexedIndirectCommand` of so many agents of a mesh.
fn command(mesh: MeshRange, agents: u32) -> [u32; 5] {
    [mesh.index_count, agents, mesh.first_index, mesh.first_vertex, 0]
}

/// Buckets of far bodies.
fn far_buckets(store: &Store) -> std::ops::Range<usize> {
    let first = store.frame.bucket_count as usize;
    first..first + 2 * AVATARS
}

fn avatar_of(store: &Store, agent: usize) -> usize {
    store.appearance[agent].avatar() as usize
}

/// Whether the agent is drawn by a mesh with eyes that turn.
fn has_eyes(store: &Store, agent: usize) -> bool {
    let eyeball = store.rig[avatar_of(store, agent) * RIG_STRIDE + RIG_EYEBALL];
    eyeball[3] > 0.0 && store.agent_bucket[agent].is_multiple_of(store.frame.level_count)
}

fn scale_of(store: &Store, agent: usize) -> f32 {
    store.appearance[agent].scale
}

#[test]
fn the_kernels_know_the_skeleton() {
    assert_eq!(PARENTS, Joint::PARENT);
    let by_name = [(SPINE, "spine"), (NECK, "neck"), (HEAD, "head")];
    assert!(by_name.iter().all(|(joint, name)| Joint::ALL[*joint].name() == *name));
}

#[test]
fn culling_draws_exactly_the_agents_that_an_eye_sees_within_range() {
    let (mut seen_far, mut specks) = (0, 0);
    for seed in 0..6 {
        let mut store = on_the_ground(animation(700, seed * 8)); // ample room, natural gaze, two eyes
        run(&mut store);
        let levels = store.frame.level_count;
        let mut drawn = 0;
        for agent in 0..700 {
            // the last six are impossible by construction, and one has no body
            let usable = agent < 700 - 6 && !store.appearance[agent].is_bodiless();
            let at = Vec3::new(store.position[agent][0], 0.0, store.position[agent][1]);
            let scale = scale_of(&store, agent);
            let own = store.appearance[agent];
            let height = store.frame.agent_height * scale * own.stature();
            let radius = store.frame.agent_radius * scale * own.breadth().max(1.0);
            // a dense row of spheres instead of a capsule
            let seen = (0..store.frame.eye_count as usize).any(|eye| {
                store.frame.planes[eye * 6..eye * 6 + 6].iter().all(|plane| {
                    (0..=200u16).any(|i| {
                        let y = radius + (height - 2.0 * radius) * f32::from(i) / 200.0;
                        let centre = (at + Vec3::Y * y).extend(1.0);
                        Vec4::from_array(*plane).dot(centre) >= -radius - 1e-6
                    })
                })
            });
            let camera = Vec4::from_array(store.frame.camera).truncate();
            let distance = (at + Vec3::Y * height * 0.5).distance(camera);
            let want = if usable && seen && distance <= store.frame.level_distance[2] {
                let finer = store.frame.level_distance[..2].iter().filter(|d| distance >= **d).count();
                let level = u32::try_from(finer).unwrap().min(levels - 1);
                let (avatar, far) = (store.appearance[agent].avatar(), store.frame.level_distance[3]);
                let is_far = far > 0.0 && distance >= far;
                seen_far += usize::from(is_far);
                let is_speck = is_far && distance >= store.frame.camera[3];
                specks += usize::from(is_speck);
                let far_bucket = store.frame.bucket_count
                    + avatar
                    + if is_speck { u32::try_from(AVATARS).unwrap() } else { 0 };
                if is_far { far_bucket } else { avatar * levels + level }
            } else {
                NONE
            };
            assert_eq!(store.agent_bucket[agent], want, "agent {agent}, seed {seed}, {distance} m");
            drawn += usize::from(want != NONE);
        }
        assert!((100..600).contains(&drawn), "{drawn} drawn: the case tests little");
    }
    assert!(specks > 30 && seen_far > specks + 30, "{seen_far} far, {specks} specks: the case tests little");
}

#[test]
fn visible_agents_are_sorted_by_bucket_then_id_and_the_arguments_count_them() {
    for (agents, seed) in
        [(0, 0), (1, 0), (63, 1), (64, 2), (65, 3), (1000, 0), (1000, 1), (1000, 4), (1000, 5)]
    {
        let store = ran(agents, seed);
        let visible = visible_agents(&store.visible);
        let key = |agent: &u32| (store.agent_bucket[*agent as usize], *agent);
        assert!(visible.is_sorted_by_key(key), "{agents} agents, seed {seed}");
        assert!(visible.len() <= store.frame.visible_capacity as usize);
        let in_bucket = |b: u32| store.agent_bucket[..agents].iter().filter(|x| **x == b).count();
        let mut start = 0;
        for bucket in 0..store.frame.bucket_count {
            let b = bucket as usize;
            assert_eq!(store.bucket_start[b] as usize, start);
            let count = in_bucket(bucket);
            let mesh = store.mesh_table[b];
            let count32 = u32::try_from(count).unwrap();
            assert_eq!(store.draw_args[b * 5..b * 5 + 5], command(mesh, count32));
            let levels = store.frame.level_count as usize;
            let coarser = store.mesh_table[if b % levels + 1 < levels { b + 1 } else { b }];
            let shadow = (store.frame.bucket_count as usize + 2 * AVATARS + b) * 5;
            assert_eq!(store.draw_args[shadow..shadow + 5], command(coarser, count32));
            if bucket % store.frame.level_count == 0 {
                let args = &store.dispatch_args[3 + 3 * (bucket / store.frame.level_count) as usize..][..3];
                assert_eq!(args, [mesh.vertex_count.div_ceil(64), count32, 1]);
            }
            start += count;
        }
        assert_eq!(store.bucket_start[store.frame.bucket_count as usize] as usize, start);
        assert_eq!(start, visible.len(), "no agent lost, none twice");
        assert_eq!(store.dispatch_args[..3], [u32::try_from(start).unwrap().div_ceil(64), 1, 1]);
        // far bodies: behind the room for those with a pose, likewise sorted
        let room = visible_slots(store.frame.visible_capacity as usize);
        let mut far = room;
        for bucket in far_buckets(&store) {
            assert_eq!(store.bucket_start[bucket + 1] as usize, far);
            let of_it = (0..agents).filter(|a| store.agent_bucket[*a] as usize == bucket);
            let of_it: Vec<u32> = of_it.map(|agent| u32::try_from(agent).unwrap()).collect();
            assert_eq!(store.visible[far..far + of_it.len()], of_it);
            let (mesh, count) = (store.mesh_table[bucket], u32::try_from(of_it.len()).unwrap());
            assert_eq!(store.draw_args[bucket * 5..bucket * 5 + 5], command(mesh, count));
            far += of_it.len();
        }
        let drawn = store.agent_bucket[..agents].iter().filter(|bucket| **bucket != NONE).count();
        assert_eq!(drawn, visible.len() + far - room);
        assert_eq!(far > room, agents >= 63 && store.frame.level_distance[3] > 0.0, "{agents}, seed {seed}");
        let near: usize =
            (0..store.frame.bucket_count).step_by(store.frame.level_count as usize).map(in_bucket).sum();
        assert!(near <= store.frame.near_capacity as usize, "{near} near agents, seed {seed}");
    }
}

#[test]
fn near_agents_beyond_the_room_go_one_level_down_in_order_of_id_and_none_is_reported() {
    let ample = ran(1000, 0);
    let mut tight = on_the_ground(animation(1000, 0));
    tight.frame.near_capacity = 5;
    run(&mut tight);
    let near: Vec<usize> = (0..1000).filter(|a| matches!(ample.agent_bucket[*a], 0 | 3)).collect();
    assert!(near.len() > 10);
    for agent in 0..1000 {
        let demoted = near.iter().position(|a| *a == agent).is_some_and(|order| order >= 5);
        assert_eq!(tight.agent_bucket[agent], ample.agent_bucket[agent] + u32::from(demoted));
    }
    assert_eq!(tight.failure[KernelId::Compact as usize], u32::MAX);
}

#[test]
fn agents_beyond_the_room_are_dropped_and_the_first_is_reported() {
    let ample = ran(1000, 0);
    let mut tight = on_the_ground(animation(1000, 0));
    tight.frame.visible_capacity = 70;
    run(&mut tight);
    let seen: Vec<usize> = (0..1000).filter(|a| ample.agent_bucket[*a] != NONE).collect();
    assert_eq!(visible_agents(&tight.visible).len(), 70);
    assert_eq!(tight.failure[KernelId::Compact as usize] as usize, seen[70]);
    assert_eq!(ample.failure[KernelId::Compact as usize], u32::MAX);
}

#[test]
fn agents_beyond_the_room_become_far_bodies_where_there_are_such() {
    let ample = ran(1000, 16);
    for (visible, near, level_count) in [(70, 1000, 3), (1000, 5, 1)] {
        let mut tight = on_the_ground(animation(1000, 16));
        tight.frame.visible_capacity = visible;
        tight.frame.near_capacity = near;
        if level_count == 1 {
            tight.mesh_table = [0, 3, 6, 7, 8, 9].map(|mesh| tight.mesh_table[mesh]).to_vec();
            (tight.frame.level_count, tight.frame.bucket_count) = (1, 2);
        }
        run(&mut tight);
        let posed = visible_agents(&tight.visible).len();
        assert_eq!(posed, visible.min(near) as usize);
        assert_eq!(tight.failure[KernelId::Compact as usize], u32::MAX, "no agent is lost");
        let drawn = |store: &Store| (0..1000).filter(|a| store.agent_bucket[*a] != NONE).count();
        let far = tight.draw_args[tight.frame.bucket_count as usize * 5..]
            .chunks(5)
            .take(2 * AVATARS)
            .map(|a| a[1]);
        assert_eq!(posed + far.sum::<u32>() as usize, drawn(&ample));
    }
}

#[test]
fn an_impossible_agent_is_reported_and_not_drawn() {
    let store = ran(500, 0);
    assert_eq!(store.failure[KernelId::Cull as usize], 494);
    assert!(store.agent_bucket[494..500].iter().all(|bucket| *bucket == NONE));
    assert_eq!(animation(500, 0).failure[KernelId::Cull as usize], u32::MAX);
}

#[test]
fn nothing_that_is_read_later_holds_a_nan_and_rotations_have_unit_length() {
    for seed in 0..8 {
        let store = ran(800, seed);
        let slots = visible_agents(&store.visible).len();
        assert!(slots > 50);
        for pose in store.local_rotations[..slots * POSE_STRIDE].chunks(POSE_STRIDE) {
            for q in &pose[..JOINT_COUNT] {
                assert!((Quat::from_array(*q).length() - 1.0).abs() < 1e-6, "{q:?}, seed {seed}");
            }
            assert!(Vec4::from_array(pose[JOINT_COUNT]).is_finite());
        }
        for (slot, palette) in store.palettes.chunks_exact(PALETTE_STRIDE).take(slots).enumerate() {
            let agent = store.visible[slot] as usize;
            let eyed = has_eyes(&store, agent);
            let written = if eyed { SKIN_JOINTS } else { LEFT_EYE } * 3;
            assert!(palette[..written].iter().all(|row| Vec4::from_array(*row).is_finite()));
            assert!(palette[written..].iter().flatten().all(|number| number.is_nan()));
        }
        assert!(
            store.local_rotations[slots * POSE_STRIDE..].iter().all(|q| q[0].is_nan()),
            "wrote past the end"
        );
    }
}

/// One agent of avatar 0 before the camera, standing aside, without gaze, as its clip.
fn one_agent() -> Store {
    let mut store = on_the_ground(animation(1, 0));
    store.frame.individuals = 0.0;
    store.position[0] = [1.0, 3.0];
    store.heading[0] = 0.4;
    store.stance[0] =
        Stance { phase: store.stance[0].phase, walk_weight: 1.0, stride: TRAVEL, ..Stance::default() };
    store.appearance[0] = Appearance::new(0, 0, false, 1.0, [0; 4]);
    store.gaits[0] = [0, 1, 2, 0];
    store.gait_weights[0] = [1.0, 0.0, 0.0, 0.0];
    store
}

fn clip_rotation(store: &Store, clip: usize, frame: usize, joint: usize) -> Quat {
    Quat::from_array(store.clip_frames[clip * CLIP_STRIDE + frame * POSE_STRIDE + joint])
}

fn pose_rotation(store: &Store, joint: usize) -> Quat {
    Quat::from_array(store.local_rotations[joint])
}

#[test]
fn a_whole_frame_of_one_gait_is_that_frame_and_half_way_lies_between() {
    for frame in 0..CLIP_FRAMES {
        let mut store = one_agent();
        let start = u32::try_from(frame).unwrap() << 26;
        store.stance[0].phase = start;
        run(&mut store);
        for joint in 0..JOINT_COUNT {
            let want = clip_rotation(&store, 0, frame, joint);
            assert!(pose_rotation(&store, joint).dot(want).abs() > 1.0 - 1e-6, "frame {frame} joint {joint}");
        }
        store.stance[0].phase = start + (1 << 25);
        run(&mut store);
        for joint in 0..JOINT_COUNT {
            let a = clip_rotation(&store, 0, frame, joint);
            let b = clip_rotation(&store, 0, (frame + 1) % CLIP_FRAMES, joint);
            let want = a.slerp(b, 0.5); // glam takes the shorter way
            assert!(
                pose_rotation(&store, joint).dot(want).abs() > 1.0 - 1e-6,
                "frame {frame}.5 joint {joint}"
            );
        }
        let root =
            |f: usize| Vec4::from_array(store.clip_frames[f % CLIP_FRAMES * POSE_STRIDE + JOINT_COUNT]);
        let middle = (root(frame) + root(frame + 1)) * 0.5;
        let drawn = Vec4::from_array(store.local_rotations[JOINT_COUNT]);
        assert!(
            drawn.truncate().abs_diff_eq(middle.truncate(), 1e-6) && drawn.w.to_bits() == 1.0_f32.to_bits()
        );
    }
}

#[test]
fn each_impossible_input_alone_is_enough_to_refuse_an_agent() {
    let mut store = one_agent();
    run(&mut store);
    assert_eq!(visible_agents(&store.visible), [0]);
    let faults: [fn(&mut Store); 14] = [
        |s| s.position[0][0] = f32::NAN,
        |s| s.position[0][1] = f32::INFINITY,
        |s| s.heading[0] = f32::NAN,
        |s| s.heading[0] = 1e9,
        |s| s.stance[0].walk_weight = f32::NEG_INFINITY,
        |s| s.stance[0].stride = f32::NAN,
        |s| s.appearance[0].traits = 2, // avatars are 0 and 1
        |s| s.appearance[0].scale = f32::NAN,
        |s| s.appearance[0].scale = 0.0,
        |s| s.appearance[0].scale = -1.0,
        |s| s.gait_weights[0][3] = -0.1,
        |s| s.gait_weights[0][1] = f32::NAN,
        |s| s.gaits[0][0] = s.frame.clip_count,
        |s| s.frame.clip_count = 0,
    ];
    for (number, fault) in faults.into_iter().enumerate() {
        let mut store = one_agent();
        fault(&mut store);
        run(&mut store);
        assert!(visible_agents(&store.visible).is_empty(), "fault {number}");
        assert_eq!(store.failure[KernelId::Cull as usize], 0, "fault {number}");
    }
}

#[test]
fn without_walk_or_without_weights_an_agent_stands_in_the_emotion_it_shows() {
    for (walk, weights) in [(0.0, [1.0, 0.0, 0.0, 0.0]), (1.0, [0.0; 4])] {
        for emotion in [0, 1, 2, 3] {
            let mut store = one_agent();
            store.stance[0].walk_weight = walk;
            store.gait_weights[0] = weights;
            store.appearance[0].set_emotion(emotion);
            run_clips_only(&mut store);
            let phase = weight_phase(0, emotion as usize, store.frame.gaze_time);
            let feet = stance_of(0);
            let clip = GAITS + (emotion * STANCES + feet) as usize;
            let (frame, way) = ((phase >> 26) as usize, unit_f32(phase << 6));
            for joint in 0..JOINT_COUNT {
                let [a, b] = [frame, (frame + 1) % CLIP_FRAMES];
                let a = clip_rotation(&store, clip, a, joint);
                let want = a.slerp(clip_rotation(&store, clip, b, joint), way);
                assert!(pose_rotation(&store, joint).dot(want).abs() > 1.0 - 1e-6, "{emotion} {joint}");
            }
        }
    }
}

#[test]
fn the_blend_depends_neither_on_the_signs_of_quaternions_nor_on_the_sum_of_the_weights() {
    let mut store = one_agent();
    store.gait_weights[0] = [0.2, 0.5, 0.3, 0.0];
    store.stance[0].walk_weight = 0.7;
    run(&mut store);
    let first = store.local_rotations.clone();
    store.gait_weights[0] = [0.4, 1.0, 0.6, 0.0];
    for (element, q) in store.clip_frames.iter_mut().enumerate() {
        if element % POSE_STRIDE < JOINT_COUNT && element % 3 == 0 {
            *q = q.map(|c| -c);
        }
    }
    run(&mut store);
    for (joint, before) in first[..JOINT_COUNT].iter().enumerate() {
        assert!(pose_rotation(&store, joint).dot(Quat::from_array(*before)).abs() > 1.0 - 1e-6);
    }
    // between two gaits, the one that weighs more is nearer
    let near = |store: &Store, clip: usize| {
        let frame = (store.stance[0].phase >> 26) as usize;
        let dots = (4..10).map(|j| pose_rotation(store, j).dot(clip_rotation(store, clip, frame, j)).abs());
        dots.sum::<f32>()
    };
    store.stance[0].walk_weight = 1.0;
    store.gait_weights[0] = [0.9, 0.1, 0.0, 0.0];
    run(&mut store);
    assert!(near(&store, 0) > near(&store, 1));
}

#[test]
fn palettes_are_world_from_joint_times_joint_from_mesh() {
    for seed in [0, 2, 5] {
        let store = ran(600, seed);
        let avatars: Vec<Avatar> = (0..AVATARS).map(|number| avatar(number, seed)).collect();
        for (slot, agent) in visible_agents(&store.visible).iter().enumerate() {
            let avatar = &avatars[avatar_of(&store, *agent as usize)];
            for (joint, want) in Built::new(&store, slot, avatar).world_from_mesh().into_iter().enumerate() {
                for row in 0..3 {
                    let got = Vec4::from_array(store.palettes[slot * PALETTE_STRIDE + joint * 3 + row]);
                    let error = (got - want.row(row)).abs().max_element();
                    // of the distance from the origin that the number stands for; the bend of steep toes loses digits
                    let size = want.row(row).w.abs().max(1.0);
                    let tolerance = if joint < JOINT_COUNT { 1e-5 } else { 4e-5 };
                    assert!(error < tolerance * size, "joint {joint} row {row}: {got} not {}", want.row(row));
                }
            }
        }
    }
}

/// How far the expression of the agent in a slot moves a vertex, m, and how it changes its normal.
fn moved(store: &Store, packed: &[[f32; 4]], slot: usize) -> [Vec3; 2] {
    let Some(number) = (packed[0][3].to_bits() >> MATERIAL_BITS).checked_sub(1) else {
        return [Vec3::ZERO; 2];
    };
    let moves: [Vec3; FACE_STRIDE] = std::array::from_fn(|shape| {
        Vec4::from(store.face_moves[number as usize * FACE_STRIDE + shape]).truncate()
    });
    let face = store.expressions[slot];
    let [up, down] = [face.mouth_corner.max(0.0), (-face.mouth_corner).max(0.0)];
    let [open, pressed] = [face.mouth_open.max(0.0), (-face.mouth_open).max(0.0)];
    let numbers = [face.inner_brow, face.outer_brow, up, down, open, pressed, face.fist, 0.0, face.blink];
    let normal = moves[FIST_NORMAL];
    [moves.into_iter().zip(numbers).map(|(way, number)| way * number).sum(), normal * face.fist]
}

/// Position and normal of a skinned vertex: the normal is a point of an octahedron, laid flat.
fn unpacked([x, y, z, normal]: [u32; 4]) -> (Vec3, Vec3) {
    let [x, y, z] = [x, y, z].map(f32::from_bits);
    let units = [normal & 0xffff, normal >> 16];
    let [across, along] = units.map(|units| (units as f32 - 32768.0) / 32767.0);
    let up = 1.0 - across.abs() - along.abs();
    let flat = Vec3::new(across, up, along);
    let below = Vec3::new((1.0 - along.abs()).copysign(across), up, (1.0 - across.abs()).copysign(along));
    (Vec3::new(x, y, z), if up < 0.0 { below } else { flat }.normalize())
}

#[test]
fn skinned_vertices_are_the_weighted_sum_of_their_joints_and_stand_where_the_rule_says() {
    let store = ran(900, 0);
    let avatars: Vec<Avatar> = (0..AVATARS).map(|number| avatar(number, 0)).collect();
    let mut first = 0;
    for (number, avatar) in avatars.iter().enumerate() {
        let bucket = number * store.frame.level_count as usize;
        let mesh = &avatar.levels[0];
        assert!(store.bucket_start[bucket + 1] > store.bucket_start[bucket]);
        for slot in store.bucket_start[bucket]..store.bucket_start[bucket + 1] {
            let world = Built::new(&store, slot as usize, avatar).world_from_mesh();
            let source = store.mesh_table[bucket].first_vertex as usize * VERTEX_STRIDE;
            let packed = store.mesh_vertices[source..].chunks_exact(VERTEX_STRIDE);
            for (vertex, packed) in mesh.vertices.iter().zip(packed) {
                let [way, turn] = moved(&store, packed, slot as usize);
                let (rest, own_normal) = (vertex.position + way, vertex.normal + turn);
                let mut at = Vec3::ZERO;
                let mut normal = Vec3::ZERO;
                let joints = packed[1][3].to_bits().to_le_bytes();
                for (joint, weight) in joints.into_iter().zip(packed[2]) {
                    let m = world[usize::from(joint)];
                    at += m.transform_point3(rest) * weight;
                    normal += m.transform_vector3(own_normal) * weight;
                }
                let (place, direction) = unpacked(store.skinned[first]);
                assert!(place.abs_diff_eq(at, 1e-4), "{place} not {at}");
                if normal.length() > 0.05 {
                    let want = normal.normalize();
                    assert!(direction.abs_diff_eq(want, 1e-3), "{direction} not {want}");
                }
                first += 1;
            }
        }
    }
    assert!(store.skinned[first..].iter().all(|vertex| *vertex == [0xdead_beef; 4]), "wrote past the end");
}

#[test]
fn a_bent_elbow_moves_each_vertex_by_its_weights() {
    let mut store = one_agent();
    let body = avatar(0, 0);
    let elbow = body.joints[Joint::LeftElbow as usize].joint_from_mesh.inverse().w_axis.truncate();
    let [upper, lower] = [Joint::LeftShoulder, Joint::LeftElbow].map(|joint| joint as u8);
    // along the lower arm: on the upper arm alone, shared, on the lower arm alone
    for (number, share) in [0.0, 0.5, 1.0_f32].into_iter().enumerate() {
        let vertex = Vertex {
            position: elbow + Vec3::X * 0.1,
            normal: Vec3::Y,
            color: Vec3::ONE,
            alpha: 1.0,
            material: Material::Skin,
            joints: [upper, lower, 0, 0],
            weights: [1.0 - share, share, 0.0, 0.0],
        };
        store.mesh_vertices[number * VERTEX_STRIDE..][..VERTEX_STRIDE]
            .copy_from_slice(&vertex_elements(&vertex));
    }
    // arms spread, the left lower arm bent forward by a right angle
    for frame in store.clip_frames[..CLIP_STRIDE].chunks_mut(POSE_STRIDE) {
        for q in &mut frame[..JOINT_COUNT] {
            *q = Quat::IDENTITY.to_array();
        }
        frame[Joint::LeftElbow as usize] = Quat::from_rotation_y(-std::f32::consts::FRAC_PI_2).to_array();
        frame[JOINT_COUNT] = body.joints[0].translation.extend(0.0).to_array();
    }
    run(&mut store);
    let world = Built::new(&store, 0, &body).world_from_model();
    let at = |n: usize| unpacked(store.skinned[n]).0;
    let straight = world.transform_point3(elbow + Vec3::X * 0.1);
    let bent = world.transform_point3(elbow + Vec3::Z * 0.1);
    assert!(at(0).abs_diff_eq(straight, 1e-5), "{} not {straight}", at(0));
    assert!(at(2).abs_diff_eq(bent, 1e-5), "{} not {bent}", at(2));
    assert!(at(1).abs_diff_eq((straight + bent) * 0.5, 1e-5));
}

/// The same on a device. Without one: skipped, unless `GAITWAY_REQUIRE_GPU=1`.
#[cfg(feature = "vulkan")]
mod device {
    use super::*;
    use crate::common::gpu;
    use gaitway::verify::compare_dispatches;

    #[test]
    fn every_animation_kernel_agrees_with_its_twin() {
        let Some(device) = gpu::device() else { return };
        println!("{}, arithmetic {}", device.describe(), device.arithmetic().unwrap());
        for agents in [0, 1, 63, 64, 65, 1000] {
            for seed in 0..8 {
                let store = on_the_ground(animation(agents, seed));
                for found in compare_dispatches(&device, &store, &dispatches(&store)).unwrap() {
                    assert!(found.exact == found.compared, "{agents} agents, seed {seed}: {found:?}");
                }
            }
        }
        gpu::assert_silent();
    }
}
