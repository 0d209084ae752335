//! The calls that the layer changes.

use super::pipelines::pipelines;
use super::profile::Profile;
use super::vulkan::{
    CacheCreate, Chained, Code, ComputeCreate, DEVICE_LOST, Dispatchable, Features, Function, GraphicsCreate,
    INITIALIZATION_FAILED, ImageCreate, ImageFormat, ImageFormatInfo, MEMORY_MAP_FAILED, Memory,
    MemoryAllocate, MemoryRequirements, ModuleCreate, Needing, OUT_OF_DEVICE_MEMORY, Object, Properties,
    QueueFamily, SUCCESS, Second,
};
use super::{is_lost, is_lost_at_submission, known, next};
use std::ffi::{CStr, c_void};
use std::mem::transmute;
use std::slice;

type Pointer = *const c_void;
/// `VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT`.
const TRANSIENT: u32 = 64;

/// Our function of a name, if the layer changes what it does.
pub(super) fn find(name: &CStr) -> Option<Function> {
    let makes_pipelines = Profile::of_process().pipelines;
    let function = match name.to_str().ok()? {
        "vkGetInstanceProcAddr" => super::get_instance_proc as *const (),
        "vkGetDeviceProcAddr" => super::get_device_proc as *const (),
        "vkCreateInstance" => super::create_instance as *const (),
        "vkDestroyInstance" => super::destroy_instance as *const (),
        "vkCreateDevice" => super::create_device as *const (),
        "vkDestroyDevice" => super::destroy_device as *const (),
        "vkGetPhysicalDeviceProperties" => properties as *const (),
        "vkGetPhysicalDeviceProperties2" | "vkGetPhysicalDeviceProperties2KHR" => properties_2 as *const (),
        "vkGetPhysicalDeviceFeatures" => features as *const (),
        "vkGetPhysicalDeviceFeatures2" | "vkGetPhysicalDeviceFeatures2KHR" => features_2 as *const (),
        "vkGetPhysicalDeviceQueueFamilyProperties" => queues as *const (),
        "vkGetPhysicalDeviceQueueFamilyProperties2" | "vkGetPhysicalDeviceQueueFamilyProperties2KHR" => {
            queues_2 as *const ()
        }
        "vkGetPhysicalDeviceMemoryProperties" => memory as *const (),
        "vkGetPhysicalDeviceMemoryProperties2" | "vkGetPhysicalDeviceMemoryProperties2KHR" => {
            memory_2 as *const ()
        }
        "vkGetPhysicalDeviceImageFormatProperties" => image_format as *const (),
        "vkGetPhysicalDeviceImageFormatProperties2" | "vkGetPhysicalDeviceImageFormatProperties2KHR" => {
            image_format_2 as *const ()
        }
        "vkGetBufferMemoryRequirements" => buffer_needs as *const (),
        "vkGetBufferMemoryRequirements2" | "vkGetBufferMemoryRequirements2KHR" => buffer_needs_2 as *const (),
        "vkGetImageMemoryRequirements" => image_needs as *const (),
        "vkGetImageMemoryRequirements2" | "vkGetImageMemoryRequirements2KHR" => image_needs_2 as *const (),
        "vkCreateImage" => create_image as *const (),
        "vkCmdDrawIndexedIndirect" if Profile::of_process().draws_nothing_indirectly() => {
            draw_nothing as *const ()
        }
        "vkAllocateMemory" => allocate as *const (),
        "vkFreeMemory" => free as *const (),
        "vkMapMemory" => map as *const (),
        "vkQueueSubmit" => submit as *const (),
        "vkQueueSubmit2" | "vkQueueSubmit2KHR" => submit_2 as *const (),
        "vkWaitForFences" => wait as *const (),
        "vkQueueWaitIdle" => queue_idle as *const (),
        "vkDeviceWaitIdle" => device_idle as *const (),
        "vkCreateShaderModule" if makes_pipelines => create_module as *const (),
        "vkCreatePipelineCache" if makes_pipelines => create_cache as *const (),
        "vkGetPipelineCacheData" if makes_pipelines => cache_data as *const (),
        "vkMergePipelineCaches" if makes_pipelines => merge_caches as *const (),
        "vkCreateComputePipelines" if makes_pipelines => compute_pipelines as *const (),
        "vkCreateGraphicsPipelines" if makes_pipelines => graphics_pipelines as *const (),
        _ => return None,
    };
    // the loader casts it to what the name says
    Some(unsafe { transmute::<*const (), Function>(function) })
}

