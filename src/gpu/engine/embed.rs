//! Kernels as a part of the caller's submission, so that a frame and the kernels before it are one submission.
//!
//! [`Engine::bring`] and [`Engine::want_report`] choose the contents that go to the device first and come back last.
//! [`Engine::encode`] records everything. [`Engine::encoded`] follows the submission, [`Engine::report`] the wait for it.
//!
//! Submissions may overlap with what the host does for the next one. Each has a slot with memory of its own, and a slot is
//! used again when its submission was waited for.
#![allow(dead_code, reason = "some builds have no caller that submits kernels itself")]

use super::super::plan::Op;
use super::super::{Buffer, Error, Memory};
use super::Engine;
use super::staging::{Copy, fill, read, stage};
use crate::kernels::{BufferId, Store};
use ash::vk;

/// What one submission of the caller copies.
#[derive(Default)]
pub(super) struct Embedded {
    /// Staging memory: to the device, and from it.
    staging: [Option<Buffer>; 2],
    /// What the next [`Engine::encode`] copies to the device first.
    brought: Vec<Copy>,
    /// What it copies to the host at its end.
    reported: Vec<Copy>,
}

impl Engine {
    /// Puts contents of buffers into a slot's staging memory, from where [`Engine::encode`] copies them. Contents of an earlier
    /// call that no [`Engine::encode`] has copied are copied now.
    ///
    /// # Errors
    /// When a call fails or memory for staging is short.
    pub(crate) fn bring(&mut self, slot: usize, store: &Store, ids: &[BufferId]) -> Result<(), Error> {
        self.bring_to_device()?;
        let copies = self.layout(&self.at_home(ids), store)?;
        let embedded = &mut self.embedded[slot];
        fill(&self.device, &mut embedded.staging[0], &copies, store)?;
        embedded.brought = copies;
        Ok(())
    }

    /// Copies the contents that wait for [`Engine::encode`] to the device, in a submission of their own.
    pub(super) fn bring_to_device(&mut self) -> Result<(), Error> {
        for slot in 0..self.embedded.len() {
            let brought = std::mem::take(&mut self.embedded[slot].brought);
            self.copy(self.embedded[slot].staging[0].as_ref(), &brought, true)?;
        }
        Ok(())
    }

    /// Bytes that the next [`Engine::encode`] brings.
    #[cfg(test)]
    pub(crate) fn brought_bytes(&self) -> usize {
        self.embedded.iter().flat_map(|embedded| &embedded.brought).map(|(_, _, length)| length).sum()
    }

    /// Chooses buffers whose contents, as long as in `store`, the next [`Engine::encode`] of the slot copies to the host at its
    /// end.
    ///
    /// # Errors
    /// When memory for staging is short.
    pub(crate) fn want_report(&mut self, slot: usize, store: &Store, ids: &[BufferId]) -> Result<(), Error> {
        let copies = self.layout(ids, store)?;
        let embedded = &mut self.embedded[slot];
        stage(&self.device, &mut embedded.staging[1], &copies, Memory::Readback)?;
        embedded.reported = copies;
        Ok(())
    }

    /// Copies the chosen contents into `store`, as the slot's last submission left them.
    pub(crate) fn report(&self, slot: usize, store: &mut Store) {
        let Embedded { staging, reported, .. } = &self.embedded[slot];
        if let [_, Some(staging)] = staging {
            read(staging, reported, store);
        }
    }

    /// Records what [`Engine::run`] would submit into the caller's command buffer, with what was chosen for this slot. The caller
    /// submits it to the device's queue and calls [`Engine::encoded`]. Draws that follow in the command buffer find
    /// everything in place.
    ///
    /// # Errors
    /// As of [`Engine::run`], without what only a submission meets.
    pub(crate) fn encode(
        &self,
        slot: usize,
        commands: vk::CommandBuffer,
        ops: &[Op],
        contents: impl Fn(usize, BufferId) -> Vec<u8>,
    ) -> Result<(), Error> {
        let Embedded { staging: [up, down], brought, reported } = &self.embedded[slot];
        if let Some(staging) = up.as_ref().filter(|_| !brought.is_empty()) {
            self.encode_copies(commands, staging, brought, true);
            self.barrier(commands);
        }
        self.encode_ops(commands, ops, &contents, false)?;
        if let Some(staging) = down.as_ref().filter(|_| !reported.is_empty()) {
            self.encode_copies(commands, staging, reported, false);
        }
        Ok(())
    }

    /// Notes that the commands of [`Engine::encode`] were submitted.
    pub(crate) fn encoded(&mut self, slot: usize) {
        self.embedded[slot].brought.clear();
    }
}
