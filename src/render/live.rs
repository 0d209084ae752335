//! Frames of a crowd that is simulated elsewhere. Its snapshots come to the device that draws; a frame is one submission,
//! from the newest snapshot to the last pixel. The device draws a frame while the host prepares the next one.

use super::commands::Commands;
use super::show::{READ, animation, check, kernels, no_failures, set_scenery};
use super::target::{EyeImages, GpuImage, ImageSpec};
use super::{
    CrowdBuffers, Error, Hand, HandKind, Image, Renderer, Settings, Show, Target, Teleport, User, View,
};
use crate::gpu::plan::Op;
use crate::gpu::{Device, Engine, FRAMES_IN_FLIGHT};
use crate::kernels::{Access, BufferId, Store};
use crate::scenario::EnvironmentMesh;
use crate::sim::bodies::MeshBuffers;
use ash::vk;
use glam::{Quat, Vec3};
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

/// The times of a frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DrawTimes {
    /// When the crowd was as it is shown, s of the clock of [`Show::take`].
    pub(crate) shown: f64,
    /// Time since the frame before, s.
    pub(crate) seconds: f32,
}

impl Show {
    /// A show on a device of the caller, of a crowd that is simulated elsewhere: [`Show::take`] brings its snapshots.
    pub(crate) fn on_device(
        device: &Arc<Device>,
        store: &Store,
        meshes: &MeshBuffers,
        scenery: &EnvironmentMesh,
        settings: Settings,
        format: vk::Format,
    ) -> Result<Self, crate::Error> {
        let animator = Engine::new(device, store, &kernels(store))?;
        let mut renderer = Renderer::with_format(device, settings, format)?;
        renderer.set_meshes(meshes)?;
        set_scenery(&mut renderer, scenery)?;
        Ok(Self::joined(renderer, Some(animator), store))
    }

    /// What a frame needs of a crowd's state.
    pub(crate) fn snapshot(store: &Store) -> Store {
        let mut snapshot = Store {
            position: store.position.clone(),
            heading: store.heading.clone(),
            stance: store.stance.clone(),
            ..Store::default()
        };
        if store.step.floor_count != 0 {
            snapshot.elevation.clone_from(&store.elevation);
        }
        if store.step.feels != 0 {
            snapshot.gait_weights.clone_from(&store.gait_weights);
            snapshot.appearance.clone_from(&store.appearance);
        }
        snapshot
    }

    /// Takes a snapshot of the crowd at its `time`, s, unless it has that one already. Snapshots are numbered from 1.
    pub(crate) fn take(&mut self, snapshot: &Store, number: u64, time: f64) -> Result<(), crate::Error> {
        self.make_room()?; // the snapshot goes into memory of the next frame's slot
        if let Some(animator) = self.animator.as_mut().filter(|_| self.taken != number) {
            // what is empty stays as it is: the heights of people on even ground, and feelings that do not change
            let [position, heading, stance, elevation] = READ;
            let felt = [BufferId::GaitWeights, BufferId::Appearance];
            let slot = self.renderer.slot();
            animator.bring(slot, snapshot, &[position, heading, stance, elevation, felt[0], felt[1]])?;
            self.taken = number;
            self.kept.keep(time);
        }
        Ok(())
    }

    /// Draws a frame that is shown nowhere, with everything that frames may have: drivers compile a pipeline when it is first
    /// drawn with, which may take seconds. The show is then as it was before. `store` is the crowd's start; `hides` says
    /// whether lenses hide a part of the images.
    pub(crate) fn warm_up(&mut self, store: &Store, view: &View, hides: bool) -> Result<(), crate::Error> {
        let Settings { width, height, eyes, .. } = *self.renderer.settings();
        let format = self.renderer.format.color;
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT;
        let spec =
            ImageSpec { layers: eyes, usage, ..ImageSpec::flat("first frame", [width, height], format) };
        let color = GpuImage::new(self.renderer.device(), spec)?;
        let images = EyeImages::layered(color.raw);
        let target = Target { color: images, view: color.view, depth: None, is_copied: false };
        let before = (self.frame, self.time, self.kept);
        self.renderer.set_user(everything(view));
        if hides {
            self.renderer.set_mask(&[[0.0, 0.0, 1.0, 1.0]; 6])?; // a triangle without an area for each eye
        }
        self.take(&Self::snapshot(store), u64::MAX, 0.0)?;
        let now = DrawTimes { shown: 0.0, seconds: 0.0 };
        let drawn =
            self.submit(view, view.center(), now, &target, |_| Ok(())).and_then(|()| self.finish(false));
        self.renderer.forget_images();
        drawn?;
        self.renderer.set_user(User::default());
        (self.frame, self.time, self.kept) = before;
        self.taken = 0;
        let Some(animator) = &mut self.animator else { return Ok(()) };
        let phases = kernels(store).into_iter().flat_map(|kernel| kernel.kernel().phases);
        let bindings = phases.flat_map(|phase| phase.entry().bindings);
        let written: BTreeSet<BufferId> = bindings
            .filter(|binding| binding.access == Access::Write)
            .map(|binding| binding.buffer)
            .collect();
        Ok(animator.upload(store, &written.into_iter().collect::<Vec<_>>())?)
    }

