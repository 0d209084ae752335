//! A body of a physique, by glam: what kernel `palette` is held against. Nothing here is shared with it.
#![allow(clippy::cast_possible_truncation, reason = "angles as f32")]

use gaitway::avatar::Avatar;
use gaitway::gait::{JOINT_COUNT, Joint};
use gaitway::kernels::Store;
use gaitway::kernels::layout::Physique;
use gaitway::kernels::shared::body::index::{
    LEFT_EYE, LEFT_FOOT, POSE_STRIDE, RIG_BALLS, RIG_STRIDE, RIGHT_FOOT, WAIST,
};
use glam::{Mat3, Mat4, Quat, Vec3, Vec4};

/// How far the back is behind the joint of the waist, m.
const BACK: Vec3 = Vec3::new(0.0, 0.0, -0.06);

/// The agent of a slot, and what it is built like.
pub(crate) struct Built<'a> {
    store: &'a Store,
    slot: usize,
    avatar: &'a Avatar,
    physique: Physique,
}

impl<'a> Built<'a> {
    pub(crate) fn new(store: &'a Store, slot: usize, avatar: &'a Avatar) -> Self {
        let physique = store.physique[store.visible[slot] as usize];
        Self { store, slot, avatar, physique }
    }

    fn agent(&self) -> usize {
        self.store.visible[self.slot] as usize
    }

    fn scale(&self) -> f32 {
        self.store.appearance[self.agent()].scale
    }

    pub(crate) fn head_size(&self) -> f32 {
        Physique::ratios_in(self.physique.head_and_shoulders)[0]
    }

    fn place(&self, joint: usize) -> Vec3 {
        self.avatar.joints[joint].joint_from_mesh.inverse().transform_point3(Vec3::ZERO)
    }

    /// How the part of the body at a joint is stretched in the mesh.
    fn stretch(&self, joint: usize) -> Mat3 {
        let own = &self.physique;
        let [trunk, arms] = Physique::ratios_in(own.trunk_and_arms);
        let across = |pair| {
            let [breadth, depth] = Physique::ratios_in(pair);
            Mat3::from_diagonal(Vec3::new(breadth, trunk, depth))
        };
        let [neck, hands] = Physique::ratios_in(own.neck_and_hands);
        let [upper_arm, forearm] = Physique::ratios_in(own.arms);
        let [thigh, calf] = Physique::ratios_in(own.legs);
        let limb = |girth: f32, length: f32, end: Joint| {
            let bone = (self.place(end as usize) - self.place(joint)).normalize();
            let along = Mat3::from_cols(bone * bone.x, bone * bone.y, bone * bone.z);
            Mat3::from_diagonal(Vec3::splat(girth)) + along * (length - girth)
        };
        if joint == WAIST {
            return across(own.waist);
        }
        match Joint::ALL[joint] {
            Joint::Root => across(own.hips),
            Joint::Spine => across(own.chest),
            Joint::Neck => Mat3::from_diagonal(Vec3::new(neck, trunk, neck)),
            Joint::Head => Mat3::from_diagonal(Vec3::splat(self.head_size())),
            Joint::LeftShoulder => limb(upper_arm, arms, Joint::LeftElbow),
            Joint::RightShoulder => limb(upper_arm, arms, Joint::RightElbow),
            Joint::LeftElbow => limb(forearm, arms, Joint::LeftHand),
            Joint::RightElbow => limb(forearm, arms, Joint::RightHand),
            Joint::LeftHand | Joint::RightHand => Mat3::from_diagonal(Vec3::splat(hands)),
            Joint::LeftHip => limb(thigh, 1.0, Joint::LeftKnee),
            Joint::RightHip => limb(thigh, 1.0, Joint::RightKnee),
            Joint::LeftKnee => limb(calf, 1.0, Joint::LeftFoot),
            Joint::RightKnee => limb(calf, 1.0, Joint::RightFoot),
            Joint::LeftFoot | Joint::RightFoot => Mat3::IDENTITY,
        }
    }

    /// How much longer the way to a joint is.
    fn longer(&self, joint: usize) -> f32 {
        let [trunk, arms] = Physique::ratios_in(self.physique.trunk_and_arms);
        match Joint::ALL[joint] {
            Joint::LeftElbow | Joint::RightElbow | Joint::LeftHand | Joint::RightHand => arms,
            Joint::Root | Joint::Spine | Joint::Neck | Joint::Head => trunk,
            Joint::LeftShoulder | Joint::RightShoulder => trunk,
            _ => 1.0,
        }
    }

