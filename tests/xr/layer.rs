//! An OpenXR API layer that plants faults which Monado does not produce by itself.
//!
//! Compiled a second time, by [`super::service::layer`], as a library that the OpenXR loader puts between the program and
//! the runtime: the program under test is the one that users run. `GAITWAY_FAULT=NAME@N` strikes at the N-th call of the
//! function concerned, `NAME@N+` at that one and all later ones. It also watches the frames: what their times and poses are
//! (`GAITWAY_FRAMES`), what goes along with the first picture (`GAITWAY_SEEN`) and which inputs are bound
//! (`GAITWAY_SUGGESTED`), and when the device has drawn what is handed over (`GAITWAY_HANDED_OVER`). Interface: "OpenXR Loader - Design and Operation", API layer negotiation.
#![allow(
    unsafe_code,
    non_snake_case,
    clippy::undocumented_unsafe_blocks,
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    missing_docs,
    dead_code,
    reason = "the C interface of a loader, which the loader calls as its specification says"
)]

#[path = "layer/fakes.rs"]
mod fakes;
#[path = "layer/frames.rs"]
mod frames;
#[path = "layer/queue.rs"]
mod queue;

use frames::{EndInfo, FrameState, Located, look_at, watch};
use std::ffi::{CStr, c_char, c_void};
use std::mem::transmute;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicPtr, AtomicU64, Ordering};

type Code = i32;
type Function = unsafe extern "system" fn();
type GetProc = unsafe extern "system" fn(u64, *const c_char, *mut Option<Function>) -> Code;
type CreateLayer = unsafe extern "system" fn(*const c_void, *const LayerInfo, *mut u64) -> Code;
type Poll = unsafe extern "system" fn(u64, *mut c_void) -> Code;
/// Any function of a handle and two pointers or fewer; the surplus is ignored by the calling convention.
type Plain = unsafe extern "system" fn(u64, *const c_void, *mut c_void) -> Code;

const TIMEOUT_EXPIRED: Code = 1;
const LOSS_PENDING: Code = 3;
const ERROR_RUNTIME_FAILURE: Code = -2;
const ERROR_FEATURE_UNSUPPORTED: Code = -8;
const ERROR_INSTANCE_LOST: Code = -13;
const ERROR_SESSION_LOST: Code = -17;

#[repr(C)]
struct NegotiateRequest {
    kind: u32,
    version: u32,
    size: usize,
    interface: u32,
    api: u64,
    get_proc: GetProc,
    create: CreateLayer,
}

#[repr(C)]
struct NextInfo {
    kind: u32,
    version: u32,
    size: usize,
    name: [c_char; 256],
    get_proc: GetProc,
    create: CreateLayer,
    next: *mut Self,
}

#[repr(C)]
struct LayerInfo {
    kind: u32,
    version: u32,
    size: usize,
    loader: *mut c_void,
    settings: [c_char; 512],
    next: *mut NextInfo,
}

/// The runtime's function behind ours. Instances come and go, and the loader gives each its own.
struct Behind(AtomicPtr<c_void>);

impl Behind {
    const fn new() -> Self {
        Self(AtomicPtr::new(std::ptr::null_mut()))
    }

    unsafe fn function<F: Copy>(&self) -> F {
        let pointer = self.0.load(Ordering::Acquire);
        unsafe { std::mem::transmute_copy(&pointer) }
    }
}

static GET_PROC: Behind = Behind::new();
static POLL: Behind = Behind::new();
static WAIT_FRAME: Behind = Behind::new();
static BEGIN_FRAME: Behind = Behind::new();
static END_FRAME: Behind = Behind::new();
static WAIT_IMAGE: Behind = Behind::new();
static LOCATE_VIEWS: Behind = Behind::new();
static REQUEST_EXIT: Behind = Behind::new();
/// The session, as passed to xrEndFrame.
static SESSION: AtomicU64 = AtomicU64::new(0);

/// Name, call at which it strikes, and whether it goes on.
fn fault() -> &'static (String, u64, bool) {
    static FAULT: OnceLock<(String, u64, bool)> = OnceLock::new();
    FAULT.get_or_init(|| {
        let text = std::env::var("GAITWAY_FAULT").unwrap_or_default();
        let (name, at) = text.split_once('@').unwrap_or((&text, "0"));
        (name.to_owned(), at.trim_end_matches('+').parse().unwrap_or(0), at.ends_with('+'))
    })
}

/// Whether this call of the function that the fault is of is the one that fails.
fn strikes(name: &str) -> bool {
    static CALLS: AtomicU64 = AtomicU64::new(0);
    let (wanted, at, goes_on) = fault();
    if wanted != name {
        return false;
    }
    let call = CALLS.fetch_add(1, Ordering::Relaxed) + 1;
    call == *at || (*goes_on && call > *at)
}

#[unsafe(no_mangle)]
unsafe extern "system" fn xrNegotiateLoaderApiLayerInterface(
    _loader: *const c_void,
    _name: *const c_char,
    request: *mut NegotiateRequest,
) -> Code {
    unsafe {
        (*request).interface = 1;
        (*request).api = 1 << 48;
        (*request).get_proc = get_proc;
        (*request).create = create_instance;
    }
    0
}

unsafe extern "system" fn create_instance(
    create: *const c_void,
    info: *const LayerInfo,
    instance: *mut u64,
) -> Code {
    unsafe {
        let next = (*info).next;
        GET_PROC.0.store((*next).get_proc as *mut c_void, Ordering::Release);
        let mut inner = std::ptr::read(info);
        inner.next = (*next).next;
        ((*next).create)(create, &raw const inner, instance)
    }
}

