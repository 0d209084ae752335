//! Whether this computer's own arithmetic is that of IEEE 754: without it there is nothing to compare a device with.

use crate::hash::Hash;
use crate::kernels::probe;

/// Cases that it is tried with.
const CASES: usize = 65_536;

/// Hash of what the operations must give, on any machine.
const CORRECTLY_ROUNDED: u64 = 0xc5c5_16a5_f15f_8253;

/// Whether the operations give what IEEE 754 demands on the computer that runs the twins.
pub(super) fn is_host_exact() -> bool {
    let results = probe::cases(CASES).into_iter().flat_map(|(case, _)| probe::expected(case));
    hash(results.flatten()) == CORRECTLY_ROUNDED
}

fn hash(results: impl Iterator<Item = f32>) -> u64 {
    let mut hash = Hash::default();
    results.for_each(|result| hash.add(&result.to_le_bytes()));
    hash.value()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_computer_whose_own_arithmetic_is_wrong_is_found_out() {
        let right = || probe::cases(CASES).into_iter().flat_map(|(case, _)| probe::expected(case)).flatten();
        assert!(is_host_exact(), "{:#018x}", hash(right()));
        let wrong = right().enumerate();
        let wrong = wrong.map(|(i, x)| if i == 400_000 { f32::from_bits(x.to_bits() + 1) } else { x });
        assert_ne!(hash(wrong), CORRECTLY_ROUNDED);
    }
}
