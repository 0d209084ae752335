// Whether two agents are on the same storey; twin: reference::shared. Needs the binding step.
fn on_storey(elevation: f32, other: f32) -> bool {
    return step.storey_height <= 0.0 || abs(elevation - other) < step.storey_height;
}
