//! What the user did, step by step, in a text file: to audit a study, or to reproduce a fault.
//!
//! The crowd depends on the user only through the place, height and velocity that it receives before each step. These are
//! written with all their bits, so a replay gives the same crowd, bit for bit, on any device whose arithmetic is exact. Head, hands and sticks are kept beside them. The header holds everything else that a session depends on;
//! a replay of something else is refused with what differs.
//!
//! ```text
//! # gaitway recording 2
//! # version 0.1.0
//! # scene crossing
//! # condition eva-g
//! # gaze natural
//! # agents 2000
//! # seed 1
//! # time_step 0.033333335
//! # scenario 3c1f...              (hash of the scenario as it runs, with what the command line changed)
//! # library 90ab...               (hash of the gaits)
//! # avatars 77de...               (hash of the bodies)
//! # start 5f0c2a9bd1e37744        (hash of the crowd before the first step)
//! # study eva-agents              (of a trial of a study: these four, which no replay depends on)
//! # participant k7q4...
//! # part scenes
//! # trial 7
//! step,x_m,z_m,y_m,vx,vz,head_x,...
//! 0,0.1,-2,0,0,0,...
//! # hash 30 81c4...               (hash of the session after so many steps: see [`SessionHash`])
//! # end 9c0d...                   (the same after the last step; missing if the session broke off)
//! ```
//!
//! Each line is written when its step is done: a program that is killed leaves all steps but the one it was doing. The
//! next start cuts a line that was not completed ([`repair`]).
//!
//! Format 1 is still read. It says neither condition nor gaze, has no heights and no hashes but those of the crowd at start
//! and end.

mod hash;
mod line;
mod place;

pub use hash::{SessionHash, hash_avatars, hash_library, hash_scenario, hash_start};
pub use place::{Way, make_way, repair};

use super::views::Pose;
use crate::kernels::Store;
use crate::library::GaitLibrary;
use crate::scenario::{Condition, GazeMode};
use crate::scene::Scene;
use glam::{Quat, Vec2, Vec3};
use std::io::{BufRead, Write};

/// Version of the format.
const VERSION: u32 = 2;
/// The format before.
const FIRST_VERSION: u32 = 1;
/// How every recording begins, of whatever version.
const FIRST: &str = "gaitway recording";
/// Most steps of one recording: twelve hours at 100 steps a second.
const MOST_STEPS: u32 = 4_320_000;
/// Seconds of the crowd between two hashes in the file.
const HASH_EVERY: f32 = 1.0;

/// What a recording was made of.
#[derive(Debug, Clone, PartialEq)]
pub struct Session {
    /// Version of gaitway.
    pub version: String,
    /// The scenario's name.
    pub scene: String,
    /// The condition of the study.
    pub condition: String,
    /// The formulas of the gaze.
    pub gaze: String,
    /// Agents.
    pub agents: u32,
    /// Seed.
    pub seed: u64,
    /// Length of a step, s.
    pub time_step: f32,
    /// [`hash_scenario`].
    pub scenario: u64,
    /// [`hash_library`].
    pub library: u64,
    /// [`hash_avatars`].
    pub avatars: u64,
    /// [`hash_start`]; in format 1 the hash of the crowd's state.
    pub start: u64,
    /// Which trial of a study it is.
    pub trial: Option<TrialLabel>,
}

/// Which trial of a study a recording is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TrialLabel {
    /// The study.
    pub study: String,
    /// The participant's code.
    pub participant: String,
    /// The part of the study.
    pub part: String,
    /// Number of the trial in its part, from 1.
    pub trial: u32,
}

/// Fields of a [`TrialLabel`] in the header. They name the recording and are no part of what is replayed.
const LABEL_KEYS: [&str; 4] = ["study", "participant", "part", "trial"];

/// Fields of the header, after the first line, on which a replay depends.
const KEYS: [&str; 11] = [
    "version",
    "scene",
    "condition",
    "gaze",
    "agents",
    "seed",
    "time_step",
    "scenario",
    "library",
    "avatars",
    "start",
];

