// uses: step, agent, mood
// What people show of how they feel: the weights of their gaits (one per emotion), with them the preferred and the
// maximum speed and the travel per stride, so that feet do not slide, and the emotion that decides the gaze, which
// changes only when another is stronger by a margin.
const MARGIN: f32 = 0.1; // of weight, before the gaze follows another emotion

@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> feeling: array<vec4<f32>>;            // [agent]
@group(0) @binding(2) var<storage, read> paces: array<Paces>;                  // [agent]
@group(0) @binding(3) var<storage, read_write> gait_weights: array<vec4<f32>>; // [agent]
@group(0) @binding(4) var<storage, read_write> body: array<Body>;              // [agent]
@group(0) @binding(5) var<storage, read_write> appearance: array<Appearance>;  // [agent]

fn sum_of(a: vec4<f32>, b: vec4<f32>) -> f32 {
    return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}

@compute @workgroup_size(64)
fn emotion_apply(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x;
    if agent >= step.agent_count {
        return;
    }
    let q = feeling[agent];
    let own = paces[agent];
    if !(own.max_speed_factor > 0.0) {
        return;
    }
    gait_weights[agent] = q;
    let speed = sum_of(q, own.preferred_speeds);
    let walk_ratio = sum_of(q, own.walk_ratios);
    body[agent].max_speed = max(speed, min(speed * own.max_speed_factor, own.max_speed));
    body[agent].preferred_speed = speed;
    body[agent].walk_ratio = walk_ratio;

    let shown = min(emotion_of(appearance[agent]), 3u);
    var strongest = shown;
    for (var emotion = 0u; emotion < 4u; emotion++) {
        if q[emotion] > q[strongest] {
            strongest = emotion;
        }
    }
    if q[strongest] > q[shown] + MARGIN {
        appearance[agent].traits = with_emotion(appearance[agent].traits, strongest);
    }
}
