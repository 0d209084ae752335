//! The headset's side of a panel: it stands in the room, takes the user's gestures, and is handed over with the frames.

use super::answer::{Gestures, Means};
use super::cues::LONGEST_SEEN;
use super::failure::Failure;
use super::headset::Headset;
use super::input::Reading;
use super::panel::picture::{MARK, Marks, marked};
use super::panel::place::{self, EyeImage, Quad};
use super::panel::{Choice, HEIGHT, WIDTH};
use super::question::{Answered, Question};
use super::running::Running;
use super::session::Frame;
use super::views::Pose;
use crate::picture::Image;
use glam::Vec2;
use std::sync::Arc;

/// Side of the mark at the end of a laser, m.
const MARK_SIZE: f32 = 0.022;

/// A panel that is shown.
#[derive(Debug)]
pub(super) struct Asking {
    question: Arc<Question>,
    /// Where it stands in the room; none before a frame with a head, and after the room was moved.
    pose: Option<Pose>,
    marks: Marks,
    /// As it is shown.
    pub(super) picture: Image,
    /// Whether the runtime has not got that yet.
    is_new: bool,
    /// What the laser is at, pixels.
    pointed: Option<[f32; 2]>,
    /// Display time of the last frame that showed it, ns.
    last: Option<i64>,
    seconds: f64,
    frames: u64,
    answer: Option<Choice>,
}

impl Asking {
    /// A panel, where the one before it stood.
    fn new(question: &Arc<Question>, pose: Option<Pose>) -> Self {
        Self {
            question: question.clone(),
            pose,
            marks: Marks::default(),
            picture: question.picture.clone(),
            is_new: true,
            pointed: None,
            last: None,
            seconds: 0.0,
            frames: 0,
            answer: None,
        }
    }

    /// Asks for a new place: the room was moved, or there is another session.
    pub(super) const fn forget_place(&mut self) {
        (self.pose, self.is_new, self.last) = (None, true, None);
    }

    /// What is shown, in the room: the panel, and the mark that a laser points with.
    pub(super) fn quads(&self) -> Vec<Quad> {
        let Some(pose) = self.pose else { return Vec::new() };
        let panel = Quad { pose, size: place::SIZE, part: [0, 0, WIDTH, HEIGHT] };
        let mark = self.pointed.map(|at| Quad {
            pose: place::place(pose, at),
            size: Vec2::splat(MARK_SIZE),
            part: [0, HEIGHT, MARK, MARK],
        });
        [panel].into_iter().chain(mark).collect()
    }

    /// Draws it over what an eye sees, where the runtime's compositor shows it.
    pub(super) fn paste(&self, image: &mut Image, eye: &EyeImage, room: Pose) {
        if self.frames > 0 {
            for quad in self.quads() {
                place::paste(image, eye, &Quad { pose: quad.pose.within(room), ..quad }, &self.picture);
            }
        }
    }

    /// Notes that a frame of that display time shows it.
    fn seen(&mut self, display: i64) {
        #[allow(clippy::cast_precision_loss, reason = "a short time")]
        let since = |before: i64| (display.saturating_sub(before) as f64 * 1e-9).clamp(0.0, LONGEST_SEEN);
        self.seconds += self.last.replace(display).map_or(0.0, since);
        self.frames += 1;
    }

    /// What the user does, and where a laser is.
    fn gestures(&mut self, input: &Reading, head: Option<Pose>, means: &[Means]) -> Gestures {
        let Some(pose) = self.pose else { return Gestures::default() };
        let panel = &self.question.panel;
        let hits = input.hands.map(|hand| hand.and_then(|hand| place::hit(pose, hand)));
        // the mark is where the hand is that points at the panel, the right one first
        let on_panel = |at: &[f32; 2]| {
            #[allow(clippy::cast_precision_loss, reason = "a thousand pixels")]
            let [width, height] = [WIDTH as f32, HEIGHT as f32];
            (0.0..width).contains(&at[0]) && (0.0..height).contains(&at[1])
        };
        let points = means.contains(&Means::Laser);
        self.pointed = [hits[1], hits[0]].into_iter().flatten().find(on_panel).filter(|_| points);
        let has_hand = input.hands.iter().any(Option::is_some);
        let look = head.and_then(|head| place::hit(pose, head));
        let gestures = Gestures {
            lasers: hits.map(|hit| hit.and_then(|at| panel.at(at))),
            triggers: input.answer.triggers,
            stick: input.answer.stick,
            confirms: input.answer.confirms,
            gaze: look.and_then(|at| panel.at(at)),
        };
        gestures.by(means, has_hand)
    }

    /// Draws the picture again if the marks have changed.
    fn mark(&mut self, marks: Marks) {
        if marks != self.marks {
            self.marks = marks;
            self.picture = marked(&self.question.picture, &self.question.panel, &marks);
            self.is_new = true;
        }
    }
}

impl Headset<'_> {
    /// Shows the panel that the stage wants, or none.
    pub(super) fn take_question(&mut self, question: Option<&Arc<Question>>) {
        let shown = self.asking.as_ref().map(|asking| asking.question.number);
        if shown != question.map(|question| question.number) {
            let place = self.asking.take().and_then(|before| before.pose);
            self.asking = question.map(|question| Asking::new(question, place));
            self.answering.begin();
        }
    }

    /// Takes what the user does in a frame.
    pub(super) fn answer(&mut self, input: &Reading, head: Option<Pose>, seconds: f64) {
        let Some(asking) = &mut self.asking else { return };
        if let (None, Some(head)) = (asking.pose, head) {
            asking.pose = Some(place::before(head));
        }
        let gestures = asking.gestures(input, head, &self.plan.means);
        let chosen = self.answering.frame(gestures, seconds, &asking.question.targets);
        // a panel that was not seen yet cannot be answered, and none twice
        if let Some((choice, means)) = chosen.filter(|_| asking.frames > 0 && asking.answer.is_none()) {
            asking.answer = Some(choice);
            let answered = Answered { choice, means, seconds: asking.seconds, frames: asking.frames };
            let number = asking.question.number;
            self.shared.report(|report| report.answer = Some((number, answered)));
        }
        let before = asking.question.panel.chosen.map(Choice::Cell);
        asking.mark(self.answering.marks(asking.answer.or(before)));
    }

    /// Has the present frame, of a slot, bring the panel's picture to the runtime if it has changed.
    pub(super) fn bring_panel(&mut self, running: &mut Running, slot: usize) -> Result<(), Failure> {
        let Some(asking) = self.asking.as_mut().filter(|asking| asking.pose.is_some()) else { return Ok(()) };
        let session = &mut running.session;
        if asking.is_new {
            self.shared.call(|| session.write_panel(slot, &asking.picture))?;
            asking.is_new = false;
        }
        Ok(())
    }

    /// Notes that a frame has shown the panel.
    pub(super) fn panel_seen(&mut self, frame: &Frame) {
        if let Some(asking) = self.asking.as_mut().filter(|asking| asking.pose.is_some()) {
            asking.seen(frame.display.as_nanos());
        }
    }
}
