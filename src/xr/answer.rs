//! From gestures to an answer: what is pointed at, and when it is chosen.
//!
//! Three means, as far as the plan allows them: a laser from a hand and its trigger; a stick to the left and right and the
//! button A; and, while no hand is there or the plan prefers it, a look that rests. After an answer nothing counts for [`DEAF`], nor before every button was
//! released and the look has left what it chose.

use super::panel::Choice;
use super::panel::picture::{Marks, STEPS};

/// Nothing counts for so long after an answer, s.
const DEAF: f64 = 0.35;
/// A look that rests for so long chooses, s.
const DWELL: f64 = 1.2;
/// A stick beyond this counts, and again only after it was below half of it.
const PUSHED: f32 = 0.6;

/// How an answer was given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Means {
    /// A laser and its trigger.
    Laser,
    /// A stick and the button A.
    Stick,
    /// A look that rested.
    Gaze,
}

impl Means {
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 3] = [Self::Laser, Self::Stick, Self::Gaze];

    /// Lower-case name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Laser => "laser",
            Self::Stick => "stick",
            Self::Gaze => "gaze",
        }
    }
}

/// What the user does in one frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Gestures {
    /// What the left and the right laser are at.
    pub(super) lasers: [Option<Choice>; 2],
    /// Whether their triggers are pulled.
    pub(super) triggers: [bool; 2],
    /// Left and right of the stick that is pushed farther, -1 to 1.
    pub(super) stick: f32,
    /// Whether the button A is pressed.
    pub(super) confirms: bool,
    /// What the head looks at, where there is no hand.
    pub(super) gaze: Option<Choice>,
}

impl Gestures {
    /// What of them counts where these means are allowed, and a hand is there or not.
    pub(super) fn by(self, means: &[Means], has_hand: bool) -> Self {
        let allows = |wanted: Means| means.contains(&wanted);
        let looks = allows(Means::Gaze) && (!has_hand || means.first() == Some(&Means::Gaze));
        let (has_laser, has_stick) = (allows(Means::Laser), allows(Means::Stick));
        Self {
            lasers: self.lasers.map(|at| at.filter(|_| has_laser)),
            triggers: self.triggers.map(|pulled| pulled && has_laser),
            stick: if has_stick { self.stick } else { 0.0 },
            confirms: self.confirms && has_stick,
            gaze: self.gaze.filter(|_| looks),
        }
    }

    fn is_pressed(&self) -> bool {
        self.confirms || self.triggers.contains(&true)
    }
}

/// The way to an answer.
#[derive(Debug, Clone, Default)]
pub(super) struct Answering {
    focus: Option<(Choice, Means)>,
    before: Gestures,
    /// How long the look has rested on the focus, s.
    dwelt: f64,
    /// How long nothing counts yet, s.
    deaf: f64,
    /// Whether the buttons that were pressed are to be released first.
    is_held: bool,
    is_pushed: bool,
    /// What the look has to leave before it chooses again.
    looked: Option<Choice>,
}

impl Answering {
    /// A new panel: nothing is in focus. What was pressed or looked at stays so, and counts only once it has ended.
    pub(super) fn begin(&mut self) {
        (self.focus, self.dwelt, self.is_held) = (None, 0.0, true);
        self.deaf = self.deaf.max(DEAF);
        self.looked = self.before.gaze;
    }

    /// Takes a frame, `seconds` after the one before. Returns what it chooses.
    pub(super) fn frame(
        &mut self,
        gestures: Gestures,
        seconds: f64,
        targets: &[Choice],
    ) -> Option<(Choice, Means)> {
        let before = std::mem::replace(&mut self.before, gestures);
        self.deaf = (self.deaf - seconds).max(0.0);
        self.is_held &= gestures.is_pressed();
        self.move_focus(&gestures, &before, targets);
        self.look(&gestures, seconds);
        let is_deaf = self.deaf > 0.0 || self.is_held;
        let chosen = self.choose(&gestures, &before).filter(|_| !is_deaf)?;
        (self.deaf, self.is_held, self.dwelt) = (DEAF, true, 0.0);
        self.looked = gestures.gaze;
        Some(chosen)
    }

    /// What is chosen, if anything.
    fn choose(&self, gestures: &Gestures, before: &Gestures) -> Option<(Choice, Means)> {
        for hand in 0..2 {
            if gestures.triggers[hand] && !before.triggers[hand] {
                return gestures.lasers[hand].map(|choice| (choice, Means::Laser));
            }
        }
        match self.focus {
            Some((choice, Means::Gaze)) if self.dwelt >= DWELL => Some((choice, Means::Gaze)),
            Some((choice, Means::Stick)) if gestures.confirms && !before.confirms => {
                Some((choice, Means::Stick))
            }
            _ => None,
        }
    }

