// People without a pose, from a distance.

// Buffer `clip_postures`: how bodies are held in a clip, [clip].
struct ClipPosture {
    lean: f32,   // rad, of the trunk forwards
    nod: f32,    // rad, of the head forwards against the trunk
    spread: f32, // rad, of the arms outwards
    swing: f32,  // rad to either side, of the arms
}

// Buffer `far_poses`: how a far body stands and holds itself, [agent].
struct FarPose {
    heading_sine: f32,
    heading_cosine: f32,
    stride: f32,    // cosine of the phase of the stride, as much as it walks
    elevation: f32, // m
    lean: f32,      // rad, as much as it walks; nod and spread likewise
    nod: f32,
    spread: f32,
    arm_swing: f32, // rad to either side, at a full walk
}
