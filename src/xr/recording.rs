//! What the user did, step by step, in a text file: to audit a study, or to meet a fault again.
//!
//! The crowd depends on the user through nothing but the place and velocity that it is told before each step, and both
//! are written with all their bits, so a replay gives the same crowd, bit for bit, on any device whose arithmetic is
//! exact. The crowd's start is made by the host with the sines and logarithms of its C library, whose last bits differ
//! from one version to another: a replay on such a machine is refused. Head, hands and sticks are kept beside them.
//!
//! ```text
//! # gaitway recording 1
//! # scene crossing
//! # agents 2000
//! # seed 1
//! # time_step 0.033333335
//! # start 5f0c2a9bd1e37744          (hash of the crowd before the first step)
//! step,x_m,z_m,vx,vz,head_x,...
//! 0,0.1,-2,0,0,...
//! # end 9c0d...                     (hash after the last step; missing if the session broke off)
//! ```

use super::views::Pose;
use glam::{Quat, Vec2, Vec3};
use std::io::{BufRead, Write};

/// Version of the format.
const VERSION: u32 = 1;
/// Most steps of one recording: twelve hours at 100 steps a second.
const MOST_STEPS: u32 = 4_320_000;

/// What a recording was made of.
#[derive(Debug, Clone, PartialEq)]
pub struct Session {
    /// The scenario's name.
    pub scene: String,
    /// Agents.
    pub agents: u32,
    /// Seed.
    pub seed: u64,
    /// Length of a step, s.
    pub time_step: f32,
    /// Hash of the crowd before the first step.
    pub start: u64,
}

/// The user in one step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moment {
    /// Place on the ground, m.
    pub place: Vec2,
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

impl Moment {
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
    /// The recording is of another crowd.
    #[error("the recording is of {recorded}, not of {wanted}")]
    Other {
        /// What it is of.
        recorded: String,
        /// What it should be of.
        wanted: String,
    },
}

const COLUMNS: &str = "step,x_m,z_m,vx,vz,head_x,head_y,head_z,head_qx,head_qy,head_qz,head_qw,left_x,left_y,left_z,\
                       left_qx,left_qy,left_qz,left_qw,right_x,right_y,right_z,right_qx,right_qy,right_qz,right_qw,\
                       walk_x,walk_y,turn";

/// Writes a recording, step by step, to wherever it shall go.
#[derive(Debug)]
pub struct Recorder<W: Write> {
    to: W,
    step: u32,
}

impl<W: Write> Recorder<W> {
    /// Begins a recording.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn new(mut to: W, session: &Session) -> Result<Self, RecordingError> {
        let Session { scene, agents, seed, time_step, start } = session;
        write!(
            to,
            "# gaitway recording {VERSION}\n# scene {scene}\n# agents {agents}\n# seed {seed}\n# time_step {time_step}\n\
             # start {start:016x}\n{COLUMNS}\n"
        )?;
        Ok(Self { to, step: 0 })
    }

    /// Steps written so far.
    pub fn steps(&self) -> u32 {
        self.step
    }

    /// Adds the step that the crowd is about to do.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn step(&mut self, moment: &Moment) -> Result<(), RecordingError> {
        let ([x, z], [vx, vz]) = (moment.place.to_array(), moment.velocity.to_array());
        write!(self.to, "{},{x},{z},{vx},{vz}", self.step)?;
        for pose in [moment.head, moment.hands[0], moment.hands[1]] {
            match pose {
                Some(pose) => pose.iter().try_for_each(|value| write!(self.to, ",{value}"))?,
                None => write!(self.to, ",,,,,,,")?,
            }
        }
        moment.sticks.iter().try_for_each(|value| write!(self.to, ",{value}"))?;
        writeln!(self.to)?;
        self.step += 1;
        Ok(())
    }

    /// Completes the recording with the hash of the crowd after the last step.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn finish(mut self, end: u64) -> Result<W, RecordingError> {
        writeln!(self.to, "# end {end:016x}")?;
        self.to.flush()?;
        Ok(self.to)
    }
}

/// A recording that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// What it is of.
    pub session: Session,
    /// The user, step by step.
    pub moments: Vec<Moment>,
    /// Hash of the crowd after the last step; none if the session broke off.
    pub end: Option<u64>,
}