    /// From the model's space, in which gaits are, to the world.
    pub(crate) fn world_from_model(&self) -> Mat4 {
        let [x, z] = self.store.position[self.agent()];
        Mat4::from_scale_rotation_translation(
            Vec3::splat(self.scale()),
            Quat::from_rotation_y(self.store.heading[self.agent()]),
            Vec3::new(x, 0.0, z),
        )
    }

    /// Of every joint: where it is and how it is turned, in the world; the agent's scale included.
    pub(crate) fn joints(&self) -> [Mat4; JOINT_COUNT] {
        let pose = &self.store.local_rotations[self.slot * POSE_STRIDE..][..POSE_STRIDE];
        let world = self.world_from_model();
        let [_, shoulders] = Physique::ratios_in(self.physique.head_and_shoulders);
        let mut joints = [world; JOINT_COUNT];
        for joint in 0..JOINT_COUNT {
            let turn = Mat4::from_quat(Quat::from_array(pose[joint]));
            if joint == 0 {
                joints[0] =
                    world * Mat4::from_translation(Vec4::from_array(pose[JOINT_COUNT]).truncate()) * turn;
                continue;
            }
            let parent = Joint::PARENT[joint];
            let mut way = self.avatar.joints[joint].translation * self.longer(joint);
            if [Joint::LeftShoulder as usize, Joint::RightShoulder as usize].contains(&joint) {
                // shoulders are apart by as much as they are, whatever the trunk's length
                let aside = Vec3::X * (self.place(joint) - self.place(parent)).x;
                let in_parent = self.avatar.joints[parent].joint_from_mesh.transform_vector3(aside);
                way += in_parent * (shoulders - self.longer(joint));
            }
            joints[joint] = joints[parent] * Mat4::from_translation(way) * turn;
        }
        joints
    }

    /// World-from-mesh of the joints, of the toes, which follow from the feet, and of the waist.
    pub(crate) fn world_from_mesh(&self) -> [Mat4; LEFT_EYE] {
        let joints = self.joints();
        let of = |joint: usize| {
            let middle = self.place(joint);
            let stretch = Mat4::from_translation(middle)
                * Mat4::from_mat3(self.stretch(joint))
                * Mat4::from_translation(-middle);
            joints[joint] * self.avatar.joints[joint].joint_from_mesh * stretch
        };
        let waist = || {
            let half = |joint: Joint| {
                (joints[joint as usize] * self.avatar.joints[joint as usize].joint_from_mesh) * 0.5
            };
            let mut turned = half(Joint::Root) + half(Joint::Spine);
            let (joint, at) =
                (self.place(Joint::Spine as usize), joints[Joint::Spine as usize].w_axis.truncate());
            turned.w_axis = (at - turned.transform_vector3(joint)).extend(1.0);
            let middle = joint + BACK;
            turned
                * Mat4::from_translation(middle)
                * Mat4::from_mat3(self.stretch(WAIST))
                * Mat4::from_translation(-middle)
        };
        std::array::from_fn(|joint| match joint.checked_sub(JOINT_COUNT) {
            None => of(joint),
            Some(2) => waist(),
            Some(side) => self.toes(of([LEFT_FOOT, RIGHT_FOOT][side]), side),
        })
    }

    fn toes(&self, foot: Mat4, side: usize) -> Mat4 {
        let number = self.store.appearance[self.agent()].avatar() as usize;
        let rig = Vec4::from_array(self.store.rig[number * RIG_STRIDE + RIG_BALLS + side]);
        let (ball, length) = (rig.truncate(), rig.w);
        let down = f64::from(-foot.transform_vector3(Vec3::Z).y / self.scale()).clamp(0.0, 0.95).asin();
        let to_ground = f64::from(0.5 * foot.transform_point3(ball).y / (length.max(0.001) * self.scale()))
            .clamp(0.0, 1.0)
            .asin();
        let bend = Mat4::from_rotation_x((to_ground.min(down) - down) as f32);
        foot * Mat4::from_translation(ball) * bend * Mat4::from_translation(-ball)
    }
}
