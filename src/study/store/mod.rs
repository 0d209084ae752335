//! The store of a study: an answer is on the disk before its page moves on.
//!
//! ```text
//!  RUN/study.sqlite   frozen study, participants, trials, answers, exposures, events, operators   one writer, WAL, full sync
//!  RUN/links.sqlite   who participants are on a platform; deleted on its own date
//!  RUN/materials/     the study file, texts and libraries of each version
//!  RUN/backups/       a copy an hour, the newest 24
//!  RUN/recordings/    what participants did in a headset, in a folder for each code
//!  RUN/lock           held by the program that writes
//! ```
//!
//! One thread writes. It takes all requests that have come in, writes what the [protocol](super::protocol) says in one
//! transaction, and answers each after the commit: what was answered well is there after a crash. If the transaction fails,
//! all of its requests are [`Trouble::Unavailable`], and the memory is rebuilt from the disk. Clients send again; an answer's key
//! makes it count once.
//!
//! Callbacks run on the writer's thread and must be short.

mod arrivals;
mod backup;
mod books;
mod data;
mod desk;
mod entries;
mod files;
mod links;
mod lists;
mod merge;
mod open;
mod operators;
mod recordings;
mod request;
mod secret;
mod version;
mod writer;

pub use backup::write as backup;
pub use files::{LINKS, RECORDINGS, STORE};
pub use lists::{Act, Overview, Person};
pub use merge::merge;
pub use operators::{Operator, Role};
pub use request::{Arrival, Arrived, PlatformId, Trouble, Turn};
pub use version::{Opening, Shown, Version};

use super::Error;
use super::file::Front;
use super::plan::Role as TrialRole;
use super::protocol::Event;
use super::tables::Tables;
use super::theatre::Showing;
use desk::Desk;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use writer::Job;

/// A handle on a store that is open for writing. When the last one is dropped the store is closed.
#[derive(Debug, Clone)]
pub struct Store {
    inner: Arc<Inner>,
}

#[derive(Debug)]
struct Inner {
    folder: PathBuf,
    versions: Arc<Vec<Arc<Version>>>,
    current: Arc<Version>,
    jobs: Mutex<Option<Sender<Job>>>,
    thread: Mutex<Option<JoinHandle<()>>>,
    _lock: File,
}

impl Drop for Inner {
    fn drop(&mut self) {
        *self.jobs.lock().unwrap_or_else(PoisonError::into_inner) = None;
        if let Some(thread) = self.thread.lock().unwrap_or_else(PoisonError::into_inner).take() {
            // a writer that panicked has nothing more to write
            let _ended = thread.join();
        }
    }
}

impl Store {
    /// Opens a folder of data with a study; makes the folder, or adds a version of the study, if it is new.
    ///
    /// # Errors
    /// [`Error::InUse`] while another program has it, [`Error::Changed`] where the study differs from the one that runs,
    /// and the store's and the study's other errors.
    pub fn open(folder: &Path, opening: &Opening) -> Result<Self, Error> {
        Self::start(folder, open::open(folder, Some(opening))?)
    }

    /// Opens a folder of data as it is.
    ///
    /// # Errors
    /// [`Error::NoStore`] where there is none, [`Error::InUse`] while another program has it, and the store's other errors.
    pub fn open_again(folder: &Path) -> Result<Self, Error> {
        Self::start(folder, open::open(folder, None)?)
    }

    fn start(folder: &Path, (desk, lock): (Desk, File)) -> Result<Self, Error> {
        let versions = Arc::clone(&desk.versions);
        let current = desk.current().ok_or_else(|| Error::NoStore { path: open::path(folder) })?;
        let failed = |source| Error::Write { path: open::path(folder), source };
        let (jobs, thread) = writer::start(desk).map_err(failed)?;
        let inner = Inner {
            folder: folder.to_owned(),
            versions,
            current,
            jobs: Mutex::new(Some(jobs)),
            thread: Mutex::new(Some(thread)),
            _lock: lock,
        };
        Ok(Self { inner: Arc::new(inner) })
    }

    /// The folder of data.
    pub fn folder(&self) -> &Path {
        &self.inner.folder
    }

    /// All versions of the study, oldest first.
    pub fn versions(&self) -> &[Arc<Version>] {
        &self.inner.versions
    }

