//! Frames of a crowd that is simulated elsewhere. Its snapshots come to the device that draws; a frame is one submission,
//! from the newest snapshot to the last pixel.

use super::show::{READ, animation, check, kernels, no_failures, surface};
use super::{CrowdBuffers, Error, Image, Renderer, Settings, Show, Target, View};
use crate::gpu::{Device, Engine};
use crate::kernels::{BufferId, Store};
use crate::scenario::EnvironmentMesh;
use crate::sim::bodies::MeshBuffers;
use glam::Vec3;
use std::sync::Arc;

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
        format: ash::vk::Format,
    ) -> Result<Self, crate::Error> {
        let animator = Engine::new(device, store, &kernels(store))?;
        let mut renderer = Renderer::with_format(device, settings, format)?;
        renderer.set_meshes(meshes)?;
        renderer.set_environment(&[surface(scenery)])?;
        Ok(Self::joined(renderer, Some(animator), store))
    }

    /// What a frame needs of a crowd's state.
    pub(crate) fn snapshot(store: &Store) -> Store {
        let mut snapshot = Store {
            position: store.position.clone(),
            stance: store.stance.clone(),
            phase: store.phase.clone(),
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
        if let Some(animator) = self.animator.as_mut().filter(|_| self.taken != number) {
            // what is empty stays as it is: the heights of people on even ground, and feelings that do not change
            let [position, stance, phase, elevation] = READ;
            let felt = [BufferId::GaitWeights, BufferId::Appearance];
            animator.bring(snapshot, &[position, stance, phase, elevation, felt[0], felt[1]])?;
            self.taken = number;
            self.kept.keep(time);
        }
        Ok(())
    }

    /// Draws the crowd at a time between the snapshots taken last into images of the caller; returns the copy that `target`
    /// asks for.
    pub(crate) fn draw_into(
        &mut self,
        view: &View,
        user_eyes: Vec3,
        times: DrawTimes,
        target: &Target,
    ) -> Result<Option<Image>, crate::Error> {
        let DrawTimes { shown, seconds } = times;
        let time = self.time.unwrap_or(0.0) + f64::from(seconds);
        self.time = Some(time);
        let frame = self.frame_of(view, Some(user_eyes), seconds, time);
        let between = self.kept.between(shown, frame.agent_count);
        let Some(animator) = &mut self.animator else { return Ok(None) };
        let (ops, contents) = animation(frame, between);
        let mut words = no_failures();
        animator.want_report(&words, &[BufferId::Failure])?;
        let crowd = CrowdBuffers::of(animator)?;
        let before = |commands| Ok(animator.encode(commands, &ops, contents)?);
        let drawn = self.renderer.draw_into(view, Some(&crowd), target, before);
        let image = drawn.map_err(|error| match error {
            Error::Gpu(error) => Error::Gpu(Engine::named(error, &ops)),
            other => other,
        })?;
        animator.encoded();
        animator.report(&mut words);
        check(&words)?;
        Ok(image)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "a test")]
mod tests {
    use super::super::target::{COLOR_FORMAT, EyeImages, GpuImage, ImageSpec};
    use super::super::{Camera, View};
    use super::*;
    use crate::avatar::{self, Sex};
    use crate::gpu::instance::{AroundSubmission, Maker, Own};
    use crate::gpu::{self, Validation, for_tests};
    use crate::library::GaitLibrary;
    use crate::scenario::{Scenario, populate_from};
    use crate::sim::snapshots::make_room;
    use crate::sim::{AvatarSet, bodies, setup};
    use ash::vk;
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
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT;
        let spec = ImageSpec { layers: 2, usage, ..ImageSpec::flat("test", [SIDE; 2], COLOR_FORMAT) };
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
            let settings = Settings { eyes: 2, ..Settings::sized(SIDE, SIDE) };
            let mut show =
                Show::on_device(&device, &store, &meshes, &scenery, settings, COLOR_FORMAT).unwrap();
            let mut pictures = Vec::new();
            // a snapshot, the same again, and one in which all agents are elsewhere
            for (number, bytes) in [(1_u32, 20 * agents as usize), (1, 0), (2, 20 * agents as usize)] {
                let before = counter.submissions.load(Ordering::Relaxed);
                show.take(&Show::snapshot(&store), number.into(), number.into()).unwrap();
                assert_eq!(show.animator.as_ref().unwrap().brought_bytes(), bytes, "{agents}, {number}");
                let drawn = show.draw_into(&view, Vec3::Y, TIMES, &target(&image, true)).unwrap();
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
        let error = show.draw_into(&view, Vec3::Y, TIMES, &target(&image, false)).unwrap_err();
        assert!(error.to_string().contains("cull") && error.to_string().contains('7'), "{error}");
    }
}
