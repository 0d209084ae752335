// Highest step that an agent climbs at once, m. What is farther above or below is not on the same floor.
const STEP: f32 = 0.6;
