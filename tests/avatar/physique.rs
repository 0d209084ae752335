//! What people's measures make of the bodies as drawn: girths, statures, feet.

use gaitway::avatar::anthropometry::{Build, Measure, Person, adult, correlated};
use gaitway::avatar::{Avatar, Sex, generated};
use gaitway::gait::{JOINT_COUNT, Joint};
use gaitway::kernels::layout::{Appearance, Stance};
use gaitway::kernels::shared::body::NONE;
use gaitway::kernels::shared::body::index::{PALETTE_STRIDE, POSE_STRIDE, VERTEX_STRIDE, WAIST};
use gaitway::kernels::{Phase, Store};
use gaitway::reference;
use gaitway::reference::exact::{hash_u32, unit_f32};
use gaitway::sim::bodies::{pack_avatars, pack_rig};
use glam::{Vec2, Vec3, Vec4};

/// People of one sex who stand at rest on one another's places, and what they are.
struct Standing {
    avatar: Avatar,
    store: Store,
    people: Vec<Person>,
    vertices: Vec<[[f32; 4]; VERTEX_STRIDE]>,
}

/// The next normal numbers of a seed.
fn normals<const N: usize>(seed: &mut u32) -> [f32; N] {
    let mut unit = || {
        *seed += 1;
        unit_f32(hash_u32(*seed))
    };
    std::array::from_fn(|_| (0..12).map(|_| unit()).sum::<f32>() - 6.0)
}

/// Adults as in ANSUR II.
pub(crate) fn adults(sex: Sex, count: usize) -> Vec<Person> {
    let mut seed = (sex as u32 + 1) << 24;
    (0..count)
        .map(|_| {
            let [stature, weight] = adult(sex, normals(&mut seed));
            let residuals = correlated(sex, &normals(&mut seed));
            Person { sex, age: None, stature, weight, residuals }
        })
        .collect()
}

impl Standing {
    fn new(people: Vec<Person>) -> Self {
        let avatar = generated(people[0].sex);
        let mut store = Store { rig: pack_rig(std::slice::from_ref(&avatar)), ..Store::default() };
        for (agent, person) in people.iter().enumerate() {
            let scale = Build::scale(person);
            let mut looks = Appearance::new(0, 3, false, scale, [0; 4]);
            let build = Build::of(person, scale);
            looks.set_size(build.stature, build.breadth);
            store.visible.push(agent as u32);
            store.position.push([0.0; 2]);
            store.heading.push(0.0);
            store.stance.push(Stance::default());
            store.appearance.push(looks);
            store.physique.push(build.physique);
            store.local_rotations.extend(avatar.joints.map(|joint| joint.rotation.to_array()));
            store.local_rotations.push(avatar.joints[0].translation.extend(1.0).to_array());
        }
        assert_eq!(store.local_rotations.len(), people.len() * POSE_STRIDE);
        store.visible.push(NONE);
        store.palettes = vec![[0.0; 4]; people.len() * PALETTE_STRIDE];
        reference::run(Phase::Palette, &mut store, 0);
        let all = pack_avatars(std::slice::from_ref(&avatar)).vertices;
        let finest = all.chunks_exact(VERTEX_STRIDE).take(avatar.levels[0].vertices.len());
        let vertices = finest.map(|rows| rows.try_into().unwrap()).collect();
        Self { avatar, store, people, vertices }
    }

    /// The finest mesh of one of them, world, m. What hangs on eyes and lids hangs on the head.
    fn skinned(&self, number: usize) -> Vec<Vec3> {
        let palette = &self.store.palettes[number * PALETTE_STRIDE..][..PALETTE_STRIDE];
        let place = |rows: &[[f32; 4]; VERTEX_STRIDE]| {
            let [x, y, z, _] = rows[0];
            let joints = rows[1][3].to_bits().to_le_bytes();
            let at = |joint: usize| {
                let joint = if joint > WAIST { Joint::Head as usize } else { joint };
                let row = |axis: usize| Vec4::from(palette[joint * 3 + axis]).dot(Vec4::new(x, y, z, 1.0));
                Vec3::new(row(0), row(1), row(2))
            };
            joints.into_iter().zip(rows[2]).map(|(joint, weight)| at(usize::from(joint)) * weight).sum()
        };
        self.vertices.iter().map(place).collect()
    }

    /// The girth of what hangs mostly on some joints, at a height of the mesh at rest, by a tape around it, m.
    fn girth(&self, skin: &[Vec3], height: f32, joints: &[usize]) -> f32 {
        let mesh = &self.avatar.levels[0];
        let share_of = |index: u32| {
            let rows = &self.vertices[index as usize];
            let bytes = rows[1][3].to_bits().to_le_bytes();
            let share = |joint: usize| -> f32 {
                let pairs = bytes.iter().zip(rows[2]);
                pairs.filter(|(own, _)| usize::from(**own) == joint).map(|(_, weight)| weight).sum()
            };
            joints.iter().map(|joint| share(*joint)).sum::<f32>()
        };
        let mostly = |triangle: &&[u32]| triangle.iter().map(|index| share_of(*index)).sum::<f32>() > 1.2;
        let mut cut: Vec<Vec2> = Vec::new();
        for triangle in mesh.indices.chunks_exact(3).filter(mostly) {
            for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                let [a, b] = [triangle[from], triangle[to]].map(|index| index as usize);
                let [low, high] = [a, b].map(|index| mesh.vertices[index].position.y - height);
                if (low < 0.0) != (high < 0.0) {
                    let p = skin[a].lerp(skin[b], low / (low - high));
                    cut.push(Vec2::new(p.x, p.z));
                }
            }
        }
        tape(cut)
    }
}

