//! From a file's skeleton to ours: rest pose, orientation, unit, merged weights.

use super::super::body::pack;
use super::super::model::{Paint, PaintCorner};
use super::super::rig_map::{RigMap, words};
use super::super::{Avatar, FaceVertex, LEVELS, Mesh, RestJoint, Vertex};
use super::Fault;
use super::expressions::{Ways, face_vertex};
use super::rig::{Driven, find, upward};
use super::simplify::simplify;
use super::source::{Part, Source};
use super::stature::crown;
use super::textured::textured;
use crate::gait::{JOINT_COUNT, Joint};
use glam::{Mat3, Mat4, Quat, Vec3};
use std::sync::Arc;

/// Heights of people that need no explanation, m.
const PEOPLE: std::ops::RangeInclusive<f32> = 1.0..=2.2;

/// Height of a character whose unit is not known, m.
const USUAL: f32 = 1.7;

/// Metres per unit of the units that files come in.
const UNITS: [(f32, &str); 4] =
    [(0.01, "centimetres"), (0.001, "millimetres"), (0.0254, "inches"), (100.0, "units of 100 m")];

/// Most triangles of the coarser levels.
const COARSE: [usize; 2] = [1200, 350];

/// A character in file space before it is turned and scaled.
struct Figure {
    joints: [Vec3; JOINT_COUNT],
    vertices: Vec<Vertex>,
    indices: Vec<u32>,
    /// Without the triangles of cut-outs that are holes for the larger part.
    whole: Vec<u32>,
    /// What each vertex is painted with.
    corners: Vec<PaintCorner>,
    /// How far expressions move each vertex, of a file that has some.
    ways: Vec<Ways>,
    /// Triangles that are not worn on the head.
    bare: Vec<[u32; 3]>,
}

/// Builds the avatar.
///
/// # Errors
/// What says why the file is no usable humanoid.
pub(super) fn reduce(name: &str, source: &mut Source, map: &RigMap) -> Result<Avatar, Fault> {
    if source.skins.is_empty() {
        return Err("has no skin: it is not rigged; export it with its armature".into());
    }
    if source.parts.iter().all(|part| part.whole.is_empty()) {
        return Err("has no triangles".into());
    }
    let node_pose: Vec<Mat4> = source.nodes.iter().map(|node| node.world).collect();
    let bind_pose = bind_pose(source);
    let place = |pose: &[Mat4]| -> Vec<Vec3> { pose.iter().map(|m| m.w_axis.truncate()).collect() };
    let driven = find(name, source, map, &place(bind_pose.as_deref().unwrap_or(&node_pose)))?;
    let pose = choose_pose(source, &driven, node_pose, bind_pose);
    let mut figure = gather(source, &driven, &pose)?;
    orient(source, &mut figure)?;
    let height = scale(source, &mut figure, map.height())?;
    let eyes = eyes(source, &figure, height);
    let joints = std::array::from_fn(|joint| {
        let position = figure.joints[joint];
        let parent = if joint == 0 { Vec3::ZERO } else { figure.joints[Joint::PARENT[joint]] };
        RestJoint {
            translation: position - parent,
            rotation: Quat::IDENTITY,
            joint_from_mesh: Mat4::from_translation(-position),
        }
    });
    let paint = paint(source, figure.corners);
    let face = face(source, &figure.ways);
    let whole = Mesh { vertices: figure.vertices, indices: figure.whole };
    let fine = whole.indices.len() / 3;
    // Holes are seen at every pixel where there are textures.
    let finest = if paint.is_some() { figure.indices } else { whole.indices.clone() };
    let mut levels = vec![Mesh { vertices: whole.vertices.clone(), indices: finest }];
    // Characters that are coarse already get coarser in proportion.
    let targets = [COARSE[0].min(fine / 3), COARSE[1].min(fine / 10)];
    for most in targets.into_iter().take(LEVELS - 1) {
        let coarse = simplify(&whole, most, height);
        // A character may be coarser than our levels already.
        if coarse.indices.len() < levels.last().map_or(0, |mesh| mesh.indices.len()) {
            levels.push(coarse);
        }
    }
    let counts: Vec<String> = levels.iter().map(|mesh| (mesh.indices.len() / 3).to_string()).collect();
    source.report.push(format!("levels of detail: {} triangles", counts.join(", ")));
    let name = name.to_owned();
    Ok(Avatar {
        name,
        joints,
        levels,
        eyes_in_head: eyes,
        eyeball: None,
        face,
        height,
        paint,
        wardrobe: None,
    })
}

