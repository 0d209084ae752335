// How bodies lie in the flat buffers. Joints by number as in gait::skeleton::Joint.
const JOINTS: u32 = 16u;
const ROOT: u32 = 0u;
const SPINE: u32 = 1u;
const NECK: u32 = 2u;
const HEAD: u32 = 3u;
const LEFT_SHOULDER: u32 = 4u;
const LEFT_HAND: u32 = 6u;
const RIGHT_SHOULDER: u32 = 7u;
const RIGHT_HAND: u32 = 9u;
const LEFT_HIP: u32 = 10u;
const LEFT_FOOT: u32 = 12u;
const RIGHT_HIP: u32 = 13u;
const RIGHT_FOOT: u32 = 15u;

// clip_frames: [clip][CLIP_ROWS][POSE_STRIDE] and local_rotations: [visible][POSE_STRIDE]: 16 local rotations
// (parent_from_joint), then the root joint's position in model space (before the agent's scale), m; last, of a clip, how
// far a stride goes, m, and of a pose its stride over the one of its gaits. The last row of a clip is the mean of its frames.
const POSE_STRIDE: u32 = 17u;
const CLIP_FRAMES: u32 = 64u;
const CLIP_ROWS: u32 = 65u;

// rig: [avatar][RIG_STRIDE]: per joint its rest translation in the parent, then three rows of joint_from_mesh;
// then the midpoint of the eyes in the head joint; where the toes bend, left and right, in the mesh, and how long they are;
// the centre of the left eyeball in the mesh, whose mirror image is the right one, and 1 where eyes turn, else 0; last, per
// joint, its place in the mesh and, per joint, the direction of its bone there
const RIG_STRIDE: u32 = 100u;
const RIG_EYES: u32 = 64u;
const RIG_BALLS: u32 = 65u;
const RIG_EYEBALL: u32 = 67u;
const RIG_PLACES: u32 = 68u;
const RIG_BONES: u32 = 84u;

// palettes: [visible][SKIN_JOINTS][3], rows of world_from_mesh. No gait moves the toes, left and right, nor the waist, which is
// half way between root and spine: kernel palette does.
// Nor does any move the eyes and the upper lids: kernel eyes does, for agents that are drawn by a mesh that has them
const LEFT_TOES: u32 = 16u;
const RIGHT_TOES: u32 = 17u;
const WAIST: u32 = 18u;
const LEFT_EYE: u32 = 19u;
const RIGHT_EYE: u32 = 20u;
const LIDS: u32 = 21u;
const SKIN_JOINTS: u32 = 22u;
const PALETTE_STRIDE: u32 = 66u;

// mesh_vertices: [vertex][VERTEX_STRIDE]: position and material; normal and four joints of eight bits;
// weights; linear colour
const VERTEX_STRIDE: u32 = 4u;

// Above these bits of a vertex's material is its number in face_moves, counted from 1; 0: no expression moves it.
const MATERIAL_BITS: u32 = 8u;

// face_moves: [face vertex][FACE_STRIDE]: how far it goes in the mesh when a number of the face is 1, m: inner brow, outer brow;
// mouth corners up, down (for 1 below 0); mouth open, pressed (likewise); fist, and how its normal changes with that, 1; blink.
// Upper lids, and blinks of the generated bodies, turn the joint LIDS instead.
const FACE_STRIDE: u32 = 9u;
const INNER_BROW: u32 = 0u;
const OUTER_BROW: u32 = 1u;
const CORNERS_UP: u32 = 2u;
const CORNERS_DOWN: u32 = 3u;
const OPENED: u32 = 4u;
const PRESSED: u32 = 5u;
const FIST: u32 = 6u;
const FIST_NORMAL: u32 = 7u;
const EYES_SHUT: u32 = 8u;

// Buffer `expressions`, [visible]: face and hands of an agent that is drawn by a finest mesh. 0 is at rest, 1 as far as actors go.
struct Expression {
    inner_brow: f32,   // height of the brows' inner ends, -1 to 1
    outer_brow: f32,   // of their outer ends
    upper_lid: f32,    // how far the eyes open, -1 to 1
    mouth_corner: f32, // height of the mouth's corners, -1 to 1
    mouth_open: f32,   // 1 open, -1 with lips pressed together
    blink: f32,        // how far the eyes are shut, 0 to 1, whatever the lids do otherwise
    fist: f32,         // how far the hands are clenched, 0 to 1
    unused: f32,
}

// Ends the posed agents of the list `visible`; in agent_bucket: not drawn.
const NONE: u32 = 0xffffffffu;

// Buffer `mesh_table`: where the mesh of a bucket lies, [bucket].
struct MeshRange {
    first_index: u32,
    index_count: u32,
    first_vertex: u32,
    vertex_count: u32,
}
