//! Each kernel of `wgsl/` beside the same in plain Rust, with every set of instructions that the machine has.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    clippy::float_cmp,
    reason = "bits of words, as a shader has them"
)]

use wgsl_lanes::Isa;
use wgsl_lanes_constructs::{
    ACROSS, ALIKE, ALIKE_TO_MOST, ATOMICS, CORNERS, COUNTERS, FLOATS, FLOW, INTEGERS, KEPT, MEMORY, ROWS,
    Runs, SIDE_BY_SIDE, UNSET, run, run_rows,
};

/// Counts of invocations: none, fewer than lanes, as many, and more.
const COUNTS: [u32; 6] = [0, 1, 7, 16, 37, 256];

/// What each set makes of buffer `number` is what is expected.
fn expect(runs: Runs, buffers: &[Vec<u32>], immediate: u32, count: u32, number: usize, want: &[u32]) {
    let all = run(runs, buffers, immediate, count);
    assert!(!all.is_empty(), "no set of instructions is here");
    for (isa, made) in all {
        for (at, (want, got)) in want.iter().zip(&made[number]).enumerate() {
            let (a, b) = (f32::from_bits(*want), f32::from_bits(*got));
            assert!(
                want == got || (a.is_nan() && b.is_nan()),
                "{isa:?}, word {at} of {count}: {want:#x} {a}, got {got:#x} {b}"
            );
        }
        assert_eq!(want.len(), made[number].len());
    }
}

#[test]
fn the_widest_set_that_this_machine_has_is_compiled() {
    assert!(FLOATS.iter().any(|(isa, _)| *isa == Isa::best()), "{:?} is not among {FLOATS:?}", Isa::best());
    assert!(std::env::consts::ARCH != "aarch64" || Isa::best() == Isa::Neon, "{:?}", Isa::best());
}

fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

fn greater(a: f32, b: f32) -> f32 {
    if b < a { a } else { b }
}

#[test]
fn floats_are_those_of_ieee_754() {
    let special = [
        0.0f32,
        -0.0,
        1.0,
        -1.0,
        0.5,
        1.5,
        2.5,
        -2.5,
        3.999,
        1e-45,
        -1e-40,
        1e38,
        -3e38,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
        2_147_483_500.0,
        4_294_967_000.0,
        5e9,
        -5e9,
        16_777_215.0,
    ];
    let pairs: Vec<[f32; 2]> = special.iter().flat_map(|a| special.map(|b| [*a, b])).collect();
    let given: Vec<u32> = pairs.iter().flatten().map(|f| f.to_bits()).collect();
    let row = |[a, b]: [f32; 2]| {
        let clamped = if a < -1.5 { -1.5 } else { a };
        let signs = [a < b, a <= b, a == b, a != b, a > b, a >= b];
        let bits = signs.iter().enumerate().fold(0, |bits, (at, is)| bits | u32::from(*is) << at);
        [
            a + b,
            a - b,
            a * b,
            a / b,
            a.sqrt(),
            lesser(a, b),
            greater(a, b),
            if b < clamped { b } else { clamped },
            a.floor() + b.ceil(),
            a.trunc() * 2.0 + b.round_ties_even(),
            a.abs() - -b,
            (a as u32) as f32,
            (b as i32) as f32,
            f32::from_bits(bits),
            f32::from_bits((a as u32) ^ (b as i32) as u32),
            (a * b + b * 3.0) + (a * (1.0 - 0.25) + b * 0.25) + (a - a.floor()),
        ]
        .map(f32::to_bits)
    };
    let want: Vec<u32> = pairs.iter().flat_map(|pair| row(*pair)).collect();
    let count = pairs.len() as u32;
    expect(FLOATS, &[given, vec![0; want.len()]], 0, count + 40, 1, &want); // those beyond the end do nothing
}

