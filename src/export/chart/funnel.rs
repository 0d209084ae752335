//! How many come to each step of a procedure, and where the others went.

use super::canvas::{Anchor, Canvas, Paint, Size, on};
use super::means::SERIES_COLORS;
use super::{Figure, MOST};

const MARGIN: f64 = 20.0;
/// Width of the bar of all, units.
const WIDTH: f64 = 360.0;
const BAR: f64 = 30.0;
/// From one bar to the next, units.
const ROW: f64 = 46.0;

/// A step.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FunnelStep {
    /// Left of the bar.
    pub name: String,
    /// How many came to it.
    pub count: usize,
    /// Where those that did not come further went, with their number.
    pub losses: Vec<(String, usize)>,
}

/// A figure of steps.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Funnel {
    /// Above the figure.
    pub title: String,
    /// From top to bottom.
    pub steps: Vec<FunnelStep>,
}

#[allow(clippy::cast_precision_loss, reason = "counts of people")]
impl Figure for Funnel {
    fn canvas(&self) -> Canvas {
        let steps = || self.steps.iter().take(MOST);
        let most = steps().map(|step| step.count).max().unwrap_or(0).max(1) as f64;
        let names = steps().map(|step| Size::Normal.width(&step.name)).fold(0.0, f64::max);
        let written = |step: &FunnelStep| {
            let losses: Vec<String> = step
                .losses
                .iter()
                .filter(|(_, count)| *count > 0)
                .map(|(name, count)| format!("{count} {name}"))
                .collect();
            if losses.is_empty() { String::new() } else { format!("less {}", losses.join(", ")) }
        };
        let losses = steps().map(|step| Size::Normal.width(&written(step))).fold(0.0, f64::max);
        let left = MARGIN + names + 12.0;
        let width = (left + WIDTH + 12.0 + losses).max(MARGIN + Size::Title.width(&self.title)) + MARGIN;
        let top = MARGIN + Canvas::line(Size::Title) + 10.0;
        let mut canvas = Canvas::new(width, top + ROW * steps().count() as f64, &self.title);
        canvas.text([MARGIN, MARGIN + 13.0], (Size::Title, Anchor::Start, Paint::Ink), &self.title);
        let color = SERIES_COLORS[0];
        for (index, step) in steps().enumerate() {
            let y = top + ROW * index as f64;
            let line = y + 0.5 * BAR + 4.0;
            let bar = WIDTH * step.count as f64 / most;
            let number = step.count.to_string();
            canvas.text([left - 12.0, line], (Size::Normal, Anchor::End, Paint::Ink), &step.name);
            canvas.rect([left, y], [bar, BAR], Paint::Fixed(color));
            let wide = Size::Normal.width(&number) + 12.0;
            let (at, paint) =
                if bar > wide { (left + 6.0, on(color)) } else { (left + bar + 6.0, Paint::Ink) };
            canvas.text([at, line], (Size::Normal, Anchor::Start, paint), &number);
            let style = (Size::Normal, Anchor::Start, Paint::Muted);
            canvas.text([left + WIDTH + 12.0, line], style, &written(step));
        }
        canvas
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_is_as_long_as_its_count_and_losses_are_named() {
        let step = |name: &str, count, losses: &[(&str, usize)]| FunnelStep {
            name: name.to_owned(),
            count,
            losses: losses.iter().map(|&(name, count)| (name.to_owned(), count)).collect(),
        };
        let steps = vec![step("arrived", 40, &[("declined", 3), ("full", 0)]), step("placed", 10, &[])];
        let svg = Funnel { title: "t".to_owned(), steps }.svg();
        assert!(
            svg.contains(&format!("width=\"{WIDTH:.1}\""))
                && svg.contains(&format!("width=\"{:.1}\"", WIDTH / 4.0))
        );
        assert!(svg.contains(">less 3 declined<") && !svg.contains("full"));
    }
}
