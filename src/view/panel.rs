//! The panel beside the frame: what the crowd does, and what can be changed.

use super::camera::CameraMode;
use super::crowd::Picked;
use super::plan::{CONDITIONS, Choice, GAZE_MODES};
use super::shares;
use super::times::Times;
use crate::emotion::Emotion;
use crate::scenario::GazeMode;
use egui::{Color32, Grid, RichText, Slider, Ui};
use egui_plot::{Line, Plot, PlotPoints};
use std::collections::VecDeque;

/// Kernels that the plot shows by name.
const PLOTTED: usize = 6;
/// Width, points.
pub(super) const WIDTH: f32 = 290.0;

/// What the user has set.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Controls {
    pub(super) is_open: bool,
    pub(super) is_paused: bool,
    /// The crowd's seconds per second.
    pub(super) speed: f64,
    /// Its shares are parts of one.
    pub(super) choice: Choice,
    /// The shares when one of them was taken hold of: the others keep their proportions to the end.
    pub(super) held: Option<[f32; 4]>,
    pub(super) gaze: GazeMode,
    pub(super) has_markers: bool,
    pub(super) camera: CameraMode,
    /// Whether frames are kept with the panel.
    pub(super) shot_has_panel: bool,
    /// What the user has requested since the last frame.
    pub(super) requests: Requests,
}

/// What the user has requested.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Requests {
    pub(super) step: bool,
    pub(super) shot: bool,
    pub(super) film: bool,
    pub(super) recast: bool,
    pub(super) unpick: bool,
}

/// What is so.
pub(super) struct Facts<'a> {
    pub(super) time: f64,
    pub(super) agents: u32,
    /// Frames a second.
    pub(super) rate: f64,
    pub(super) device: &'a str,
    pub(super) simulated_on: &'a str,
    pub(super) picked: Option<&'a Picked>,
    /// Where the picked person is in the frame: middle of the feet and of the head, points.
    pub(super) mark: Option<[egui::Pos2; 2]>,
    pub(super) is_filmed: bool,
    pub(super) times: &'a [Times; 2],
    pub(super) message: &'a str,
}

/// Lays the panel out.
pub(super) fn lay(ui: &mut Ui, controls: &mut Controls, facts: &Facts<'_>) {
    mark(ui, facts);
    if !controls.is_open {
        return;
    }
    egui::Panel::left("panel").resizable(false).exact_size(WIDTH).show(ui, |ui| {
        egui::ScrollArea::vertical().show(ui, |ui| {
            ui.add_space(4.0);
            head(ui, facts);
            ui.separator();
            clock(ui, controls);
            ui.separator();
            people(ui, controls);
            ui.separator();
            camera(ui, controls, facts);
            ui.separator();
            person(ui, controls, facts.picked);
            ui.separator();
            plot(ui, "step", &facts.times[0]);
            plot(ui, "picture", &facts.times[1]);
        });
    });
}

/// A bracket about the picked person.
fn mark(ui: &Ui, facts: &Facts<'_>) {
    let Some([feet, head]) = facts.mark else { return };
    let half = ((feet.y - head.y).abs() * 0.25).max(6.0);
    let rectangle = egui::Rect::from_two_pos(
        egui::pos2(head.x - half, head.y - 4.0),
        egui::pos2(feet.x + half, feet.y + 4.0),
    );
    let stroke = egui::Stroke::new(2.0, Color32::from_rgb(255, 235, 120));
    ui.painter().rect_stroke(rectangle, 3.0, stroke, egui::StrokeKind::Outside);
}

fn head(ui: &mut Ui, facts: &Facts<'_>) {
    ui.label(RichText::new(format!("{:.1} s", facts.time)).heading());
    ui.label(format!("{} people, {:.0} pictures/s", facts.agents, facts.rate));
    let same = facts.device == facts.simulated_on;
    let how = if same { "simulated and drawn on" } else { "simulated on" };
    ui.label(RichText::new(format!("{how} {}", facts.simulated_on)).small());
    if !same {
        ui.label(RichText::new(format!("drawn on {}", facts.device)).small());
    }
    // there even without a message: what stands below must not jump away from the pointer
    let message = if facts.message.is_empty() { " " } else { facts.message };
    ui.add(egui::Label::new(RichText::new(message).small().strong()).truncate());
}

