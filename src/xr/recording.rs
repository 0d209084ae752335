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
//! step,x_m,z_m,y_m,vx,vz,head_x,...
//! 0,0.1,-2,0,0,0,...
//! # hash 30 81c4...               (hash of the session after so many steps: see [`SessionHash`])
//! # end 9c0d...                   (the same after the last step; missing if the session broke off)
//! ```
//!
//! Each line is written when its step is done: a program that is killed leaves all steps but the one it was doing. The
//! next start cuts a line that was not completed ([`repair`]).

mod hash;
mod place;

pub use hash::{SessionHash, hash_avatars, hash_library, hash_scenario, hash_start};
pub use place::{Way, make_way, repair};

use super::views::Pose;
use crate::kernels::Store;
use glam::{Quat, Vec2, Vec3};
use std::io::{BufRead, Write};

/// Version of the format.
const VERSION: u32 = 2;
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
    /// [`hash_start`].
    pub start: u64,
}

/// Fields of the header, after the first line.
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
    /// There is something at the recording's place that must not be lost.
    #[error("{0}")]
    Taken(&'static str),
}

const COLUMNS: &str = "step,x_m,z_m,y_m,vx,vz,head_x,head_y,head_z,head_qx,head_qy,head_qz,head_qw,left_x,left_y,left_z,\
                       left_qx,left_qy,left_qz,left_qw,right_x,right_y,right_z,right_qx,right_qy,right_qz,right_qw,\
                       walk_x,walk_y,turn";

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
    /// When it cannot be written.
    pub fn new(mut to: W, session: &Session) -> Result<Self, RecordingError> {
        let mut head = format!("# {FIRST} {VERSION}\n");
        for (key, value) in KEYS.iter().zip(session.values()) {
            head += &format!("# {key} {value}\n");
        }
        to.write_all(format!("{head}{COLUMNS}\n").as_bytes())?;
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
        let mut line = self.step.to_string();
        let ([x, z], [vx, vz]) = (user.place.to_array(), user.velocity.to_array());
        for value in [x, z, user.elevation, vx, vz] {
            line += &format!(",{value}");
        }
        for pose in [user.head, user.hands[0], user.hands[1]] {
            match pose {
                Some(pose) => pose.iter().for_each(|value| line += &format!(",{value}")),
                None => line += ",,,,,,,",
            }
        }
        user.sticks.iter().for_each(|value| line += &format!(",{value}"));
        line += "\n";
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
    /// What it is of.
    pub session: Session,
    /// The user, step by step.
    pub steps: Vec<UserState>,
    /// Hashes of the session after so many steps.
    pub hashes: Vec<(u32, u64)>,
    /// Hash of the session after the last step; none if it broke off.
    pub end: Option<u64>,
}

impl Recording {
    /// Reads a recording. A last line that was not completed does not count.
    ///
    /// # Errors
    /// When it cannot be read, or a line is not as it should be: which, and what is wrong.
    pub fn read(mut from: impl BufRead) -> Result<Self, RecordingError> {
        let mut head: [Option<String>; 11] = Default::default();
        let (mut steps, mut hashes, mut end) = (Vec::new(), Vec::new(), None);
        let (mut line, mut number) = (String::new(), 0);
        while from.read_line(&mut line)? > 0 && line.ends_with('\n') {
            number += 1;
            let wrong = |message: String| RecordingError::Line { line: number, message };
            let text = line.trim_end();
            if number == 1 {
                version(text).map_err(wrong)?;
            } else if let Some((key, value)) = text.strip_prefix("# ").and_then(|text| text.split_once(' ')) {
                match key {
                    "end" => end = Some(hex(value).map_err(|message| wrong(format!("end: {message}")))?),
                    "hash" => hashes.push(hash_after(value, steps.len()).map_err(wrong)?),
                    key => {
                        if let Some(place) = KEYS.iter().position(|known| *known == key) {
                            head[place] = Some(value.to_owned());
                        }
                    }
                }
            } else if !text.starts_with("step,") && !text.is_empty() {
                if steps.len() >= MOST_STEPS as usize {
                    return Err(wrong(format!("more than {MOST_STEPS} steps")));
                }
                steps.push(user_state(text, steps.len()).map_err(wrong)?);
            }
            line.clear();
        }
        if number == 0 {
            version("").map_err(|message| RecordingError::Line { line: 1, message })?;
        }
        Ok(Self { session: session(&head)?, steps, hashes, end })
    }

