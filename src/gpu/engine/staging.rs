//! Staging memory, through which contents of buffers go to a device and come back.

use super::super::{Buffer, Device, Error, Memory};
use crate::kernels::{BufferId, Store};
use std::sync::Arc;

/// Largest staging buffer that is kept for smaller copies, bytes.
const STAGING_KEPT: u64 = 4 << 20;

/// A buffer, and where its contents stand in staging memory: offset and length, bytes.
pub(super) type Copy = (BufferId, usize, usize);

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