unsafe extern "system" fn get_proc(instance: u64, name: *const c_char, out: *mut Option<Function>) -> Code {
    unsafe {
        let real: GetProc = GET_PROC.function();
        let code = real(instance, name, out);
        let Some(found) = (*out).filter(|_| code == 0) else { return code };
        let (behind, ours): (&Behind, *const c_void) = match CStr::from_ptr(name).to_bytes() {
            b"xrPollEvent" => (&POLL, poll as *const c_void),
            b"xrWaitFrame" => (&WAIT_FRAME, wait_frame as *const c_void),
            b"xrBeginFrame" => (&BEGIN_FRAME, begin_frame as *const c_void),
            b"xrEndFrame" => (&END_FRAME, end_frame as *const c_void),
            b"xrWaitSwapchainImage" => (&WAIT_IMAGE, wait_image as *const c_void),
            b"xrCreateSession" => (&queue::CREATE_SESSION, queue::create_session as *const c_void),
            b"xrLocateViews" => (&LOCATE_VIEWS, locate_views as *const c_void),
            b"xrRequestExitSession" => {
                REQUEST_EXIT.0.store(found as *mut c_void, Ordering::Release);
                return code;
            }
            name => match fakes::ours(name) {
                Some(faked) => faked,
                None => return code,
            },
        };
        behind.0.store(found as *mut c_void, Ordering::Release);
        *out = Some(transmute::<*const c_void, Function>(ours));
        code
    }
}

/// Type numbers of the events, as in `openxr.h`.
const SESSION_STATE_CHANGED: u32 = 18;
const INSTANCE_LOSS_PENDING: u32 = 17;
const STATE_LOSS_PENDING: u32 = 7;

#[repr(C)]
struct StateChanged {
    kind: u32,
    next: *const c_void,
    session: u64,
    state: u32,
    time: i64,
}

#[repr(C)]
struct InstanceLoss {
    kind: u32,
    next: *const c_void,
    time: i64,
}

unsafe extern "system" fn poll(instance: u64, event: *mut c_void) -> Code {
    unsafe {
        // counted from the first frame on
        let session = SESSION.load(Ordering::Relaxed);
        if session != 0 && strikes("loss-pending") {
            let (kind, state, next) = (SESSION_STATE_CHANGED, STATE_LOSS_PENDING, std::ptr::null());
            event.cast::<StateChanged>().write(StateChanged { kind, next, session, state, time: 1 });
            return 0;
        }
        if session != 0 && strikes("instance-loss-pending") {
            let (kind, next) = (INSTANCE_LOSS_PENDING, std::ptr::null());
            event.cast::<InstanceLoss>().write(InstanceLoss { kind, next, time: 1 });
            return 0;
        }
        POLL.function::<Poll>()(instance, event)
    }
}

unsafe extern "system" fn wait_frame(session: u64, info: *const c_void, state: *mut c_void) -> Code {
    unsafe {
        if strikes("session-lost-at-wait") {
            return ERROR_SESSION_LOST;
        }
        if strikes("exit") {
            // as when the user closes the application in the runtime's menu
            REQUEST_EXIT.function::<unsafe extern "system" fn(u64) -> Code>()(session);
        }
        let code = WAIT_FRAME.function::<Plain>()(session, info, state);
        if code >= 0 {
            watch(|watched| watched.display = (*state.cast::<FrameState>()).display);
        }
        code
    }
}

unsafe extern "system" fn begin_frame(session: u64, info: *const c_void) -> Code {
    if strikes("begin-fails") {
        return ERROR_RUNTIME_FAILURE;
    }
    unsafe { BEGIN_FRAME.function::<unsafe extern "system" fn(u64, *const c_void) -> Code>()(session, info) }
}

unsafe extern "system" fn end_frame(session: u64, info: *const EndInfo) -> Code {
    SESSION.store(session, Ordering::Relaxed);
    unsafe {
        look_at(info);
        if (*info).has_picture() {
            queue::look();
        }
        watch(|watched| watched.ends(&*info));
        // what a faked display is shown, Monado shows as its own kind does
        let shown = if fault().0 == "no-opaque" { (*info).blended(fakes::OPAQUE) } else { *info };
        type End = unsafe extern "system" fn(u64, *const EndInfo) -> Code;
        let code = END_FRAME.function::<End>()(session, &raw const shown);
        match code {
            0 if strikes("loss-pending-at-end") => LOSS_PENDING,
            0 if strikes("instance-lost-at-end") => ERROR_INSTANCE_LOST,
            code => code,
        }
    }
}

unsafe extern "system" fn wait_image(swapchain: u64, info: *const c_void) -> Code {
    if strikes("image-timeout") {
        return TIMEOUT_EXPIRED;
    }
    unsafe { WAIT_IMAGE.function::<unsafe extern "system" fn(u64, *const c_void) -> Code>()(swapchain, info) }
}

unsafe extern "system" fn locate_views(
    session: u64,
    info: *const c_void,
    state: *mut c_void,
    capacity: u32,
    count: *mut u32,
    views: *mut c_void,
) -> Code {
    type Locate =
        unsafe extern "system" fn(u64, *const c_void, *mut c_void, u32, *mut u32, *mut c_void) -> Code;
    if strikes("session-lost-at-locate") {
        return ERROR_SESSION_LOST;
    }
    unsafe {
        let code = LOCATE_VIEWS.function::<Locate>()(session, info, state, capacity, count, views);
        if code >= 0 && capacity > 0 {
            let found = std::slice::from_raw_parts(views.cast::<Located>(), *count as usize);
            watch(|watched| watched.located(&*info.cast(), found));
        }
        code
    }
}
