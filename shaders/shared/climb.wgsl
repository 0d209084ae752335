// m: nobody climbs more at once, so what is this much higher or lower is not on the same floor.
const STEP: f32 = 0.6;
