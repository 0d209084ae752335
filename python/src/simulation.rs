//! The class `Simulation`: a crowd behind a lock.
//!
//! Work happens detached from the interpreter, so that other Python threads run meanwhile. Two threads that step one simulation take turns.

use crate::choices::{Choices, camera_of};
use crate::crowd::{Crowd, video};
use crate::error::{Fault, Result};
use crate::fork::on_threads;
use crate::gaits::Gaits;
use crate::recorder::{self, Recorder};
use crate::table::Table;
use crate::views::Numbers;
use gaitway::export::Walkable;
use gaitway::low_level::ground::is_absent;
use gaitway::sim::measure;
use glam::Vec2;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// How long work may go on before Ctrl-C is looked at.
const PATIENCE: Duration = Duration::from_millis(100);

/// A crowd in motion; `gaitway.Simulation` stands on it.
#[pyclass(frozen, subclass, module = "gaitway._gaitway")]
#[derive(Debug)]
pub(crate) struct Simulation {
    crowd: Mutex<Crowd>,
}

impl Simulation {
    /// The crowd; waits, detached from the interpreter, while another thread has it.
    fn lock(&self, py: Python<'_>) -> MutexGuard<'_, Crowd> {
        self.crowd.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner)
    }

    /// Does work with the crowd, detached and on all threads.
    fn work<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut Crowd) -> Result<T> + Send,
    ) -> PyResult<T> {
        let done = py.detach(|| {
            let mut guard = self.crowd.lock().unwrap_or_else(PoisonError::into_inner);
            let crowd: &mut Crowd = &mut guard;
            on_threads(move || work(crowd))
        });
        Ok(done?)
    }

    /// A part of the state, which is read first where a device is ahead of it.
    fn numbers(&self, py: Python<'_>, part: fn(&mut Crowd) -> Result<Numbers>) -> PyResult<Numbers> {
        {
            let mut crowd = self.lock(py);
            if crowd.is_read() {
                return Ok(part(&mut crowd)?);
            }
        }
        self.work(py, |crowd| crowd.read().map(|_| ()))?;
        Ok(part(&mut self.lock(py))?)
    }
}

#[pymethods]
impl Simulation {
    /// See `gaitway.Simulation`, which checks and names the arguments.
    #[new]
    #[pyo3(signature = (scene, is_text, settings, agents, seed, condition, library, backend, device, record))]
    #[allow(clippy::too_many_arguments, reason = "one for each of Python's keywords")]
    fn new(
        py: Python<'_>,
        scene: &str,
        is_text: bool,
        settings: Vec<String>,
        agents: Option<u32>,
        seed: Option<u64>,
        condition: Option<&str>,
        library: Option<PyRef<'_, Gaits>>,
        backend: &str,
        device: Option<&str>,
        record: Option<f64>,
    ) -> PyResult<Self> {
        let library = library.map(|gaits| gaits.library.clone());
        let choices =
            Choices { scene, is_text, settings, agents, seed, condition, library, backend, device, record };
        Ok(Self { crowd: Mutex::new(py.detach(|| on_threads(|| choices.crowd()))?) })
    }

    /// Does `steps` steps.
    fn step(&self, py: Python<'_>, steps: u32) -> PyResult<()> {
        let mut left = steps;
        while left > 0 {
            left -= self.work(py, |crowd| crowd.advance(left, PATIENCE))?;
            py.check_signals()?;
        }
        Ok(())
    }

    /// Walks for `seconds` with a frame every `every` seconds; stops earlier once no people are present, if asked to.
    #[pyo3(name = "_walk")]
    fn walk(&self, py: Python<'_>, seconds: f64, every: f64, until_empty: bool) -> PyResult<Table> {
        let mut recorder = self.work(py, |crowd| {
            let mut recorder = Recorder::new(crowd.steps_of("every", every)?);
            crowd.record(&mut recorder)?;
            Ok(recorder)
        })?;
        let mut left = self.lock(py).steps_of("seconds", seconds)?;
        while left > 0 {
            let some = left.min(recorder.every);
            self.step(py, some)?;
            left -= some;
            let is_empty = self.work(py, |crowd| {
                if some == recorder.every {
                    crowd.record(&mut recorder)?;
                }
                let (store, agents) = crowd.read()?;
                Ok(store.position[..agents].iter().all(|place| is_absent(*place)))
            })?;
            if until_empty && is_empty {
                break;
            }
        }
        Ok(recorder.table()?)
    }

    /// What `record=` has recorded so far; `None` without it.
    #[pyo3(name = "_recorded")]
    fn recorded(&self, py: Python<'_>) -> PyResult<Option<Table>> {
        let table = self.work(py, |crowd| {
            crowd.simulation()?; // the first frame is recorded at the start
            crowd.recorder.as_ref().map(Recorder::table).transpose()
        })?;
        Ok(table)
    }

