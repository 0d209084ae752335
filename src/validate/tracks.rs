//! Where people were, frame by frame: recorded from a simulation or read from a file.

use glam::Vec2;

/// Positions of people at equal times.
#[derive(Debug, Clone, PartialEq)]
pub struct Tracks {
    /// Frames a second.
    pub rate: f64,
    /// `[frame]` id and position, m, of every person present, in rising order of ids.
    pub frames: Vec<Vec<(u32, Vec2)>>,
}

impl Tracks {
    /// Nothing yet.
    pub const fn new(rate: f64) -> Self {
        Self { rate, frames: Vec::new() }
    }

    /// Adds a frame; the number of a person is its place in the list.
    #[allow(clippy::cast_possible_truncation, reason = "thousands of people")]
    pub fn push(&mut self, positions: &[Option<Vec2>]) {
        let there = positions.iter().enumerate().filter_map(|(who, at)| at.map(|at| (who as u32, at)));
        self.frames.push(there.collect());
    }

    /// Position of a person in a frame, m.
    pub fn at(&self, frame: usize, who: u32) -> Option<Vec2> {
        let people = self.frames.get(frame)?;
        people.binary_search_by_key(&who, |person| person.0).ok().map(|place| people[place].1)
    }

    /// Velocity of a person in a frame, m/s, by the positions `half` seconds before and after, or as near to that as there
    /// are frames.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "a few frames"
    )]
    pub fn velocity(&self, frame: usize, who: u32, half: f64) -> Option<Vec2> {
        let reach = (half * self.rate).round().max(1.0) as usize;
        let find = |mut candidates: Box<dyn Iterator<Item = usize> + '_>| {
            candidates.find_map(|other| self.at(other, who).map(|at| (other, at)))
        };
        let first = find(Box::new(frame.saturating_sub(reach)..=frame))?;
        let last = find(Box::new((frame..=frame + reach).rev()))?;
        (last.0 > first.0).then(|| (last.1 - first.1) * (self.rate / (last.0 - first.0) as f64) as f32)
    }
}
