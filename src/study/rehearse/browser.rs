//! One simulated browser.

use super::client::{Client, Failure, Reply, Sent};
use super::{Acknowledged, Hints, NoServer, Outcome, Rehearsal};
use crate::random::Random;
use crate::study::plan::{Ending, Scale};
use crate::study::protocol::{Answer, Content, Event, Exposure, Page, PageQuestion};
use axum::http::Method;
use serde::Deserialize;
use std::sync::PoisonError;
use std::time::{Duration, Instant};
use tokio::runtime::Runtime;

/// First and longest wait before a request is sent again.
const WAITS: [Duration; 2] = [Duration::from_millis(200), Duration::from_secs(8)];

/// How a participation ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    Finished,
    Left,
    TurnedAway,
}

/// Why a participation could not go on.
#[derive(Debug)]
pub(super) struct Lost(pub(super) String);

/// What the server says of a page to a program.
#[derive(Debug, Deserialize)]
struct State {
    page: Page,
    mark: String,
    code: String,
}

/// One simulated browser.
pub(super) struct Browser<'r> {
    rehearsal: &'r Rehearsal,
    hints: &'r Hints,
    /// What was answered to the check that was just sent.
    tried: Vec<((String, String), i64)>,
    client: Client<'r>,
    random: Random,
    /// Scheme and host.
    origin: String,
    /// What follows the host in the address of the first page.
    path: String,
    cookie: String,
    mark: String,
    code: String,
    answers: Vec<Acknowledged>,
    latencies: Vec<f64>,
    repeated: u64,
}

impl<'r> Browser<'r> {
    pub(super) fn new(
        runtime: &'r Runtime,
        rehearsal: &'r Rehearsal,
        hints: &'r Hints,
        random: Random,
    ) -> Self {
        let (scheme, rest) = rehearsal.address.split_once("://").unwrap_or(("http", &rehearsal.address));
        let (host, path) = rest.split_once('/').unwrap_or((rest, ""));
        let port = if host.contains(':') { "" } else { ":80" };
        Self {
            rehearsal,
            hints,
            tried: Vec::new(),
            client: Client::new(runtime, format!("{host}{port}")),
            random,
            origin: format!("{scheme}://{host}"),
            path: format!("/{path}"),
            cookie: String::new(),
            mark: String::new(),
            code: String::new(),
            answers: Vec::new(),
            latencies: Vec::new(),
            repeated: 0,
        }
    }

    /// Whether there is a server: asked once.
    pub(super) fn knock(&mut self) -> Result<(), NoServer> {
        let sent = Sent { method: Method::GET, path: &self.path, headers: &[], body: String::new() };
        let reason = match self.client.send(&sent) {
            Ok(reply) if (200..300).contains(&reply.status) => return Ok(()),
            Ok(reply) => format!("status {}", reply.status),
            Err(error) => error.to_string(),
        };
        Err(NoServer { address: self.rehearsal.address.clone(), reason })
    }

    /// Whether the server has let it in.
    pub(super) fn is_in(&self) -> bool {
        !self.code.is_empty()
    }

    pub(super) fn hand_over(self, outcome: &mut Outcome) {
        outcome.answers.extend(self.answers);
        outcome.latencies.extend(self.latencies);
        outcome.repeated += self.repeated;
    }

    /// Takes part from the first page to the last, or leaves.
    pub(super) fn take_part(&mut self) -> Result<End, Lost> {
        let begun = self.send("/begin", "application/x-www-form-urlencoded", "new=1")?;
        let status = begun.status;
        let Some(cookie) = begun.cookie.as_deref().and_then(|cookie| cookie.split(';').next()) else {
            // the page says that no one is let in
            return if status < 500 {
                Ok(End::TurnedAway)
            } else {
                Err(Lost(format!("begin: status {status}")))
            };
        };
        cookie.clone_into(&mut self.cookie);
        loop {
            let State { page, mark, code } = self.state()?;
            (self.mark, self.code) = (mark, code);
            self.learn(&page);
            match &page.content {
                Content::Ended { ending: Ending::Full, .. } => return Ok(End::TurnedAway),
                Content::Ended { .. } => return Ok(End::Finished),
                Content::Show { .. } if self.random.unit() < self.rehearsal.leaving => return Ok(End::Left),
                _ => self.answer_page(&page)?,
            }
        }
    }

    /// Tells the others what was answered to a check that was passed.
    fn learn(&mut self, page: &Page) {
        let tried = std::mem::take(&mut self.tried);
        if !matches!(page.content, Content::Check { .. } | Content::Ended { .. }) {
            self.hints.lock().unwrap_or_else(PoisonError::into_inner).extend(tried);
        }
    }

    /// What has passed a check before.
    fn hint(&self, part: &str, question: &str) -> Option<i64> {
        let key = (part.to_owned(), question.to_owned());
        self.hints.lock().unwrap_or_else(PoisonError::into_inner).get(&key).copied()
    }

