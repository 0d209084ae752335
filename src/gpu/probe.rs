//! What a device's own arithmetic does, measured by the kernel `arithmetic`.

use super::arithmetic::{Arithmetic, Fault, Part, Wanted};
use super::instance::DriverId;
use super::plan::Op;
use super::{Device, Engine, Error};
use crate::kernels::probe::{self, Case, Class, Primitive};
use crate::kernels::{BufferId, Dispatch, KernelId, Phase, Store};
use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// Cases that a device is probed with when it first computes.
const CASES: u32 = 8_192;

/// What the arithmetic of a device does.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Probe {
    /// The primitives that do not always give the bits of IEEE 754, with their largest error in units in the last place.
    pub inexact: BTreeMap<Primitive, u32>,
    /// Whether a subnormal operand or result has been taken for zero.
    pub flushes_subnormals: bool,
}

impl fmt::Display for Probe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<String> =
            self.inexact.iter().map(|(primitive, ulps)| in_words(*primitive, *ulps)).collect();
        match names.as_slice() {
            [] => f.write_str("exact")?,
            names => write!(f, "not exact: {}", names.join(", "))?,
        }
        if self.flushes_subnormals { f.write_str("; subnormal numbers are flushed") } else { Ok(()) }
    }
}

fn in_words(primitive: Primitive, ulps: u32) -> String {
    match (primitive, ulps) {
        (_, 0) => format!("{} (sign of zero)", primitive.name()),
        (_, 1..=1000) => format!("{} by {ulps} ULP", primitive.name()),
        _ => primitive.name().to_owned(),
    }
}

/// Two devices of one key compute alike.
type Key = (DriverId, Vec<Fault>);

/// What has been found in this process.
static FOUND: Mutex<Vec<(Key, Probe)>> = Mutex::new(Vec::new());

impl Probe {
    /// Probes the device's own arithmetic, once in a process for each device.
    ///
    /// # Errors
    /// When the device fails.
    pub fn of_native(device: &Arc<Device>) -> Result<Self, Error> {
        let key = (device.driver, device.setting.faults.clone());
        let mut found = FOUND.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, probe)) = found.iter().find(|(known, _)| *known == key) {
            return Ok(probe.clone());
        }
        let probe = Self::of(device, &device.arithmetic_of(Vec::new()), CASES)?;
        found.push((key, probe.clone()));
        Ok(probe)
    }

    /// Probes what `arithmetic` makes of a device, with so many cases.
    ///
    /// # Errors
    /// When the device fails.
    pub fn of(device: &Arc<Device>, arithmetic: &Arithmetic, cases: u32) -> Result<Self, Error> {
        let cases = probe::cases(cases as usize);
        let mut store = Store {
            numerics_in: cases.iter().map(|(case, _)| *case).collect(),
            arithmetic_out: vec![[0.0; 4]; 3 * cases.len()],
            ..Store::default()
        };
        #[allow(clippy::cast_possible_truncation, reason = "as many as were asked for")]
        let dispatch = Dispatch::of(Phase::Arithmetic, cases.len() as u32);
        let code = |entry: &'static crate::kernels::Entry| Ok(vec![arithmetic.applied(entry.spirv)?.into()]);
        let code = |kernel: &'static crate::kernels::Kernel| code(kernel.phases[0].entry());
        let mut engine = Engine::of_code(device, &store, &[KernelId::Arithmetic], code)?;
        engine.run(&[Op::Dispatch(dispatch)], |_, _| Vec::new(), false)?;
        engine.download(&mut store, &[BufferId::ArithmeticOut])?;
        Ok(Self::judged(&cases, &store.arithmetic_out))
    }

    /// What the device's results say beside those of IEEE 754.
    fn judged(cases: &[Case], results: &[[f32; 4]]) -> Self {
        let mut found = Self::default();
        for ((case, class), got) in cases.iter().zip(results.chunks_exact(3)) {
            let want = probe::expected(*case);
            let both = want.iter().flatten().zip(got.iter().flatten());
            for (primitive, (want, got)) in Primitive::ALL.into_iter().zip(both) {
                if want.to_bits() == got.to_bits() {
                    continue;
                }
                match class {
                    Class::Subnormal => found.flushes_subnormals |= want.is_subnormal() && *got == 0.0,
                    Class::Normal => {
                        let largest = found.inexact.entry(primitive).or_default();
                        *largest = ulps(*want, *got).max(*largest);
                    }
                }
            }
        }
        found
    }

    /// Whether every primitive gives the bits of IEEE 754, subnormal numbers apart.
    pub fn is_exact(&self) -> bool {
        self.inexact.is_empty()
    }

    /// What careful code can mend.
    pub(super) fn inexact_parts(&self) -> Vec<Part> {
        let is_inexact =
            |part: &Part| self.inexact.keys().any(|primitive| Part::of(*primitive) == Some(*part));
        Part::ALL.into_iter().filter(is_inexact).collect()
    }
}

