use super::*;
use crate::kernels::shared::body::index::{LEFT_EYE, LIDS, RIGHT_EYE, SKIN_JOINTS};
use crate::kernels::shared::outfit::{BEARD, GLASSES};
use std::collections::HashMap;

/// Signed volume, and the area of triangles whose normals disagree with their winding.
fn volume(mesh: &Mesh) -> f32 {
    mesh.indices
        .chunks_exact(3)
        .map(|t| {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.vertices[i as usize].position);
            a.dot(b.cross(c)) / 6.0
        })
        .sum()
}

#[test]
fn bodies_have_the_promised_triangle_counts_and_stature() {
    for sex in Sex::ALL {
        let avatar = generated(sex);
        let counts: Vec<usize> = avatar.levels.iter().map(|mesh| mesh.indices.len() / 3).collect();
        println!("{}: {counts:?} triangles", avatar.name);
        for (count, range) in counts.iter().zip([2000..=3500, 330..=460, 95..=155]) {
            assert!(range.contains(count), "{}: {counts:?}", avatar.name);
        }
        for mesh in &avatar.levels {
            let top = mesh.vertices.iter().map(|v| v.position.y).fold(f32::MIN, f32::max);
            let bottom = mesh.vertices.iter().map(|v| v.position.y).fold(f32::MAX, f32::min);
            assert!((top - avatar.height).abs() < 0.02, "{} is {top} m high", avatar.name);
            assert!(bottom.abs() < 1e-4, "{} stands at {bottom} m", avatar.name);
        }
    }
}

#[test]
fn surfaces_wind_outward_with_unit_normals_on_the_same_side() {
    for sex in Sex::ALL {
        for mesh in &generated(sex).levels {
            assert!((0.02..0.2).contains(&volume(mesh)), "volume {} m3", volume(mesh));
            let mut odd = 0;
            for t in mesh.indices.chunks_exact(3) {
                let corners = [t[0], t[1], t[2]].map(|i| mesh.vertices[i as usize]);
                let [a, b, c] = corners.map(|v| v.position);
                let normal = (b - a).cross(c - a).normalize();
                for v in corners {
                    assert!((v.normal.length() - 1.0).abs() < 1e-4);
                    odd += usize::from(v.normal.dot(normal) < -0.2);
                }
            }
            assert!(
                odd * 100 < mesh.indices.len(),
                "{odd} of {} corners shade inside out",
                mesh.indices.len()
            );
        }
    }
}

