// Somebody who is not there (not yet, or no more) stands at ABSENT on both axes and has no slot.
const ABSENT = 1e9;
const NOBODY = 0xffffffffu;

fn is_absent(position: vec2<f32>) -> bool {
    return position.x >= 0.5 * ABSENT;
}
