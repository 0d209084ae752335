//! A trial: its world out of the grey and back into it, on record.

use super::front::{Cut, Front, LOOK, now};
use super::panels;
use super::watch::Ahead;
use crate::scene::Scene;
use crate::study::lab::Order;
use crate::study::protocol::{Event, Exposure, Page};
use crate::study::theatre::Showing;
use crate::xr::{RecordedSession, Recorder, RecordingError, TrialLabel, Walked, World};
use std::fs::File;

/// How long a fade is waited for, s.
const FADED: f64 = 0.4;
/// A trial in which the headset was away for so long is shown again, s.
const AWAY: f64 = 1.0;
/// Most times that it is: a machine that shows less than a frame a second never shows it whole.
const MOST_AGAIN: u32 = 3;
/// Looks for a world until the participant reads why it takes so long.
const SOON: u32 = 10;
/// Most names of recordings of one trial.
const MOST_REPEATS: u32 = 100;

impl Front<'_> {
    /// Shows a trial. None: the session is over.
    pub(super) fn trial(&mut self, page: &Page, seconds: f64) -> Result<Option<Page>, crate::Error> {
        let Some(showing) = self.participation.trial()? else {
            return self.participation.page().map(Some);
        };
        let mut again = 0;
        loop {
            let started = now();
            let exposure = match self.show(&showing, seconds)? {
                Ok(walked) => Exposure { started, ..exposure(&walked) },
                Err(Cut::Order(Order::Repeat)) => {
                    self.beside.operator().note(&format!("{}: again from its beginning", page.id));
                    continue;
                }
                Err(Cut::Order(Order::Skip)) => {
                    self.beside.operator().note(&format!("{}: left out", page.id));
                    let (page, reason) = (page.id.clone(), "skipped by the operator".to_owned());
                    return self.participation.submit(Event::Fault { page, reason }).map(Some);
                }
                Err(Cut::Order(_)) => return self.participation.page().map(Some),
                Err(Cut::Over) => return Ok(None),
            };
            let away = seconds - exposure.seconds_visible;
            if away >= AWAY && again < MOST_AGAIN {
                again += 1;
                let line = format!("{}: the headset was away for {away:.1} s; it is shown again", page.id);
                self.beside.operator().note(&line);
                continue;
            }
            self.tell(page, &exposure);
            return self.participation.submit(Event::Shown { page: page.id.clone(), exposure }).map(Some);
        }
    }

    /// Tells the operator how a trial went.
    fn tell(&mut self, page: &Page, exposure: &Exposure) {
        let Exposure { seconds_visible, frames, late_frames, longest_ms, .. } = *exposure;
        let rate = f64::from(frames) / seconds_visible.max(f64::EPSILON);
        let line = format!(
            "{}: seen for {seconds_visible:.1} s, {rate:.0} frames/s, {late_frames} late, longest {longest_ms:.0} ms",
            page.id
        );
        self.beside.operator().note(&line);
    }

    /// Shows a trial's world out of the grey and back into it, and records it.
    fn show(&mut self, showing: &Showing, seconds: f64) -> Result<Result<Walked, Cut>, crate::Error> {
        let Some((scene, mut world)) = self.world(showing)? else { return Ok(Err(self.cut())) };
        if !self.stage.show(&world, &mut self.beside)? {
            return Ok(Err(self.cut()));
        }
        self.stage.fade(0.0);
        self.beside.record(self.recorder(showing, &scene, &mut world)?);
        let walked = self.stage.walk(&mut world, seconds, &mut self.beside)?;
        // what was cut is gone at once
        if walked.is_whole {
            self.stage.fade(1.0);
        } else {
            self.stage.blank();
        }
        if let Some(recorder) = self.beside.take_recorder() {
            recorder.finish(world.simulation().state()?).map_err(|error| of_recording(&error))?;
        }
        if !walked.is_whole {
            return Ok(Err(self.cut()));
        }
        self.stage.walk(&mut world, FADED, &mut self.beside)?;
        Ok(Ok(walked))
    }

    /// The world of a trial, ready to be seen: made ahead, or now. None: the session is over, or the operator wants something.
    fn world(&mut self, showing: &Showing) -> Result<Option<(Scene, World)>, crate::Error> {
        if self.ahead.as_ref().is_none_or(|ahead| !ahead.is_of(showing)) {
            self.ahead = Some(Ahead::begin(&self.theatre, showing.clone())?);
        }
        let mut waits = 0;
        while !self.look_at_ahead()? {
            waits += 1;
            if waits == SOON {
                self.stage.tell(&panels::notice(&self.words.wait))?;
            }
            if !self.stage.rest(LOOK, &mut self.beside) {
                return Ok(None);
            }
        }
        Ok(self.ahead.take().and_then(Ahead::world))
    }

    /// Begins to make the next trial's world, and brings it to the headset's device.
    pub(super) fn look_ahead(&mut self) -> Result<(), crate::Error> {
        if self.ahead.is_none()
            && let Some(next) = self.participation.next_trial()?.filter(|next| next.stimulus.is_some())
        {
            self.ahead = Some(Ahead::begin(&self.theatre, next)?);
        }
        self.look_at_ahead().map(drop)
    }

    /// Whether the next world can be seen at once.
    fn look_at_ahead(&mut self) -> Result<bool, crate::Error> {
        let Some(ahead) = &mut self.ahead else { return Ok(false) };
        let Some(world) = ahead.look()? else { return Ok(false) };
        self.stage.prepare(world);
        Ok(self.stage.is_ready(world))
    }

    /// A new recording of a trial. One that broke off is kept, and complete ones are.
    fn recorder(
        &self,
        showing: &Showing,
        scene: &Scene,
        world: &mut World,
    ) -> Result<Recorder<File>, crate::Error> {
        let label = TrialLabel {
            study: self.setup.study.clone(),
            participant: self.setup.participant.clone(),
            part: showing.trial.part.clone(),
            trial: showing.trial.position,
        };
        let of = RecordedSession::of(scene, &self.theatre.library, world.simulation().state()?);
        let session = RecordedSession { trial: Some(label), ..of };
        let name = format!("{}-{}", showing.trial.part, showing.trial.position);
        let mut last = None;
        for repeat in 1..=MOST_REPEATS {
            let again = if repeat > 1 { format!("-{repeat}") } else { String::new() };
            match crate::xr::make_way(&self.setup.recordings.join(format!("{name}{again}.csv"))) {
                Ok(way) => return Recorder::new(way.file, &session).map_err(|error| of_recording(&error)),
                Err(error @ RecordingError::Taken(_)) => last = Some(error),
                Err(error) => return Err(of_recording(&error)),
            }
        }
        Err(of_recording(&last.unwrap_or(RecordingError::Taken("there are too many recordings"))))
    }
}

/// How a walk was seen.
fn exposure(walked: &Walked) -> Exposure {
    let count = |frames: u64| u32::try_from(frames).unwrap_or(u32::MAX);
    Exposure {
        started: 0,
        seconds_visible: walked.frames.seconds.min(walked.seconds),
        plays: 1,
        frames: count(walked.frames.drawn),
        late_frames: count(walked.frames.missed),
        longest_ms: f64::from(walked.frames.longest_ms),
    }
}

fn of_recording(error: &RecordingError) -> crate::Error {
    crate::Error::Usage {
        message: error.to_string(),
        hint: "make room on the disk, or choose a folder that can be written to".to_owned(),
    }
}
