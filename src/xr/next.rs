//! The world that comes next, made ready on a thread of its own while frames go on.

use super::failure::{Failure, no_thread, panicked};
use super::session::Session;
use super::surroundings::Surroundings;
use super::views;
use crate::gpu::Device;
use crate::render::{Settings, Show, Stereo, View};
use ash::vk;
use std::sync::Arc;
use std::thread::{self, JoinHandle};

/// What a show is made for: the device and the images of a session.
#[derive(Clone)]
pub(super) struct Venue {
    device: Arc<Device>,
    size: [u32; 2],
    stereo: Stereo,
    format: vk::Format,
    /// Whether the lenses hide a part of the images.
    hides: bool,
}

impl Venue {
    /// That of a session.
    pub(super) fn of(device: &Arc<Device>, session: &mut Session) -> Self {
        Self {
            device: device.clone(),
            size: session.size(),
            stereo: session.stereo(),
            format: session.format(),
            hides: session.hidden().triangles() != [0; 2],
        }
    }

    /// What draws the frames of a world, ready to draw the first, which is seen by `view`.
    pub(super) fn show(&self, world: &Surroundings, view: &View) -> Result<Show, crate::Error> {
        let [width, height] = self.size;
        let settings = Settings { width, height, eyes: 2, stereo: self.stereo, ..world.settings };
        let Surroundings { store, meshes, scenery, gaze, .. } = world;
        let mut show = Show::on_device(&self.device, store, meshes, scenery, settings, self.format)?;
        show.set_gaze(gaze);
        show.set_level_distances(world.level_distances);
        show.warm_up(store, view, self.hides)?;
        Ok(show)
    }
}

/// The world that comes next. Dropped, it waits for the thread, whose work is on the session's device.
#[derive(Default)]
pub(super) struct Next {
    loading: Option<Loading>,
    ready: Option<(Arc<Surroundings>, Show)>,
}

struct Loading {
    world: Arc<Surroundings>,
    thread: JoinHandle<Result<Show, crate::Error>>,
}

impl Next {
    /// Begins to make a world ready, unless that is done or under way. One at a time: another one waits for its turn.
    pub(super) fn prepare(&mut self, world: &Arc<Surroundings>, venue: &Venue) -> Result<(), Failure> {
        let is_ready = self.ready.as_ref().is_some_and(|(ready, _)| ready.number == world.number);
        if is_ready || self.loading.is_some() {
            return Ok(());
        }
        self.ready = None;
        let (venue, shown) = (venue.clone(), world.clone());
        let load =
            move || venue.show(&shown, &views::at_start(super::rig::Rig::new(shown.start).world_from_room()));
        let thread = thread::Builder::new().name("next world".to_owned()).spawn(load);
        let thread = thread.map_err(|error| Failure::Fatal(no_thread(&error)))?;
        self.loading = Some(Loading { world: world.clone(), thread });
        Ok(())
    }

    /// The number of the world that is ready; looks whether the thread is done.
    pub(super) fn look(&mut self) -> Result<Option<u64>, Failure> {
        if let Some(Loading { world, thread }) = self.loading.take_if(|loading| loading.thread.is_finished())
        {
            let made = thread.join().unwrap_or_else(|_| Err(panicked("that makes a world ready")));
            self.ready = Some((world, made?));
        }
        Ok(self.ready.as_ref().map(|(world, _)| world.number))
    }

    /// The world that is ready, if it is that one.
    pub(super) fn take(&mut self, number: u64) -> Option<(Arc<Surroundings>, Show)> {
        self.ready.take_if(|(world, _)| world.number == number)
    }
}

impl Drop for Next {
    fn drop(&mut self) {
        if let Some(loading) = self.loading.take() {
            let _ = loading.thread.join();
        }
    }
}
