//! Ctrl-C (SIGINT, or SIGTERM). While a [`Heed`] lives, the first one asks the program to end in good order. The second one,
//! or the first without a `Heed`, ends it at once. Either way no unfinished file is left, and the exit code is [`EXIT_CODE`].

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Exit code of a program that was asked to end.
pub const EXIT_CODE: u8 = 130;

static ASKED: AtomicBool = AtomicBool::new(false);
static HEEDED: AtomicUsize = AtomicUsize::new(0);

/// Whether the program was asked to end.
pub fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}

/// While it lives, the first Ctrl-C only makes [`asked`] true. Its owner then ends in good order.
#[derive(Debug)]
pub struct Heed(());

/// Promises to look at [`asked`] often.
#[must_use]
pub fn heed() -> Heed {
    HEEDED.fetch_add(1, Ordering::SeqCst);
    Heed(())
}

impl Drop for Heed {
    fn drop(&mut self) {
        HEEDED.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Handles Ctrl-C from now on, in a thread. Where the thread cannot start, Ctrl-C ends the program as it always does.
#[cfg(all(unix, feature = "cli"))]
pub fn listen() {
    use signal_hook::consts::{SIGINT, SIGTERM};
    let wait = || {
        let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM]) else {
            return;
        };
        for _ in signals.forever() {
            if ASKED.swap(true, Ordering::SeqCst) || HEEDED.load(Ordering::SeqCst) == 0 {
                crate::file::abandon();
                // not by way of destructors: other threads are in the middle of what they do
                signal_hook::low_level::exit(EXIT_CODE.into());
            }
        }
    };
    let _ = std::thread::Builder::new().name("signals".to_owned()).spawn(wait);
}

/// Here Ctrl-C ends the program at once.
#[cfg(not(all(unix, feature = "cli")))]
pub fn listen() {}
