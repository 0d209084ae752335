//! The bodies of distant people: some fifty triangles in the colours and proportions of the avatar, whose limbs
//! swing, and farther still a speck of thirteen. They need no pose, so that thousands of them cost little.

use super::{Avatar, Material, Posture};
use crate::gait::Joint;
pub(super) use crate::kernels::draw::far::ARM_SWING;
use glam::{Quat, Vec3};

/// Swing of a leg to either side, radians: strides of 1.3 m on legs of 0.85 m.
const SWING: f32 = 0.39;
/// Where an arm points that hangs, on the left.
pub(super) const HANGING: Vec3 = Vec3::new(0.16, -1.0, 0.04);
/// Points along an edge of a triangle at which it is sampled.
const SAMPLES: u16 = 5;
/// Half a side of a ring of four corners over the deviation of what it stands for: a prism then looks, from the sides
/// taken together, as wide as the ellipse it replaces (mean width of a rectangle, deviation of an ellipse's outline).
const FOUR: f32 = 1.11;
/// The same for the radius of a ring of three corners.
const THREE: f32 = 1.71;

/// How far the normals of a part's highest ring point upwards, against outwards.
const UPWARDS: f32 = 0.7;

/// A vertex of a far body, mesh space as [`super::Vertex`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[doc(hidden)]
pub struct FarVertex {
    /// Position, m.
    pub position: Vec3,
    /// Unit normal.
    pub normal: Vec3,
    /// Linear colour, as [`super::Vertex::color`].
    pub color: Vec3,
    /// Which of the agent's colours tints this vertex.
    pub material: Material,
    /// Point about which the vertex swings forwards and back, m.
    pub hinge: Vec3,
    /// Turn about +x at phase 0 (left foot strike) of a walk, radians; it goes with the cosine of the phase.
    pub swing: f32,
    /// What of a posture moves it.
    pub limb: Limb,
    /// Height of the hips, about which a posture leans, m.
    pub hips: f32,
}

/// What of a posture moves a vertex of a far body; the numbers are those of `shaders/draw/far.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u32)]
#[doc(hidden)]
pub enum Limb {
    /// Nothing: legs, and all of a speck.
    #[default]
    Fixed = 0,
    /// It leans.
    Trunk = 1,
    /// It leans, and nods about its hinge.
    Head = 2,
    /// It leans, is spread about its hinge to the left, and swings.
    LeftArm = 3,
    /// The same to the right.
    RightArm = 4,
}

/// A far body.
#[derive(Debug, Clone, PartialEq, Default)]
#[doc(hidden)]
pub struct FarMesh {
    /// Vertices.
    pub vertices: Vec<FarVertex>,
    /// Three indices into `vertices` per triangle.
    pub indices: Vec<u32>,
}

/// Turns within a swing at which the bounds are taken; in between the arc is less than a millimetre farther out.
const TURNS: i8 = 8;
/// Room between a far body and its bounds, m.
const MARGIN: f32 = 0.01;
/// Where the upper of the two boxes begins, as a share of the height: below the chin.
const CHIN: f32 = 0.84;

