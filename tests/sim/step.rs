//! The order of the kernels and the barriers between them, as text, without a GPU.

use gaitway::gpu::plan::{Op, plan, text};
use gaitway::kernels::BufferId;
use gaitway::sim::order;
use gaitway::verify::cases::{animation, step};

#[test]
fn the_barriers_of_a_step_stand_where_its_kernels_meet() {
    let store = step::crowd(100, 1);
    let one = std::iter::once(Op::CountStep)
        .chain(order::step_dispatches(&store.step).into_iter().map(Op::Dispatch));
    let ops: Vec<_> = one.collect();
    let two: Vec<_> = ops.iter().chain(&ops[..2]).copied().collect();
    let want = "\
count step
lead_agents.appear
barrier
teleport
barrier
advance_journey
barrier
grid_scan
barrier
grid_scatter contents storeys+unlike+walls+user+groups
barrier
group_cohesion
barrier
react
barrier
lead_agents.steer
barrier
unjam.turns
barrier
unjam.walls
barrier
velocity_orca contents storeys+unlike+walls+user+groups
barrier
velocity_orca.again contents storeys+unlike+walls+user+groups
barrier
clip_to_walls
barrier
integrate contents storeys+unlike+walls+user+groups
barrier
elevate
barrier
measure
count step
barrier
lead_agents.appear
";
    assert_eq!(text(&plan(&two)), want);
}

#[test]
fn the_barriers_of_a_picture_stand_where_its_kernels_meet() {
    let store = animation::animation(100, 0);
    let ops: Vec<_> = std::iter::once(Op::Set(BufferId::Frame))
        .chain(order::frame_dispatches(&store.frame).into_iter().map(Op::Dispatch))
        .collect();
    let found = text(&plan(&ops));
    let lines: Vec<_> = found.lines().collect();
    let names: Vec<_> = lines.iter().filter(|line| **line != "barrier").copied().collect();
    let want = [
        "set frame",
        "cull",
        "compact.count",
        "compact.scan_visible",
        "compact.demote",
        "compact.scan_buckets",
        "compact.arguments",
        "compact.list",
        "pose",
        "feet",
        "manner",
        "idle",
        "stand",
        "gaze",
        "palette",
        "eyes",
        "skin avatar 0",
        "skin avatar 1",
    ];
    assert_eq!(names, want);
    for pair in [
        ("pose", "feet"),
        ("feet", "gaze"),
        ("gaze", "palette"),
        ("palette", "eyes"),
        ("eyes", "skin avatar 0"),
    ] {
        let at = |name| lines.iter().position(|line| *line == name);
        assert!(
            lines[at(pair.0).unwrap_or(0)..at(pair.1).unwrap_or(0)].contains(&"barrier"),
            "{pair:?}\n{found}"
        );
    }
}
