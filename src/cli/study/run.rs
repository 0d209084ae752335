//! `gaitway study run`: one participant of a study in a headset.

use super::super::output::{say, say_json, warn};
use super::super::outputs::make_folder;
use super::super::render::size;
use super::super::xr::write_shot;
use super::super::{failed, usage};
use super::opening::{OpeningArguments, trouble};
use super::terminal::Terminal;
use crate::export::image::png;
use crate::study::file::{Front as Place, Pointer, StudyFile};
use crate::study::headset::{Front, Kept, Setup};
use crate::study::lab::Lab;
use crate::study::protocol::{Content, State};
use crate::study::serve::Server;
use crate::study::store::{RECORDINGS, Store};
use crate::xr::{self, Means, Mirror, Outcome, Plan, Shot, Shots};
use crate::{Error, stop};
use serde::Serialize;
use std::net::SocketAddr;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

/// Rows of pixels of the eye on the operator's page, and how often it is new.
const ROWS: u32 = 360;
const PERIOD: Duration = Duration::from_secs(1);
/// Frames from one picture to the next.
const EVERY: u64 = 30;
/// How often threads look whether the session has ended.
const LOOK: Duration = Duration::from_millis(100);

/// Arguments of `gaitway study run`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  gaitway study run mine/ --data run1/\n  gaitway study run mine/ --data run1/ --console\n  gaitway \
                  study run mine/ --data run1/ --code K7Q01XZB...\n\nThe operator types at this terminal: whether the participant \
                  agrees, what they say aloud, and orders (/help lists them). --console adds a page with what the participant sees. \
                  Every answer is stored before the next panel. A session that broke off goes on with the participant's code.\n\
                  Recordings of all trials are in DATA/recordings; `gaitway study replay` checks them."
)]
pub(super) struct Arguments {
    #[command(flatten)]
    opening: OpeningArguments,
    /// The participant who goes on [default: a new one]
    #[arg(long, value_name = "CODE")]
    code: Option<String>,
    /// Language of the texts, one of the study's [default: its first]
    #[arg(long, value_name = "TAG", conflicts_with = "code")]
    language: Option<String>,
    /// Give rows of the design from this range alone, where several machines collect: 0..12 here, 12..24 there. It is kept in
    /// DATA
    #[arg(long, value_name = "FROM..TO", value_parser = rows)]
    rows: Option<Range<u32>>,
    /// Also open the operators' pages, at this address on this machine
    #[arg(long, value_name = "ADDRESS:PORT", num_args = 0..=1, default_missing_value = "127.0.0.1:8081")]
    console: Option<SocketAddr>,
    /// Pixels of one eye, always [default: as the runtime recommends, fewer where the device is too slow]
    #[arg(long, value_name = "WxH", value_parser = size)]
    eye_size: Option<(u32, u32)>,
    /// Ask for this refresh rate of the display, Hz, or the nearest there is [default: the runtime's]
    #[arg(long, value_name = "HZ", value_parser = super::super::xr::refresh_rate)]
    rate: Option<f32>,
    /// Write pictures of both eyes, panels included, into this folder, one of thirty frames
    #[arg(long, value_name = "FOLDER")]
    shots: Option<PathBuf>,
    /// Print one JSON object at the end
    #[arg(long)]
    json: bool,
}

/// A range of rows, such as `0..12`.
fn rows(text: &str) -> Result<Range<u32>, String> {
    let wrong = || format!("{text:?} must be a range such as 0..12, from a row to one after it");
    let (from, to) = text.split_once("..").ok_or_else(wrong)?;
    let row = |text: &str| text.parse::<u32>().ok();
    row(from).zip(row(to)).map(|(from, to)| from..to).filter(|rows| !rows.is_empty()).ok_or_else(wrong)
}

