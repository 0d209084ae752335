// Reads from the buffer `rig` (its layout stands in body.wgsl); the kernel binds it.
fn joint_translation(avatar: u32, joint: u32) -> vec3<f32> {
    return rig[avatar * RIG_STRIDE + joint * 4u].xyz;
}

// Where the model's +z points, seen from the joint at rest: a column of joint_from_mesh, not normalised.
fn joint_forward(avatar: u32, joint: u32) -> vec3<f32> {
    let at = avatar * RIG_STRIDE + joint * 4u;
    return vec3<f32>(rig[at + 1u].z, rig[at + 2u].z, rig[at + 3u].z);
}
