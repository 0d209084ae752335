//! Simulated browsers at a running server: a rehearsal before people come, and a measure of how much it stands.
//!
//! They speak HTTP as the page's script does: an answer is sent with a key, again and again until it is acknowledged. They know
//! no more than a browser knows, but tell one another which answers have passed a check. What they answer means nothing.

mod browser;
mod client;

use crate::random::Random;
use browser::{Browser, End, Lost};
use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};
use tokio::runtime::Builder;

/// Threads that wait for all connections.
const WORKERS: usize = 2;

/// How many simulated browsers come, and what they do.
#[derive(Debug, Clone, PartialEq)]
pub struct Rehearsal {
    /// Address of the first page, such as `http://127.0.0.1:8080/s/eva-gaits`.
    pub address: String,
    /// Most that come.
    pub participants: u32,
    /// Most at the same time.
    pub at_once: u32,
    /// Chance of leaving at each page with trials, 0 to 1.
    pub leaving: f64,
    /// Longest pause between two answers; each is drawn from 0 on.
    pub pause: Duration,
    /// How long a request is sent again while the server does not answer.
    pub patience: Duration,
    /// Seed of all draws.
    pub seed: u64,
}

/// Answers that have passed checks, by page and question.
type Hints = Mutex<BTreeMap<(String, String), i64>>;

/// An answer that the server has acknowledged.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Acknowledged {
    /// The participant's code.
    pub code: String,
    /// The page.
    pub page: String,
    /// The question.
    pub question: String,
    /// The number; none for free text.
    pub value: Option<i64>,
    /// The answer's key.
    pub key: String,
}

/// What came of a rehearsal.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outcome {
    /// Browsers that were let in.
    pub arrived: u32,
    /// That came to the end.
    pub finished: u32,
    /// That left before.
    pub left: u32,
    /// That found no place.
    pub turned_away: u32,
    /// That gave up: a request was not answered for longer than `patience`, or not as it should be.
    pub lost: Vec<String>,
    /// All acknowledged answers, in no order of participants.
    pub answers: Vec<Acknowledged>,
    /// Requests that were sent again.
    pub repeated: u64,
    /// From sending an answer to its acknowledgement, those at once, ms, in ascending order.
    pub latencies: Vec<f64>,
    /// From the first request to the last reply, s.
    pub seconds: f64,
}

impl Outcome {
    /// Acknowledged answers a second.
    #[allow(clippy::cast_precision_loss, reason = "a count of answers")]
    pub fn rate(&self) -> f64 {
        self.answers.len() as f64 / self.seconds.max(1e-9)
    }

    /// The latency that a share of the answers does not exceed, ms; 0 without answers.
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a rank, 1 to the number of answers"
    )]
    pub fn latency(&self, share: f64) -> f64 {
        let rank = (share * self.latencies.len() as f64).ceil().max(1.0) as usize;
        self.latencies.get(rank - 1).copied().unwrap_or(0.0)
    }
}

/// Nothing answers at an address.
#[derive(Debug, thiserror::Error)]
#[error("nothing answers at {address}: {reason}")]
pub struct NoServer {
    /// The address.
    pub address: String,
    /// Why.
    pub reason: String,
}

/// Rehearses a study that is being served. Ends when all participants are through, or none is let in any more.
///
/// # Errors
/// [`NoServer`] when nothing answers at the address. Later failures are in [`Outcome::lost`].
pub fn rehearse(rehearsal: &Rehearsal) -> Result<Outcome, NoServer> {
    let hints = Hints::default();
    let failed =
        |error: std::io::Error| NoServer { address: rehearsal.address.clone(), reason: error.to_string() };
    let runtime = Builder::new_multi_thread().worker_threads(WORKERS).enable_all().build().map_err(failed)?;
    Browser::new(&runtime, rehearsal, &hints, Random::new(0)).knock()?;
    let next = AtomicU32::new(0);
    let outcome = Mutex::new(Outcome::default());
    let began = Instant::now();
    let work = || {
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= rehearsal.participants || crate::stop::asked() {
                return;
            }
            let mut seed = Random::new(rehearsal.seed ^ (u64::from(number) << 32));
            let mut browser = Browser::new(&runtime, rehearsal, &hints, Random::new(seed.bits()));
            let ended = browser.take_part();
            let is_full = matches!(ended, Ok(End::TurnedAway));
            let mut outcome = outcome.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            outcome.arrived += u32::from(browser.is_in());
            match ended {
                Ok(End::Finished) => outcome.finished += 1,
                Ok(End::Left) => outcome.left += 1,
                Ok(End::TurnedAway) => outcome.turned_away += 1,
                Err(Lost(reason)) => outcome.lost.push(reason),
            }
            browser.hand_over(&mut outcome);
            if is_full {
                next.store(rehearsal.participants, Ordering::Relaxed);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..rehearsal.at_once.max(1) {
            scope.spawn(work);
        }
    });
    let mut outcome = outcome.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    outcome.latencies.sort_by(f64::total_cmp);
    outcome.seconds = began.elapsed().as_secs_f64();
    Ok(outcome)
}
