//! The words of a buffer, as a kernel sees them.

use std::marker::PhantomData;
use std::sync::atomic::AtomicU32;

/// What is read where a buffer is empty.
static NOTHING: [u32; 256] = [0; 256];

/// The 32-bit words of one buffer that a kernel binds, shared by all invocations.
///
/// Reads beyond the end give the last element, writes beyond it are dropped, as robust buffer access demands.
#[derive(Debug, Clone, Copy)]
pub struct Words<'a> {
    first: *mut u32,
    length: u32,
    readable: u32,
    borrowed: PhantomData<&'a mut [u32]>,
}

// SAFETY: what threads may do with the words at the same time is the contract of the kernels that get them.
unsafe impl Send for Words<'_> {}
// SAFETY: as above.
unsafe impl Sync for Words<'_> {}

impl<'a> Words<'a> {
    /// Words that are only read: for a binding that no invocation writes.
    ///
    /// # Panics
    /// More than 2^31 words.
    pub fn read(words: &'a [u32]) -> Self {
        Self::new(words.as_ptr().cast_mut(), words.len())
    }

    /// Words that are read and written.
    ///
    /// # Panics
    /// More than 2^31 words.
    pub fn write(words: &'a mut [u32]) -> Self {
        Self::new(words.as_mut_ptr(), words.len())
    }

    /// No words.
    pub fn none() -> Self {
        Self::new(std::ptr::null_mut(), 0)
    }

    fn new(first: *mut u32, length: usize) -> Self {
        assert!(length <= i32::MAX as usize, "{length} words: a buffer has at most 2^31 - 1");
        let length = length as u32;
        let (first, readable) = match length {
            0 => (NOTHING.as_ptr().cast_mut(), NOTHING.len() as u32),
            _ => (first, length),
        };
        Self { first, length, readable, borrowed: PhantomData }
    }

    /// How many words there are.
    #[inline(always)]
    pub const fn len(self) -> u32 {
        self.length
    }

    /// Whether there are none.
    #[inline(always)]
    pub const fn is_empty(self) -> bool {
        self.length == 0
    }

    /// How many words may be read from [`Self::first`] on: at least one.
    #[inline(always)]
    pub(crate) const fn readable(self) -> u32 {
        self.readable
    }

    /// The first word.
    #[inline(always)]
    pub(crate) const fn first(self) -> *mut u32 {
        self.first
    }

    /// One word, the last beyond the end.
    #[inline(always)]
    pub fn word(self, at: u32) -> u32 {
        // SAFETY: `at` is below the number of readable words, which is at least one.
        unsafe { self.first.add(at.min(self.readable - 1) as usize).read() }
    }

    /// Overwrites one word; beyond the end nothing happens.
    #[inline(always)]
    pub(crate) fn set(self, at: u32, value: u32) {
        if at < self.length {
            // SAFETY: `at` is below the number of words; a kernel writes only what it got by `write`.
            unsafe { self.first.add(at as usize).write(value) }
        }
    }

    /// Overwrites four words; where not all are there nothing happens.
    #[inline(always)]
    pub(crate) fn set_four(self, at: u32, values: [u32; 4]) {
        if at < self.length.saturating_sub(3) {
            // SAFETY: `at` + 3 is below the number of words; a kernel writes only what it got by `write`.
            unsafe { self.first.add(at as usize).cast::<[u32; 4]>().write(values) }
        }
    }

    /// One word, for atomic operations; none beyond the end.
    #[inline(always)]
    pub(crate) fn atomic(self, at: u32) -> Option<&'a AtomicU32> {
        // SAFETY: the word is there, aligned, and lives as long as the buffer.
        (at < self.length).then(|| unsafe { AtomicU32::from_ptr(self.first.add(at as usize)) })
    }
}