impl FarMesh {
    /// Two upright boxes that bound it, for the lower and the upper part of the body, at any phase and heading in these
    /// postures and their mixtures: half a side, bottom, top, 0; m.
    pub fn bounds(&self, postures: &[Posture]) -> [[f32; 4]; 2] {
        let heights = self.vertices.iter().map(|vertex| vertex.position.y);
        let chin = CHIN * heights.fold(0.0, f32::max);
        let mut parts = [[0.0_f32, chin, chin, 0.0]; 2];
        let mut take = |part: usize, place: Vec3| {
            let [side, bottom, top, _] = &mut parts[part];
            *side = side.max(libm::hypotf(place.x, place.z));
            (*bottom, *top) = (bottom.min(place.y), top.max(place.y));
        };
        let extremes = extremes(postures);
        let turns = (-TURNS..=TURNS).map(|turn| f32::from(turn) / f32::from(TURNS));
        let poses = turns.flat_map(|turn| extremes.iter().map(move |posture| (turn, *posture)));
        for ((turn, posture), triangle) in
            poses.flat_map(|pose| self.indices.chunks_exact(3).map(move |triangle| (pose, triangle)))
        {
            let places = [0, 1, 2].map(|corner| {
                let vertex = triangle.get(corner).and_then(|index| self.vertices.get(*index as usize));
                vertex.map_or(Vec3::ZERO, |vertex| vertex.moved(turn, &posture))
            });
            for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (places[a], places[b])) {
                take(usize::from(a.y > chin), a);
                if (a.y > chin) != (b.y > chin) {
                    // the edge goes through the plane between the boxes
                    let cut = a.lerp(b, (chin - a.y) / (b.y - a.y)).with_y(chin);
                    take(0, cut);
                    take(1, cut);
                }
            }
        }
        parts.map(|[side, bottom, top, _]| [side + MARGIN, bottom - MARGIN, top + MARGIN, 0.0])
    }
}

impl FarVertex {
    /// Where it is after a share, -1 to 1, of its swing in a posture: as `shaders/draw/far.wgsl` has it.
    fn moved(&self, share: f32, posture: &Posture) -> Vec3 {
        let arm = self.position - self.hinge;
        let about = |angle: f32, place: Vec3| Quat::from_rotation_x(angle) * place;
        let swung = about(self.swing / ARM_SWING * posture.swing * share, arm);
        let local = match self.limb {
            Limb::Fixed => return self.hinge + about(self.swing * share, arm),
            Limb::Trunk => arm,
            Limb::Head => about(posture.nod, arm),
            Limb::LeftArm => Quat::from_rotation_z(posture.spread) * swung,
            Limb::RightArm => Quat::from_rotation_z(-posture.spread) * swung,
        };
        let hips = Vec3::Y * self.hips;
        hips + about(posture.lean, self.hinge + local - hips)
    }
}

/// Postures between which, and the one at rest, all mixtures of these lie.
fn extremes(postures: &[Posture]) -> Vec<Posture> {
    let range = |of: fn(&Posture) -> f32| {
        let (low, high) = postures.iter().map(of).fold((0.0_f32, 0.0_f32), |(l, h), x| (l.min(x), h.max(x)));
        [low, 0.5 * (low + high), high]
    };
    let most = range(|posture| posture.swing)[2];
    let mut all = Vec::new();
    for lean in range(|posture| posture.lean) {
        for nod in range(|posture| posture.nod) {
            all.extend(range(|posture| posture.spread).map(|spread| Posture {
                lean,
                nod,
                spread,
                swing: most,
            }));
        }
    }
    all
}

/// A point of the surface, standing for an area.
struct Sample {
    position: Vec3,
    color: Vec3,
    material: Material,
    area: f32,
}

/// A part of a far body.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Part {
    Trunk,
    Head,
    LeftArm,
    RightArm,
    LeftLeg,
    RightLeg,
    /// All of a speck.
    Whole,
}

impl Part {
    const ALL: [Self; 6] =
        [Self::Trunk, Self::Head, Self::LeftArm, Self::RightArm, Self::LeftLeg, Self::RightLeg];

    /// The part that a joint's surface belongs to.
    const fn of(joint: usize) -> Self {
        match joint {
            2 | 3 => Self::Head,
            4..=6 => Self::LeftArm,
            7..=9 => Self::RightArm,
            10..=12 => Self::LeftLeg,
            13..=15 => Self::RightLeg,
            _ => Self::Trunk,
        }
    }

