// What there is in a crowd, as flags, for the kernels of a step: what there is not costs nothing then. (An
// immediate, not a uniform, since drivers know that all invocations agree about it.)
var<immediate> contents: u32;

const STOREYS: u32 = 1u; // people walk above one another
const UNLIKE: u32 = 2u;  // avoidance differs between people
const WALLS: u32 = 4u;
const USER: u32 = 8u;
const CROWDED: u32 = 16u; // agents slow down for a crowd ahead
const GROUPS: u32 = 32u;  // some walk together
const BARE: u32 = 64u;    // agents have no bodies, which turn and walk on feet
