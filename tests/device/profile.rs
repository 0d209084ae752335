//! What kind of device is emulated, and its limits, features and memory.

use super::vulkan::{Chained, Features, ImageFormat, Limits, Memory, MemoryHeap, MemoryType};
use super::vulkan::{
    DRIVER_PROPERTIES, Driver, MULTIVIEW_FEATURES, MultiviewFeatures, ROBUST_BUFFER_ACCESS,
    VULKAN_11_FEATURES, VULKAN_12_PROPERTIES, Vulkan11Features,
};
use std::sync::OnceLock;

/// The environment variable that names what is emulated, separated by commas.
pub(crate) const VARIABLE: &str = "GAITWAY_WRONG_DEVICE";

/// `VK_MEMORY_PROPERTY_...`.
const DEVICE_LOCAL: u32 = 1;
const HOST: u32 = 2 | 4; // visible and coherent
const CACHED: u32 = 8;
const LAZY: u32 = 16;
/// `VK_DRIVER_ID_QUALCOMM_PROPRIETARY`, `VK_DRIVER_ID_MESA_TURNIP`.
const QUALCOMM: u32 = 8;
const TURNIP: u32 = 18;
/// `VK_SAMPLE_COUNT_1_BIT`, and with `..._4_BIT`: what every device has.
const ONE_SAMPLE: u32 = 1;
const ONE_OR_FOUR: u32 = 1 | 4;
/// `VK_IMAGE_USAGE_SAMPLED_BIT`.
const SAMPLED: u32 = 4;
/// `VK_FORMAT_D16_UNORM` to `VK_FORMAT_D32_SFLOAT_S8_UINT`.
const DEPTH_FORMATS: std::ops::RangeInclusive<u32> = 124..=130;
/// Memory of a discrete card that the host sees, bytes.
const WINDOW: u64 = 256 << 20;

/// What is emulated.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Profile {
    /// `android-15`: the limits that Android 15 demands at least, and no optional feature.
    pub(crate) android: bool,
    /// `vulkan-minimum`: the limits that Vulkan demands at least, but 12 storage buffers a stage instead of 4.
    pub(crate) minimum: bool,
    /// `discrete`: the memory types of a discrete card.
    pub(crate) discrete: bool,
    /// `no-multiview`.
    pub(crate) no_multiview: bool,
    /// `no-timestamps`: no valid bits.
    pub(crate) no_timestamps: bool,
    /// `no-depth-reads`: depth of several samples cannot be read.
    pub(crate) no_depth_reads: bool,
    /// `pipelines`: the driver hands out compiled pipelines and takes them back.
    pub(crate) pipelines: bool,
    /// `tiler`: a tiler's driver, and memory for attachments that is taken lazily, which is never here.
    pub(crate) tiler: bool,
    /// `adreno`: the same with Qualcomm's own driver, whose indexed indirect draws draw nothing.
    pub(crate) adreno: bool,
    /// `no-indirect-draws`: indexed indirect draws draw nothing.
    pub(crate) no_indirect_draws: bool,
    /// `memory@MIB`: so much memory on the device, bytes.
    pub(crate) memory: Option<u64>,
    /// `lost@N`: the device that makes the N-th submission of the process is lost with it.
    pub(crate) lost: Option<u64>,
    /// `first-lost@N`: the first device of the process is lost with its own N-th submission.
    pub(crate) first_lost: Option<u64>,
    /// `second-lost@N`: the second one likewise.
    pub(crate) second_lost: Option<u64>,
}

