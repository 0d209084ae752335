//! Other libraries on the same workload, in the same run: gaitway and each of them take turns over the same steps of the crossing.
//!
//! A peer is a program of its own. It reads the crowd as one line of JSON ([`Crowd`]) and prints its name. To `step N` it answers
//! with the milliseconds that N steps took, to `state` with a line of JSON ([`State`]). It ends with its input.

use super::crowds::{SPACING, bare};
use super::runs::Row;
use crate::kernels::Store;
use crate::sim::{Backend, Simulation};
use crate::verify::cases::crossing::{CrossingQuality, bare_crossing, crossing_quality};
use serde::{Deserialize, Serialize};
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::Instant;

/// The peer that is known: RVO2 as a package of Python.
pub(crate) const PYRVO: &str = include_str!("../../assets/peers/pyrvo.py");

/// Steps before the first that count, so that the streams have met.
const WARM_UP: u32 = 30;
/// Turns of each.
const ROUNDS: usize = 7;
/// Agent steps of a turn, about: a turn of either takes a fraction of a second.
const TURN: usize = 200_000;
/// A turn begins with so many of its steps that do not count. After the other's turn the system has yet to spread the threads over
/// the cores, and the caches hold the other's crowd.
fn uncounted(steps: u32) -> u32 {
    (steps / 2).max(1)
}

/// What a peer is given. Agents stand in the order of their places, row by row, which is the best order for a tree.
#[derive(Debug, Serialize)]
struct Crowd {
    time_step: f32,
    side: f32,
    radius: f32,
    max_speed: f32,
    neighbour_distance: f32,
    neighbours: f32,
    horizon: f32,
    position: Vec<[f32; 2]>,
    velocity: Vec<[f32; 2]>,
}

/// What a peer says of its agents, in the order in which it was given them.
#[derive(Debug, Deserialize)]
struct State {
    position: Vec<[f32; 2]>,
    velocity: Vec<[f32; 2]>,
}

/// One crowd that was timed.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Peer {
    /// Who stepped it.
    pub(crate) name: String,
    /// Agents.
    pub(crate) agents: usize,
    /// A step, ms.
    pub(crate) ms_median: f64,
    /// The fastest turn, ms a step.
    pub(crate) ms_min: f64,
    /// Its median over that of gaitway.
    pub(crate) times_median: f64,
    /// Its minimum over that of gaitway.
    pub(crate) times_min: f64,
    /// Pairs closer than 0.99 of the summed radii, per agent, at the end.
    pub(crate) overlapping: f64,
    /// Smallest distance between two agents, m, at the end.
    pub(crate) min_distance: f64,
    /// Mean velocity along the wanted direction, m/s, at the end.
    pub(crate) progress: f64,
}

/// The outcome.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Peers {
    /// This computer.
    pub(crate) machine: String,
    /// Threads of each.
    pub(crate) threads: usize,
    /// Whether gaitway was compiled with optimisation.
    pub(crate) optimised: bool,
    /// Of each size gaitway, then its peers.
    pub(crate) rows: Vec<Peer>,
}

/// A peer that runs.
struct Running {
    command: String,
    name: String,
    child: Child,
    answers: BufReader<ChildStdout>,
}

