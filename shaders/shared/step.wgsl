// An agent of this priority is led from outside: it takes its preferred velocity whatever stands in its way.
const LED: f32 = 2.0;
// The right of way raises an agent's priority by this much for a while (its own priority is 1 at most).
const RAISE: f32 = 1.5;
// Beside the neighbour cap in slot_motion: is led from outside.
const LED_BIT: u32 = 256u;
// Above it there: one more than the first member of the group that the agent walks with (group_cohesion); 0: it walks alone.
const GROUP_SHIFT: u32 = 9u;

// Parameters of one simulation step; the Rust twin is kernels::layout::StepUniforms. SI units, ground plane (x, z).
struct StepUniforms {
    step_index: u32,             // first: on a device the buffer step_count is this word
    agent_count: u32,
    seed: u32,
    cell_count: u32,             // columns * rows
    grid_columns: u32,
    grid_rows: u32,
    grid_origin: vec2<f32>,      // corner of cell 0, m
    cell_size: f32,              // m
    inverse_cell_size: f32,      // 1/m
    time_step: f32,              // s
    inverse_time_step: f32,      // 1/s
    storey_height: f32,          // m: an agent this much higher or lower is not a neighbour
    inverse_time_horizon_obstacles: f32, // 1/s
    user_position: vec2<f32>,    // m
    user_velocity: vec2<f32>,    // m/s
    user_radius: f32,            // m; 0 when there is no user to avoid
    obstacle_count: u32,         // obstacle segments
    turn_rate: f32,              // rad/s
    perturbation: f32,           // m/s added to the preferred velocity at random, to break symmetry
    walk_speed: f32,             // below this share of the preferred speed the body blends to standing
    blend_rate: f32,             // 1/s, how fast it does
    time_horizon_obstacles: f32, // s
    responsibility: f32,         // share of the avoidance an agent takes towards another: 0.5
    safety_margin: f32,          // m added to the summed radii while avoiding
    inverse_time_horizon_dense: f32, // 1/s: the horizon tried when not all lines can be kept; 0: none
    inverse_time_horizon_jam: f32,   // 1/s: the horizon tried after that by an agent that hardly moves; 0: none
    model: u32,                  // velocity kernel: 0 ORCA, 1 RVO
    collision_weight: f32,       // m, of RVO: what a time to collision of 1 s costs
    max_acceleration: f32,       // m/s2, of RVO
    patience: f32,               // time without progress before `unjam` acts, s; 0: never
    source_count: u32,           // sources of people
    queue_count: u32,            // queues
    wrap: f32,                   // m: side of a square from the origin whose opposite sides are joined; 0: none
    led_count: u32,              // agents led from outside
    crowding: f32,               // 0 to 1, how much people ahead slow an agent down
    crowding_reach: f32,         // m ahead over which their density is measured
    group_count: u32,            // walking groups
    floor_count: u32,            // floors above the ground
    reaction_steps: u32,         // first step by which every agent has reacted
    feels: u32,                  // 1: feelings change
    path_count: u32,             // agents led on a path
    teleport_count: u32,         // boxes from which agents move to other boxes
    alike: u32,                  // 1: all agents have the avoidance of agent 0
    user_elevation: f32,         // m: height of the floor that the user stands on
    widest_radius: f32,          // m: of any agent
    measured: u32,               // 1: steps are measured
    fastest: f32,                // m/s: no agent is faster
    bare: u32,                   // 1: agents have no bodies, neither headings nor stances
    unused: u32,
}
