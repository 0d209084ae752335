//! A simulation and a renderer joined: frames of a crowd in motion.
//!
//! [`Show::draw`] animates the bodies that a view sees (`cull` to `skin`) and draws them from the buffers that the
//! kernels wrote. A crowd that is simulated on the CPU is animated on the renderer's device, from its state.

#[cfg(feature = "view")]
use super::Target;
use super::{CrowdBuffers, Image, Renderer, Settings, View};
#[cfg(feature = "xr")]
use crate::gpu::FRAMES_IN_FLIGHT;
use crate::gpu::plan::Op;
use crate::gpu::{Device, Engine, Validation};
use crate::kernels::layout::{BetweenUniforms, FrameUniforms};
use crate::kernels::{BufferId, Dispatch, KernelId, Phase, Store};
use crate::scenario::{EnvironmentMesh, Gaze};
use crate::sim::bodies::{self, FAR_PIXELS, LEVEL_DISTANCES, MeshBuffers, SPECK_PIXELS};
#[cfg(any(feature = "xr", feature = "view"))]
use crate::sim::snapshots::Snapshots;
use crate::sim::{self, Simulation, order};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Time step of the gaze in the first frame, s.
const FIRST_FRAME_TIME: f32 = 1.0 / 30.0;

/// Height of a person, m.
const PERSON: f32 = 1.7;
/// Pixels of a metre at a metre's distance in frames of 720 rows and 50 degrees, for which the level distances are meant.
const FULL_FOCAL: f32 = 772.0;
/// In larger frames the levels change at most so many times as far away.
const LARGEST: f32 = 2.0;
/// Agents nearer than this have a pose, however small the image, m: lod3 and lod4 bodies do not gaze.
const POSED: f32 = 20.0;
/// Agents nearer than this are drawn in the finest level, which fades near the eyes, however small the image, m.
const LEAST: f32 = 2.5;

/// What the animation reads of a crowd's state.
pub(super) const READ: [BufferId; 4] =
    [BufferId::Position, BufferId::Heading, BufferId::Stance, BufferId::Elevation];

/// Draws a simulation.
#[derive(Debug)]
pub struct Show {
    /// Goes first: it waits for frames that the device still draws from the animator's buffers.
    pub(super) renderer: Renderer,
    /// Animates a crowd that is simulated on the CPU.
    pub(super) animator: Option<Engine>,
    /// What does not depend on the camera.
    pub(super) frame: FrameUniforms,
    pub(super) time: Option<f64>,
    /// Number of the snapshot that the animator has.
    #[cfg(feature = "xr")]
    pub(super) taken: u64,
    #[cfg(any(feature = "xr", feature = "view"))]
    pub(super) kept: KeptSnapshots,
    /// The kernels of the frames that were not waited for yet, by slot.
    #[cfg(feature = "xr")]
    pub(super) in_flight: [Vec<Op>; FRAMES_IN_FLIGHT],
    /// How long the animator's kernels ran since they were last asked for, if they are timed.
    times: Option<Vec<(Phase, f64)>>,
}

/// The two snapshots between which frames lie.
#[cfg(any(feature = "xr", feature = "view"))]
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct KeptSnapshots {
    times: Snapshots,
    /// The slot in which the next frame keeps the newest snapshot.
    next_slot: Option<u32>,
    /// Whether the device has room for two snapshots.
    has_room: bool,
}

#[cfg(any(feature = "xr", feature = "view"))]
impl KeptSnapshots {
    /// Has the next frame keep the present snapshot, of this time, s.
    pub(super) fn keep(&mut self, time: f64) {
        self.next_slot = self.has_room.then(|| self.times.keep(time));
    }

    /// The parameters of a time between the two, and the slot to keep the newest in; none without room.
    pub(super) fn between(&mut self, shown: f64, agents: u32) -> Option<Between> {
        let slot = self.next_slot.take();
        self.has_room.then(|| (self.times.at(shown, agents), slot))
    }
}

/// Parameters of a time between two snapshots, and the slot in which the newest is kept first.
pub(super) type Between = (BetweenUniforms, Option<u32>);