/// The length of the shortest line around points, m.
fn tape(mut points: Vec<Vec2>) -> f32 {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let half = |points: &mut dyn Iterator<Item = Vec2>| {
        let mut hull: Vec<Vec2> = Vec::new();
        for point in points {
            while let [.., a, b] = hull[..] {
                if (b - a).perp_dot(point - b) > 0.0 {
                    break;
                }
                hull.pop();
            }
            hull.push(point);
        }
        hull.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f32>()
    };
    half(&mut points.iter().copied()) + half(&mut points.iter().rev().copied())
}

fn mean_and_deviation(values: &[f32]) -> [f32; 2] {
    let count = values.len() as f32;
    let mean = values.iter().sum::<f32>() / count;
    [mean, (values.iter().map(|x| (x - mean) * (x - mean)).sum::<f32>() / count).sqrt()]
}

const TRUNK: [usize; 5] =
    [Joint::Root as usize, Joint::Spine as usize, WAIST, Joint::LeftHip as usize, Joint::RightHip as usize];

#[test]
fn drawn_adults_have_the_girths_and_statures_of_ansur() {
    /// Women and men of ANSUR II, mm: mean and deviation; at these heights of the mesh over its stature.
    const TAKEN: [(&str, f32, [f32; 2], [f32; 2]); 3] = [
        ("chest", 0.727, [946.9, 82.7], [1058.7, 87.4]),
        ("waist", 0.602, [860.9, 99.9], [940.6, 111.7]),
        ("hips", 0.509, [1021.2, 75.9], [1019.5, 76.7]),
    ];
    let statures = [[1628.5, 64.2], [1756.2, 68.6]];
    for sex in Sex::ALL {
        let standing = Standing::new(adults(sex, 500));
        let skins: Vec<Vec<Vec3>> = (0..500).map(|number| standing.skinned(number)).collect();
        let judge = |what: &str, found: Vec<f32>, [want, spread]: [f32; 2]| {
            let [mean, deviation] = mean_and_deviation(&found);
            println!("{sex:?} {what}: {mean:.1} +- {deviation:.1} mm, ANSUR II {want} +- {spread}");
            assert!((mean / want - 1.0).abs() < 0.03, "{sex:?} {what}: {mean} not {want} mm");
            assert!((deviation / spread - 1.0).abs() < 0.15, "{sex:?} {what}: {deviation} not {spread} mm");
        };
        let top = |skin: &Vec<Vec3>| 1e3 * skin.iter().map(|p| p.y).fold(0.0, f32::max);
        judge("stature", skins.iter().map(top).collect(), statures[sex as usize]);
        for (what, share, women, men) in TAKEN {
            let height = share * standing.avatar.height;
            let girths = skins.iter().map(|skin| 1e3 * standing.girth(skin, height, &TRUNK)).collect();
            judge(what, girths, [women, men][sex as usize]);
        }
        let limbs: [(&str, Measure, usize, usize, f32); 2] = [
            ("calf", Measure::Calf, Joint::LeftKnee as usize, Joint::LeftFoot as usize, 0.33),
            ("forearm", Measure::Forearm, Joint::LeftElbow as usize, Joint::LeftHand as usize, 0.25),
        ];
        for (what, measure, from, to, share) in limbs {
            let [a, b] = [from, to].map(|joint| {
                standing.avatar.joints[joint].joint_from_mesh.inverse().transform_point3(Vec3::ZERO)
            });
            // the cut is level, and a limb hangs a little aslant
            let aslant = (b - a).normalize().y.abs().sqrt();
            let of = |(skin, person): (&Vec<Vec3>, &Person)| {
                let girth = standing.girth(skin, a.lerp(b, share).y, &[from]) * aslant;
                girth / person.measure(measure)
            };
            let ratios: Vec<f32> = skins.iter().zip(&standing.people).map(of).collect();
            let [mean, _] = mean_and_deviation(&ratios);
            println!("{sex:?} {what}: {mean:.3} of what they are to be");
            assert!(
                (mean - 1.0).abs() < 0.03 && ratios.iter().all(|ratio| (ratio - 1.0).abs() < 0.06),
                "{mean}"
            );
        }
    }
}

#[test]
fn each_is_as_tall_as_it_is_and_stands_on_feet_that_a_physique_leaves_alone() {
    for sex in Sex::ALL {
        let standing = Standing::new(adults(sex, 200));
        for (number, person) in standing.people.iter().enumerate() {
            let skin = standing.skinned(number);
            let top = skin.iter().map(|p| p.y).fold(0.0, f32::max);
            assert!((top / person.stature - 1.0).abs() < 0.004, "{top} not {} m", person.stature);
            let scale = standing.store.appearance[number].scale;
            let feet = standing.avatar.levels[0].vertices.iter().zip(&skin);
            let is_foot =
                |joint: u8| [Joint::LeftFoot, Joint::RightFoot].iter().any(|foot| joint == *foot as u8);
            for (rest, at) in feet.filter(|(rest, _)| is_foot(rest.joints[0]) && rest.weights[0] > 0.999) {
                assert!(at.distance(rest.position * scale) < 1e-5, "{at} not {}", rest.position * scale);
            }
        }
    }
}

#[test]
fn a_body_of_no_physique_is_its_avatars() {
    for sex in Sex::ALL {
        let mut standing = Standing::new(adults(sex, 1));
        standing.store.physique.fill(gaitway::kernels::layout::Physique::default());
        standing.store.appearance[0].scale = 1.0;
        reference::run(Phase::Palette, &mut standing.store, 0);
        let skin = standing.skinned(0);
        for (rest, at) in standing.avatar.levels[0].vertices.iter().zip(&skin) {
            assert!(at.distance(rest.position) < 1e-5, "{at} not {}", rest.position);
        }
        assert_eq!(standing.store.local_rotations.len(), JOINT_COUNT + 1);
    }
}
