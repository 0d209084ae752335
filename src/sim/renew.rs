//! A crowd whose device is lost goes on, bit for bit, on a device that is opened again.

use super::{Simulation, order};
use crate::kernels::{Access, BufferId, Phase};
use std::collections::BTreeSet;

impl Simulation {
    /// Has the host keep all that a new device would need ([`Self::renew`]), from now on: beside the state of the last
    /// [`Self::state`] the flow fields, which are read back whenever they were solved.
    ///
    /// # Errors
    /// When the device fails.
    #[doc(hidden)]
    pub fn make_renewable(&mut self) -> Result<(), crate::Error> {
        self.is_renewable = true;
        self.state()?;
        self.keep_ways()
    }

    /// Opens the device again after it was lost. The crowd is then as it was at the last [`Self::state`], and takes the same
    /// steps as if nothing had happened. [`Self::make_renewable`] was called before.
    ///
    /// # Errors
    /// When the device cannot be opened again. The simulation cannot be used then.
    #[doc(hidden)]
    pub fn renew(&mut self) -> Result<(), crate::Error> {
        self.store.step.step_index = self.stored_step;
        self.is_current = true;
        self.given = None;
        self.machine.renew(&self.store)
    }

    /// Reads back what steps read of the flow fields.
    pub(super) fn keep_ways(&mut self) -> Result<(), crate::Error> {
        if !self.is_renewable || self.store.flow_grid.field_count == 0 {
            return Ok(());
        }
        let bindings = |phase: Phase| phase.entry().bindings.iter();
        let flow = Phase::ALL.into_iter().filter(|phase| phase.entry().name.starts_with("flow_"));
        let written = flow.flat_map(bindings).filter(|binding| binding.access == Access::Write);
        let solved: BTreeSet<BufferId> = written.map(|binding| binding.buffer).collect();
        let steps = order::step_dispatches(&self.store.step);
        let read = steps.iter().flat_map(|dispatch| bindings(dispatch.phase)).map(|binding| binding.buffer);
        let kept: BTreeSet<BufferId> = read.filter(|buffer| solved.contains(buffer)).collect();
        self.machine.fetch(&mut self.store, &kept.into_iter().collect::<Vec<_>>())
    }
}
