//! A window that shows images from memory: what the user of a headset sees.

use super::canvas::Canvas;
use super::surface::{self, Surface};
use super::window::no_display;
use crate::gpu::Validation;
use crate::picture::Image;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::window::{Window, WindowId};

/// Time between two looks for a new image.
const LOOK: Duration = Duration::from_millis(10);

/// Where the images come from.
pub trait Source {
    /// The newest image, unless it was given already.
    fn take(&mut self) -> Option<Image>;

    /// Whether more images may come.
    fn is_open(&self) -> bool;
}

/// What a mirror has shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Mirrored {
    /// Images that were shown.
    pub shown: u64,
    /// Whether the user closed the window.
    pub was_closed: bool,
}

/// Shows images in a window until it is closed or there are no more.
///
/// # Errors
/// [`NoDisplay`](super::Error::NoDisplay) and [`NoPresenter`](super::Error::NoPresenter) when there can be no window; when the
/// device fails.
pub fn mirror(title: &str, size: [u32; 2], source: &mut dyn Source) -> Result<Mirrored, crate::Error> {
    let events = EventLoop::new().map_err(no_display)?;
    let mut app =
        App { title, size, source, open: None, mirrored: Mirrored::default(), failure: None, newest: None };
    let ended = events.run_app(&mut app);
    drop(app.open.take());
    if let Some(error) = app.failure {
        return Err(error);
    }
    ended.map_err(no_display)?;
    Ok(app.mirrored)
}

/// What lives as long as the window. What uses the device goes before the surface, that before the window.
struct Open {
    canvas: Canvas,
    surface: Surface,
    window: Window,
}

struct App<'a> {
    title: &'a str,
    size: [u32; 2],
    source: &'a mut dyn Source,
    open: Option<Open>,
    newest: Option<Image>,
    mirrored: Mirrored,
    failure: Option<crate::Error>,
}

impl App<'_> {
    fn open(&self, events: &ActiveEventLoop) -> Result<Open, crate::Error> {
        let attributes = Window::default_attributes()
            .with_title(format!("{} - gaitway", self.title))
            .with_inner_size(PhysicalSize::new(self.size[0], self.size[1]));
        let window = events.create_window(attributes).map_err(no_display)?;
        let device = surface::open(&window, None, Validation::from_environment()?)?;
        let surface = Surface::new(&device, &window)?;
        Ok(Open { canvas: Canvas::new(&device, self.size)?, surface, window })
    }

    fn show(&mut self) -> Result<(), crate::Error> {
        let (Some(scene), Some(newest)) = (&mut self.open, &self.newest) else { return Ok(()) };
        let size: [u32; 2] = scene.window.inner_size().into();
        if !size.contains(&0) && scene.canvas.paint(newest, &mut scene.surface, size)? {
            self.mirrored.shown += 1;
        }
        Ok(())
    }

    fn fail(&mut self, events: &ActiveEventLoop, error: crate::Error) {
        self.failure.get_or_insert(error);
        events.exit();
    }
}

impl ApplicationHandler for App<'_> {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.open.is_none() && self.failure.is_none() {
            match self.open(events) {
                Ok(scene) => self.open = Some(scene),
                Err(error) => self.fail(events, error),
            }
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested | WindowEvent::Destroyed => {
                self.mirrored.was_closed = true;
                events.exit();
            }
            WindowEvent::Resized(_) => {
                if let Some(scene) = &mut self.open {
                    scene.surface.forget();
                    scene.window.request_redraw();
                }
            }
            WindowEvent::RedrawRequested => {
                if let Err(error) = self.show() {
                    self.fail(events, error);
                }
            }
            _ => {}
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        if !self.source.is_open() {
            events.exit();
            return;
        }
        if let (Some(image), Some(scene)) = (self.source.take(), &self.open) {
            self.newest = Some(image);
            scene.window.request_redraw();
        }
        events.set_control_flow(ControlFlow::WaitUntil(Instant::now() + LOOK));
    }
}
