//! The structures of Vulkan and of its loader that the layer reads or changes, as `vulkan_core.h` and `vk_layer.h` declare
//! them. Fields that nothing here needs stand together. [`super::tests`] holds these against the crate `ash`.
#![allow(unreachable_pub, reason = "the layer is a crate of its own")]

use std::ffi::{c_char, c_void};

/// An instance, a physical device, a device or a queue: its first word is the same for all that belong together.
pub type Dispatchable = *mut c_void;
/// Any other object.
pub type Object = u64;
pub type Code = i32;
pub type Function = unsafe extern "system" fn();
pub type GetProc = unsafe extern "system" fn(Dispatchable, *const c_char) -> Option<Function>;

pub const SUCCESS: Code = 0;
pub const INCOMPLETE: Code = 5;
pub const OUT_OF_DEVICE_MEMORY: Code = -2;
pub const INITIALIZATION_FAILED: Code = -3;
pub const DEVICE_LOST: Code = -4;
pub const MEMORY_MAP_FAILED: Code = -5;

/// `VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO`, `..._DEVICE_CREATE_INFO`.
pub const LOADER_CREATE_INFO: [u32; 2] = [47, 48];
/// `VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES`, and the same of multiview alone.
pub const VULKAN_11_FEATURES: u32 = 49;
pub const MULTIVIEW_FEATURES: u32 = 1_000_053_001;
/// `VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES`, and the same of the driver alone.
pub const VULKAN_12_PROPERTIES: u32 = 52;
pub const DRIVER_PROPERTIES: u32 = 1_000_196_000;
/// What the loader tells a layer about the next one (`VK_LAYER_LINK_INFO`).
pub const LINK: u32 = 0;

/// How every structure begins that others may be chained to.
#[repr(C)]
pub struct Chained {
    pub kind: u32,
    pub next: *mut Self,
}

#[repr(C)]
pub struct Negotiate {
    pub kind: u32,
    pub next: *mut c_void,
    pub version: u32,
    pub get_instance_proc: GetProc,
    pub get_device_proc: GetProc,
    pub get_physical_device_proc: Option<GetProc>,
}

/// `VkLayerInstanceCreateInfo` and `VkLayerDeviceCreateInfo`.
#[repr(C)]
pub struct LoaderInfo {
    pub chained: Chained,
    pub function: u32,
    pub link: *mut Link,
}

/// `VkLayerInstanceLink` and `VkLayerDeviceLink`; of an instance, the last is of physical devices.
#[repr(C)]
pub struct Link {
    pub next: *mut Self,
    pub get_instance_proc: GetProc,
    pub get_device_proc: GetProc,
}

#[repr(C)]
pub struct Limits {
    pub image_dimension: [u32; 5],
    pub texel_buffer_elements: u32,
    pub uniform_buffer_range: u32,
    pub storage_buffer_range: u32,
    pub push_constants_size: u32,
    pub memory_allocations: u32,
    pub samplers: u32,
    pub granularity: [u64; 2],
    pub bound_descriptor_sets: u32,
    /// Samplers, uniform buffers, storage buffers, sampled images, storage images, input attachments, all.
    pub per_stage: [u32; 7],
    /// Samplers, uniform buffers, dynamic ones, storage buffers, dynamic ones, sampled images, storage images, attachments.
    pub per_set: [u32; 8],
    pub vertex_input: [u32; 4],
    pub vertex_output_components: u32,
    pub tessellation: [u32; 8],
    pub geometry: [u32; 5],
    pub fragment_input_components: u32,
    pub fragment_output: [u32; 3],
    pub shared_memory: u32,
    pub group_count: [u32; 3],
    pub group_invocations: u32,
    pub group_size: [u32; 3],
    pub precision: [u32; 3],
    pub indexed_index_value: u32,
    pub indirect_count: u32,
    pub sampler: [f32; 2],
    pub viewports: [u32; 6],
    pub memory_map_alignment: usize,
    pub texel_offset_alignment: u64,
    pub uniform_offset_alignment: u64,
    pub storage_offset_alignment: u64,
    pub texel_offsets: [u32; 7],
    pub framebuffer: [u32; 3],
    /// Colour, depth, stencil, without attachments.
    pub framebuffer_samples: [u32; 4],
    pub color_attachments: u32,
    /// Colour, integer, depth, stencil.
    pub sampled_samples: [u32; 4],
    pub storage_samples: u32,
    pub sample_mask_words: u32,
    pub timestamps: u32,
    pub timestamp_period: f32,
    pub clip_and_others: [u32; 12],
    pub copy_alignment: [u64; 2],
    pub non_coherent_atom: u64,
}