/// What a session came to.
#[derive(Debug, Serialize)]
struct Done {
    study: String,
    participant: String,
    /// Where the participation stands.
    state: &'static str,
    /// The current page.
    page: String,
    #[serde(flatten)]
    outcome: Outcome,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    xr::hush_loader();
    let study = arguments.opening.study()?;
    let language = language(arguments, &study.file)?;
    let store = arguments.opening.open_checked(&study, arguments.rows.clone())?;
    let kept = begin(arguments, &store, language)?;
    let lab = Arc::new(Lab::new(kept.code()));
    let is_over = Arc::new(AtomicBool::new(false));
    let server = console(arguments, &store, &lab, &is_over)?;
    let mirror = arguments.console.map(|_| Arc::new(Mirror::new(ROWS).every(PERIOD)));
    let painter =
        mirror.clone().map(|mirror| watch(mirror, Arc::clone(&lab), Arc::clone(&is_over))).transpose()?;
    warn(&format!("participant   {}", kept.code()));
    let heed = stop::heed();
    let outcome = show(arguments, &kept, &lab, mirror);
    drop(heed);
    is_over.store(true, Ordering::Relaxed);
    for thread in server.into_iter().chain(painter) {
        // one that panicked has printed why
        let _ended = thread.join();
    }
    end(arguments, &kept, outcome?)
}

/// The language of a new participant, in a study for headsets.
fn language<'a>(arguments: &'a Arguments, file: &'a StudyFile) -> Result<&'a str, Error> {
    if !file.study.fronts.contains(&Place::Headset) {
        let message = format!("study.where of {} has no \"headset\"", file.study.id);
        return Err(failed(
            message,
            "add it, and a section [headset]; `gaitway study check` says what is missing",
        ));
    }
    let languages = &file.study.languages;
    let language = arguments.language.as_ref().or_else(|| languages.first()).map_or("en", String::as_str);
    if languages.iter().any(|own| own == language) {
        return Ok(language);
    }
    let message = format!("--language {language}: the study is in {}", languages.join(", "));
    Err(usage(message, "choose one of these, or leave it out"))
}

/// The participant: a new one, or the one of a code, who has not come to an end.
fn begin(arguments: &Arguments, store: &Store, language: &str) -> Result<Kept, Error> {
    let kept = Kept::begin(store, arguments.code.as_deref(), language).map_err(trouble)?;
    let state = kept.turn().map_err(trouble)?.state;
    if let (State::Ended(_), Some(_)) = (state, &arguments.code) {
        let message = format!("this participation has ended: {}", state.name());
        return Err(failed(message, "leave --code out for a new participant"));
    }
    Ok(kept)
}

/// The operators' pages, if they are wanted, on a thread of their own.
fn console(
    arguments: &Arguments,
    store: &Store,
    lab: &Arc<Lab>,
    is_over: &Arc<AtomicBool>,
) -> Result<Option<thread::JoinHandle<()>>, Error> {
    let Some(address) = arguments.console else { return Ok(None) };
    let server = Server::beside(store, address, Arc::clone(lab))?;
    if let Some(address) = server.console_address() {
        warn(&format!("operators     http://{address}/admin"));
    }
    if let Some(link) = server.first_link() {
        warn(&format!("password      choose the first operator's, once, at {link}"));
    }
    let is_over = Arc::clone(is_over);
    let serve = move || {
        if let Err(error) = server.run(move || is_over.load(Ordering::Relaxed)) {
            warn(&format!("the operators' pages: {error}"));
        }
    };
    spawn("operators", serve).map(Some)
}

/// Brings what the left eye sees to the operators' page.
fn watch(
    mirror: Arc<Mirror>,
    lab: Arc<Lab>,
    is_over: Arc<AtomicBool>,
) -> Result<thread::JoinHandle<()>, Error> {
    let paint = move || {
        while !is_over.load(Ordering::Relaxed) {
            if let Some(png) = mirror.take().and_then(|image| png(&image).ok()) {
                lab.show(png);
            }
            thread::sleep(LOOK);
        }
    };
    spawn("eye", paint)
}