/// A query of a structure, plain or with a head for chains: the answer of the driver, changed.
macro_rules! queries {
    ($($plain:ident $plain_name:literal, $second:ident $second_name:literal, $inner:ty, $change:expr;)+) => {$(
        unsafe extern "system" fn $plain(physical: Dispatchable, out: *mut $inner) {
            type Query = unsafe extern "system" fn(Dispatchable, *mut $inner);
            unsafe {
                let Some(next) = next::<Query>(physical, $plain_name) else { return };
                next(physical, out);
                $change(Profile::of_process(), &mut *out);
            }
        }

        unsafe extern "system" fn $second(physical: Dispatchable, out: *mut Second<$inner>) {
            type Query = unsafe extern "system" fn(Dispatchable, *mut Second<$inner>);
            unsafe {
                let Some(next) = next::<Query>(physical, $second_name) else { return };
                next(physical, out);
                Profile::of_process().chained((&raw mut (*out).chained).cast::<Chained>());
                $change(Profile::of_process(), &mut (*out).inner);
            }
        }
    )+};
}

queries! {
    properties c"vkGetPhysicalDeviceProperties", properties_2 c"vkGetPhysicalDeviceProperties2", Properties,
        |profile: &Profile, found: &mut Properties| profile.limits(&mut found.limits);
    features c"vkGetPhysicalDeviceFeatures", features_2 c"vkGetPhysicalDeviceFeatures2", Features, Profile::features;
    memory c"vkGetPhysicalDeviceMemoryProperties", memory_2 c"vkGetPhysicalDeviceMemoryProperties2", Memory, Profile::memory;
}

/// The same of queue families, of which there are several.
macro_rules! families {
    ($($function:ident $name:literal, $element:ty, $family:expr;)+) => {$(
        unsafe extern "system" fn $function(physical: Dispatchable, count: *mut u32, out: *mut $element) {
            type Query = unsafe extern "system" fn(Dispatchable, *mut u32, *mut $element);
            unsafe {
                let Some(next) = next::<Query>(physical, $name) else { return };
                next(physical, count, out);
                if !out.is_null() && Profile::of_process().no_timestamps {
                    slice::from_raw_parts_mut(out, *count as usize).iter_mut().for_each($family);
                }
            }
        }
    )+};
}

families! {
    queues c"vkGetPhysicalDeviceQueueFamilyProperties", QueueFamily,
        |family: &mut QueueFamily| family.timestamp_bits = 0;
    queues_2 c"vkGetPhysicalDeviceQueueFamilyProperties2", Second<QueueFamily>,
        |family: &mut Second<QueueFamily>| family.inner.timestamp_bits = 0;
}

unsafe extern "system" fn image_format(
    physical: Dispatchable,
    format: u32,
    kind: u32,
    tiling: u32,
    usage: u32,
    flags: u32,
    out: *mut ImageFormat,
) -> Code {
    type Query = unsafe extern "system" fn(Dispatchable, u32, u32, u32, u32, u32, *mut ImageFormat) -> Code;
    unsafe {
        let name = c"vkGetPhysicalDeviceImageFormatProperties";
        let Some(next) = next::<Query>(physical, name) else { return INITIALIZATION_FAILED };
        let code = next(physical, format, kind, tiling, usage, flags, out);
        Profile::of_process().image(format, usage, &mut *out);
        code
    }
}

unsafe extern "system" fn image_format_2(
    physical: Dispatchable,
    info: *const ImageFormatInfo,
    out: *mut Second<ImageFormat>,
) -> Code {
    type Query =
        unsafe extern "system" fn(Dispatchable, *const ImageFormatInfo, *mut Second<ImageFormat>) -> Code;
    unsafe {
        let name = c"vkGetPhysicalDeviceImageFormatProperties2";
        let Some(next) = next::<Query>(physical, name) else { return INITIALIZATION_FAILED };
        let code = next(physical, info, out);
        Profile::of_process().image((*info).format, (*info).usage, &mut (*out).inner);
        code
    }
}

/// What memory a buffer or an image needs: of an object, or of a structure that names it.
macro_rules! needs {
    ($($function:ident $name:literal, $object:ty, $own:expr, $out:ty, $types:expr, $is_image:literal;)+) => {$(
        unsafe extern "system" fn $function(device: Dispatchable, object: $object, out: *mut $out) {
            type Query = unsafe extern "system" fn(Dispatchable, $object, *mut $out);
            unsafe {
                let Some(next) = next::<Query>(device, $name) else { return };
                next(device, object, out);
                let own: Object = $own(object);
                let is_transient = $is_image && known(|known| known.transient.contains(&own));
                Profile::of_process().memory_types($types(&mut *out), $is_image, is_transient);
            }
        }
    )+};
}

fn types(needs: &mut MemoryRequirements) -> &mut u32 {
    &mut needs.types
}

fn types_2(needs: &mut Second<MemoryRequirements>) -> &mut u32 {
    &mut needs.inner.types
}

unsafe fn object_of(needing: *const Needing) -> Object {
    unsafe { (*needing).object }
}

