//! The picture of a panel, drawn by the host: letters by cosmic-text in the one embedded font.

use super::{Area, Choice, HEIGHT, Panel, WIDTH};
use crate::picture::Image;
use cosmic_text::{
    Align, Attrs, Buffer, Color, Family, FontSystem, Metrics, Shaping, SwashCache, Weight, fontdb,
};

/// Columns and rows of the mark that shows what a laser points at; it stands below the panel in the same picture.
pub(in super::super) const MARK: u32 = 48;
/// Rows of a picture: the panel, and the mark.
pub(in super::super) const ROWS: u32 = HEIGHT + MARK;

const GROUND: [u8; 4] = [28, 32, 40, 255];
const RIM: [u8; 4] = [90, 98, 112, 255];
const CELL: [u8; 4] = [52, 59, 72, 255];
/// What a laser or a stick is at, and how far a look has come.
const FOCUS: [u8; 4] = [64, 110, 190, 255];
const DWELT: [u8; 4] = [120, 190, 255, 255];
const CHOSEN: [u8; 4] = [230, 190, 80, 255];
const LETTERS: Color = Color::rgb(240, 242, 246);
const QUIET: Color = Color::rgb(180, 188, 200);
/// Width of frames, pixels.
const FRAME: f32 = 6.0;
/// Space about the text of a cell.
const SPACE: f32 = 10.0;

/// What a panel shows of the answer so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(in super::super) struct Marks {
    /// What would be chosen.
    pub(in super::super) focus: Option<Choice>,
    /// How far a look at it has come, of [`STEPS`].
    pub(in super::super) dwelt: u32,
    /// The cell that is chosen.
    pub(in super::super) chosen: Option<Choice>,
}

/// Steps in which a look is shown.
pub(in super::super) const STEPS: u32 = 10;

/// Draws panels; keeps the font.
pub(in super::super) struct Lettering {
    fonts: FontSystem,
    cache: SwashCache,
}

impl std::fmt::Debug for Lettering {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Lettering").finish_non_exhaustive()
    }
}

impl Default for Lettering {
    /// Nothing of the system: Ubuntu Light alone, which has Latin, Greek and Cyrillic letters.
    fn default() -> Self {
        let mut fonts = fontdb::Database::new();
        fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
        let fonts = FontSystem::new_with_locale_and_db("en".to_owned(), fonts);
        Self { fonts, cache: SwashCache::new() }
    }
}

impl Lettering {
    /// The picture of a panel without what its answer so far adds, and the mark below it.
    pub(in super::super) fn panel(&mut self, panel: &Panel) -> Image {
        let mut image = Image::filled(WIDTH, ROWS, GROUND);
        frame(&mut image, Area::new(0.0, 0.0, side(WIDTH), side(HEIGHT)), RIM, FRAME);
        image.fill(0, HEIGHT, WIDTH, MARK, [0; 4]);
        mark(&mut image);
        let targets = panel.targets();
        let question_ends = targets.iter().map(|(_, area)| area.top).fold(side(HEIGHT) - 40.0, f32::min);
        self.text(&mut image, Area::new(60.0, 24.0, 1180.0, 56.0), &panel.title, [34.0, 26.0], QUIET);
        let question = Area::new(60.0, 90.0, 1180.0, question_ends - 110.0);
        self.text(&mut image, question, &panel.question, [52.0, 24.0], LETTERS);
        for (choice, area) in &targets {
            let inner = area.inner(SPACE);
            fill(&mut image, inner, CELL);
            frame(&mut image, inner, RIM, 2.0);
            self.text(&mut image, inner.inner(SPACE), panel.label(*choice), [46.0, 20.0], LETTERS);
        }
        self.ends(&mut image, panel, &targets);
        image
    }

    /// The words below the first and the last cell.
    fn ends(&mut self, image: &mut Image, panel: &Panel, targets: &[(Choice, Area)]) {
        let cells = targets.iter().filter(|(choice, _)| matches!(choice, Choice::Cell(_)));
        let areas: Vec<Area> = cells.map(|(_, area)| *area).collect();
        let (Some(first), Some(last)) = (areas.first(), areas.last()) else { return };
        let lowest = last.top + last.height;
        let room = (super::BUTTONS - lowest).clamp(0.0, 110.0);
        let wide = (0.45 * side(WIDTH)).min(520.0);
        let left = Area::new(first.left + SPACE, lowest, wide, room);
        let right = Area::new(last.left + last.width - SPACE - wide, lowest, wide, room);
        let [one, other] = &panel.ends;
        self.aligned(image, left, one, [34.0, 20.0], QUIET, Align::Left);
        self.aligned(image, right, other, [34.0, 20.0], QUIET, Align::Right);
    }

