//! Rust twins of the structs that buffers hold. Every field's offset and size is checked against the WGSL when
//! the crate is built.

use bytemuck::{Pod, Zeroable};

/// Size of a field, from a function that borrows it (used by the generated layout checks).
#[allow(clippy::needless_pass_by_value, reason = "a function pointer, used in const context only")]
pub(crate) const fn field_size<T, F>(_: fn(&T) -> &F) -> usize {
    size_of::<F>()
}

/// Parameters of one simulation step; units and meaning stand in `shaders/shared/step.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "documented beside the WGSL twin, where the fields are declared")]
pub struct StepUniforms {
    pub agent_count: u32,
    pub step_index: u32,
    pub seed: u32,
    pub cell_count: u32,
    pub grid_columns: u32,
    pub grid_rows: u32,
    pub grid_origin: [f32; 2],
    pub cell_size: f32,
    pub inverse_cell_size: f32,
    pub time_step: f32,
    pub inverse_time_step: f32,
    pub storey_height: f32,
    pub inverse_time_horizon_obstacles: f32,
    pub user_position: [f32; 2],
    pub user_velocity: [f32; 2],
    pub user_radius: f32,
    pub obstacle_count: u32,
    pub turn_rate: f32,
    pub perturbation: f32,
    pub walk_speed: f32,
    pub blend_rate: f32,
    pub time_horizon_obstacles: f32,
    pub responsibility: f32,
    pub safety_margin: f32,
    pub inverse_time_horizon_dense: f32,
    pub inverse_time_horizon_jam: f32,
    pub model: u32,
    pub collision_weight: f32,
    pub max_acceleration: f32,
    pub patience: f32,
    pub source_count: u32,
    pub queue_count: u32,
    pub wrap: f32,
    pub led_count: u32,
    pub crowding: f32,
    pub crowding_reach: f32,
    pub group_count: u32,
    pub floor_count: u32,
    pub reaction_steps: u32,
    pub feels: u32,
    pub path_count: u32,
    pub teleport_count: u32,
    pub alike: u32,
    pub user_elevation: f32,
    pub padding: u32,
}

/// The flow grid; units and meaning stand in `shaders/shared/way.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "documented beside the WGSL twin, where the fields are declared")]
pub struct FlowUniforms {
    pub origin: [f32; 2],
    pub cell_size: f32,
    pub inverse_cell_size: f32,
    pub columns: u32,
    pub rows: u32,
    pub cell_count: u32,
    pub tile_columns: u32,
    pub tile_rows: u32,
    pub field_count: u32,
    pub seed_count: u32,
    pub window: u32,
    pub density_weight: f32,
    pub solid_step: f32,
    pub every: u32,
    pub sheet_rows: u32,
    pub joint_count: u32,
    pub unused_a: u32,
    pub unused_b: u32,
    pub unused_c: u32,
}

/// How feelings change; units and meaning stand in `shaders/shared/mood.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "documented beside the WGSL twin, where the fields are declared")]
pub struct MoodUniforms {
    pub radius: f32,
    pub contagion: f32,
    pub decay: f32,
    pub event_count: u32,
}

/// Two snapshots of a crowd; units and meaning stand in `shaders/shared/between.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "documented beside the WGSL twin, where the fields are declared")]
pub struct BetweenUniforms {
    pub agent_count: u32,
    pub newest: u32,
    pub share: f32,
    pub reach: f32,
}

/// Parameters of one picture; units and meaning stand in `shaders/shared/frame.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "documented beside the WGSL twin, where the fields are declared")]
pub struct FrameUniforms {
    pub planes: [[f32; 4]; 12],
    pub user_eyes: [f32; 4],
    pub camera: [f32; 4],
    pub level_distance: [f32; 4],
    pub standing_clips: [[u32; 4]; 4],
    pub agent_count: u32,
    pub eye_count: u32,
    pub level_count: u32,
    pub bucket_count: u32,
    pub visible_capacity: u32,
    pub near_capacity: u32,
    pub frame_index: u32,
    pub gaze_mode: u32,
    pub frame_time: f32,
    pub agent_height: f32,
    pub agent_radius: f32,
    pub clip_count: u32,
    pub gaze_limit: u32,
    pub gaze_time: u32,
    pub turn_least: u32,
    pub turn_most: u32,
}

/// What hides people in a pass of a picture; units and meaning stand in `shaders/shared/sight.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "documented beside the WGSL twin, where the fields are declared")]
pub struct SightUniforms {
    pub clip_from_world: [[[f32; 4]; 4]; 2],
    pub bounds: [[[f32; 4]; 2]; 32],
    pub width: f32,
    pub height: f32,
    pub eye_count: u32,
    pub tile_width: u32,
    pub tile_height: u32,
    pub tile_columns: u32,
    pub tile_rows: u32,
    pub first_bucket: u32,
    pub bucket_end: u32,
    pub start_shift: u32,
    pub fewest: u32,
    pub eye_height: f32,
}

/// A rounded solid; meaning and units stand in `shaders/draw/user.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "documented beside the WGSL twin, where the fields are declared")]
pub struct Solid {
    pub x: [f32; 4],
    pub y: [f32; 4],
    pub z: [f32; 4],
    pub color: [f32; 4],
}

/// What pictures show of the user; meaning and units stand in `shaders/draw/user.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "documented beside the WGSL twin, where the fields are declared")]
pub struct UserUniforms {
    pub solids: [Solid; 64],
    pub target_place: [f32; 4],
    pub target_color: [f32; 4],
    pub vignette: [f32; 4],
}

/// Parameters of one picture for the draw shaders; units and meaning stand in `shaders/shared/view.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
#[allow(missing_docs, reason = "documented beside the WGSL twin, where the fields are declared")]
pub struct ViewUniforms {
    pub clip_from_world: [[[f32; 4]; 4]; 2],
    pub world_from_clip: [[[f32; 4]; 4]; 2],
    pub eyes: [[f32; 4]; 2],
    pub shadow_from_world: [[f32; 4]; 4],
    pub sun_direction: [f32; 4],
    pub sun_color: [f32; 4],
    pub sky_zenith: [f32; 4],
    pub sky_light: [f32; 4],
    pub sky_horizon: [f32; 4],
    pub ground_bounce: [f32; 4],
    pub emotion_colors: [[f32; 4]; 4],
    pub fade: [[f32; 4]; 5],
    pub level_count: u32,
    pub bucket_count: u32,
    pub marker_radius: f32,
    pub marker_width: f32,
    pub far_count: u32,
    pub samples: u32,
    pub pad1: u32,
    pub pad2: u32,
}
