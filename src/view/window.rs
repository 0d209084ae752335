//! The window itself: its events, and one frame after another.

mod input;

use super::camera::{CameraMode, Push, Rig};
use super::canvas::{Canvas, Overlay};
use super::crowd::{Company, Picked};
use super::panel::{self, Controls, Facts, Requests};
use super::pick::Ray;
use super::surface::{self, Surface};
use super::{Choice, Error, Outcome, Plan, shares};
use crate::export::image::write_png;
use crate::gpu::Validation;
use crate::picture::Image;
use crate::render::camera::View;
use crate::scenario::Shares;
use crate::scene::{Scene, SceneBuilder};
use glam::{Vec2, Vec3};
use input::Pointer;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::keyboard::KeyCode;
use winit::window::{Window, WindowId};

/// Pause while the window is hidden or has no area: the crowd goes on.
const HIDDEN: Duration = Duration::from_millis(20);
/// How long a line for the user stays in the panel.
const SAYING: Duration = Duration::from_secs(6);
/// Most files that are tried for a free name.
const MOST_FILES: u32 = 10_000;
/// Frames after which [`Plan::click`] comes.
const CLICK_AFTER: u64 = 3;

/// Opens the window and shows the crowd until it is closed.
///
/// # Errors
/// [`Error::NoDisplay`] and [`Error::NoPresenter`] when there can be no window; when the crowd cannot be cast or the device
/// fails.
pub fn run(plan: Plan, builder: SceneBuilder) -> Result<Outcome, crate::Error> {
    let scene = builder.clone().build()?;
    let events = EventLoop::new().map_err(no_display)?;
    events.set_control_flow(ControlFlow::Poll);
    let cast = Some((builder, scene));
    let mut app = App { plan, cast, open: None, outcome: Outcome::default(), failure: None };
    let ended = events.run_app(&mut app);
    let open = app.open.take();
    if let Some(error) = app.failure {
        return Err(error);
    }
    ended.map_err(no_display)?;
    drop(open);
    Ok(app.outcome)
}

/// What the system says of a window that cannot be, without the place in the source where it says so.
pub(super) fn no_display(error: impl std::fmt::Display) -> Error {
    let text = error.to_string();
    let rest = text.split_once(".rs:").map(|(_, rest)| rest.trim_start_matches(|c: char| c.is_ascii_digit()));
    Error::NoDisplay(rest.map_or(text.as_str(), |rest| rest.trim_start_matches([':', ' '])).to_owned())
}

struct App {
    plan: Plan,
    /// The crowd, until there is a window to show it in.
    cast: Option<(SceneBuilder, Scene)>,
    open: Option<Open>,
    outcome: Outcome,
    failure: Option<crate::Error>,
}

/// Everything that lives as long as the window. What uses the device goes before the surface, that before the window.
struct Open {
    company: Company,
    canvas: Canvas,
    surface: Surface,
    pen: egui_winit::State,
    rig: Rig,
    controls: Controls,
    pointer: Pointer,
    keys: BTreeSet<KeyCode>,
    picked: Option<u32>,
    click: Option<(u32, u32)>,
    message: (String, Instant),
    devices: (String, String),
    begin: Instant,
    before: Instant,
    /// Time between two frames, smoothed, s; 0 before the second.
    pace: f64,
    is_hidden: bool,
    view: View,
    size: [u32; 2],
    window: Window,
}

impl ApplicationHandler for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if let Some(cast) = self.cast.take() {
            match Open::new(&self.plan, cast, events) {
                Ok(open) => self.open = Some(open),
                Err(error) => self.fail(events, error),
            }
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        let _ = open.pen.on_window_event(&open.window, &event);
        match event {
            WindowEvent::CloseRequested | WindowEvent::Destroyed => self.end(events),
            WindowEvent::RedrawRequested => self.redraw(events),
            WindowEvent::Occluded(is_hidden) => open.is_hidden = is_hidden,
            other => {
                if let Err(error) = open.take(&other) {
                    self.fail(events, error);
                }
            }
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        let Some(open) = &mut self.open else { return };
        let size = open.window.inner_size();
        if open.is_hidden || size.width == 0 || size.height == 0 {
            // nothing can be shown: the crowd goes on, and no other thread is kept waiting
            events.set_control_flow(ControlFlow::WaitUntil(Instant::now() + HIDDEN));
            let seconds = open.seconds_since();
            if let Err(error) = open.advance(seconds) {
                self.fail(events, error);
            } else if self.is_over() {
                self.redraw(events); // a shot that was requested needs no window
            }
        } else {
            events.set_control_flow(ControlFlow::Poll);
            open.window.request_redraw();
        }
    }
}

