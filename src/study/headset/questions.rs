//! The questions of a page, one panel each, answered by the participant or typed by the operator.

use super::front::{Cut, Front, now};
use super::panels;
use super::parties::Typed;
use crate::study::lab::Order;
use crate::study::protocol::{Answer, Event, Page, PageQuestion};
use crate::xr::Choice;
use std::time::Instant;

/// The answer to one question so far.
#[derive(Debug, Clone, Copy, Default)]
struct Given {
    value: Option<i64>,
    /// When it was answered first, s after it was seen.
    first: Option<f64>,
    /// How long it was seen until the last answer, s.
    seconds: f64,
}

impl Given {
    /// Adds an answer after so many more seconds.
    fn add(&mut self, seconds: f64, value: Option<i64>) {
        self.seconds += seconds;
        self.first.get_or_insert(self.seconds);
        self.value = value;
    }
}

/// What came of a panel with a question.
enum Said {
    /// A choice of the participant, and the seconds until it.
    Chosen(Choice, f64),
    /// What the operator typed, and the seconds until it.
    Typed(Typed, f64),
}

impl Front<'_> {
    /// Asks the questions of a page, one at a time. None: the session is over.
    pub(super) fn questions(
        &mut self,
        page: &Page,
        questions: &[PageQuestion],
        instruction: Option<&str>,
    ) -> Result<Option<Page>, crate::Error> {
        let mut given: Vec<Given> = vec![Given::default(); questions.len()];
        let mut at = 0;
        while let Some(question) = questions.get(at) {
            let said =
                match self.question(page, question, [at, questions.len()], (given[at].value, instruction))? {
                    Ok(said) => said,
                    Err(Cut::Over) => return Ok(None),
                    Err(Cut::Order(Order::Look)) => return self.participation.page().map(Some),
                    Err(Cut::Order(order)) => {
                        self.refuse(order);
                        continue;
                    }
                };
            match self.take(page, question, &mut given[at], said)? {
                Some(Choice::Next) => at += 1,
                Some(Choice::Back) => at = at.saturating_sub(1),
                _ => {}
            }
            self.look_ahead()?;
        }
        self.participation.submit(Event::Next { page: page.id.clone() }).map(Some)
    }

    /// Shows a question until something is said to it.
    fn question(
        &mut self,
        page: &Page,
        question: &PageQuestion,
        place: [usize; 2],
        (answer, instruction): (Option<i64>, Option<&str>),
    ) -> Result<Result<Said, Cut>, crate::Error> {
        let mut panel = panels::question(&self.words, page, question, place, answer);
        if let Some(instruction) = instruction {
            panel.question = format!("{instruction}\n{}", panel.question);
        }
        if panels::cells(question).is_none() {
            panel = panels::spoken(&self.words, question, panel);
        }
        self.beside.wait_for(&page.id, question);
        let begin = Instant::now();
        let asked = self.ask(&panel)?;
        Ok(match self.beside.take_typed() {
            Some(typed) => Ok(Said::Typed(typed, begin.elapsed().as_secs_f64())),
            None => asked.map(|(choice, seconds)| Said::Chosen(choice, seconds)),
        })
    }

    /// Stores what was said to a question. Returns where it leads: to the next question, back, or to the same again.
    fn take(
        &mut self,
        page: &Page,
        question: &PageQuestion,
        given: &mut Given,
        said: Said,
    ) -> Result<Option<Choice>, crate::Error> {
        let (value, text, seconds, leads) = match said {
            Said::Chosen(Choice::Cell(cell), seconds) => {
                let cells = panels::cells(question);
                let value = cells.and_then(|cells| cells.get(cell).map(|cell| cell.1));
                (value, None, seconds, None)
            }
            Said::Chosen(choice, seconds) => {
                given.seconds += seconds;
                return Ok(Some(choice));
            }
            Said::Typed(Typed::LeftOut, _) => return Ok(question.optional.then_some(Choice::Next)),
            Said::Typed(Typed::Waiting, _) => return Ok(None),
            Said::Typed(Typed::Number(value), seconds) => (Some(value), None, seconds, Some(Choice::Next)),
            Said::Typed(Typed::Text(text), seconds) => (None, Some(text), seconds, Some(Choice::Next)),
        };
        given.add(seconds, value);
        self.answer(page, question, given, text)?;
        Ok(leads)
    }

    /// Stores an answer.
    fn answer(
        &mut self,
        page: &Page,
        question: &PageQuestion,
        given: &Given,
        text: Option<String>,
    ) -> Result<(), crate::Error> {
        self.answers += 1;
        let said = given.value.map_or_else(|| "a text".to_owned(), |value| value.to_string());
        let answer = Answer {
            page: page.id.clone(),
            question: question.id.clone(),
            value: given.value,
            text,
            first_ms: given.first.map_or(0, ms),
            ms: ms(given.seconds),
            key: format!("{:x}-{}", now().unsigned_abs(), self.answers),
        };
        self.participation.submit(Event::Answer(answer))?;
        self.beside.operator().note(&format!("{}: {} = {said}", page.id, question.id));
        let group = question.id.split('.').next().unwrap_or_default();
        let stop = self.setup.stop_at.get(&question.id).or_else(|| self.setup.stop_at.get(group));
        if let Some((stop, value)) = stop.zip(given.value).filter(|(stop, value)| value >= stop) {
            let line = format!("{} is {value}, which is {stop} or more: ask whether to end", question.id);
            self.beside.operator().note(&line);
        }
        Ok(())
    }
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a time of answering")]
fn ms(seconds: f64) -> u32 {
    (seconds * 1e3).round().clamp(0.0, f64::from(u32::MAX)) as u32
}
