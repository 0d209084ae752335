//! A Vulkan layer that makes a device smaller, poorer or worse than the one that is there.
//!
//! Compiled a second time, by [`super::layer`], as a library that the Vulkan loader puts between the validation layer and
//! the driver: the program under test is the one that users run. `GAITWAY_WRONG_DEVICE` says what is emulated
//! ([`profile::Profile`]). Interface: "Architecture of the Vulkan Loader Interfaces", layers.
#![allow(
    unsafe_code,
    clippy::undocumented_unsafe_blocks,
    clippy::print_stderr,
    unreachable_pub,
    missing_docs,
    dead_code,
    reason = "the C interface of a loader, which the loader calls as its specification says"
)]

#[path = "calls.rs"]
mod calls;
#[path = "pipelines.rs"]
pub(crate) mod pipelines;
#[path = "profile.rs"]
pub(crate) mod profile;
#[path = "vulkan.rs"]
pub(crate) mod vulkan;

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::{CStr, c_char, c_void};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use vulkan::{Code, Dispatchable, Function, GetProc, INITIALIZATION_FAILED, LINK, LOADER_CREATE_INFO};
use vulkan::{Link, LoaderInfo, Negotiate, Object, SUCCESS};

/// What lies behind us, for an instance or for a device.
#[derive(Clone, Copy)]
struct Behind {
    object: usize,
    get_proc: GetProc,
}

/// Everything that is known, by the first word of the objects that belong together.
struct Known {
    behind: BTreeMap<usize, Behind>,
    /// Devices that are lost.
    lost: BTreeSet<usize>,
    /// The submissions of each device, in the order of their first ones; a device that is gone keeps its place.
    submissions: Vec<(usize, u64)>,
    /// Memory: its size, bytes, and whether the host must not see it.
    memory: BTreeMap<Object, (u64, bool)>,
    /// Images that are transient attachments.
    transient: BTreeSet<Object>,
}

static KNOWN: Mutex<Known> = Mutex::new(Known {
    behind: BTreeMap::new(),
    lost: BTreeSet::new(),
    submissions: Vec::new(),
    memory: BTreeMap::new(),
    transient: BTreeSet::new(),
});
/// Submissions of the process.
static SUBMISSIONS: AtomicU64 = AtomicU64::new(0);

fn known<T>(look: impl FnOnce(&mut Known) -> T) -> T {
    look(&mut KNOWN.lock().unwrap_or_else(PoisonError::into_inner))
}

/// What an object has in common with its instance or device.
unsafe fn key(object: Dispatchable) -> usize {
    unsafe { *object.cast::<usize>() }
}

/// The function of this name behind us.
unsafe fn next<F: Copy>(object: Dispatchable, name: &CStr) -> Option<F> {
    let key = unsafe { key(object) };
    let behind = known(|known| known.behind.get(&key).copied())?;
    let found = unsafe { (behind.get_proc)(behind.object as Dispatchable, name.as_ptr()) }?;
    Some(unsafe { std::mem::transmute_copy(&found) })
}

#[unsafe(no_mangle)]
unsafe extern "system" fn vkNegotiateLoaderLayerInterfaceVersion(negotiate: *mut Negotiate) -> Code {
    unsafe {
        (*negotiate).version = 2;
        (*negotiate).get_instance_proc = get_instance_proc;
        (*negotiate).get_device_proc = get_device_proc;
        (*negotiate).get_physical_device_proc = None;
    }
    SUCCESS
}

/// Takes the next link out of the chain that the loader handed over.
unsafe fn take_link(create: *const c_void) -> Option<*mut Link> {
    let mut info = unsafe { *create.cast::<*mut LoaderInfo>().add(1) }; // the chain of a create-info is its second word
    while let Some(found) = unsafe { info.as_mut() } {
        if LOADER_CREATE_INFO.contains(&found.chained.kind) && found.function == LINK {
            let link = found.link;
            found.link = unsafe { (*link).next };
            return Some(link);
        }
        info = found.chained.next.cast();
    }
    None
}