/// The kernels of a frame.
pub(super) fn kernels(store: &Store) -> Vec<KernelId> {
    let mut kernels: Vec<KernelId> =
        order::frame_dispatches(&store.frame).iter().map(Dispatch::kernel).collect();
    // agents may have to take turns later, and may be seen from afar
    kernels.extend([KernelId::GazeSchedule, KernelId::PoseFar]);
    kernels.extend([KernelId::Occlude, KernelId::OcclusionCompact]);
    if !store.snapshots.is_empty() {
        kernels.extend([KernelId::KeepSnapshot, KernelId::Interpolate]);
    }
    kernels.sort_unstable();
    kernels.dedup();
    kernels
}

/// Draws this scenery from now on.
pub(super) fn set_scenery(renderer: &mut Renderer, scenery: &EnvironmentMesh) -> Result<(), super::Error> {
    renderer.set_scenery(scenery)?;
    renderer.set_place(scenery.place.as_deref())
}

/// The kernels that prepare the bodies for a frame, and the contents of their uniforms. `between` shows a time between two
/// snapshots instead of the newest.
pub(super) fn animation(
    frame: FrameUniforms,
    between: Option<Between>,
) -> (Vec<Op>, impl Fn(usize, BufferId) -> Vec<u8>) {
    let mut ops = vec![Op::Set(BufferId::Frame)];
    if let Some((between, keep)) = &between {
        ops.push(Op::Set(BufferId::Between));
        ops.extend(order::between_dispatches(between.agent_count, *keep).into_iter().map(Op::Dispatch));
    }
    ops.extend(order::frame_dispatches(&frame).into_iter().map(Op::Dispatch));
    let contents = move |_, buffer| match (buffer, &between) {
        (BufferId::Between, Some((between, _))) => bytemuck::bytes_of(between).to_vec(),
        _ => bytemuck::bytes_of(&frame).to_vec(),
    };
    (ops, contents)
}

impl Show {
    /// A show of a simulation. [`crate::sim::bodies::fill`] has filled its store and gave `meshes`.
    ///
    /// `device` is a name or index as for [`Device::open`]; a simulation on Vulkan is shown on its own device.
    ///
    /// # Errors
    /// When there is no usable device, memory is short, or a size is beyond the device.
    pub fn new(
        simulation: &mut Simulation,
        meshes: &MeshBuffers,
        scenery: &EnvironmentMesh,
        settings: Settings,
        device: Option<&str>,
    ) -> Result<Self, crate::Error> {
        let device = match simulation.engine() {
            Some(engine) => engine.device().clone(),
            None => Device::open(device, Validation::from_environment()?)?,
        };
        Self::with_device(simulation, meshes, scenery, settings, &device)
    }

    /// The same on a device that is open already: the simulation's own, if it is on Vulkan.
    pub(crate) fn with_device(
        simulation: &mut Simulation,
        meshes: &MeshBuffers,
        scenery: &EnvironmentMesh,
        settings: Settings,
        device: &Arc<Device>,
    ) -> Result<Self, crate::Error> {
        let animator = if simulation.engine().is_some() {
            None
        } else {
            let store = simulation.state()?;
            Some(Engine::new(device, store, &kernels(store))?)
        };
        let mut renderer = Renderer::new(device, settings)?;
        renderer.set_meshes(meshes)?;
        set_scenery(&mut renderer, scenery)?;
        Ok(Self::joined(renderer, animator, simulation.store()))
    }

    pub(super) fn joined(renderer: Renderer, animator: Option<Engine>, store: &Store) -> Self {
        Self {
            renderer,
            animator,
            frame: store.frame,
            time: None,
            #[cfg(feature = "xr")]
            taken: 0,
            #[cfg(any(feature = "xr", feature = "view"))]
            kept: KeptSnapshots { has_room: !store.snapshots.is_empty(), ..KeptSnapshots::default() },
            #[cfg(feature = "xr")]
            in_flight: Default::default(),
            times: None,
        }
    }

    /// The device that draws, in words.
    pub fn device(&self) -> String {
        self.renderer.device().describe()
    }

    /// Times the kernels that the show runs itself, or stops: those of a crowd that is simulated on the CPU. For others see
    /// [`Simulation::measure_times`].
    #[cfg(feature = "view")]
    pub(crate) fn measure_times(&mut self, is_on: bool) {
        self.times = is_on.then(Vec::new);
    }

