//! The panel beside the picture: what the crowd does, and what can be changed.

use super::camera::CameraMode;
use super::crowd::{Person, Times};
use super::{CONDITIONS, Choice, GAZE_MODES};
use crate::emotion::Emotion;
use crate::scenario::GazeMode;
use egui::{Color32, Grid, RichText, Slider, Ui};
use egui_plot::{Legend, Line, Plot, PlotPoints};

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
    pub(super) choice: Choice,
    pub(super) gaze: GazeMode,
    pub(super) has_markers: bool,
    pub(super) camera: CameraMode,
    /// Whether pictures are kept with the panel.
    pub(super) shot_has_panel: bool,
    /// What was asked for since the picture before.
    pub(super) asked: Asked,
}

/// What was asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Asked {
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
    /// Pictures a second.
    pub(super) rate: f64,
    pub(super) device: &'a str,
    pub(super) simulated_on: &'a str,
    pub(super) picked: Option<&'a Person>,
    /// Where the picked person is in the picture: middle of the feet and of the head, points.
    pub(super) mark: Option<[egui::Pos2; 2]>,
    pub(super) is_filmed: bool,
    pub(super) times: &'a [Times; 2],
    pub(super) said: &'a str,
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
            plot(ui, "ms per step", &facts.times[0]);
            plot(ui, "ms per picture", &facts.times[1]);
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
    ui.label(RichText::new(facts.simulated_on).small());
    if facts.device != facts.simulated_on {
        ui.label(RichText::new(format!("drawn on {}", facts.device)).small());
    }
    // there even when nothing is said: what stands below must not jump away from the pointer
    let said = if facts.said.is_empty() { " " } else { facts.said };
    ui.add(egui::Label::new(RichText::new(said).small().strong()).truncate());
}

fn clock(ui: &mut Ui, controls: &mut Controls) {
    ui.horizontal(|ui| {
        let name = if controls.is_paused { "Go on" } else { "Pause" };
        if ui.button(name).on_hover_text("Space").clicked() {
            controls.is_paused = !controls.is_paused;
        }
        if ui.button("One step").on_hover_text("full stop").clicked() {
            controls.is_paused = true;
            controls.asked.step = true;
        }
    });
    ui.add(Slider::new(&mut controls.speed, 0.1..=8.0).logarithmic(true).text("speed"));
}

fn people(ui: &mut Ui, controls: &mut Controls) {
    let before = controls.choice.condition;
    ui.horizontal(|ui| {
        for (condition, name) in CONDITIONS {
            ui.selectable_value(&mut controls.choice.condition, condition, name);
        }
    });
    controls.asked.recast |= controls.choice.condition != before;
    ui.horizontal(|ui| {
        ui.label("gaze");
        for (mode, name) in GAZE_MODES {
            ui.selectable_value(&mut controls.gaze, mode, name);
        }
    });
    let sum: f32 = controls.choice.shares.iter().sum();
    Grid::new("shares").show(ui, |ui| {
        for emotion in Emotion::ALL {
            let share = &mut controls.choice.shares[emotion.index()];
            ui.label(emotion.name());
            let response = ui.add(Slider::new(share, 0.0..=1.0).show_value(false));
            controls.asked.recast |= response.drag_stopped() || (response.changed() && !response.dragged());
            ui.label(format!("{:.0} %", 100.0 * *share / sum.max(1e-6)));
            ui.end_row();
        }
    });
    ui.checkbox(&mut controls.has_markers, "rings in the colours of the emotions");
}

fn camera(ui: &mut Ui, controls: &mut Controls, facts: &Facts<'_>) {
    ui.horizontal(|ui| {
        for (mode, name) in CameraMode::ALL {
            ui.selectable_value(&mut controls.camera, mode, name);
        }
    });
    ui.label(RichText::new("drag: turn; right drag or WASD, Q, E: move; wheel: nearer; click: pick").small());
    ui.horizontal(|ui| {
        if ui.button("Picture").on_hover_text("F12").clicked() {
            controls.asked.shot = true;
        }
        ui.checkbox(&mut controls.shot_has_panel, "with panel");
        let name = if facts.is_filmed { "End film" } else { "Film" };
        if ui.button(name).on_hover_text("F9").clicked() {
            controls.asked.film = true;
        }
    });
}

fn person(ui: &mut Ui, controls: &mut Controls, picked: Option<&Person>) {
    let Some(person) = picked else {
        ui.label("Click somebody to see their state.");
        return;
    };
    ui.horizontal(|ui| {
        ui.label(RichText::new(format!("agent {}", person.id)).strong());
        if ui.small_button("let go").clicked() {
            controls.asked.unpick = true;
        }
    });
    let line = |ui: &mut Ui, name: &str, value: String| {
        ui.label(name);
        ui.label(value);
        ui.end_row();
    };
    Grid::new("person").num_columns(2).show(ui, |ui| {
        line(ui, "emotion", person.emotion.to_owned());
        let weights = person.weights.map(|weight| format!("{weight:.2}"));
        line(ui, "weights", weights.join("  "));
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

fn plot(ui: &mut Ui, name: &str, times: &Times) {
    let all = times.dearest();
    let sum = all.iter().fold(0.0, |sum, (_, mean, _)| sum + mean);
    egui::CollapsingHeader::new(format!("{name}: {sum:.2}")).id_salt(name).default_open(true).show(
        ui,
        |ui| {
            let frame = Plot::new(name)
                .height(130.0)
                .legend(Legend::default())
                .include_y(0.0)
                .show_x(false)
                .show_axes([false, true])
                .allow_scroll(false)
                .allow_drag(false)
                .allow_zoom(false);
            frame.show(ui, |plot| {
                for (kernel, mean, history) in all.iter().take(PLOTTED) {
                    let points: Vec<f64> = history.iter().copied().collect();
                    let label = format!("{kernel} {mean:.2}");
                    plot.line(Line::new(label, PlotPoints::from_ys_f64(&points)).id(*kernel));
                }
            });
        },
    );
}
