//! The one writer: takes what has come in, writes it in one transaction, and answers after the commit.

use super::backup;
use super::desk::Desk;
use super::request::Trouble;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Most requests of one transaction.
const MOST: usize = 256;
/// How often leases are looked at.
const TICK: Duration = Duration::from_secs(1);
/// How often a backup is made, and what is too old deleted.
const BACKUP_EVERY: Duration = Duration::from_secs(3600);

/// What is to be done at the desk. It returns the answer, which is given after the commit.
pub(super) type Job = Box<dyn FnOnce(&mut Desk) -> Answer + Send>;
/// Gives an answer; with a reason, the answer that nothing was stored.
pub(super) type Answer = Box<dyn FnOnce(Option<&str>) + Send>;

/// A request: its work at the desk, and who takes the answer.
pub(super) fn job<T: Send + 'static>(
    work: impl FnOnce(&mut Desk) -> Result<T, Trouble> + Send + 'static,
    then: impl FnOnce(Result<T, Trouble>) + Send + 'static,
) -> Job {
    Box::new(move |desk| {
        let found = desk.refresh().map_err(Trouble::from).and_then(|()| work(desk));
        let reason = match &found {
            Err(Trouble::Unavailable(reason)) => Some(reason.clone()),
            _ => None,
        };
        if let Some(reason) = reason {
            desk.fail(reason);
        }
        Box::new(move |failure| {
            then(match failure {
                None => found,
                Some(reason) => Err(Trouble::Unavailable(reason.to_owned())),
            });
        })
    })
}

/// Starts the writer. It ends, with everything on the disk, when all senders are gone.
pub(super) fn start(mut desk: Desk) -> std::io::Result<(Sender<Job>, JoinHandle<()>)> {
    let (sender, jobs) = channel();
    let work = move || {
        let mut upkeep = Upkeep { leases: Instant::now(), backup: Instant::now() };
        while serve(&mut desk, &jobs) {
            upkeep.look(&mut desk);
        }
        // the last state goes into the file itself; what cannot be written now is in the log beside it
        let _closing = desk.empty_logs();
    };
    let thread = std::thread::Builder::new().name("study store".to_owned()).spawn(work)?;
    Ok((sender, thread))
}

/// Meets the requests that are there, or waits for some. Returns whether more can come.
fn serve(desk: &mut Desk, jobs: &Receiver<Job>) -> bool {
    let first = match jobs.recv_timeout(TICK) {
        Ok(job) => job,
        Err(RecvTimeoutError::Timeout) => return true,
        Err(RecvTimeoutError::Disconnected) => return false,
    };
    let mut answers = vec![first(desk)];
    while answers.len() < MOST && desk.failure().is_none() {
        let Ok(job) = jobs.try_recv() else { break };
        answers.push(job(desk));
    }
    let failure = desk.settle();
    answers.into_iter().for_each(|answer| answer(failure.as_deref()));
    true
}

/// What is due from time to time.
struct Upkeep {
    leases: Instant,
    backup: Instant,
}

impl Upkeep {
    fn look(&mut self, desk: &mut Desk) {
        if self.leases.elapsed() >= TICK {
            self.leases = Instant::now();
            if let Err(error) = desk.lapse() {
                desk.fail(error.to_string());
            }
            // leases are looked at again in a second
            let _failure = desk.settle();
        }
        if self.backup.elapsed() >= BACKUP_EVERY {
            self.backup = Instant::now();
            if let Err(trouble) = desk.purge() {
                desk.fail(trouble.to_string());
            }
            // what could not be deleted now is in an hour
            let _failure = desk.settle();
            let folder = desk.folder.clone();
            // beside the writer, which goes on; the next one comes in an hour
            drop(
                std::thread::Builder::new()
                    .name("study backup".to_owned())
                    .spawn(move || backup::write(&folder)),
            );
        }
    }
}