impl App {
    fn is_over(&self) -> bool {
        let since = self.open.as_ref().map(|open| open.begin.elapsed().as_secs_f64());
        crate::stop::asked() || self.plan.seconds.zip(since).is_some_and(|(most, since)| since >= most)
    }

    fn redraw(&mut self, events: &ActiveEventLoop) {
        if self.failure.is_some() || events.exiting() {
            return;
        }
        let is_last = self.is_over();
        let Some(open) = &mut self.open else { return };
        let shot = self.plan.shot.as_deref().filter(|_| is_last);
        if let Err(error) = open.frame(&self.plan, &mut self.outcome, shot) {
            self.fail(events, error);
        } else if is_last {
            self.end(events);
        }
    }

    fn fail(&mut self, events: &ActiveEventLoop, error: crate::Error) {
        self.failure.get_or_insert(error);
        events.exit();
    }

    /// Ends in good order.
    fn end(&mut self, events: &ActiveEventLoop) {
        if let Some(open) = &mut self.open
            && !events.exiting()
        {
            match open.finish(&mut self.outcome) {
                Ok(()) => {}
                Err(error) => self.failure = Some(error),
            }
        }
        events.exit();
    }
}

impl Open {
    fn new(plan: &Plan, cast: (SceneBuilder, Scene), events: &ActiveEventLoop) -> Result<Self, crate::Error> {
        let attributes = Window::default_attributes()
            .with_title(format!("{} - gaitway", cast.1.scenario.name))
            .with_inner_size(PhysicalSize::new(plan.size.0, plan.size.1));
        let window = events.create_window(attributes).map_err(no_display)?;
        let device = surface::open(&window, cast.1.device.as_deref(), Validation::from_environment()?)?;
        let size: [u32; 2] = window.inner_size().into();
        let size = size.map(|side| side.max(1));
        let surface = Surface::new(&device, &window)?;
        let canvas = Canvas::new(&device, size)?;
        let mut company = Company::new(&device, cast, plan, size)?;
        company.set_markers(plan.has_markers);
        if let Some(path) = &plan.record {
            company.begin_film(path)?;
        }
        let context = egui::Context::default();
        context.set_theme(egui::Theme::Dark);
        let side = usize::try_from(device.limits.max_image_dimension2_d).ok();
        let pen = egui_winit::State::new(context, egui::ViewportId::ROOT, &window, None, None, side);
        let (eye, target) = company.scene().geometry.overview;
        let rig = Rig::new(eye, target);
        let scenario = &company.scene().scenario;
        let Shares { happy, angry, sad, neutral } = scenario.population.emotions;
        let (condition, gaze) = (scenario.condition, scenario.gaze.mode);
        let now = Instant::now();
        Ok(Self {
            devices: company.devices(),
            company,
            canvas,
            surface,
            pen,
            view: View::mono(&rig.camera(), size[0], size[1]),
            rig,
            controls: Controls {
                is_open: true,
                is_paused: plan.is_paused,
                speed: 1.0,
                choice: Choice { condition, shares: shares::whole([happy, angry, sad, neutral]) },
                held: None,
                gaze,
                has_markers: plan.has_markers,
                camera: CameraMode::default(),
                shot_has_panel: true,
                requests: Requests::default(),
            },
            pointer: Pointer::default(),
            keys: BTreeSet::new(),
            picked: None,
            click: plan.click,
            message: (String::new(), now),
            begin: now,
            before: now,
            pace: 0.0,
            is_hidden: false,
            size,
            window,
        })
    }

    /// Picks the person at a point of the window, pixels from the top left.
    fn pick(&mut self, at: Vec2) -> Result<(), crate::Error> {
        let ndc = at / Vec2::new(side(self.size[0]), side(self.size[1])) * 2.0 - 1.0;
        let ray = Ray { origin: self.view.eyes[0], direction: self.view.ray(0, ndc) };
        self.picked = self.company.pick(&ray)?;
        Ok(())
    }

    /// Seconds since the last call.
    fn seconds_since(&mut self) -> f64 {
        let now = Instant::now();
        (now - std::mem::replace(&mut self.before, now)).as_secs_f64()
    }