    /// Corners of a ring, and rings from the lowest to the highest: their height, and the slice that they stand for, as
    /// shares of the part's height.
    const fn rings(self) -> (u16, &'static [[f32; 3]]) {
        match self {
            Self::Trunk => (4, &[[0.0, 0.0, 0.2], [0.33, 0.13, 0.53], [1.0, 0.8, 1.0]]),
            Self::Head => (4, &[[0.1, 0.0, 0.4], [0.95, 0.65, 1.0]]),
            Self::Whole => (3, &[[0.0, 0.02, 0.4], [0.65, 0.5, 0.8], [1.0, 0.87, 1.0]]),
            _ => (3, &[[0.03, 0.0, 0.33], [1.0, 0.7, 1.0]]),
        }
    }
}

impl Avatar {
    /// Where a joint is at rest, mesh space, m.
    fn rest(&self, joint: Joint) -> Vec3 {
        self.joints[joint as usize].joint_from_mesh.inverse().w_axis.truncate()
    }

    /// The body that this one is drawn as far away, made from its coarsest level.
    pub fn far_body(&self) -> FarMesh {
        let samples = self.samples();
        let mut mesh = FarMesh::default();
        for part in Part::ALL {
            let of_part: Vec<&Sample> =
                samples.iter().filter(|(of, _)| *of == part).map(|(_, s)| s).collect();
            // arms against legs
            let (hinge, swing, limb) = match part {
                Part::LeftArm => (self.rest(Joint::LeftShoulder), ARM_SWING, Limb::LeftArm),
                Part::RightArm => (self.rest(Joint::RightShoulder), -ARM_SWING, Limb::RightArm),
                Part::LeftLeg => (self.rest(Joint::LeftHip), -SWING, Limb::Fixed),
                Part::RightLeg => (self.rest(Joint::RightHip), SWING, Limb::Fixed),
                Part::Head => (self.rest(Joint::Neck), 0.0, Limb::Head),
                Part::Trunk => (Vec3::ZERO, 0.0, Limb::Trunk),
                Part::Whole => (Vec3::ZERO, 0.0, Limb::Fixed),
            };
            let hips = self.rest(Joint::Root).y;
            add_part(&mut mesh, part, &of_part, &Motion { hinge, swing, limb, hips });
        }
        mesh
    }

    /// The body where it is a few pixels high: legs, trunk and head in one prism that keeps still.
    pub fn speck(&self) -> FarMesh {
        let samples = self.samples();
        let all: Vec<&Sample> = samples.iter().map(|(_, sample)| sample).collect();
        let mut mesh = FarMesh::default();
        add_part(&mut mesh, Part::Whole, &all, &Motion::default());
        mesh
    }

    /// Points of the coarsest level's surface, arms hanging, with the part they belong to.
    fn samples(&self) -> Vec<(Part, Sample)> {
        let Some(mesh) = self.levels.last() else { return Vec::new() };
        let arms = [
            self.hanging(Joint::LeftShoulder, Joint::LeftHand),
            self.hanging(Joint::RightShoulder, Joint::RightHand),
        ];
        let mut samples = Vec::new();
        for triangle in mesh.indices.chunks_exact(3) {
            let corner = |i: usize| mesh.vertices.get(triangle[i] as usize);
            let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) else { continue };
            let mut shares = [0.0_f32; 16];
            for vertex in [a, b, c] {
                for (joint, weight) in vertex.driven_joints().into_iter().zip(vertex.weights) {
                    shares[usize::from(joint)] += weight;
                }
            }
            let joint = (0..16).max_by(|x, y| shares[*x].total_cmp(&shares[*y])).unwrap_or(0);
            let arm = match joint {
                4..=6 => Some(&arms[0]),
                7..=9 => Some(&arms[1]),
                _ => None,
            };
            let area = 0.5 * (b.position - a.position).cross(c.position - a.position).length();
            for i in 0..SAMPLES {
                for j in 0..SAMPLES - i {
                    let edge = f32::from(SAMPLES - 1);
                    let (u, v) = (f32::from(i) / edge, f32::from(j) / edge);
                    let mix = |f: fn(&super::Vertex) -> Vec3| f(a) * (1.0 - u - v) + f(b) * u + f(c) * v;
                    let mut position = mix(|vertex| vertex.position);
                    if let Some((shoulder, turn)) = arm {
                        position = *shoulder + *turn * (position - *shoulder);
                    }
                    let color = mix(|vertex| vertex.color);
                    samples.push((Part::of(joint), Sample { position, color, material: a.material, area }));
                }
            }
        }
        samples.retain(|(_, sample)| sample.position.is_finite() && sample.area.is_finite());
        samples
    }

    /// The shoulder, and the turn that lets an arm hang that is stretched out at rest.
    fn hanging(&self, shoulder: Joint, hand: Joint) -> (Vec3, Quat) {
        let at = self.rest(shoulder);
        let arm = (self.rest(hand) - at).try_normalize().unwrap_or(Vec3::NEG_Y);
        let down = Vec3::new(HANGING.x * at.x.signum(), HANGING.y, HANGING.z).normalize();
        (at, Quat::from_rotation_arc(arm, down))
    }
}