impl Profile {
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let mut found = Self::default();
        for word in text.split(',').filter(|word| !word.is_empty()) {
            let number =
                |text: &str| text.parse::<u64>().map_err(|error| format!("{VARIABLE}: {word}: {error}"));
            match word.split_once('@') {
                None => *found.flag(word).ok_or_else(|| format!("{VARIABLE}: there is no {word}"))? = true,
                Some(("memory", mib)) => found.memory = Some(number(mib)? << 20),
                Some(("lost", at)) => found.lost = Some(number(at)?),
                Some(("first-lost", at)) => found.first_lost = Some(number(at)?),
                Some(("second-lost", at)) => found.second_lost = Some(number(at)?),
                Some(_) => return Err(format!("{VARIABLE}: there is no {word}")),
            }
        }
        Ok(found)
    }

    fn flag(&mut self, word: &str) -> Option<&mut bool> {
        Some(match word {
            "android-15" => &mut self.android,
            "vulkan-minimum" => &mut self.minimum,
            "discrete" => &mut self.discrete,
            "no-multiview" => &mut self.no_multiview,
            "no-timestamps" => &mut self.no_timestamps,
            "no-depth-reads" => &mut self.no_depth_reads,
            "pipelines" => &mut self.pipelines,
            "tiler" => &mut self.tiler,
            "adreno" => &mut self.adreno,
            "no-indirect-draws" => &mut self.no_indirect_draws,
            _ => return None,
        })
    }

    /// Of the environment. What cannot be read ends the program: a test would say nothing.
    pub(crate) fn of_process() -> &'static Self {
        static PROFILE: OnceLock<Profile> = OnceLock::new();
        PROFILE.get_or_init(|| {
            Self::parse(&std::env::var(VARIABLE).unwrap_or_default()).unwrap_or_else(|error| {
                eprintln!("{error}");
                std::process::abort();
            })
        })
    }

    pub(crate) fn limits(&self, limits: &mut Limits) {
        if self.android {
            small(limits, [128, 13, 12, 128, 4, 4, 128]);
        }
        if self.minimum {
            small(limits, [16, 12, 12, 16, 4, 4, 128]);
        }
        if self.no_timestamps {
            limits.timestamps = 0;
        }
        if self.no_depth_reads {
            limits.sampled_samples[1] &= ONE_SAMPLE;
            limits.sampled_samples[2] &= ONE_SAMPLE;
        }
    }

    pub(crate) fn features(&self, features: &mut Features) {
        if self.android || self.minimum {
            let robust = features.all[ROBUST_BUFFER_ACCESS];
            features.all = [0; 55];
            features.all[ROBUST_BUFFER_ACCESS] = robust;
        }
    }

    /// # Safety
    /// A chain of structures as Vulkan declares them.
    pub(crate) unsafe fn chained(&self, mut chained: *mut Chained) {
        while let Some(structure) = unsafe { chained.as_mut() } {
            let driver = match self {
                Self { adreno: true, .. } => Some(QUALCOMM),
                Self { tiler: true, .. } => Some(TURNIP),
                _ => None,
            };
            if let (DRIVER_PROPERTIES | VULKAN_12_PROPERTIES, Some(id)) = (structure.kind, driver) {
                unsafe { (*chained.cast::<Driver>()).id = id };
            }
            if self.no_multiview {
                match structure.kind {
                    VULKAN_11_FEATURES => unsafe { (*chained.cast::<Vulkan11Features>()).multiview = [0; 3] },
                    MULTIVIEW_FEATURES => unsafe { (*chained.cast::<MultiviewFeatures>()).all = [0; 3] },
                    _ => {}
                }
            }
            chained = structure.next;
        }
    }

    pub(crate) fn memory(&self, memory: &mut Memory) {
        if self.discrete {
            let size = memory.heaps[0].size;
            let heaps = [(size, DEVICE_LOCAL), (size, 0), (WINDOW, DEVICE_LOCAL)];
            let types = [(DEVICE_LOCAL, 0), (HOST, 1), (HOST | CACHED, 1), (DEVICE_LOCAL | HOST, 2)];
            for (place, (size, flags)) in memory.heaps.iter_mut().zip(heaps) {
                *place = MemoryHeap { size, flags };
            }
            for (place, (flags, heap)) in memory.types.iter_mut().zip(types) {
                *place = MemoryType { flags, heap };
            }
            (memory.heap_count, memory.type_count) = (3, 4);
        }
        if let Some(index) = self.lazy_type() {
            memory.types[index as usize] = MemoryType { flags: DEVICE_LOCAL | LAZY, heap: 0 };
            memory.type_count = index + 1;
        }
        if let Some(bytes) = self.memory {
            for heap in &mut memory.heaps[..memory.heap_count as usize] {
                heap.size = heap.size.min(bytes);
            }
        }
    }

    /// The memory types that something may be bound to.
    pub(crate) fn memory_types(&self, types: &mut u32, is_image: bool, is_transient: bool) {
        if self.discrete {
            *types = if is_image { 0b0001 } else { 0b1111 };
        }
        if let Some(index) = self.lazy_type().filter(|_| is_transient) {
            *types |= 1 << index;
        }
    }

    /// The type of memory that is taken lazily: behind lavapipe's only one, or a card's.
    fn lazy_type(&self) -> Option<u32> {
        (self.tiler || self.adreno).then_some(if self.discrete { 4 } else { 1 })
    }

    /// Whether memory of this type is taken lazily: tiles suffice, so that it is never taken.
    pub(crate) fn is_lazy(&self, index: u32) -> bool {
        self.lazy_type() == Some(index)
    }

    /// Whether indexed indirect draws draw nothing.
    pub(crate) fn draws_nothing_indirectly(&self) -> bool {
        self.adreno || self.no_indirect_draws
    }

    /// The driver's own memory type for an emulated one: lavapipe has only one.
    pub(crate) fn own_memory_type(&self, index: u32) -> u32 {
        if self.discrete || self.is_lazy(index) { 0 } else { index }
    }

    /// Whether the host must not see memory of this type.
    pub(crate) fn is_hidden(&self, index: u32) -> bool {
        self.is_lazy(index) || (self.discrete && index == 0)
    }

    pub(crate) fn image(&self, format: u32, usage: u32, found: &mut ImageFormat) {
        if self.no_depth_reads && DEPTH_FORMATS.contains(&format) && usage & SAMPLED != 0 {
            found.samples &= ONE_SAMPLE;
        }
    }
}