    /// Lets the crowd go on.
    fn advance(&mut self, seconds: f64) -> Result<(), crate::Error> {
        let is_requested = std::mem::take(&mut self.controls.requests.step);
        if is_requested {
            self.company.step_once()?;
        } else if !self.controls.is_paused {
            self.company.pass(seconds, self.controls.speed)?;
        }
        Ok(())
    }

    fn say(&mut self, line: String) {
        self.message = (line, Instant::now());
    }

    /// One frame.
    fn frame(&mut self, plan: &Plan, outcome: &mut Outcome, shot: Option<&Path>) -> Result<(), crate::Error> {
        let size: [u32; 2] = self.window.inner_size().into();
        if size.contains(&0) {
            return Ok(());
        }
        if size != self.size {
            self.take_size(size, outcome)?;
        }
        let seconds = self.seconds_since();
        if outcome.frames > 0 {
            self.pace += (seconds - self.pace) * if self.pace > 0.0 { 0.1 } else { 1.0 };
        }
        self.advance(seconds)?;
        let person = self.steer(seconds)?;
        let eyes = if plan.eyes_follow_camera { self.view.eyes[0] } else { self.company.user_eyes() };
        let requests = self.controls.requests;
        let overlay = self.lay(person.as_ref());
        let keeps = requests.shot || shot.is_some();
        let with_panel = self.controls.shot_has_panel || shot.is_some();
        let target = self.canvas.target(keeps && !with_panel);
        let bare = self.company.draw(&self.view, eyes, &target)?;
        let (was_shown, full) = self.canvas.show(overlay, &mut self.surface, keeps && with_panel)?;
        outcome.frames += u64::from(was_shown);
        if let Some(image) = full.or(bare.filter(|_| keeps)) {
            match keep(&image, shot) {
                Ok(file) => {
                    self.say(format!("written {}", file.display()));
                    outcome.shots.push(file);
                }
                Err(error) if shot.is_some() => return Err(error),
                Err(error) => self.complain(plan, &error),
            }
        }
        self.controls.requests.shot &= !requests.shot;
        if let Some(at) = self.click.filter(|_| outcome.frames >= CLICK_AFTER) {
            self.click = None;
            self.pick(Vec2::new(side(at.0), side(at.1)))?;
        }
        self.obey(plan, outcome)
    }

    /// Another size of the window.
    fn take_size(&mut self, size: [u32; 2], outcome: &mut Outcome) -> Result<(), crate::Error> {
        if self.company.is_filmed() {
            self.end_film(outcome)?; // all frames of a video are of one size
        }
        self.company.resize(size)?;
        self.canvas.resize(size)?;
        self.surface.forget();
        self.size = size;
        Ok(())
    }

    /// Moves the camera. Returns the picked person as they are now.
    fn steer(&mut self, seconds: f64) -> Result<Option<Picked>, crate::Error> {
        let person = match self.picked {
            Some(agent) => self.company.picked(agent)?,
            None => None,
        };
        let held = |code| f32::from(u8::from(self.keys.contains(&code)));
        let push = Push {
            right: held(KeyCode::KeyD) - held(KeyCode::KeyA) + held(KeyCode::ArrowRight)
                - held(KeyCode::ArrowLeft),
            up: held(KeyCode::KeyE) - held(KeyCode::KeyQ),
            forward: held(KeyCode::KeyW) - held(KeyCode::KeyS) + held(KeyCode::ArrowUp)
                - held(KeyCode::ArrowDown),
            is_fast: self.keys.contains(&KeyCode::ShiftLeft),
        };
        #[allow(clippy::cast_possible_truncation, reason = "a short time")]
        let seconds = seconds.min(0.1) as f32;
        self.rig.set_mode(self.controls.camera);
        if push != Push::default() {
            self.rig.push(push, seconds);
        }
        self.rig.follow(person.as_ref().map(Company::place));
        self.view = View::mono(&self.rig.camera(), self.size[0], self.size[1]);
        Ok(person)
    }