impl Session {
    /// Of a scene at its start, which stands in `store`, walked by the gaits of a library.
    pub fn of(scene: &Scene, library: &GaitLibrary, store: &Store) -> Self {
        let scenario = &scene.scenario;
        let condition = match scenario.condition {
            Condition::Baseline => "baseline",
            Condition::EvaO => "eva-o",
            Condition::EvaG => "eva-g",
        };
        let gaze = match scenario.gaze.mode {
            GazeMode::Natural => "natural",
            GazeMode::Paper => "paper",
        };
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            scene: scenario.name.clone(),
            condition: condition.to_owned(),
            gaze: gaze.to_owned(),
            agents: store.step.agent_count,
            seed: scenario.seed,
            time_step: store.step.time_step,
            scenario: hash_scenario(scenario),
            library: hash_library(library),
            avatars: hash_avatars(scene.cast.avatars()),
            start: hash_start(store),
            trial: None,
        }
    }

    /// The values of [`KEYS`] as they are written.
    fn values(&self) -> [String; 11] {
        let hex = |hash: u64| format!("{hash:016x}");
        [
            self.version.clone(),
            self.scene.clone(),
            self.condition.clone(),
            self.gaze.clone(),
            self.agents.to_string(),
            self.seed.to_string(),
            self.time_step.to_string(),
            hex(self.scenario),
            hex(self.library),
            hex(self.avatars),
            hex(self.start),
        ]
    }

    /// Steps between two hashes in the file.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a second of steps of a millisecond or more"
    )]
    pub fn hash_every(&self) -> u32 {
        ((HASH_EVERY / self.time_step).round() as u32).max(1)
    }
}

/// The user in one step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct UserState {
    /// Place on the ground, m.
    pub place: Vec2,
    /// Height of the floor that the user stands on, m.
    pub elevation: f32,
    /// Velocity, m/s.
    pub velocity: Vec2,
    /// Head in the world: position, m, and rotation x, y, z, w; none while it is not tracked.
    pub head: Option<[f32; 7]>,
    /// Hands, likewise.
    pub hands: [Option<[f32; 7]>; 2],
    /// Walking stick x, y and turning stick x.
    pub sticks: [f32; 3],
}

/// A pose as it is written.
pub(super) fn numbers(pose: Pose) -> [f32; 7] {
    let ([x, y, z], [a, b, c, d]) = (pose.position.to_array(), pose.rotation.to_array());
    [x, y, z, a, b, c, d]
}

impl UserState {
    /// Position and rotation of the head in the world.
    pub fn head_pose(&self) -> Option<(Vec3, Quat)> {
        self.head.map(|[x, y, z, a, b, c, d]| (Vec3::new(x, y, z), Quat::from_xyzw(a, b, c, d)))
    }
}

/// A recording could not be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The file cannot be written or read.
    #[error("recording: {0}")]
    File(#[from] std::io::Error),
    /// A line is not as it should be.
    #[error("recording, line {line}: {message}")]
    Line {
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong.
        message: String,
    },
    /// The recording is of another session.
    #[error("the recording is of another session: {}", .differences.join("; "))]
    Other {
        /// What differs, one line each: its name, as recorded, as it is now.
        differences: Vec<String>,
    },
    /// A field of the header cannot be written.
    #[error("recording: {key} {value:?} must be one line of at least one character")]
    Field {
        /// The field.
        key: &'static str,
        /// Its value.
        value: String,
    },
    /// There is something at the recording's place that must not be lost.
    #[error("{0}")]
    Taken(&'static str),
}

/// Writes a recording, step by step, each line at once.
#[derive(Debug)]
pub struct Recorder<W: Write> {
    to: W,
    step: u32,
    every: u32,
    hash: SessionHash,
}

impl<W: Write> Recorder<W> {
    /// Begins a recording.
    ///
    /// # Errors
    /// When it cannot be written, or a field of the header is not one line.
    pub fn new(mut to: W, session: &Session) -> Result<Self, RecordingError> {
        let mut head = format!("# {FIRST} {VERSION}\n");
        let labels = session.trial.iter().flat_map(|of| {
            let values = [of.study.clone(), of.participant.clone(), of.part.clone(), of.trial.to_string()];
            LABEL_KEYS.into_iter().zip(values)
        });
        for (key, value) in KEYS.into_iter().zip(session.values()).chain(labels) {
            if value.trim() != value || value.is_empty() || value.contains(char::is_control) {
                return Err(RecordingError::Field { key, value });
            }
            head += &format!("# {key} {value}\n");
        }
        to.write_all(format!("{head}{}\n", line::COLUMNS).as_bytes())?;
        to.flush()?;
        Ok(Self { to, step: 0, every: session.hash_every(), hash: SessionHash::new(session) })
    }

    /// Steps written so far.
    pub fn steps(&self) -> u32 {
        self.step
    }

    /// Adds a step that the crowd has done with the user as they were, and the crowd after it.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn step(&mut self, user: &UserState, crowd: &Store) -> Result<(), RecordingError> {
        self.hash.step(user, crowd);
        let mut line = line::written(self.step, user);
        self.step += 1;
        if self.step.is_multiple_of(self.every) {
            line += &format!("# hash {} {:016x}\n", self.step, self.hash.with(crowd));
        }
        // one call for the line, or a program that is killed would leave a part of it
        self.to.write_all(line.as_bytes())?;
        Ok(self.to.flush()?)
    }

    /// Completes the recording with the hash of the session, of which this is the crowd after the last step.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn finish(mut self, crowd: &Store) -> Result<W, RecordingError> {
        self.to.write_all(format!("# end {:016x}\n", self.hash.with(crowd)).as_bytes())?;
        self.to.flush()?;
        Ok(self.to)
    }

    /// The writer of a recording that is given up.
    pub fn into_inner(self) -> W {
        self.to
    }
}

