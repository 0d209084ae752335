//! What the frames of a session say of time, place, depth and blending.

use std::ffi::c_void;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// What the frames of a session say of time and place. One line to the file that `GAITWAY_FRAMES` names with each picture:
/// how many there were, how many different poses their left eyes had, the fewest columns of one, and the first fault.
#[derive(Default)]
pub(super) struct Watched {
    /// What xrWaitFrame predicted last, ns.
    pub(super) display: i64,
    /// Display time, space, and pose and field of view of each eye, as xrLocateViews gave them last.
    views: Option<(i64, u64, Vec<[u32; 11]>)>,
    pictures: u32,
    poses: std::collections::BTreeSet<[u32; 11]>,
    columns: Option<i32>,
    fault: Option<String>,
}

/// Pose and field of view, bit for bit.
fn bits(pose: &[f32; 7], fov: &[f32; 4]) -> [u32; 11] {
    std::array::from_fn(|i| if i < 7 { pose[i].to_bits() } else { fov[i - 7].to_bits() })
}

impl Watched {
    fn wrong(&mut self, what: String) {
        self.fault.get_or_insert(what);
    }

    pub(super) fn located(&mut self, info: &LocateInfo, views: &[Located]) {
        if info.time != self.display {
            self.wrong(format!("views located for {} ns, display predicted for {}", info.time, self.display));
        }
        self.views =
            Some((info.time, info.space, views.iter().map(|view| bits(&view.pose, &view.fov)).collect()));
    }

    pub(super) unsafe fn ends(&mut self, info: &EndInfo) {
        if info.time != self.display {
            self.wrong(format!("frame ends for {} ns, display predicted for {}", info.time, self.display));
        }
        for layer in 0..info.count as usize {
            let layer = unsafe { &**info.layers.add(layer) };
            if layer.kind != PROJECTION {
                continue;
            }
            let views = unsafe { std::slice::from_raw_parts(layer.views, layer.count as usize) };
            let shown: Vec<[u32; 11]> = views.iter().map(|view| bits(&view.pose, &view.fov)).collect();
            if self.views.as_ref() != Some(&(info.time, layer.space, shown.clone())) {
                self.wrong(format!("picture {} is of other views than were located for it", self.pictures));
            }
            let columns = views.iter().map(|view| view.image.rect[2]).min();
            self.columns = self.columns.into_iter().chain(columns).min();
            self.pictures += 1;
            self.poses.extend(shown.first());
        }
        let fault = self.fault.as_deref().unwrap_or("none");
        let (pictures, poses, columns) = (self.pictures, self.poses.len(), self.columns.unwrap_or_default());
        let told = format!("{pictures} pictures, {poses} poses, {columns} columns, fault: {fault}\n");
        if let Some(file) = std::env::var_os("GAITWAY_FRAMES") {
            let _ = std::fs::write(file, told);
        }
    }
}

pub(super) fn watch(look: impl FnOnce(&mut Watched)) {
    static WATCHED: Mutex<Option<Watched>> = Mutex::new(None);
    look(WATCHED.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_default());
}

#[repr(C)]
pub(super) struct FrameState {
    kind: u32,
    next: *const c_void,
    pub(super) display: i64,
}

#[repr(C)]
pub(super) struct LocateInfo {
    kind: u32,
    next: *const c_void,
    configuration: u32,
    time: i64,
    space: u64,
}

#[repr(C)]
pub(super) struct Located {
    kind: u32,
    next: *const c_void,
    pose: [f32; 7],
    fov: [f32; 4],
}

#[repr(C)]
#[derive(Clone, Copy)]
pub(super) struct EndInfo {
    kind: u32,
    next: *const c_void,
    time: i64,
    blend: u32,
    count: u32,
    layers: *const *const Projection,
}

impl EndInfo {
    pub(super) fn has_picture(&self) -> bool {
        self.count > 0
    }

    pub(super) fn blended(&self, blend: u32) -> Self {
        Self { blend, ..*self }
    }
}

#[repr(C)]
pub(super) struct Projection {
    kind: u32,
    next: *const c_void,
    flags: u64,
    space: u64,
    count: u32,
    views: *const View,
}

#[repr(C)]
pub(super) struct SubImage {
    swapchain: u64,
    rect: [i32; 4],
    layer: u32,
}

#[repr(C)]
pub(super) struct View {
    kind: u32,
    next: *const Depth,
    pose: [f32; 7],
    fov: [f32; 4],
    image: SubImage,
}

#[repr(C)]
pub(super) struct Depth {
    kind: u32,
    next: *const c_void,
    image: SubImage,
    min: f32,
    max: f32,
    near: f32,
    far: f32,
}

/// Type numbers of the layers, as in `openxr.h`.
const PROJECTION: u32 = 35;
const DEPTH: u32 = 1_000_010_000;

/// Writes what the first frame with a picture says of its images and of blending into the file that `GAITWAY_SEEN` names.
pub(super) unsafe fn look_at(info: *const EndInfo) {
    static LOOKED: AtomicU64 = AtomicU64::new(0);
    let Some(file) = std::env::var_os("GAITWAY_SEEN") else { return };
    unsafe {
        if (*info).count == 0 || LOOKED.swap(1, Ordering::Relaxed) != 0 {
            return;
        }
        let layer = *(*info).layers;
        let mut text = format!("blend {}\n", (*info).blend);
        for view in (0..(*layer).count as usize).filter(|_| (*layer).kind == PROJECTION) {
            let View { image, next: depth, .. } = &*(*layer).views.add(view);
            let is_first = image.swapchain == (*(*layer).views).image.swapchain;
            let swapchain = if is_first { "first" } else { "another" };
            let [_, _, width, height] = image.rect;
            text += &format!("colour of layer {} of the {swapchain}, {width}x{height}\n", image.layer);
            let depth = *depth;
            if depth.is_null() || (*depth).kind != DEPTH {
                text += "no depth\n";
                continue;
            }
            let Depth { image, min, max, near, far, .. } = &*depth;
            let [_, _, width, height] = image.rect;
            text += &format!("depth {min} {max} {near} {far} of layer {}, {width}x{height}\n", image.layer);
        }
        let _ = std::fs::write(file, text);
    }
}