/// What an expression moves.
fn face(source: &mut Source, ways: &[Ways]) -> Vec<FaceVertex> {
    let face: Vec<FaceVertex> =
        ways.iter().zip(0..).filter_map(|(ways, vertex)| face_vertex(vertex, ways)).collect();
    if source.expressions.are_any() {
        let names = source.expressions.names();
        source.report.push(format!("expressions: {} move {} vertices near by", names.join(", "), face.len()));
    }
    face
}

/// What the vertices are painted with; nothing of a file without textures.
fn paint(source: &mut Source, corners: Vec<PaintCorner>) -> Option<Arc<Paint>> {
    let textured = textured(source);
    let [colors, maps] = [textured.colors.len(), textured.maps.len()];
    if colors + maps == 0 {
        return None;
    }
    source
        .report
        .push(format!("textures near by: {colors} of colours, {maps} of normals, roughness, occlusion"));
    Some(Arc::new(Paint { corners, textured }))
}

/// Pose in which the mesh was bound, of every node: inverse bind matrices where there are some, else as the
/// nodes' own transforms carry on. `None` without inverse bind matrices.
fn bind_pose(source: &Source) -> Option<Vec<Mat4>> {
    let mut known: Vec<Option<Mat4>> = vec![None; source.nodes.len()];
    let mut order: Vec<usize> = (0..source.skins.len()).collect();
    order.sort_by_key(|&skin| std::cmp::Reverse(source.skins[skin].joints.len()));
    for skin in order {
        let skin = &source.skins[skin];
        let Some(inverse) = &skin.inverse_bind else { continue };
        // A joint that another skin has placed, else the skin's topmost joint, says where the skin's mesh space is.
        let placed = skin.joints.iter().position(|&joint| known[joint].is_some());
        let top = (0..skin.joints.len()).min_by_key(|&slot| upward(source, skin.joints[slot]).count());
        let slot = placed.or(top)?;
        let anchor = known[skin.joints[slot]].unwrap_or(source.nodes[skin.joints[slot]].world);
        let model_from_mesh = anchor * inverse[slot];
        for (&joint, inverse) in skin.joints.iter().zip(inverse) {
            let bind = model_from_mesh * inverse.inverse();
            if bind.is_finite() {
                known[joint].get_or_insert(bind);
            }
        }
    }
    known.iter().any(Option::is_some).then(|| {
        let settle = |node: usize| {
            // The nearest node above with a bind pose carries the rest of the chain.
            let mut local = Mat4::IDENTITY;
            for above in upward(source, node) {
                if let Some(bind) = known[above] {
                    return bind * local;
                }
                local = source.nodes[above].local * local;
            }
            local
        };
        (0..source.nodes.len()).map(settle).collect()
    })
}

/// How much a pose looks like a person standing upright: legs straight down, sides alike.
fn uprightness(driven: &Driven, pose: &[Mat4]) -> f32 {
    let at = |joint: Joint| driven[joint as usize].map_or(Vec3::ZERO, |node| pose[node].w_axis.truncate());
    let down = |a: Joint, b: Joint| -(at(b) - at(a)).normalize_or_zero().y;
    let reach = |a: Joint, b: Joint| at(a).distance(at(b)).max(1e-6);
    let mut score = 0.0;
    for hip in [Joint::LeftHip, Joint::RightHip] {
        let [knee, foot] = [1, 2].map(|k| Joint::ALL[hip as usize + k]);
        score += down(hip, knee) + down(knee, foot);
    }
    for (left, right) in [(Joint::LeftFoot, Joint::RightFoot), (Joint::LeftHand, Joint::RightHand)] {
        let (a, b) = (reach(Joint::Head, left), reach(Joint::Head, right));
        score -= 2.0 * (a - b).abs() / a.max(b);
    }
    score
}

