//! Agents with a pose (lod0 to lod2), and their shadows.

use super::super::Error;
use super::super::commands::Commands;
use super::super::frame::{Frame, Shared};
use super::super::meshes::DrawList;
use super::super::pipelines::{PipelineSpec, Program, SetIndex, Setup};
use super::super::settings::Quality;
use super::shadow::SunMap;
use crate::kernels::draw;
use ash::vk;

/// Draws the skinned bodies.
pub(in super::super) struct CrowdPass {
    program: Program,
    /// For the finest level, which fades near the eyes.
    near: vk::Pipeline,
    solid: vk::Pipeline,
    shadow: vk::Pipeline,
    /// Of the finer shadow map; the other one where there is none.
    near_shadow: vk::Pipeline,
}

impl CrowdPass {
    pub(in super::super) fn new(setup: &Setup<'_>) -> Result<Self, Error> {
        let mut program = setup.program(&draw::CROWD)?;
        let low = ["crowd_vertex", "crowd_fragment"];
        let [vertex, fragment] = setup.stages(low, ["crowd_fine_vertex", "crowd_fine_fragment"]);
        let solid = program.pipeline(&setup.solid(vertex, fragment))?;
        let low = ["crowd_vertex", "crowd_near_fragment"];
        let [vertex, fragment] = setup.stages(low, ["crowd_fine_vertex", "crowd_near_fine_fragment"]);
        let near = PipelineSpec { covers: true, ..setup.solid(vertex, fragment) };
        let near = program.pipeline(&near)?;
        let shadow = program.pipeline(&setup.shadow("crowd_shadow"))?;
        let near_shadow = match setup.quality {
            Quality::Low => shadow,
            Quality::Medium | Quality::High => program.pipeline(&setup.shadow("crowd_near_shadow"))?,
        };
        Ok(Self { program, near, solid, shadow, near_shadow })
    }

    pub(in super::super) fn bind(&self, index: SetIndex, shared: &Shared<'_>) -> Result<(), Error> {
        if shared.crowd.is_none() {
            return Ok(());
        }
        self.program.bind(index, |name| shared.find(name))
    }

    pub(in super::super) fn record(&self, frame: &Frame<'_>, commands: &Commands<'_>) {
        let Some(meshes) = frame.crowd.map(|crowd| crowd.meshes) else { return };
        // one change of pipelines: the finest level of every avatar, then the others
        let is_near = |bucket: &u32| bucket.is_multiple_of(meshes.level_count);
        let finest =
            (0..meshes.bucket_count).filter(|bucket| is_near(bucket) && !meshes.painted.contains(bucket));
        let others = (0..meshes.bucket_count).filter(|bucket| !is_near(bucket));
        commands.labelled(c"gaitway.crowd", || {
            commands.use_program(&self.program, self.near, frame.eye_pass);
            self.draw(frame, commands, finest, DrawList::Seen);
            commands.use_program(&self.program, self.solid, frame.eye_pass);
            self.draw(frame, commands, others, DrawList::Seen);
        });
    }

    pub(in super::super) fn record_shadow(&self, frame: &Frame<'_>, commands: &Commands<'_>, map: &SunMap) {
        let Some(meshes) = frame.crowd.map(|crowd| crowd.meshes) else { return };
        let (pipeline, list) = match map.near {
            Some(_) => (self.near_shadow, DrawList::Seen),
            None => (self.shadow, DrawList::Shadow),
        };
        let reach = map.near.unwrap_or(f32::INFINITY);
        // near ones may be in the second level for want of room
        let casts = |bucket: &u32| bucket % meshes.level_count < 2 || frame.third_begins <= reach;
        commands.labelled(c"gaitway.crowd", || {
            commands.use_program(&self.program, pipeline, map.pass);
            self.draw(frame, commands, (0..meshes.bucket_count).filter(casts), list);
        });
    }

    /// Draws these buckets with the pipeline that is bound.
    fn draw(
        &self,
        frame: &Frame<'_>,
        commands: &Commands<'_>,
        buckets: impl Iterator<Item = u32>,
        list: DrawList,
    ) {
        let Some(crowd) = frame.crowd else { return };
        crowd.meshes.bind_indices(commands);
        for bucket in buckets {
            // SAFETY: rendering has begun, pipeline and indices are bound, and the meshes have the bucket.
            unsafe { crowd.draw_bucket(commands, &self.program, bucket, list) };
        }
    }
}
