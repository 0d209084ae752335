//! Watches a crowd: the joints of every body as drawn, frame by frame.

use super::Track;
use crate::emotion::Emotion;
use crate::gait::{JOINT_COUNT, Joint, Pose, Recording};
use crate::kernels::layout::FrameUniforms;
use crate::kernels::shared::body::NONE;
use crate::kernels::shared::body::index::PALETTE_STRIDE;
use crate::kernels::{BufferId, Store};
use crate::scenario::{GazeMode, Scenario};
use crate::sim::{AvatarSet, Simulation, bodies};
use glam::{Vec3, Vec4};

/// Time before the recording in which the gaze settles, s.
const SETTLING: f32 = 1.0;
/// Distance within which every agent has a pose, m.
const FAR: f32 = 1e9;
/// Most bytes of joint positions that are kept.
const MOST_BYTES: u64 = 4 << 30;

/// How a crowd is watched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recorder {
    /// Steps before the recording begins.
    pub warm_up: u32,
    /// Steps that are recorded, one frame each.
    pub steps: u32,
    /// The user's eyes, at which agents look; world, m. None: there is no user.
    pub user_eyes: Option<Vec3>,
    /// Whether the gaze follows the paper's formulas to the letter.
    pub paper_gaze: bool,
}

impl Recorder {
    /// After `warm_up` steps, `steps` frames of a scenario's crowd, which looks at the user where the scenario has it.
    pub fn of(scenario: &Scenario, warm_up: u32, steps: u32) -> Self {
        Self {
            warm_up,
            steps,
            user_eyes: scenario.geometry().eyes(scenario),
            paper_gaze: scenario.gaze.mode == GazeMode::Paper,
        }
    }
}

/// Steps a simulation and records every agent. The simulation's buffers must have been filled for drawing
/// ([`crate::sim::bodies::fill`]) with the avatars of `cast`. `progress` receives the fraction done, 0 to 1.
///
/// # Errors
/// When the device or a kernel fails, or more agents are to be recorded than one picture shows or memory holds.
pub fn record(
    simulation: &mut Simulation,
    cast: &AvatarSet,
    how: &Recorder,
    progress: &mut dyn FnMut(f64),
) -> Result<Vec<Track>, crate::Error> {
    let frame = everyone(simulation.store().frame, how);
    let agents = frame.agent_count;
    check_size(&frame, how.steps)?;
    let mut tracks = start(simulation.store());
    if agents == 0 {
        return Ok(tracks);
    }
    let rest: Vec<[Vec3; JOINT_COUNT]> = cast.avatars().iter().map(rest_joints).collect();
    let time_step = simulation.store().step.time_step;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a second of steps")]
    let settling = ((SETTLING / time_step).ceil() as u32).min(how.warm_up);
    simulation.step(how.warm_up - settling)?;
    let frames = settling + how.steps;
    for index in 0..frames {
        simulation.step(1)?;
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "wraps after 49 days")]
        let gaze_time = (simulation.time() * 1e3) as u64 as u32;
        let shown = FrameUniforms { frame_index: index + 1, frame_time: time_step, gaze_time, ..frame };
        simulation.animate(shown)?;
        if index >= settling {
            let store = simulation.read(&[BufferId::Visible, BufferId::Palettes, BufferId::Stance])?;
            take(store, &rest, &mut tracks);
        }
        progress(f64::from(index + 1) / f64::from(frames));
    }
    Ok(tracks)
}

/// Parameters of a frame in which every agent is visible and none is near enough to be skinned. The palette, from which all
/// levels of detail are drawn, does not depend on the level.
fn everyone(frame: FrameUniforms, how: &Recorder) -> FrameUniforms {
    FrameUniforms {
        planes: [[0.0, 0.0, 0.0, 1.0]; 12], // inside everywhere
        eye_count: 1,
        level_distance: [0.0, 0.0, FAR, 0.0],
        near_capacity: 0,
        gaze_mode: u32::from(how.paper_gaze),
        camera: how.user_eyes.unwrap_or_default().extend(0.0).to_array(),
        ..bodies::looking_at(frame, how.user_eyes)
    }
}

fn check_size(frame: &FrameUniforms, steps: u32) -> Result<(), crate::Error> {
    let refused = |message: String, hint: &str| crate::Error::Usage { message, hint: hint.to_owned() };
    if frame.agent_count > frame.visible_capacity {
        let (found, most) = (frame.agent_count, frame.visible_capacity);
        let message = format!("{found} agents are to be watched; one picture shows {most}");
        return Err(refused(message, "use fewer agents (--agents)"));
    }
    let bytes = u64::from(frame.agent_count) * u64::from(steps) * size_of::<Pose>() as u64;
    if bytes > MOST_BYTES {
        let message = format!(
            "{} agents over {steps} frames are {} MiB of joint positions; at most {} MiB are kept",
            frame.agent_count,
            bytes >> 20,
            MOST_BYTES >> 20
        );
        return Err(refused(message, "use fewer agents (--agents) or seconds (--seconds)"));
    }
    Ok(())
}

/// Empty tracks of all agents.
fn start(store: &Store) -> Vec<Track> {
    let agents = store.step.agent_count as usize;
    let rate = 1.0 / store.step.time_step;
    let track = |agent: usize| {
        let emotion = store.appearance[agent].emotion() as usize;
        Track {
            wanted: Emotion::ALL[emotion.min(3)],
            preferred_speed: store.body[agent].preferred_speed,
            recording: Recording::new(format!("agent {agent}"), rate, Vec::new()),
            phase: Vec::new(),
        }
    };
    (0..agents).map(track).collect()
}

/// Where each joint is in the mesh's space at rest, m: the origin of the inverse of `joint_from_mesh`.
fn rest_joints(avatar: &crate::avatar::Avatar) -> [Vec3; JOINT_COUNT] {
    avatar.joints.map(|joint| joint.joint_from_mesh.inverse().w_axis.truncate())
}

/// Adds one frame to the tracks of all visible agents. An agent that no kernel could draw gets none.
fn take(store: &Store, rest: &[[Vec3; JOINT_COUNT]], tracks: &mut [Track]) {
    let slots = store.visible.iter().zip(store.palettes.chunks_exact(PALETTE_STRIDE));
    for (&agent, palette) in slots.take_while(|(agent, _)| **agent != NONE) {
        let agent = agent as usize;
        let (Some(track), Some(own)) = (tracks.get_mut(agent), store.appearance.get(agent)) else {
            continue;
        };
        let Some(rest) = rest.get(own.avatar() as usize) else { continue };
        let pose: Pose = std::array::from_fn(|joint| {
            let rows: [Vec4; 3] = std::array::from_fn(|axis| Vec4::from(palette[3 * joint + axis]));
            let at = rest[joint].extend(1.0);
            Vec3::new(rows[0].dot(at), rows[1].dot(at), rows[2].dot(at))
        });
        debug_assert!(pose[Joint::Root as usize].is_finite(), "agent {agent} is nowhere");
        track.recording.poses.push(pose);
        let phase = store.stance[agent].phase;
        let unwrapped = match track.phase.last() {
            // the phase only ever advances
            Some(&before) => {
                #[allow(clippy::cast_possible_truncation, reason = "the low word is the phase itself")]
                let before_wrapped = before as u32;
                before + u64::from(phase.wrapping_sub(before_wrapped))
            }
            None => u64::from(phase),
        };
        track.phase.push(unwrapped);
    }
}