/// A recording that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Version of its format, 1 or 2.
    pub format: u32,
    /// What it is of. In format 1 `version`, `condition` and `gaze` are empty, and the hashes but `start` 0: it does not say.
    pub session: Session,
    /// The user, step by step.
    pub steps: Vec<UserState>,
    /// Hashes of the session after so many steps; none in format 1.
    pub hashes: Vec<(u32, u64)>,
    /// Hash of the session after the last step, in format 1 of the crowd's state; none if it broke off.
    pub end: Option<u64>,
}

impl Recording {
    /// Reads a recording. A last line that was not completed does not count.
    ///
    /// # Errors
    /// When it cannot be read, or a line is not as it should be: which, and what is wrong.
    pub fn read(mut from: impl BufRead) -> Result<Self, RecordingError> {
        let mut head = Head::default();
        let (mut steps, mut hashes, mut end) = (Vec::new(), Vec::new(), None);
        let (mut line, mut number, mut format) = (String::new(), 0, VERSION);
        while from.read_line(&mut line)? > 0 && line.ends_with('\n') {
            number += 1;
            let wrong = |message: String| RecordingError::Line { line: number, message };
            let text = line.trim_end();
            if number == 1 {
                format = version(text).map_err(wrong)?;
            } else if let Some((key, value)) = text.strip_prefix("# ").and_then(|text| text.split_once(' ')) {
                match key {
                    "end" => end = Some(hex(value).map_err(|message| wrong(format!("end: {message}")))?),
                    "hash" => hashes.push(hash_after(value, steps.len()).map_err(wrong)?),
                    key => head.take(key, value),
                }
            } else if !text.starts_with("step,") && !text.is_empty() {
                if steps.len() >= MOST_STEPS as usize {
                    return Err(wrong(format!("more than {MOST_STEPS} steps")));
                }
                steps.push(line::user_state(text, steps.len(), format).map_err(wrong)?);
            }
            line.clear();
        }
        if number == 0 {
            version("").map_err(|message| RecordingError::Line { line: 1, message })?;
        }
        Ok(Self { format, session: head.session(format)?, steps, hashes, end })
    }

    /// Whether it does not say its condition: format 1.
    pub fn is_silent(&self) -> bool {
        self.format == FIRST_VERSION
    }

    /// Whether it is of this session.
    ///
    /// # Errors
    /// [`RecordingError::Other`] says what differs, of that which the format says.
    pub fn must_be_of(&self, session: &Session) -> Result<(), RecordingError> {
        let pairs = self.session.values().into_iter().zip(session.values());
        let differences: Vec<String> = KEYS
            .iter()
            .zip(pairs)
            .filter(|(key, (recorded, now))| says(self.format, key) && recorded != now)
            .map(|(key, (recorded, now))| format!("{key} {recorded} was recorded, this is {now}"))
            .collect();
        if differences.is_empty() { Ok(()) } else { Err(RecordingError::Other { differences }) }
    }
}