    fn text(&mut self, image: &mut Image, area: Area, text: &str, sizes: [f32; 2], color: Color) {
        self.aligned(image, area, text, sizes, color, Align::Center);
    }

    /// Text in the middle of an area: in the largest size, of two, at which it fits, or all that fits in the smaller one.
    fn aligned(
        &mut self,
        image: &mut Image,
        area: Area,
        text: &str,
        [largest, least]: [f32; 2],
        color: Color,
        align: Align,
    ) {
        if text.is_empty() || area.width < 1.0 || area.height < 1.0 {
            return;
        }
        let attributes = Attrs::new().family(Family::Name("Ubuntu")).weight(Weight::LIGHT);
        let mut size = largest;
        let (mut buffer, high) = loop {
            let mut buffer = Buffer::new(&mut self.fonts, Metrics::new(size, 1.2 * size));
            buffer.set_size(Some(area.width), None);
            buffer.set_text(text, &attributes, Shaping::Advanced, Some(align));
            buffer.shape_until_scroll(&mut self.fonts, false);
            let (high, wide) = buffer.layout_runs().fold((0.0_f32, 0.0_f32), |(high, wide), run| {
                (high.max(run.line_top + run.line_height), wide.max(run.line_w))
            });
            // a word is broken only where no size has room for it
            let words = text.split_whitespace().count() + text.lines().count();
            let is_broken = buffer.layout_runs().count() > words;
            if (high <= area.height && wide <= area.width && !is_broken) || size <= least {
                break (buffer, high);
            }
            size = (size - 2.0).max(least);
        };
        let down = area.top + 0.5 * (area.height - high).max(0.0);
        buffer.draw(&mut self.fonts, &mut self.cache, color, |x, y, width, height, color| {
            for (dx, dy) in (0..height).flat_map(|dy| (0..width).map(move |dx| (dx, dy))) {
                let (x, y) = (x.saturating_add_unsigned(dx), y.saturating_add_unsigned(dy));
                let at = [whole(area.left).checked_add_signed(x), whole(down).checked_add_signed(y)];
                if let [Some(x), Some(y)] = at
                    && area.holds([side(x), side(y)])
                {
                    blend(image, x, y, color);
                }
            }
        });
    }
}

/// A picture of a panel with what its answer so far adds.
pub(in super::super) fn marked(plain: &Image, panel: &Panel, marks: &Marks) -> Image {
    let mut image = plain.clone();
    for (choice, area) in panel.targets() {
        let inner = area.inner(SPACE);
        if marks.chosen == Some(choice) {
            frame(&mut image, inner, CHOSEN, FRAME);
        }
        if marks.focus == Some(choice) {
            frame(&mut image, area.inner(1.0), FOCUS, FRAME + 2.0);
            #[allow(clippy::cast_precision_loss, reason = "at most ten")]
            let share = marks.dwelt.min(STEPS) as f32 / STEPS as f32;
            let bar = Area::new(inner.left, inner.top + inner.height - 14.0, inner.width * share, 14.0);
            fill(&mut image, bar, DWELT);
        }
    }
    image
}

