//! Kernels as a part of the caller's submission, so that a frame and the kernels before it are one submission.
//!
//! [`Engine::bring`] and [`Engine::want_report`] choose the contents that go to the device first and come back last.
//! [`Engine::encode`] records everything. [`Engine::encoded`] and [`Engine::report`] follow the wait.
#![allow(dead_code, reason = "some builds have no caller that submits kernels itself")]

use super::super::plan::Op;
use super::super::{Error, Memory};
use super::Engine;
use crate::kernels::{BufferId, Store};
use ash::vk;

impl Engine {
    /// Puts contents of buffers into staging memory, from where [`Engine::encode`] copies them. Contents of an earlier call
    /// that no [`Engine::encode`] has copied are copied now.
    ///
    /// # Errors
    /// When a call fails or memory for staging is short.
    pub(crate) fn bring(&mut self, store: &Store, ids: &[BufferId]) -> Result<(), Error> {
        self.bring_to_device()?;
        self.brought = self.fill(store, ids)?;
        Ok(())
    }

    /// Bytes that the next [`Engine::encode`] brings.
    #[cfg(test)]
    pub(crate) fn brought_bytes(&self) -> usize {
        self.brought.iter().map(|(_, _, length)| length).sum()
    }

    /// Chooses buffers whose contents, as long as in `store`, the next [`Engine::encode`] copies to the host at its end.
    ///
    /// # Errors
    /// When memory for staging is short.
    pub(crate) fn want_report(&mut self, store: &Store, ids: &[BufferId]) -> Result<(), Error> {
        let ids = self.present(ids);
        self.reported = self.stage(&ids, |id| store.bytes(id).len(), Memory::Readback)?;
        Ok(())
    }

    /// Copies the chosen contents into `store`, as the last submission left them.
    pub(crate) fn report(&self, store: &mut Store) {
        if let [_, Some(staging)] = &self.staging {
            for (id, offset, length) in &self.reported {
                let bytes = staging.bytes().get(*offset..offset + length);
                if let (Some(bytes), to) = (bytes, store.bytes_mut(*id))
                    && bytes.len() == to.len()
                {
                    to.copy_from_slice(bytes);
                }
            }
        }
    }

    /// Records what [`Engine::run`] would submit into the caller's command buffer. The caller submits it to the device's
    /// queue, waits, and calls [`Engine::encoded`]. Draws that follow in the command buffer find everything in place.
    ///
    /// # Errors
    /// As of [`Engine::run`], without what only a submission meets.
    pub(crate) fn encode(
        &self,
        commands: vk::CommandBuffer,
        ops: &[Op],
        contents: impl Fn(usize, BufferId) -> Vec<u8>,
    ) -> Result<(), Error> {
        if !self.brought.is_empty() {
            self.encode_copies(commands, &self.brought, true);
            self.barrier(commands);
        }
        self.encode_ops(commands, ops, &contents, false)?;
        self.encode_copies(commands, &self.reported, false);
        Ok(())
    }

    /// Notes that the commands of [`Engine::encode`] are done.
    pub(crate) fn encoded(&mut self) {
        self.brought.clear();
    }
}
