//! The layer's structures against those of the crate `ash`, and what it understands.

use super::layer::profile::Profile;
use super::layer::vulkan::{
    CacheCreate, ComputeCreate, Driver, Features, GraphicsCreate, ImageCreate, ImageFormat, ImageFormatInfo,
    Limits, Memory, MemoryAllocate, MemoryRequirements, ModuleCreate, MultiviewFeatures, Needing, Properties,
    QueueFamily, Second, Stage, Vulkan11Features,
};
use ash::vk;
use std::mem::{offset_of, size_of};

/// Fields of both that must lie at the same place.
macro_rules! same {
    ($ours:ty, $theirs:ty: $($own:ident $own_at:expr, $other:ident;)*) => {
        $(assert_eq!(
            offset_of!($ours, $own) + $own_at * 4,
            offset_of!($theirs, $other),
            "{}.{}", stringify!($theirs), stringify!($other)
        );)*
    };
}

#[test]
fn the_layers_structures_are_those_of_vulkan() {
    let sizes = [
        (size_of::<Limits>(), size_of::<vk::PhysicalDeviceLimits>()),
        (size_of::<Properties>(), size_of::<vk::PhysicalDeviceProperties>()),
        (size_of::<Second<Properties>>(), size_of::<vk::PhysicalDeviceProperties2<'_>>()),
        (size_of::<Features>(), size_of::<vk::PhysicalDeviceFeatures>()),
        (size_of::<MultiviewFeatures>(), size_of::<vk::PhysicalDeviceMultiviewFeatures<'_>>()),
        (size_of::<QueueFamily>(), size_of::<vk::QueueFamilyProperties>()),
        (size_of::<Second<QueueFamily>>(), size_of::<vk::QueueFamilyProperties2<'_>>()),
        (size_of::<Memory>(), size_of::<vk::PhysicalDeviceMemoryProperties>()),
        (size_of::<MemoryRequirements>(), size_of::<vk::MemoryRequirements>()),
        (size_of::<Second<MemoryRequirements>>(), size_of::<vk::MemoryRequirements2<'_>>()),
        (size_of::<MemoryAllocate>(), size_of::<vk::MemoryAllocateInfo<'_>>()),
        (size_of::<ImageFormat>(), size_of::<vk::ImageFormatProperties>()),
        (size_of::<ImageFormatInfo>(), size_of::<vk::PhysicalDeviceImageFormatInfo2<'_>>()),
        (size_of::<Needing>(), size_of::<vk::ImageMemoryRequirementsInfo2<'_>>()),
        (size_of::<Needing>(), size_of::<vk::BufferMemoryRequirementsInfo2<'_>>()),
        (size_of::<ModuleCreate>(), size_of::<vk::ShaderModuleCreateInfo<'_>>()),
        (size_of::<CacheCreate>(), size_of::<vk::PipelineCacheCreateInfo<'_>>()),
        (size_of::<Stage>(), size_of::<vk::PipelineShaderStageCreateInfo<'_>>()),
        (size_of::<ComputeCreate>(), size_of::<vk::ComputePipelineCreateInfo<'_>>()),
        (size_of::<GraphicsCreate>(), size_of::<vk::GraphicsPipelineCreateInfo<'_>>()),
    ];
    for (number, (ours, theirs)) in sizes.into_iter().enumerate() {
        assert_eq!(ours, theirs, "structure {number}");
    }
    same!(Limits, vk::PhysicalDeviceLimits:
        image_dimension 1, max_image_dimension2_d;
        uniform_buffer_range 0, max_uniform_buffer_range;
        storage_buffer_range 0, max_storage_buffer_range;
        push_constants_size 0, max_push_constants_size;
        memory_allocations 0, max_memory_allocation_count;
        granularity 0, buffer_image_granularity;
        bound_descriptor_sets 0, max_bound_descriptor_sets;
        per_stage 2, max_per_stage_descriptor_storage_buffers;
        per_stage 6, max_per_stage_resources;
        per_set 3, max_descriptor_set_storage_buffers;
        vertex_output_components 0, max_vertex_output_components;
        fragment_input_components 0, max_fragment_input_components;
        fragment_output 2, max_fragment_combined_output_resources;
        shared_memory 0, max_compute_shared_memory_size;
        group_count 0, max_compute_work_group_count;
        group_invocations 0, max_compute_work_group_invocations;
        group_size 0, max_compute_work_group_size;
        indexed_index_value 0, max_draw_indexed_index_value;
        indirect_count 0, max_draw_indirect_count;
        uniform_offset_alignment 0, min_uniform_buffer_offset_alignment;
        storage_offset_alignment 0, min_storage_buffer_offset_alignment;
        framebuffer 1, max_framebuffer_height;
        framebuffer_samples 1, framebuffer_depth_sample_counts;
        color_attachments 0, max_color_attachments;
        sampled_samples 2, sampled_image_depth_sample_counts;
        timestamps 0, timestamp_compute_and_graphics;
        non_coherent_atom 0, non_coherent_atom_size;
    );
    same!(Properties, vk::PhysicalDeviceProperties: cache_uuid 0, pipeline_cache_uuid; limits 0, limits;);
    same!(Features, vk::PhysicalDeviceFeatures: all 0, robust_buffer_access;);
    same!(Vulkan11Features, vk::PhysicalDeviceVulkan11Features<'_>: multiview 0, multiview;);
    same!(QueueFamily, vk::QueueFamilyProperties: timestamp_bits 0, timestamp_valid_bits;);
    same!(Memory, vk::PhysicalDeviceMemoryProperties: types 0, memory_types; heaps 0, memory_heaps;);
    same!(MemoryRequirements, vk::MemoryRequirements: types 0, memory_type_bits;);
    same!(MemoryAllocate, vk::MemoryAllocateInfo<'_>: size 0, allocation_size; memory_type 0, memory_type_index;);
    same!(ImageFormat, vk::ImageFormatProperties: samples 0, sample_counts;);
    same!(ImageFormatInfo, vk::PhysicalDeviceImageFormatInfo2<'_>: format 0, format; usage 0, usage;);
    same!(ImageCreate, vk::ImageCreateInfo<'_>: format 0, format; samples 0, samples; usage 0, usage;);
    same!(Needing, vk::ImageMemoryRequirementsInfo2<'_>: object 0, image;);
    same!(Driver, vk::PhysicalDeviceDriverProperties<'_>: id 0, driver_id;);
    same!(Driver, vk::PhysicalDeviceVulkan12Properties<'_>: id 0, driver_id;);
    same!(ModuleCreate, vk::ShaderModuleCreateInfo<'_>: size 0, code_size; code 0, p_code;);
    same!(CacheCreate, vk::PipelineCacheCreateInfo<'_>: size 0, initial_data_size; data 0, p_initial_data;);
    same!(Stage, vk::PipelineShaderStageCreateInfo<'_>: module 0, module; name 0, p_name;);
    same!(ComputeCreate, vk::ComputePipelineCreateInfo<'_>: stage 0, stage;);
    same!(GraphicsCreate, vk::GraphicsPipelineCreateInfo<'_>: stage_count 0, stage_count; stages 0, p_stages; layout 0, layout;);
}

#[test]
fn what_is_not_known_is_not_emulated_in_silence() {
    let lost = Profile { lost: Some(7), discrete: true, ..Profile::default() };
    assert_eq!(Profile::parse("discrete,lost@7"), Ok(lost));
    assert_eq!(Profile::parse("memory@64").unwrap().memory, Some(64 << 20));
    for kind in super::KINDS {
        assert_ne!(Profile::parse(kind).unwrap(), Profile::default());
    }
    assert_eq!(Profile::parse("second-lost@20").unwrap().second_lost, Some(20));
    for wrong in ["discreet", "lost", "lost@", "third-lost@1", "memory@much", "discrete@1"] {
        assert!(Profile::parse(wrong).is_err(), "{wrong}");
    }
}