fn choose_pose(source: &mut Source, driven: &Driven, nodes: Vec<Mat4>, bind: Option<Vec<Mat4>>) -> Vec<Mat4> {
    let Some(bind) = bind else { return nodes };
    let height = driven[Joint::Head as usize].map_or(1.0, |node| nodes[node].w_axis.y.abs().max(1e-6));
    let apart = driven
        .iter()
        .flatten()
        .map(|&node| nodes[node].w_axis.distance(bind[node].w_axis) / height)
        .fold(0.0, f32::max);
    if apart < 0.01 {
        return nodes;
    }
    let (own, bound) = (uprightness(driven, &nodes), uprightness(driven, &bind));
    let use_bind = bound > own + 0.02;
    let chosen = if use_bind { "bind pose" } else { "pose of its nodes" };
    source.report.push(format!(
        "rest pose: its nodes and its bind pose differ by {:.0} % of its height; the {chosen} stands straighter and is used",
        apart * 100.0
    ));
    if use_bind { bind } else { nodes }
}

/// The driven joint that a node follows: itself or the nearest one above.
fn driver(source: &Source, driven: &Driven, node: usize) -> Option<Joint> {
    upward(source, node)
        .find_map(|above| Joint::ALL.into_iter().find(|&joint| driven[joint as usize] == Some(above)))
}

/// Brings all parts into the chosen pose and merges weights of joints that nothing drives.
fn gather(source: &mut Source, driven: &Driven, pose: &[Mat4]) -> Result<Figure, String> {
    let at = |joint: Joint| driven[joint as usize].map(|node| pose[node].w_axis.truncate());
    let mut joints = [Vec3::ZERO; JOINT_COUNT];
    for joint in Joint::ALL {
        let (root, head) = (at(Joint::Root), at(Joint::Head));
        let shoulders = at(Joint::LeftShoulder).zip(at(Joint::RightShoulder)).map(|(l, r)| l.midpoint(r));
        joints[joint as usize] = at(joint)
            .or(match joint {
                // Rigs without a spine bend a third of the way up the trunk.
                Joint::Spine => root.zip(shoulders).map(|(root, chest)| root.lerp(chest, 0.3)),
                // Rigs without a neck turn the head where it sits.
                _ => head,
            })
            .ok_or_else(|| format!("has no joint {}", joint.name()))?;
    }
    for joint in [Joint::Spine, Joint::Neck] {
        if driven[joint as usize].is_none() {
            source.report.push(format!("{}: the rig has none, a place for it was inferred", joint.name()));
        }
    }
    let mut figure = Figure {
        joints,
        vertices: Vec::new(),
        indices: Vec::new(),
        whole: Vec::new(),
        corners: Vec::new(),
        ways: Vec::new(),
        bare: Vec::new(),
    };
    let mut unbound = 0;
    let mut left_out = Vec::new();
    for part in &source.parts {
        let held = upward(source, part.node).skip(1).any(|node| is_prop(&source.nodes[node].name));
        let carrier = driver(source, driven, part.node);
        if part.skin.is_none() && (held || carrier.is_none()) {
            left_out.push(format!("{:?}", source.nodes[part.node].name));
            continue;
        }
        let first = figure.whole.len();
        unbound += add_part(&mut figure, source, driven, pose, part);
        let on_head = part.skin.is_none() && carrier == Some(Joint::Head);
        if !on_head && !is_headwear(&source.nodes[part.node].name) {
            let own = figure.whole[first..].chunks_exact(3).map(|t| [t[0], t[1], t[2]]);
            figure.bare.extend(own);
        }
    }
    if !left_out.is_empty() {
        source.report.push(format!("left out, held or loose objects: {}", left_out.join(", ")));
    }
    if unbound > 0 {
        source.report.push(format!("{unbound} vertices have no weights and follow the root"));
    }
    if figure.whole.is_empty() {
        return Err("has no triangles on its skeleton".to_owned());
    }
    Ok(figure)
}

