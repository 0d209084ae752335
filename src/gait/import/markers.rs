//! Joints from the markers of gait analysis: Plug-in Gait and its kin (such as CMU's 41), `OpenSim`'s and `OpenCap`'s sets.
//! Pelvis, knees and ankles must be there; what the markers above the pelvis do not tell is missing.
//!
//! Hip centres after Bell, Pedersen and Brand (1990), as shares of the distance between the front pelvis markers:
//! 0.36 outwards, 0.30 down, 0.19 back from their middle. Knee and ankle markers sit on the outside of the joint and
//! are moved inwards along the pelvis's own axis, across the bone, by half the joint's width; shoulder markers on
//! top of it are moved down the trunk (shares of lengths, ours, from an adult's widths). Elbow markers stay.

use super::joint_map::plain;
use crate::gait::{JOINT_COUNT, Joint, JointSet, Pose};
use glam::Vec3;

/// What must be there, for messages.
pub(super) const NEEDED: &str = "LASI or LFWT, LPSI or LBWT or SACR, LKNE, LANK, and the right ones; for the upper body \
                                 C7 or CLAV, LSHO, LELB, LWRA or LWRI, LFHD or HEAD";

/// Half the knee's width, in lengths of the thigh.
const KNEE: f32 = 0.115;
/// Half the ankle's width, in lengths of the shank.
const ANKLE: f32 = 0.085;
/// Shoulder centre below its marker, in distances between the two markers.
const SHOULDER: f32 = 0.14;
/// Hip centres outwards, down and back from the middle of the front markers, in distances between them.
const HIP: Vec3 = Vec3::new(0.36, -0.30, -0.19);
/// The spine joint, from the pelvis to the base of the neck (as E-Gait).
const SPINE: f32 = 0.4;

/// Points of the file: one, or several whose middle counts.
type Group = Vec<usize>;

/// The markers found; `[left, right]`.
#[derive(Debug)]
pub(super) struct Markers {
    front: [Group; 2],
    back: [Group; 2],
    head: Option<Group>,
    neck: Option<Group>,
    shoulder: Option<[Group; 2]>,
    elbow: Option<[Group; 2]>,
    wrist: Option<[Group; 2]>,
    knee: [Group; 2],
    ankle: [Group; 2],
}

impl Markers {
    /// Finds the markers among names; `None` if some are missing.
    pub(super) fn find(names: &[&str]) -> Option<Self> {
        let plain: Vec<String> = names.iter().map(|name| plain(name)).collect();
        let at = |name: &str| plain.iter().position(|other| other == name);
        // The first alternative of which everything is there; `#` stands for the side.
        let group = |side: &str, alternatives: &[&[&str]]| -> Option<Group> {
            alternatives
                .iter()
                .find_map(|names| names.iter().map(|name| at(&name.replace('#', side))).collect())
        };
        let pair = |alternatives: &[&[&str]]| Some([group("l", alternatives)?, group("r", alternatives)?]);
        let shoulder = pair(&[
            &["#sho"],
            &["#acr"],
            &["#shoulder"],
            &["#acromium"],
            &["#acromion"],
            &["#shoulderstudy"],
        ]);
        let neck = group("", &[&["c7", "clav"], &["c7"], &["clav"], &["c7study"]]);
        Some(Self {
            front: pair(&[&["#asi"], &["#fwt"], &["#asis"], &["#asisstudy"]])?,
            back: pair(&[
                &["#psi"],
                &["#bwt"],
                &["#psis"],
                &["#psisstudy"],
                &["sacr"],
                &["sacrum"],
                &["vsacral"],
            ])?,
            head: group(
                "",
                &[&["lfhd", "rfhd", "lbhd", "rbhd"], &["lfhd", "rfhd"], &["head"], &["thead"], &["tophead"]],
            ),
            neck: neck.or_else(|| shoulder.as_ref().map(|sides| sides.concat())),
            shoulder,
            elbow: pair(&[&["#elb"], &["#elbow"], &["#lel"], &["#lelbowstudy"], &["#elbowlat"]]),
            wrist: pair(&[
                &["#wra", "#wrb"],
                &["#wri"],
                &["#wrist"],
                &["#wristlat", "#wristmed"],
                &["#lwriststudy", "#mwriststudy"],
                &["#faradius", "#faulna"],
                &["#wra"],
                &["#wrb"],
            ]),
            knee: pair(&[&["#kne"], &["#knee"], &["#lek"], &["#kneelat"], &["#kneestudy"], &["#lfc"]])?,
            ankle: pair(&[&["#ank"], &["#ankle"], &["#lm"], &["#anklelat"], &["#anklestudy"], &["#lmal"]])?,
        })
    }

