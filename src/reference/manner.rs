//! How each agent that walks differs from the person whose gait it has.

use super::body::{joint_translation, visible_agents};
use super::exact::{greater, sin_cos};
use super::quaternion::{
    add3, cross3, dot3, dot4, limit, quat_conjugate, quat_mul, quat_normalize, quat_rotate, scale3,
};
use super::standing::{moods_of, own_draw, walk_share};
use crate::kernels::manner::index::{ARM_JOINTS, LEFT_ARM};
use crate::kernels::manner::{
    ARM_AHEAD, ARM_LATE, ARM_OUT, ARM_SWING, ARMS_APART, ARMS_BALANCE, ARMS_FOLLOW, CIRCLE, DRAWS_OF_ARM,
    DRAWS_OF_TRUNK, ELBOW, ELBOW_SWING, FIELD, HALF_SUM, HEAD_FOLLOWS, HEAD_TILT, HEAD_TURN, LEAN,
    LEAST_SQUARE, NECK_FLEXION, NOD, OWN_WALK, SHOULDER_TURN, SIDE_LEAN, Slices, TRUNK_TURN, UNITS,
};
use crate::kernels::shared::body::index::{HEAD, JOINTS, NECK, POSE_STRIDE, SPINE};
use rayon::prelude::*;

/// In [-1, 1], most often near 0: the agent's own for good.
pub fn own_share(agent: u32, number: u32) -> f32 {
    let draw = own_draw(agent, OWN_WALK, number);
    let sum = (draw & FIELD) + ((draw >> 10) & FIELD) + ((draw >> 20) & FIELD);
    (sum as f32 - HALF_SUM) * (1.0 / HALF_SUM)
}

/// A small turn by angles about x, y and z; not normalised.
fn small_turn(angles: [f32; 3]) -> [f32; 4] {
    let [x, y, z] = scale3(angles, 0.5);
    [x, y, z, 1.0]
}

/// How much an agent differs now.
#[derive(Clone, Copy)]
struct Amount {
    agent: u32,
    /// Of what is held.
    held: f32,
    /// Of what swings, at the left foot's strike and a quarter of a stride after it.
    early: f32,
    late: f32,
    /// The sine of the phase.
    beat: f32,
}

impl Amount {
    /// Deviations of trunk and head, rad.
    fn trunk_and_face(self) -> [[f32; 3]; 2] {
        let Self { agent, held, early, beat, .. } = self;
        let lean = held * LEAN * own_share(agent, 0);
        let side = held * SIDE_LEAN * own_share(agent, 1);
        let turn = held * TRUNK_TURN * own_share(agent, 2) + early * SHOULDER_TURN * own_share(agent, 3);
        let nod = held * NECK_FLEXION * own_share(agent, 4) + 2.0 * early * beat * NOD * own_share(agent, 5);
        let trunk = [lean, turn, side];
        let aside = held * HEAD_TURN * own_share(agent, 6);
        let tilt = held * HEAD_TILT * own_share(agent, 7);
        [trunk, add3(scale3(trunk, HEAD_FOLLOWS), [nod, aside, tilt])]
    }