/// How a part moves, see [`FarVertex`].
#[derive(Debug, Clone, Copy, Default)]
struct Motion {
    hinge: Vec3,
    swing: f32,
    limb: Limb,
    hips: f32,
}

/// Adds a prism around the samples of a part.
fn add_part(mesh: &mut FarMesh, part: Part, samples: &[&Sample], motion: &Motion) {
    let Motion { hinge, swing, limb, hips } = *motion;
    let low = samples.iter().map(|s| s.position.y).fold(f32::INFINITY, f32::min);
    let high = samples.iter().map(|s| s.position.y).fold(f32::NEG_INFINITY, f32::max);
    if high - low <= 1e-3 {
        return;
    }
    let (corners, rings) = part.rings();
    let first = u32::try_from(mesh.vertices.len()).unwrap_or(u32::MAX);
    for [share, below, above] in rings {
        let height = |share: &f32| low + (high - low) * share;
        let (y, slice) = (height(share), height(below)..=height(above));
        let near: Vec<&Sample> = samples.iter().copied().filter(|s| slice.contains(&s.position.y)).collect();
        let ring = Ring::of(if near.is_empty() { samples } else { &near });
        for corner in 0..corners {
            let (position, out) = ring.corner(corner, corners, y);
            // shoulders and crown catch the light from above
            let normal = if *share > 0.5 { (out + Vec3::Y * UPWARDS).normalize() } else { out };
            let (color, material) = (ring.color, ring.material);
            mesh.vertices.push(FarVertex { position, normal, color, material, hinge, swing, limb, hips });
        }
    }
    let corners = u32::from(corners);
    let rings = u32::try_from(rings.len()).unwrap_or(0);
    let at = |ring: u32, corner: u32| first + ring * corners + corner % corners;
    for ring in 1..rings {
        for corner in 0..corners {
            let (low, up) =
                ([at(ring - 1, corner), at(ring - 1, corner + 1)], [at(ring, corner), at(ring, corner + 1)]);
            mesh.indices.extend([low[0], up[0], low[1], low[1], up[0], up[1]]);
        }
    }
    // shoulders and crowns are seen from above
    let top = rings - 1;
    match part {
        Part::Trunk | Part::Head => {
            mesh.indices.extend([at(top, 0), at(top, 2), at(top, 1), at(top, 0), at(top, 3), at(top, 2)]);
        }
        Part::Whole => mesh.indices.extend([at(top, 0), at(top, 2), at(top, 1)]),
        _ => {}
    }
}

/// What a slice of a part looks like from above.
struct Ring {
    middle: Vec3,
    deviation: Vec3,
    color: Vec3,
    material: Material,
}