    /// The joints that no markers tell.
    pub(super) fn missing(&self) -> JointSet {
        let sides = |is_there: bool, joints: [Joint; 2]| joints.into_iter().filter(move |_| !is_there);
        sides(self.neck.is_some(), [Joint::Spine, Joint::Neck])
            .chain(sides(self.head.is_some(), [Joint::Head, Joint::Head]))
            .chain(sides(self.shoulder.is_some(), [Joint::LeftShoulder, Joint::RightShoulder]))
            .chain(sides(self.elbow.is_some(), [Joint::LeftElbow, Joint::RightElbow]))
            .chain(sides(self.wrist.is_some(), [Joint::LeftHand, Joint::RightHand]))
            .collect()
    }

    fn groups(&self) -> impl Iterator<Item = &Group> {
        let legs = [&self.front, &self.back, &self.knee, &self.ankle];
        let arms = [&self.shoulder, &self.elbow, &self.wrist];
        let pairs = legs.into_iter().chain(arms.into_iter().flatten());
        pairs.flatten().chain([&self.head, &self.neck].into_iter().flatten())
    }

    /// Number of markers used.
    pub(super) fn count(&self) -> usize {
        let mut used = self.used();
        used.sort_unstable();
        used.dedup();
        used.len()
    }

    /// Every point used.
    pub(super) fn used(&self) -> Vec<usize> {
        self.groups().flatten().copied().collect()
    }

    /// The same markers where only some points of the file had been looked at.
    pub(super) fn of(self, points: &[usize]) -> Self {
        let group =
            |group: Group| -> Group { group.into_iter().filter_map(|at| points.get(at).copied()).collect() };
        let pair = |pair: [Group; 2]| pair.map(group);
        Self {
            front: pair(self.front),
            back: pair(self.back),
            head: self.head.map(group),
            neck: self.neck.map(group),
            shoulder: self.shoulder.map(pair),
            elbow: self.elbow.map(pair),
            wrist: self.wrist.map(pair),
            knee: pair(self.knee),
            ankle: pair(self.ankle),
        }
    }