    /// The panel of this frame.
    fn lay(&mut self, person: Option<&Picked>) -> Overlay {
        let input = self.pen.take_egui_input(&self.window);
        let context = self.pen.egui_ctx().clone();
        let points = egui_winit::pixels_per_point(&context, &self.window);
        let place = |at: Vec3| {
            let pixel = self.view.pixel_from_world(0, at, self.size[0], self.size[1])?;
            Some(egui::pos2(pixel.x / points, pixel.y / points))
        };
        let mark = person.and_then(|person| {
            let foot = Company::place(person);
            Some([place(foot)?, place(foot + Vec3::Y * self.company.height())?])
        });
        let facts = Facts {
            time: self.company.time(),
            agents: self.company.agents(),
            rate: if self.pace > 0.0 { 1.0 / self.pace } else { 0.0 },
            device: &self.devices.0,
            simulated_on: &self.devices.1,
            picked: person,
            mark,
            is_filmed: self.company.is_filmed(),
            times: &self.company.times,
            message: if self.message.1.elapsed() < SAYING { &self.message.0 } else { "" },
        };
        let controls = &mut self.controls;
        let output = context.run_ui(input, |ui| panel::lay(ui, controls, &facts));
        self.pen.handle_platform_output(&self.window, output.platform_output);
        Overlay {
            primitives: context.tessellate(output.shapes, output.pixels_per_point),
            textures: output.textures_delta,
            pixels_per_point: output.pixels_per_point,
        }
    }

    /// Does what the user has requested in the panel.
    fn obey(&mut self, plan: &Plan, outcome: &mut Outcome) -> Result<(), crate::Error> {
        let requests = std::mem::take(&mut self.controls.requests);
        self.controls.requests = Requests { shot: requests.shot, step: requests.step, ..Requests::default() };
        self.company.set_gaze_mode(self.controls.gaze);
        self.company.set_markers(self.controls.has_markers);
        if requests.unpick {
            self.picked = None;
        }
        if requests.recast {
            if let Err(error) = self.company.recast(&self.controls.choice) {
                self.complain(plan, &error);
            }
            self.before = Instant::now();
        }
        if requests.film {
            if self.company.is_filmed() {
                self.end_film(outcome)?;
            } else {
                let path = free_name("mp4");
                match self.company.begin_film(&path) {
                    Ok(()) => self.say(format!("filming {}", path.display())),
                    Err(error) => self.complain(plan, &error),
                }
            }
        }
        Ok(())
    }

    fn complain(&mut self, plan: &Plan, error: &crate::Error) {
        (plan.note)(&format!("error: {error}"));
        self.say(error.to_string());
    }

    fn end_film(&mut self, outcome: &mut Outcome) -> Result<(), crate::Error> {
        if let Some((path, frames)) = self.company.end_film()? {
            self.say(format!("written {} ({frames} pictures)", path.display()));
            outcome.videos.push(path);
        }
        Ok(())
    }

    /// What came of it all.
    fn finish(&mut self, outcome: &mut Outcome) -> Result<(), crate::Error> {
        self.end_film(outcome)?;
        (outcome.device, outcome.simulated_on) = self.devices.clone();
        outcome.steps = self.company.steps();
        [outcome.step_ms, outcome.picture_ms] = [0, 1].map(|which| self.company.times[which].means());
        outcome.swapchains = self.surface.made();
        outcome.size = self.size;
        outcome.picked = match self.picked {
            Some(agent) => self.company.picked(agent)?,
            None => None,
        };
        Ok(())
    }
}

/// A file in the working folder that is not there yet.
fn free_name(ending: &str) -> PathBuf {
    let name = |number: u32| PathBuf::from(format!("gaitway-{number:04}.{ending}"));
    (1..MOST_FILES).map(name).find(|path| !path.exists()).unwrap_or_else(|| name(MOST_FILES))
}

/// Writes an image into a file, or into one with a free name; the file's name.
fn keep(image: &Image, file: Option<&Path>) -> Result<PathBuf, crate::Error> {
    let path = file.map_or_else(|| free_name("png"), Path::to_owned);
    write_png(&path, image).map_err(crate::export::Error::from)?;
    Ok(path)
}

#[allow(clippy::cast_precision_loss, reason = "sides of windows are far below 2^24")]
const fn side(pixels: u32) -> f32 {
    pixels as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_display_is_reported_without_the_place_in_a_source_file() {
        let message = no_display("os error at /home/me/winit/src/mod.rs:765: DISPLAY is not set").to_string();
        assert_eq!(message, "no window can be opened: DISPLAY is not set");
        assert_eq!(no_display("no").to_string(), "no window can be opened: no");
    }
}
