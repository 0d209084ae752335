//! Who computes what a twin computes, and which of them is wrong where they differ.

use super::Comparison;
use crate::kernels::KernelId;
use serde::Serialize;
use wgsl_lanes::Isa;

/// One that computes beside the twin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Device,
    Lanes(Isa),
}

impl Side {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Device => "device",
            Self::Lanes(Isa::Portable) => "lanes (portable)",
            Self::Lanes(Isa::Neon) => "lanes (NEON)",
            Self::Lanes(Isa::Avx2) => "lanes (AVX2)",
            Self::Lanes(Isa::Avx512) => "lanes (AVX-512)",
        }
    }
}

/// One side against the twin: a row of [`KernelRow::sides`].
#[doc(hidden)]
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SideRow {
    /// `device`, or `lanes` and their instructions.
    pub side: &'static str,
    /// Words compared.
    pub compared: usize,
    /// Words with equal bits.
    pub exact: usize,
    /// Largest difference; `null` in JSON where one side is not finite or an integer differs.
    pub max_error: f32,
    /// The first difference: case, buffer, element, both values.
    pub first: Option<String>,
}

/// One kernel against its twin, on all sides.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KernelRow {
    /// Kernel.
    pub name: &'static str,
    /// Who computed it beside the twin (`side`: `device`, or `lanes` and their instructions), with the words `compared` and those that are
    /// `exact`, the largest difference (`max_error`) and the `first`.
    pub sides: Vec<SideRow>,
    /// Whether all bits are equal.
    pub pass: bool,
    /// Who is wrong, `twin` among them: those that the others outvote, or all that differ where it is one against one.
    pub differs: Vec<&'static str>,
}

/// Comparisons of a kernel, by side.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) kernel: KernelId,
    sides: Vec<(Side, Comparison)>,
}

/// Adds the comparison of a case.
pub(super) fn merge(found: &mut Vec<Found>, side: Side, mut new: Comparison, case: &str) {
    new.first = new.first.map(|first| format!("{case}: {first}"));
    let kernel = new.kernel;
    let at = found.iter().position(|old| old.kernel == kernel).unwrap_or_else(|| {
        found.push(Found { kernel, sides: Vec::new() });
        found.len() - 1
    });
    let sides = &mut found[at].sides;
    match sides.iter_mut().find(|(known, _)| *known == side) {
        Some((_, old)) => old.merge(new),
        None => sides.push((side, new)),
    }
}

impl From<Found> for KernelRow {
    fn from(found: Found) -> Self {
        let votes: Vec<_> =
            found.sides.iter().map(|(side, c)| (*side, c.exact == c.compared, c.digest())).collect();
        let row = |(side, comparison): (Side, Comparison)| {
            let Comparison { compared, exact, max_error, first, .. } = comparison;
            SideRow { side: side.name(), compared, exact, max_error, first }
        };
        let differs = wrong(&votes);
        Self {
            name: found.kernel.kernel().name,
            sides: found.sides.into_iter().map(row).collect(),
            pass: differs.is_empty(),
            differs,
        }
    }
}

/// Who is wrong: of each side whether it agrees with the twin, and the hash of its results.
///
/// Where all sides agree against the twin, and there are a device and lanes among them, the twin is outvoted: a device and a CPU
/// share the shader alone. A device or lanes against the other two are outvoted as well.
pub(super) fn wrong(votes: &[(Side, bool, u64)]) -> Vec<&'static str> {
    let off: Vec<&(Side, bool, u64)> = votes.iter().filter(|(_, agrees, _)| !agrees).collect();
    let Some((_, _, first)) = off.first() else { return Vec::new() };
    let is_whole = off.len() == votes.len();
    let has = |is: fn(Side) -> bool| votes.iter().any(|(side, ..)| is(*side));
    let has_both = has(|side| side == Side::Device) && has(|side| side != Side::Device);
    if is_whole && has_both && off.iter().all(|(_, _, hash)| hash == first) {
        return vec!["twin"];
    }
    let mut names: Vec<&'static str> = off.iter().map(|(side, ..)| side.name()).collect();
    if is_whole && !has_both {
        names.push("twin"); // it may be either
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    const LANES: Side = Side::Lanes(Isa::Avx2);

    #[test]
    fn no_kernel_is_allowed_any_difference() {
        let comparison = |exact| {
            let mut comparison = Comparison::none(KernelId::Integrate);
            (comparison.compared, comparison.exact, comparison.max_error) = (100, exact, 1e-9);
            comparison
        };
        let row = |exact| {
            let mut found = Vec::new();
            merge(&mut found, Side::Device, comparison(exact), "one");
            KernelRow::from(found.remove(0))
        };
        assert!(row(100).pass);
        assert!(!row(99).pass);
    }

    #[test]
    fn cases_add_up_and_the_first_difference_is_kept_with_its_case() {
        let mut found = Vec::new();
        for (case, first) in [("one", None), ("two", Some("a")), ("three", Some("b"))] {
            let mut new = Comparison::none(KernelId::Integrate);
            (new.compared, new.exact) = (100, if first.is_some() { 98 } else { 100 });
            new.max_error = 0.5;
            new.first = first.map(str::to_owned);
            merge(&mut found, LANES, new, case);
        }
        let row = KernelRow::from(found.remove(0));
        assert_eq!((row.sides[0].compared, row.sides[0].exact, row.sides[0].max_error), (300, 296, 0.5));
        assert_eq!(row.sides[0].first.as_deref(), Some("two: a"));
    }

    #[test]
    fn the_one_that_two_outvote_is_named() {
        let vote = |device: (bool, u64), lanes: (bool, u64)| {
            wrong(&[(Side::Device, device.0, device.1), (LANES, lanes.0, lanes.1)])
        };
        assert!(vote((true, 1), (true, 1)).is_empty());
        assert_eq!(vote((false, 2), (true, 1)), ["device"]);
        assert_eq!(vote((true, 1), (false, 2)), ["lanes (AVX2)"]);
        assert_eq!(vote((false, 2), (false, 2)), ["twin"]);
        assert_eq!(vote((false, 2), (false, 3)), ["device", "lanes (AVX2)"]);
    }

    #[test]
    fn one_against_one_says_no_more_than_that_they_differ() {
        assert_eq!(wrong(&[(LANES, false, 2)]), ["lanes (AVX2)", "twin"]);
        assert_eq!(wrong(&[(Side::Device, false, 2)]), ["device", "twin"]);
        let sets = [(Side::Lanes(Isa::Portable), true, 1), (Side::Lanes(Isa::Avx512), false, 2)];
        assert_eq!(wrong(&sets), ["lanes (AVX-512)"]);
        let all = [(Side::Lanes(Isa::Portable), false, 2), (Side::Lanes(Isa::Avx512), false, 2)];
        assert_eq!(wrong(&all), ["lanes (portable)", "lanes (AVX-512)", "twin"]);
    }
}