impl Recording {
    /// Reads a recording.
    ///
    /// # Errors
    /// When it cannot be read, or a line is not as it should be: which, and what is wrong.
    pub fn read(from: impl BufRead) -> Result<Self, RecordingError> {
        let mut head: [Option<String>; 6] = Default::default();
        const KEYS: [&str; 6] = ["gaitway recording", "scene", "agents", "seed", "time_step", "start"];
        let (mut moments, mut end) = (Vec::new(), None);
        for (index, line) in from.lines().enumerate() {
            let (line, number) = (line?, index + 1);
            let wrong = |message: String| RecordingError::Line { line: number, message };
            if let Some(comment) = line.strip_prefix("# ") {
                if let Some(hash) = comment.strip_prefix("end ") {
                    let hash = u64::from_str_radix(hash.trim(), 16);
                    end = Some(hash.map_err(|error| wrong(format!("end: {error}")))?);
                }
                for (key, value) in KEYS.iter().zip(&mut head) {
                    if let Some(found) = comment.strip_prefix(key).and_then(|rest| rest.strip_prefix(' ')) {
                        *value = Some(found.trim().to_owned());
                    }
                }
            } else if !line.starts_with("step,") && !line.trim().is_empty() {
                if moments.len() >= MOST_STEPS as usize {
                    return Err(wrong(format!("more than {MOST_STEPS} steps")));
                }
                moments.push(moment(&line, moments.len()).map_err(wrong)?);
            }
        }
        let missing = |key: usize| RecordingError::Line { line: 1, message: format!("no `# {}`", KEYS[key]) };
        let value = |key: usize| head[key].as_deref().ok_or_else(|| missing(key));
        let bad = |key: usize, found: &str| RecordingError::Line {
            line: key + 1,
            message: format!("{} {found:?} is not a number that it may be", KEYS[key]),
        };
        let version = value(0)?;
        if version.parse() != Ok(VERSION) {
            let message = format!("format version {version:?}; this program reads {VERSION}");
            return Err(RecordingError::Line { line: 1, message });
        }
        let time_step: f32 = value(4)?.parse().map_err(|_error| bad(4, head[4].as_deref().unwrap_or("")))?;
        if !(time_step > 0.0 && time_step <= 1.0) {
            return Err(bad(4, value(4)?));
        }
        let session = Session {
            scene: value(1)?.to_owned(),
            agents: value(2)?.parse().map_err(|_error| bad(2, head[2].as_deref().unwrap_or("")))?,
            seed: value(3)?.parse().map_err(|_error| bad(3, head[3].as_deref().unwrap_or("")))?,
            time_step,
            start: u64::from_str_radix(value(5)?, 16)
                .map_err(|_error| bad(5, head[5].as_deref().unwrap_or("")))?,
        };
        Ok(Self { session, moments, end })
    }

    /// Whether it is of this crowd.
    ///
    /// # Errors
    /// [`RecordingError::Other`] says what it is of instead.
    pub fn must_be_of(&self, session: &Session) -> Result<(), RecordingError> {
        if self.session == *session {
            return Ok(());
        }
        let words = |s: &Session| {
            format!(
                "{}, {} agents, seed {}, steps of {} s, start {:016x}",
                s.scene, s.agents, s.seed, s.time_step, s.start
            )
        };
        Err(RecordingError::Other { recorded: words(&self.session), wanted: words(session) })
    }
}

/// One line of the table, which must be that of step `step`.
fn moment(line: &str, step: usize) -> Result<Moment, String> {
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
    Ok(Moment {
        place: Vec2::new(number(1)?, number(2)?),
        velocity: Vec2::new(number(3)?, number(4)?),
        head: pose(5)?,
        hands: [pose(12)?, pose(19)?],
        sticks: [number(26)?, number(27)?, number(28)?],
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;

    fn session() -> Session {
        Session { scene: "crossing".into(), agents: 7, seed: u64::MAX, time_step: 1.0 / 30.0, start: 0x0123 }
    }

    fn written() -> (Vec<Moment>, String) {
        let odd = |i: u32| f32::from_bits(0x3f80_0000 + i * 7919);
        let moments: Vec<Moment> = (0..40)
            .map(|i| Moment {
                place: Vec2::new(odd(i), -odd(i + 1) * 1e-3),
                velocity: Vec2::new(odd(2 * i) - 1.0, 1e-30),
                head: (i % 3 > 0).then(|| [odd(i), 1.6, -0.0, 0.0, odd(i), 0.0, 1.0]),
                hands: [None, (i % 2 == 0).then_some([0.1; 7])],
                sticks: [0.0, odd(i), -1.0],
            })
            .collect();
        let mut recorder = Recorder::new(Vec::new(), &session()).unwrap();
        for moment in &moments {
            recorder.step(moment).unwrap();
        }
        (moments, String::from_utf8(recorder.finish(0xfeed).unwrap()).unwrap())
    }

    #[test]
    fn what_is_written_is_read_back_with_all_its_bits() {
        let (moments, text) = written();
        let read = Recording::read(text.as_bytes()).unwrap();
        assert_eq!((read.session.clone(), read.end), (session(), Some(0xfeed)));
        assert_eq!(read.moments.len(), moments.len());
        for (a, b) in read.moments.iter().zip(&moments) {
            let bits = |m: &Moment| [m.place.x, m.place.y, m.velocity.x, m.velocity.y].map(f32::to_bits);
            assert_eq!(bits(a), bits(b));
            assert_eq!(a, b);
        }
        read.must_be_of(&session()).unwrap();
        let other = Session { seed: 2, ..session() };
        assert!(read.must_be_of(&other).unwrap_err().to_string().contains("seed 2"));
    }

    #[test]
    fn a_broken_file_is_refused_at_its_line() {
        let (_, text) = written();
        let refused = |text: String, want: &str| {
            let error = Recording::read(text.as_bytes()).unwrap_err().to_string();
            assert!(error.contains(want), "{error}");
        };
        refused(text.replace("recording 1", "recording 9"), "version \"9\"");
        refused(text.replace("# seed", "# sead"), "no `# seed`");
        refused(text.replace("\n5,", "\n6,"), "line 13: step \"6\"; it should be 5");
        refused(text.replace(",1.6,", ",NaN,"), "not a finite number");
        refused(text.replace("\n3,", "\n3,0,"), "fields");
        // cut off: what there is counts, without an end
        let cut: String = text.lines().take(20).map(|line| format!("{line}\n")).collect();
        let read = Recording::read(cut.as_bytes()).unwrap();
        assert_eq!((read.moments.len(), read.end), (13, None));
    }
}