    /// A laser takes the focus where it comes to another target, a stick with every push.
    fn move_focus(&mut self, gestures: &Gestures, before: &Gestures, targets: &[Choice]) {
        // of two the right one, where the mark is
        for hand in 0..2 {
            let (now, then) = (gestures.lasers[hand], before.lasers[hand]);
            match (now, self.focus) {
                (Some(choice), _) if now != then => self.focus = Some((choice, Means::Laser)),
                (None, Some((focus, Means::Laser))) if then == Some(focus) => self.focus = None,
                _ => {}
            }
        }
        let [left, right] = gestures.lasers;
        self.focus = self.focus.or_else(|| right.or(left).map(|choice| (choice, Means::Laser)));
        if gestures.stick.abs() < 0.5 * PUSHED {
            self.is_pushed = false;
        } else if gestures.stick.abs() > PUSHED && !self.is_pushed {
            self.is_pushed = true;
            let at = self.focus.and_then(|(focus, _)| targets.iter().position(|target| *target == focus));
            let last = targets.len().saturating_sub(1);
            let to = match (at, gestures.stick > 0.0) {
                (None, true) => 0,
                (None, false) => last,
                (Some(at), true) => (at + 1).min(last),
                (Some(at), false) => at.saturating_sub(1),
            };
            self.focus = targets.get(to).map(|target| (*target, Means::Stick));
        }
    }

    /// Follows a look. Once a hand is there, or a stick has taken the focus, looks do not count.
    fn look(&mut self, gestures: &Gestures, seconds: f64) {
        if self.looked.is_some() && gestures.gaze != self.looked {
            self.looked = None;
        }
        match (gestures.gaze, self.focus) {
            (None, Some((_, Means::Gaze))) => (self.focus, self.dwelt) = (None, 0.0),
            (Some(gaze), None | Some((_, Means::Gaze))) if self.looked.is_none() && self.deaf <= 0.0 => {
                let is_same = self.focus == Some((gaze, Means::Gaze));
                self.dwelt = if is_same { self.dwelt + seconds } else { 0.0 };
                self.focus = Some((gaze, Means::Gaze));
            }
            _ => {}
        }
    }