needs! {
    buffer_needs c"vkGetBufferMemoryRequirements", Object, std::convert::identity, MemoryRequirements, types, false;
    buffer_needs_2 c"vkGetBufferMemoryRequirements2", *const Needing, object_of, Second<MemoryRequirements>, types_2, false;
    image_needs c"vkGetImageMemoryRequirements", Object, std::convert::identity, MemoryRequirements, types, true;
    image_needs_2 c"vkGetImageMemoryRequirements2", *const Needing, object_of, Second<MemoryRequirements>, types_2, true;
}

unsafe extern "system" fn create_image(
    device: Dispatchable,
    create: *const ImageCreate,
    allocator: Pointer,
    out: *mut Object,
) -> Code {
    unsafe {
        let Some(next) = next::<Create<ImageCreate>>(device, c"vkCreateImage") else {
            return INITIALIZATION_FAILED;
        };
        let code = next(device, create, allocator, out);
        if code == SUCCESS {
            // a handle may be that of an image that is gone
            known(|known| match (*create).usage & TRANSIENT {
                0 => known.transient.remove(&*out),
                _ => known.transient.insert(*out),
            });
        }
        code
    }
}

/// Draws nothing and says nothing.
unsafe extern "system" fn draw_nothing(_: Dispatchable, _: Object, _: u64, _: u32, _: u32) {}

unsafe extern "system" fn allocate(
    device: Dispatchable,
    info: *const MemoryAllocate,
    allocator: Pointer,
    out: *mut Object,
) -> Code {
    type Allocate =
        unsafe extern "system" fn(Dispatchable, *const MemoryAllocate, Pointer, *mut Object) -> Code;
    let profile = Profile::of_process();
    unsafe {
        let Some(next) = next::<Allocate>(device, c"vkAllocateMemory") else { return INITIALIZATION_FAILED };
        let taken = if profile.is_lazy((*info).memory_type) { 0 } else { (*info).size };
        let in_use: u64 = known(|known| known.memory.values().map(|(size, _)| size).sum());
        if profile.memory.is_some_and(|most| in_use + taken > most) {
            return OUT_OF_DEVICE_MEMORY;
        }
        let own = MemoryAllocate { memory_type: profile.own_memory_type((*info).memory_type), ..*info };
        let code = next(device, &raw const own, allocator, out);
        if code == SUCCESS {
            let is_hidden = profile.is_hidden((*info).memory_type);
            known(|known| known.memory.insert(*out, (taken, is_hidden)));
        }
        code
    }
}

unsafe extern "system" fn free(device: Dispatchable, memory: Object, allocator: Pointer) {
    type Free = unsafe extern "system" fn(Dispatchable, Object, Pointer);
    known(|known| known.memory.remove(&memory));
    unsafe {
        if let Some(next) = next::<Free>(device, c"vkFreeMemory") {
            next(device, memory, allocator);
        }
    }
}

unsafe extern "system" fn map(
    device: Dispatchable,
    memory: Object,
    offset: u64,
    size: u64,
    flags: u32,
    out: *mut *mut c_void,
) -> Code {
    type Map = unsafe extern "system" fn(Dispatchable, Object, u64, u64, u32, *mut *mut c_void) -> Code;
    if known(|known| known.memory.get(&memory).is_some_and(|(_, is_hidden)| *is_hidden)) {
        return MEMORY_MAP_FAILED;
    }
    unsafe {
        let Some(next) = next::<Map>(device, c"vkMapMemory") else { return MEMORY_MAP_FAILED };
        next(device, memory, offset, size, flags, out)
    }
}

type Submit = unsafe extern "system" fn(Dispatchable, u32, Pointer, Object) -> Code;

unsafe extern "system" fn submit(queue: Dispatchable, count: u32, infos: Pointer, fence: Object) -> Code {
    unsafe { submit_by(c"vkQueueSubmit", queue, count, infos, fence) }
}

unsafe extern "system" fn submit_2(queue: Dispatchable, count: u32, infos: Pointer, fence: Object) -> Code {
    unsafe { submit_by(c"vkQueueSubmit2", queue, count, infos, fence) }
}

unsafe fn submit_by(name: &CStr, queue: Dispatchable, count: u32, infos: Pointer, fence: Object) -> Code {
    unsafe {
        if is_lost_at_submission(queue) {
            // what was submitted before is over when a lost device is waited for
            idle(queue, c"vkQueueWaitIdle");
            return DEVICE_LOST;
        }
        next::<Submit>(queue, name).map_or(INITIALIZATION_FAILED, |next| next(queue, count, infos, fence))
    }
}

unsafe fn idle(object: Dispatchable, name: &CStr) -> Code {
    type Idle = unsafe extern "system" fn(Dispatchable) -> Code;
    unsafe { next::<Idle>(object, name).map_or(INITIALIZATION_FAILED, |next| next(object)) }
}