#[test]
fn weights_sum_to_one_and_the_body_is_its_own_mirror_image() {
    for sex in Sex::ALL {
        for mesh in &generated(sex).levels {
            let key = |p: Vec3| (p * 2e3).round().as_ivec3();
            let mut found: HashMap<glam::IVec3, usize> = HashMap::new();
            for v in &mesh.vertices {
                assert!((v.weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
                assert!(v.joints.iter().all(|&j| usize::from(j) < SKIN_JOINTS));
                *found.entry(key(v.position)).or_default() += 1;
            }
            let single = mesh.vertices.iter().filter(|v| {
                let p = v.position * Vec3::new(-1.0, 1.0, 1.0);
                let near = |d: Vec3| found.contains_key(&key(p + d * 5e-4));
                !near(Vec3::ZERO) && !near(Vec3::X) && !near(-Vec3::X) && !near(Vec3::Y) && !near(-Vec3::Y)
            });
            let share = single.count() as f32 / mesh.vertices.len() as f32;
            // Odd polygons (5 segments) are symmetric about the front, hence the whole body is.
            assert!(share < 0.35, "{share} of the vertices have no mirror image");
        }
    }
}

#[test]
fn eyes_and_joints_lie_inside_the_figure() {
    for sex in Sex::ALL {
        let avatar = generated(sex);
        let rotations = avatar.joints.map(|joint| joint.rotation);
        let model = avatar.model_from_joint(&rotations, avatar.joints[0].translation);
        let eyes = model[Joint::Head as usize].transform_point3(avatar.eyes_in_head);
        assert!(eyes.z > 0.05 && (0.92..0.95).contains(&(eyes.y / avatar.height)), "{eyes}");
        for (joint, transform) in Joint::ALL.into_iter().zip(&model) {
            let skin = *transform * avatar.joints[joint as usize].joint_from_mesh;
            assert!(skin.abs_diff_eq(Mat4::IDENTITY, 1e-5), "{} is not at rest", joint.name());
        }
    }
}

#[test]
fn the_finest_level_has_round_eyes_under_lids_and_the_others_have_none() {
    for sex in Sex::ALL {
        let avatar = generated(sex);
        let Some(left) = avatar.eyeball else { panic!("{} has no eyes", avatar.name) };
        let right = left * Vec3::new(-1.0, 1.0, 1.0);
        let radii = |joint: usize, center: Vec3| -> (f32, f32) {
            let own = avatar.levels[0].vertices.iter().filter(|v| usize::from(v.joints[0]) == joint);
            let sides = own.filter(|v| v.position.x * center.x > 0.0);
            let away = sides.map(|v| v.position.distance(center));
            away.fold((f32::MAX, 0.0), |(least, most), r| (least.min(r), most.max(r)))
        };
        for (eye, center) in [(LEFT_EYE, left), (RIGHT_EYE, right)] {
            let (ball, lid) = (radii(eye, center), radii(LIDS, center));
            assert!(ball.0 > 0.014 && ball.1 < ball.0 + 0.0005, "{ball:?}");
            assert!(lid.0 > ball.1 && lid.1 < ball.1 + 0.0015, "{lid:?} over {ball:?}");
        }
        // the facets of the lids do not cut into the eyeballs
        let finest = &avatar.levels[0];
        let corner = |index: u32| finest.vertices[index as usize];
        for t in finest.indices.chunks_exact(3).filter(|t| usize::from(corner(t[0]).joints[0]) == LIDS) {
            let [a, b, c] = [0, 1, 2].map(|i| corner(t[i]).position);
            let center = if a.x > 0.0 { left } else { right };
            let away = (b - a).cross(c - a).normalize().dot(a - center).abs();
            assert!(
                away > radii(LEFT_EYE, left).1,
                "{}: a lid {away} m from the middle of its eye",
                avatar.name
            );
        }
        let coarser = avatar.levels[1..].iter().flat_map(|mesh| &mesh.vertices);
        assert!(coarser.flat_map(|v| v.joints).all(|joint| usize::from(joint) < JOINT_COUNT));
    }
}

/// Of the vertices at the height of the mouth's line, moves of the middle and of a corner.
fn mouth(avatar: &Avatar) -> [FaceVertex; 2] {
    let at = |own: &&FaceVertex| avatar.levels[0].vertices[own.vertex as usize].position;
    // the lower lip's edge goes down farthest, the corner up
    let lip = avatar.face.iter().min_by(|a, b| a.opened.y.total_cmp(&b.opened.y)).unwrap();
    let corner = avatar.face.iter().filter(|own| at(own).x > 0.0);
    let corner = corner.max_by(|a, b| a.corners_up.y.total_cmp(&b.corners_up.y)).unwrap();
    [*lip, *corner]
}

#[test]
fn mouths_smile_droop_open_and_press_by_millimetres() {
    for sex in Sex::ALL {
        let [lip, corner] = mouth(&generated(sex));
        let [smile, droop] = [corner.corners_up, corner.corners_down].map(|way| way * 1e3);
        assert!(smile.y > 7.0 && smile.x > 3.0, "{smile} mm");
        assert!(lip.corners_up.y * 1e3 < 1.0, "the middle stays");
        assert!(droop.y < -6.0 && lip.corners_down.y > -1e-4, "{droop} mm");
        assert!(lip.opened.y * 1e3 < -8.0 && corner.opened.length() * 1e3 < 0.2, "{}", lip.opened);
        let pressed = generated(sex).face.iter().map(|own| own.pressed.y).fold(0.0, f32::max);
        assert!(pressed * 1e3 > 2.0, "lips grow thin: {pressed}");
    }
}

#[test]
fn brows_move_at_either_end() {
    for sex in Sex::ALL {
        let avatar = generated(sex);
        let brow = avatar.levels[0].vertices.iter().zip(0..).filter(|(v, number)| {
            let is_moved = avatar.face.iter().any(|own| own.vertex == *number);
            v.material == Material::Hair && v.position.x > 0.0 && is_moved
        });
        let of = |number: u32| *avatar.face.iter().find(|own| own.vertex == number).unwrap();
        let [inner, outer] = [1.0, -1.0].map(|side| {
            brow.clone()
                .min_by(|(a, _), (b, _)| (side * a.position.x).total_cmp(&(side * b.position.x)))
                .unwrap()
        });
        let [inner, outer] = [of(inner.1), of(outer.1)];
        assert!(inner.inner_brow.y > 0.006 && inner.outer_brow.y.abs() < 1e-4, "{inner:?}");
        assert!(outer.outer_brow.y > 0.004 && outer.inner_brow.y.abs() < 1e-4, "{outer:?}");
    }
}

fn is_of_hand(own: &FaceVertex) -> bool {
    own.fist != Vec3::ZERO || own.fist_normal != Vec3::ZERO
}

#[test]
fn a_face_tears_nowhere_but_between_the_lips_and_only_its_front_moves() {
    for sex in Sex::ALL {
        let avatar = generated(sex);
        let vertices = &avatar.levels[0].vertices;
        let all: HashMap<u32, FaceVertex> =
            avatar.face.iter().map(|own| (own.vertex, FaceVertex { vertex: 0, ..*own })).collect();
        let mut found: HashMap<glam::IVec3, FaceVertex> = HashMap::new();
        for (vertex, number) in vertices.iter().zip(0..) {
            let own = all.get(&number).copied().unwrap_or_default();
            if own != FaceVertex::default() && !is_of_hand(&own) {
                assert!(vertex.position.z > 0.0 && usize::from(vertex.joints[0]) == Joint::Head as usize);
            }
            let first = *found.entry((vertex.position * 1e6).round().as_ivec3()).or_insert(own);
            assert_eq!(FaceVertex { opened: first.opened, ..own }, first, "at {}", vertex.position);
        }
        let moved = avatar.face.iter().filter(|own| !is_of_hand(own)).count();
        println!("{}: a face moves {moved} of {} vertices", avatar.name, vertices.len());
        assert!((200..900).contains(&moved));
    }
}

#[test]
fn fingers_close_into_the_palm_and_stay_fingers() {
    for sex in Sex::ALL {
        let avatar = generated(sex);
        let size = if sex == Sex::Male { 1.0 } else { 0.88 };
        let vertices = &avatar.levels[0].vertices;
        let wrist = Measures::of(sex).bones.of(Joint::LeftHand);
        let fingers: Vec<_> = avatar
            .face
            .iter()
            .filter(|own| vertices[own.vertex as usize].position.x > 0.0 && own.fist != Vec3::ZERO)
            .collect();
        let far = |clenched: f32| {
            let from_wrist = |own: &&FaceVertex| {
                (vertices[own.vertex as usize].position + own.fist * clenched).distance(wrist)
            };
            fingers.iter().map(from_wrist).fold(0.0, f32::max) / size
        };
        let [rest, fist] = [far(0.0), far(1.0)];
        assert!(
            (0.13..0.20).contains(&rest) && (0.09..0.13).contains(&fist),
            "{rest} m, {fist} m from the wrist"
        );
        for own in &fingers {
            let vertex = &vertices[own.vertex as usize];
            assert_eq!(usize::from(vertex.joints[0]), Joint::LeftHand as usize);
            let length = (vertex.normal + own.fist_normal).length();
            assert!((length - 1.0).abs() < 1e-4, "a normal of {length}");
        }
        let ways: HashMap<u32, &FaceVertex> = fingers.iter().map(|own| (own.vertex, *own)).collect();
        // area, and whether it faces where its normals say
        let of_fingers = |t: &[u32], clenched: f32| -> Option<(f32, bool)> {
            let corner = |number: u32| {
                let (at, own) = (&vertices[number as usize], ways.get(&number)?);
                Some((at.position + own.fist * clenched, at.normal + own.fist_normal * clenched))
            };
            let [a, b, c] = [corner(t[0])?, corner(t[1])?, corner(t[2])?];
            let across = (b.0 - a.0).cross(c.0 - a.0);
            Some((0.5 * across.length(), across.dot(a.1 + b.1 + c.1) > 0.0))
        };
        let area = |clenched: f32| -> f32 {
            let triangles = avatar.levels[0].indices.chunks_exact(3);
            let all: Vec<_> = triangles.filter_map(|t| of_fingers(t, clenched)).collect();
            assert!(all.len() > 60 && all.iter().all(|(_, is_outside)| *is_outside), "normals at {clenched}");
            all.iter().map(|(area, _)| area).sum()
        };
        let ratio = area(1.0) / area(0.0);
        assert!((0.8..1.05).contains(&ratio), "clenched fingers have {ratio} of their skin");
    }
}

#[test]
fn beards_and_glasses_are_seen_in_the_first_two_levels() {
    for sex in Sex::ALL {
        let avatar = generated(sex);
        let levels = &avatar.wardrobe.as_ref().unwrap().levels;
        let has = |tailored: &[Tailoring], part| tailored.iter().any(|own| own.part == part);
        let found = |level: &Clothes| [has(&level.own, BEARD), has(&level.of_others, GLASSES)];
        let wanted = [sex == Sex::Male, true];
        let found: Vec<_> = levels.iter().map(found).collect();
        assert_eq!(found, [wanted, wanted, [false; 2]], "{}", avatar.name);
    }
}
