//! Inputs for `cull`, `compact`, `pose`, `gaze`, `palette`, `eyes` and `skin`: a crowd of two avatars about the user.
//!
//! Hard by design: agents behind the camera, at it and on top of the user, the user straight above, weights of zero,
//! walking and standing, clip ids that lead nowhere behind a weight of zero, quaternions of either sign, inputs that
//! are not numbers, and NaN in everything that must not be read.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "small made-up numbers, written in the buffers' types"
)]

use super::avatars::{Dice, avatar, clip, clip_elements, rig_elements, vertex_elements};
use super::case::{filled, nan};
use crate::avatar::foot::{footprints, with_toes};
use crate::avatar::waist::with_waist;
use crate::avatar::{Avatar, ClipFrame, LEVELS};
use crate::emotion::Emotion;
use crate::kernels::gaze_schedule::index::COUNTS;
use crate::kernels::layout::{
    Appearance, Attention, ClipPosture, FrameUniforms, GazeState, MeshRange, Physique, Stance,
};
use crate::kernels::shared::attention::{ENGAGED, VALID};
use crate::kernels::shared::body::index::{PALETTE_STRIDE, POSE_STRIDE, VERTEX_STRIDE};
use crate::kernels::shared::ranks::index::COLUMNS;
use crate::kernels::shared::scan::index::LANES;
use crate::kernels::shared::standing::index::STANCES;
use crate::kernels::{Dispatch, KernelId, Store};
use crate::reference::body::far_slot;
use crate::reference::exact::{hash_u32, unit_f32};
use crate::sim::bodies::number_face;
use glam::Vec3;

/// Avatars of the made-up crowd.
pub const AVATARS: usize = 2;
/// Gaits per avatar.
pub const GAITS: usize = 3;
/// How far a stride of the gaits goes, m.
pub const TRAVEL: f32 = 1.2;
/// Clips per avatar: its gaits, then its standing clips.
pub const CLIPS: usize = GAITS + 4 * STANCES;
/// Elements behind the last agent that hold NaN.
const SPARE: usize = 5;
/// Index of the frame that the made-up memories of the gaze refer to.
const FRAME_INDEX: u32 = 1000;
/// Its time for even seeds, ms. Odd ones have any.
const GAZE_TIME: u32 = 20_000;

/// Frustum planes of an eye at `eye` that looks towards +z, 50 degrees to each side, without a far end.
fn planes(eye: Vec3) -> [[f32; 4]; 6] {
    let (sine, cosine) = libm::sincosf(50.0_f32.to_radians());
    let plane = |normal: Vec3| normal.extend(-normal.dot(eye)).to_array();
    [
        plane(Vec3::new(cosine, 0.0, sine)),
        plane(Vec3::new(-cosine, 0.0, sine)),
        plane(Vec3::new(0.0, cosine, sine)),
        plane(Vec3::new(0.0, -cosine, sine)),
        Vec3::Z.extend(-(eye.z + 0.05)).to_array(),
        [0.0, 0.0, 0.0, 1.0],
    ]
}

