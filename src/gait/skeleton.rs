//! The paper's 16 joints: order, parents and names (S-02).
//!
//! Order as in the E-Gait README, left side first; part of the files of E-Gait are right side first, which its
//! importer repairs.

/// Number of joints.
pub const JOINT_COUNT: usize = 16;

/// One of the 16 joints; the discriminant is its index in every pose and buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(usize)]
#[allow(missing_docs, reason = "the variants are body parts and say so")]
pub enum Joint {
    Root = 0,
    Spine = 1,
    Neck = 2,
    Head = 3,
    LeftShoulder = 4,
    LeftElbow = 5,
    LeftHand = 6,
    RightShoulder = 7,
    RightElbow = 8,
    RightHand = 9,
    LeftHip = 10,
    LeftKnee = 11,
    LeftFoot = 12,
    RightHip = 13,
    RightKnee = 14,
    RightFoot = 15,
}

impl Joint {
    /// All joints in index order; a parent always stands before its children.
    pub const ALL: [Self; JOINT_COUNT] = [
        Self::Root,
        Self::Spine,
        Self::Neck,
        Self::Head,
        Self::LeftShoulder,
        Self::LeftElbow,
        Self::LeftHand,
        Self::RightShoulder,
        Self::RightElbow,
        Self::RightHand,
        Self::LeftHip,
        Self::LeftKnee,
        Self::LeftFoot,
        Self::RightHip,
        Self::RightKnee,
        Self::RightFoot,
    ];

    /// The joints above the pelvis, parents first: what a capture of the legs lacks.
    pub const UPPER_BODY: [Self; 9] = [
        Self::Spine,
        Self::Neck,
        Self::Head,
        Self::LeftShoulder,
        Self::LeftElbow,
        Self::LeftHand,
        Self::RightShoulder,
        Self::RightElbow,
        Self::RightHand,
    ];

    /// Index of the parent joint by joint index; the root is its own parent. Shoulders hang on the spine (chest).
    pub const PARENT: [usize; JOINT_COUNT] = [0, 0, 1, 2, 1, 4, 5, 1, 7, 8, 0, 10, 11, 0, 13, 14];

    /// Snake-case name, as written in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Root => "root",
            Self::Spine => "spine",
            Self::Neck => "neck",
            Self::Head => "head",
            Self::LeftShoulder => "left_shoulder",
            Self::LeftElbow => "left_elbow",
            Self::LeftHand => "left_hand",
            Self::RightShoulder => "right_shoulder",
            Self::RightElbow => "right_elbow",
            Self::RightHand => "right_hand",
            Self::LeftHip => "left_hip",
            Self::LeftKnee => "left_knee",
            Self::LeftFoot => "left_foot",
            Self::RightHip => "right_hip",
            Self::RightKnee => "right_knee",
            Self::RightFoot => "right_foot",
        }
    }

    /// The joint on the other side of the body; joints of the middle are their own mirror.
    pub const fn mirrored(self) -> Self {
        match self as usize {
            4..=6 | 10..=12 => Self::ALL[self as usize + 3],
            7..=9 | 13..=15 => Self::ALL[self as usize - 3],
            middle => Self::ALL[middle],
        }
    }
}

/// A set of joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct JointSet(u16);

impl JointSet {
    /// Whether there is no joint in it.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Whether a joint is in it.
    pub const fn contains(self, joint: Joint) -> bool {
        self.0 >> joint as usize & 1 == 1
    }

    /// Its joints in index order, so that parents come first.
    pub fn iter(self) -> impl Iterator<Item = Joint> {
        Joint::ALL.into_iter().filter(move |&joint| self.contains(joint))
    }

    /// The joints of both sets.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The joints on the other side of the body.
    #[must_use]
    pub fn mirrored(self) -> Self {
        self.iter().map(Joint::mirrored).collect()
    }
}

impl FromIterator<Joint> for JointSet {
    fn from_iter<I: IntoIterator<Item = Joint>>(joints: I) -> Self {
        Self(joints.into_iter().fold(0, |bits, joint| bits | 1 << joint as usize))
    }
}

impl std::fmt::Display for JointSet {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.iter().map(Joint::name).collect::<Vec<_>>().join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parents_come_first_and_mirroring_is_its_own_inverse() {
        for (index, joint) in Joint::ALL.into_iter().enumerate() {
            assert_eq!(joint as usize, index);
            assert!(Joint::PARENT[index] < index.max(1));
            assert_eq!(joint.mirrored().mirrored(), joint);
            assert_eq!(
                joint.name().replace("left", "right"),
                joint.mirrored().name().replace("left", "right")
            );
        }
    }
}