/// Words that are not all alike.
fn draws(count: usize) -> Vec<u32> {
    let next = |x: &u32| Some(x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    std::iter::successors(Some(12_345), next).take(count).map(|x| (x ^ x >> 15) >> (x >> 27)).collect()
}

#[test]
fn integers_wrap_and_divide_as_in_the_language() {
    for count in COUNTS {
        let given = draws(2 * count as usize);
        let row = |pair: &[u32]| {
            let (a, b) = (pair[0], pair[1]);
            let (s, t) = (a as i32, b as i32);
            let bits =
                |all: &[bool]| all.iter().enumerate().fold(0, |bits, (at, is)| bits | u32::from(*is) << at);
            [
                a.wrapping_add(b),
                a.wrapping_sub(b),
                a.wrapping_mul(b),
                a / b.max(1),
                a % b.max(1),
                (s / t.max(1)) as u32,
                (s % t.max(1)) as u32,
                (a & b) | (a ^ b),
                !a,
                a << (b % 32),
                a >> (b % 32),
                (s >> (b % 32)) as u32,
                a.min(b),
                a.max(b),
                s.min(t) as u32,
                s.max(-100).min(t.max(-100)) as u32,
                a.count_ones() + b.leading_zeros() * 64 + a.trailing_zeros() * 4096,
                (s.wrapping_neg() as u32).wrapping_add(t.unsigned_abs()),
                bits(&[a < b, a <= b, a == b, a > b, a >= b]),
                bits(&[s < t, s <= t, s != t, s > t, s >= t]),
                (a as f32).to_bits(),
                (s as f32).to_bits(),
                if a > 7 && b > 7 { b } else { a }.wrapping_add(if a > 9 || b > 9 { 2 } else { 1 }),
                u32::from((a != 0) != (b & 1 != 0))
                    + u32::from((a > 3) == (b > 3)) * 2
                    + u32::from(a <= b) * 4,
            ]
        };
        let want: Vec<u32> = given.chunks(2).flat_map(row).collect();
        expect(INTEGERS, &[given, vec![0; want.len()]], 0, count, 1, &want);
    }
}

fn collatz(start: u32) -> u32 {
    let (mut at, mut turns) = (start, 0);
    loop {
        if at <= 1 {
            return turns;
        }
        if turns > 40 {
            break;
        }
        at = if at % 2 == 0 { at / 2 } else { at.wrapping_mul(3).wrapping_add(1) };
        turns += 1;
    }
    at.wrapping_add(1000)
}

fn pairs(most: u32) -> u32 {
    let mut count = 0;
    for i in 0..most {
        for j in i..12 {
            if (i + j) % 3 == 0 {
                continue;
            }
            if i * j > most + 7 {
                return count + 100 * i;
            }
            if j > most {
                break;
            }
            count += 1;
        }
        if count > 40 {
            continue;
        }
        count += 2;
    }
    count
}

fn name(kind: u32) -> u32 {
    match kind {
        0 => 1,
        1 | 2 => 20,
        5 => 500,
        _ => 7 + kind,
    }
}

fn machine(program: u32) -> u32 {
    let (mut rest, mut sum) = (program, 0u32);
    while rest != 0 {
        let code = rest & 3;
        rest >>= 2;
        match code {
            0 => continue,
            1 => sum += 1,
            2 if sum > 5 => {}
            2 => sum *= 2,
            _ => sum += 10,
        }
        sum ^= 1;
    }
    sum
}

#[test]
fn lanes_part_and_meet_again_in_branches_loops_and_switches() {
    for count in COUNTS {
        let mut given: Vec<u32> = draws(count as usize).into_iter().map(|x| x % 97).collect();
        if let Some(third) = given.get_mut(2) {
            *third = 13;
        }
        let row = |value: u32| {
            if value == 13 {
                return [13; 4];
            }
            let mut last = name(value * 2 % 8);
            loop {
                last += 3;
                if last > value {
                    break;
                }
            }
            [collatz(value), pairs(value % 12), name(value % 7) + 10000 * last, machine(value)]
        };
        let want: Vec<u32> = given.iter().flat_map(|value| row(*value)).collect();
        expect(FLOW, &[given, vec![0; want.len()]], 0, count, 1, &want);
    }
}

fn carried(value: u32) -> u32 {
    let (mut kept, mut sum) = (0u32, 0u32);
    for turn in 0..6 {
        if value >> turn & 1 == 1 {
            kept = turn + 5;
        }
        if (value + turn).is_multiple_of(3) {
            continue;
        }
        kept = kept * 2 + 1;
        sum += kept;
    }
    sum
}

#[test]
fn rare_ends_and_choices_are_those_of_the_language() {
    for count in COUNTS {
        let given: Vec<u32> = draws(count as usize).into_iter().map(|x| x % 97).collect();
        let row = |value: u32| {
            let root = (1..).find(|root| root * root > value).unwrap();
            let half = match value {
                odd if odd % 2 == 1 => odd + 100,
                even if even / 2 > 40 => 1,
                even => even / 2 + 1000,
            };
            let is_small = if value.is_multiple_of(2) { value < 90 } else { value > 3 };
            let both = [if is_small { value < 9 } else { true }, if value > 20 { false } else { value > 8 }];
            let flags = [is_small, both[0], both[1], false, value != 0];
            let bits = flags.iter().enumerate().fold(0, |bits, (at, is)| bits | u32::from(*is) << at);
            [root, half, carried(value), bits + (40 + value) * 32 + 10]
        };
        let want: Vec<u32> = given.iter().flat_map(|value| row(*value)).collect();
        expect(CORNERS, &[given, vec![0; want.len()]], 0, count, 1, &want);
    }
}

/// `Item`: 8 words and 2 that fill it up, since its `vec2` begins at an even word.
const ITEM: usize = 8;

/// What `memory.wgsl` makes: the copies, and `made`.
fn memory(id: u32, given: &[u32], settings: &[u32]) -> (Vec<u32>, [u32; 4]) {
    let f = f32::from_bits;
    let mut item = given.to_vec();
    let (low, high, count, table) = (0, 2, 4, 5);
    let by = id + 1;
    item[count] = item[count].wrapping_add(by);
    item[table + (by % 3) as usize] = by;
    item[high + 1] = (f(item[high + 1]) + 1.0).to_bits();
    let (mut stack, mut words) = ([[0.0f32; 2]; 6], [9u32, 8, 7, 6, 5]);
    let (mut top, mut other) = (0u32, 70u32);
    for i in 0..item[count] % 7 {
        stack[top as usize] = [i as f32 * f(settings[0]), f(item[low]) * f(settings[1])];
        top = (top + 1).min(5);
    }
    stack[(item[count] % 4) as usize][1] = 50.0;
    top += words[(item[count] % 6).min(4) as usize];
    std::mem::swap(&mut top, &mut other);
    words[(id % 3) as usize] = [3, 1, 4, 1][(top % 4) as usize];
    words[4] = words[1] + settings[4 + 4 * (id % 2) as usize + (id % 4) as usize] + settings[8 + 2];
    let v = [f(item[low]), 2.0];
    let mut chosen = if v[0] < 0.0 { (v[1], [-v[1], -v[0]]) } else { (v[0], v) };
    let picked = stack[(id % 5) as usize];
    if item[count] > 4 {
        stack[1] = [0.0, f(settings[14])];
        chosen = (1.0, picked);
    }
    let made = [
        (top + 100 * other) as f32,
        words[(id % 5) as usize] as f32,
        stack[1][1] + chosen.1[0],
        picked[(item[count] % 2) as usize],
    ];
    item[low] = chosen.0.to_bits();
    item[high] = chosen.1[0].to_bits();
    item[high + 1] = chosen.1[1].to_bits();
    (item, made.map(f32::to_bits))
}

#[test]
fn variables_arrays_and_buffers_hold_what_each_lane_put_there() {
    let offset = 3;
    let settings: Vec<u32> = [2.0f32, -3.0, 0.0, 0.0]
        .map(f32::to_bits)
        .into_iter()
        .chain([10, 20, 30, 40, 50, 60, 70, 80])
        .chain([1.5f32, 2.5, 3.5, 4.5].map(f32::to_bits))
        .collect();
    for count in COUNTS {
        let items: Vec<Vec<u32>> = (0..count + offset)
            .map(|i| {
                let floats = [i as f32 - 9.0, 0.0, 0.5, i as f32];
                floats.map(f32::to_bits).into_iter().chain([i * 7, 1, 2, 3]).collect()
            })
            .collect();
        let (mut copies, mut made) = (Vec::new(), Vec::new());
        for id in 0..count {
            let (copy, row) = memory(id, &items[(id + offset) as usize], &settings);
            // the gap behind `low` is not written
            copies.extend(copy.iter().enumerate().map(|(at, word)| if at == 1 { 0 } else { *word }));
            made.extend(row);
        }
        let empty = |words: usize| vec![0; words];
        let buffers = [
            settings.clone(),
            items.concat(),
            empty(count as usize * ITEM),
            empty(count as usize * 4),
            vec![],
        ];
        expect(MEMORY, &buffers, offset, count, 2, &copies);
        expect(MEMORY, &buffers, offset, count, 3, &made);
    }
}

#[test]
fn atomic_operations_lose_nothing() {
    for count in COUNTS {
        let given: Vec<u32> =
            draws(count as usize).into_iter().map(|x| (x % 2001).wrapping_sub(1000)).collect();
        let mut sums = [0u32, 0, 0, 0, u32::MAX, u32::MAX, 0, 0, 0, 0];
        let (mut extremes, mut list) = ([i32::MAX, i32::MIN, 0], vec![0; count as usize]);
        for (id, bits) in (0..).zip(&given) {
            let value = *bits as i32;
            sums[0] = sums[0].wrapping_add(*bits);
            sums[1] = sums[1].wrapping_sub(*bits);
            sums[2] |= bits;
            sums[3] ^= bits;
            sums[4] &= bits | 0xffff_0000;
            sums[5] = sums[5].min(*bits);
            sums[6] = sums[6].max(*bits);
            extremes = [extremes[0].min(value), extremes[1].max(value), extremes[2]];
            if value > 0 {
                list[sums[7] as usize] = id;
                sums[7] += 1;
                sums[8 + (id % 2) as usize] = 1;
                extremes[2] = 5;
            }
        }
        let start = vec![0u32, 0, 0, 0, u32::MAX, u32::MAX, 0, 0, 0, 0];
        let ends = [i32::MAX as u32, i32::MIN as u32, 0].to_vec();
        let buffers = [given, start, ends, vec![0; count as usize]];
        expect(ATOMICS, &buffers, 0, count, 1, &sums);
        expect(ATOMICS, &buffers, 0, count, 2, &extremes.map(|value| value as u32));
        expect(ATOMICS, &buffers, 0, count, 3, &list);
    }
}

/// What `counters.wgsl` does.
fn counters(own: u32, given: &[u32], first: u32) -> [u32; 8] {
    let mut rows = [[0u32; 2]; 6];
    let mut words = [0u32; 5];
    let mut pairs = [[0u32; 2]; 3];
    let row = |i: u32| (i as usize).min(5);
    let word = |i: u32| (i as usize).min(4);
    let mut number = 0;
    while number < own % 9 && number != own % 5 + 2 {
        if number % 2 != own % 2 {
            rows[row(number)] = [number * 10 + own % 4, own];
            let more = rows[row(number)][1].wrapping_add(given[(number as usize).min(given.len() - 1)]);
            words[word(number)] = words[word(number)].wrapping_add(more);
        }
        number += 1;
    }
    let mut nested = 0u32;
    for i in first..first + 3 {
        let mut j = i;
        while j < i + own % 4 {
            nested = nested.wrapping_mul(7).wrapping_add(rows[row(j)][0]).wrapping_add(words[word(i)]);
            pairs[(i % 3) as usize][0] += j;
            rows[row(j)][1] = nested;
            j += 2;
        }
        pairs[((i - first) as usize).min(2)][1] = nested;
    }
    let mut total = 0u32;
    for i in own % 3..5 {
        total = total.wrapping_add(rows[row(i)][0].wrapping_mul(i + 1));
    }
    for i in (0..5).step_by((own % 2 + 1) as usize) {
        total = total.wrapping_mul(5).wrapping_add(words[i]);
    }
    let mut i = 0;
    while i < 5 {
        if words[word(i)] % 2 == 1 {
            i += 1;
        }
        total = total.wrapping_mul(5).wrapping_add(words[word(i)]);
        i += 1;
    }
    let (between, mut onward) = (total, 0);
    for turn in 0..2 {
        while onward < own % 6 {
            if words[word(onward)] % 3 == 2 {
                onward += 1;
                break;
            }
            total = total.wrapping_add(words[word(onward)].wrapping_mul(turn + 1));
            onward += 1;
        }
        total = total.wrapping_mul(2).wrapping_add(onward);
    }
    let mut again = 0;
    for turn in 0..3 {
        while again < own % 7 && words[word(again)].wrapping_add(own).wrapping_add(again) % 3 != turn {
            total = total.wrapping_add(words[word(again)].wrapping_mul(3));
            again += 1;
        }
        total = total.wrapping_mul(2).wrapping_add(again);
    }
    let sum = |base: u32, count: u32, from: u32| {
        (from..count).fold(0u32, |sum, i| sum.wrapping_mul(3).wrapping_add(rows[row(base + i)][0]))
    };
    let all = pairs.iter().fold(0u32, |all, [low, high]| {
        all.wrapping_mul(11).wrapping_add(*low).wrapping_add(high.wrapping_mul(3))
    });
    let sums = [sum(0, own % 5, 0), sum(own % 3, 3, own % 2), sum(first, 4, 1)];
    [number, nested, between, total, sums[0], sums[1], sums[2], all]
}

#[test]
fn counters_of_loops_are_those_of_each_lane() {
    for (count, first) in COUNTS.into_iter().flat_map(|count| [0, 2].map(|first| (count, first))) {
        let given: Vec<u32> = (0..count.max(1)).map(|i| i.wrapping_mul(2_654_435_761) >> 7).collect();
        let want: Vec<u32> =
            given.iter().take(count as usize).flat_map(|own| counters(*own, &given, first)).collect();
        expect(COUNTERS, &[given, vec![0; 8 * count as usize]], first, count, 1, &want);
    }
}

/// `fold` of `wgsl/alike.wgsl`.
fn fold(value: u32, most: u32, flags: u32) -> u32 {
    let mut sum = value;
    for i in 0..8 {
        if flags & 1 != 0 {
            if i == 3 {
                continue;
            }
            sum = sum.wrapping_mul(3).wrapping_add(i);
        }
        if (flags as i32) < 0 && value > 5 {
            return sum.wrapping_add(100);
        }
        if flags <= 6 {
            sum ^= 5;
        } else {
            sum = sum.wrapping_add(value % (i + 1));
            if i >= 4 && flags != 9 {
                break;
            }
        }
        if i == most {
            return sum.wrapping_add(1000);
        }
        if flags & 7 >= 4 {
            sum = sum.wrapping_add(7);
        } else if i <= 2 {
            sum = sum.wrapping_add(value & 1);
        }
    }
    sum
}

/// Immediates that take every branch of `fold`.
const FLAGS: [u32; 8] = [0, 1, 4, 6, 7, 9, 40, 0x8000_0003];

#[test]
fn what_all_lanes_have_alike_is_one_branch() {
    for flags in FLAGS {
        for count in COUNTS {
            let given = draws(count as usize);
            for (kernel, most) in [(ALIKE, 6), (ALIKE_TO_MOST, flags % 9)] {
                let want: Vec<u32> = given.iter().map(|value| fold(*value, most, flags)).collect();
                expect(kernel, &[given.clone(), vec![0; want.len()]], flags, count, 1, &want);
            }
        }
    }
}

#[test]
fn arrays_that_are_not_cleared_hold_what_is_written_first() {
    for count in COUNTS {
        let given = draws(count as usize);
        for (isa, made) in run(UNSET, &[given.clone(), vec![0; 2 * given.len()]], 0, count) {
            for (at, value) in given.iter().enumerate() {
                let most = value % 5;
                let add = |sum: u32, i| sum.wrapping_mul(7).wrapping_add(value.wrapping_mul(i + 1));
                assert_eq!(made[1][2 * at], (0..most).fold(most, add), "{isa:?}, {at} of {count}");
            }
            let left: u32 = made[1].iter().skip(1).step_by(2).sum();
            assert!(left < count.max(1), "{isa:?}: the first found what none had left");
            assert!(count < 256 || left > 0, "{isa:?}: nothing was left to others");
        }
    }
}

#[test]
fn elements_side_by_side_are_those_of_two_reads() {
    for (count, length) in [(1, 1), (7, 1), (16, 2), (37, 3), (256, 40)] {
        let (given, pairs) = (draws(count), draws(2 * length));
        let pair = |at: usize| [0, 1].map(|part| pairs[2 * at.min(length - 1) + part]);
        let of = |(number, value): (usize, &u32)| {
            let at = *value as usize % length;
            let ([a, b], [c, d]) = (pair(at), pair(at + 1));
            let [e, f, g] = [at, at + 1, number + 1].map(|at| given[at.min(count - 1)]);
            let parts = [(a, 3), (b, 5), (c, 7), (d, 11), (e, 13), (f, 17), (g, 19)];
            parts.iter().fold(0u32, |sum, (word, by)| sum.wrapping_add(word.wrapping_mul(*by)))
        };
        let want: Vec<u32> = given.iter().enumerate().map(of).collect();
        expect(SIDE_BY_SIDE, &[given, vec![0; count], pairs], 0, count as u32, 1, &want);
    }
}

#[test]
fn rows_side_by_side_are_those_of_three_reads() {
    for (count, length, spread) in
        [(1, 1, 1), (7, 4, 2), (16, 40, 37), (37, 40, 60), (256, 300, 1), (256, 300, 290)]
    {
        let (draws, given) = (draws(count), draws(4 * length));
        let places: Vec<u32> = draws.iter().map(|draw| draw % spread).collect();
        let row = |at: u32| {
            let first = 4 * (at as usize).min(length - 1);
            [0, 1, 2, 3].map(|word| given[first + word])
        };
        let of = |(number, at): (usize, &u32)| {
            let [first, second, third] = [0, 1, 2].map(|behind| row(at + behind));
            let [a, b, c, d] = first;
            let later = places[(number + 2).min(count - 1)];
            let both = std::array::from_fn(|word| (first[word] ^ second[word]).wrapping_add(later));
            [third, [d, c, b, a], both].concat()
        };
        let want: Vec<u32> = places.iter().enumerate().flat_map(of).collect();
        expect(ROWS, &[places, given, vec![0; 12 * count]], 0, count as u32, 2, &want);
        // the last element is not there: what does not fit is dropped
        let short = want[..want.len() - 12].to_vec();
        let places: Vec<u32> = draws.iter().map(|draw| draw % spread).collect();
        let given = self::draws(4 * length);
        expect(ROWS, &[places, given, vec![0; 12 * (count - 1)]], 0, count as u32, 2, &short);
    }
}

#[test]
fn lanes_along_y_give_what_lanes_along_x_do() {
    for [width, height] in [[1, 1], [5, 7], [3, 16], [40, 37], [9, 300]] {
        let (columns, rows) = (draws(width), draws(2 * height));
        let (columns, rows): (Vec<u32>, Vec<u32>) =
            (columns.iter().map(|word| word % 50).collect(), rows.iter().map(|word| word % 60).collect());
        let column = |at: u32| columns[(at as usize).min(width - 1)];
        let row = |at: usize| [0, 1].map(|part| rows[2 * at.min(height - 1) + part]);
        let mut want = Vec::new();
        for y in 0..height {
            for x in 0..width as u32 {
                let [mut value, other] = row(y);
                let here = column(x);
                if here.is_multiple_of(3) {
                    value = value.wrapping_add(other.wrapping_mul(here));
                } else if other > here {
                    value = value.wrapping_sub(column(other));
                }
                for i in 0..here % 5 {
                    let more = column(i).wrapping_add(row(i as usize)[1]).wrapping_add(x);
                    value = value.wrapping_mul(3).wrapping_add(more);
                }
                want.push(value);
            }
        }
        let sizes = vec![width as u32, height as u32];
        let buffers = [columns.clone(), rows.clone(), vec![0; width * height], sizes];
        // more than there are: they return at once
        for (isa, made) in run_rows(ACROSS, &buffers, 0, [width as u32 + 2, height as u32 + 3]) {
            assert_eq!(made[2], want, "{isa:?}, {width} by {height}");
        }
    }
}

#[test]
fn what_is_kept_of_a_buffer_is_what_it_holds() {
    // parts one behind the other from some part on, to the end of the buffer and beyond, and in no order
    type Place = fn(u32) -> u32;
    let cases: [(usize, usize, Place); 6] = [
        (16, 16, |y| y),
        (16, 40, |y| y + 7),
        (5, 9, |y| y + 2),
        (37, 30, |y| y),
        (64, 64, |y| y),
        (64, 70, |y| y * 7 % 64),
    ];
    for (height, parts, place) in cases {
        let places: Vec<u32> = (0..height as u32).map(place).collect();
        let own = draws(5 * 4 * parts);
        let element = |at: u32| {
            let first = 4 * (at as usize).min(5 * parts - 1);
            [0, 1, 2, 3].map(|word| own[first + word])
        };
        let one = |y: usize, x: u32| {
            let at = places[y] * 5 + x;
            let (first, second) = (element(at), element(at + 1));
            std::array::from_fn::<u32, 4, _>(|word| first[word].wrapping_mul(3).wrapping_add(second[word]))
        };
        let want: Vec<u32> = (0..height).flat_map(|y| (0..5).flat_map(move |x| one(y, x))).collect();
        let buffers = [places.clone(), own.clone(), vec![0; 20 * height]];
        for (isa, made) in run_rows(KEPT, &buffers, 0, [5, height as u32]) {
            assert_eq!(made[2], want, "{isa:?}, {height} of {parts} parts");
        }
    }
}