    /// A version by its number.
    pub fn version(&self, number: u32) -> Option<Arc<Version>> {
        self.versions().iter().find(|version| version.number == number).cloned()
    }

    /// The version that new participants get.
    pub fn current(&self) -> Arc<Version> {
        Arc::clone(&self.inner.current)
    }

    /// Has the writer do something; `then` gets what came of it, after the commit.
    fn ask<T: Send + 'static>(
        &self,
        work: impl FnOnce(&mut Desk) -> Result<T, Trouble> + Send + 'static,
        then: impl FnOnce(Result<T, Trouble>) + Send + 'static,
    ) {
        let jobs = self.inner.jobs.lock().unwrap_or_else(PoisonError::into_inner);
        // a job that is not taken is dropped with its callback, which tells the caller
        if let Some(jobs) = jobs.as_ref() {
            drop(jobs.send(writer::job(work, then)));
        }
    }

    /// Lets a participant in. One whom the platform has sent before goes on where they were.
    pub fn arrive(&self, arrival: Arrival, then: impl FnOnce(Result<Arrived, Trouble>) + Send + 'static) {
        self.ask(move |desk| desk.arrive(&arrival), then);
    }

    /// Lets the participant of a code go on: in another browser, or in the headset where they began.
    pub fn resume(
        &self,
        code: &str,
        front: Front,
        then: impl FnOnce(Result<Arrived, Trouble>) + Send + 'static,
    ) {
        let code = code.to_owned();
        self.ask(move |desk| desk.resume(&code, front), then);
    }

    /// Where the participant of a secret is. One whose lease has lapsed gets a place again.
    pub fn turn(&self, token: &str, then: impl FnOnce(Result<Turn, Trouble>) + Send + 'static) {
        let token = token.to_owned();
        self.ask(move |desk| desk.known(&token).and_then(|id| desk.sign(id)), then);
    }

    /// The id by which the platform knows the participant of a secret; none without a platform, or after it was deleted.
    pub fn platform_id(
        &self,
        token: &str,
        then: impl FnOnce(Result<Option<String>, Trouble>) + Send + 'static,
    ) {
        let token = token.to_owned();
        self.ask(move |desk| desk.platform_id(&token), then);
    }

    /// Takes an event of the participant of a secret. Only events that are [open to fronts](Event::is_open_to_fronts) may come
    /// from outside.
    pub fn submit(
        &self,
        token: &str,
        event: Event,
        then: impl FnOnce(Result<Turn, Trouble>) + Send + 'static,
    ) {
        let token = token.to_owned();
        self.ask(move |desk| desk.known(&token).and_then(|id| desk.conduct(id, Some(event))), then);
    }

    /// What the current trial of the participant of a secret shows, and the one after it in the same part.
    pub fn showing(
        &self,
        token: &str,
        then: impl FnOnce(Result<[Option<Showing>; 2], Trouble>) + Send + 'static,
    ) {
        let token = token.to_owned();
        self.ask(move |desk| desk.known(&token).and_then(|id| desk.showing(id)), then);
    }

    /// The study at a glance.
    pub fn overview(&self, then: impl FnOnce(Result<Overview, Trouble>) + Send + 'static) {
        self.ask(|desk| desk.overview(), then);
    }

    /// All participants, in the order of arrival.
    pub fn people(&self, then: impl FnOnce(Result<Vec<Person>, Trouble>) + Send + 'static) {
        self.ask(|desk| Ok(desk.list()), then);
    }

    /// Does something with the participant of a code. The audit says who did it.
    pub fn operate(
        &self,
        operator: &str,
        code: &str,
        act: Act,
        then: impl FnOnce(Result<Turn, Trouble>) + Send + 'static,
    ) {
        let (operator, code) = (operator.to_owned(), code.to_owned());
        self.ask(move |desk| desk.operate(&operator, &code, act), then);
    }

    /// Opens or closes admission.
    pub fn set_admission(
        &self,
        operator: &str,
        is_open: bool,
        then: impl FnOnce(Result<(), Trouble>) + Send + 'static,
    ) {
        let operator = operator.to_owned();
        self.ask(move |desk| desk.set_admission(&operator, is_open), then);
    }

    /// Writes and reads a row.
    pub fn health(&self, then: impl FnOnce(Result<(), Trouble>) + Send + 'static) {
        self.ask(Desk::health, then);
    }

    /// The operator of a name.
    pub fn operator(
        &self,
        name: &str,
        then: impl FnOnce(Result<Option<Operator>, Trouble>) + Send + 'static,
    ) {
        let name = name.to_owned();
        self.ask(move |desk| desk.operator(&name), then);
    }

    /// How many operators there are.
    pub fn operators(&self, then: impl FnOnce(Result<usize, Trouble>) + Send + 'static) {
        self.ask(|desk| desk.operators(), then);
    }

    /// Names an operator, or gives one a new password or role.
    pub fn set_operator(
        &self,
        by: &str,
        operator: Operator,
        then: impl FnOnce(Result<(), Trouble>) + Send + 'static,
    ) {
        let by = by.to_owned();
        self.ask(move |desk| desk.set_operator(&by, &operator), then);
    }

    /// Notes who did what to whom.
    pub fn audit(
        &self,
        operator: &str,
        what: &'static str,
        about: &str,
        then: impl FnOnce(Result<(), Trouble>) + Send + 'static,
    ) {
        let (operator, about) = (operator.to_owned(), about.to_owned());
        self.ask(move |desk| desk.audit(&operator, what, &about), then);
    }

    /// Deletes what the study's dates say. Returns how many of the platform's ids and how many participants are gone.
    pub fn purge(&self, then: impl FnOnce(Result<(usize, usize), Trouble>) + Send + 'static) {
        self.ask(Desk::purge, then);
    }

    /// The data so far.
    pub fn tables(&self, then: impl FnOnce(Result<Tables, Trouble>) + Send + 'static) {
        self.ask(|desk| Ok(desk.tables(None)), then);
    }
}

