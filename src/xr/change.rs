//! What changes between two frames: the world, the grey over it.

use super::cues::FADE_SECONDS;
use super::failure::Failure;
use super::headset::Headset;
use super::rig::Rig;
use super::running::Running;
use super::shared::user_at;
use super::surroundings::Surroundings;
use crate::render::Show;
use std::sync::Arc;

impl Headset<'_> {
    /// Does what the stage wants: makes the next world ready, and shows it when its time has come.
    pub(super) fn heed(&mut self, running: &mut Running) -> Result<(), Failure> {
        let cues = self.shared.cues();
        let Running { next, venue, .. } = running;
        if let Some(world) = cues.next.as_ref().filter(|world| world.number != self.world.number) {
            next.prepare(world, venue)?;
        }
        if let Some(ready) = next.look()? {
            self.shared.report(|report| report.ready = ready);
        }
        if cues.on_stage != self.world.number
            && let Some((world, show)) = next.take(cues.on_stage)
        {
            self.change(running, world, show)?;
        }
        self.take_question(cues.question.as_ref());
        Ok(())
    }

    /// Shows another world from the next frame on.
    fn change(&mut self, running: &mut Running, world: Arc<Surroundings>, show: Show) -> Result<(), Failure> {
        // the device is done with the frames of the one before
        running.show.finish(false)?;
        running.show = show;
        running.in_flight = Default::default();
        running.clock.shown = super::shown::Shown::default();
        running.session.hidden().renew();
        self.enter(world);
        Ok(())
    }

    /// The user is in another world, where it has them begin.
    fn enter(&mut self, world: Arc<Surroundings>) {
        self.rig = Rig::new(world.start);
        self.recentres = true;
        self.shared.set_user(user_at(world.start));
        self.world = world;
    }

    /// Asks for a new place of the panel: the room is another one.
    pub(super) fn forget_place(&mut self) {
        self.asking.iter_mut().for_each(super::asking::Asking::forget_place);
    }

    /// At the begin of a session: a world that was to be seen meanwhile, and a panel that has no place in the room yet.
    pub(super) fn adopt(&mut self) {
        self.forget_place();
        let cues = self.shared.cues();
        let wanted =
            cues.next.filter(|next| next.number == cues.on_stage && next.number != self.world.number);
        if let Some(world) = wanted {
            self.enter(world);
        }
    }

    /// Brings the grey nearer to what is wanted, after so many seconds by the display.
    pub(super) fn fade_on(&mut self, seconds: f32) {
        let (cues, most) = (self.shared.cues(), (seconds / FADE_SECONDS).clamp(0.0, 1.0));
        let most = if cues.fades_at_once { 1.0 } else { most };
        self.fade += (cues.fade - self.fade).clamp(-most, most);
        self.shared.report(|report| report.fade = self.fade);
    }

    /// Tells the stage of a frame that was handed over.
    pub(super) fn report_frame(&self, periods: u64, since_ms: f32) {
        self.shared.report(|report| {
            report.on_stage = self.world.number;
            report.frames.add(periods, since_ms);
        });
    }
}