    /// The timed kernels and how long each ran since the last call, ms.
    #[cfg(feature = "view")]
    pub(crate) fn take_times(&mut self) -> Vec<(Phase, f64)> {
        self.times.as_mut().map(std::mem::take).unwrap_or_default()
    }

    /// The renderer, to change its settings.
    pub fn renderer(&mut self) -> &mut Renderer {
        &mut self.renderer
    }

    /// Distances at which levels of detail end, and at which agents are no longer drawn, m: `[first, second, farthest]`.
    /// They hold for an image of 720 rows, 50 degrees and high quality. In smaller images and those of less quality the levels come
    /// nearer, in larger ones they are up to twice as far. The distance of lod3 follows the second (see [`bodies::LEVEL_DISTANCES`]).
    pub fn set_level_distances(&mut self, [first, second, farthest]: [f32; 3]) {
        self.frame.level_distance = [first, second, farthest, 0.0];
    }

    /// Which formulas move the gaze, and how many agents look at the user at a time.
    pub fn set_gaze(&mut self, gaze: &Gaze) {
        bodies::set_gaze(&mut self.frame, gaze);
    }

    /// Draws the crowd as it is now. Agents that gaze look at `user_eyes` (world frame, m).
    ///
    /// # Errors
    /// When the device fails.
    pub fn draw(
        &mut self,
        simulation: &mut Simulation,
        view: &View,
        user_eyes: impl Into<Option<Vec3>>,
    ) -> Result<Image, crate::Error> {
        self.prepare_between(simulation, view, user_eyes.into(), simulation.time(), None)?;
        let engine = self.animator.as_ref().or(simulation.engine());
        let crowd = engine.map(CrowdBuffers::of).transpose()?;
        Ok(self.renderer.draw(view, crowd.as_ref())?)
    }

    /// Draws a frame and leaves it on the device: for timings.
    pub(crate) fn make(
        &mut self,
        simulation: &mut Simulation,
        view: &View,
        user_eyes: impl Into<Option<Vec3>>,
    ) -> Result<(), crate::Error> {
        self.prepare_between(simulation, view, user_eyes.into(), simulation.time(), None)?;
        let engine = self.animator.as_ref().or(simulation.engine());
        let crowd = engine.map(CrowdBuffers::of).transpose()?;
        self.renderer.draw_offscreen(view, crowd.as_ref(), false)?;
        Ok(())
    }

    /// Draws the crowd at time `shown`, s, between the times of the last two calls, into images of the caller. Returns the copy
    /// that `target` asks for.
    #[cfg(feature = "view")]
    pub(crate) fn draw_between(
        &mut self,
        simulation: &mut Simulation,
        view: &View,
        user_eyes: Vec3,
        shown: f64,
        target: &Target,
    ) -> Result<Option<Image>, crate::Error> {
        let time = simulation.time();
        if self.kept.times.newest() != Some(time) {
            self.kept.keep(time);
        }
        let between = self.kept.between(shown, self.frame.agent_count);
        self.prepare_between(simulation, view, Some(user_eyes), shown, between)?;
        let engine = self.animator.as_ref().or(simulation.engine());
        let crowd = engine.map(CrowdBuffers::of).transpose()?;
        let image = self.renderer.draw_into(view, crowd.as_ref(), target)?;
        if let Some((between, _)) = between.filter(|_| self.animator.is_none()) {
            simulation.restore(between)?;
        }
        Ok(image)
    }

    /// Animates the bodies that a view sees.
    pub(crate) fn prepare(
        &mut self,
        simulation: &mut Simulation,
        view: &View,
        user_eyes: Vec3,
    ) -> Result<(), crate::Error> {
        self.prepare_between(simulation, view, Some(user_eyes), simulation.time(), None)
    }

