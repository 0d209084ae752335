//! Pointer and keys over the frame.

use super::{Open, side};
use crate::view::camera::CameraMode;
use crate::view::panel;
use glam::Vec2;
use winit::event::{ElementState, KeyEvent, MouseButton, MouseScrollDelta, WindowEvent};
use winit::keyboard::{KeyCode, PhysicalKey};

/// Pointer movement up to which a press and release are a click, pixels.
const CLICK: f32 = 4.0;
/// Pixels that a touchpad scrolls for one notch of a wheel.
const NOTCH: f32 = 50.0;

/// The pointer over the frame.
#[derive(Debug, Default)]
pub(super) struct Pointer {
    at: Vec2,
    /// Which button is held since when it was pressed over the frame, and how far it was dragged.
    held: Option<(MouseButton, f32)>,
}

impl Open {
    /// Takes an event that is not the panel's.
    pub(super) fn take(&mut self, event: &WindowEvent) -> Result<(), crate::Error> {
        let context = self.pen.egui_ctx();
        let types = context.egui_wants_keyboard_input();
        // by its place: egui itself knows only where the pointer was at the frame before
        let width = panel::WIDTH * egui_winit::pixels_per_point(context, &self.window);
        let is_over = self.controls.is_open && self.pointer.at.x <= width;
        let over_panel = is_over || context.egui_is_using_pointer();
        match event {
            WindowEvent::CursorMoved { position, .. } => {
                #[allow(clippy::cast_possible_truncation, reason = "pixels")]
                let at = Vec2::new(position.x as f32, position.y as f32);
                let moved = at - self.pointer.at;
                self.pointer.at = at;
                if let Some((button, dragged)) = &mut self.pointer.held {
                    *dragged += moved.length();
                    if *dragged > CLICK {
                        let drag = moved / side(self.size[1]);
                        match button {
                            MouseButton::Left => self.rig.turn(drag),
                            _ => self.rig.pan(drag),
                        }
                    }
                }
            }
            WindowEvent::MouseInput { state: ElementState::Pressed, button, .. } if !over_panel => {
                self.pointer.held = Some((*button, 0.0));
            }
            WindowEvent::MouseInput { state: ElementState::Released, button, .. } => {
                let held = self.pointer.held.take();
                if let Some((MouseButton::Left, dragged)) = held
                    && *button == MouseButton::Left
                    && dragged <= CLICK
                {
                    self.pick(self.pointer.at)?;
                }
            }
            WindowEvent::MouseWheel { delta, .. } if !over_panel => {
                #[allow(clippy::cast_possible_truncation, reason = "pixels")]
                self.rig.zoom(match delta {
                    MouseScrollDelta::LineDelta(_, y) => *y,
                    MouseScrollDelta::PixelDelta(at) => at.y as f32 / NOTCH,
                });
            }
            WindowEvent::KeyboardInput { event, .. } if !types || event.state == ElementState::Released => {
                self.key(event);
            }
            WindowEvent::Focused(false) => {
                self.keys.clear();
                self.pointer.held = None;
            }
            _ => {}
        }
        Ok(())
    }

    fn key(&mut self, event: &KeyEvent) {
        let PhysicalKey::Code(code) = event.physical_key else { return };
        if event.state == ElementState::Released {
            self.keys.remove(&code);
            return;
        }
        self.keys.insert(code);
        if event.repeat {
            return;
        }
        let controls = &mut self.controls;
        match code {
            KeyCode::Space => controls.is_paused = !controls.is_paused,
            KeyCode::Period => {
                controls.is_paused = true;
                controls.requests.step = true;
            }
            KeyCode::Tab => controls.is_open = !controls.is_open,
            KeyCode::KeyF => {
                let follows = controls.camera == CameraMode::Follow;
                controls.camera = if follows { CameraMode::Orbit } else { CameraMode::Follow };
            }
            KeyCode::Escape => controls.requests.unpick = true,
            KeyCode::F12 => controls.requests.shot = true,
            KeyCode::F9 => controls.requests.film = true,
            _ => {}
        }
    }
}