    /// Whether it is of this session.
    ///
    /// # Errors
    /// [`RecordingError::Other`] says what differs.
    pub fn must_be_of(&self, session: &Session) -> Result<(), RecordingError> {
        let pairs = self.session.values().into_iter().zip(session.values());
        let differences: Vec<String> = KEYS
            .iter()
            .zip(pairs)
            .filter(|(_, (recorded, now))| recorded != now)
            .map(|(key, (recorded, now))| format!("{key} {recorded} was recorded, this is {now}"))
            .collect();
        if differences.is_empty() { Ok(()) } else { Err(RecordingError::Other { differences }) }
    }
}

/// Checks the first line.
fn version(line: &str) -> Result<(), String> {
    let found = line.strip_prefix("# ").and_then(|line| line.strip_prefix(FIRST)).map(str::trim);
    match found {
        Some(version) if version.parse() == Ok(VERSION) => Ok(()),
        Some("1") => Err(format!(
            "format version 1, which holds neither condition nor gaze; this program reads {VERSION}. Replay it with the \
             version of gaitway that recorded it"
        )),
        Some(version) => Err(format!("format version {version:?}; this program reads {VERSION}")),
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

/// What the header says.
fn session(head: &[Option<String>; 11]) -> Result<Session, RecordingError> {
    let at = |key: usize, message: String| RecordingError::Line { line: key + 2, message };
    let value = |key: usize| head[key].as_deref().ok_or_else(|| at(key, format!("no `# {}`", KEYS[key])));
    let bad =
        |key: usize, found: &str| at(key, format!("{} {found:?} is not a number that it may be", KEYS[key]));
    let word = |key: usize| Ok::<_, RecordingError>(value(key)?.to_owned());
    let hash = |key: usize| hex(value(key)?).map_err(|message| at(key, format!("{}: {message}", KEYS[key])));
    let time_step = value(6)?.parse().ok().filter(|time_step: &f32| *time_step > 0.0 && *time_step <= 1.0);
    Ok(Session {
        version: word(0)?,
        scene: word(1)?,
        condition: word(2)?,
        gaze: word(3)?,
        agents: value(4)?.parse().map_err(|_error| bad(4, head[4].as_deref().unwrap_or("")))?,
        seed: value(5)?.parse().map_err(|_error| bad(5, head[5].as_deref().unwrap_or("")))?,
        time_step: time_step.ok_or_else(|| bad(6, head[6].as_deref().unwrap_or("")))?,
        scenario: hash(7)?,
        library: hash(8)?,
        avatars: hash(9)?,
        start: hash(10)?,
    })
}

/// One line of the table, which must be that of step `step`.
fn user_state(line: &str, step: usize) -> Result<UserState, String> {
    let fields: Vec<&str> = line.split(',').collect();
    let wanted = COLUMNS.split(',').count();
    if fields.len() != wanted {
        return Err(format!("{} fields; there must be {wanted}", fields.len()));
    }
    if fields[0].parse() != Ok(step) {
        return Err(format!("step {:?}; it should be {step}", fields[0]));
    }
    let number = |field: usize| match fields[field].parse::<f32>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("field {}: {:?} is not a finite number", field + 1, fields[field])),
    };
    let pose = |first: usize| {
        if fields[first..first + 7].iter().all(|field| field.is_empty()) {
            return Ok(None);
        }
        let mut values = [0.0; 7];
        for (place, value) in values.iter_mut().enumerate() {
            *value = number(first + place)?;
        }
        Ok::<_, String>(Some(values))
    };
    Ok(UserState {
        place: Vec2::new(number(1)?, number(2)?),
        elevation: number(3)?,
        velocity: Vec2::new(number(4)?, number(5)?),
        head: pose(6)?,
        hands: [pose(13)?, pose(20)?],
        sticks: [number(27)?, number(28)?, number(29)?],
    })
}

#[cfg(test)]
mod tests;