/// Every buffer that the animation kernels touch, for `agents` agents.
///
/// Seeds differ in kind, not only in numbers: odd ones have less room than there are visible agents, those with bit 1
/// set gaze in `paper` mode, those with bit 2 set have one eye and one level of detail; in odd ones agents
/// take turns in looking at the user; those one more than a multiple of three have far bodies. Agents are individuals to
/// a part where the seed is one more than a multiple of four, and not at all where it is two more. Faces move by half, and farther than
/// at most, in some.
pub fn animation(agents: usize, seed: u32) -> Store {
    let mut dice = Dice::of(hash_u32(seed ^ 0x5eed));
    let levels = if seed & 4 == 0 { LEVELS } else { 1 };
    let is_tight = seed & 1 == 1;
    let user_eyes = Vec3::new(0.3, 1.66, 0.2);
    let visible_capacity = if is_tight { agents / 3 + 1 } else { agents + 3 };
    let near_capacity = if is_tight { agents / 12 + 1 } else { agents + 1 };
    let mut all_planes = [[0.0; 4]; 12];
    all_planes[..6].copy_from_slice(&planes(user_eyes - Vec3::X * 0.032));
    all_planes[6..].copy_from_slice(&planes(user_eyes + Vec3::X * 0.032));
    let mut store = Store {
        frame: FrameUniforms {
            planes: all_planes,
            user_eyes: user_eyes.extend(0.0).to_array(),
            camera: user_eyes.extend(if seed % 3 == 1 && seed & 4 == 0 { 17.0 } else { 0.0 }).to_array(),
            level_distance: [4.0, 9.0, 25.0, if seed % 3 == 1 { 12.0 } else { 0.0 }],
            standing_clips: [[GAITS as u32, (GAITS + CLIPS) as u32, 0, 0], [0; 4], [0; 4], [0; 4]],
            agent_count: agents as u32,
            eye_count: if seed & 4 == 0 { 2 } else { 1 },
            level_count: levels as u32,
            bucket_count: (AVATARS * levels) as u32,
            visible_capacity: visible_capacity as u32,
            near_capacity: near_capacity as u32,
            frame_index: FRAME_INDEX,
            gaze_mode: seed >> 1 & 1,
            frame_time: 1.0 / dice.between(24.0, 144.0),
            agent_height: 1.95,
            agent_radius: 0.6,
            clip_count: (AVATARS * CLIPS) as u32,
            gaze_limit: [0, agents as u32 / 12 + 2, 0, 4, 3, 2, agents as u32 / 6 + 2, 4][seed as usize % 8],
            gaze_time: if is_tight { hash_u32(seed) } else { GAZE_TIME },
            turn_least: 1000,
            turn_most: 4000,
            individuals: [1.0, 0.4, 0.0, 1.0][seed as usize % 4],
            expression: [1.0, 0.5, 1.5, 0.0][seed as usize / 2 % 4],
            ..FrameUniforms::default()
        },
        ..Store::default()
    };
    let avatars: Vec<Avatar> = (0..AVATARS).map(|number| avatar(number, seed)).collect();
    let mut first_index = 0;
    for avatar in &avatars {
        store.rig.extend(rig_elements(avatar));
        for number in 0..CLIPS {
            let swing = if number >= GAITS { 0.1 } else { dice.between(0.5, 1.0) };
            let travel = if number >= GAITS { 0.0 } else { TRAVEL };
            let mut frames = clip(avatar, &mut dice, swing);
            frames.push(ClipFrame::mean(&frames));
            store.clip_frames.extend(frames.iter().flat_map(|frame| clip_elements(frame, travel)));
        }
        for (level, mesh) in avatar.levels[..levels].iter().enumerate() {
            let first_vertex = store.mesh_vertices.len() / VERTEX_STRIDE;
            let (indices, vertices) = (mesh.indices.len() as u32, mesh.vertices.len() as u32);
            store.mesh_table.push(MeshRange {
                first_index,
                index_count: indices,
                first_vertex: first_vertex as u32,
                vertex_count: vertices,
            });
            first_index += indices;
            let toed = mesh.vertices.iter().map(|vertex| with_waist(with_toes(*vertex, &footprints(avatar))));
            let mut elements: Vec<_> = toed.flat_map(|vertex| vertex_elements(&vertex)).collect();
            if level == 0 {
                number_face(&mut elements, &avatar.face, &mut store.face_moves);
            }
            store.mesh_vertices.extend(elements);
        }
    }
    for avatar in 0..2 * AVATARS {
        // far bodies: any mesh will do
        store.mesh_table.push(MeshRange {
            first_index,
            index_count: 6,
            first_vertex: avatar as u32,
            vertex_count: 4,
        });
    }
    for _ in 0..AVATARS * CLIPS {
        let [lean, nod, spread, swing] = [0; 4].map(|_| dice.between(-0.5, 0.5));
        store.clip_postures.push(ClipPosture { lean, nod, spread, swing });
    }
    for agent in 0..agents {
        push_agent(&mut store, &mut dice, agent, user_eyes);
    }
    for (agent, hard) in HARD.iter().enumerate().take(agents) {
        make_hard(&mut store, agent + (agents - HARD.len().min(agents)), *hard, user_eyes);
    }
    add_spare_and_outputs(&mut store, agents, visible_capacity, near_capacity);
    store
}

