//! Ctrl-C: the session ends in good order, and what was recorded is kept. The second one ends the program at once.

use std::sync::atomic::{AtomicBool, Ordering};

static ASKED: AtomicBool = AtomicBool::new(false);

/// Whether the program was asked to end.
pub(super) fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}

/// From now on Ctrl-C (SIGINT, or SIGTERM) is taken as a wish.
#[cfg(unix)]
pub(crate) fn listen() {
    extern "C" fn on_signal(signal: libc::c_int) {
        ASKED.store(true, Ordering::Relaxed);
        // SAFETY: allowed in a handler; what the signal did before comes back.
        unsafe { libc::signal(signal, libc::SIG_DFL) };
    }
    let handler: extern "C" fn(libc::c_int) = on_signal;
    for signal in [libc::SIGINT, libc::SIGTERM] {
        // SAFETY: the handler does nothing but store a flag and call `signal`, both of which handlers may do.
        unsafe { libc::signal(signal, handler as *const () as libc::sighandler_t) };
    }
}

/// Here Ctrl-C ends the program at once.
#[cfg(not(unix))]
pub(crate) fn listen() {}
