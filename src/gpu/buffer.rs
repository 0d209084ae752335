//! Buffers with their memory.

use super::{Device, Error, call};
use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};
use std::sync::{Arc, PoisonError};

/// Where a buffer lives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Memory {
    /// On the device.
    Device,
    /// On the host, written by it and read by the device.
    Upload,
    /// On the host, cached, written by the device and read by the host.
    Readback,
}

/// A Vulkan buffer and its memory.
pub struct Buffer {
    device: Arc<Device>,
    pub(crate) raw: vk::Buffer,
    allocation: Option<Allocation>,
    size: u64,
}

impl std::fmt::Debug for Buffer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Buffer").field("size", &self.size).finish_non_exhaustive()
    }
}

impl Buffer {
    /// Makes a named buffer of `size` bytes (at least 16), fit for every use this program makes of buffers.
    ///
    /// # Errors
    /// When memory is short.
    pub fn new(device: &Arc<Device>, name: &str, size: u64, memory: Memory) -> Result<Self, Error> {
        let size = Self::rounded(size);
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER
            | vk::BufferUsageFlags::UNIFORM_BUFFER
            | vk::BufferUsageFlags::TRANSFER_SRC
            | vk::BufferUsageFlags::TRANSFER_DST
            | vk::BufferUsageFlags::INDIRECT_BUFFER
            | vk::BufferUsageFlags::INDEX_BUFFER;
        let create = vk::BufferCreateInfo::default().size(size).usage(usage);
        // SAFETY: the create-info is complete; the device is alive.
        let raw = unsafe { device.raw.create_buffer(&create, None) }.map_err(call("vkCreateBuffer"))?;
        let mut buffer = Self { device: device.clone(), raw, allocation: None, size };
        device.name(raw, name);
        // SAFETY: the buffer was made by this device.
        let requirements = unsafe { device.raw.get_buffer_memory_requirements(raw) };
        let location = match memory {
            Memory::Device => MemoryLocation::GpuOnly,
            Memory::Upload => MemoryLocation::CpuToGpu,
            Memory::Readback => MemoryLocation::GpuToCpu,
        };
        let allocation = device
            .allocator
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .allocate(&AllocationCreateDesc {
                name,
                requirements,
                location,
                linear: true,
                allocation_scheme: AllocationScheme::GpuAllocatorManaged,
            })
            .map_err(|e| Error::Memory { name: name.to_owned(), bytes: size, reason: e.to_string() })?;
        // SAFETY: the memory satisfies the buffer's requirements and is bound once.
        let bound = unsafe { device.raw.bind_buffer_memory(raw, allocation.memory(), allocation.offset()) };
        buffer.allocation = Some(allocation);
        bound.map_err(call("vkBindBufferMemory"))?;
        Ok(buffer)
    }

    /// The size of a buffer for so many bytes.
    pub fn rounded(bytes: u64) -> u64 {
        bytes.max(16).next_multiple_of(16)
    }

    /// Bytes.
    pub fn size(&self) -> u64 {
        self.size
    }

    /// The mapped bytes of a host buffer; empty for a device buffer that is not mapped.
    pub fn bytes(&self) -> &[u8] {
        self.allocation.as_ref().and_then(Allocation::mapped_slice).unwrap_or(&[])
    }

    /// The mapped bytes of a host buffer, to be written.
    pub fn bytes_mut(&mut self) -> &mut [u8] {
        self.allocation.as_mut().and_then(Allocation::mapped_slice_mut).unwrap_or(&mut [])
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        // SAFETY: the owner of the buffer has waited for the work that uses it (every submission here is waited for).
        unsafe { self.device.raw.destroy_buffer(self.raw, None) };
        if let Some(allocation) = self.allocation.take() {
            let mut allocator = self.device.allocator.lock().unwrap_or_else(PoisonError::into_inner);
            let _ = allocator.free(allocation); // fails only for memory that is not the allocator's
        }
    }
}