fn push_agent(store: &mut Store, dice: &mut Dice, agent: usize, user_eyes: Vec3) {
    let avatar = dice.below(AVATARS as u32);
    // the farther half of the crowd is sparse, so that every level of detail has its share
    let (angle, away) = (dice.between(-3.1, 3.1), dice.between(0.3, 5.3));
    let away = away * away;
    store.position.push([user_eyes.x + away * libm::sinf(angle), user_eyes.z + away * libm::cosf(angle)]);
    let walk = [0.0, 1.0, dice.between(0.0, 1.0)][dice.below(3) as usize];
    store.elevation.push(if agent.is_multiple_of(3) {
        unit_f32(hash_u32(agent as u32)) * 6.0 - 2.0
    } else {
        0.0
    });
    // strides as long as those of the gaits, or of every length from none on
    let stride = [TRAVEL, 1.6 * TRAVEL * unit_f32(hash_u32(agent as u32 ^ 0x57e9))]
        [usize::from(!agent.is_multiple_of(4))];
    // feet where the gait has them, or off to any side
    let mut off = |most: f32| if agent.is_multiple_of(3) { 0.0 } else { dice.between(-most, most) };
    let mut both = |most: f32| [off(most), off(most)];
    let (left, right, turns, lean) = (both(0.5), both(0.5), both(1.0), both(0.1));
    let (heights, slopes, [foresight, _]) = (both(0.3), both(0.2), both(0.5));
    let heading = dice.between(-3.1, 3.1);
    store.heading.push(heading);
    store.stance.push(Stance {
        phase: dice.bits(),
        walk_weight: walk,
        left,
        right,
        turns,
        lean,
        heights,
        slopes,
        stride,
        foresight,
    });
    let (emotion, gazes) = (dice.below(4), dice.below(8) > 0);
    let scale = dice.between(0.9, 1.1);
    let mut looks = Appearance {
        skin_and_hair: dice.bits(),
        top_and_bottom: dice.bits(),
        ..Appearance::new(avatar, emotion, gazes, scale, [0; 4])
    };
    // Every fifth agent has its avatar's build. The others have ratios at random.
    let mut build = Dice::of(hash_u32(agent as u32 ^ 0xb111d));
    let mut ratio = || if agent.is_multiple_of(5) { 1.0 } else { build.between(0.7, 1.4) };
    looks.set_size(ratio(), ratio());
    store.appearance.push(looks);
    let mut pair = || Physique::word([ratio(), ratio()]);
    store.physique.push(Physique {
        trunk_and_arms: pair(),
        head_and_shoulders: pair(),
        chest: pair(),
        waist: pair(),
        hips: pair(),
        neck_and_hands: pair(),
        arms: pair(),
        legs: pair(),
    });
    let mut weights = [0; 4].map(|_| dice.between(0.0, 1.0));
    for weight in &mut weights[(agent % 4 + 1).min(4)..] {
        *weight = 0.0;
    }
    if agent % 8 == 7 {
        // one gait alone, in whichever place
        weights = std::array::from_fn(|place| if place == agent / 8 % 4 { 0.7 } else { 0.0 });
    }
    store.gait_weights.push(weights);
    store.gaits.push(weights.map(|weight| {
        let clip = avatar * CLIPS as u32 + dice.below(GAITS as u32);
        if weight > 0.0 { clip } else { dice.bits() } // a weight of zero hides any id
    }));
    let (flexion, rotation) = (dice.between(-0.7, 0.7), dice.between(-1.2, 1.2));
    let [flexion_rate, rotation_rate] = [0; 2].map(|_| dice.between(-3.0, 3.0));
    store.gaze_state.push(GazeState { flexion, rotation, flexion_rate, rotation_rate });
    store.gaze_frame.push(match dice.below(5) {
        0 => 0,
        1 => (FRAME_INDEX - 2) | VALID | ENGAGED,
        2 => FRAME_INDEX | VALID | ENGAGED,
        3 => (FRAME_INDEX - 1) | VALID,
        _ => (FRAME_INDEX - 1) | VALID | ENGAGED,
    });
    let now = store.frame.gaze_time;
    let [until, key_and_frame] = match dice.below(5) {
        0 => [0; 2],                                                      // never had a turn
        1 => [now.wrapping_sub(500 + dice.below(3000)), FRAME_INDEX - 1], // rests, or has rested for long enough
        2 if agent.is_multiple_of(7) => [now.wrapping_sub(500_000 + dice.below(99_999)), FRAME_INDEX], // for ever
        2 => [now.wrapping_sub(3000 + dice.below(15_000)), FRAME_INDEX], // waits
        3 => [now.wrapping_add(1 + dice.below(3000)), FRAME_INDEX - 1],  // looks, if there are not too many
        _ => [now.wrapping_add(1 + dice.below(3000)), FRAME_INDEX - 2],  // was out of view meanwhile
    };
    store.attention.push(Attention { until, key_and_frame });
}

/// What the last agents are changed into.
#[derive(Debug, Clone, Copy)]
enum Hard {
    NotANumber,
    Infinite,
    NegativeWeight,
    NoSuchAvatar,
    NoSuchClip,
    NoSize,
    AtTheCamera,
    OnTheUser,
    UserAbove,
    ZeroWeights,
    PhaseAtTheEnd,
    StraightBehind,
    AtTheRange,
    Absent,
    Undrawn,
    TooDeep,
}

const HARD: [Hard; 16] = [
    Hard::Absent,
    Hard::Undrawn,
    Hard::TooDeep,
    Hard::AtTheRange,
    Hard::UserAbove,
    Hard::AtTheCamera,
    Hard::OnTheUser,
    Hard::ZeroWeights,
    Hard::PhaseAtTheEnd,
    Hard::StraightBehind,
    Hard::NotANumber,
    Hard::Infinite,
    Hard::NegativeWeight,
    Hard::NoSuchAvatar,
    Hard::NoSuchClip,
    Hard::NoSize,
];