fn at_most<const N: usize>(limits: &mut [u32; N], most: &[u32; N]) {
    for (limit, most) in limits.iter_mut().zip(most) {
        *limit = (*limit).min(*most);
    }
}

/// The limits of the table "Required Limits" of Vulkan 1.3, without the optional features, and what a stage may bind.
fn small(limits: &mut Limits, per_stage: [u32; 7]) {
    at_most(&mut limits.image_dimension, &[4096, 4096, 256, 4096, 256]);
    limits.uniform_buffer_range = limits.uniform_buffer_range.min(16 << 10);
    limits.storage_buffer_range = limits.storage_buffer_range.min(1 << 27);
    limits.push_constants_size = limits.push_constants_size.min(128);
    limits.memory_allocations = limits.memory_allocations.min(4096);
    limits.granularity[0] = limits.granularity[0].max(1024);
    limits.bound_descriptor_sets = limits.bound_descriptor_sets.min(4);
    at_most(&mut limits.per_stage, &per_stage);
    at_most(&mut limits.per_set, &[96, 72, 8, 24, 4, 96, 24, 4]);
    limits.vertex_output_components = limits.vertex_output_components.min(64);
    limits.fragment_input_components = limits.fragment_input_components.min(64);
    at_most(&mut limits.fragment_output, &[4, 0, 4]);
    limits.shared_memory = limits.shared_memory.min(16 << 10);
    at_most(&mut limits.group_count, &[65_535; 3]);
    limits.group_invocations = limits.group_invocations.min(128);
    at_most(&mut limits.group_size, &[128, 128, 64]);
    limits.indexed_index_value = limits.indexed_index_value.min((1 << 24) - 1);
    limits.indirect_count = limits.indirect_count.min(1);
    limits.uniform_offset_alignment = 256;
    limits.storage_offset_alignment = 256;
    at_most(&mut limits.framebuffer, &[4096, 4096, 256]);
    at_most(&mut limits.framebuffer_samples, &[ONE_OR_FOUR; 4]);
    at_most(&mut limits.sampled_samples, &[ONE_OR_FOUR, ONE_SAMPLE, ONE_OR_FOUR, ONE_OR_FOUR]);
    limits.color_attachments = limits.color_attachments.min(4);
    limits.non_coherent_atom = 256;
}
