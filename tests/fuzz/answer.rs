//! What a reader may do with any bytes: answer, quickly, with memory in proportion, and never panic.

use crate::memory;
use crate::targets::Target;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// A reader may hold so many times the bytes of its input, and so many beside.
const MEMORY_RATIO: usize = 64;
pub(crate) const MEMORY_FREE: usize = 16 << 20;
/// An answer that takes longer is a hang (unoptimised builds, slow machines, others at work on them).
const SLOW: Duration = Duration::from_secs(60);

/// The answer to one input, read or refused; or what is wrong.
pub(crate) fn ask(target: &Target, input: &[u8]) -> Result<Result<String, String>, String> {
    let begin = Instant::now();
    let floor = memory::mark();
    let answer = catch_unwind(AssertUnwindSafe(|| (target.read)(input)));
    let peak = memory::peak().saturating_sub(floor);
    let allowed = MEMORY_RATIO * input.len() + MEMORY_FREE;
    match answer {
        Err(panic) => {
            let text = panic.downcast_ref::<String>().cloned();
            let text = text.or_else(|| panic.downcast_ref::<&str>().map(|&s| s.to_owned()));
            Err(format!("panics: {}", text.unwrap_or_default()))
        }
        Ok(_) if peak > allowed => {
            Err(format!("holds {peak} bytes for an input of {}; {allowed} are allowed", input.len()))
        }
        Ok(_) if begin.elapsed() > SLOW => Err(format!("takes {:.1} s", begin.elapsed().as_secs_f32())),
        Ok(answer) => Ok(answer),
    }
}