/// Nodes that carry interchangeable weapons and the like.
fn is_prop(name: &str) -> bool {
    let name = name.to_lowercase();
    ["handslot", "weapon", "holder", "prop_"].iter().any(|word| name.contains(word))
}

/// Parts that are worn on the head.
fn is_headwear(name: &str) -> bool {
    const WORN: [&str; 10] =
        ["hat", "helmet", "helm", "cap", "hood", "crown", "headgear", "headwear", "horns", "antenna"];
    words(name).iter().any(|word| WORN.contains(&word.as_str()))
}

/// Adds a part; returns how many of its vertices had no weights.
fn add_part<'a>(
    figure: &mut Figure,
    source: &'a Source,
    driven: &Driven,
    pose: &[Mat4],
    part: &'a Part,
) -> usize {
    let first = u32::try_from(figure.vertices.len()).unwrap_or(u32::MAX);
    let skin = part.skin.and_then(|skin| source.skins.get(skin));
    // Per skin joint: mesh space to the chosen pose, and the joint that it follows.
    let slots: Vec<(Mat4, usize)> = skin.map_or_else(Vec::new, |skin| {
        let slot = |(slot, &joint): (usize, &usize)| {
            let inverse = skin.inverse_bind.as_ref().map_or(Mat4::IDENTITY, |inverse| inverse[slot]);
            (pose[joint] * inverse, driver(source, driven, joint).map_or(0, |joint| joint as usize))
        };
        skin.joints.iter().enumerate().map(slot).collect()
    });
    let rigid = (pose[part.node], driver(source, driven, part.node).map_or(0, |joint| joint as usize));
    let fallback = slots.first().copied().unwrap_or(rigid);
    let mut unbound = 0;
    for (i, &position) in part.positions.iter().enumerate() {
        let total: f32 = part.influences[i].iter().map(|(_, weight)| weight).sum();
        let mut shares = [0.0; JOINT_COUNT];
        let mut matrix = Mat4::ZERO;
        for &(slot, weight) in &part.influences[i] {
            let (transform, joint) = slots.get(slot).copied().unwrap_or(fallback);
            matrix += transform * (weight / total);
            shares[joint] += weight / total;
        }
        if total <= 0.0 {
            unbound += usize::from(skin.is_some());
            let (transform, joint) = if skin.is_some() { fallback } else { rigid };
            matrix = transform;
            shares[joint] = 1.0;
        }
        let (joints, weights) = pack(&shares);
        if source.expressions.are_any() {
            let own = part.ways.get(i).copied().unwrap_or_default();
            figure.ways.push(own.map(|way| matrix.transform_vector3(way)));
        }
        let normal = part.normals.as_ref().map_or(Vec3::ZERO, |normals| matrix.transform_vector3(normals[i]));
        figure.vertices.push(Vertex {
            position: matrix.transform_point3(position),
            normal: normal.normalize_or_zero(),
            color: part.colors[i].truncate(),
            alpha: part.colors[i].w,
            material: part.material,
            joints,
            weights,
        });
    }
    // A mirrored node turns triangles inside out.
    let flipped = skin.is_none() && Mat3::from_mat4(rigid.0).determinant() < 0.0;
    let turned = |t: &[u32]| if flipped { [t[0], t[2], t[1]] } else { [t[0], t[1], t[2]] };
    let own = |indices: &'a [u32]| indices.chunks_exact(3).flat_map(turned).map(|corner| first + corner);
    figure.indices.extend(own(&part.indices));
    figure.whole.extend(own(&part.whole));
    let material = u32::try_from(part.surface).unwrap_or(0);
    let corners = part.own.iter().zip(&part.uv);
    figure.corners.extend(corners.map(|(color, uv)| PaintCorner { color: *color, uv: *uv, material }));
    unbound
}