impl Ring {
    fn of(samples: &[&Sample]) -> Self {
        let area: f32 = samples.iter().map(|s| s.area).sum::<f32>().max(1e-12);
        let middle = samples.iter().map(|s| s.position * s.area).sum::<Vec3>() / area;
        let square = |s: &&Sample| (s.position - middle) * (s.position - middle) * s.area;
        let deviation = (samples.iter().map(square).sum::<Vec3>() / area).map(f32::sqrt);
        // the colour that most of the slice has
        let share = |material: Material| {
            samples.iter().filter(|s| s.material == material).map(|s| s.area).sum::<f32>()
        };
        let all = [Material::Fixed, Material::Skin, Material::Hair, Material::Top, Material::Bottom];
        let material = all.into_iter().max_by(|a, b| share(*a).total_cmp(&share(*b))).unwrap_or_default();
        let of_it = samples.iter().filter(|s| s.material == material);
        let color = of_it.map(|s| s.color * s.area).sum::<Vec3>() / share(material).max(1e-12);
        Self { middle, deviation, color, material }
    }

    /// Position and normal of a corner of the ring at a height.
    fn corner(&self, corner: u16, corners: u16, y: f32) -> (Vec3, Vec3) {
        let turn = std::f32::consts::TAU * (f32::from(corner) + 0.5) / f32::from(corners);
        let (sin, cos) = libm::sincosf(turn);
        // four corners lie on the diagonals
        let size = if corners == 4 { FOUR * std::f32::consts::SQRT_2 } else { THREE };
        let at = Vec3::new(cos * self.deviation.x, 0.0, sin * self.deviation.z) * size;
        let normal = Vec3::new(cos * self.deviation.z, 0.0, sin * self.deviation.x);
        ((self.middle + at).with_y(y), normal.try_normalize().unwrap_or(Vec3::Y))
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "a swing of nought is nought")]
mod tests {
    use super::super::{Sex, generated};
    use super::*;

    #[test]
    fn a_far_body_has_few_triangles_stands_as_tall_and_wide_and_turns_its_outside_out() {
        for sex in Sex::ALL {
            let avatar = generated(sex);
            let far = avatar.far_body();
            assert!((45..=56).contains(&(far.indices.len() / 3)), "{} triangles", far.indices.len() / 3);
            let span = |axis: fn(&FarVertex) -> f32| {
                let values = far.vertices.iter().map(axis);
                values.clone().fold(f32::MAX, f32::min)..values.fold(f32::MIN, f32::max)
            };
            let (y, x) = (span(|v| v.position.y), span(|v| v.position.x));
            assert!(y.start.abs() < 0.05 && (y.end - avatar.height).abs() < 0.08, "{y:?}");
            assert!((0.5..0.8).contains(&(x.end - x.start)), "{x:?}");
            let used = |material| far.vertices.iter().any(|v| v.material == material);
            assert!(used(Material::Top) && used(Material::Bottom) && used(Material::Hair));
            let speck = avatar.speck();
            assert_eq!(speck.indices.len() / 3, 13);
            let tall = speck.vertices.iter().map(|v| v.position.y).fold(0.0, f32::max);
            assert!((tall - avatar.height).abs() < 0.05 && speck.vertices.iter().all(|v| v.swing == 0.0));
            // every triangle looks away from the axis of its part, or up
            let triangles = |mesh: &FarMesh| {
                let corners = |t: &[u32]| [0, 1, 2].map(|i| mesh.vertices[t[i] as usize]);
                mesh.indices.chunks_exact(3).map(corners).collect::<Vec<_>>()
            };
            for triangle in triangles(&far).into_iter().chain(triangles(&speck)) {
                let [a, b, c] = triangle;
                let face = (b.position - a.position).cross(c.position - a.position);
                let out = a.normal + b.normal + c.normal;
                let is_cap = face.normalize().y.abs() > 0.9;
                assert!(is_cap || face.dot(out) > 0.0, "{triangle:?}");
            }
        }
    }

