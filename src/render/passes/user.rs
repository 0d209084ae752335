//! What a frame shows of the user: hands and a teleport's arc, its ring on the floor, and the vignette.

use super::super::commands::Commands;
use super::super::frame::Shared;
use super::super::pipelines::{Program, Resource, SetIndex, Setup};
use super::super::user::SOLID_VERTICES;
use super::super::{Error, User};
use crate::gpu::{Buffer, Memory};
use crate::kernels::draw;
use crate::kernels::layout::UserUniforms;
use ash::vk;

/// Draws the user.
pub(in super::super) struct UserPass {
    program: Program,
    solid: vk::Pipeline,
    target: vk::Pipeline,
    vignette: vk::Pipeline,
    uniforms: Buffer,
    user: User,
}

impl UserPass {
    pub(in super::super) fn new(setup: &Setup<'_>) -> Result<Self, Error> {
        let (near, over_all) = (vk::CompareOp::GREATER, vk::CompareOp::ALWAYS);
        let mut program = setup.program(&draw::USER)?;
        let [vertex, fragment] =
            setup.stages(["user_vertex", "user_fragment"], ["user_vertex", "user_fine_fragment"]);
        let solid = program.pipeline(&setup.two_sided(vertex, fragment))?;
        let target = program.pipeline(&setup.blended("target_vertex", "target_fragment", near))?;
        let vignette = program.pipeline(&setup.blended("vignette_vertex", "vignette_fragment", over_all))?;
        let size = size_of::<UserUniforms>() as u64;
        let uniforms = Buffer::new(setup.device, "user", size, Memory::Device)?;
        Ok(Self { program, solid, target, vignette, uniforms, user: User::default() })
    }

    pub(in super::super) fn set(&mut self, user: User) {
        self.user = user;
    }

    pub(in super::super) fn bind(&self, index: SetIndex, shared: &Shared<'_>) -> Result<(), Error> {
        self.program.bind(index, |name| match name {
            "user" => Some(Resource::Buffer(self.uniforms.raw)),
            name => shared.find(name),
        })
    }

    /// Records the update of the uniforms, before rendering.
    pub(in super::super) fn update(&self, commands: &Commands<'_>) {
        if self.user == User::default() {
            return;
        }
        let (uniforms, _) = self.user.uniforms();
        let bytes = bytemuck::bytes_of(&uniforms);
        // SAFETY: recording has begun; the contents are below 65,536 bytes, a multiple of four, and fit the buffer.
        unsafe { commands.raw().cmd_update_buffer(commands.buffer, self.uniforms.raw, 0, bytes) };
    }

    /// Draws hands and arc, which are nearest.
    pub(in super::super) fn record_solids(&self, commands: &Commands<'_>, eye_pass: usize) {
        let (_, solids) = self.user.uniforms();
        self.draw(commands, eye_pass, self.solid, [SOLID_VERTICES, solids]);
    }

    /// Draws the ring where a teleport leads, and vignette and fade over everything.
    pub(in super::super) fn record_overlays(&self, commands: &Commands<'_>, eye_pass: usize) {
        let has_target = u32::from(self.user.teleport.is_some());
        self.draw(commands, eye_pass, self.target, [6, has_target]);
        let is_covered = u32::from(self.user.vignette > 0.0 || self.user.fade > 0.0);
        self.draw(commands, eye_pass, self.vignette, [3, is_covered]);
    }

    fn draw(
        &self,
        commands: &Commands<'_>,
        eye_pass: usize,
        pipeline: vk::Pipeline,
        [vertices, instances]: [u32; 2],
    ) {
        if instances == 0 {
            return;
        }
        commands.labelled(c"gaitway.user", || {
            commands.use_program(&self.program, pipeline, eye_pass);
            // SAFETY: rendering has begun; the shader makes its own vertices.
            unsafe { commands.raw().cmd_draw(commands.buffer, vertices, instances, 0, 0) };
        });
    }
}
