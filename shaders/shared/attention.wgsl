// When an agent looks at the user: what `gaze` and `gaze_schedule` agree on.
const HAPPY: u32 = 0u; // emotions, by number
const ANGRY: u32 = 1u;
const SAD: u32 = 2u;

const RANGE: f32 = 8.0;                   // m, spec 1.8 r_gaze
const RANGE_HYSTERESIS: f32 = 0.5;        // m, ours
const HALF_FIELD: f32 = 1.5707964;        // 90 degrees, spec 1.8 fov / 2
const FIELD_HYSTERESIS: f32 = 0.17453293; // 10 degrees, spec 1.8
const FIELD_END: f32 = -0.17364818;       // cosine of the two together

// bits of gaze_frame
const ATTENDS: u32 = 0x20000000u; // it is the agent's turn; `gaze_schedule` writes it
const VALID: u32 = 0x40000000u;   // there was an update; `gaze` writes it
const ENGAGED: u32 = 0x80000000u; // the agent looked at the user then; `gaze` writes it

const NATURAL: u32 = 0u; // of gaze_mode