fn spawn(name: &str, work: impl FnOnce() + Send + 'static) -> Result<thread::JoinHandle<()>, Error> {
    let thread = thread::Builder::new().name(name.to_owned()).spawn(work);
    thread.map_err(|error| {
        failed(format!("no thread for {name}: {error}"), "close other programs, then try again")
    })
}

/// Shows the participation until it has ended, or the session is over.
fn show(
    arguments: &Arguments,
    kept: &Kept,
    lab: &Arc<Lab>,
    mirror: Option<Arc<Mirror>>,
) -> Result<Outcome, Error> {
    let version = kept.version();
    let headset = version.study.file.headset.as_ref();
    let means: Vec<Means> = headset.iter().flat_map(|headset| &headset.answer).map(means).collect();
    let plan = Plan {
        eye_size: arguments.eye_size.map(|(width, height)| [width, height]),
        refresh_rate: arguments.rate,
        means: if means.is_empty() { Means::ALL.to_vec() } else { means },
        mirror,
        shots: arguments.shots.clone().map(shots).transpose()?,
        waits: true,
        ..Plan::default()
    };
    let setup = Setup {
        study: version.study.file.study.id.clone(),
        participant: kept.code().to_owned(),
        language: kept.language().to_owned(),
        recordings: recordings(arguments.opening.data.as_path(), kept.code())?,
        stop_at: headset.map(|headset| headset.stop_at.clone()).unwrap_or_default(),
    };
    let (mut participation, mut operator) = (kept.clone(), Terminal::new(kept.clone(), Arc::clone(lab)));
    Front::open(plan, &mut participation, &mut operator, version.theatre()?, setup)?.run()
}

/// Writes pictures into a folder.
fn shots(folder: PathBuf) -> Result<(u64, Shots), Error> {
    make_folder(&folder)?;
    Ok((EVERY, Box::new(move |shot: &Shot| write_shot(&folder, shot))))
}

const fn means(pointer: &Pointer) -> Means {
    match pointer {
        Pointer::Laser => Means::Laser,
        Pointer::Stick => Means::Stick,
        Pointer::Gaze => Means::Gaze,
    }
}

/// The folder of a participant's recordings.
fn recordings(data: &Path, code: &str) -> Result<PathBuf, Error> {
    let folder = data.join(RECORDINGS).join(code);
    make_folder(&folder).map(|()| folder)
}

/// Says how it ended, and how it goes on.
fn end(arguments: &Arguments, kept: &Kept, outcome: Outcome) -> Result<bool, Error> {
    let turn = kept.turn().map_err(trouble)?;
    let is_hung = outcome.hung;
    let study = kept.version().study.file.study.id.clone();
    let is_over = matches!(turn.page.content, Content::Ended { .. });
    let (participant, state) = (turn.code, turn.state.name());
    if arguments.json {
        say_json(&Done { study, participant, state, page: turn.page.id, outcome })?;
        return Ok(!is_hung);
    }
    say(&format!("participant   {participant}: {state}"));
    say(&format!("recordings    {}", arguments.opening.data.join(RECORDINGS).join(&participant).display()));
    say(&format!(
        "frames        {} drawn, {} periods of the display missed, {} sessions ({})",
        outcome.frames.drawn, outcome.frames.missed, outcome.sessions, outcome.ended
    ));
    if !is_over {
        say(&format!("stopped at    {}; it goes on with --code {participant}", turn.page.id));
    }
    Ok(!is_hung)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_a_range_that_is_not_empty() {
        assert_eq!(rows("0..12"), Ok(0..12));
        for wrong in ["", "3", "..", "3..", "..4", "4..4", "5..4", "a..b", "0..-1"] {
            assert!(rows(wrong).unwrap_err().contains("0..12"), "{wrong}");
        }
    }
}
