//! What the kernel `measure` finds while a crowd walks, so that the host need not read every step.

use super::{Simulation, setup};
use crate::kernels::BufferId;
use crate::kernels::layout::Seen;
use crate::kernels::measure::index::MEASURED_STEPS;
use crate::reference::measure::from_order;

/// Steps after which [`Simulation::extremes`] must have been asked.
pub(crate) const MEASURED: u32 = crate::kernels::measure::MEASURED_STEPS;

/// The worst of the measured steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Extremes {
    /// Smallest gap between two discs, m (negative when they overlap); infinite when no two came nearer than half a metre.
    pub(crate) min_clearance: f32,
    /// Most pairs that overlapped by more than a tenth in one step.
    pub(crate) overlapping_pairs: u32,
    /// Most agents outside the walkable area after one step.
    pub(crate) outside: u32,
}

impl Extremes {
    /// Before any step.
    pub(crate) const NONE: Self = Self { min_clearance: f32::INFINITY, overlapping_pairs: 0, outside: 0 };

    /// The worse of both.
    pub(crate) fn or(self, other: Self) -> Self {
        Self {
            min_clearance: self.min_clearance.min(other.min_clearance),
            overlapping_pairs: self.overlapping_pairs.max(other.overlapping_pairs),
            outside: self.outside.max(other.outside),
        }
    }
}

impl Simulation {
    /// Has every step measured from now on.
    ///
    /// # Errors
    /// When the device fails.
    pub(crate) fn measure_steps(&mut self) -> Result<(), crate::Error> {
        self.state()?;
        setup::nothing_measured(&mut self.store);
        self.store.step.measured = 1;
        self.machine.take(&self.store, &[BufferId::Seen, BufferId::Measured])
    }

    /// The worst of the steps since the last call, or since they are measured: at most [`MEASURED`].
    ///
    /// # Errors
    /// When the device fails.
    pub(crate) fn extremes(&mut self) -> Result<Extremes, crate::Error> {
        self.machine.fetch(&mut self.store, &[BufferId::Measured])?;
        let most = |counts: &[u32]| counts.iter().copied().max().unwrap_or(0);
        let found = match self.store.measured.split_first_mut() {
            None => Extremes::NONE,
            Some((least, counts)) => {
                let (pairs, outside) = counts.split_at(MEASURED_STEPS);
                let min_clearance = if *least == u32::MAX { f32::INFINITY } else { from_order(*least) };
                let found =
                    Extremes { min_clearance, overlapping_pairs: most(pairs), outside: most(outside) };
                *least = u32::MAX;
                counts.fill(0);
                found
            }
        };
        self.machine.take(&self.store, &[BufferId::Measured])?;
        Ok(found)
    }

    /// What was seen of each agent in the measured steps.
    ///
    /// # Errors
    /// When the device fails.
    pub(crate) fn seen(&mut self) -> Result<&[Seen], crate::Error> {
        self.machine.fetch(&mut self.store, &[BufferId::Seen])?;
        Ok(&self.store.seen[..self.store.step.agent_count as usize])
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;
    use crate::reference::measure::in_order;

    #[test]
    fn bits_stand_in_the_order_of_their_numbers() {
        let numbers = [-2.5, -0.1, -0.0, 0.0, 1e-30, 0.1, 7.0];
        assert!(numbers.map(in_order).is_sorted());
        let back = numbers.map(|number| from_order(in_order(number)).to_bits());
        assert_eq!(back, numbers.map(f32::to_bits));
    }
}