impl Device {
    /// The arithmetic of its kernels: the device's own, or careful code for what is not exact. Probes the device when first
    /// asked, where that is left to us.
    ///
    /// # Errors
    /// When the device fails.
    pub fn arithmetic(self: &Arc<Self>) -> Result<&Arithmetic, Error> {
        if let Some(known) = self.arithmetic.get() {
            return Ok(known);
        }
        let careful = match self.setting.wanted {
            Wanted::Native => Vec::new(),
            Wanted::Careful => Part::ALL.to_vec(),
            Wanted::Auto => Probe::of_native(self)?.inexact_parts(),
        };
        Ok(self.arithmetic.get_or_init(|| self.arithmetic_of(careful)))
    }
}

/// Distance in units in the last place; zeros of both signs are one number.
fn ulps(a: f32, b: f32) -> u32 {
    let order = |x: f32| {
        let size = i64::from(x.to_bits() & 0x7fff_ffff);
        if x.is_sign_negative() { -size } else { size }
    };
    let distance = order(a).abs_diff(order(b));
    if a.is_nan() || b.is_nan() { u32::MAX } else { u32::try_from(distance).unwrap_or(u32::MAX) }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;

    fn results() -> (Vec<Case>, Vec<[f32; 4]>) {
        let cases = probe::cases(512);
        let results = cases.iter().flat_map(|(case, _)| probe::expected(*case)).collect();
        (cases, results)
    }

    #[test]
    fn one_bit_of_any_primitive_makes_a_device_inexact_but_among_subnormal_numbers() {
        let (cases, right) = results();
        assert_eq!(Probe::judged(&cases, &right).to_string(), "exact");
        for (lane, primitive) in Primitive::ALL.into_iter().enumerate() {
            let mut got = right.clone();
            for case in [80, 500] {
                let value = &mut got[3 * case + lane / 4][lane % 4];
                *value = f32::from_bits(value.to_bits() ^ 1);
                let found = Probe::judged(&cases[case..=case], &got[3 * case..3 * case + 3]);
                assert_eq!(found.inexact.contains_key(&primitive), case == 80, "{found}");
            }
        }
    }

    #[test]
    fn a_zero_in_the_place_of_a_subnormal_number_is_flushed() {
        let (cases, mut got) = results();
        for value in got.iter_mut().flatten().filter(|value| value.is_subnormal()) {
            *value = 0.0;
        }
        let found = Probe::judged(&cases, &got);
        assert!(found.is_exact() && found.flushes_subnormals, "{found}");
        assert_eq!(found.to_string(), "exact; subnormal numbers are flushed");
    }

    #[test]
    fn the_cases_tell_the_zeros_apart_and_the_words_say_what_is_wrong() {
        let (cases, mut got) = results();
        for ((case, _), got) in cases.iter().zip(got.chunks_exact_mut(3)) {
            got[0][0] = f32::from_bits(got[0][0].to_bits() + u32::from(case[0] > 1.0));
            if case[0] == 0.0 && case[1] == 0.0 {
                got[1][0] = case[0]; // the other zero
            }
        }
        let found = Probe::judged(&cases, &got);
        assert!(
            found.to_string().starts_with("not exact: division by 1 ULP, minimum (sign of zero)"),
            "{found}"
        );
        assert_eq!(found.inexact_parts(), [Part::Division, Part::Order]);
    }
}
