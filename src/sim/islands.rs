//! Many small crowds that step together. They do not see one another: each is, bit for bit, what it would be alone.
//!
//! On a Vulkan device the steps of all crowds are one submission, in which a barrier serves all of them: a crowd of some hundred
//! people leaves most of a GPU idle, and 64 of them do not. On the CPU each crowd is a task of its own.

use super::{Error, Simulation};
use rayon::prelude::*;

#[cfg(feature = "vulkan")]
use super::BATCH;
#[cfg(feature = "vulkan")]
use super::backend::{Machine, news};
#[cfg(feature = "vulkan")]
use crate::gpu::{Part, Together};
#[cfg(feature = "vulkan")]
use crate::kernels::{Op, Phase};

/// Crowds that step together, such as replicates of a run with different seeds.
///
/// ```
/// use gaitway::sim::{Backend, Islands};
/// use gaitway::Scene;
///
/// # fn main() -> gaitway::Result<()> {
/// let scene = |seed| Scene::load("garden")?.agents(40).seed(seed).backend(Backend::Cpu).build();
/// let scenes: Vec<Scene> = (1..=4).map(scene).collect::<gaitway::Result<_>>()?;
/// let mut islands = Islands::default();
/// for scene in &scenes {
///     scene.start_in(&mut islands)?;
/// }
/// islands.step(60)?;
/// let mut alone = scenes[2].start()?;
/// alone.step(60)?;
/// assert!(islands.crowds_mut()[2].people()?.eq(alone.people()?));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Default)]
pub struct Islands {
    /// Submissions of crowds whose steps are of the same phases. Before the crowds, so that they are dropped first.
    #[cfg(feature = "vulkan")]
    together: Vec<Together>,
    crowds: Vec<Simulation>,
}

impl Islands {
    /// The crowds, in the order in which they were added.
    pub fn crowds(&self) -> &[Simulation] {
        &self.crowds
    }

    /// The same, to be read, led or stepped one by one.
    pub fn crowds_mut(&mut self) -> &mut [Simulation] {
        &mut self.crowds
    }

    /// Adds a crowd. On another device than the first one it makes all crowds step one by one; see
    /// [`Scene::start_in`](crate::Scene::start_in).
    pub fn add(&mut self, crowd: Simulation) -> &mut Simulation {
        self.crowds.push_mut(crowd)
    }

    /// Takes a crowd out; the last one takes its place.
    ///
    /// # Panics
    /// If there is none of that number.
    pub fn remove(&mut self, number: usize) -> Simulation {
        self.crowds.swap_remove(number)
    }

    /// Does `count` steps of every crowd, and waits for them. A kernel that met values that are not finite is no error here:
    /// [`Simulation::finish`] of its crowd tells of it.
    ///
    /// # Errors
    /// When the device fails.
    pub fn step(&mut self, count: u32) -> Result<(), crate::Error> {
        if !self.are_on_one_device() {
            return self.crowds.par_iter_mut().try_for_each(|crowd| match crowd.step(count) {
                Err(crate::Error::Sim(Error::Failure { .. })) => Ok(()),
                other => other,
            });
        }
        let mut left = count;
        while left > 0 {
            let mut some = left;
            for crowd in &mut self.crowds {
                let every = crowd.store.flow_grid.every;
                if every > 0 {
                    let since = crowd.steps_done() % every;
                    if since == 0 {
                        crowd.solve_ways()?;
                    }
                    some = some.min(every - since);
                }
            }
            self.walk(some)?;
            left -= some;
        }
        Ok(())
    }
}

#[cfg(not(feature = "vulkan"))]
impl Islands {
    #[allow(clippy::unused_self, reason = "as with Vulkan")]
    const fn are_on_one_device(&self) -> bool {
        false
    }

    #[allow(
        clippy::unused_self,
        clippy::needless_pass_by_ref_mut,
        reason = "never called: there is no device"
    )]
    const fn walk(&mut self, _: u32) -> Result<(), crate::Error> {
        Ok(())
    }
}

#[cfg(feature = "vulkan")]
impl Islands {
    /// Whether all crowds have an engine on the same device, and none has its phases timed.
    fn are_on_one_device(&self) -> bool {
        let first = self.crowds.first().and_then(Simulation::engine);
        first.is_some_and(|first| {
            self.crowds.iter().all(|crowd| {
                let is_there =
                    |engine: &crate::gpu::Engine| std::sync::Arc::ptr_eq(engine.device(), first.device());
                crowd.times.is_none() && crowd.engine().is_some_and(is_there)
            })
        })
    }

    /// Does `count` steps with the present flow fields.
    fn walk(&mut self, count: u32) -> Result<(), crate::Error> {
        let mut groups: Vec<(Vec<Phase>, Members)> = Vec::new();
        for (index, crowd) in self.crowds.iter_mut().enumerate() {
            if crowd.store.step.agent_count == 0 {
                crowd.store.step.step_index += count;
                continue;
            }
            let ops = crowd.begin_walk()?;
            let phases = phases(&ops);
            match groups.iter_mut().find(|(known, _)| *known == phases) {
                Some((_, members)) => members.push((index, ops)),
                None => groups.push((phases, vec![(index, ops)])),
            }
        }
        for (number, (_, members)) in groups.iter().enumerate() {
            let Some(engine) = self.crowds[members[0].0].engine() else { continue };
            // crowds on another device may have been there before
            self.together.truncate(self.together.iter().take_while(|one| one.is_on(engine.device())).count());
            if self.together.len() <= number {
                self.together.push(Together::new(engine.device())?);
            }
            let mut left = count;
            while left > 0 {
                let batch = left.min(BATCH);
                self.walk_batch(number, members, batch)?;
                left -= batch;
            }
        }
        self.together.iter_mut().try_for_each(Together::finish)?;
        Ok(())
    }

    /// Submits so many steps of the crowds of a group.
    fn walk_batch(&mut self, number: usize, members: &Members, batch: u32) -> Result<(), crate::Error> {
        let news: Vec<_> = members
            .iter()
            .map(|(index, _)| {
                let crowd = &mut self.crowds[*index];
                if crowd.begin_batch() { news(&crowd.store) } else { Vec::new() }
            })
            .collect();
        let mut parts = Vec::with_capacity(members.len());
        for ((index, ops), sets) in members.iter().zip(news) {
            if let Machine::Vulkan(engine) = &self.crowds[*index].machine {
                parts.push(Part { engine, sets, ops: ops.clone() });
            }
        }
        self.together[number].repeat(&parts, batch)?;
        drop(parts);
        for (index, _) in members {
            self.crowds[*index].end_batch(batch);
            self.crowds[*index].is_current = false;
        }
        Ok(())
    }
}

/// Numbers of crowds whose steps are of the same phases, and the operations of a step of each.
#[cfg(feature = "vulkan")]
type Members = Vec<(usize, Vec<Op>)>;

/// What the operations of a step run.
#[cfg(feature = "vulkan")]
fn phases(ops: &[Op]) -> Vec<Phase> {
    let phase = |op: &Op| match op {
        Op::Dispatch(dispatch) => Some(dispatch.phase),
        Op::Set(_) | Op::CountStep => None,
    };
    ops.iter().filter_map(phase).collect()
}