    #[test]
    fn the_two_boxes_hold_the_body_and_the_upper_one_is_as_narrow_as_a_head() {
        for sex in Sex::ALL {
            let avatar = generated(sex);
            for mesh in [avatar.far_body(), avatar.speck()] {
                let sad = Posture { lean: 0.2, nod: 0.4, spread: 0.05, swing: 0.1 };
                let [lower, upper] = mesh.bounds(&[]);
                let [wide, high] = mesh.bounds(&[sad]);
                assert!(wide[0] >= lower[0] && high[0] >= upper[0] && high[2] >= upper[2]);
                let mixed = Posture { lean: 0.13, nod: 0.31, spread: 0.02, swing: 0.07 };
                assert!(lower[1] < 0.1 && lower[2] > upper[1] && (lower[2] - upper[1] - 0.02).abs() < 1e-4);
                assert!(upper[2] > avatar.height - 0.05 && upper[2] < avatar.height + 0.1, "{upper:?}");
                assert!(
                    (0.08..0.21).contains(&upper[0]) && (0.25..0.6).contains(&lower[0]),
                    "{lower:?} {upper:?}"
                );
                for vertex in &mesh.vertices {
                    for share in [-1.0, -0.37, 0.0, 0.71, 1.0] {
                        let holds = |boxes: [&[f32; 4]; 2], place: Vec3| {
                            let is_in = |b: &&[f32; 4]| {
                                libm::hypotf(place.x, place.z) <= b[0] && (b[1]..=b[2]).contains(&place.y)
                            };
                            boxes.iter().any(is_in)
                        };
                        let place = vertex.moved(share, &Posture::default());
                        assert!(holds([&lower, &upper], place), "{place}");
                        let place = vertex.moved(share, &mixed);
                        assert!(holds([&wide, &high], place), "{place}");
                    }
                }
            }
        }
    }

    #[test]
    fn legs_swing_against_each_other_about_the_hips_and_the_left_one_begins_forwards() {
        let avatar = generated(Sex::Male);
        let far = avatar.far_body();
        for (side, joint) in [(1.0, Joint::LeftHip), (-1.0, Joint::RightHip)] {
            let leg: Vec<_> =
                far.vertices.iter().filter(|v| v.swing * side < 0.0 && v.hinge.y < 1.1).collect();
            assert_eq!(leg.len(), 6);
            assert!(leg.iter().all(|v| v.hinge == avatar.rest(joint)));
            assert!(leg.iter().map(|v| v.position.x * side).sum::<f32>() > 6.0 * 0.05);
            let foot = leg.iter().min_by(|a, b| a.position.y.total_cmp(&b.position.y)).unwrap();
            let turned = foot.hinge + Quat::from_rotation_x(foot.swing) * (foot.position - foot.hinge);
            assert!((turned.z - foot.position.z) * side > 0.2, "{side}: {turned}");
        }
    }

    #[test]
    fn arms_that_are_stretched_out_at_rest_hang_and_a_body_without_a_surface_has_no_far_one() {
        let mut avatar = generated(Sex::Female);
        let wide = |avatar: &Avatar| {
            let far = avatar.far_body();
            far.vertices.iter().map(|v| v.position.x.abs()).fold(0.0, f32::max)
        };
        let before = wide(&avatar);
        // the left arm straight out to the side: mesh and joints turned about the shoulder
        let shoulder = avatar.rest(Joint::LeftShoulder);
        let turn = Quat::from_rotation_z(1.3);
        let out = |p: Vec3| shoulder + turn * (p - shoulder);
        for vertex in &mut avatar.levels.last_mut().unwrap().vertices {
            if vertex.joints.iter().zip(vertex.weights).any(|(j, w)| (4..=6).contains(j) && w > 0.5) {
                vertex.position = out(vertex.position);
            }
        }
        for joint in [Joint::LeftElbow, Joint::LeftHand] {
            let at = out(avatar.rest(joint));
            avatar.joints[joint as usize].joint_from_mesh = glam::Mat4::from_translation(-at);
        }
        assert!((wide(&avatar) - before).abs() < 0.04, "{} {before}", wide(&avatar));
        avatar.levels.clear();
        assert_eq!((avatar.far_body(), avatar.speck()), (FarMesh::default(), FarMesh::default()));
    }
}