    /// Waits until there is room for another frame: until the device has drawn the frame before last. Returns how long that
    /// took it; none where there was no such frame, or it cannot be known.
    pub(crate) fn make_room(&mut self) -> Result<Option<Duration>, crate::Error> {
        let slot = self.renderer.slot();
        let ops = std::mem::take(&mut self.in_flight[slot]);
        let took = self.renderer.make_room().map_err(named(&ops))?;
        self.check_frame(slot, &ops)?;
        Ok(took)
    }

    /// Has the device draw the crowd at a time between the snapshots taken last into images of the caller, and does not wait for
    /// it. What `after` records comes last in the same submission.
    pub(crate) fn submit(
        &mut self,
        view: &View,
        user_eyes: Vec3,
        times: DrawTimes,
        target: &Target,
        after: impl FnOnce(&Commands<'_>) -> Result<(), Error>,
    ) -> Result<(), crate::Error> {
        self.make_room()?;
        let DrawTimes { shown, seconds } = times;
        let time = self.time.unwrap_or(0.0) + f64::from(seconds);
        self.time = Some(time);
        let frame = self.frame_of(view, Some(user_eyes), seconds, time);
        let between = self.kept.between(shown, frame.agent_count);
        let slot = self.renderer.slot();
        let Some(animator) = &mut self.animator else { return Ok(()) };
        let (ops, contents) = animation(frame, between);
        animator.want_report(slot, &no_failures(), &[BufferId::Failure])?;
        let crowd = CrowdBuffers::of(animator)?;
        let before = |commands| Ok(animator.encode(slot, commands, &ops, contents)?);
        let submitted = self.renderer.submit_into(view, Some(&crowd), target, before, after);
        submitted.map_err(named(&ops))?;
        animator.encoded(slot);
        self.in_flight[slot] = ops;
        Ok(())
    }

    /// Waits for all frames. Returns the copy of the newest if that is wanted, and it was copied.
    pub(crate) fn finish(&mut self, is_wanted: bool) -> Result<Option<Image>, crate::Error> {
        let frames = std::mem::take(&mut self.in_flight);
        let newest = frames[(self.renderer.slot() + FRAMES_IN_FLIGHT - 1) % FRAMES_IN_FLIGHT].as_slice();
        let image = self.renderer.finish(is_wanted).map_err(named(newest))?;
        for (slot, ops) in frames.iter().enumerate() {
            self.check_frame(slot, ops)?;
        }
        Ok(image)
    }

    /// Reads the failure words of a frame that was waited for.
    fn check_frame(&self, slot: usize, ops: &[Op]) -> Result<(), crate::Error> {
        let Some(animator) = self.animator.as_ref().filter(|_| !ops.is_empty()) else { return Ok(()) };
        let mut words = no_failures();
        animator.report(slot, &mut words);
        check(&words)
    }
}

/// All that frames may show of a user.
fn everything(view: &View) -> User {
    let place = view.center();
    let hand = Hand { place, turn: Quat::IDENTITY, kind: HandKind::Controller };
    let teleport = Teleport { from: place, to: place - Vec3::Y, is_allowed: true };
    User { hands: [Some(hand); 2], joints: [None; 2], teleport: Some(teleport), vignette: 1.0, fade: 0.0 }
}

/// An error of a frame with these operations.
fn named(ops: &[Op]) -> impl FnOnce(Error) -> Error + '_ {
    move |error| match error {
        Error::Gpu(error) => Error::Gpu(Engine::named(error, ops)),
        other => other,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "a test")]
