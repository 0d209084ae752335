//! The crowd of `gaitway verify`: the same one on all sides, for many steps, and where they first differ.

use super::cases;
use super::equivalence::first_difference;
use super::report::{Device, Options};
use super::sides::{Side, wrong};
use crate::kernels::Store;
use crate::lanes;
use crate::sim::{Backend, FELT, STATE, Simulation, measure::state_hash, order};
use serde::Serialize;

/// Steps between two comparisons of the crowd.
const STRIDE: u32 = 20;

/// A crowd on all sides.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CrowdRow {
    /// Agents.
    pub agents: usize,
    /// Steps.
    pub steps: u32,
    /// The first step after which some differ.
    pub differs_by_step: Option<u32>,
    /// Who is wrong then, as of a kernel.
    pub differs: Vec<&'static str>,
    /// The first difference of each side then: side, buffer, element, word, the twin's value and its own.
    pub first: Vec<String>,
    /// Hash of the twins' state at the end.
    pub state_hash: String,
    /// Whether the whole state is equal bit for bit after all of them.
    pub pass: bool,
}

/// A side and its crowd.
type Beside = (Side, Simulation);

/// Steps the same crowd on all sides and compares whole states: with every model of avoidance for its share of the steps. Where
/// they differ, the last steps are walked again one by one.
///
/// # Errors
/// When the device fails.
pub(super) fn trajectory(
    device: Option<&Device>,
    options: &Options,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<CrowdRow, crate::Error> {
    let mut walk = Walk::new(options);
    let mut found = None;
    for model in order::MODELS {
        let mut equal = walk.start(model);
        let mut sides = beside(device, &equal)?;
        let mut twin = Simulation::from_store(equal.clone(), Backend::Reference, None)?;
        while let Some(count) = walk.stride(found.is_some(), progress) {
            let steps = walk.done;
            walk.done += count;
            if let Some(differs) = advance(&mut twin, &mut sides, count)? {
                // without a second time the report has what was found the first time
                let again = one_by_one(device, &equal, steps, count)?;
                found = Some(again.unwrap_or_else(|| differs.at(walk.done)));
            } else {
                equal = twin.state()?.clone();
            }
        }
        walk.store = twin.state()?.clone();
    }
    let found = found.unwrap_or_default();
    Ok(CrowdRow {
        agents: options.crowd_agents,
        steps: walk.done,
        differs_by_step: found.step,
        pass: found.step.is_none(),
        differs: found.differs,
        first: found.first,
        state_hash: format!("{:016x}", state_hash(&walk.store)),
    })
}

/// Where sides differ.
#[derive(Debug, Default)]
struct Found {
    step: Option<u32>,
    differs: Vec<&'static str>,
    first: Vec<String>,
}

impl Found {
    fn at(self, step: u32) -> Self {
        Self { step: Some(step), ..self }
    }
}

/// Walks all sides so many steps on, and compares them with the twin.
fn advance(twin: &mut Simulation, sides: &mut [Beside], count: u32) -> Result<Option<Found>, crate::Error> {
    twin.step(count)?;
    let twin = twin.state()?;
    let (mut votes, mut first) = (Vec::new(), Vec::new());
    for (side, simulation) in sides {
        simulation.step(count)?;
        let state = simulation.state()?;
        let compared = STATE.into_iter().chain(FELT);
        let difference = compared
            .into_iter()
            .find_map(|buffer| first_difference(buffer, twin.bytes(buffer), state.bytes(buffer)));
        votes.push((*side, difference.is_none(), state_hash(state)));
        first.extend(difference.map(|text| format!("{}: {text}", side.name())));
    }
    let differs = wrong(&votes);
    Ok((!differs.is_empty()).then_some(Found { step: None, differs, first }))
}

/// Walks from an equal state, which so many steps led to, up to the first difference.
fn one_by_one(
    device: Option<&Device>,
    equal: &Store,
    steps: u32,
    count: u32,
) -> Result<Option<Found>, crate::Error> {
    let mut sides = beside(device, equal)?;
    let mut twin = Simulation::from_store(equal.clone(), Backend::Reference, None)?;
    for step in 1..=count {
        if let Some(found) = advance(&mut twin, &mut sides, 1)? {
            return Ok(Some(found.at(steps + step)));
        }
    }
    Ok(None)
}

/// The crowd on all sides but that of the twins.
#[cfg_attr(not(feature = "vulkan"), allow(unused_variables, reason = "there is no device"))]
fn beside(device: Option<&Device>, start: &Store) -> Result<Vec<Beside>, crate::Error> {
    let lanes = Simulation::from_store(start.clone(), Backend::Cpu, None)?;
    #[allow(unused_mut, reason = "a device joins them")]
    let mut sides = vec![(Side::Lanes(lanes::best()), lanes)];
    #[cfg(feature = "vulkan")]
    if let Some(device) = device {
        sides.push((Side::Device, Simulation::on_device(start.clone(), device)?));
    }
    Ok(sides)
}

/// How far the crowd of a verification has come.
struct Walk<'a> {
    options: &'a Options,
    store: Store,
    /// Steps done, and of those to be done with the present model.
    done: u32,
    until: u32,
}

impl<'a> Walk<'a> {
    fn new(options: &'a Options) -> Self {
        Self { options, store: cases::everything(options.crowd_agents, options.seed), done: 0, until: 0 }
    }

    /// Goes on with a model of avoidance, and says from where.
    fn start(&mut self, model: u32) -> Store {
        self.store.step.model = model;
        self.until = self.options.crowd_steps * (model + 1) / order::MODELS.end;
        self.store.clone()
    }

    /// Steps to the next comparison, if there is one with this model and nothing has differed yet.
    fn stride(&self, differs: bool, progress: &mut dyn FnMut(&str, f64)) -> Option<u32> {
        let Options { crowd_agents, crowd_steps, .. } = self.options;
        let share = f64::from(self.done) / f64::from((*crowd_steps).max(1));
        progress(&format!("crowd of {crowd_agents} agents, step {}", self.done), 0.5 + 0.5 * share);
        let count = STRIDE.min(self.until.saturating_sub(self.done));
        (count > 0 && !differs).then_some(count)
    }
}