fn clock(ui: &mut Ui, controls: &mut Controls) {
    ui.horizontal(|ui| {
        let name = if controls.is_paused { "Go on" } else { "Pause" };
        if ui.button(name).on_hover_text("Space").clicked() {
            controls.is_paused = !controls.is_paused;
        }
        if ui.button("One step").on_hover_text("full stop").clicked() {
            controls.is_paused = true;
            controls.requests.step = true;
        }
    });
    let speed = Slider::new(&mut controls.speed, 0.1..=8.0).logarithmic(true).suffix(" x").text("speed");
    ui.add(speed);
}

fn people(ui: &mut Ui, controls: &mut Controls) {
    let before = controls.choice.condition;
    ui.horizontal(|ui| {
        for (condition, name) in CONDITIONS {
            ui.selectable_value(&mut controls.choice.condition, condition, name);
        }
    });
    controls.requests.recast |= controls.choice.condition != before;
    ui.horizontal(|ui| {
        ui.label("gaze");
        for (mode, name) in GAZE_MODES {
            ui.selectable_value(&mut controls.gaze, mode, name);
        }
    });
    Grid::new("shares").show(ui, |ui| {
        for emotion in Emotion::ALL {
            ui.label(emotion.name());
            share(ui, controls, emotion.index());
            ui.end_row();
        }
    });
    ui.checkbox(&mut controls.has_markers, "rings in the colours of the emotions");
}

/// The share of an emotion. The crowd is built again when the slider is released.
fn share(ui: &mut Ui, controls: &mut Controls, index: usize) {
    // whole percents: a slider rounds what it is given, and that is no change of the user's
    let before = (100.0 * controls.choice.shares[index]).round();
    let mut percent = before;
    let response = ui.add(Slider::new(&mut percent, 0.0..=100.0).suffix(" %").integer());
    let is_changed = (percent - before).abs() > 0.5;
    if response.drag_started() {
        controls.held = Some(controls.choice.shares);
    }
    if is_changed {
        let from = controls.held.unwrap_or(controls.choice.shares);
        controls.choice.shares = shares::with(from, index, percent / 100.0);
    }
    controls.requests.recast |= response.drag_stopped() || (is_changed && !response.dragged());
    if response.drag_stopped() {
        controls.held = None;
    }
}

fn camera(ui: &mut Ui, controls: &mut Controls, facts: &Facts<'_>) {
    ui.horizontal(|ui| {
        for (mode, name) in CameraMode::ALL {
            ui.selectable_value(&mut controls.camera, mode, name);
        }
    });
    let keys = "drag: turn; right drag or WASD, Q, E: move (Shift: faster)\nwheel: nearer; click: pick; Tab: hide this panel";
    ui.label(RichText::new(keys).small());
    if controls.camera == CameraMode::Follow && facts.picked.is_none() {
        ui.label(RichText::new("Click a person to follow them.").small().strong());
    }
    ui.horizontal(|ui| {
        if ui.button("Picture").on_hover_text("F12").clicked() {
            controls.requests.shot = true;
        }
        ui.checkbox(&mut controls.shot_has_panel, "with panel");
        let name = if facts.is_filmed { "End film" } else { "Film" };
        if ui.button(name).on_hover_text("F9").clicked() {
            controls.requests.film = true;
        }
    });
}