mod tests {
    use super::super::target::COLOR_FORMAT;
    use super::super::{Camera, Draws};
    use super::*;
    use crate::avatar::{self, Sex};
    use crate::gpu::instance::{AroundSubmission, Maker, Own};
    use crate::gpu::{self, Validation, for_tests};
    use crate::kernels::layout::Stance;
    use crate::library::GaitLibrary;
    use crate::scenario::{Scenario, populate_from};
    use crate::sim::snapshots::make_room;
    use crate::sim::{AvatarSet, bodies, setup};
    use std::sync::atomic::{AtomicU32, Ordering};

    const SIDE: u32 = 64;

    /// Makes devices that count their submissions.
    #[derive(Default)]
    struct Counter {
        submissions: Arc<AtomicU32>,
    }

    impl Maker for Counter {
        unsafe fn instance(
            &self,
            entry: &ash::Entry,
            create: &vk::InstanceCreateInfo<'_>,
        ) -> Result<vk::Instance, gpu::Error> {
            // SAFETY: as the caller promises.
            unsafe { Own.instance(entry, create) }
        }

        fn physical_device(&self, instance: vk::Instance) -> Result<Option<vk::PhysicalDevice>, gpu::Error> {
            Own.physical_device(instance)
        }

        fn around_submission(&self) -> Option<AroundSubmission> {
            let submissions = self.submissions.clone();
            Some(Box::new(move |submit| {
                submissions.fetch_add(1, Ordering::Relaxed);
                submit();
            }))
        }

        unsafe fn device(
            &self,
            entry: &ash::Entry,
            instance: &ash::Instance,
            physical: vk::PhysicalDevice,
            create: &vk::DeviceCreateInfo<'_>,
        ) -> Result<vk::Device, gpu::Error> {
            // SAFETY: as the caller promises.
            unsafe { Own.device(entry, instance, physical, create) }
        }
    }

    fn image(device: &Arc<Device>) -> GpuImage {
        image_of(device, SIDE)
    }

    fn image_of(device: &Arc<Device>, side: u32) -> GpuImage {
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT;
        let spec = ImageSpec { layers: 2, usage, ..ImageSpec::flat("test", [side; 2], COLOR_FORMAT) };
        GpuImage::readable(device, spec).unwrap()
    }

    fn target(image: &GpuImage, is_copied: bool) -> Target {
        Target { color: EyeImages::layered(image.raw), view: image.view, depth: None, is_copied }
    }

    const TIMES: DrawTimes = DrawTimes { shown: 9.0, seconds: 0.02 };

    fn crowd(agents: u32) -> (Store, MeshBuffers, EnvironmentMesh) {
        let library = GaitLibrary::built_in().unwrap();
        let scenario = Scenario::builtin("crossing").unwrap().with_agents(agents);
        let people = populate_from(&scenario, &library).unwrap();
        let cast = AvatarSet::new(library.gaits(), Sex::ALL.map(avatar::generated).to_vec()).unwrap();
        let geometry = scenario.geometry();
        let mut store = setup::store(&scenario, &geometry, &people, &cast);
        let meshes = bodies::fill(&mut store, &cast, bodies::SMALLEST_STORAGE_RANGE);
        make_room(&mut store);
        (store, meshes, geometry.scenery())
    }