    /// New rotations of shoulder and elbow; `spine` is as it was and as it is now.
    fn arm(
        self,
        arm: usize,
        pose: &[[f32; 4]],
        [upper_in, fore_in]: [[f32; 3]; 2],
        [spine, new_spine]: [[f32; 4]; 2],
        [swing, lean, turn]: [f32; 3],
    ) -> [[f32; 4]; 2] {
        let Self { agent, held, early, late, .. } = self;
        let draws = DRAWS_OF_TRUNK + DRAWS_OF_ARM * arm as u32;
        let left = if arm == 0 { 1.0 } else { -1.0 };
        let shoulder = LEFT_ARM + ARM_JOINTS * arm;
        let upper = quat_mul(spine, pose[shoulder]);
        let lower = quat_mul(upper, pose[shoulder + 1]);
        let upper_arm = quat_rotate(upper, upper_in);
        let forearm = quat_rotate(lower, fore_in);
        let square = dot3(upper_arm, upper_arm) * dot3(forearm, forearm);
        let size = greater(square, LEAST_SQUARE).sqrt();
        let hinge = cross3(upper_arm, forearm).map(|part| part / size);
        let reach = add3(upper_arm, forearm);
        let [aside, ..] = reach;
        let outwards = limit(left * aside / greater(dot3(reach, reach), LEAST_SQUARE).sqrt(), 0.0, 1.0);
        let lag = ARM_LATE * late * own_share(agent, 8);
        let middle = held * ARM_AHEAD * own_share(agent, DRAWS_OF_TRUNK) - ARMS_BALANCE * lean;
        let apart = held * ARMS_APART * own_share(agent, DRAWS_OF_TRUNK + DRAWS_OF_ARM);
        let ahead = middle + left * apart - left * swing * (early * own_share(agent, draws + 1) + lag);
        let out = held * ARM_OUT * own_share(agent, draws + 2) * outwards;
        let bend = held * ELBOW * own_share(agent, draws + 3)
            - left * early * ELBOW_SWING * own_share(agent, draws + 4);
        let new_upper = quat_mul(small_turn([-ahead, ARMS_FOLLOW * turn, left * out]), upper);
        let new_lower = quat_mul(small_turn(scale3(hinge, bend)), lower);
        [
            quat_normalize(quat_mul(quat_conjugate(new_spine), new_upper)),
            quat_normalize(quat_mul(quat_conjugate(upper), new_lower)),
        ]
    }
}

/// Twin of `shaders/manner.wgsl`.
pub fn manner(b: Slices<'_>) {
    let Slices { frame, visible, stance, appearance, gait_weights, rig, local_rotations } = b;
    let slots = local_rotations.par_chunks_mut(POSE_STRIDE);
    visible_agents(visible).par_iter().zip(slots).for_each(|(number, pose)| {
        let (number, agent) = (*number, *number as usize);
        let weights = gait_weights[agent];
        let held = frame.individuals * walk_share(weights, stance[agent].walk_weight);
        if !(held > 0.0) {
            return;
        }
        let own = appearance[agent];
        let avatar = own.avatar() as usize;
        let [.., stride] = pose[JOINTS];
        let swung = held * limit(stride, 0.0, 1.0);
        let [sine, cosine] = sin_cos((stance[agent].phase >> 8) as f32 * (CIRCLE / UNITS));
        let amount = Amount { agent: number, held, early: swung * cosine, late: swung * sine, beat: sine };
        let [trunk, face] = amount.trunk_and_face();

        let pelvis = pose[0];
        let spine = quat_mul(pelvis, pose[SPINE]);
        let neck = quat_mul(spine, pose[NECK]);
        let head = quat_mul(neck, pose[HEAD]);
        let new_spine = quat_mul(small_turn(trunk), spine);
        let new_neck = quat_mul(small_turn(scale3(add3(trunk, face), 0.5)), neck);
        let new_head = quat_mul(small_turn(face), head);
        pose[SPINE] = quat_normalize(quat_mul(quat_conjugate(pelvis), new_spine));
        pose[NECK] = quat_normalize(quat_mul(quat_conjugate(new_spine), new_neck));
        pose[HEAD] = quat_normalize(quat_mul(quat_conjugate(new_neck), new_head));

        let swing = dot4(moods_of(weights, own.emotion()), ARM_SWING);
        let [lean, turn, _] = trunk;
        for arm in 0..2 {
            let shoulder = LEFT_ARM + ARM_JOINTS * arm;
            let bones = [1, 2].map(|next| joint_translation(rig, avatar, shoulder + next));
            let turned = amount.arm(arm, pose, bones, [spine, new_spine], [swing, lean, turn]);
            pose[shoulder..shoulder + 2].copy_from_slice(&turned);
        }
    });
}
