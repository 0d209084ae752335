//! Answers of runtimes that are not Monado: what they hide, offer and refuse.

use super::{Behind, Code, ERROR_FEATURE_UNSUPPORTED, GET_PROC, GetProc, strikes};
use std::ffi::{c_char, c_void};
use std::fmt::Write as _;
use std::io::Write as _;
use std::mem::transmute;

static MASK: Behind = Behind::new();
static FORMATS: Behind = Behind::new();
static BLEND: Behind = Behind::new();
static SWAPCHAIN: Behind = Behind::new();
static SUGGEST: Behind = Behind::new();

/// The runtime's function of that name, and ours, where there is one here.
pub(super) fn ours(name: &[u8]) -> Option<(&'static Behind, *const c_void)> {
    Some(match name {
        b"xrGetVisibilityMaskKHR" => (&MASK, mask as *const c_void),
        b"xrEnumerateSwapchainFormats" => (&FORMATS, formats as *const c_void),
        b"xrEnumerateEnvironmentBlendModes" => (&BLEND, blend_modes as *const c_void),
        b"xrCreateSwapchain" => (&SWAPCHAIN, create_swapchain as *const c_void),
        b"xrSuggestInteractionProfileBindings" => (&SUGGEST, suggest as *const c_void),
        _ => return None,
    })
}

#[repr(C)]
struct MaskInfo {
    kind: u32,
    next: *const c_void,
    vertex_capacity: u32,
    vertex_count: u32,
    vertices: *mut [f32; 2],
    index_capacity: u32,
    index_count: u32,
    indices: *mut u32,
}

/// A mask of one triangle that hides the outer part of each eye's picture, from half a metre beside the middle of a plane one
/// metre away.
unsafe extern "system" fn mask(session: u64, views: u32, eye: u32, kind: u32, info: *mut MaskInfo) -> Code {
    type Get = unsafe extern "system" fn(u64, u32, u32, u32, *mut MaskInfo) -> Code;
    if !strikes("mask") {
        return unsafe { MASK.function::<Get>()(session, views, eye, kind, info) };
    }
    let side = if eye == 0 { -1.0 } else { 1.0 };
    let corners = [[0.5 * side, 9.0], [0.5 * side, -9.0], [9.0 * side, 0.0]];
    unsafe {
        ((*info).vertex_count, (*info).index_count) = (3, 3);
        if (*info).vertex_capacity >= 3 && (*info).index_capacity >= 3 {
            for (index, corner) in corners.into_iter().enumerate() {
                (*info).vertices.add(index).write(corner);
                (*info).indices.add(index).write(index as u32);
            }
        }
    }
    0
}

/// Without the format of our depth.
unsafe extern "system" fn formats(session: u64, capacity: u32, count: *mut u32, found: *mut i64) -> Code {
    type Enumerate = unsafe extern "system" fn(u64, u32, *mut u32, *mut i64) -> Code;
    const D32: i64 = 126;
    unsafe {
        let code = FORMATS.function::<Enumerate>()(session, capacity, count, found);
        if strikes("no-depth-format") && code == 0 && capacity > 0 {
            for index in 0..*count as usize {
                let format = found.add(index);
                if *format == D32 {
                    *format = 0;
                }
            }
        }
        code
    }
}

pub(super) const OPAQUE: u32 = 1;
const ADDITIVE: u32 = 2;
const ALPHA_BLEND: u32 = 3;

/// `no-opaque`: a display that one can see through. `opaque-last`: one that likes the room behind its pictures best.
unsafe extern "system" fn blend_modes(
    instance: u64,
    system: u64,
    views: u32,
    capacity: u32,
    count: *mut u32,
    modes: *mut u32,
) -> Code {
    type Enumerate = unsafe extern "system" fn(u64, u64, u32, u32, *mut u32, *mut u32) -> Code;
    let faked: &[u32] = match (strikes("no-opaque"), strikes("opaque-last")) {
        (true, _) => &[ADDITIVE],
        (_, true) => &[ALPHA_BLEND, OPAQUE],
        _ => {
            return unsafe { BLEND.function::<Enumerate>()(instance, system, views, capacity, count, modes) };
        }
    };
    unsafe {
        *count = faked.len() as u32;
        if capacity as usize >= faked.len() {
            modes.copy_from_nonoverlapping(faked.as_ptr(), faked.len());
        }
    }
    0
}

#[repr(C)]
struct SwapchainInfo {
    kind: u32,
    next: *const c_void,
    create: u64,
    usage: u64,
    format: i64,
    samples: u32,
    width: u32,
    height: u32,
    faces: u32,
    layers: u32,
    mips: u32,
}

/// `no-layers`: no images of two layers.
unsafe extern "system" fn create_swapchain(session: u64, info: *const SwapchainInfo, out: *mut u64) -> Code {
    type Create = unsafe extern "system" fn(u64, *const SwapchainInfo, *mut u64) -> Code;
    unsafe {
        if (*info).layers > 1 && strikes("no-layers") {
            return ERROR_FEATURE_UNSUPPORTED;
        }
        SWAPCHAIN.function::<Create>()(session, info, out)
    }
}

#[repr(C)]
struct Suggested {
    kind: u32,
    next: *const c_void,
    profile: u64,
    count: u32,
    bindings: *const [u64; 2],
}

/// Adds a line to the file that `GAITWAY_SUGGESTED` names: what the runtime answered, the profile, the bindings.
unsafe extern "system" fn suggest(instance: u64, info: *const Suggested) -> Code {
    type Suggest = unsafe extern "system" fn(u64, *const Suggested) -> Code;
    unsafe {
        let code = SUGGEST.function::<Suggest>()(instance, info);
        if let Some(file) = std::env::var_os("GAITWAY_SUGGESTED") {
            let mut line = format!("{code} {}", text(instance, (*info).profile));
            for [_, path] in std::slice::from_raw_parts((*info).bindings, (*info).count as usize) {
                let _ = write!(line, " {}", text(instance, *path));
            }
            let file = std::fs::OpenOptions::new().create(true).append(true).open(file);
            let _ = file.and_then(|mut file| writeln!(file, "{line}"));
        }
        code
    }
}

/// The text of a path.
unsafe fn text(instance: u64, path: u64) -> String {
    type ToString = unsafe extern "system" fn(u64, u64, u32, *mut u32, *mut c_char) -> Code;
    let (mut found, mut length, mut bytes) = (None, 0, [0; 256]);
    unsafe {
        let code = GET_PROC.function::<GetProc>()(instance, c"xrPathToString".as_ptr(), &raw mut found);
        let Some(found) = found.filter(|_| code == 0) else { return "?".to_owned() };
        let to_string = transmute::<super::Function, ToString>(found);
        if to_string(instance, path, 256, &raw mut length, bytes.as_mut_ptr()) != 0 {
            return "?".to_owned();
        }
        std::ffi::CStr::from_ptr(bytes.as_ptr()).to_string_lossy().into_owned()
    }
}