fn make_hard(store: &mut Store, agent: usize, hard: Hard, user_eyes: Vec3) {
    let angry_gazer = Appearance::new(0, Emotion::Angry as u32, true, 1.0, [0; 4]).traits;
    match hard {
        Hard::NotANumber => store.position[agent][1] = f32::NAN,
        Hard::Infinite => store.heading[agent] = f32::INFINITY,
        Hard::NegativeWeight => store.gait_weights[agent][2] = -0.5,
        Hard::NoSuchAvatar => store.appearance[agent].set_avatar(0xff),
        Hard::NoSuchClip => {
            store.gait_weights[agent] = [1.0, 0.0, 0.0, 0.0];
            store.gaits[agent][0] = (AVATARS * CLIPS) as u32;
        }
        Hard::NoSize => store.appearance[agent].scale = 0.0,
        Hard::AtTheCamera => store.position[agent] = [user_eyes.x, user_eyes.z + 0.001],
        Hard::OnTheUser | Hard::UserAbove => {
            // the neck of avatar 0 stands 1 cm behind the origin
            store.position[agent] = [user_eyes.x, user_eyes.z + 0.01];
            store.appearance[agent].traits = angry_gazer;
            store.appearance[agent].scale = if matches!(hard, Hard::UserAbove) { 0.6 } else { 1.0 };
            let phase = store.stance[agent].phase;
            (store.heading[agent], store.stance[agent]) = (0.0, Stance { phase, ..Stance::default() });
        }
        Hard::Absent => store.position[agent] = [crate::ground::ABSENT; 2],
        Hard::Undrawn => store.appearance[agent].set_bodiless(true),
        Hard::TooDeep => store.elevation[agent] = -1e7,
        Hard::AtTheRange => {
            store.position[agent] = [user_eyes.x, user_eyes.z + 8.0];
            store.appearance[agent].traits = angry_gazer;
            let phase = store.stance[agent].phase;
            store.heading[agent] = std::f32::consts::PI;
            store.stance[agent] = Stance { phase, ..Stance::default() };
            (store.gaze_frame[agent], store.attention[agent]) = (0, Attention::default());
        }
        Hard::ZeroWeights => store.gait_weights[agent] = [0.0; 4],
        Hard::PhaseAtTheEnd => store.stance[agent].phase = u32::MAX,
        Hard::StraightBehind => {
            // faces away from the user, in front of the camera
            store.position[agent] = [user_eyes.x, user_eyes.z + 2.0];
            let phase = store.stance[agent].phase;
            store.heading[agent] = 0.0;
            store.stance[agent] = Stance { phase, walk_weight: 1.0, stride: TRAVEL, ..Stance::default() };
            store.appearance[agent].traits = angry_gazer;
        }
    }
}

/// NaN behind the last agent and in every output.
fn add_spare_and_outputs(store: &mut Store, agents: usize, visible_capacity: usize, near_capacity: usize) {
    const NAN: f32 = f32::NAN;
    const POISON: u32 = 0xdead_beef;
    for _ in 0..SPARE {
        store.position.push([NAN; 2]);
        store.elevation.push(NAN);
        store.heading.push(NAN);
        store.stance.push(nan());
        store.appearance.push(filled(POISON));
        store.physique.push(filled(POISON));
        store.gaits.push([POISON; 4]);
        store.gait_weights.push([NAN; 4]);
        store.gaze_state.push(nan());
        store.gaze_frame.push(POISON);
        store.attention.push(filled(POISON));
    }
    store.far_poses = vec![nan(); agents + SPARE];
    let buckets = store.mesh_table.len();
    let most_vertices = store.mesh_table.iter().map(|mesh| mesh.vertex_count as usize).max().unwrap_or(0);
    store.agent_bucket = vec![POISON; agents + SPARE];
    store.bucket_counts = vec![POISON; (agents.div_ceil(LANES) + 1) * COLUMNS];
    store.bucket_start = vec![POISON; buckets + 2];
    store.visible = vec![POISON; far_slot(visible_capacity) + agents];
    store.attention_counts = vec![0; COUNTS];
    store.draw_args = vec![POISON; 2 * buckets * 5];
    store.dispatch_args = vec![POISON; 3 + AVATARS * 3];
    store.failure = vec![u32::MAX; KernelId::ALL.len()];
    store.local_rotations = vec![[NAN; 4]; (visible_capacity + 1) * POSE_STRIDE];
    store.palettes = vec![[NAN; 4]; (visible_capacity + 1) * PALETTE_STRIDE];
    store.expressions = vec![nan(); visible_capacity + 1];
    store.skinned = vec![[POISON; 4]; near_capacity * most_vertices + 1];
}

/// The dispatches of the animation kernels for one frame, in order.
pub fn dispatches(store: &Store) -> Vec<Dispatch> {
    crate::sim::order::frame_dispatches(&store.frame)
}
