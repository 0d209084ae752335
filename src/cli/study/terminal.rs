//! The operator at the terminal: lines that are typed are answers, or orders that begin with a slash.

use super::super::output::warn;
use crate::study::headset::{Kept, Operator, Typed};
use crate::study::lab::{Lab, Order};
use crate::study::plan::{Ending, Scale};
use crate::study::protocol::{PageQuestion, State};
use crate::study::store::{Act, Trouble, Turn};
use std::collections::VecDeque;
use std::io::BufRead as _;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

/// Who the audit says did it.
const OPERATOR: &str = "terminal";
/// How often it is looked whether the participation was paused or ended from elsewhere.
const LOOK: Duration = Duration::from_millis(250);
/// What is typed for an answer that is left out.
const LEFT_OUT: &str = "-";
/// The orders, with what they do.
const ORDERS: &str = "orders: /pause, /resume, /repeat (the trial, from its beginning), /skip (the trial), /note TEXT, /end (grey at \
                      once; the participation can go on later), /help. All else is the answer to the question";

/// What came of looking where the participation is.
type Looked = Result<Turn, Trouble>;

/// The operator at the terminal.
pub(super) struct Terminal {
    kept: Kept,
    lab: Arc<Lab>,
    typed: Receiver<String>,
    /// Lines that are not orders.
    said: VecDeque<String>,
    /// Whether the text to agree to was printed.
    has_asked_consent: bool,
    turns: (Sender<Looked>, Receiver<Looked>),
    /// When the store was asked last, and whether it has not answered yet.
    looked: (Instant, bool),
    /// Whether the participation was cut off when it was looked last.
    was_cut_off: bool,
}

impl Terminal {
    pub(super) fn new(kept: Kept, lab: Arc<Lab>) -> Self {
        let (send, typed) = channel();
        let read = move || {
            for line in std::io::stdin().lock().lines().map_while(Result::ok) {
                if send.send(line.trim().to_owned()).is_err() {
                    return;
                }
            }
        };
        // without it nothing can be typed, and the console is left
        if std::thread::Builder::new().name("terminal".to_owned()).spawn(read).is_err() {
            warn("no thread for the terminal: what is typed is not heard");
        }
        Self {
            kept,
            lab,
            typed,
            said: VecDeque::new(),
            has_asked_consent: false,
            turns: channel(),
            looked: (Instant::now(), false),
            was_cut_off: false,
        }
    }

    /// Takes what was typed since it was looked last.
    fn hear(&mut self) {
        while let Ok(line) = self.typed.try_recv() {
            match line.strip_prefix('/') {
                Some(order) => self.obey(order),
                None if line.is_empty() => {}
                None => self.said.push_back(line),
            }
        }
    }

    fn obey(&mut self, order: &str) {
        let (word, text) = order.split_once(' ').unwrap_or((order, ""));
        let act = match word {
            "repeat" => return self.lab.order(Order::Repeat),
            "skip" => return self.lab.order(Order::Skip),
            "end" => return self.lab.order(Order::End),
            "pause" => Act::Pause,
            "resume" => Act::Resume,
            "note" if !text.trim().is_empty() => Act::Note { text: text.trim().to_owned() },
            "note" => return warn("/note takes a text, such as /note asked for water"),
            "help" => return warn(ORDERS),
            _ => return warn(&format!("/{word} is no order. {ORDERS}")),
        };
        match self.kept.operate(OPERATOR, act) {
            Ok(_) => {
                if word == "pause" {
                    self.lab.order(Order::Look);
                    self.was_cut_off = true;
                }
                self.note(&format!("{word}: done"));
            }
            Err(trouble) => warn(&format!("{word}: {trouble}")),
        }
    }

    /// Whether the participation was paused, ended or withdrawn since it was looked last.
    fn is_cut_off(&mut self) -> bool {
        let mut is_new = false;
        while let Ok(turn) = self.turns.1.try_recv() {
            self.looked.1 = false;
            let now = turn.is_ok_and(|turn| {
                matches!(turn.state, State::Paused | State::Ended(Ending::Excluded | Ending::Withdrawn))
            });
            is_new |= now && !self.was_cut_off;
            self.was_cut_off = now;
        }
        if !self.looked.1 && self.looked.0.elapsed() >= LOOK {
            self.looked = (Instant::now(), true);
            let tell = self.turns.0.clone();
            self.kept.look(move |turn| drop(tell.send(turn)));
        }
        is_new
    }
}

