//! One simulated participant: what they answer to a page.

use super::agents::{Seen, identify};
use super::draws::{cut, normal};
use super::run::Minds;
use crate::emotion::Emotion;
use crate::random::Random;
use crate::study::plan::{Plan, Role, Scale, StepKind, Stimulus};
use crate::study::protocol::{Answer, Content, Event, Exposure, Page, PageQuestion, Session};

/// A simulated participant.
#[derive(Debug, Clone)]
pub(super) struct Person {
    pub(super) number: u64,
    pub(super) is_careless: bool,
    /// Standard normal: how far they agree with anything.
    deviate: f64,
    pub(super) random: Random,
    keys: u64,
    /// Whether they fell silent for good.
    pub(super) has_left: bool,
    /// Events that they have in hand, with their times.
    pub(super) pending: Vec<(i64, Event)>,
}

impl Person {
    pub(super) fn new(number: u64, careless: f64, mut random: Random) -> Self {
        let is_careless = random.unit() < careless;
        let deviate = normal(&mut random);
        Self { number, is_careless, deviate, random, keys: 0, has_left: false, pending: Vec::new() }
    }

    /// The events by which they answer a page, each with the time that it takes, ms.
    pub(super) fn reply(
        &mut self,
        plan: &Plan,
        minds: &Minds,
        session: &Session,
        page: &Page,
    ) -> Vec<(i64, Event)> {
        let id = page.id.clone();
        match &page.content {
            Content::Consent { .. } => vec![(self.between(20, 60), Event::Consented { text: String::new() })],
            Content::Text { .. } | Content::Rest => vec![(self.between(8, 30), Event::Next { page: id })],
            Content::Show { seconds, plays, .. } => {
                let exposure = Exposure {
                    seconds_visible: seconds * f64::from(*plays),
                    plays: *plays,
                    ..Exposure::default()
                };
                let time = cut(1000.0 * exposure.seconds_visible, 0, i64::MAX) + self.between(0, 2);
                vec![(time, Event::Shown { page: id, exposure })]
            }
            Content::Form { .. } | Content::Check { .. } | Content::Ask { .. } => {
                let mut events: Vec<(i64, Event)> = Vec::new();
                let mut since = 0;
                for question in page.content.questions() {
                    let time = if self.is_careless { self.between(0, 1) } else { self.between(1, 4) };
                    since += time;
                    if let Some(answer) = self.answer(plan, minds, session, (page, question), since) {
                        events.push((time, Event::Answer(answer)));
                    }
                }
                events.push((self.between(0, 2), Event::Next { page: id }));
                events
            }
            _ => Vec::new(),
        }
    }

    /// A time between two numbers of seconds, ms.
    fn between(&mut self, least: u32, most: u32) -> i64 {
        let seconds = f64::from(least) + f64::from(most - least) * self.random.unit();
        cut(1000.0 * seconds, 1, i64::MAX)
    }

    fn answer(
        &mut self,
        plan: &Plan,
        minds: &Minds,
        session: &Session,
        (page, question): (&Page, &PageQuestion),
        since: i64,
    ) -> Option<Answer> {
        if matches!(question.scale, Scale::Text { .. }) {
            return None;
        }
        let value =
            if self.is_careless { None } else { self.considered(plan, minds, session, (page, question)) };
        let value = value.unwrap_or_else(|| self.any(&question.scale));
        self.keys += 1;
        let ms = u32::try_from(since).unwrap_or(u32::MAX);
        Some(Answer {
            page: page.id.clone(),
            question: question.id.clone(),
            value: Some(value),
            text: None,
            first_ms: ms,
            ms,
            key: self.keys.to_string(),
        })
    }

    /// Any answer that can be given.
    fn any(&mut self, scale: &Scale<String>) -> i64 {
        match scale {
            Scale::Points { least, greatest, .. } | Scale::Number { least, greatest } => {
                let range = usize::try_from(greatest.saturating_sub(*least).saturating_add(1)).unwrap_or(1);
                least + i64::try_from(self.random.below(range)).unwrap_or(0)
            }
            Scale::Options { options } => {
                let index = self.random.below(options.len());
                options.get(index).map_or(0, |(value, _)| *value)
            }
            Scale::Text { .. } => 0,
        }
    }

    /// The answer of a participant who cares; none where any is as good.
    fn considered(
        &mut self,
        plan: &Plan,
        minds: &Minds,
        session: &Session,
        (page, question): (&Page, &PageQuestion),
    ) -> Option<i64> {
        if let Content::Check { questions, .. } = &page.content {
            let step = plan.steps.iter().find(|step| step.name == page.part)?;
            let StepKind::Check { prompts, right, .. } = &step.kind else { return None };
            let index = prompts.iter().position(|prompt| prompt.id == question.id)?;
            return right.get(index).copied().filter(|_| !questions.is_empty());
        }
        if let Scale::Points { least, greatest, .. } = question.scale
            && session.trial().is_none()
        {
            // forms about oneself: mostly well
            return Some(cut(self.random.unit() * self.random.unit() * 3.0, least, greatest));
        }
        let (trial, _) = session.trial()?;
        if let Role::Catch { answer } = trial.role {
            return Some(answer);
        }
        match (session.stimulus(plan, trial)?, &question.scale) {
            (Stimulus::Gait { gait }, Scale::Points { least, greatest, .. }) => {
                let (_, item) = question.id.split_once('.')?;
                let emotion = item.parse::<Emotion>().ok()?;
                let rating = minds.ratings.rate(gait, emotion, self.deviate, &mut self.random);
                // the model has five points, and a scale may have others
                Some(rating.max(*least).min(*greatest))
            }
            (Stimulus::Scene { scene, condition }, Scale::Points { least, greatest, .. }) => {
                let seen = Seen { scene, condition, position: trial.position };
                Some(minds.scenes.answer(seen, self.deviate, (*least, *greatest), &mut self.random))
            }
            (Stimulus::Agent { emotion, .. }, Scale::Options { options }) => {
                let shown = emotion.parse::<Emotion>().ok()?;
                let answered = identify(minds.confusion[shown.index()], &mut self.random);
                let named = |text: &str| text.parse::<Emotion>().ok();
                let has_names = options.iter().any(|(_, text)| named(text).is_some());
                let is_it = |(value, text): &&(i64, String)| match named(text) {
                    Some(emotion) => emotion.index() == answered,
                    // in another language: in the order of the program
                    None => !has_names && usize::try_from(*value).is_ok_and(|value| value == answered),
                };
                options.iter().find(is_it).map(|(value, _)| *value)
            }
            _ => None,
        }
    }
}
