//! What a session is known by.

use super::{Session, UserState};
use crate::avatar::Avatar;
use crate::hash::Hash;
use crate::kernels::Store;
use crate::kernels::shared::attention::{RANGE, RANGE_HYSTERESIS};
use crate::library::GaitLibrary;
use crate::reference::gaze::user_in_model;
use crate::scenario::Scenario;
use crate::sim::measure::state_hash;

/// A hash of a session. It covers the header, the user in every step, the inputs of the crowd's gaze in every step, and the
/// state of the crowd.
///
/// The angles at which heads were shown depend on the times of the display's frames, and no replay could repeat them. The
/// steps fix their inputs: the emotion of each agent within reach that looks at the user at times, and the user's head as
/// that agent sees it. Another condition, another mode of the gaze or another posture of the head gives another hash, though
/// all agents walk as before.
#[derive(Debug, Clone)]
pub struct SessionHash {
    hash: Hash,
    sees_far: bool,
}

impl SessionHash {
    /// Of a session before its first step.
    pub fn new(session: &Session) -> Self {
        let mut hash = Hash::default();
        session.values().iter().for_each(|value| hash.add_text(value));
        Self { hash, sees_far: session.gaze != "natural" }
    }

    /// Adds a step: the user in it, and the crowd after it.
    pub fn step(&mut self, user: &UserState, crowd: &Store) {
        let numbers = [user.place.x, user.place.y, user.elevation, user.velocity.x, user.velocity.y];
        self.hash.add(bytemuck::cast_slice(&numbers));
        for pose in [user.head, user.hands[0], user.hands[1]] {
            self.hash.add(&u32::from(pose.is_some()).to_le_bytes());
            self.hash.add(bytemuck::cast_slice(&pose.unwrap_or_default()));
        }
        self.hash.add(bytemuck::cast_slice(&user.sticks));
        if let Some([x, y, z, ..]) = user.head {
            self.gaze([x, y, z], crowd);
        }
    }

    /// Adds the user's head as seen by each agent that looks at the user at times.
    fn gaze(&mut self, head: [f32; 3], crowd: &Store) {
        let range = RANGE + RANGE_HYSTERESIS;
        for agent in 0..crowd.step.agent_count as usize {
            let (own, [x, z]) = (crowd.appearance[agent], crowd.position[agent]);
            let away = [head[0] - x, head[2] - z];
            let is_near = self.sees_far || away[0] * away[0] + away[1] * away[1] < range * range;
            if own.gazes() && is_near {
                let scale = own.scale;
                let mut seen = user_in_model(head, [x, z], crowd.heading[agent], scale);
                seen[1] -= crowd.elevation[agent] / scale;
                #[allow(clippy::cast_possible_truncation, reason = "at most a million agents")]
                self.hash.add(bytemuck::cast_slice(&[agent as u32, own.traits]));
                self.hash.add(bytemuck::cast_slice(&seen));
            }
        }
    }

    /// The hash so far, with the state of the crowd after the step that was added last.
    pub fn with(&self, crowd: &Store) -> u64 {
        let mut hash = self.hash;
        hash.add(&state_hash(crowd).to_le_bytes());
        hash.value()
    }
}

/// A hash of a crowd before its first step: its state, its bodies and how they look and walk.
pub fn hash_start(crowd: &Store) -> u64 {
    let mut hash = Hash::default();
    hash.add(&state_hash(crowd).to_le_bytes());
    hash.add(bytemuck::cast_slice(&crowd.body));
    // where all are alike one record counts for each
    let each =
        crowd.avoidance.iter().chain(std::iter::repeat_n(crowd.avoidance.last(), crowd.body.len()).flatten());
    each.take(crowd.body.len()).for_each(|own| hash.add(bytemuck::bytes_of(own)));
    hash.add(bytemuck::cast_slice(&crowd.appearance));
    hash.add(bytemuck::cast_slice(&crowd.gaits));
    hash.add(bytemuck::cast_slice(&crowd.gait_weights));
    hash.value()
}

/// A hash of a scenario as it runs: of every key, with what the command line changed.
pub fn hash_scenario(scenario: &Scenario) -> u64 {
    let mut hash = Hash::default();
    // a scenario that was read or made can be written
    hash.add_text(&serde_json::to_string(scenario).unwrap_or_default());
    hash.value()
}

/// A hash of all gaits of a library: of what a crowd has of them, in whatever bytes the file had it.
pub fn hash_library(library: &GaitLibrary) -> u64 {
    let mut hash = Hash::default();
    for gait in library.gaits() {
        hash.add_text(&gait.name);
        for position in gait.poses.iter().flatten() {
            hash.add(bytemuck::cast_slice(&position.to_array()));
        }
        let sex = gait.provenance.sex;
        hash.add_text(&format!(
            "{:?}",
            (gait.frame_rate, gait.speed, gait.ratings, gait.label, sex, gait.missing)
        ));
    }
    hash.value()
}

/// A hash of bodies: names, joints, meshes.
pub fn hash_avatars(avatars: &[Avatar]) -> u64 {
    let mut hash = Hash::default();
    for avatar in avatars {
        hash.add_text(&avatar.name);
        hash.add(bytemuck::cast_slice(&avatar.eyes_in_head.to_array()));
        hash.add(bytemuck::bytes_of(&avatar.height));
        hash.add_text(&format!("{:?}", avatar.eyeball));
        for joint in &avatar.joints {
            hash.add_text(&format!("{joint:?}"));
        }
        for mesh in &avatar.levels {
            hash.add(bytemuck::cast_slice(&mesh.indices));
            for vertex in &mesh.vertices {
                for numbers in [vertex.position, vertex.normal, vertex.color] {
                    hash.add(bytemuck::cast_slice(&numbers.to_array()));
                }
                hash.add(&(vertex.material as u32).to_le_bytes());
                hash.add(&vertex.joints);
                hash.add(bytemuck::cast_slice(&vertex.weights));
            }
        }
    }
    hash.value()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;
    use crate::emotion::Emotion;
    use crate::gait::Gait;
    use crate::gait::walker::Sex;

    #[test]
    fn a_library_is_known_by_what_a_crowd_has_of_it() {
        let hash = |change: &dyn Fn(&mut Gait)| {
            let mut gaits = GaitLibrary::generated(3, 1).unwrap().gaits().to_vec();
            change(&mut gaits[5]);
            hash_library(&GaitLibrary::from_gaits(gaits).unwrap())
        };
        let plain = hash(&|_| {});
        assert_eq!(hash(&|gait| gait.provenance.file = "elsewhere.bvh".to_owned()), plain);
        let changes: [&dyn Fn(&mut Gait); 8] = [
            &|gait| gait.poses[7][3].y += 1e-6,
            &|gait| gait.poses.truncate(20),
            &|gait| gait.frame_rate += 1.0,
            &|gait| gait.speed += 1e-6,
            &|gait| gait.label = Some(Emotion::Neutral),
            &|gait| gait.ratings = Some([1.0, 2.0, 3.0, 4.0]),
            &|gait| gait.provenance.sex = Some(Sex::Female),
            &|gait| gait.missing = [crate::gait::Joint::Neck].into_iter().collect(),
        ];
        for (number, change) in changes.iter().enumerate() {
            assert_ne!(hash(change), plain, "change {number}");
        }
    }
}
