//! What goes between a [`Store`] and the buffers of an engine, through staging memory.

use super::super::{Buffer, Device, Error, Memory};
use super::{Engine, next_version};
use crate::kernels::{BufferId, Phase, Store};
use std::sync::Arc;

/// Largest staging buffer that is kept for smaller copies, bytes.
const STAGING_KEPT: u64 = 4 << 20;

/// A buffer, and where its contents stand in staging memory: offset and length, bytes.
pub(super) type Copy = (BufferId, usize, usize);

impl Engine {
    /// Copies buffers from the host to the device; a buffer whose length has changed is replaced.
    ///
    /// # Errors
    /// When a buffer is larger than the device can bind, memory is short, or a call fails.
    pub fn replace(&mut self, store: &Store, ids: &[BufferId]) -> Result<(), Error> {
        let ids = self.at_home(ids);
        let mut made = Vec::new();
        for &id in &ids {
            let bytes = store.bytes(id).len() as u64;
            let fits = self.buffer(id).is_some_and(|buffer| buffer.size() == Buffer::rounded(bytes));
            if !fits {
                self.forget_repeated()?;
                self.buffers[id as usize] = None;
                self.make_buffer(id, bytes)?;
                made.push(id);
            }
        }
        if !made.is_empty() {
            self.version = next_version();
            for entry in Phase::ALL.map(Phase::entry) {
                let binds = entry.bindings.iter().any(|b| made.contains(&b.buffer));
                if let Some(pipeline) = self.pipelines[entry.phase as usize].as_ref().filter(|_| binds) {
                    pipeline.bind(&self.device, entry, &self.buffers);
                }
            }
        }
        self.upload(store, &ids)
    }

    /// Copies buffers from the host to the device.
    ///
    /// # Errors
    /// When a buffer of the store is longer than it was when it was made, a call fails or memory for staging is short.
    pub fn upload(&mut self, store: &Store, ids: &[BufferId]) -> Result<(), Error> {
        self.bring_to_device()?; // what was brought before is older
        let copies = self.layout(&self.at_home(ids), store)?;
        fill(&self.device, &mut self.staging[0], &copies, store)?;
        self.copy(self.staging[0].as_ref(), &copies, true)
    }

    /// Copies buffers from the device to the host; the store's buffers keep their lengths.
    ///
    /// # Errors
    /// When a buffer of the store is longer than the device's, a call fails or memory for staging is short.
    pub fn download(&mut self, store: &mut Store, ids: &[BufferId]) -> Result<(), Error> {
        let copies = self.layout(ids, store)?;
        stage(&self.device, &mut self.staging[1], &copies, Memory::Readback)?;
        self.copy(self.staging[1].as_ref(), &copies, false)?;
        if let Some(staging) = &self.staging[1] {
            read(staging, &copies, store);
        }
        Ok(())
    }

    /// Refuses more bytes than a buffer of this engine has.
    pub(super) fn fits(&self, id: BufferId, bytes: usize) -> Result<(), Error> {
        match self.buffer(id).map(Buffer::size) {
            Some(size) if bytes as u64 > size => {
                Err(Error::Contents { name: id.name(), bytes: bytes as u64, size })
            }
            _ => Ok(()),
        }
    }

    fn present(&self, ids: &[BufferId]) -> Vec<BufferId> {
        ids.iter().copied().filter(|id| self.buffer(*id).is_some()).collect()
    }

    /// Those that are there and are no part of another.
    pub(super) fn at_home(&self, ids: &[BufferId]) -> Vec<BufferId> {
        ids.iter().copied().filter(|id| self.buffers[*id as usize].is_some()).collect()
    }

    /// Places of buffers' contents, as long as in `store`, one after another in staging memory.
    pub(super) fn layout(&self, ids: &[BufferId], store: &Store) -> Result<Vec<Copy>, Error> {
        let ids = self.present(ids);
        let mut end = 0;
        let mut copies = Vec::with_capacity(ids.len());
        for id in ids {
            let length = store.bytes(id).len();
            self.fits(id, length)?;
            if length > 0 {
                copies.push((id, end, length));
                end += length.next_multiple_of(16);
            }
        }
        Ok(copies)
    }

    pub(super) fn copy(
        &self,
        staging: Option<&Buffer>,
        copies: &[Copy],
        to_device: bool,
    ) -> Result<(), Error> {
        let Some(staging) = staging.filter(|_| !copies.is_empty()) else { return Ok(()) };
        self.record(|engine, commands| {
            engine.encode_copies(commands, staging, copies, to_device);
            Ok(())
        })
    }
}

/// Makes room for copies in a staging buffer, which is kept for the next time if it is small.
pub(super) fn stage(
    device: &Arc<Device>,
    staging: &mut Option<Buffer>,
    copies: &[Copy],
    memory: Memory,
) -> Result<(), Error> {
    let end = copies.last().map_or(0, |(_, offset, length)| (offset + length) as u64);
    if staging.as_ref().is_none_or(|kept| kept.size() < end || kept.size() > STAGING_KEPT.max(end)) {
        *staging = None; // before the new one is made, so that there is room
        if end > 0 {
            *staging = Some(Buffer::new(device, "staging", end, memory)?);
        }
    }
    Ok(())
}

/// Puts contents of buffers into staging memory.
pub(super) fn fill(
    device: &Arc<Device>,
    staging: &mut Option<Buffer>,
    copies: &[Copy],
    store: &Store,
) -> Result<(), Error> {
    stage(device, staging, copies, Memory::Upload)?;
    if let Some(staging) = staging {
        for (id, offset, length) in copies {
            staging.bytes_mut()[*offset..offset + length].copy_from_slice(store.bytes(*id));
        }
    }
    Ok(())
}

/// Copies contents of staging memory into `store`, whose buffers are as long as when they were laid out.
pub(super) fn read(staging: &Buffer, copies: &[Copy], store: &mut Store) {
    for (id, offset, length) in copies {
        let bytes = staging.bytes().get(*offset..offset + length);
        if let (Some(bytes), to) = (bytes, store.bytes_mut(*id))
            && bytes.len() == to.len()
        {
            to.copy_from_slice(bytes);
        }
    }
}
