//! Whether the device has drawn a picture when it is handed over.
//!
//! The layer submits a fence of its own behind everything that the program has submitted. The file that `GAITWAY_HANDED_OVER`
//! names says of how many pictures the device was still drawing then, and of how many not.

use super::{Behind, Code};
use std::ffi::{c_char, c_void};
use std::mem::transmute;
use std::sync::Mutex;

pub(super) static CREATE_SESSION: Behind = Behind::new();

/// `XR_TYPE_GRAPHICS_BINDING_VULKAN_KHR`, and what the program's device is.
const VULKAN: u32 = 1_000_025_000;
/// A device that does not draw any more has signalled its fence after so long, ns.
const SOON: u64 = 2_000_000;

#[repr(C)]
pub(super) struct SessionInfo {
    kind: u32,
    next: *const Binding,
    flags: u64,
    system: u64,
}

#[repr(C)]
pub(super) struct Binding {
    kind: u32,
    next: *const Self,
    instance: usize,
    physical: usize,
    device: usize,
    family: u32,
    index: u32,
}

unsafe extern "C" {
    fn dlopen(name: *const c_char, flags: i32) -> *mut c_void;
    fn dlsym(library: *mut c_void, name: *const c_char) -> *mut c_void;
}

/// The device of the session, its queue's family and number.
static DEVICE: Mutex<Option<(usize, u32, u32)>> = Mutex::new(None);

pub(super) unsafe extern "system" fn create_session(
    instance: u64,
    info: *const SessionInfo,
    out: *mut u64,
) -> Code {
    type Create = unsafe extern "system" fn(u64, *const SessionInfo, *mut u64) -> Code;
    unsafe {
        let mut binding = (*info).next;
        while let Some(found) = binding.as_ref() {
            if found.kind == VULKAN {
                *DEVICE.lock().unwrap() = Some((found.device, found.family, found.index));
            }
            binding = found.next;
        }
        CREATE_SESSION.function::<Create>()(instance, info, out)
    }
}

#[repr(C)]
struct FenceInfo {
    kind: u32,
    next: *const c_void,
    flags: u32,
}

type GetQueue = unsafe extern "system" fn(usize, u32, u32, *mut usize);
type CreateFence = unsafe extern "system" fn(usize, *const FenceInfo, *const c_void, *mut u64) -> Code;
type Submit = unsafe extern "system" fn(usize, u32, *const c_void, u64) -> Code;
type Wait = unsafe extern "system" fn(usize, u32, *const u64, u32, u64) -> Code;
type DestroyFence = unsafe extern "system" fn(usize, u64, *const c_void);
type GetProc = unsafe extern "system" fn(usize, *const c_char) -> *mut c_void;

/// Looks whether the device still draws, which is to be called when a picture is handed over: the program holds its queue.
pub(super) unsafe fn look() {
    static SEEN: Mutex<[u32; 2]> = Mutex::new([0; 2]);
    let Some(file) = std::env::var_os("GAITWAY_HANDED_OVER") else { return };
    let Some((device, family, index)) = *DEVICE.lock().unwrap() else { return };
    const NOW: i32 = 2;
    let still_draws = unsafe {
        let library = dlopen(c"libvulkan.so.1".as_ptr(), NOW);
        let get: GetProc = transmute(dlsym(library, c"vkGetDeviceProcAddr".as_ptr()));
        let (mut queue, mut fence) = (0, 0);
        transmute::<*mut c_void, GetQueue>(get(device, c"vkGetDeviceQueue".as_ptr()))(
            device,
            family,
            index,
            &raw mut queue,
        );
        let info = FenceInfo { kind: 8, next: std::ptr::null(), flags: 0 };
        let create: CreateFence = transmute(get(device, c"vkCreateFence".as_ptr()));
        create(device, &raw const info, std::ptr::null(), &raw mut fence);
        let submit: Submit = transmute(get(device, c"vkQueueSubmit".as_ptr()));
        submit(queue, 0, std::ptr::null(), fence);
        let wait: Wait = transmute(get(device, c"vkWaitForFences".as_ptr()));
        let still_draws = wait(device, 1, &raw const fence, 1, SOON) != 0;
        wait(device, 1, &raw const fence, 1, u64::MAX);
        let destroy: DestroyFence = transmute(get(device, c"vkDestroyFence".as_ptr()));
        destroy(device, fence, std::ptr::null());
        still_draws
    };
    let mut seen = SEEN.lock().unwrap();
    seen[usize::from(!still_draws)] += 1;
    let _ = std::fs::write(file, format!("{} while it was drawn, {} after\n", seen[0], seen[1]));
}