/// Whether the header of a format says this. The hash of the start is another one in format 1.
fn says(format: u32, key: &str) -> bool {
    format != FIRST_VERSION || ["scene", "agents", "seed", "time_step"].contains(&key)
}

/// The version that the first line names.
fn version(line: &str) -> Result<u32, String> {
    let found = line.strip_prefix("# ").and_then(|line| line.strip_prefix(FIRST)).map(str::trim);
    match found.map(|found| (found, found.parse::<u32>())) {
        Some((_, Ok(version))) if (FIRST_VERSION..=VERSION).contains(&version) => Ok(version),
        Some((found, _)) => {
            Err(format!("format version {found:?}; this program reads {FIRST_VERSION} and {VERSION}"))
        }
        None => Err(format!("does not begin with `# {FIRST} {VERSION}`")),
    }
}

fn hex(text: &str) -> Result<u64, String> {
    u64::from_str_radix(text, 16).map_err(|error| format!("{text:?}: {error}"))
}

/// `STEPS HASH`, which stands after that many lines of the table.
fn hash_after(text: &str, steps: usize) -> Result<(u32, u64), String> {
    let (after, hash) =
        text.split_once(' ').ok_or_else(|| format!("hash {text:?}: must be steps and a hash"))?;
    match after.parse::<u32>() {
        Ok(after) if after as usize == steps => Ok((after, hex(hash)?)),
        _ => Err(format!("hash after {after:?} steps; it stands after {steps}")),
    }
}

/// The header as it was read.
#[derive(Debug, Default)]
struct Head {
    values: [Option<String>; KEYS.len()],
    labels: [Option<String>; LABEL_KEYS.len()],
}

impl Head {
    fn take(&mut self, key: &str, value: &str) {
        let known = KEYS.iter().zip(&mut self.values).chain(LABEL_KEYS.iter().zip(&mut self.labels));
        if let Some((_, place)) = known.into_iter().find(|(known, _)| **known == key) {
            *place = Some(value.to_owned());
        }
    }

    /// What it says.
    fn session(&self, format: u32) -> Result<Session, RecordingError> {
        let at = |key: usize, message: String| RecordingError::Line { line: key + 2, message };
        let value = |key: usize| match &self.values[key] {
            Some(value) => Ok(Some(value.as_str())),
            None if says(format, KEYS[key]) => Err(at(key, format!("no `# {}`", KEYS[key]))),
            None => Ok(None),
        };
        let bad = |key: usize, found: &str| {
            at(key, format!("{} {found:?} is not a number that it may be", KEYS[key]))
        };
        let word = |key: usize| Ok::<_, RecordingError>(value(key)?.unwrap_or_default().to_owned());
        let hash = |key: usize| {
            let read = |text| hex(text).map_err(|message| at(key, format!("{}: {message}", KEYS[key])));
            value(key)?.map_or(Ok(0), read)
        };
        let number = |key: usize| Ok::<_, RecordingError>(value(key)?.unwrap_or_default());
        let time_step = number(6)?;
        let is_step = |step: &f32| *step > 0.0 && *step <= 1.0;
        Ok(Session {
            version: word(0)?,
            scene: word(1)?,
            condition: word(2)?,
            gaze: word(3)?,
            agents: number(4)?.parse().map_err(|_error| bad(4, number(4).unwrap_or_default()))?,
            seed: number(5)?.parse().map_err(|_error| bad(5, number(5).unwrap_or_default()))?,
            time_step: time_step.parse().ok().filter(is_step).ok_or_else(|| bad(6, time_step))?,
            scenario: hash(7)?,
            library: hash(8)?,
            avatars: hash(9)?,
            start: hash(10)?,
            trial: self.trial()?,
        })
    }

    /// The trial, if it names one.
    fn trial(&self) -> Result<Option<TrialLabel>, RecordingError> {
        let [Some(study), Some(participant), Some(part), Some(trial)] = &self.labels else { return Ok(None) };
        let line = KEYS.len() + LABEL_KEYS.len() + 1;
        let wrong = |error| RecordingError::Line { line, message: format!("trial {trial:?}: {error}") };
        let trial = trial.parse().map_err(wrong)?;
        let [study, participant, part] = [study, participant, part].map(Clone::clone);
        Ok(Some(TrialLabel { study, participant, part, trial }))
    }
}

#[cfg(test)]
mod tests;