    fn answer_page(&mut self, page: &Page) -> Result<(), Lost> {
        let id = page.id.clone();
        let event = match &page.content {
            Content::Consent { .. } => Event::Consented { text: String::new() },
            Content::Show { name, plays, .. } => {
                self.fetch(&format!("/stimuli/{name}"))?;
                let exposure = Exposure { plays: *plays, frames: 240, ..Exposure::default() };
                Event::Shown { page: id, exposure }
            }
            Content::Paused => {
                std::thread::sleep(WAITS[1]);
                return Ok(());
            }
            content => {
                for question in content.questions() {
                    let value = self.answer(page, question)?;
                    if matches!(content, Content::Check { .. }) {
                        let key = (page.part.clone(), question.id.clone());
                        self.tried.extend(value.map(|value| (key, value)));
                    }
                }
                Event::Next { page: id }
            }
        };
        let body = json(&event)?;
        self.acknowledged("/event", &body).map(drop)
    }

    /// Answers a question; returns the number.
    fn answer(&mut self, page: &Page, question: &PageQuestion) -> Result<Option<i64>, Lost> {
        let pause = self.rehearsal.pause.mul_f64(self.random.unit());
        std::thread::sleep(pause);
        let (value, text) = match &question.scale {
            Scale::Points { least, greatest, .. } | Scale::Number { least, greatest } => {
                let steps = usize::try_from(greatest - least + 1).unwrap_or(1);
                let step = i64::try_from(self.random.below(steps)).unwrap_or(0);
                (Some(least + step), None)
            }
            Scale::Options { options } => {
                let index = self.random.below(options.len());
                let any = options.get(index).map(|(value, _)| *value);
                (self.hint(&page.part, &question.id).or(any), None)
            }
            Scale::Text { .. } => (None, Some("rehearsal".to_owned())),
        };
        let ms = u32::try_from(pause.as_millis()).unwrap_or(u32::MAX);
        let key = format!("{:016x}", self.random.bits());
        let answer = Answer {
            page: page.id.clone(),
            question: question.id.clone(),
            value,
            text,
            first_ms: ms,
            ms,
            key: key.clone(),
        };
        let body = json(&answer)?;
        let sent = Instant::now();
        if self.acknowledged("/answer", &body)? {
            self.latencies.push(1000.0 * sent.elapsed().as_secs_f64());
        }
        let (code, page, question) = (self.code.clone(), page.id.clone(), question.id.clone());
        self.answers.push(Acknowledged { code, page, question, value, key });
        Ok(value)
    }

    /// Sends JSON until the server has stored it. Returns whether it did at once.
    fn acknowledged(&mut self, route: &str, body: &str) -> Result<bool, Lost> {
        let before = self.repeated;
        let Reply { status, text, .. } = self.send(route, "application/json", body)?;
        match status {
            200 => Ok(self.repeated == before),
            _ => Err(Lost(format!("{route}: status {status}: {text:.200}"))),
        }
    }

    fn state(&mut self) -> Result<State, Lost> {
        let path = format!("{}/go", self.path);
        let text = self.fetch(&path)?;
        serde_json::from_str(&text).map_err(|error| Lost(format!("{path}: {error}: {text:.200}")))
    }

    fn fetch(&mut self, path: &str) -> Result<String, Lost> {
        let cookie = self.cookie.clone();
        let headers = [("cookie", cookie.as_str()), ("accept", "application/json")];
        let sent = Sent { method: Method::GET, path, headers: &headers, body: String::new() };
        let Reply { status, text, .. } = self.insist(&sent)?;
        match status {
            200 => Ok(text),
            _ => Err(Lost(format!("{path}: status {status}: {text:.200}"))),
        }
    }

    fn send(&mut self, route: &str, kind: &str, body: &str) -> Result<Reply, Lost> {
        let path = format!("{}{route}", self.path);
        let (origin, cookie, mark) = (self.origin.clone(), self.cookie.clone(), self.mark.clone());
        let headers = [
            ("origin", origin.as_str()),
            ("sec-fetch-site", "same-origin"),
            ("content-type", kind),
            ("cookie", cookie.as_str()),
            ("x-participation", mark.as_str()),
        ];
        self.insist(&Sent { method: Method::POST, path: &path, headers: &headers, body: body.to_owned() })
    }

    /// Sends a request again until it is answered by something else than a failure of the server.
    fn insist(&mut self, sent: &Sent<'_>) -> Result<Reply, Lost> {
        let began = Instant::now();
        let mut wait = WAITS[0];
        loop {
            let reason = match self.client.send(sent) {
                Ok(reply) if reply.status < 500 && reply.status != 429 => return Ok(reply),
                Ok(reply) => format!("status {}", reply.status),
                Err(failure @ Failure::Request(_)) => return Err(Lost(format!("{}: {failure}", sent.path))),
                Err(failure) => failure.to_string(),
            };
            if began.elapsed() > self.rehearsal.patience || crate::stop::asked() {
                return Err(Lost(format!("{}: {reason}", sent.path)));
            }
            self.repeated += 1;
            std::thread::sleep(wait);
            wait = (2 * wait).min(WAITS[1]);
        }
    }
}

fn json<T: serde::Serialize>(value: &T) -> Result<String, Lost> {
    serde_json::to_string(value).map_err(|error| Lost(error.to_string()))
}