    /// Like [`Show::prepare`], at time `shown`, s: now, or between two snapshots.
    fn prepare_between(
        &mut self,
        simulation: &mut Simulation,
        view: &View,
        user_eyes: Option<Vec3>,
        shown: f64,
        between: Option<Between>,
    ) -> Result<(), crate::Error> {
        let frame = self.next_frame(simulation, view, user_eyes, shown)?;
        if let Some(animator) = &mut self.animator {
            let store = simulation.state()?;
            animator.upload(store, &READ)?;
            if store.step.feels != 0 {
                animator.upload(store, &[BufferId::GaitWeights, BufferId::Appearance])?;
            }
            let (ops, contents) = animation(frame, between);
            let measured = animator.run(&ops, contents, self.times.is_some())?;
            if let Some(times) = &mut self.times {
                times.extend(measured.iter().map(|time| (time.dispatch.phase, time.milliseconds)));
            }
            let mut words = no_failures();
            animator.download(&mut words, &[BufferId::Failure])?;
            check(&words)
        } else if let Some((between, keep)) = between {
            simulation.animate_between(frame, between, keep)
        } else {
            simulation.animate(frame)
        }
    }

    /// Parameters of a frame at `time`, `seconds` after the last one, s.
    pub(super) fn frame_of(
        &mut self,
        view: &View,
        user_eyes: Option<Vec3>,
        seconds: f32,
        time: f64,
    ) -> FrameUniforms {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "wraps after 49 days")]
        {
            self.frame.gaze_time = (time * 1e3) as u64 as u32;
        }
        self.frame.frame_index = self.frame.frame_index.wrapping_add(1);
        let (level_distance, lod4) =
            level_distances(view, self.renderer.settings(), self.frame.level_distance);
        self.renderer.third_begins = level_distance[1];
        FrameUniforms {
            level_distance,
            planes: view.planes(),
            camera: view.center().extend(lod4).to_array(),
            eye_count: view.eye_count,
            frame_time: seconds,
            ..bodies::looking_at(self.frame, user_eyes)
        }
    }

    /// Parameters of the next frame of a simulation, which shows it at time `shown`, s.
    fn next_frame(
        &mut self,
        simulation: &mut Simulation,
        view: &View,
        user_eyes: Option<Vec3>,
        shown: f64,
    ) -> Result<FrameUniforms, crate::Error> {
        #[allow(clippy::cast_possible_truncation, reason = "a short time")]
        let since = self.time.map_or(FIRST_FRAME_TIME, |before| (shown - before).max(0.0) as f32);
        self.time = Some(shown);
        let mut frame = self.frame_of(view, user_eyes, since, shown);
        if view.parallel {
            // a map shows all agents equally large, however high its camera stands
            let away = view.center().y;
            let [_, second, farthest, _] = &mut frame.level_distance;
            *second += away;
            *farthest += away;
        }
        // lod3 and lod4 bodies have room for all agents
        let [.., farthest, lod3] = &mut frame.level_distance;
        if frame.visible_capacity < frame.agent_count && *lod3 == 0.0 {
            let store = simulation.state()?;
            let nearest = nearest(store, view.center(), frame.visible_capacity as usize, frame.agent_height);
            *farthest = farthest.min(nearest);
        }
        Ok(frame)
    }
}

/// Level distances `[first, second, farthest, lod3]` of a view in an image with these settings, and that of lod4, m.
///
/// The first two are meant for frames of [`FULL_FOCAL`]. In smaller frames they come nearer, and in larger ones they go farther, up to
/// [`LARGEST`] times, so that people are as many pixels high where they change. Lod3 begins where people are [`FAR_PIXELS`] high,
/// lod4 at [`SPECK_PIXELS`]; both come nearer as the second level does. That is so at high quality; at others all but lod4 begin
/// nearer. On a map no agent (0) or every agent has them.
pub(crate) fn level_distances(
    view: &View,
    settings: &Settings,
    [first, second, farthest, _]: [f32; 4],
) -> ([f32; 4], f32) {
    let focal = view.focal(settings.height);
    if view.parallel {
        let all_below = |pixels| if PERSON * focal < pixels { f32::MIN_POSITIVE } else { 0.0 };
        return ([first, second, farthest, all_below(FAR_PIXELS)], all_below(SPECK_PIXELS));
    }
    let share = (focal / FULL_FOCAL).min(LARGEST);
    let reach = settings.quality.reach();
    let scaled = |distance: f32, reach: f32| (distance * share * reach).max(distance.min(LEAST));
    let (near, middle) = (scaled(first, reach.first), scaled(second, reach.second));
    let high = |pixels: f32| PERSON * focal / pixels * (second / LEVEL_DISTANCES[1]);
    let far = (high(FAR_PIXELS) * reach.posed).max(middle).max(POSED);
    ([near, middle, farthest, far], high(SPECK_PIXELS).max(far))
}