impl Operator for Terminal {
    fn note(&mut self, line: &str) {
        warn(line);
        self.lab.note(line);
    }

    fn order(&mut self) -> Option<Order> {
        self.hear();
        if self.is_cut_off() { Some(Order::Look) } else { self.lab.next_order() }
    }

    fn agreed(&mut self, text: &str, minimum_age: u32) -> Option<bool> {
        if !self.has_asked_consent {
            self.has_asked_consent = true;
            self.said.clear();
            warn(&format!(
                "\n{}\n\nThe participant is at least {minimum_age} years old and agrees? agree / decline",
                text.trim()
            ));
        }
        self.hear();
        match self.said.pop_front().as_deref() {
            Some("agree") => Some(true),
            Some("decline") => Some(false),
            Some(other) => {
                warn(&format!("{other:?}: type agree or decline"));
                None
            }
            None => None,
        }
    }

    fn asks(&mut self, page: &str, question: &PageQuestion) {
        // what was typed before it was asked is no answer to it
        self.hear();
        self.said.clear();
        let optional =
            if question.optional { format!(", {LEFT_OUT} to leave it out") } else { String::new() };
        warn(&format!("{page}: {} ({}{optional})", question.text.trim(), allowed(&question.scale)));
    }

    fn typed(&mut self, question: &PageQuestion) -> Typed {
        self.hear();
        let Some(line) = self.said.pop_front() else { return Typed::Waiting };
        answer(&line, question).unwrap_or_else(|wrong| {
            warn(&wrong);
            Typed::Waiting
        })
    }
}

/// What can be answered, in words.
fn allowed(scale: &Scale<String>) -> String {
    match scale {
        Scale::Points { least, greatest, .. } | Scale::Number { least, greatest } => {
            format!("{least} to {greatest}")
        }
        Scale::Options { options } => {
            let options: Vec<String> =
                options.iter().map(|(value, text)| format!("{value} {text}")).collect();
            options.join(", ")
        }
        Scale::Text { most } => format!("a text of up to {most} letters"),
    }
}

/// What a line answers to a question.
fn answer(line: &str, question: &PageQuestion) -> Result<Typed, String> {
    let wrong = || format!("{line:?} is no answer: {}", allowed(&question.scale));
    if line == LEFT_OUT {
        let must = || "this question may not be left out".to_owned();
        return if question.optional { Ok(Typed::LeftOut) } else { Err(must()) };
    }
    let number = line.parse::<i64>().ok();
    match &question.scale {
        Scale::Points { least, greatest, .. } | Scale::Number { least, greatest } => {
            number.filter(|value| (least..=greatest).contains(&value)).map(Typed::Number).ok_or_else(wrong)
        }
        Scale::Options { options } => {
            let is_meant =
                |(value, text): &&(i64, String)| number == Some(*value) || text.eq_ignore_ascii_case(line);
            options.iter().find(is_meant).map(|(value, _)| Typed::Number(*value)).ok_or_else(wrong)
        }
        Scale::Text { most } if line.chars().count() <= *most as usize => Ok(Typed::Text(line.to_owned())),
        Scale::Text { .. } => Err(wrong()),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;

    fn question(scale: Scale<String>, optional: bool) -> PageQuestion {
        PageQuestion { id: "q".into(), heading: String::new(), text: "How?".into(), scale, optional }
    }

    #[test]
    fn a_line_answers_what_the_scale_allows_and_nothing_else() {
        let points = question(Scale::Points { least: 1, greatest: 7, labels: Vec::new() }, false);
        assert_eq!(answer("7", &points).unwrap(), Typed::Number(7));
        for wrong in ["0", "8", "x", "1.5", "-"] {
            answer(wrong, &points).unwrap_err();
        }
        let options = vec![(3, "Sad".to_owned()), (0, "happy".to_owned())];
        let options = question(Scale::Options { options }, true);
        for (line, value) in [("3", 3), ("sad", 3), ("Happy", 0), ("0", 0)] {
            assert_eq!(answer(line, &options).unwrap(), Typed::Number(value), "{line}");
        }
        assert_eq!(answer("-", &options).unwrap(), Typed::LeftOut);
        assert!(answer("bored", &options).unwrap_err().contains("3 Sad, 0 happy"));
        let text = question(Scale::Text { most: 4 }, true);
        assert_eq!(answer("äöüß", &text).unwrap(), Typed::Text("äöüß".into()));
        assert!(answer("äöüßx", &text).unwrap_err().contains("up to 4"));
    }
}
