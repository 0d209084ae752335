//! Whether a device's arithmetic is exact: found out at start-up, because it decides what agreement to expect.

use super::cases::Case;
use crate::gpu::plan::Op;
use crate::gpu::{Device, Engine, Error};
use crate::kernels::{BufferId, KernelId, Phase};
use crate::sim::measure::Hash;
use std::sync::Arc;

/// Cases that the probe tries.
pub const CASES: u32 = super::cases::PROBED;

/// What the probe computes for each case, in the order of `numerics.wgsl`.
const RESULTS: [[Probed; 4]; 4] = [
    [Primitive("division"), Primitive("square root"), Primitive("product and sum"), Primitive("products")],
    [Primitive("conversion"), Primitive("floor"), Primitive("minimum"), Primitive("maximum")],
    [Function("sin"), Function("cos"), Function("atan2"), Function("acos")],
    [Function("exp2"), Function("wrap"), Function("unit_f32"), Primitive("absolute value")],
];

/// One result of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Probed {
    /// Of one operation, or of few that a driver might fuse or re-associate.
    Primitive(&'static str),
    /// Of a function of `exact.wgsl`: exact wherever the primitives are.
    Function(&'static str),
}
use Probed::{Function, Primitive};

/// Hash of what the primitives must give, on any machine.
const CORRECTLY_ROUNDED: u64 = 0x088a_6be7_511c_cccc;

/// What a device's arithmetic does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Numerics {
    /// The computer's own primitives give what IEEE 754 demands: there is something to compare with.
    pub is_host_exact: bool,
    /// Every primitive of the device has the bits of the correctly rounded one: CPU and device must agree bit for bit.
    pub exact: bool,
    /// Largest error of a division in units in the last place.
    pub division_ulp: u32,
    /// Largest error of a square root in units in the last place.
    pub square_root_ulp: u32,
    /// Results that differ, of all.
    pub different: u32,
    /// A primitive that differs.
    pub primitive: Option<&'static str>,
    /// A function that differs. Where the primitives do not, that is a fault: of its twin, or of what the device compiles.
    pub function: Option<&'static str>,
}

impl std::fmt::Display for Numerics {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { division_ulp, square_root_ulp, different, .. } = self;
        let all = CASES * 16;
        match (self.is_host_exact, self.primitive, self.function) {
            (false, ..) => f.write_str("this computer's own arithmetic is not that of IEEE 754"),
            (true, None, None) => f.write_str("exact"),
            (true, None, Some(function)) => {
                write!(f, "exact, but {different} of {all} results differ: {function} is wrong")
            }
            (true, Some(primitive), _) => write!(
                f,
                "{different} of {all} results differ, of {primitive} and others (division {division_ulp} ULP, \
                 square root {square_root_ulp} ULP)"
            ),
        }
    }
}

/// Distance in units in the last place between floats of the same sign.
fn ulps(a: f32, b: f32) -> u32 {
    let order = |x: f32| {
        let bits = x.to_bits();
        if bits >> 31 == 1 { !bits } else { bits | 0x8000_0000 }
    };
    if a.is_nan() || b.is_nan() { u32::MAX } else { order(a).abs_diff(order(b)) }
}

/// Runs the probe on a device and compares with the CPU.
///
/// # Errors
/// When the device fails.
pub fn numerics(device: &Arc<Device>) -> Result<Numerics, Error> {
    let Case { store: mut want, dispatches, .. } = super::cases::probe();
    let mut engine = Engine::new(device, &want, &[KernelId::Numerics])?;
    let ops: Vec<Op> = dispatches.into_iter().map(Op::Dispatch).collect();
    engine.run(&ops, |_, _| Vec::new(), false)?;
    let mut got = want.clone();
    engine.download(&mut got, &[BufferId::NumericsOut])?;
    crate::reference::run(Phase::Numerics, &mut want, 0);
    Ok(judged(&want.numerics_out, &got.numerics_out))
}

/// What the device's results say beside the CPU's.
fn judged(want: &[[f32; 4]], got: &[[f32; 4]]) -> Numerics {
    let mut found = Numerics {
        is_host_exact: host_hash(want) == CORRECTLY_ROUNDED,
        exact: true,
        division_ulp: 0,
        square_root_ulp: 0,
        different: 0,
        primitive: None,
        function: None,
    };
    for (index, (w, g)) in want.iter().zip(got).enumerate() {
        for (lane, probed) in RESULTS[index % 4].into_iter().enumerate() {
            if w[lane].to_bits() == g[lane].to_bits() {
                continue;
            }
            found.different += 1;
            match probed {
                Primitive(name) => {
                    found.exact = false;
                    found.primitive.get_or_insert(name);
                }
                Function(name) => {
                    found.function.get_or_insert(name);
                }
            }
        }
        if index % 4 == 0 {
            found.division_ulp = found.division_ulp.max(ulps(w[0], g[0]));
            found.square_root_ulp = found.square_root_ulp.max(ulps(w[1], g[1]));
        }
    }
    found
}

/// Hash of the primitives among results.
fn host_hash(results: &[[f32; 4]]) -> u64 {
    let mut hash = Hash::default();
    for (index, result) in results.iter().enumerate() {
        for (value, probed) in result.iter().zip(RESULTS[index % 4]) {
            if matches!(probed, Primitive(_)) {
                hash.add(&value.to_le_bytes());
            }
        }
    }
    hash.value()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn results() -> Vec<[f32; 4]> {
        let mut store = crate::verify::cases::probe().store;
        crate::reference::run(Phase::Numerics, &mut store, 0);
        store.numerics_out
    }

    #[test]
    fn a_function_that_differs_where_primitives_do_not_is_a_fault_and_no_tolerance() {
        let want = results();
        assert_eq!(judged(&want, &want).to_string(), "exact");
        for (index, probed) in RESULTS.into_iter().flatten().enumerate() {
            let mut got = want.clone();
            let value = &mut got[4 * 77 + index / 4][index % 4];
            *value = f32::from_bits(value.to_bits() ^ 1);
            let found = judged(&want, &got);
            let (primitive, function) = match probed {
                Primitive(name) => (Some(name), None),
                Function(name) => (None, Some(name)),
            };
            assert_eq!((found.primitive, found.function, found.different), (primitive, function, 1));
            assert_eq!(found.exact, function.is_some(), "{found}");
        }
    }

    #[test]
    fn a_computer_whose_own_arithmetic_is_wrong_is_found_out() {
        let mut want = results();
        assert!(judged(&want, &want).is_host_exact, "{:#x}", host_hash(&want));
        let quotient = &mut want[400][0];
        *quotient = f32::from_bits(quotient.to_bits() + 1);
        let found = judged(&want, &want);
        assert!(!found.is_host_exact && found.to_string().contains("IEEE 754"), "{found}");
    }
}
