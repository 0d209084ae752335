//! The people of a crowd as they are now, by name instead of by buffer.

use super::Simulation;
use crate::emotion::Emotion;
use crate::ground::is_absent;
use crate::kernels::Store;
use glam::Vec2;

/// A person in the crowd at present.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Person {
    /// Number of the agent, the same for the whole run.
    pub id: u32,
    /// Ground position (x, z), m.
    pub position: Vec2,
    /// Height of the floor stood on, m.
    pub elevation: f32,
    /// Velocity (x, z), m/s.
    pub velocity: Vec2,
    /// Heading about +y, radians; 0 faces +z.
    pub heading: f32,
    /// Weights of the emotions, in the order of [`Emotion::ALL`]; their sum is 1.
    pub emotions: [f32; 4],
}

impl Person {
    /// The emotion of the largest weight; of two alike the first.
    pub fn emotion(&self) -> Emotion {
        Emotion::strongest(self.emotions)
    }

    /// An agent of a crowd, unless it is not there.
    pub(crate) fn of(store: &Store, emotions: &[[f32; 4]], id: u32) -> Option<Self> {
        let i = id as usize;
        let position = *store.position.get(i).filter(|_| id < store.step.agent_count)?;
        if is_absent(position) {
            return None;
        }
        let felt = if store.step.feels > 0 { store.feeling.get(i) } else { emotions.get(i) };
        Some(Self {
            id,
            position: Vec2::from_array(position),
            elevation: store.elevation.get(i).copied().unwrap_or(0.0),
            velocity: Vec2::from_array(*store.velocity.get(i)?),
            heading: *store.heading.get(i)?,
            emotions: felt.copied().unwrap_or(Emotion::Neutral.weights()),
        })
    }
}

impl Simulation {
    /// All people present now, by ascending number. People who have not entered yet, or have left, are not among them. On a
    /// Vulkan device this reads the state back first.
    ///
    /// # Errors
    /// When the device fails.
    pub fn people(&mut self) -> Result<impl Iterator<Item = Person> + '_, crate::Error> {
        self.state()?;
        let (store, emotions) = (&self.store, &self.emotions);
        Ok((0..store.step.agent_count).filter_map(|id| Person::of(store, emotions, id)))
    }

    /// One agent as it is now; none where there is no such agent, or it is not there now.
    ///
    /// # Errors
    /// As [`Self::people`].
    pub fn person(&mut self, id: u32) -> Result<Option<Person>, crate::Error> {
        self.state()?;
        Ok(Person::of(&self.store, &self.emotions, id))
    }

    /// How many agents there are, whether they are there now or not.
    pub fn agent_count(&self) -> u32 {
        self.store.step.agent_count
    }
}
