//! The mirror of `gaitway xr --mirror`: a window with what the user of the headset sees.
//!
//! The window is a process of its own: this program, started a second time. It receives images through a pipe. So its faults
//! do not reach the headset: neither a closed window nor a lost display, at which X11's library ends its process.

use crate::Error;
use crate::picture::Image;
use crate::view::{self, Source};
use crate::xr;
use clap::Args;
use std::io::Read as _;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Most rows of pixels of the mirror's pictures, and the side of its window.
pub(super) const ROWS: u32 = 720;
/// How long the window may take to close.
const FAREWELL: Duration = Duration::from_secs(2);
/// How often a new picture is looked for.
const LOOK: Duration = Duration::from_millis(5);
/// Largest side of a picture that is believed.
const MOST: u32 = 16_384;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Title of the window
    #[arg(long, default_value = "left eye")]
    title: String,
}

/// Pictures as they come through standard input: two words of four bytes, width and height, and four bytes a pixel.
struct Pipe {
    latest: Arc<Mutex<Option<Image>>>,
    is_open: Arc<AtomicBool>,
}

impl Source for Pipe {
    fn take(&mut self) -> Option<Image> {
        self.latest.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    fn is_open(&self) -> bool {
        self.is_open.load(Ordering::Relaxed)
    }
}

/// The next picture of a pipe; none at its end.
fn read(from: &mut impl std::io::Read) -> Option<Image> {
    let mut word = || {
        let mut bytes = [0; 4];
        from.read_exact(&mut bytes).ok()?;
        Some(u32::from_ne_bytes(bytes)).filter(|side| (1..=MOST).contains(side))
    };
    let (width, height) = (word()?, word()?);
    let mut pixels = vec![0; width as usize * height as usize * 4];
    from.read_exact(&mut pixels).ok()?;
    Some(Image { width, height, pixels })
}

fn write(to: &mut impl std::io::Write, image: &Image) -> std::io::Result<()> {
    to.write_all(&image.width.to_ne_bytes())?;
    to.write_all(&image.height.to_ne_bytes())?;
    to.write_all(&image.pixels)?;
    to.flush()
}

/// Runs the window, until it is closed or there are no more pictures.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let mut pipe = Pipe { latest: Arc::default(), is_open: Arc::new(AtomicBool::new(true)) };
    let (latest, is_open) = (pipe.latest.clone(), pipe.is_open.clone());
    // left behind when the window is closed: it waits for a picture, and the program ends
    thread::spawn(move || {
        let mut from = std::io::BufReader::new(std::io::stdin());
        while let Some(image) = read(&mut from) {
            *latest.lock().unwrap_or_else(PoisonError::into_inner) = Some(image);
        }
        is_open.store(false, Ordering::Relaxed);
    });
    view::mirror(&arguments.title, [ROWS, ROWS], &mut pipe)?;
    Ok(true)
}

/// A mirror, its window, and the thread that sends it pictures and counts them.
pub(super) struct Window {
    mirror: Arc<xr::Mirror>,
    child: Arc<Mutex<Option<Child>>>,
    feeder: Option<JoinHandle<u64>>,
}

/// Opens the window.
pub(super) fn open(mirror: &Arc<xr::Mirror>, scene: &str) -> Window {
    let mut window = Window { mirror: mirror.clone(), child: Arc::default(), feeder: None };
    let started = start(scene).and_then(|mut child| {
        let to = child.stdin.take().ok_or_else(|| std::io::Error::other("no pipe"))?;
        *lock(&window.child) = Some(child);
        let (mirror, child) = (mirror.clone(), window.child.clone());
        thread::Builder::new().name("mirror".to_owned()).spawn(move || feed(&mirror, to, &child))
    });
    match started {
        Ok(feeder) => window.feeder = Some(feeder),
        Err(error) => mirror.close(Some(format!("no mirror: {error}"))),
    }
    window
}

/// Starts this program again, as the window.
fn start(scene: &str) -> std::io::Result<Child> {
    // started through a runner, a program cannot find its own file: `current_exe` is the runner's loader
    let mut command = match (std::env::var_os("GAITWAY_RUNNER"), std::env::args_os().next()) {
        (Some(runner), Some(program)) => {
            let mut command = Command::new(runner);
            command.arg(program);
            command
        }
        _ => Command::new(std::env::current_exe()?),
    };
    let title = format!("{scene}, left eye");
    command.args(["mirror", "--title", &title]);
    command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn()
}

fn lock(child: &Mutex<Option<Child>>) -> std::sync::MutexGuard<'_, Option<Child>> {
    child.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Sends the window images until either end closes. Returns their number.
fn feed(mirror: &xr::Mirror, mut to: ChildStdin, child: &Mutex<Option<Child>>) -> u64 {
    let mut sent = 0;
    while mirror.is_open() {
        match mirror.take() {
            Some(image) if write(&mut to, &image).is_ok() => sent += 1,
            Some(_) => break,
            None if lock(child).as_mut().is_none_or(|child| !matches!(child.try_wait(), Ok(None))) => break,
            None => thread::sleep(LOOK),
        }
    }
    drop(to);
    if mirror.is_open() {
        mirror.close(Some(why(child)));
    }
    sent
}

/// Why the window is gone, in one line.
fn why(child: &Mutex<Option<Child>>) -> String {
    let mut said = String::new();
    if let Some(from) = lock(child).as_mut().and_then(|child| child.stderr.as_mut()) {
        let _ = from.read_to_string(&mut said);
    }
    match said.lines().find_map(|line| line.strip_prefix("error: ")) {
        Some(reason) => format!("no mirror: {reason}"),
        None => "the mirror was closed".to_owned(),
    }
}

/// Closes the window in any case. Returns the number of images sent.
pub(super) fn close(window: Window) -> u64 {
    window.mirror.close(None);
    let begin = Instant::now();
    let is_over = || lock(&window.child).as_mut().is_none_or(|child| !matches!(child.try_wait(), Ok(None)));
    while begin.elapsed() < FAREWELL && !is_over() {
        thread::sleep(LOOK);
    }
    if let Some(child) = lock(&window.child).as_mut() {
        // one that has ended by itself is only waited for
        let _ = child.kill();
        let _ = child.wait();
    }
    window.feeder.and_then(|feeder| feeder.join().ok()).unwrap_or(0)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;

    #[test]
    fn pictures_go_through_the_pipe_and_nonsense_ends_it() {
        let image = Image { width: 2, height: 1, pixels: (0..8).collect() };
        let mut bytes = Vec::new();
        write(&mut bytes, &image).unwrap();
        write(&mut bytes, &image).unwrap();
        let mut from = bytes.as_slice();
        assert_eq!(read(&mut from).unwrap().pixels, image.pixels);
        assert_eq!(read(&mut from).unwrap().width, 2);
        assert!(read(&mut from).is_none());
        assert!(read(&mut [0_u8; 8].as_slice()).is_none());
        assert!(read(&mut [255_u8; 64].as_slice()).is_none());
    }
}
