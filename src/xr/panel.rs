//! A question on a panel that stands in the user's room: plain data, and where on it what can be chosen is.
//!
//! A pixel of the panel is a millimetre of it, [`WIDTH`] by [`HEIGHT`] in all. The panel stands [`place::DISTANCE`] before
//! the user. A cell of a row of seven is at least 6 degrees wide from there, at the row's ends too.

pub(super) mod layer;
pub(super) mod picture;
pub(super) mod place;

/// Pixels of the panel, a millimetre each: columns and rows.
pub(super) const WIDTH: u32 = 1300;
pub(super) const HEIGHT: u32 = 960;
/// Most cells in a row, and rows.
const COLUMNS: usize = 7;
const ROWS: usize = 3;
/// Most cells of a panel.
pub const MOST_CELLS: usize = COLUMNS * ROWS;
/// Most characters of a text on a panel.
pub const MOST_CHARACTERS: usize = 400;
/// From one cell of a full row to the next, pixels. A row of fewer cells has wider ones.
const PITCH: f32 = 180.0;
const WIDEST_PITCH: f32 = 300.0;
/// Height of a row of cells, and of the buttons below, pixels.
const ROW: f32 = 170.0;
const BUTTON: f32 = 120.0;
/// Where the middle row of cells is, and the top of the buttons, pixels from the top.
const MIDDLE: f32 = 555.0;
const BUTTONS: f32 = 825.0;

/// A question on a panel. Without cells and buttons it is a text that nothing answers.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Panel {
    /// A line above the question, such as how far the user is.
    pub title: String,
    /// The question, the statement, or a text to read.
    pub question: String,
    /// What can be chosen, in reading order: at most [`MOST_CELLS`], seven a row.
    pub cells: Vec<String>,
    /// What the first and the last cell mean, below them.
    pub ends: [String; 2],
    /// The cell that was chosen before.
    pub chosen: Option<usize>,
    /// The button that leads back, by its label.
    pub back: Option<String>,
    /// The button that leads on, by its label.
    pub next: Option<String>,
}

/// What can be chosen on a panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Choice {
    /// A cell, by its number from 0.
    Cell(usize),
    /// The button that leads back.
    Back,
    /// The button that leads on.
    Next,
}

/// A panel that cannot be shown.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PanelError {
    /// Too many cells.
    #[error("{found} cells; a panel has room for {MOST_CELLS}")]
    Cells {
        /// How many there are.
        found: usize,
    },
    /// A text is too long.
    #[error("{what} has {found} characters; there is room for {MOST_CHARACTERS}")]
    Text {
        /// Which text.
        what: &'static str,
        /// Its characters.
        found: usize,
    },
    /// The chosen cell is not there.
    #[error("cell {chosen} is chosen of {cells}")]
    Chosen {
        /// The cell.
        chosen: usize,
        /// How many there are.
        cells: usize,
    },
}

/// A part of the panel, pixels from its upper left corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    pub(super) left: f32,
    pub(super) top: f32,
    pub(super) width: f32,
    pub(super) height: f32,
}

impl Area {
    pub(super) const fn new(left: f32, top: f32, width: f32, height: f32) -> Self {
        Self { left, top, width, height }
    }

    fn holds(&self, [x, y]: [f32; 2]) -> bool {
        (self.left..self.left + self.width).contains(&x) && (self.top..self.top + self.height).contains(&y)
    }

    /// The area without a rim.
    pub(super) fn inner(&self, rim: f32) -> Self {
        Self::new(self.left + rim, self.top + rim, self.width - 2.0 * rim, self.height - 2.0 * rim)
    }
}

impl Panel {
    /// Whether it can be shown.
    ///
    /// # Errors
    /// What cannot.
    pub fn check(&self) -> Result<(), PanelError> {
        let cells = self.cells.len();
        if cells > MOST_CELLS {
            return Err(PanelError::Cells { found: cells });
        }
        if let Some(chosen) = self.chosen.filter(|chosen| *chosen >= cells) {
            return Err(PanelError::Chosen { chosen, cells });
        }
        let named = [("the title", &self.title), ("the question", &self.question)];
        let cells = self.cells.iter().map(|cell| ("a cell", cell));
        let others = self.ends.iter().chain(&self.back).chain(&self.next).map(|text| ("a label", text));
        for (what, text) in named.into_iter().chain(cells).chain(others) {
            let found = text.chars().count();
            if found > MOST_CHARACTERS {
                return Err(PanelError::Text { what, found });
            }
        }
        Ok(())
    }

