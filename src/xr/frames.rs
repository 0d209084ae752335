//! The frames of a session: from xrWaitFrame to xrEndFrame.
//!
//! A frame is handed over when its commands are submitted. The device draws it while this thread waits for the next one and
//! prepares it. What the device took for a frame is known two frames later.

use super::Error;
use super::asking::Asking;
use super::failure::Failure;
use super::headset::Headset;
use super::input::{Active, Reading};
use super::panel::place::EyeImage;
use super::plan::Shot;
use super::recording::{UserState, numbers};
use super::rig::{Terrain, Walk};
use super::running::{HostWork, Running, Step};
use super::session::Eyes;
use super::shown::Crowd;
use super::views::{self, Pose};
use super::watch::Watch;
use crate::render::{DrawTimes, Hand, HandKind, Target, User};
use glam::{Mat4, Vec2, Vec3};
use std::time::{Duration, Instant};

impl Headset<'_> {
    /// Waits until it is time for a frame, and hands it over.
    pub(super) fn frame(&mut self, running: &mut Running) -> Result<(), Failure> {
        let shared = self.shared;
        self.heed(running)?;
        let Running { clock, session, .. } = running;
        let frame = shared.call(|| session.wait())?;
        let (woke, waited, watch) = (Instant::now(), session.waited(), Watch::start());
        let Step { seconds, periods, since_ms } = clock.step(&frame, &mut self.times);
        self.fade_on(since_ms * 1e-3);
        let active = match (&self.asking, self.plan.moves) {
            (Some(_), _) => Active::Answer,
            (None, true) => Active::Walk,
            (None, false) => Active::Hands,
        };
        let read = || Ok::<_, Error>((session.read_input(&frame, active)?, session.head(&frame)?));
        let (input, head) = shared.call(read)?;
        if let Some(head) = head {
            self.follow(head, &input, seconds);
        }
        self.answer(&input, head, f64::from(since_ms.max(0.0)) * 1e-3);
        if !frame.wants_image {
            self.times.empty();
            return Ok(shared.call(|| session.end(frame, None, &[]))?);
        }
        self.make_room(running, frame.period)?;
        let Running { clock, show, session, .. } = running;
        let begin = Instant::now();
        let target = shared.call(|| session.acquire())?;
        let snapshot = shared.snapshot();
        if snapshot.world == self.world.number {
            show.take(&snapshot.store, snapshot.number, snapshot.due)?;
        }
        let crowd = Crowd { now: shared.now(), step: snapshot.step, late: snapshot.late };
        let shown = clock.shown.time(frame.display.as_nanos(), &crowd);
        show.set_level_distances(self.governor.distances(self.world.level_distances));
        let size = self.drawn_size(session.size());
        show.renderer().set_drawn_size(size);
        let slot = show.renderer().slot();
        // as late as can be: everything but the eyes' place is ready
        let eyes = shared.call(|| session.locate(&frame))?;
        let shot = match &eyes {
            Some(eyes) => self.draw(running, target, eyes, &input, DrawTimes { shown, seconds })?,
            None => None,
        };
        let Running { session, in_flight, .. } = running;
        let drawn = eyes.as_ref().map(|eyes| (eyes, size));
        let quads = self.asking.as_ref().filter(|_| eyes.is_some()).map_or_else(Vec::new, Asking::quads);
        shared.call(|| session.release().and_then(|()| session.end(frame, drawn, &quads)))?;
        if !quads.is_empty() {
            self.panel_seen(&frame);
        }
        self.times.drew(periods);
        self.report_frame(periods, since_ms);
        let handed_over = begin.elapsed();
        let host = woke.elapsed().saturating_sub(session.waited().saturating_sub(waited));
        self.times.prepared(host, watch.ran());
        in_flight[slot] = eyes.is_some().then_some(HostWork { handed_over, host });
        if let Some((user_eyes, clips)) = shot {
            self.shoot(running, user_eyes, clips)?;
        }
        self.frames += 1;
        Ok(())
    }

    /// Pixels that are drawn of an eye's image of this size: all of them where the user has chosen the size.
    fn drawn_size(&mut self, full: [u32; 2]) -> [u32; 2] {
        if self.plan.eye_size.is_some() {
            return full;
        }
        self.outcome.least_resolution = self.outcome.least_resolution.min(self.governor.resolution());
        self.governor.size(full)
    }

    /// Waits until the device has drawn the frame before last, and takes note of what it took.
    fn make_room(&mut self, running: &mut Running, period: Duration) -> Result<(), Failure> {
        let Running { show, miniature, in_flight, .. } = running;
        let slot = show.renderer().slot();
        let device = show.make_room()?;
        if let (Some(mirror), Some((mut copy, clip))) = (&self.plan.mirror, miniature.take(slot)) {
            let eye = EyeImage { left: 0, size: [copy.width, copy.height], clip };
            self.asking.iter().for_each(|asking| asking.paste(&mut copy, &eye, self.rig.world_from_room()));
            mirror.keep(copy);
        }
        if let Some(HostWork { handed_over, host }) = in_flight[slot].take() {
            self.times.worked(handed_over, device);
            // each has the whole period, since they work at the same time
            self.governor.frame(host.max(device.unwrap_or_default()), period);
            self.outcome.least_quality = self.outcome.least_quality.min(self.governor.quality());
        }
        Ok(())
    }

    /// Hands out what the newest frame showed, once the device has drawn it.
    fn shoot(&mut self, running: &mut Running, user_eyes: Vec3, clips: [Mat4; 2]) -> Result<(), Failure> {
        let mut image = running.show.finish(true)?;
        if let (Some(image), Some(asking)) = (&mut image, &self.asking) {
            let size = [image.width / 2, image.height];
            for (left, clip) in [0, size[0]].into_iter().zip(clips) {
                asking.paste(image, &EyeImage { left, size, clip }, self.rig.world_from_room());
            }
        }
        let faces = running.show.faces(&self.world.store)?;
        if let (Some(image), Some((_, shots))) = (image, &mut self.plan.shots) {
            shots(&Shot { frame: self.frames, image, user_eyes, faces }).map_err(Failure::Fatal)?;
        }
        Ok(())
    }

    /// Moves the user, and hands their state to the crowd.
    fn follow(&mut self, head: Pose, input: &Reading, seconds: f32) {
        let hand = input.hands[1].or(input.hands[0]);
        let terrain = Terrain {
            floors: &self.world.floors,
            is_free: &|place, height| self.world.is_free(place, height),
        };
        let recentres = input.walk.recentres || std::mem::take(&mut self.recentres);
        self.rig.walk(&Walk { recentres, ..input.walk }, head, hand, seconds, &terrain);
        let place = self.rig.user(head);
        let room = self.rig.world_from_room();
        let state = UserState {
            place,
            elevation: self.rig.elevation(),
            velocity: Vec2::ZERO,
            head: Some(numbers(head.within(room))),
            hands: input.hands.map(|hand| hand.map(|hand| numbers(hand.within(room)))),
            sticks: [input.walk.stick.x, input.walk.stick.y, input.walk.turn],
        };
        self.shared.update_user(|before| {
            let velocity = (place - before.place) / seconds.max(1e-3);
            // a teleport or a recentring is no walk
            let velocity = if velocity.length() > 4.0 { Vec2::ZERO } else { velocity };
            UserState { velocity: before.velocity.lerp(velocity, 0.3), ..state }
        });
    }

    /// Has the device draw what the eyes see. Returns the midpoint of the eyes, and clip from world space of each, if this
    /// frame is one of the shots.
    fn draw(
        &mut self,
        running: &mut Running,
        target: Target,
        eyes: &Eyes,
        input: &Reading,
        times: DrawTimes,
    ) -> Result<Option<(Vec3, [Mat4; 2])>, Failure> {
        let small = self.wants_miniature(running)?;
        let slot = running.show.renderer().slot();
        self.bring_panel(running, slot)?;
        let Running { show, session, miniature, .. } = running;
        let view = views::view(eyes.placed, self.rig.world_from_room());
        let middle: Vec3 = (view.eyes[0] + view.eyes[1]) * 0.5;
        let renderer = show.renderer();
        renderer.set_user(self.user(input));
        if let Some(corners) = session.hidden().corners(eyes.placed.map(|(_, fov)| fov)) {
            renderer.set_mask(&corners).map_err(Error::from)?;
            self.outcome.hidden_triangles = session.hidden().triangles();
        }
        let is_copied = self.plan.shots.as_ref().is_some_and(|(every, _)| self.frames.is_multiple_of(*every));
        let drawn = [renderer.settings().width, renderer.settings().height];
        show.submit(&view, middle, times, &Target { is_copied, ..target }, |commands| {
            if small {
                miniature.record(commands, slot, target.color.left(), drawn, view.clip_from_world[0]);
            }
            session.record_panel(commands, slot);
            Ok(())
        })?;
        Ok(is_copied.then_some((middle, view.clip_from_world)))
    }

    /// What the frame shows of the user.
    fn user(&self, input: &Reading) -> User {
        let room = self.rig.world_from_room();
        let held = |grip: Pose| {
            let Pose { rotation: turn, position: place } = grip.within(room);
            Hand { place, turn, kind: HandKind::Controller }
        };
        User {
            hands: input.grips.map(|grip| grip.map(held)),
            joints: input.seen.map(|seen| seen.map(|seen| seen.within(room))),
            teleport: self.rig.teleport_shown(input.hands[1].or(input.hands[0])),
            vignette: self.rig.vignette() * self.plan.vignette,
            fade: self.fade,
        }
    }

    /// Whether this frame is to make a small copy for the mirror, for which there is room then. A copy that has none closes the
    /// mirror and never ends the session.
    fn wants_miniature(&self, running: &mut Running) -> Result<bool, Error> {
        let Running { show, session, miniature, .. } = running;
        let Some(mirror) = &self.plan.mirror else { return Ok(false) };
        let Some(size) = mirror.wants(session.size(), Instant::now()) else { return Ok(false) };
        match miniature.prepare(show.renderer(), size) {
            Ok(()) => Ok(true),
            // a device that is lost is the headset's matter; memory that is short is not
            Err(crate::render::Error::Gpu(error @ crate::gpu::Error::Memory { .. })) => {
                mirror.close(Some(format!("the mirror is closed: {error}")));
                Ok(false)
            }
            Err(error) => Err(error.into()),
        }
    }
}