impl Figure {
    fn turn(&mut self, by: Quat) {
        self.joints.iter_mut().for_each(|p| *p = by * *p);
        for v in &mut self.vertices {
            v.position = by * v.position;
            v.normal = by * v.normal;
        }
        self.ways.iter_mut().flatten().for_each(|way| *way = by * *way);
    }

    fn joint(&self, joint: Joint) -> Vec3 {
        self.joints[joint as usize]
    }

    /// How far the vertices of a foot reach in front of its ankle minus how far behind, over their sum.
    fn toes_ahead(&self) -> f32 {
        let mut ahead = 0.0;
        for foot in [Joint::LeftFoot, Joint::RightFoot] {
            let ankle = self.joint(foot);
            let own = |v: &&Vertex| usize::from(v.joints[0]) == foot as usize && v.weights[0] > 0.5;
            let reach = |v: &Vertex| v.position.z - ankle.z;
            let vertices = self.vertices.iter().filter(own);
            let (back, front) =
                vertices.fold((0.0_f32, 0.0_f32), |(low, high), v| (low.min(reach(v)), high.max(reach(v))));
            ahead += (front + back) / (front - back).max(1e-9);
        }
        ahead * 0.5
    }
}

/// Turns the figure upright and to +z, and exchanges sides that are named from the onlooker's view.
fn orient(source: &mut Source, figure: &mut Figure) -> Result<(), String> {
    let feet = figure.joint(Joint::LeftFoot).midpoint(figure.joint(Joint::RightFoot));
    let up =
        (figure.joint(Joint::Head) - feet).try_normalize().ok_or("its head and feet are in one place")?;
    if up.y < 0.7 {
        let axis = [Vec3::X, Vec3::NEG_X, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z]
            .into_iter()
            .max_by(|a, b| a.dot(up).total_cmp(&b.dot(up)))
            .unwrap_or(Vec3::Z);
        figure.turn(Quat::from_rotation_arc(axis, Vec3::Y));
        source.report.push(format!("up: the file's up axis is {axis}; turned to y"));
    }
    let across = |figure: &Figure| {
        let pairs = [(Joint::LeftHip, Joint::RightHip), (Joint::LeftShoulder, Joint::RightShoulder)];
        pairs.iter().map(|&(l, r)| figure.joint(l) - figure.joint(r)).sum::<Vec3>().with_y(0.0)
    };
    let left = across(figure).try_normalize().ok_or("its left and right are in one place")?;
    // The turn about y that brings left to +x.
    let turn = libm::atan2f(left.z, left.x);
    figure.turn(Quat::from_rotation_y(turn));
    if turn.abs() > 0.1 {
        source.report.push(format!("facing: turned by {:.0} degrees to +z", turn.to_degrees()));
    }
    if figure.toes_ahead() < -0.15 {
        // Left and right as an onlooker names them: the toes tell.
        figure.turn(Quat::from_rotation_y(std::f32::consts::PI));
        let mirrored = |joint: usize| Joint::ALL[joint].mirrored() as usize;
        let joints = figure.joints;
        figure.joints = std::array::from_fn(|joint| joints[mirrored(joint)]);
        for v in &mut figure.vertices {
            v.joints = v.joints.map(|joint| u8::try_from(mirrored(usize::from(joint))).unwrap_or(0));
        }
        source.report.push("sides: the toes point backwards, so left and right were exchanged".to_owned());
    }
    Ok(())
}

/// The crown of the body without what it wears; of one that is nothing but rigid objects, of all of it.
fn bare_crown(figure: &Figure) -> f32 {
    let head = figure.joint(Joint::Head);
    let all: Vec<[u32; 3]> = figure.whole.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
    let has_head = figure.bare.iter().flatten().any(|&corner| {
        let v = &figure.vertices[corner as usize];
        usize::from(v.joints[0]) == Joint::Head as usize && v.position.y > head.y
    });
    crown(&figure.vertices, if has_head { &figure.bare } else { &all }, head)
}

