//! Agents of few pixels (lod3 and lod4), and their shadows. They have the posture of their gait but no pose.

use super::super::Error;
use super::super::commands::Commands;
use super::super::frame::{Frame, Shared};
use super::super::meshes::{DrawList, FarLod};
use super::super::pipelines::{Program, SetIndex, Setup};
use crate::kernels::draw;
use ash::vk;
use std::ops::Range;

/// Draws bodies of 52 and 13 triangles.
pub(in super::super) struct FarPass {
    program: Program,
    solid: vk::Pipeline,
    shadow: vk::Pipeline,
}

impl FarPass {
    pub(in super::super) fn new(setup: &Setup<'_>) -> Result<Self, Error> {
        let mut program = setup.program(&draw::FAR)?;
        let low = ["far_vertex", "far_fragment"];
        let [vertex, fragment] = setup.stages(low, ["far_vertex", "far_fine_fragment"]);
        let solid = program.pipeline(&setup.solid(vertex, fragment))?;
        let shadow = program.pipeline(&setup.shadow("far_shadow"))?;
        Ok(Self { program, solid, shadow })
    }

    pub(in super::super) fn bind(&self, index: SetIndex, shared: &Shared<'_>) -> Result<(), Error> {
        if shared.crowd.is_none() {
            return Ok(());
        }
        self.program.bind(index, |name| shared.find(name))
    }

    /// Draws both levels without an occlusion test.
    pub(in super::super) fn record(&self, frame: &Frame<'_>, commands: &Commands<'_>) {
        let buckets = frame.crowd.map(|crowd| crowd.meshes.all_far_buckets());
        self.draw(frame, commands, buckets, DrawList::Seen);
    }

    /// Draws the bodies of one level that the occlusion pass has kept.
    pub(in super::super) fn record_unoccluded(
        &self,
        frame: &Frame<'_>,
        commands: &Commands<'_>,
        lod: FarLod,
    ) {
        let buckets = frame.crowd.map(|crowd| crowd.meshes.far_buckets(lod));
        self.draw(frame, commands, buckets, DrawList::Unoccluded);
    }

    pub(in super::super) fn record_shadow(&self, frame: &Frame<'_>, commands: &Commands<'_>) {
        let buckets = frame.crowd.map(|crowd| crowd.meshes.all_far_buckets());
        self.draw(frame, commands, buckets, DrawList::Shadow);
    }

    fn draw(&self, frame: &Frame<'_>, commands: &Commands<'_>, buckets: Option<Range<u32>>, list: DrawList) {
        let (Some(crowd), Some(buckets)) = (frame.crowd, buckets) else { return };
        let (pipeline, eye_pass) = match list {
            DrawList::Shadow => (self.shadow, 0),
            DrawList::Seen | DrawList::Unoccluded => (self.solid, frame.eye_pass),
        };
        commands.labelled(c"gaitway.far", || {
            commands.use_program(&self.program, pipeline, eye_pass);
            crowd.meshes.bind_indices(commands);
            for bucket in buckets {
                // SAFETY: rendering has begun, pipeline and indices are bound, and the meshes have the bucket.
                unsafe { crowd.draw_bucket(commands, &self.program, bucket, list) };
            }
        });
    }
}