fn person(ui: &mut Ui, controls: &mut Controls, picked: Option<&Picked>) {
    let Some(person) = picked else {
        ui.label("Click a person to see their state.");
        return;
    };
    ui.horizontal(|ui| {
        ui.label(RichText::new(format!("agent {}", person.id)).strong());
        if ui.small_button("let go").clicked() {
            controls.requests.unpick = true;
        }
    });
    let line = |ui: &mut Ui, name: &str, value: String| {
        ui.label(name);
        ui.label(value);
        ui.end_row();
    };
    Grid::new("person").num_columns(2).show(ui, |ui| {
        line(ui, "emotion", felt(&person.weights));
        line(ui, "speed", format!("{:.2} of {:.2} m/s", person.speed, person.preferred_speed));
        line(ui, "heading", format!("{:.0}°, walks {:.0} %", person.heading_deg, person.walking * 100.0));
        let [x, z] = person.position;
        line(ui, "position", format!("{x:.2}, {z:.2} m, up {:.2} m", person.elevation));
        let [at, of] = person.stage;
        line(ui, "goal", format!("{} {at} of {of}, round {}", person.stage_kind, person.rounds + 1));
        let away = (person.goal[0] - x).hypot(person.goal[1] - z);
        line(ui, "", format!("at {:.1}, {:.1} m, {away:.1} m away", person.goal[0], person.goal[1]));
    });
}

/// The emotions that a person feels, without those of strength 0.
fn felt(weights: &[f32; 4]) -> String {
    let all = Emotion::ALL.into_iter().map(|emotion| (emotion.name(), 100.0 * weights[emotion.index()]));
    let some =
        all.filter(|(_, percent)| *percent >= 0.5).map(|(name, percent)| format!("{name} {percent:.0} %"));
    some.collect::<Vec<_>>().join(", ")
}