#[allow(clippy::cast_precision_loss, reason = "a thousand pixels")]
const fn side(pixels: u32) -> f32 {
    pixels as f32
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place on the panel")]
fn whole(pixels: f32) -> u32 {
    pixels.max(0.0).round() as u32
}

fn fill(image: &mut Image, area: Area, color: [u8; 4]) {
    let [left, top] = [area.left, area.top].map(whole);
    let [right, bottom] = [area.left + area.width, area.top + area.height].map(whole);
    image.fill(left, top, right.saturating_sub(left), bottom.saturating_sub(top), color);
}

/// A frame of so many pixels, inside of an area.
fn frame(image: &mut Image, area: Area, color: [u8; 4], wide: f32) {
    let Area { left, top, width, height } = area;
    for part in [
        Area::new(left, top, width, wide),
        Area::new(left, top + height - wide, width, wide),
        Area::new(left, top, wide, height),
        Area::new(left + width - wide, top, wide, height),
    ] {
        fill(image, part, color);
    }
}

/// A light disc with a dark rim: what a laser points at.
fn mark(image: &mut Image) {
    let middle = 0.5 * side(MARK);
    for (x, y) in (0..MARK).flat_map(|y| (0..MARK).map(move |x| (x, y))) {
        let away = (side(x) + 0.5 - middle).hypot(side(y) + 0.5 - middle);
        let color = if away < 0.55 * middle { [250, 250, 250, 255] } else { [20, 24, 32, 255] };
        if away < 0.9 * middle {
            image.set(x, HEIGHT + y, color);
        }
    }
}

#[allow(clippy::cast_possible_truncation, reason = "a mean of two bytes")]
fn blend(image: &mut Image, x: u32, y: u32, color: Color) {
    let Some(under) = image.pixel(x, y) else { return };
    let alpha = u32::from(color.a());
    let mix =
        |over: u8, under: u8| ((u32::from(over) * alpha + u32::from(under) * (255 - alpha)) / 255) as u8;
    let [r, g, b, a] = under;
    image.set(x, y, [mix(color.r(), r), mix(color.g(), g), mix(color.b(), b), a]);
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;

    /// How many pixels of an area are lighter than grounds and frames.
    fn letters(image: &Image, area: Area) -> usize {
        let (left, top) = (whole(area.left), whole(area.top));
        let places = (0..whole(area.height)).flat_map(|y| (0..whole(area.width)).map(move |x| (x, y)));
        places
            .filter(|(x, y)| image.pixel(left + x, top + y).is_some_and(|p| p[1] > 150 && p[0] > 140))
            .count()
    }

    pub(super) fn likert() -> Panel {
        Panel {
            title: "Crossing · 3 of 5".to_owned(),
            question: "The people seemed to notice me, and to differ in what they felt".to_owned(),
            cells: (1..=7).map(|cell| cell.to_string()).collect(),
            ends: ["disagree strongly".to_owned(), "agree strongly".to_owned()],
            chosen: None,
            back: Some("Back".to_owned()),
            next: Some("Next".to_owned()),
        }
    }

    #[test]
    fn every_text_of_a_panel_is_drawn_where_it_belongs_and_nothing_else_is() {
        let panel = likert();
        let mut lettering = Lettering::default();
        let image = lettering.panel(&panel);
        assert_eq!([image.width, image.height], [WIDTH, ROWS]);
        for (choice, area) in panel.targets() {
            assert!(letters(&image, area) > 60, "{choice:?}: {}", letters(&image, area));
            let bare = Panel {
                cells: vec![String::new(); 7],
                back: Some(String::new()),
                next: Some(String::new()),
                ..panel.clone()
            };
            let bare = lettering.panel(&bare);
            assert_eq!(letters(&bare, area), 0, "{choice:?}");
        }
        assert!(letters(&image, Area::new(60.0, 90.0, 1180.0, 250.0)) > 2000);
        let below = Area::new(20.0, 645.0, 500.0, 100.0);
        assert!(letters(&image, below) > 300 && letters(&image, Area::new(560.0, 645.0, 180.0, 100.0)) == 0);
    }

    #[test]
    fn long_texts_become_smaller_and_stay_within_their_cells() {
        let words = "neither agree nor disagree, or rather undecided about it";
        let panel = Panel { cells: vec![words.to_owned(); 21], question: "word ".repeat(80), ..likert() };
        panel.check().unwrap();
        let image = Lettering::default().panel(&panel);
        for (choice, area) in panel.targets() {
            let (all, inner) = (letters(&image, area), letters(&image, area.inner(SPACE + 2.0)));
            assert!(all > 60 && all == inner, "{choice:?}: {all} {inner}");
        }
    }

    #[test]
    fn the_answer_so_far_is_seen_at_its_cell_alone() {
        let panel = likert();
        let plain = Lettering::default().panel(&panel);
        let changed = |marks: Marks, choice: Choice| {
            let image = marked(&plain, &panel, &marks);
            let (mut inside, mut outside) = (0, 0);
            let area = panel.targets().into_iter().find(|(one, _)| *one == choice).unwrap().1;
            for (x, y) in (0..ROWS).flat_map(|y| (0..WIDTH).map(move |x| (x, y))) {
                if image.pixel(x, y) != plain.pixel(x, y) {
                    *(if area.holds([side(x), side(y)]) { &mut inside } else { &mut outside }) += 1;
                }
            }
            (inside, outside)
        };
        let three = Choice::Cell(3);
        let (focus, outside) = changed(Marks { focus: Some(three), ..Marks::default() }, three);
        assert!(focus > 2000 && outside == 0, "{focus} {outside}");
        let (dwelt, _) = changed(Marks { focus: Some(three), dwelt: 5, ..Marks::default() }, three);
        assert!(dwelt > focus + 500, "{dwelt}");
        let (chosen, outside) =
            changed(Marks { chosen: Some(Choice::Next), ..Marks::default() }, Choice::Next);
        assert!(chosen > 2000 && outside == 0, "{chosen} {outside}");
        assert_eq!(marked(&plain, &panel, &Marks::default()), plain);
    }

    #[test]
    fn the_mark_is_a_disc_below_the_panel() {
        let image = Lettering::default().panel(&likert());
        assert_eq!(image.pixel(MARK / 2, HEIGHT + MARK / 2), Some([250, 250, 250, 255]));
        assert_eq!(image.pixel(0, HEIGHT), Some([0; 4]));
        assert_eq!(image.pixel(MARK + 1, HEIGHT + MARK / 2), Some([0; 4]));
    }
}
