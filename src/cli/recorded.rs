//! Recordings of what users of headsets did, and what comes of doing their steps again.

use super::failed;
use super::output::{note, say};
use super::progress::Progress;
use crate::kernels::Store;
use crate::sim::{Simulation, measure};
use crate::xr::{self, RecordedSession, Recording, RecordingError, SessionHash};
use crate::{Error, file};
use serde::Serialize;
use std::path::Path;

/// Longest recording that is replayed, bytes: some days.
const MOST_RECORDED: u64 = 1 << 30;

/// What a replay came to.
#[derive(Debug, Serialize)]
pub(super) struct Replayed {
    device: String,
    /// Version of the recording's format.
    format: u32,
    /// The trial of a study that it names.
    #[serde(skip_serializing_if = "Option::is_none")]
    trial: Option<String>,
    pub(super) steps: usize,
    /// Of the crowd after the last step.
    state_hash: String,
    /// Of the session: [`SessionHash`].
    session_hash: String,
    pub(super) recorded_hash: Option<String>,
    /// Steps up to which the recording has hashes to compare with.
    pub(super) compared_steps: usize,
    /// Whether all of these are equal; null if there is none.
    pub(super) equal: Option<bool>,
    /// Steps after which the first hash differs.
    pub(super) differs_after: Option<usize>,
}

impl Replayed {
    /// Whether nothing differs.
    pub(super) fn is_good(&self) -> bool {
        self.equal != Some(false)
    }
}

/// Says of an error of a recording which file it is and what helps.
pub(super) fn of(path: &Path) -> impl Fn(RecordingError) -> Error + '_ {
    move |error| {
        let hint = match error {
            RecordingError::Taken(_) => "choose another name, or move the file away",
            _ => {
                "a recording is written by `gaitway xr --record` and `gaitway study run`; replay it with the same scene, \
                 condition, agents, seed and library, by the same version"
            }
        };
        failed(format!("{}: {error}", path.display()), hint)
    }
}

/// Reads a recording; one that broke off is repaired first.
pub(super) fn read(path: &Path) -> Result<Recording, Error> {
    let wrong = of(path);
    file::regular(path).map_err(|error| wrong(error.into()))?;
    match xr::repair(path) {
        Ok(0) => {}
        Ok(_) => note(&format!("note: {} broke off in a step: cut at its last whole one", path.display())),
        // one that cannot be written is still read
        Err(error) if error.kind() == std::io::ErrorKind::PermissionDenied => {}
        Err(error) => return Err(wrong(error.into())),
    }
    let bytes = file::read(path, MOST_RECORDED).map_err(|error| wrong(error.into()))?;
    Recording::read(bytes.as_slice()).map_err(wrong)
}

/// Whether a crowd begins as one of format 1 says: by the hash of its state.
fn check_start(found: &Recording, store: &Store) -> Result<(), RecordingError> {
    let (recorded, now) = (found.session.start, measure::state_hash(store));
    if recorded == now {
        return Ok(());
    }
    Err(RecordingError::Other {
        differences: vec![format!("start {recorded:016x} was recorded, this is {now:016x}")],
    })
}

/// Does the steps of a recording again, with the user as they were, in a crowd that has not begun.
pub(super) fn replay(
    path: &Path,
    found: Recording,
    session: &RecordedSession,
    simulation: &mut Simulation,
) -> Result<Replayed, Error> {
    found.must_be_of(session).map_err(of(path))?;
    if found.is_silent() {
        note(&format!(
            "note: {}: format 1 says neither condition nor gaze: whether this is the condition it was recorded under cannot be \
             told; the crowd is compared alone",
            path.display()
        ));
        check_start(&found, simulation.state()?).map_err(of(path))?;
    }
    let mut progress = Progress::new("replaying".to_owned());
    let mut hash = SessionHash::new(session);
    let steps = found.steps.len();
    let mut recorded = found.hashes.iter().peekable();
    let (mut compared_steps, mut differs_after) = (0, None);
    for (step, user) in found.steps.iter().enumerate() {
        simulation.set_user(user.place, user.elevation, user.velocity);
        simulation.step(1)?;
        let crowd = simulation.state()?;
        hash.step(user, crowd);
        if let Some((after, is)) = recorded.next_if(|(after, _)| *after as usize == step + 1) {
            compared_steps = *after as usize;
            if hash.with(crowd) != *is {
                differs_after.get_or_insert(compared_steps);
            }
        }
        #[allow(clippy::cast_precision_loss, reason = "a share of a few million")]
        let share = step as f64 / steps as f64;
        progress.at(&format!("step {step} of {steps}"), share);
    }
    let device = simulation.device();
    let crowd = simulation.state()?;
    let session_hash = hash.with(crowd);
    let now = if found.is_silent() { measure::state_hash(crowd) } else { session_hash };
    if let Some(end) = found.end {
        compared_steps = steps;
        if end != now {
            differs_after.get_or_insert(steps);
        }
    }
    let hex = |hash: u64| format!("{hash:016x}");
    let is_compared = found.end.is_some() || compared_steps > 0;
    let trial = found.session.trial.map(|of| {
        let xr::TrialLabel { study, participant, part, trial } = of;
        format!("{study}, participant {participant}, trial {trial} of {part}")
    });
    Ok(Replayed {
        device,
        format: found.format,
        trial,
        steps,
        state_hash: hex(measure::state_hash(crowd)),
        session_hash: hex(session_hash),
        recorded_hash: found.end.map(hex),
        compared_steps,
        equal: is_compared.then_some(differs_after.is_none()),
        differs_after,
    })
}

/// Prints what a replay came to.
pub(super) fn print(replayed: &Replayed) {
    if let Some(trial) = &replayed.trial {
        say(&format!("trial      {trial}"));
    }
    say(&format!("replayed   {} steps on {}", replayed.steps, replayed.device));
    say(&format!("state hash {}", replayed.state_hash));
    say(&format!("session    {}", replayed.session_hash));
    if replayed.recorded_hash.is_none() {
        say(&format!("the recording broke off; it can be compared up to step {}", replayed.compared_steps));
    }
    match (replayed.equal, replayed.differs_after) {
        (Some(true), _) => say("the session is that of the recording, bit for bit"),
        (_, Some(after)) => {
            say(&format!("the session is NOT that of the recording: it differs after {after} steps"));
        }
        _ => say("there is nothing to compare with"),
    }
}