/// Times gaitway beside the peers that some commands start. Calls `progress` with what runs and the fraction done.
///
/// # Errors
/// A peer that does not start, or ends, or answers with something else; or the backend fails.
pub(crate) fn peers(
    sizes: &[usize],
    commands: &[Vec<String>],
    backend: Backend,
    device: Option<&str>,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<Peers, crate::Error> {
    let mut rows = Vec::new();
    for (number, &agents) in sizes.iter().enumerate() {
        #[allow(clippy::cast_precision_loss, reason = "a handful of sizes")]
        let done = number as f64 / sizes.len() as f64;
        progress(&format!("peers, {agents} agents"), done);
        rows.extend(one_size(agents, commands, backend, device)?);
    }
    let threads = rayon::current_num_threads();
    Ok(Peers { machine: machine(), threads, optimised: !cfg!(debug_assertions), rows })
}

fn one_size(
    agents: usize,
    commands: &[Vec<String>],
    backend: Backend,
    device: Option<&str>,
) -> Result<Vec<Peer>, crate::Error> {
    let mut store = bare(bare_crossing(agents, SPACING));
    let order = by_place(&store);
    let crowd = Crowd::of(&store, &order);
    let mut running = Vec::new();
    for command in commands {
        running.push(Running::start(command, &crowd)?);
    }
    let mut gaitway = Simulation::from_store(store.clone(), backend, device)?;
    let steps = u32::try_from(TURN / agents.max(1)).unwrap_or(u32::MAX).clamp(3, 200);
    let mut times = vec![Vec::new(); running.len() + 1];
    let mut own_turn = |steps: u32| -> Result<f64, crate::Error> {
        let begin = Instant::now();
        gaitway.step(steps)?;
        gaitway.finish()?;
        Ok(begin.elapsed().as_secs_f64() * 1e3)
    };
    own_turn(WARM_UP)?;
    for peer in &mut running {
        peer.step(WARM_UP)?;
    }
    for _ in 0..ROUNDS {
        own_turn(uncounted(steps))?;
        times[0].push(own_turn(steps)? / f64::from(steps));
        for (peer, times) in running.iter_mut().zip(&mut times[1..]) {
            peer.step(uncounted(steps))?;
            times.push(peer.step(steps)? / f64::from(steps));
        }
    }
    let name = format!("gaitway, {}", gaitway.device());
    let mut crowds = vec![(name, crossing_quality(gaitway.state()?))];
    for peer in &mut running {
        let State { position, velocity } = peer.state(agents)?;
        for (place, agent) in order.iter().enumerate() {
            (store.position[*agent], store.velocity[*agent]) = (position[place], velocity[place]);
        }
        crowds.push((peer.name.clone(), crossing_quality(&store)));
    }
    let rows: Vec<Row> = times.into_iter().map(|times| Row::new("step", agents, times)).collect();
    let own = rows[0].clone();
    let beside = |(row, (name, quality)): (Row, (String, CrossingQuality))| Peer {
        name,
        agents,
        ms_median: row.ms_median,
        ms_min: row.ms_min,
        times_median: row.ms_median / own.ms_median,
        times_min: row.ms_min / own.ms_min,
        overlapping: quality.overlapping,
        min_distance: quality.min_distance,
        progress: quality.progress,
    };
    Ok(rows.into_iter().zip(crowds).map(beside).collect())
}

/// Agents row by row, each row along x.
fn by_place(store: &Store) -> Vec<usize> {
    let mut order: Vec<usize> = (0..store.position.len()).collect();
    let key = |agent: &usize| {
        let [x, z] = store.position[*agent];
        (z.floor().to_bits(), x.to_bits()) // places are positive, whose bits are ordered as they are
    };
    order.sort_by_key(key);
    order
}

impl Crowd {
    fn of(store: &Store, order: &[usize]) -> Self {
        let (body, avoidance) = (store.body.first(), store.avoidance.first());
        Self {
            time_step: store.step.time_step,
            side: store.step.wrap,
            radius: body.map_or(0.0, |body| body.radius),
            max_speed: body.map_or(0.0, |body| body.max_speed),
            neighbour_distance: avoidance.map_or(0.0, |own| own.neighbour_distance),
            neighbours: avoidance.map_or(0.0, |own| own.neighbour_cap),
            horizon: avoidance.map_or(0.0, |own| 1.0 / own.inverse_time_horizon),
            position: order.iter().map(|agent| store.position[*agent]).collect(),
            velocity: order.iter().map(|agent| store.velocity[*agent]).collect(),
        }
    }
}

impl Running {
    fn start(command: &[String], crowd: &Crowd) -> Result<Self, crate::Error> {
        let shown = command.first().cloned().unwrap_or_default();
        let broken = |what: String| crate::Error::Usage {
            message: format!("the peer `{shown}` does not run: {what}"),
            hint: "pip install pyrvo, and name its Python with --python; or name a program with --peer"
                .to_owned(),
        };
        let mut child = Command::new(&shown)
            .args(&command[1..])
            .env("OMP_NUM_THREADS", rayon::current_num_threads().to_string())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|error| broken(error.to_string()))?;
        let answers = child.stdout.take().ok_or_else(|| broken("it has no output".to_owned()))?;
        let answers = BufReader::new(answers);
        let mut peer = Self { command: shown.clone(), name: String::new(), child, answers };
        let text = serde_json::to_string(crowd).map_err(|error| broken(error.to_string()))?;
        let Ok(name) = peer.ask(&text) else {
            return Err(broken("it ended before it gave its name".to_owned()));
        };
        peer.name = name;
        Ok(peer)
    }

    /// Sends a line and waits for one.
    fn ask(&mut self, line: &str) -> Result<String, crate::Error> {
        let mut answer = String::new();
        let sent = match &mut self.child.stdin {
            Some(input) => writeln!(input, "{line}").and_then(|()| input.flush()),
            None => Ok(()),
        };
        let read = sent.and_then(|()| self.answers.read_line(&mut answer));
        match read {
            Ok(1..) => Ok(answer.trim().to_owned()),
            Ok(0) => Err(self.fault("it has ended")),
            Err(error) => Err(self.fault(&error.to_string())),
        }
    }

    /// Makes steps; how long they took, ms.
    fn step(&mut self, count: u32) -> Result<f64, crate::Error> {
        let answer = self.ask(&format!("step {count}"))?;
        let time = answer.parse().ok().filter(|time: &f64| time.is_finite() && *time > 0.0);
        time.ok_or_else(|| self.fault(&format!("a time in ms is wanted, not `{answer}`")))
    }

    fn state(&mut self, agents: usize) -> Result<State, crate::Error> {
        let answer = self.ask("state")?;
        let state: State = serde_json::from_str(&answer).map_err(|error| self.fault(&error.to_string()))?;
        if state.position.len() != agents || state.velocity.len() != agents {
            return Err(self.fault(&format!("{} places for {agents} agents", state.position.len())));
        }
        Ok(state)
    }

    fn fault(&self, what: &str) -> crate::Error {
        crate::Error::Usage {
            message: format!("the peer `{}`: {what}", self.command),
            hint: "docs/speed.md says what a peer is asked".to_owned(),
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        drop(self.child.stdin.take()); // which ends it
        let _ = self.child.wait();
    }
}

/// This computer, in words.
fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    let model = model.map_or(std::env::consts::ARCH, |(_, name)| name.trim());
    format!("{cores} cores of {model}")
}