#[repr(C)]
pub struct Properties {
    /// Versions of Vulkan and driver, maker, device, kind of device.
    pub numbers: [u32; 5],
    pub name: [u8; 256],
    pub cache_uuid: [u8; 16],
    pub limits: Limits,
    pub sparse: [u32; 5],
}

#[repr(C)]
pub struct Features {
    pub all: [u32; 55],
}

/// Places in [`Features::all`].
pub const ROBUST_BUFFER_ACCESS: usize = 0;

#[repr(C)]
pub struct MultiviewFeatures {
    pub chained: Chained,
    pub all: [u32; 3],
}

/// The start of `VkPhysicalDeviceVulkan11Features`, up to multiview's three.
#[repr(C)]
pub struct Vulkan11Features {
    pub chained: Chained,
    pub storage: [u32; 4],
    pub multiview: [u32; 3],
}

/// The start of `VkPhysicalDeviceDriverProperties`, which is that of `VkPhysicalDeviceVulkan12Properties`, too.
#[repr(C)]
pub struct Driver {
    pub chained: Chained,
    pub id: u32,
}

#[repr(C)]
pub struct QueueFamily {
    pub flags: u32,
    pub count: u32,
    pub timestamp_bits: u32,
    pub granularity: [u32; 3],
}

#[derive(Clone, Copy)]
#[repr(C)]
pub struct MemoryType {
    pub flags: u32,
    pub heap: u32,
}

#[derive(Clone, Copy)]
#[repr(C)]
pub struct MemoryHeap {
    pub size: u64,
    pub flags: u32,
}

#[repr(C)]
pub struct Memory {
    pub type_count: u32,
    pub types: [MemoryType; 32],
    pub heap_count: u32,
    pub heaps: [MemoryHeap; 16],
}

/// The start of `VkImageCreateInfo`, up to its usage.
#[repr(C)]
pub struct ImageCreate {
    pub chained: Chained,
    pub flags: u32,
    pub kind: u32,
    pub format: u32,
    pub extent: [u32; 3],
    pub levels_and_layers: [u32; 2],
    pub samples: u32,
    pub tiling: u32,
    pub usage: u32,
}

/// `VkImageMemoryRequirementsInfo2` and `VkBufferMemoryRequirementsInfo2`.
#[repr(C)]
pub struct Needing {
    pub chained: Chained,
    pub object: Object,
}

#[repr(C)]
pub struct MemoryRequirements {
    pub size: u64,
    pub alignment: u64,
    pub types: u32,
}

#[derive(Clone, Copy)]
#[repr(C)]
pub struct MemoryAllocate {
    pub kind: u32,
    pub next: *const c_void,
    pub size: u64,
    pub memory_type: u32,
}

#[repr(C)]
pub struct ImageFormat {
    pub extent: [u32; 3],
    pub levels_and_layers: [u32; 2],
    pub samples: u32,
    pub size: u64,
}

/// `VkPhysicalDeviceImageFormatInfo2`.
#[repr(C)]
pub struct ImageFormatInfo {
    pub chained: Chained,
    pub format: u32,
    pub kind: u32,
    pub tiling: u32,
    pub usage: u32,
    pub flags: u32,
}

/// A structure of "2": another one with a head for chains.
#[repr(C)]
pub struct Second<T> {
    pub chained: Chained,
    pub inner: T,
}

#[repr(C)]
pub struct ModuleCreate {
    pub chained: Chained,
    pub flags: u32,
    pub size: usize,
    pub code: *const u8,
}

#[repr(C)]
pub struct CacheCreate {
    pub chained: Chained,
    pub flags: u32,
    pub size: usize,
    pub data: *const u8,
}

#[repr(C)]
pub struct Stage {
    pub chained: Chained,
    pub flags: u32,
    pub stage: u32,
    pub module: Object,
    pub name: *const c_char,
    pub specialization: *const c_void,
}

#[repr(C)]
pub struct ComputeCreate {
    pub chained: Chained,
    pub flags: u32,
    pub stage: Stage,
    pub layout: Object,
    pub base: Object,
    pub base_index: i32,
}

/// `VkGraphicsPipelineCreateInfo`; between the stages and the layout lie nine states.
#[repr(C)]
pub struct GraphicsCreate {
    pub chained: Chained,
    pub flags: u32,
    pub stage_count: u32,
    pub stages: *const Stage,
    pub states: [*const c_void; 9],
    pub layout: Object,
    pub pass: Object,
    pub subpass: u32,
    pub base: Object,
    pub base_index: i32,
}