/// A distance within which no more than `count` agents stand, measured as `cull` does, m.
fn nearest(store: &Store, eye: Vec3, count: usize, height: f32) -> f32 {
    let eye_ground = crate::ground::ground_from_world(eye);
    let agents = store.step.agent_count as usize;
    let mut distances: Vec<f32> = store.position[..agents]
        .iter()
        .zip(&store.elevation)
        .map(|(p, foot)| {
            let away = eye.y - foot;
            let lowest = (away - 0.6 * height).abs().min((away - 0.4 * height).abs());
            Vec2::from_array(*p).distance(eye_ground).hypot(lowest)
        })
        .collect();
    if count >= distances.len() {
        return f32::INFINITY;
    }
    // a centimetre short of the first one that has no room
    let (_, first_out, _) = distances.select_nth_unstable_by(count, f32::total_cmp);
    (*first_out - 0.01).max(0.0)
}

/// Room for the failure words of a frame.
pub(super) fn no_failures() -> Store {
    Store { failure: vec![u32::MAX; KernelId::ALL.len()], ..Store::default() }
}

/// What the words say.
pub(super) fn check(words: &Store) -> Result<(), crate::Error> {
    for kernel in KernelId::ALL {
        let agent = words.failure.get(kernel as usize).copied().unwrap_or(u32::MAX);
        if agent != u32::MAX {
            return Err(sim::Error::Failure { kernel: kernel.kernel().name, agent }.into());
        }
    }
    Ok(())
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "limits are exact")]
mod tests {
    use super::*;
    use crate::render::{Camera, Quality};

    #[test]
    fn levels_change_where_people_have_the_same_height_in_pixels_whatever_the_picture() {
        let camera = Camera::user_eyes(Vec3::Y, 0.0, 0.0);
        let full = [8.0, 20.0, 2000.0, 0.0];
        let [at, of_medium] = [Quality::High, Quality::Medium].map(|quality| {
            move |rows| {
                let settings = Settings { quality, ..Settings::sized(rows, rows) };
                level_distances(&View::mono(&camera, rows, rows), &settings, full).0
            }
        });
        let [first, second, farthest, far] = at(720);
        assert!((first - 8.0).abs() < 0.01 && (second - 20.0).abs() < 0.01 && farthest == 2000.0);
        assert!((far - 82.0).abs() < 0.5, "{far}: 1.7 m of 772 pixels a metre are 16 there");
        let half = at(360);
        assert!((half[0] - 4.0).abs() < 0.01 && (half[3] - far / 2.0).abs() < 0.1, "{half:?}");
        let large = at(1440);
        assert!((large[0] - 16.0).abs() < 0.02 && (large[1] - 40.0).abs() < 0.02, "{large:?}");
        assert_eq!(at(4320)[..2], [16.0, 40.0], "and no farther");
        assert!((large[3] - far * 2.0).abs() < 0.1);
        let medium = of_medium(720);
        assert!((medium[0] - 6.0).abs() < 0.01 && (medium[1] - 12.0).abs() < 0.01, "{medium:?}");
        assert!(medium[2] == farthest && (medium[3] - 0.75 * far).abs() < 0.01, "{medium:?}");
        assert_eq!((at(8)[0], at(8)[3]), (LEAST, POSED));
        // the governor brings the far bodies nearer together with the second level
        let view = View::mono(&camera, 720, 720);
        let sized = Settings { quality: Quality::High, ..Settings::sized(720, 720) };
        let (poor, lod4) = level_distances(&view, &sized, [4.0, 10.0, 900.0, 0.0]);
        assert!((lod4 - poor[3] * 16.0 / 7.0).abs() < 0.1);
        assert!((poor[3] - far / 2.0).abs() < 0.1);
        // a map: all agents or none
        let map =
            |height| level_distances(&View::mono(&Camera::top(Vec2::ZERO, height), 720, 720), &sized, full);
        let all = f32::MIN_POSITIVE;
        let of = |height| (map(height).0[3], map(height).1);
        assert_eq!((of(20.0), of(100.0), of(400.0)), ((0.0, 0.0), (all, 0.0), (all, all)));
    }
}
