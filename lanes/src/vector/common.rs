//! What the modules of all instruction sets have alike, written once and compiled for each.

/// Lane by lane, memory, and arrays that each lane indexes for itself. Needs `LANES`, `V` and `M` with their methods; `$attr` enables
/// the instructions.
macro_rules! common {
    ($(#[$attr:meta])*) => {
        use crate::Words;
        use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

        impl V {
            /// The words, lane by lane.
            #[inline(always)]
            pub const fn to_array(self) -> [u32; LANES] {
                // SAFETY: both are so many words without invalid values.
                unsafe { std::mem::transmute::<Self, [u32; LANES]>(self) }
            }

            /// Of one word a lane.
            #[inline(always)]
            pub const fn from_array(words: [u32; LANES]) -> Self {
                // SAFETY: both are so many words without invalid values.
                unsafe { std::mem::transmute::<[u32; LANES], Self>(words) }
            }

            /// The word of the first lane: that of all, where they have the same.
            #[inline(always)]
            pub const fn lane(self) -> u32 {
                self.to_array()[0]
            }

            /// `first`, `first` + 1, and so on.
            #[inline]
            $(#[$attr])*
            pub fn count_from(first: u32) -> Self {
                Self::c(first).iadd(Self::iota())
            }

            /// The float in all lanes.
            #[inline]
            $(#[$attr])*
            pub fn f(value: f32) -> Self {
                Self::c(value.to_bits())
            }

            /// `f` of each lane's float.
            #[inline]
            $(#[$attr])*
            fn each_f(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
                self.each(other, |a, b| f(f32::from_bits(a), f32::from_bits(b)).to_bits())
            }

            /// `f` of each lane's words.
            #[inline]
            $(#[$attr])*
            fn each(self, other: Self, f: impl Fn(u32, u32) -> u32) -> Self {
                let (mut words, others) = (self.to_array(), other.to_array());
                for (word, other) in words.iter_mut().zip(others) {
                    *word = f(*word, other);
                }
                Self::from_array(words)
            }

            /// Remainder, with the sign of the dividend.
            #[inline]
            $(#[$attr])*
            pub fn frem(self, other: Self) -> Self {
                self.each_f(other, |a, b| a % b)
            }

            /// Quotient of unsigned integers; by zero the dividend.
            #[inline]
            $(#[$attr])*
            pub fn udiv(self, other: Self) -> Self {
                self.each(other, |a, b| a.checked_div(b).unwrap_or(a))
            }

            /// Remainder of unsigned integers; by zero it is zero.
            #[inline]
            $(#[$attr])*
            pub fn urem(self, other: Self) -> Self {
                self.each(other, |a, b| a.checked_rem(b).unwrap_or(0))
            }

            /// Quotient of signed integers, towards zero; by zero, or where it does not fit, the dividend.
            #[inline]
            $(#[$attr])*
            pub fn idiv(self, other: Self) -> Self {
                self.each(other, |a, b| (a as i32).checked_div(b as i32).unwrap_or(a as i32) as u32)
            }

            /// Remainder of signed integers, with the sign of the dividend; by zero it is zero.
            #[inline]
            $(#[$attr])*
            pub fn irem(self, other: Self) -> Self {
                self.each(other, |a, b| (a as i32).checked_rem(b as i32).unwrap_or(0) as u32)
            }

            /// Ones of each word.
            #[inline]
            $(#[$attr])*
            pub fn popcount(self) -> Self {
                self.each(self, |a, _| a.count_ones())
            }

            /// Zeros before the highest one of each word.
            #[inline]
            $(#[$attr])*
            pub fn leading_zeros(self) -> Self {
                self.each(self, |a, _| a.leading_zeros())
            }

            /// Zeros behind the lowest one of each word.
            #[inline]
            $(#[$attr])*
            pub fn trailing_zeros(self) -> Self {
                self.each(self, |a, _| a.trailing_zeros())
            }

            /// Negated integers.
            #[inline]
            $(#[$attr])*
            pub fn ineg(self) -> Self {
                Self::c(0).isub(self)
            }

            /// Of a float each to a float: the second, where the first is not less.
            #[inline]
            $(#[$attr])*
            pub fn fclamp(self, low: Self, high: Self) -> Self {
                let raised = self.flt(low).pick(low, self);
                high.flt(raised).pick(high, raised)
            }

            /// Unsigned integers within bounds.
            #[inline]
            $(#[$attr])*
            pub fn uclamp(self, low: Self, high: Self) -> Self {
                self.umax(low).umin(high)
            }

            /// Signed integers within bounds.
            #[inline]
            $(#[$attr])*
            pub fn iclamp(self, low: Self, high: Self) -> Self {
                self.imax(low).imin(high)
            }
        }

        impl M {
            /// 1 or 0.
            #[inline]
            $(#[$attr])*
            pub fn to_u(self) -> V {
                self.pick(V::c(1), V::c(0))
            }

            /// 1.0 or 0.0.
            #[inline]
            $(#[$attr])*
            pub fn to_f(self) -> V {
                self.pick(V::f(1.0), V::f(0.0))
            }
        }

        /// The first `count` lanes.
        #[inline]
        $(#[$attr])*
        pub fn first_lanes(count: u32) -> M {
            V::iota().ult(V::c(count))
        }

        /// A bit for every lane.
        const ALL: u32 = ((1u64 << LANES) - 1) as u32;

        /// The lanes of a set of bits, lowest first.
        struct Bits(u32);

        impl Iterator for Bits {
            type Item = usize;

            #[inline(always)]
            fn next(&mut self) -> Option<usize> {
                let lane = self.0.trailing_zeros();
                self.0 &= self.0.wrapping_sub(1);
                (lane < 32).then_some(lane as usize)
            }
        }

        /// The word at each lane's index.
        #[inline]
        $(#[$attr])*
        pub fn word(from: Words<'_>, index: V) -> V {
            let index = index.umin(V::c(from.readable() - 1));
            // SAFETY: every index is below the number of readable words.
            unsafe { gather(from.first(), index) }
        }

        /// The `W` words from each lane's index on.
        #[inline]
        $(#[$attr])*
        pub fn row<const W: usize>(from: Words<'_>, index: V) -> [V; W] {
            let index = index.umin(V::c(from.readable().saturating_sub(W as u32)));
            // SAFETY: a buffer has whole elements, so the words up to `index + W` are there.
            unsafe { gather_row(from.first(), index) }
        }

        /// Rows of `W` words, one behind the other, from each lane's index on: `D` words in one read where all are there.
        #[inline]
        $(#[$attr])*
        pub fn rows<const W: usize, const D: usize>(from: Words<'_>, index: V, mask: M) -> [V; D] {
            const { assert!(D.is_multiple_of(W)) };
            let last = V::c(from.readable().saturating_sub(D as u32));
            if (from.readable() as usize) < D || mask.and(last.ult(index)).any() {
                return rows_apart::<W, D>(from, index);
            }
            let index = index.umin(last);
            if D > 4 && !index.ieq(V::c(index.lane())).negated().any() {
                return row_of(from, index.lane());
            }
            // SAFETY: there are as many words, and `last` + D of them at most are read.
            unsafe { gather_row(from.first(), index) }
        }

        /// Parts of a buffer, one for each lane, which lie one behind the other: word by word, the same word of all lanes together.
        /// Each has `N` words.
        #[derive(Debug)]
        pub struct Kept<const N: usize> {
            /// Where that of the first lane begins, in words, and one more; 0: nowhere.
            begin: std::cell::Cell<u32>,
            words: std::cell::UnsafeCell<[V; N]>,
        }

        impl<const N: usize> Kept<N> {
            /// Of nothing yet.
            #[inline]
            $(#[$attr])*
            pub fn empty() -> Self {
                Self { begin: std::cell::Cell::new(0), words: std::cell::UnsafeCell::new([V::c(0); N]) }
            }

            /// What [`rows`] gives. Where each lane reads in a part of its own, at the same place in each, the parts are kept.
            #[inline]
            $(#[$attr])*
            pub fn rows<const W: usize, const D: usize>(&self, from: Words<'_>, index: V, mask: M) -> [V; D] {
                let first = index.lane();
                let (begin, offset) = (first - first % N as u32, (first % N as u32) as usize);
                let differ = index.ieq(V::c(first).iadd(V::iota().imul(V::c(N as u32)))).negated();
                let end = u64::from(begin) + (N * LANES) as u64;
                if offset + D > N || end > u64::from(from.readable()) || differ.any() {
                    return rows::<W, D>(from, index, mask);
                }
                if self.begin.get() != begin + 1 {
                    self.read(from, begin);
                }
                let mut all = [V::c(0); D];
                let kept: *const V = self.words.get().cast();
                for (at, value) in (offset..).zip(&mut all) {
                    // SAFETY: only `read` writes the words, and it is done; `offset` + D are N at most. Volatile, for a copy would
                    // be a call, and go through memory.
                    *value = unsafe { kept.add(at).read_volatile() };
                }
                all
            }

            /// Keeps the parts from a word on.
            #[inline(never)]
            $(#[$attr])*
            fn read(&self, from: Words<'_>, begin: u32) {
                // SAFETY: nothing else borrows the words meanwhile.
                let words = unsafe { &mut *self.words.get() };
                for (offset, kept) in (begin..).zip(words) {
                    *kept = word(from, V::c(offset).iadd(V::iota().imul(V::c(N as u32))));
                }
                self.begin.set(begin + 1);
            }
        }

        /// The same where the end of the buffer is near: each row as far as the buffer goes.
        #[cold]
        #[inline(never)]
        $(#[$attr])*
        fn rows_apart<const W: usize, const D: usize>(from: Words<'_>, index: V) -> [V; D] {
            let mut all = [V::c(0); D];
            for (offset, words) in (0..).step_by(W).zip(all.chunks_exact_mut(W)) {
                words.copy_from_slice(&row::<W>(from, index.iadd(V::c(offset))));
            }
            all
        }

        /// The `W` words from one index on, the same for all lanes.
        #[inline]
        $(#[$attr])*
        pub fn row_of<const W: usize>(from: Words<'_>, index: u32) -> [V; W] {
            let index = index.min(from.readable().saturating_sub(W as u32));
            if (from.readable() as usize) < W {
                return short_row(from);
            }
            let mut row = [V::c(0); W];
            for (at, value) in (0..).zip(&mut row) {
                // SAFETY: there are W words, so those up to `index` + W are.
                *value = V::c(unsafe { from.first().add((index + at) as usize).read() });
            }
            row
        }

        /// A row of a buffer that has fewer words: the last one in place of those.
        #[cold]
        #[inline(never)]
        $(#[$attr])*
        fn short_row<const W: usize>(from: Words<'_>) -> [V; W] {
            let mut row = [V::c(0); W];
            for (at, value) in (0..).zip(&mut row) {
                *value = V::c(from.word(at));
            }
            row
        }

        /// An index into an array of some length: beyond the end that of the last.
        #[inline(always)]
        pub const fn place(index: u32, length: usize) -> usize {
            let index = index as usize;
            if index < length { index } else { length - 1 }
        }

        /// Writes each active lane's word to its index.
        #[inline]
        $(#[$attr])*
        pub fn set_word(to: Words<'_>, index: V, value: V, mask: M) {
            let (index, value) = (index.to_array(), value.to_array());
            for lane in Bits(mask.bits()) {
                to.set(index[lane], value[lane]);
            }
        }

        /// Writes each active lane's words from its index on.
        #[inline]
        $(#[$attr])*
        pub fn set_row<const W: usize>(to: Words<'_>, index: V, value: [V; W], mask: M) {
            let last = V::c(to.len().saturating_sub(W as u32));
            if W.is_multiple_of(4) && mask.bits() == ALL && to.len() as usize >= W && !last.ult(index).any() {
                // SAFETY: `last` + W words at most are written; a kernel writes only what it got by `write`.
                return unsafe { scatter_row(to.first(), index, value) };
            }
            let index = index.to_array();
            let mut offset = 0;
            while offset + 4 <= W {
                let four = [value[offset], value[offset + 1], value[offset + 2], value[offset + 3]];
                let [a, b, c, d] = transpose(four);
                let rows = [a.to_array(), b.to_array(), c.to_array(), d.to_array()];
                for lane in Bits(mask.bits()) {
                    let block = lane / 4 * 4;
                    let row = &rows[lane % 4];
                    let words = [row[block], row[block + 1], row[block + 2], row[block + 3]];
                    to.set_four(index[lane].wrapping_add(offset as u32), words);
                }
                offset += 4;
            }
            while offset < W {
                let words = value[offset].to_array();
                for lane in Bits(mask.bits()) {
                    to.set(index[lane].wrapping_add(offset as u32), words[lane]);
                }
                offset += 1;
            }
        }

        /// Writes the words of all lanes from their indices on, four at a time.
        ///
        /// # Safety
        /// They may be written.
        #[inline]
        $(#[$attr])*
        unsafe fn scatter_row<const W: usize>(to: *mut u32, index: V, value: [V; W]) {
            let index = index.to_array();
            let mut offset = 0;
            while offset < W {
                let four = [value[offset], value[offset + 1], value[offset + 2], value[offset + 3]];
                let rows = transpose(four).map(V::to_array);
                for lane in 0..LANES {
                    let (row, block) = (&rows[lane % 4], lane / 4 * 4);
                    let words = [row[block], row[block + 1], row[block + 2], row[block + 3]];
                    // SAFETY: the caller vouches for the words of each lane.
                    unsafe { to.add(index[lane] as usize + offset).cast::<[u32; 4]>().write(words) };
                }
                offset += 4;
            }
        }

        /// An atomic operation of each active lane in turn; what was there before.
        #[inline]
        $(#[$attr])*
        fn atomic(at: Words<'_>, index: V, value: V, mask: M, f: impl Fn(&AtomicU32, u32) -> u32) -> V {
            let (index, mut value) = (index.to_array(), value.to_array());
            for lane in Bits(mask.bits()) {
                value[lane] = at.atomic(index[lane]).map_or(0, |word| f(word, value[lane]));
            }
            V::from_array(value)
        }

        common!(@atomic $(#[$attr])*; atomic_load |word, _| word.load(Relaxed));
        common!(@atomic $(#[$attr])*; atomic_store |word, value| { word.store(value, Relaxed); 0 });
        common!(@atomic $(#[$attr])*; atomic_add |word, value| word.fetch_add(value, Relaxed));
        common!(@atomic $(#[$attr])*; atomic_sub |word, value| word.fetch_sub(value, Relaxed));
        common!(@atomic $(#[$attr])*; atomic_and |word, value| word.fetch_and(value, Relaxed));
        common!(@atomic $(#[$attr])*; atomic_or |word, value| word.fetch_or(value, Relaxed));
        common!(@atomic $(#[$attr])*; atomic_xor |word, value| word.fetch_xor(value, Relaxed));
        common!(@atomic $(#[$attr])*; atomic_exchange |word, value| word.swap(value, Relaxed));
        common!(@atomic $(#[$attr])*; atomic_umin |word, value| word.fetch_min(value, Relaxed));
        common!(@atomic $(#[$attr])*; atomic_umax |word, value| word.fetch_max(value, Relaxed));
        common!(@atomic $(#[$attr])*; atomic_imin |word, value| signed(word, value, i32::min));
        common!(@atomic $(#[$attr])*; atomic_imax |word, value| signed(word, value, i32::max));

        /// An atomic operation on a signed integer.
        #[inline]
        fn signed(word: &AtomicU32, value: u32, f: fn(i32, i32) -> i32) -> u32 {
            let changed = word.fetch_update(Relaxed, Relaxed, |there| Some(f(there as i32, value as i32) as u32));
            match changed {
                Ok(before) | Err(before) => before,
            }
        }

        /// The index of all active lanes, if they have the same.
        #[inline]
        $(#[$attr])*
        fn shared(index: V, length: usize, mask: M) -> Option<usize> {
            let first = index.first(mask);
            let differ = mask.andnot(index.ieq(V::c(first)));
            (!differ.any()).then_some((first as usize).min(length - 1))
        }

        /// Where in an array of rows each lane's own word of column 0 lies.
        #[inline]
        $(#[$attr])*
        fn own(index: V, length: usize, columns: usize) -> V {
            let row = index.umin(V::c(length as u32 - 1)).imul(V::c((columns * LANES) as u32));
            row.iadd(V::iota())
        }

        /// The element of an array at each lane's index; the last beyond the end.
        #[inline]
        $(#[$attr])*
        pub fn at<const N: usize>(array: &[V; N], index: V, mask: M) -> V {
            let [value] = row_at(as_rows(array), index, mask);
            value
        }

        /// The row of an array at each lane's index; the last beyond the end.
        #[inline]
        $(#[$attr])*
        pub fn row_at<const C: usize, const N: usize>(array: &[[V; C]; N], index: V, mask: M) -> [V; C] {
            if let Some(shared) = shared(index, N, mask) {
                return array[shared];
            }
            let own = own(index, N, C);
            let mut row = [V::c(0); C];
            for (column, value) in (0..).zip(&mut row) {
                // SAFETY: the row is below N, the column below C and the lane below LANES.
                *value = unsafe { gather(array.as_ptr().cast(), own.iadd(V::c(column * LANES as u32))) };
            }
            row
        }

        /// Overwrites the element at each active lane's index; beyond the end the last.
        #[inline]
        $(#[$attr])*
        pub fn put<const N: usize>(array: &mut [V; N], index: V, value: V, mask: M) {
            row_put(as_rows_mut(array), index, [value], mask);
        }

        /// Overwrites the row at each active lane's index; beyond the end the last.
        #[inline]
        $(#[$attr])*
        pub fn row_put<const C: usize, const N: usize>(array: &mut [[V; C]; N], index: V, value: [V; C], mask: M) {
            for (column, value) in value.into_iter().enumerate() {
                put_column(array, index, column, value, mask);
            }
        }

        /// Overwrites one column of the row at each active lane's index; beyond the end that of the last.
        #[inline]
        $(#[$attr])*
        pub fn put_column<const C: usize, const N: usize>(
            array: &mut [[V; C]; N], index: V, column: usize, value: V, mask: M,
        ) {
            if let Some(shared) = shared(index, N, mask) {
                let place = &mut array[shared][column];
                *place = mask.pick(value, *place);
                return;
            }
            let (index, value) = (index.to_array(), value.to_array());
            for lane in Bits(mask.bits()) {
                let place = &mut array[(index[lane] as usize).min(N - 1)][column];
                let mut words = place.to_array();
                words[lane] = value[lane];
                *place = V::from_array(words);
            }
        }

        /// Elements as rows of one column.
        #[inline(always)]
        fn as_rows<const N: usize>(array: &[V; N]) -> &[[V; 1]; N] {
            // SAFETY: an array of one is laid out as what it holds.
            unsafe { &*std::ptr::from_ref(array).cast() }
        }

        /// The same to be written.
        #[inline(always)]
        fn as_rows_mut<const N: usize>(array: &mut [V; N]) -> &mut [[V; 1]; N] {
            // SAFETY: an array of one is laid out as what it holds.
            unsafe { &mut *std::ptr::from_mut(array).cast() }
        }
    };
    (@atomic $(#[$attr:meta])*; $name:ident |$word:pat_param, $value:pat_param| $body:expr) => {
        #[doc = concat!("`", stringify!($name), "` of each active lane in turn; what was there before.")]
        #[inline]
        $(#[$attr])*
        pub fn $name(at: Words<'_>, index: V, value: V, mask: M) -> V {
            atomic(at, index, value, mask, |$word, $value| $body)
        }
    };
}
