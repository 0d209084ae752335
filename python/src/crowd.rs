//! A crowd in motion, from its scene on: started when it is first needed, put on stage when it is first drawn.

use crate::error::{Fault, Result};
use crate::fork;
use crate::recorder::Recorder;
use gaitway::export::AgentInfo;
use gaitway::export::video::Video;
use gaitway::low_level::kernels::Store;
use gaitway::picture::Image;
use gaitway::render::Settings;
use gaitway::scene::{CameraChoice, Scene, Stage, atmosphere};
use gaitway::sim::measure::time_of;
use gaitway::sim::{Backend, Simulation};
use glam::Vec2;
use std::path::Path;
use std::time::{Duration, Instant};

/// Steps that are waited for together.
const TOGETHER: u32 = 16;

/// Where a crowd stands.
#[derive(Debug)]
enum Motion {
    /// No device is open yet.
    Waits,
    Walks(Box<Simulation>),
    /// Can be drawn. The scene of this stage is a copy.
    OnStage(Box<Stage>),
}

/// A scene and its crowd.
#[derive(Debug)]
pub(crate) struct Crowd {
    pub(crate) scene: Scene,
    motion: Motion,
    /// The process whose Vulkan device is used, if one is.
    device_of: Option<u32>,
    /// Whether the state was read since the last step.
    is_read: bool,
    /// Emotions of all agents at the start.
    emotions: Vec<[f32; 4]>,
    info: Vec<AgentInfo>,
    pub(crate) recorder: Option<Recorder>,
}

impl Crowd {
    pub(crate) fn new(scene: Scene, recorder: Option<Recorder>) -> Self {
        let all = scene.crowd.agents.iter().chain(&scene.crowd.external);
        Self {
            emotions: all.map(|agent| agent.emotion).collect(),
            info: scene.agents_info(),
            motion: Motion::Waits,
            device_of: None,
            is_read: false,
            recorder,
            scene,
        }
    }

    /// How many agents there are, present or not.
    pub(crate) fn agents(&self) -> usize {
        self.emotions.len()
    }

    /// What is known of each agent.
    pub(crate) fn info(&self) -> &[AgentInfo] {
        &self.info
    }

    /// Seconds of a step.
    pub(crate) fn time_step(&self) -> f32 {
        self.scene.scenario.navigation.time_step
    }

    /// Whether a read takes no time: the state is here.
    pub(crate) const fn is_read(&self) -> bool {
        self.is_read
    }

    /// Opens what the crowd is computed on, unless it is open.
    fn start(&mut self) -> Result<()> {
        if let Some(by) = self.device_of {
            fork::check_own(by)?;
        }
        if !matches!(self.motion, Motion::Waits) {
            return Ok(());
        }
        if !self.scene.backend.is_cpu() {
            fork::check_may_open()?;
        }
        let simulation = self.scene.start()?;
        if simulation.engine().is_some() {
            self.opened();
        }
        self.motion = Motion::Walks(Box::new(simulation));
        if let Some(mut recorder) = self.recorder.take() {
            let recorded = self.record(&mut recorder);
            self.recorder = Some(recorder);
            recorded?;
        }
        Ok(())
    }

    fn opened(&mut self) {
        fork::opened();
        self.device_of = Some(std::process::id());
    }

    /// The simulation, started.
    pub(crate) fn simulation(&mut self) -> Result<&mut Simulation> {
        self.start()?;
        match &mut self.motion {
            Motion::Walks(simulation) => Ok(simulation),
            Motion::OnStage(stage) => Ok(&mut stage.simulation),
            Motion::Waits => Err(Fault::failed("the crowd did not start", "please report this")),
        }
    }

    /// The present state and the number of agents.
    pub(crate) fn read(&mut self) -> Result<(&Store, usize)> {
        let agents = self.agents();
        self.simulation()?.state()?;
        self.is_read = true;
        Ok((self.simulation()?.store(), agents))
    }

    /// Weights of the emotions by agent: those of now where they change, else those of the start.
    pub(crate) fn feelings(&mut self) -> Result<&[[f32; 4]]> {
        let (store, agents) = self.read()?;
        if store.step.feels == 0 {
            return Ok(&self.emotions);
        }
        let feeling = &self.simulation()?.store().feeling;
        Ok(&feeling[..agents.min(feeling.len())])
    }

    /// Steps done and the time that they take, s.
    pub(crate) fn time(&self) -> (u32, f64) {
        let steps = match &self.motion {
            Motion::Waits => 0,
            Motion::Walks(simulation) => simulation.steps_done(),
            Motion::OnStage(stage) => stage.simulation.steps_done(),
        };
        (steps, time_of(steps, self.time_step()))
    }