/// Waits for what the writer says: `wait(|then| store.overview(then))`.
///
/// # Errors
/// What the request says, or [`Trouble::Unavailable`] when the writer has stopped.
pub fn wait<T: Send + 'static>(
    ask: impl FnOnce(Box<dyn FnOnce(Result<T, Trouble>) + Send>),
) -> Result<T, Trouble> {
    let (sender, receiver) = channel();
    ask(Box::new(move |found| drop(sender.send(found))));
    receiver.recv().unwrap_or_else(|_stopped| Err(Trouble::Unavailable("the store has stopped".to_owned())))
}

/// A store as it is, read beside a program that may write.
#[derive(Debug)]
pub struct Reading {
    desk: Desk,
}

impl Reading {
    /// Reads a folder of data.
    ///
    /// # Errors
    /// [`Error::NoStore`] where there is none, and the store's other errors.
    pub fn open(folder: &Path) -> Result<Self, Error> {
        open::read(folder).map(|desk| Self { desk })
    }

    /// All versions of the study, oldest first.
    pub fn versions(&self) -> &[Arc<Version>] {
        &self.desk.versions
    }

    /// The study at a glance.
    ///
    /// # Errors
    /// [`Trouble::Unavailable`] when the store cannot be read.
    pub fn overview(&self) -> Result<Overview, Trouble> {
        self.desk.overview()
    }

    /// All participants, in the order of arrival.
    pub fn people(&self) -> Vec<Person> {
        self.desk.list()
    }

    /// What a trial of the participant of a code showed, and the version of the study; none if there is no such trial.
    pub fn showing(&self, code: &str, part: &str, trial: u32) -> Option<(Showing, Arc<Version>)> {
        let id = *self.desk.books.by_code.get(code)?;
        let one = self.desk.books.people.get(&id)?;
        let version = self.desk.version(one.version)?;
        let trials = one.session.trials_of(&version.plan, part);
        let mut trial = trials.into_iter().find(|own| own.position == trial)?;
        if trial.role == TrialRole::Ordinary && trial.item.is_none() {
            // left out since; what it was to show is in the plan as it was given
            trial.item = entries::placed_item(&self.desk.connection, id, &trial).ok()?;
        }
        let stimulus = one.session.stimulus(&version.plan, &trial).cloned();
        Some((Showing { trial, stimulus }, version))
    }

    /// The data of a version, or of all.
    pub fn tables(&self, version: Option<u32>) -> Tables {
        self.desk.tables(version)
    }
}