/// Brings the figure to metres, onto the ground and over the origin; its height from sole to crown, which may be given, m.
fn scale(source: &mut Source, figure: &mut Figure, wanted: Option<f32>) -> Result<f32, String> {
    let low = figure.vertices.iter().map(|v| v.position.y).fold(f32::MAX, f32::min);
    let tall = bare_crown(figure) - low;
    if !(tall.is_finite() && tall > 1e-9) {
        return Err(format!("is {tall} units high"));
    }
    let (factor, unit) = if let Some(height) = wanted {
        (height / tall, format!("{} m, as the rig map says", height / tall))
    } else if PEOPLE.contains(&tall) {
        (1.0, "metres".to_owned())
    } else if let Some((factor, unit)) =
        UNITS.into_iter().find(|(factor, _)| PEOPLE.contains(&(tall * factor)))
    {
        (factor, unit.to_owned())
    } else {
        (USUAL / tall, format!("no known unit ({tall} high), made {USUAL} m"))
    };
    let middle = figure.joint(Joint::LeftHip).midpoint(figure.joint(Joint::RightHip));
    let ground = Vec3::new(middle.x, low, middle.z);
    figure.joints.iter_mut().for_each(|p| *p = (*p - ground) * factor);
    figure.vertices.iter_mut().for_each(|v| v.position = (v.position - ground) * factor);
    figure.ways.iter_mut().flatten().for_each(|way| *way *= factor);
    source.report.push(format!("unit: {unit}; {:.2} m tall", tall * factor));
    let legs = figure.joint(Joint::LeftHip).y - figure.joint(Joint::LeftFoot).y;
    if legs <= 0.02 {
        return Err(format!("its left hip is {legs} m above its foot; is it standing?"));
    }
    let bare = figure.vertices.iter().any(|v| v.normal == Vec3::ZERO);
    if bare {
        smooth_normals(figure);
        source.report.push("normals: missing, computed".to_owned());
    }
    Ok(tall * factor)
}

/// Area-weighted normals for vertices that have none.
fn smooth_normals(figure: &mut Figure) {
    let mut sums = vec![Vec3::ZERO; figure.vertices.len()];
    for t in figure.indices.chunks_exact(3) {
        let [a, b, c] = [t[0], t[1], t[2]].map(|i| figure.vertices[i as usize].position);
        let normal = (b - a).cross(c - a);
        t.iter().for_each(|&i| sums[i as usize] += normal);
    }
    for (v, sum) in figure.vertices.iter_mut().zip(sums) {
        if v.normal == Vec3::ZERO {
            v.normal = sum.try_normalize().unwrap_or(Vec3::Y);
        }
    }
}

/// Midpoint of the eyes in the head joint's space: VRM's own, else where eyes are in a head of that size.
fn eyes(source: &Source, figure: &Figure, height: f32) -> Vec3 {
    let head = figure.joint(Joint::Head);
    if let Some(offset) = source.eyes {
        // VRM 0.x faces -z, VRM 1.0 faces +z; eyes are in front.
        return offset.with_z(offset.z.abs());
    }
    let own = |v: &&Vertex| usize::from(v.joints[0]) == Joint::Head as usize;
    let vertices = || figure.vertices.iter().filter(own).map(|v| v.position - head);
    let top = vertices().map(|p| p.y).fold(0.0, f32::max).min((height - head.y).max(0.0));
    let level = 0.45 * top;
    let front = vertices()
        .filter(|p| (p.y - level).abs() < 0.15 * top && p.x.abs() < 0.3 * top)
        .map(|p| p.z)
        .fold(0.0, f32::max);
    // no face is deeper; the brim of a hat is
    Vec3::new(0.0, level, front.min(0.55 * top) * 0.85)
}