unsafe extern "system" fn queue_idle(queue: Dispatchable) -> Code {
    unsafe { if is_lost(queue) { DEVICE_LOST } else { idle(queue, c"vkQueueWaitIdle") } }
}

unsafe extern "system" fn device_idle(device: Dispatchable) -> Code {
    unsafe { if is_lost(device) { DEVICE_LOST } else { idle(device, c"vkDeviceWaitIdle") } }
}

unsafe extern "system" fn wait(
    device: Dispatchable,
    count: u32,
    fences: *const Object,
    all: u32,
    patience: u64,
) -> Code {
    type Wait = unsafe extern "system" fn(Dispatchable, u32, *const Object, u32, u64) -> Code;
    unsafe {
        if is_lost(device) {
            return DEVICE_LOST;
        }
        let Some(next) = next::<Wait>(device, c"vkWaitForFences") else { return INITIALIZATION_FAILED };
        next(device, count, fences, all, patience)
    }
}

/// A call that makes an object of a create-info.
type Create<T> = unsafe extern "system" fn(Dispatchable, *const T, Pointer, *mut Object) -> Code;

unsafe extern "system" fn create_module(
    device: Dispatchable,
    create: *const ModuleCreate,
    allocator: Pointer,
    out: *mut Object,
) -> Code {
    unsafe {
        let Some(next) = next::<Create<ModuleCreate>>(device, c"vkCreateShaderModule") else {
            return INITIALIZATION_FAILED;
        };
        let code = next(device, create, allocator, out);
        if code == SUCCESS {
            pipelines().add_module(*out, &*create);
        }
        code
    }
}

unsafe extern "system" fn create_cache(
    device: Dispatchable,
    create: *const CacheCreate,
    allocator: Pointer,
    out: *mut Object,
) -> Code {
    unsafe {
        let Some(next) = next::<Create<CacheCreate>>(device, c"vkCreatePipelineCache") else {
            return INITIALIZATION_FAILED;
        };
        let CacheCreate { flags, .. } = *create;
        let Chained { kind, next: chain } = (*create).chained;
        let empty =
            CacheCreate { chained: Chained { kind, next: chain }, flags, size: 0, data: std::ptr::null() };
        let code = next(device, &raw const empty, allocator, out);
        if code == SUCCESS {
            pipelines().add_cache(*out, &*create);
        }
        code
    }
}

unsafe extern "system" fn cache_data(
    device: Dispatchable,
    cache: Object,
    size: *mut usize,
    out: *mut u8,
) -> Code {
    type Data = unsafe extern "system" fn(Dispatchable, Object, *mut usize, *mut u8) -> Code;
    unsafe {
        let Some(next) = next::<Data>(device, c"vkGetPipelineCacheData") else {
            return INITIALIZATION_FAILED;
        };
        let mut head = [0; 32];
        next(device, cache, &mut head.len(), head.as_mut_ptr());
        pipelines().data(cache, head, &mut *size, out)
    }
}

unsafe extern "system" fn merge_caches(
    _: Dispatchable,
    into: Object,
    count: u32,
    from: *const Object,
) -> Code {
    unsafe { pipelines().merge(into, slice::from_raw_parts(from, count as usize)) };
    SUCCESS
}

/// A call that makes pipelines of create-infos.
type CreateMany<T> =
    unsafe extern "system" fn(Dispatchable, Object, u32, *const T, Pointer, *mut Object) -> Code;

unsafe extern "system" fn compute_pipelines(
    device: Dispatchable,
    cache: Object,
    count: u32,
    creates: *const ComputeCreate,
    allocator: Pointer,
    out: *mut Object,
) -> Code {
    unsafe {
        let Some(next) = next::<CreateMany<ComputeCreate>>(device, c"vkCreateComputePipelines") else {
            return INITIALIZATION_FAILED;
        };
        for create in slice::from_raw_parts(creates, count as usize) {
            pipelines().make(cache, std::iter::once(&create.stage));
        }
        next(device, cache, count, creates, allocator, out)
    }
}

unsafe extern "system" fn graphics_pipelines(
    device: Dispatchable,
    cache: Object,
    count: u32,
    creates: *const GraphicsCreate,
    allocator: Pointer,
    out: *mut Object,
) -> Code {
    unsafe {
        let Some(next) = next::<CreateMany<GraphicsCreate>>(device, c"vkCreateGraphicsPipelines") else {
            return INITIALIZATION_FAILED;
        };
        for create in slice::from_raw_parts(creates, count as usize) {
            let stages = slice::from_raw_parts(create.stages, create.stage_count as usize);
            pipelines().make(cache, stages.iter());
        }
        next(device, cache, count, creates, allocator, out)
    }
}