    /// Does up to `count` steps, as many as fit in `longest`, and records those that are to be recorded. Returns how many.
    pub(crate) fn advance(&mut self, count: u32, longest: Duration) -> Result<u32> {
        let (begin, mut done) = (Instant::now(), 0);
        self.start()?;
        while done < count && (done == 0 || begin.elapsed() < longest) {
            if done > 0 {
                self.simulation()?.finish()?;
            }
            let steps = self.time().0;
            let to_next = self.recorder.as_ref().map_or(u32::MAX, |own| own.every - steps % own.every);
            let some = (count - done).min(TOGETHER).min(to_next);
            self.is_read = false;
            self.simulation()?.step(some)?;
            done += some;
            if let Some(mut recorder) = self.recorder.take_if(|_| some == to_next) {
                let recorded = self.record(&mut recorder);
                self.recorder = Some(recorder);
                recorded?;
            }
        }
        Ok(done)
    }

    /// Adds the present frame to a recording.
    pub(crate) fn record(&mut self, recorder: &mut Recorder) -> Result<()> {
        let (_, time) = self.time();
        self.read()?;
        let feelings = self.feelings()?.to_vec();
        let simulation = match &self.motion {
            Motion::Walks(simulation) => simulation.as_ref(),
            Motion::OnStage(stage) => &stage.simulation,
            Motion::Waits => return Ok(()),
        };
        recorder.frame(simulation.store(), &feelings, &self.info, time)
    }

    /// Steps of so many seconds, which must be a whole number of steps.
    pub(crate) fn steps_of(&self, name: &str, seconds: f64) -> Result<u32> {
        let steps = seconds / f64::from(self.time_step());
        let whole = steps.round();
        if !((1.0..=1e9).contains(&whole) && (whole - steps).abs() < 0.01) {
            let rate = 1.0 / f64::from(self.time_step());
            let message =
                format!("{name} = {seconds}: must be a whole number of steps of 1/{rate:.0} s, at least one");
            return Err(Fault::value(message, format!("such as {:.4} s, three steps", 3.0 / rate)));
        }
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 1e9")]
        let steps = whole as u32;
        Ok(steps)
    }

    /// Says where an agent that is led is after the next step, with its velocity (x, z); none: it is absent.
    pub(crate) fn lead(&mut self, agent: u32, target: Option<(Vec2, Vec2)>) -> Result<()> {
        let last = self.agents().checked_sub(1);
        if agent as usize >= self.agents() {
            let numbers = last
                .map_or_else(|| "there are none".to_owned(), |last| format!("they are numbered 0 to {last}"));
            return Err(Fault::value(format!("there is no agent {agent}: {numbers}"), "see sim.agents"));
        }
        if !self.info[agent as usize].led {
            return Err(Fault::value(
                format!("agent {agent} cannot be led: it walks by itself"),
                "add one that can: set={\"outsiders\": [{\"kind\": \"robot\"}]}",
            ));
        }
        self.simulation()?.lead(agent, target)?;
        Ok(())
    }

    /// The stage, made on the first call; what is drawn has this size, pixels.
    ///
    /// The stage is begun with a crowd of its own, on the CPU, so that bodies are animated apart from the steps; then this crowd takes its place.
    /// So a crowd that is never drawn has no bodies, and one that is drawn keeps the memory that views look at.
    fn stage(&mut self, (width, height): (u32, u32)) -> Result<&mut Stage> {
        self.simulation()?;
        if let Motion::Walks(_) = self.motion {
            fork::check_may_open()?;
            let copy = self.scene.clone().on(Backend::Cpu, self.scene.device.as_deref());
            let mut settings = Settings::sized(width, height);
            settings.atmosphere = atmosphere(self.scene.scenario.layout);
            let stage = Box::new(Stage::new(copy, settings)?);
            if let Motion::Walks(walking) = std::mem::replace(&mut self.motion, Motion::OnStage(stage))
                && let Motion::OnStage(stage) = &mut self.motion
            {
                stage.simulation = *walking;
            }
            self.opened();
        }
        let Motion::OnStage(stage) = &mut self.motion else {
            return Err(Fault::failed("the crowd is not on stage", "please report this"));
        };
        if stage.size() != (width, height) {
            stage.resize((width, height))?;
        }
        Ok(stage)
    }

    /// A picture of the crowd as it is, `since` seconds after the first of a video.
    pub(crate) fn picture(&mut self, camera: CameraChoice, size: (u32, u32), since: f64) -> Result<Image> {
        let stage = self.stage(size)?;
        let camera = stage.camera(camera, since)?;
        let image = stage.picture(&camera)?;
        self.is_read = false;
        Ok(image)
    }
}

/// Begins a video file.
pub(crate) fn video(path: &Path, (width, height): (u32, u32), rate: f64) -> Result<Video> {
    Ok(Video::create(path, width, height, rate).map_err(gaitway::export::Error::from)?)
}

impl Drop for Crowd {
    /// What a parent opened is the parent's to close: in a fork its driver's threads are missing, and closing would wait for them.
    fn drop(&mut self) {
        if self.device_of.is_some_and(|by| by != std::process::id()) {
            std::mem::forget(std::mem::replace(&mut self.motion, Motion::Waits));
        }
    }
}