    /// Everything that can be chosen, in the order in which a stick goes through it, and where it is.
    pub(super) fn targets(&self) -> Vec<(Choice, Area)> {
        let (columns, pitch) = self.grid();
        let rows = self.cells.len().div_ceil(columns);
        #[allow(clippy::cast_precision_loss, reason = "a handful")]
        let cell = |number: usize| {
            let (row, column) = ((number / columns) as f32, (number % columns) as f32);
            let left = 0.5 * (WIDTH as f32 - pitch * columns as f32) + pitch * column;
            Area::new(left, MIDDLE + ROW * (row - 0.5 * rows as f32), pitch, ROW)
        };
        let cells = (0..self.cells.len()).map(|number| (Choice::Cell(number), cell(number)));
        let buttons = [(Choice::Back, &self.back, 60.0), (Choice::Next, &self.next, 880.0)];
        let buttons = buttons.into_iter().filter(|(_, label, _)| label.is_some());
        cells
            .chain(buttons.map(|(choice, _, left)| (choice, Area::new(left, BUTTONS, 360.0, BUTTON))))
            .collect()
    }

    /// Columns of the cells, and pixels from one to the next.
    fn grid(&self) -> (usize, f32) {
        let columns = self.cells.len().clamp(1, COLUMNS);
        #[allow(clippy::cast_precision_loss, reason = "at most seven")]
        let wide = PITCH * COLUMNS as f32 / columns as f32;
        (columns, wide.min(WIDEST_PITCH))
    }

    /// What can be chosen at a place of the panel, pixels.
    pub(super) fn at(&self, place: [f32; 2]) -> Option<Choice> {
        self.targets().into_iter().find(|(_, area)| area.holds(place)).map(|(choice, _)| choice)
    }

    /// The words of what can be chosen.
    pub(super) fn label(&self, choice: Choice) -> &str {
        match choice {
            Choice::Cell(cell) => self.cells.get(cell).map_or("", String::as_str),
            Choice::Back => self.back.as_deref().unwrap_or_default(),
            Choice::Next => self.next.as_deref().unwrap_or_default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn likert(cells: usize) -> Panel {
        let cells = (1..=cells).map(|cell| cell.to_string()).collect();
        Panel { cells, back: Some("Back".into()), next: Some("Next".into()), ..Panel::default() }
    }

    #[test]
    fn seven_cells_are_six_degrees_wide_each_and_everything_has_room_of_its_own() {
        for cells in [0, 1, 2, 5, 7, 8, 11, 21] {
            let targets = likert(cells).targets();
            assert_eq!(targets.len(), cells + 2);
            for (number, (choice, area)) in targets.iter().enumerate() {
                assert!(area.left >= 0.0 && area.left + area.width <= WIDTH as f32, "{choice:?}");
                assert!(area.top >= 250.0 && area.top + area.height <= HEIGHT as f32, "{choice:?}");
                let angle = |x: f32| ((x - 0.5 * WIDTH as f32) / (1e3 * place::DISTANCE)).atan().to_degrees();
                let wide = angle(area.left + area.width) - angle(area.left);
                assert!(wide >= 6.0, "{choice:?}: {wide} degrees");
                let middle = [area.left + 0.5 * area.width, area.top + 0.5 * area.height];
                assert_eq!(likert(cells).at(middle), Some(*choice));
                for (other, them) in &targets[number + 1..] {
                    let is_beside = them.left >= area.left + area.width - 0.01
                        || them.top >= area.top + area.height - 0.01;
                    assert!(is_beside, "{choice:?} and {other:?}");
                }
            }
        }
        assert_eq!(likert(7).at([5.0, 5.0]), None);
        let only = Panel { next: None, back: None, ..likert(7) };
        assert_eq!(only.targets().len(), 7);
    }

    #[test]
    fn what_has_no_room_is_refused_with_the_bound() {
        let refused = |panel: Panel| panel.check().map_err(|error| error.to_string());
        assert_eq!(likert(21).check(), Ok(()));
        assert_eq!(refused(likert(22)), Err("22 cells; a panel has room for 21".into()));
        assert_eq!(Panel::default().check(), Ok(()));
        let chosen = Panel { chosen: Some(7), ..likert(7) };
        assert_eq!(refused(chosen), Err("cell 7 is chosen of 7".into()));
        let long = Panel { question: "ä".repeat(401), ..likert(7) };
        assert_eq!(refused(long), Err("the question has 401 characters; there is room for 400".into()));
        assert_eq!(Panel { question: "ä".repeat(400), ..likert(7) }.check(), Ok(()));
    }
}