    /// The 16 joints, from the position of each point; file units and frame. What is missing stands at the origin.
    pub(super) fn pose(&self, at: impl Fn(usize) -> Vec3) -> Pose {
        let mean =
            |group: &Group| group.iter().map(|&point| at(point)).sum::<Vec3>() / group.len().max(1) as f32;
        let [left, right] = self.front.each_ref().map(mean);
        let front = (left + right) / 2.0;
        let back = (mean(&self.back[0]) + mean(&self.back[1])) / 2.0;
        let width = left.distance(right);
        // The pelvis's own axes: to the left, forwards, up.
        let lateral = (left - right).normalize_or_zero();
        let forward = (front - back).reject_from_normalized(lateral).normalize_or_zero();
        let up = forward.cross(lateral);
        let hip = |side: f32| front + (lateral * (side * HIP.x) + up * HIP.y + forward * HIP.z) * width;

        let mut pose = [Vec3::ZERO; JOINT_COUNT];
        let mut put = |joint: Joint, point: Vec3| pose[joint as usize] = point;
        let root = (front + back) / 2.0;
        put(Joint::Root, root);
        let mut drop = Vec3::ZERO;
        let shoulders = self.shoulder.as_ref().map(|sides| sides.each_ref().map(mean));
        if let Some(neck) = self.neck.as_ref().map(mean) {
            put(Joint::Spine, root.lerp(neck, SPINE));
            put(Joint::Neck, neck);
            let apart = shoulders.map_or(0.0, |[left, right]| left.distance(right));
            drop = (root - neck).normalize_or_zero() * (SHOULDER * apart);
        }
        if let Some(head) = self.head.as_ref().map(mean) {
            put(Joint::Head, head);
        }
        let sides = [
            (
                1.0,
                [
                    Joint::LeftShoulder,
                    Joint::LeftElbow,
                    Joint::LeftHand,
                    Joint::LeftHip,
                    Joint::LeftKnee,
                    Joint::LeftFoot,
                ],
            ),
            (
                -1.0,
                [
                    Joint::RightShoulder,
                    Joint::RightElbow,
                    Joint::RightHand,
                    Joint::RightHip,
                    Joint::RightKnee,
                    Joint::RightFoot,
                ],
            ),
        ];
        for (index, (side, [shoulder, elbow, hand, hip_joint, knee_joint, foot])) in
            sides.into_iter().enumerate()
        {
            let arm = [
                (shoulder, shoulders.map(|sides| sides[index] + drop)),
                (elbow, self.elbow.as_ref().map(|sides| mean(&sides[index]))),
                (hand, self.wrist.as_ref().map(|sides| mean(&sides[index]))),
            ];
            for (joint, point) in arm {
                if let Some(point) = point {
                    put(joint, point);
                }
            }
            let hip = hip(side);
            // Inwards, across the bone.
            let inwards = |from: Vec3, marker: Vec3, share: f32| {
                let bone = marker - from;
                marker
                    - lateral.reject_from(bone.normalize_or(Vec3::Y)).normalize_or_zero()
                        * (side * share * bone.length())
            };
            let knee = inwards(hip, mean(&self.knee[index]), KNEE);
            put(hip_joint, hip);
            put(knee_joint, knee);
            put(foot, inwards(knee, mean(&self.ankle[index]), ANKLE));
        }
        pose
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Markers of a body standing at the origin, facing +z, metres.
    const BODY: [(&str, [f32; 3]); 20] = [
        ("LFHD", [0.07, 1.60, 0.08]),
        ("RFHD", [-0.07, 1.60, 0.08]),
        ("LBHD", [0.07, 1.60, -0.08]),
        ("RBHD", [-0.07, 1.60, -0.08]),
        ("C7", [0.0, 1.45, -0.07]),
        ("CLAV", [0.0, 1.38, 0.07]),
        ("LSHO", [0.18, 1.42, 0.0]),
        ("RSHO", [-0.18, 1.42, 0.0]),
        ("LELB", [0.26, 1.10, 0.0]),
        ("RELB", [-0.26, 1.10, 0.0]),
        ("LWRA", [0.27, 0.85, 0.03]),
        ("LWRB", [0.31, 0.85, -0.03]),
        ("RWRA", [-0.27, 0.85, 0.03]),
        ("RWRB", [-0.31, 0.85, -0.03]),
        ("LASI", [0.12, 1.00, 0.10]),
        ("RASI", [-0.12, 1.00, 0.10]),
        ("LPSI", [0.05, 1.00, -0.08]),
        ("RPSI", [-0.05, 1.00, -0.08]),
        ("LKNE", [0.14, 0.50, 0.0]),
        ("LANK", [0.13, 0.08, -0.02]),
    ];

    #[test]
    fn joints_stand_inside_their_markers() {
        let mut body: Vec<(&str, Vec3)> =
            BODY.iter().map(|(name, at)| (*name, Vec3::from_array(*at))).collect();
        let names: Vec<&str> = body.iter().map(|(name, _)| *name).collect();
        assert!(Markers::find(&names).is_none(), "the right leg is missing");
        body.push(("RKNE", Vec3::new(-0.14, 0.50, 0.0)));
        body.push(("anna:RANK", Vec3::new(-0.13, 0.08, -0.02)));
        let names: Vec<&str> = body.iter().map(|(name, _)| *name).collect();
        let markers = Markers::find(&names).unwrap();
        assert_eq!(markers.count(), 22);
        let pose = markers.pose(|point| body[point].1);
        let near = |joint: Joint, x: f32, y: f32, z: f32, within: f32| {
            let off = pose[joint as usize].distance(Vec3::new(x, y, z));
            assert!(off < within, "{joint:?} at {} is off by {off}", pose[joint as usize]);
        };
        // Bell's shares of 24 cm by hand; knees about 5.5 cm and ankles about 3.5 cm further in.
        near(Joint::LeftHip, 0.0864, 0.928, 0.0544, 1e-4);
        near(Joint::RightHip, -0.0864, 0.928, 0.0544, 1e-4);
        near(Joint::LeftKnee, 0.09, 0.50, 0.0, 0.01);
        near(Joint::LeftFoot, 0.094, 0.08, -0.02, 0.01);
        near(Joint::Root, 0.0, 1.0, 0.01, 1e-4);
        near(Joint::LeftShoulder, 0.18, 1.37, 0.0, 0.01);
        near(Joint::RightHand, -0.29, 0.85, 0.0, 1e-4);
        near(Joint::Head, 0.0, 1.6, 0.0, 1e-4);
        // The same on the other side, mirrored.
        for joint in Joint::ALL {
            let (a, b) = (pose[joint as usize], pose[joint.mirrored() as usize]);
            assert!(a.distance(Vec3::new(-b.x, b.y, b.z)) < 1e-5, "{joint:?}");
        }
    }
}