    #[test]
    fn a_picture_is_one_submission_and_brings_a_new_moment_and_nothing_else() {
        let counter = Counter::default();
        let Some(device) = for_tests::device() else { return };
        let wanted = device.info().index.to_string();
        let validation = Validation::from_environment().unwrap();
        drop(device);
        let device = Device::made_by(&counter, &gpu::Wanted::of(Some(&wanted)), validation).unwrap();
        let image = image(&device);
        let camera = Camera::look_at(Vec3::new(0.0, 30.0, 20.0), Vec3::ZERO, Vec3::Y);
        let view = View { eye_count: 2, ..View::mono(&camera, SIDE, SIDE) };
        for agents in [30, 300] {
            let (mut store, meshes, scenery) = crowd(agents);
            let settings = Settings { eyes: 2, draws: Draws::Indirect, ..Settings::sized(SIDE, SIDE) };
            let mut show =
                Show::on_device(&device, &store, &meshes, &scenery, settings, COLOR_FORMAT).unwrap();
            let mut pictures = Vec::new();
            // a snapshot, the same again, and one in which all agents are elsewhere
            // place, heading and stance of each agent
            let moment = agents as usize * (size_of::<[f32; 2]>() + size_of::<f32>() + size_of::<Stance>());
            for (number, bytes) in [(1_u32, moment), (1, 0), (2, moment)] {
                let before = counter.submissions.load(Ordering::Relaxed);
                show.take(&Show::snapshot(&store), number.into(), number.into()).unwrap();
                assert_eq!(show.animator.as_ref().unwrap().brought_bytes(), bytes, "{agents}, {number}");
                show.submit(&view, Vec3::Y, TIMES, &target(&image, true), |_| Ok(())).unwrap();
                let drawn = show.finish(true).unwrap();
                let after = counter.submissions.load(Ordering::Relaxed);
                assert_eq!(after - before, 1, "{agents}, {number}");
                assert_eq!(show.animator.as_ref().unwrap().brought_bytes(), 0);
                pictures.push(drawn.unwrap());
                if number == 1 && pictures.len() == 2 {
                    for place in &mut store.position {
                        place[0] += 500.0;
                    }
                }
            }
            let [first, same, other] = &pictures[..] else { panic!("three pictures") };
            let differ =
                |a: &Image, b: &Image| a.pixels.iter().zip(&b.pixels).filter(|(a, b)| a != b).count();
            assert!(differ(first, other) > 20 + 4 * differ(first, same), "the new snapshot is what is seen");
        }
        drop((image, device));
        for_tests::assert_silent();
    }

    #[test]
    fn failures_that_kernels_report_end_the_show() {
        let Some(device) = for_tests::device() else { return };
        let image = image(&device);
        let view = View { eye_count: 2, ..View::mono(&Camera::user_eyes(Vec3::Y, 0.0, 0.0), SIDE, SIDE) };
        let (mut store, meshes, scenery) = crowd(9);
        store.failure[crate::kernels::KernelId::Cull as usize] = 7;
        let settings = Settings { eyes: 2, ..Settings::sized(SIDE, SIDE) };
        let mut show = Show::on_device(&device, &store, &meshes, &scenery, settings, COLOR_FORMAT).unwrap();
        show.submit(&view, Vec3::Y, TIMES, &target(&image, false), |_| Ok(())).unwrap();
        let error = show.finish(false).unwrap_err();
        assert!(error.to_string().contains("cull") && error.to_string().contains('7'), "{error}");
    }

    /// A show of a crowd, and that crowd as it is in one step after the other.
    fn walking(device: &Arc<Device>, agents: u32, side: u32) -> (Show, Store, Vec<Store>) {
        walking_as(device, agents, Settings::sized(side, side))
    }

    fn walking_as(device: &Arc<Device>, agents: u32, settings: Settings) -> (Show, Store, Vec<Store>) {
        let (store, meshes, scenery) = crowd(agents);
        let settings = Settings { eyes: 2, ..settings };
        let show = Show::on_device(device, &store, &meshes, &scenery, settings, COLOR_FORMAT).unwrap();
        let moved = |step: u8| {
            let mut moved = Show::snapshot(&store);
            moved.position.iter_mut().for_each(|place| place[0] += 0.2 * f32::from(step));
            moved
        };
        let steps = (0..6).map(moved).collect();
        (show, store, steps)
    }

    fn view_of(side: u32) -> View {
        let camera = Camera::look_at(Vec3::new(0.0, 1.7, 9.0), Vec3::new(0.0, 1.2, 0.0), Vec3::Y);
        View { eye_count: 2, ..View::mono(&camera, side, side) }
    }

    /// The last picture of a crowd that walks. `waits` for each frame, or lets them overlap.
    fn last_picture(device: &Arc<Device>, image: &GpuImage, waits: bool, warms_up: bool) -> Image {
        last_picture_of(walking(device, 200, SIDE), image, waits, warms_up)
    }

