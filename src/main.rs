//! The program `gaitway`; everything it does is in the library's `cli`.
//!
//! Where the system gives no more memory it says so in one line and ends with exit code 1: by itself Rust aborts there, and
//! leaves unfinished files.
#![allow(unsafe_code, reason = "an allocator is unsafe by its signature; this one only passes on")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write as _;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

fn main() -> ExitCode {
    gaitway::cli::main()
}

#[global_allocator]
static MEMORY: Memory = Memory;

struct Memory;

// SAFETY: every call goes to the system's allocator as it came; what that could not give is not returned.
unsafe impl GlobalAlloc for Memory {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promises are those that `System` asks for.
        found(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        found(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, old: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above.
        found(unsafe { System.realloc(old, layout, size) }, size)
    }

    unsafe fn dealloc(&self, old: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(old, layout) }
    }
}

fn found(place: *mut u8, size: usize) -> *mut u8 {
    if place.is_null() {
        end(size);
    }
    place
}

/// Ends the program, unless it is about to.
#[cold]
fn end(size: usize) {
    static ENDING: AtomicBool = AtomicBool::new(false);
    if ENDING.swap(true, Ordering::SeqCst) {
        return;
    }
    // standard error has no buffer, so this takes no memory
    let _ = writeln!(
        std::io::stderr(),
        "error: not enough memory: {size} bytes more were wanted\nhint: ask for fewer agents or smaller files, or raise the \
         limit (ulimit -v)"
    );
    gaitway::file::abandon();
    #[cfg(unix)]
    signal_hook::low_level::exit(1);
    #[cfg(not(unix))]
    std::process::exit(1);
}