    /// What a panel shows of it.
    pub(super) fn marks(&self, chosen: Option<Choice>) -> Marks {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most ten")]
        let dwelt = match self.focus {
            Some((_, Means::Gaze)) => (f64::from(STEPS) * self.dwelt / DWELL) as u32,
            _ => 0,
        };
        Marks { focus: self.focus.map(|(focus, _)| focus), dwelt, chosen }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TARGETS: [Choice; 4] = [Choice::Cell(0), Choice::Cell(1), Choice::Cell(2), Choice::Next];
    const STEP: f64 = 0.0625;

    /// Frames of a sixteenth of a second with the same gestures: what they chose, and in which frame.
    fn hold(answering: &mut Answering, gestures: Gestures, frames: u32) -> Vec<(u32, Choice, Means)> {
        let chosen =
            |frame| answering.frame(gestures, STEP, &TARGETS).map(|(choice, means)| (frame, choice, means));
        (0..frames).filter_map(chosen).collect()
    }

    /// A panel that was looked at for a while.
    fn begun() -> Answering {
        let mut answering = Answering::default();
        answering.begin();
        assert_eq!(hold(&mut answering, Gestures::default(), 10), []);
        answering
    }

    fn aim(cell: usize, pulls: bool) -> Gestures {
        Gestures { lasers: [None, Some(Choice::Cell(cell))], triggers: [false, pulls], ..Gestures::default() }
    }

    #[test]
    fn a_laser_chooses_what_it_is_at_when_its_trigger_is_pulled() {
        let mut answering = begun();
        assert_eq!(hold(&mut answering, aim(1, false), 3), []);
        assert_eq!(answering.marks(None).focus, Some(Choice::Cell(1)));
        assert_eq!(hold(&mut answering, aim(1, true), 1), [(0, Choice::Cell(1), Means::Laser)]);
        // beside the panel, and the other hand's trigger
        let mut answering = begun();
        assert_eq!(hold(&mut answering, Gestures { triggers: [true, true], ..Gestures::default() }, 5), []);
        let mut answering = begun();
        assert_eq!(hold(&mut answering, Gestures { triggers: [true, false], ..aim(1, false) }, 5), []);
        assert_eq!(hold(&mut answering, Gestures::default(), 2), []);
        assert_eq!(answering.marks(None).focus, None);
        // of two lasers that are there from the beginning the right one
        let both = Gestures { lasers: [Some(Choice::Cell(0)), Some(Choice::Cell(2))], ..Gestures::default() };
        assert_eq!(hold(&mut begun(), both, 1), []);
        let mut answering = begun();
        hold(&mut answering, both, 3);
        assert_eq!(answering.marks(None).focus, Some(Choice::Cell(2)));
    }

    #[test]
    fn after_an_answer_nothing_counts_for_a_while_and_until_the_button_is_released() {
        let mut answering = begun();
        assert_eq!(hold(&mut answering, aim(1, true), 1).len(), 1);
        // held on for three seconds, over another cell: one answer
        assert_eq!(hold(&mut answering, aim(2, true), 60), []);
        assert_eq!(hold(&mut answering, aim(2, false), 1), []);
        assert_eq!(hold(&mut answering, aim(2, true), 1).len(), 1);
        // released and pulled within 350 ms
        assert_eq!(hold(&mut answering, aim(2, false), 2), []);
        assert_eq!(hold(&mut answering, aim(2, true), 1), []);
        assert_eq!(
            hold(&mut answering, aim(2, true), 20),
            [],
            "a pull that was not heard does not count later"
        );
        assert_eq!(hold(&mut answering, aim(2, false), 1), []);
        assert_eq!(hold(&mut answering, aim(2, true), 1).len(), 1);
        // a new panel under a trigger that is held, or pulled at once
        answering.begin();
        assert_eq!(hold(&mut answering, aim(2, true), 60), []);
        let mut answering = Answering::default();
        answering.begin();
        assert_eq!(hold(&mut answering, aim(0, false), 2), []);
        assert_eq!(hold(&mut answering, aim(0, true), 3), []);
    }

    #[test]
    fn only_the_means_of_the_plan_count_and_a_look_where_there_is_no_hand() {
        let all = Gestures {
            lasers: [None, Some(Choice::Next)],
            triggers: [false, true],
            stick: 1.0,
            confirms: true,
            gaze: Some(Choice::Cell(0)),
        };
        assert_eq!(all.by(&Means::ALL, false), all);
        assert_eq!(all.by(&Means::ALL, true), Gestures { gaze: None, ..all });
        let laser = Gestures { stick: 0.0, confirms: false, gaze: None, ..all };
        assert_eq!(all.by(&[Means::Laser], false), laser);
        let stick = Gestures { lasers: [None; 2], triggers: [false; 2], gaze: None, ..all };
        assert_eq!(all.by(&[Means::Stick], false), stick);
        let gaze = Gestures { gaze: all.gaze, ..Gestures::default() };
        assert_eq!(all.by(&[Means::Gaze], true), gaze);
        assert_eq!(all.by(&[Means::Gaze, Means::Laser], true).gaze, all.gaze);
    }

    #[test]
    fn a_stick_goes_from_target_to_target_and_a_chooses() {
        let mut answering = begun();
        let push = |stick: f32| Gestures { stick, ..Gestures::default() };
        let confirm = Gestures { confirms: true, ..Gestures::default() };
        assert_eq!(hold(&mut answering, confirm, 2), [], "nothing is in focus");
        for (stick, focus) in [(1.0, 0), (1.0, 1), (1.0, 2), (-1.0, 1), (-0.9, 0), (-0.9, 0)] {
            assert_eq!(hold(&mut answering, push(stick), 5), [], "held on it moves once");
            assert_eq!(answering.marks(None).focus, Some(Choice::Cell(focus)));
            assert_eq!(hold(&mut answering, push(0.4), 2), []);
            assert_eq!(hold(&mut answering, push(0.1), 2), []);
        }
        assert_eq!(hold(&mut answering, confirm, 5), [(0, Choice::Cell(0), Means::Stick)]);
        let mut other = begun();
        hold(&mut other, push(-1.0), 1);
        assert_eq!(other.marks(None).focus, Some(Choice::Next), "from the end");
    }

    #[test]
    fn a_look_that_rests_chooses_once_and_again_only_after_it_was_elsewhere() {
        let mut answering = begun();
        let look = |cell: usize| Gestures { gaze: Some(Choice::Cell(cell)), ..Gestures::default() };
        assert_eq!(hold(&mut answering, look(1), 20), []);
        assert_eq!(answering.marks(None).dwelt, 9);
        assert_eq!(hold(&mut answering, look(2), 20), [], "another cell begins from nothing");
        assert_eq!(hold(&mut answering, Gestures::default(), 1), []);
        assert_eq!(hold(&mut answering, look(2), 60), [(20, Choice::Cell(2), Means::Gaze)]);
        answering.begin();
        assert_eq!(hold(&mut answering, look(2), 60), [], "the next panel under the same look");
        assert_eq!(hold(&mut answering, look(1), 60).len(), 1);
        // with a hand on the way there is no look
        let mut answering = begun();
        hold(&mut answering, look(1), 20);
        assert_eq!(hold(&mut answering, aim(2, false), 60), []);
    }
}
