//! Where the agents of a frame look, from the matrices that they were skinned with.

use super::Show;
use crate::Emotion;
use crate::ground::ground_from_world;
use crate::kernels::shared::body::index::{HEAD, PALETTE_STRIDE, RIG_EYES, RIG_STRIDE, SPINE};
use crate::kernels::{BufferId, Store};
use crate::reference::body::visible_agents;
use glam::{Mat4, Vec3, Vec4};

/// The face of an agent that was drawn, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Face {
    /// The agent.
    pub agent: u32,
    /// The emotion they gaze by.
    pub emotion: Emotion,
    /// Midpoint of the eyes, m.
    pub eyes: Vec3,
    /// Where the face points, a unit vector.
    pub forward: Vec3,
    /// Turn of the face against the chest about the vertical, radians, left positive.
    pub turn: f32,
    /// Rise of the face above the horizontal, radians.
    pub rise: f32,
}

impl Face {
    /// Angle between the way the face points and the line from the eyes to a place, radians.
    pub fn off(&self, place: Vec3) -> f32 {
        self.forward.angle_between(place - self.eyes)
    }
}

impl Show {
    /// The faces of the agents of the last frame, skinned ones first, nearest first. `store` is the crowd's start: sizes, rigs
    /// and emotions do not change.
    ///
    /// # Errors
    /// When the device fails.
    pub(crate) fn faces(&mut self, store: &Store) -> Result<Vec<Face>, crate::Error> {
        let Some(animator) = &mut self.animator else { return Ok(Vec::new()) };
        let mut drawn = Store {
            visible: vec![0; store.visible.len()],
            palettes: vec![[0.0; 4]; store.palettes.len()],
            ..Store::default()
        };
        animator.download(&mut drawn, &[BufferId::Visible, BufferId::Palettes])?;
        let agents = visible_agents(&drawn.visible).iter();
        let faces = agents.zip(drawn.palettes.chunks_exact(PALETTE_STRIDE));
        Ok(faces.filter_map(|(agent, palette)| face(store, *agent, palette)).collect())
    }
}

fn face(store: &Store, agent: u32, palette: &[[f32; 4]]) -> Option<Face> {
    let own = store.appearance.get(agent as usize)?;
    let rig = store.rig.get(own.avatar() as usize * RIG_STRIDE..)?;
    let head = world_from_mesh(palette, HEAD);
    let joint_from_mesh = rows(&rig[HEAD * 4 + 1..HEAD * 4 + 4]);
    let in_joint = Vec4::from_array(rig[RIG_EYES]).truncate();
    let eyes = head.transform_point3(joint_from_mesh.inverse().transform_point3(in_joint));
    let forward = head.transform_vector3(Vec3::Z).try_normalize()?;
    let chest = world_from_mesh(palette, SPINE).transform_vector3(Vec3::Z);
    // seen from above with z down the page, left is counter-clockwise: against the sense from x to z
    let turn = -ground_from_world(chest).angle_to(ground_from_world(forward));
    let emotion = *Emotion::ALL.get(own.emotion() as usize)?;
    Some(Face { agent, emotion, eyes, forward, turn, rise: forward.y.clamp(-1.0, 1.0).asin() })
}

fn world_from_mesh(palette: &[[f32; 4]], joint: usize) -> Mat4 {
    rows(&palette[joint * 3..joint * 3 + 3])
}

fn rows(rows: &[[f32; 4]]) -> Mat4 {
    let [x, y, z] = [0, 1, 2].map(|row| Vec4::from_array(rows[row]));
    Mat4::from_cols(x, y, z, Vec4::W).transpose()
}