unsafe extern "system" fn create_instance(
    create: *const c_void,
    allocator: *const c_void,
    instance: *mut Dispatchable,
) -> Code {
    type Create = unsafe extern "system" fn(*const c_void, *const c_void, *mut Dispatchable) -> Code;
    unsafe {
        let Some(link) = take_link(create) else { return INITIALIZATION_FAILED };
        let get_proc = (*link).get_instance_proc;
        let Some(next) = get_proc(std::ptr::null_mut(), c"vkCreateInstance".as_ptr()) else {
            return INITIALIZATION_FAILED;
        };
        let code = std::mem::transmute::<Function, Create>(next)(create, allocator, instance);
        if code == SUCCESS {
            let behind = Behind { object: *instance as usize, get_proc };
            known(|known| known.behind.insert(key(*instance), behind));
        }
        code
    }
}

unsafe extern "system" fn create_device(
    physical: Dispatchable,
    create: *const c_void,
    allocator: *const c_void,
    device: *mut Dispatchable,
) -> Code {
    type Create =
        unsafe extern "system" fn(Dispatchable, *const c_void, *const c_void, *mut Dispatchable) -> Code;
    unsafe {
        let Some(link) = take_link(create) else { return INITIALIZATION_FAILED };
        let get_proc = (*link).get_device_proc;
        let Some(next) = next::<Create>(physical, c"vkCreateDevice") else { return INITIALIZATION_FAILED };
        let code = next(physical, create, allocator, device);
        if code == SUCCESS {
            let behind = Behind { object: *device as usize, get_proc };
            known(|known| known.behind.insert(key(*device), behind));
        }
        code
    }
}

type Destroy = unsafe extern "system" fn(Dispatchable, *const c_void);

unsafe extern "system" fn destroy_instance(instance: Dispatchable, allocator: *const c_void) {
    unsafe { destroy(instance, allocator, c"vkDestroyInstance") }
}

unsafe extern "system" fn destroy_device(device: Dispatchable, allocator: *const c_void) {
    pipelines::pipelines().end();
    unsafe { destroy(device, allocator, c"vkDestroyDevice") }
}

unsafe fn destroy(object: Dispatchable, allocator: *const c_void, name: &CStr) {
    if object.is_null() {
        return;
    }
    unsafe {
        let key = key(object);
        if let Some(next) = next::<Destroy>(object, name) {
            next(object, allocator);
        }
        known(|known| {
            known.behind.remove(&key);
            known.lost.remove(&key);
            known.submissions.iter_mut().filter(|(device, _)| *device == key).for_each(|gone| gone.0 = 0);
        });
    }
}

unsafe extern "system" fn get_instance_proc(instance: Dispatchable, name: *const c_char) -> Option<Function> {
    unsafe {
        let ours = calls::find(CStr::from_ptr(name));
        if ours.is_some() || instance.is_null() {
            return ours;
        }
        let behind = known(|known| known.behind.get(&key(instance)).copied())?;
        (behind.get_proc)(instance, name)
    }
}

unsafe extern "system" fn get_device_proc(device: Dispatchable, name: *const c_char) -> Option<Function> {
    unsafe {
        let behind = known(|known| known.behind.get(&key(device)).copied())?;
        // what the driver does not have, we do not have
        let next = (behind.get_proc)(device, name)?;
        Some(calls::find(CStr::from_ptr(name)).unwrap_or(next))
    }
}

/// Counts a submission; whether the device is lost, from now on or already.
unsafe fn is_lost_at_submission(queue: Dispatchable) -> bool {
    let submission = SUBMISSIONS.fetch_add(1, Ordering::Relaxed) + 1;
    let key = unsafe { key(queue) };
    let profile = profile::Profile::of_process();
    known(|known| {
        let at = known.submissions.iter().position(|(device, _)| *device == key);
        let at = at.unwrap_or_else(|| {
            known.submissions.push((key, 0));
            known.submissions.len() - 1
        });
        known.submissions[at].1 += 1;
        let own = Some(known.submissions[at].1);
        let is_now = match at {
            0 => own == profile.first_lost,
            1 => own == profile.second_lost,
            _ => false,
        };
        if is_now || profile.lost == Some(submission) {
            known.lost.insert(key);
        }
    });
    unsafe { is_lost(queue) }
}

unsafe fn is_lost(object: Dispatchable) -> bool {
    let key = unsafe { key(object) };
    known(|known| known.lost.contains(&key))
}