/// The colour of a kernel's line: the same whatever its rank, unlike that of its neighbours in the alphabet.
fn color(kernel: &str, all: &[(&'static str, f64, &VecDeque<f64>)]) -> Color32 {
    let before = all.iter().filter(|(name, ..)| *name < kernel).count();
    #[allow(clippy::cast_precision_loss, reason = "a few dozen")]
    let hue = (before as f32 * 0.618_034).fract();
    egui::ecolor::Hsva::new(hue, 0.55, 0.95, 1.0).into()
}

/// How long steps or frames take, their dearest kernels as lines, and what these are called.
fn plot(ui: &mut Ui, name: &str, times: &Times) {
    let all = times.dearest();
    let title = if all.is_empty() {
        format!("{name}: not measured yet")
    } else {
        let sum: f64 = all.iter().map(|(_, mean, _)| mean).sum();
        format!("{name}: {:.2} ms, of it kernels {sum:.2}", times.means().whole)
    };
    egui::CollapsingHeader::new(title).id_salt(name).default_open(true).show(ui, |ui| {
        let frame = Plot::new(name)
            .height(100.0)
            .include_y(0.0)
            .show_x(false)
            .show_axes([false, true])
            .allow_scroll(false)
            .allow_drag(false)
            .allow_zoom(false);
        let lines = || all.iter().take(PLOTTED).map(|line| (line, color(line.0, &all)));
        frame.show(ui, |plot| {
            for ((kernel, _, history), color) in lines() {
                let points: Vec<f64> = history.iter().copied().collect();
                plot.line(Line::new(*kernel, PlotPoints::from_ys_f64(&points)).id(*kernel).color(color));
            }
        });
        ui.horizontal_wrapped(|ui| {
            for ((kernel, mean, _), color) in lines() {
                let text = RichText::new(format!("{kernel} {mean:.2}")).small().color(color);
                ui.add(egui::Label::new(text).extend());
            }
        });
    });
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "limits are exact")]
mod tests {
    use super::*;
    use crate::kernels::Phase;
    use crate::scenario::Condition;
    use egui::{Event, Modifiers, PointerButton, Pos2, RawInput, Rect, Shape, pos2};
    use std::time::Duration;

    fn controls() -> Controls {
        Controls {
            is_open: true,
            is_paused: false,
            speed: 1.0,
            choice: Choice { condition: Condition::EvaG, shares: [0.25; 4] },
            held: None,
            gaze: GazeMode::Natural,
            has_markers: false,
            camera: CameraMode::Orbit,
            shot_has_panel: true,
            requests: Requests::default(),
        }
    }

    fn facts(times: &[Times; 2]) -> Facts<'_> {
        Facts {
            time: 1.5,
            agents: 40,
            rate: 30.0,
            device: "a",
            simulated_on: "a",
            picked: None,
            mark: None,
            is_filmed: false,
            times,
            message: "",
        }
    }

    /// Every text of a frame of the panel, and where it begins.
    fn texts(context: &egui::Context, controls: &mut Controls, events: Vec<Event>) -> Vec<(String, Pos2)> {
        fn collect(shape: &Shape, found: &mut Vec<(String, Pos2)>) {
            match shape {
                Shape::Text(text) => found.push((text.galley.text().to_owned(), text.pos)),
                Shape::Vec(all) => all.iter().for_each(|shape| collect(shape, found)),
                _ => {}
            }
        }
        let mut times = [Times::default(), Times::default()];
        times[0].take(&[(Phase::Integrate, 1.5)], 1, Duration::from_millis(2));
        times[1].take(&[(Phase::Cull, 0.25), (Phase::Skin, 0.5)], 1, Duration::from_millis(8));
        let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, egui::vec2(1280.0, 1200.0)));
        let input = RawInput { screen_rect, events, ..RawInput::default() };
        let mut output = context.run_ui(input, |ui| lay(ui, controls, &facts(&times)));
        output.textures_delta.clear();
        let mut found = Vec::new();
        output.shapes.iter().for_each(|clipped| collect(&clipped.shape, &mut found));
        found
    }

    #[test]
    fn shares_read_as_shares_and_what_takes_time_has_a_name_and_a_unit() {
        let context = egui::Context::default();
        let mut controls = controls();
        texts(&context, &mut controls, Vec::new());
        let found = texts(&context, &mut controls, Vec::new());
        let count = |text: &str| found.iter().filter(|(found, _)| found == text).count();
        assert_eq!([count("25"), count(" %")], [4, 4], "{found:?}");
        assert_eq!(count("step: 2.00 ms, of it kernels 1.50"), 1, "{found:?}");
        assert_eq!(count("picture: 8.00 ms, of it kernels 0.75"), 1, "{found:?}");
        for kernel in ["integrate 1.50", "cull 0.25", "skin 0.50"] {
            assert_eq!(count(kernel), 1, "{kernel}: {found:?}");
        }
        assert_eq!(controls, self::controls(), "looking changes nothing");
    }

    #[test]
    fn a_share_that_is_dragged_takes_from_the_others_and_casts_again_when_let_go() {
        let context = egui::Context::default();
        let mut controls = controls();
        texts(&context, &mut controls, Vec::new());
        let found = texts(&context, &mut controls, Vec::new());
        let value = found.iter().find(|(text, _)| text == "25").map(|(_, at)| *at).unwrap();
        // the rail of the first slider ends left of its value; it is taken hold of at its right end
        let at = value + egui::vec2(-14.0, 6.0);
        let press = |pressed, pos| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        texts(&context, &mut controls, vec![Event::PointerMoved(at), press(true, at)]);
        texts(&context, &mut controls, vec![Event::PointerMoved(at + egui::vec2(8.0, 0.0))]);
        texts(&context, &mut controls, vec![Event::PointerMoved(at + egui::vec2(30.0, 0.0))]);
        assert_eq!(controls.choice.shares, [1.0, 0.0, 0.0, 0.0]);
        assert!(!controls.requests.recast, "not while it is held");
        texts(&context, &mut controls, vec![Event::PointerMoved(pos2(at.x - 500.0, at.y))]);
        let [first, others @ ..] = controls.choice.shares;
        assert!(
            first.abs() < 1e-6 && others.iter().all(|share| (share - 1.0 / 3.0).abs() < 1e-6),
            "{others:?}"
        );
        texts(&context, &mut controls, vec![press(false, pos2(at.x - 500.0, at.y))]);
        assert!(controls.requests.recast && controls.held.is_none());
        // thirds are no whole percents: without a touch nothing changes
        let let_go = controls.choice.shares;
        controls.requests.recast = false;
        texts(&context, &mut controls, Vec::new());
        assert!(controls.choice.shares == let_go && !controls.requests.recast);
    }

    #[test]
    fn what_is_not_felt_is_not_named() {
        assert_eq!(felt(&[0.75, 0.0, 0.25, 0.001]), "happy 75 %, sad 25 %");
    }
}
