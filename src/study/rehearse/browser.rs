//! One simulated browser.

use super::{Acknowledged, Hints, NoServer, Outcome, Rehearsal};
use crate::random::Random;
use crate::study::plan::{Ending, Scale};
use crate::study::protocol::{Answer, Content, Event, Exposure, Page, PageQuestion};
use serde::Deserialize;
use std::sync::PoisonError;
use std::time::{Duration, Instant};
use ureq::Agent;
use ureq::http::Response;

/// First and longest wait before a request is sent again.
const WAITS: [Duration; 2] = [Duration::from_millis(200), Duration::from_secs(8)];
/// Longest reply that is read, bytes.
const LONGEST_REPLY: u64 = 4 << 20;

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
    agent: Agent,
    random: Random,
    /// Scheme and host.
    origin: String,
    cookie: String,
    mark: String,
    code: String,
    answers: Vec<Acknowledged>,
    latencies: Vec<f64>,
    repeated: u64,
}

impl<'r> Browser<'r> {
    pub(super) fn new(rehearsal: &'r Rehearsal, hints: &'r Hints, random: Random) -> Self {
        let config = Agent::config_builder()
            .http_status_as_error(false)
            .max_redirects(0)
            .timeout_global(Some(Duration::from_secs(20)))
            .build();
        let host = rehearsal.address.splitn(4, '/').take(3).collect::<Vec<_>>();
        Self {
            rehearsal,
            hints,
            tried: Vec::new(),
            agent: config.into(),
            random,
            origin: host.join("/"),
            cookie: String::new(),
            mark: String::new(),
            code: String::new(),
            answers: Vec::new(),
            latencies: Vec::new(),
            repeated: 0,
        }
    }

    /// Whether there is a server: asked once.
    pub(super) fn knock(&self) -> Result<(), NoServer> {
        let address = self.rehearsal.address.clone();
        match self.agent.get(&address).call() {
            Ok(reply) if reply.status().is_success() => Ok(()),
            Ok(reply) => Err(NoServer { address, reason: format!("status {}", reply.status()) }),
            Err(error) => Err(NoServer { address, reason: error.to_string() }),
        }
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
        let status = begun.status().as_u16();
        let cookie = begun.headers().get("set-cookie").and_then(|value| value.to_str().ok());
        let Some(cookie) = cookie.and_then(|cookie| cookie.split(';').next()) else {
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
                self.fetch(&format!("{}/stimuli/{name}", self.origin))?;
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
        let mut reply = self.send(route, "application/json", body)?;
        let status = reply.status().as_u16();
        // the body belongs to the reply: the connection is used again
        let text = reply.body_mut().with_config().limit(LONGEST_REPLY).read_to_string().unwrap_or_default();
        match status {
            200 => Ok(self.repeated == before),
            _ => Err(Lost(format!("{route}: status {status}: {text:.200}"))),
        }
    }

    fn state(&mut self) -> Result<State, Lost> {
        let url = format!("{}/go", self.rehearsal.address);
        let text = self.fetch(&url)?;
        serde_json::from_str(&text).map_err(|error| Lost(format!("{url}: {error}: {text:.200}")))
    }

    fn fetch(&mut self, url: &str) -> Result<String, Lost> {
        let cookie = self.cookie.clone();
        let mut reply = self.insist(url, |agent| {
            agent.get(url).header("cookie", &cookie).header("accept", "application/json").call()
        })?;
        let status = reply.status().as_u16();
        let text = reply.body_mut().with_config().limit(LONGEST_REPLY).read_to_string();
        match (status, text) {
            (200, Ok(text)) => Ok(text),
            (status, text) => Err(Lost(format!("{url}: status {status}: {:.200}", text.unwrap_or_default()))),
        }
    }

    fn send(&mut self, route: &str, kind: &str, body: &str) -> Result<Response<ureq::Body>, Lost> {
        let url = format!("{}{route}", self.rehearsal.address);
        let (origin, cookie, mark) = (self.origin.clone(), self.cookie.clone(), self.mark.clone());
        self.insist(&url, |agent| {
            agent
                .post(&url)
                .header("origin", &origin)
                .header("sec-fetch-site", "same-origin")
                .header("content-type", kind)
                .header("cookie", &cookie)
                .header("x-participation", &mark)
                .send(body)
        })
    }

    /// Sends a request again until it is answered by something else than a failure of the server.
    fn insist(
        &mut self,
        url: &str,
        request: impl Fn(&Agent) -> Result<Response<ureq::Body>, ureq::Error>,
    ) -> Result<Response<ureq::Body>, Lost> {
        let began = Instant::now();
        let mut wait = WAITS[0];
        loop {
            let reply = request(&self.agent);
            let reason = match reply {
                Ok(reply) if reply.status().as_u16() < 500 && reply.status().as_u16() != 429 => {
                    return Ok(reply);
                }
                Ok(reply) => format!("status {}", reply.status()),
                Err(error) => error.to_string(),
            };
            if began.elapsed() > self.rehearsal.patience || crate::stop::asked() {
                return Err(Lost(format!("{url}: {reason}")));
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