    fn last_picture_of(
        (mut show, store, steps): (Show, Store, Vec<Store>),
        image: &GpuImage,
        waits: bool,
        warms_up: bool,
    ) -> Image {
        let view = view_of(SIDE);
        if warms_up {
            show.warm_up(&store, &view, true).unwrap();
        }
        for (number, step) in (1_u32..).zip(&steps) {
            let now = 0.03 * f64::from(number);
            show.take(step, number.into(), now).unwrap();
            let times = DrawTimes { shown: now - 0.02, seconds: 0.03 };
            show.submit(&view, Vec3::Y, times, &target(image, true), |_| Ok(())).unwrap();
            if waits {
                show.finish(false).unwrap();
            }
        }
        show.finish(true).unwrap().unwrap()
    }

    #[test]
    fn frames_that_overlap_show_what_frames_one_after_the_other_show() {
        let Some(device) = for_tests::device() else { return };
        let image = image(&device);
        let [apart, overlapping, warmed_up] = [(true, false), (false, false), (false, true)]
            .map(|(waits, warms_up)| last_picture(&device, &image, waits, warms_up));
        assert!(apart == overlapping, "what overlaps is mixed up");
        assert!(apart == warmed_up, "the picture that nobody saw has left something");
        drop((image, device));
        for_tests::assert_silent();
    }

    #[test]
    fn frames_that_are_drawn_directly_show_what_others_show() {
        let Some(device) = for_tests::device() else { return };
        let image = image(&device);
        let [indirect, direct] = [Draws::Indirect, Draws::Direct].map(|draws| {
            let settings = Settings { draws, ..Settings::sized(SIDE, SIDE) };
            last_picture_of(walking_as(&device, 200, settings), &image, false, true)
        });
        assert!(indirect == direct, "people are missing, or elsewhere");
        drop((image, device));
        for_tests::assert_silent();
    }

    #[test]
    fn the_host_waits_for_the_frame_before_last_and_for_no_other() {
        let Some(device) = for_tests::device() else { return };
        let (mut show, _, steps) = walking(&device, 100, SIDE);
        let (view, image) = (view_of(SIDE), image(&device));
        let in_flight = |show: &Show| show.renderer.flights.count();
        let submit = |show: &mut Show, number: u8| {
            show.take(&steps[usize::from(number)], number.into(), 0.03 * f64::from(number)).unwrap();
            show.submit(&view, Vec3::Y, TIMES, &target(&image, false), |_| Ok(())).unwrap();
        };
        assert_eq!(show.make_room().unwrap(), None, "there was no frame");
        submit(&mut show, 1);
        assert_eq!(in_flight(&show), 1);
        assert_eq!(show.make_room().unwrap(), None, "there is room for a second one");
        submit(&mut show, 2);
        assert_eq!(in_flight(&show), 2);
        let took = show.make_room().unwrap();
        assert!(took.is_some_and(|took| took > Duration::from_micros(100)), "{took:?}");
        assert_eq!((in_flight(&show), show.make_room().unwrap()), (1, None), "the first was waited for");
        submit(&mut show, 3);
        submit(&mut show, 4);
        assert_eq!(in_flight(&show), 2, "who needs room makes it");
        show.finish(false).unwrap();
        assert_eq!(in_flight(&show), 0);
        submit(&mut show, 5);
        drop((show, image, device)); // which waits
        for_tests::assert_silent();
    }

    #[test]
    fn a_part_of_an_image_shows_what_a_small_image_shows() {
        const LARGE: u32 = 101;
        let Some(device) = for_tests::device() else { return };
        let view = view_of(SIDE);
        // enough people that some are hidden and left out
        let picture = |side: u32| {
            let (mut show, _, steps) = walking(&device, 1200, side);
            let image = image_of(&device, side);
            show.renderer().set_drawn_size([SIDE; 2]);
            show.take(&steps[0], 1, 0.03).unwrap();
            show.submit(&view, Vec3::Y, TIMES, &target(&image, true), |_| Ok(())).unwrap();
            show.finish(true).unwrap().unwrap()
        };
        let (small, part) = (picture(SIDE), picture(LARGE));
        assert_eq!([small.width, small.height], [2 * SIDE, SIDE]);
        assert!(small == part, "the part shows something else");
        drop(device);
        for_tests::assert_silent();
    }
}
