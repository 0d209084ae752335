// An absent agent (not yet there, or gone) stands at ABSENT on both axes and has no slot.
const ABSENT: f32 = 1e9;
const NOBODY: u32 = 0xffffffffu;

fn is_absent(position: vec2<f32>) -> bool {
    return position.x >= 0.5 * ABSENT;
}