    /// Ground positions (x, z), m: a read-only float32 view `(agents, 2)`. Absent agents are at 1e9: see `present`.
    ///
    /// Valid until the next step: then ask for it again, or keep a copy of it.
    #[getter]
    fn positions<'py>(slf: Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let numbers = slf.get().numbers(slf.py(), Numbers::positions)?;
        Ok(numbers.rows(2, slf.into_any()))
    }

    /// Velocities (x, z), m/s: a read-only float32 view `(agents, 2)`, valid until the next step.
    #[getter]
    fn velocities<'py>(slf: Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let numbers = slf.get().numbers(slf.py(), Numbers::velocities)?;
        Ok(numbers.rows(2, slf.into_any()))
    }

    /// Headings about +y, radians, 0 facing +z: a read-only float32 view `(agents,)`, valid until the next step.
    #[getter]
    fn headings<'py>(slf: Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let numbers = slf.get().numbers(slf.py(), Numbers::headings)?;
        Ok(numbers.column(slf.into_any()))
    }

    /// Heights of the floors that agents stand on, m: a read-only float32 view `(agents,)`, valid until the next step.
    #[getter]
    fn elevations<'py>(slf: Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let numbers = slf.get().numbers(slf.py(), Numbers::elevations)?;
        Ok(numbers.column(slf.into_any()))
    }

    /// Weights of happy, angry, sad and neutral, sum 1: a read-only float32 view `(agents, 4)`, valid until the next step.
    #[getter]
    fn emotions<'py>(slf: Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let numbers = slf.get().numbers(slf.py(), Numbers::emotions)?;
        Ok(numbers.rows(4, slf.into_any()))
    }

    /// Who is there now: a new array `(agents,)` of bool.
    #[pyo3(name = "_mask")]
    fn mask<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        self.numbers(py, Numbers::positions)?;
        let mut crowd = self.lock(py);
        let (store, agents) = crowd.read()?;
        let present = store.position[..agents].iter().map(|place| !is_absent(*place)).collect();
        Ok(PyArray1::from_vec(py, present))
    }

    /// The plane of PedPy: (x, y = -z), m, a new float32 array `(agents, 2)`.
    #[pyo3(name = "_plane")]
    fn plane<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.numbers(py, Numbers::positions)?;
        let mut crowd = self.lock(py);
        let (store, agents) = crowd.read()?;
        // `0 - z`, not `-z`: no negative zeros
        let flat: Vec<f32> = store.position[..agents].iter().flat_map(|[x, z]| [*x, 0.0 - z]).collect();
        Ok(PyArray1::from_vec(py, flat).reshape([agents, 2])?.into_any())
    }

    /// Number of agents, present or not.
    fn __len__(&self, py: Python<'_>) -> usize {
        self.lock(py).agents()
    }

    /// Seconds simulated.
    #[getter]
    fn time(&self, py: Python<'_>) -> f64 {
        self.lock(py).time().1
    }

    /// Steps done.
    #[getter]
    fn steps(&self, py: Python<'_>) -> u32 {
        self.lock(py).time().0
    }

    /// Seconds of a step.
    #[getter]
    fn time_step(&self, py: Python<'_>) -> f64 {
        measure::time_of(1, self.lock(py).time_step())
    }

    /// Name of the scene.
    #[getter]
    fn name(&self, py: Python<'_>) -> String {
        self.lock(py).scene.scenario.name.clone()
    }

    /// Seed of every random draw.
    #[getter]
    fn seed(&self, py: Python<'_>) -> u64 {
        self.lock(py).scene.scenario.seed
    }

    /// The scenario as TOML, with all that was set.
    #[getter]
    fn scenario(&self, py: Python<'_>) -> PyResult<String> {
        let toml = self.lock(py).scene.scenario.to_toml();
        Ok(toml.map_err(Fault::from)?)
    }

    /// What it runs on, in words. Opens the device.
    #[getter]
    fn device(&self, py: Python<'_>) -> PyResult<String> {
        self.work(py, |crowd| Ok(crowd.simulation()?.device()))
    }

    /// Why the CPU is used although a GPU was tried; `None`: it is not, or none was.
    #[getter]
    fn fallback(&self, py: Python<'_>) -> PyResult<Option<String>> {
        self.work(py, |crowd| Ok(crowd.simulation()?.fallback().map(str::to_owned)))
    }

    /// A hash of everything a step carries on, 16 hexadecimal digits: the one that `gaitway simulate` prints.
    #[getter]
    fn state_hash(&self, py: Python<'_>) -> PyResult<String> {
        self.work(py, |crowd| Ok(format!("{:016x}", measure::state_hash(crowd.read()?.0))))
    }

    /// The agents as a table: `id`, `kind`, `led`, `emotion` and its four weights, `gait`, `avatar`, `class`, `group`,
    /// `radius_m`, `preferred_speed_m_s`, `age_years`, `stature_m`, `weight_kg`.
    #[getter]
    fn agents(&self, py: Python<'_>) -> PyResult<Table> {
        Ok(recorder::agents(self.lock(py).info())?)
    }

    /// The numbers of the agents of a kind: `person`, `robot` or `vehicle`.
    #[pyo3(name = "_numbers_of")]
    fn numbers_of(&self, py: Python<'_>, kind: &str) -> Vec<u32> {
        let crowd = self.lock(py);
        let all = (0_u32..).zip(crowd.info());
        all.filter(|(_, agent)| agent.kind.name() == kind).map(|(id, _)| id).collect()
    }

    /// The state in numbers, as `gaitway simulate --json` has them.
    fn measures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let found = self.work(py, |crowd| Ok(measure::measures(crowd.read()?.0)))?;
        let numbers = PyDict::new(py);
        numbers.set_item("present", found.present)?;
        numbers.set_item("mean_speed_m_s", found.mean_speed)?;
        numbers.set_item("min_clearance_m", found.min_clearance)?;
        numbers.set_item("overlapping_pairs", found.overlapping_pairs)?;
        numbers.set_item("arrived", found.arrived)?;
        numbers.set_item("entered", found.entered)?;
        numbers.set_item("left", found.left)?;
        numbers.set_item("waiting_outside", found.waiting_outside)?;
        numbers.set_item("never", found.never)?;
        Ok(numbers)
    }

    /// The walkable area as WKT in PedPy's plane, one polygon: the parts that the places (x, z) of `table` are in.
    #[pyo3(name = "_walkable_wkt")]
    fn walkable_wkt(&self, py: Python<'_>, table: Option<PyRef<'_, Table>>) -> PyResult<String> {
        let area = Walkable::from(&self.lock(py).scene.geometry);
        let places = table.map(|table| table.places()).transpose()?.unwrap_or_default();
        Ok(py.detach(|| area.polygon(places)).0)
    }

    /// Says where the agent `id` that is led is after the next step: (x, z), m, and its velocity, m/s; `None`: absent.
    #[pyo3(name = "_lead_agent", signature = (id, target, velocity))]
    fn lead_agent(
        &self,
        py: Python<'_>,
        id: u32,
        target: Option<[f32; 2]>,
        velocity: [f32; 2],
    ) -> PyResult<()> {
        let target = target.map(|place| (Vec2::from_array(place), Vec2::from_array(velocity)));
        self.work(py, |crowd| crowd.lead(id, target))
    }

    /// A picture: rows from the top, `height * width * 4` bytes, red, green, blue, alpha.
    #[pyo3(name = "_pixels")]
    fn pixels<'py>(&self, py: Python<'py>, camera: &str, size: (u32, u32)) -> PyResult<Bound<'py, PyAny>> {
        let camera = camera_of(camera)?;
        let image = self.work(py, |crowd| crowd.picture(camera, size, 0.0))?;
        let shape = [image.height as usize, image.width as usize, 4];
        Ok(PyArray1::from_vec(py, image.pixels).reshape(shape)?.into_any())
    }

    /// Films `seconds` of the crowd, which walks on, into a file; returns the number of frames.
    #[pyo3(name = "_film")]
    fn film(
        &self,
        py: Python<'_>,
        path: PathBuf,
        seconds: f64,
        camera: &str,
        size: (u32, u32),
        fps: f64,
    ) -> PyResult<u64> {
        let camera = camera_of(camera)?;
        let (every, steps) = {
            let crowd = self.lock(py);
            (crowd.steps_of("1 / fps", 1.0 / fps)?, crowd.steps_of("seconds", seconds)?)
        };
        let mut video = video(&path, size, fps)?;
        for frame in 0..(steps / every).max(1) {
            if frame > 0 {
                self.step(py, every)?;
            }
            let since = f64::from(frame) / fps;
            self.work(py, |crowd| {
                let image = crowd.picture(camera, size, since)?;
                Ok(video.push(&image).map_err(gaitway::export::Error::from)?)
            })?;
            py.check_signals()?;
        }
        let frames = video.frames();
        video.finish().map_err(gaitway::export::Error::from).map_err(Fault::from)?;
        Ok(frames)
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let crowd = self.lock(py);
        let (scenario, (_, time)) = (&crowd.scene.scenario, crowd.time());
        format!(
            "<gaitway.Simulation {}: {} agents, seed {}, {time:.2} s>",
            scenario.name,
            crowd.agents(),
            scenario.seed
        )
    }
}
