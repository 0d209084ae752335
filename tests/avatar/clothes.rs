//! No skin is seen through cloth, whatever the outfit and the phase of the stride.

use super::stroll::Walker;
use gaitway::Emotion;
use gaitway::avatar::wardrobe::{Outfit, Tailoring};
use gaitway::avatar::{Material, Mesh, Sex, Vertex, generated};
use gaitway::gait::walker;
use gaitway::kernels::shared::outfit::{
    BARE_LEGS, COAT, JACKET, LOWER_LEG, LOWER_SLEEVE, SKIRT, TORSO, TROUSERS, UPPER_SLEEVE,
};
use glam::{Mat4, Quat, Vec3};
use rayon::prelude::*;

/// Pixels of a metre, and of a side of the picture.
const SCALE: f32 = 90.0;
const SIDE: usize = 180;
/// Directions that people are seen from.
const VIEWS: u8 = 4;

/// What a triangle is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shown {
    /// Of legs. Nothing else has skin under its cloth: hands and head may be before anything, and a neck is in a collar.
    Skin,
    /// A skirt, trousers, a top or a jacket.
    Cloth,
    Other,
}

fn shown(vertex: &Vertex, own: &Tailoring) -> Shown {
    match (own.part, vertex.material) {
        (SKIRT | TROUSERS | JACKET | COAT | TORSO, _) => Shown::Cloth,
        (BARE_LEGS | LOWER_LEG, Material::Skin) => Shown::Skin,
        _ => Shown::Other,
    }
}

/// The outfits that have something over skin.
fn outfits(sex: Sex) -> Vec<Outfit> {
    let with = |parts: &[u32]| {
        let worn = parts.iter().fold(1 << TORSO | 1 << UPPER_SLEEVE, |worn, part| worn | 1 << part);
        Outfit { worn, colors: 0 }
    };
    match sex {
        Sex::Female => vec![
            with(&[SKIRT, BARE_LEGS]),
            with(&[SKIRT, BARE_LEGS, JACKET, LOWER_SLEEVE]),
            with(&[SKIRT, BARE_LEGS, JACKET, COAT, LOWER_SLEEVE]),
            with(&[TROUSERS, JACKET, LOWER_SLEEVE]),
        ],
        Sex::Male => vec![with(&[LOWER_LEG]), with(&[JACKET, LOWER_SLEEVE, LOWER_LEG])],
    }
}

/// How far at most what comes through cloth is before it, m: what is before it by more is a leg before another part.
const THROUGH: f32 = 0.03;

/// What is seen of an outfit: at every pixel the nearest depths of skin, of cloth over it, and of anything, m.
struct Picture {
    skin: Vec<f32>,
    cloth: Vec<f32>,
    all: Vec<f32>,
}

impl Picture {
    fn new() -> Self {
        let empty = vec![f32::MAX; SIDE * SIDE];
        Self { skin: empty.clone(), cloth: empty.clone(), all: empty }
    }

    /// Pixels that show skin with cloth right behind it.
    fn through_cloth(&self) -> usize {
        let pixels = self.skin.iter().zip(&self.cloth).zip(&self.all);
        pixels
            .filter(|((skin, cloth), all)| **skin < f32::MAX && skin <= all && **cloth - **skin < THROUGH)
            .count()
    }

    /// Draws the front of everything that an outfit shows, seen from a direction about the vertical.
    fn draw(&mut self, (mesh, tailoring, places): &Part<'_>, outfit: &Outfit, turn: f32) {
        let view = Quat::from_rotation_y(turn);
        for t in mesh.indices.chunks_exact(3) {
            let ids = [t[0] as usize, t[1] as usize, t[2] as usize];
            if !outfit.shows(&tailoring[ids[0]]) {
                continue;
            }
            let kind = shown(&mesh.vertices[ids[0]], &tailoring[ids[0]]);
            let corners = ids.map(|id| {
                let q = view * places[id];
                Vec3::new((q.x + 1.0) * SCALE, (1.95 - q.y) * SCALE, -q.z)
            });
            self.triangle(corners, kind);
        }
    }

    fn triangle(&mut self, p: [Vec3; 3], kind: Shown) {
        let cross = |a: Vec3, b: Vec3, c: Vec3| (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        let area = cross(p[0], p[1], p[2]);
        if area >= 0.0 {
            return; // a back
        }
        let (low, high) = (p[0].min(p[1]).min(p[2]), p[0].max(p[1]).max(p[2]));
        let clamp = |v: f32| (v.max(0.0) as usize).min(SIDE);
        for y in clamp(low.y)..clamp(high.y + 1.0) {
            for x in clamp(low.x)..clamp(high.x + 1.0) {
                let q = Vec3::new(x as f32 + 0.5, y as f32 + 0.5, 0.0);
                let w = [cross(p[1], p[2], q), cross(p[2], p[0], q), cross(p[0], p[1], q)].map(|v| v / area);
                if w.iter().any(|w| *w < 0.0) {
                    continue;
                }
                let depth: f32 = (0..3).map(|i| w[i] * p[i].z).sum();
                let at = y * SIDE + x;
                self.all[at] = self.all[at].min(depth);
                match kind {
                    Shown::Skin => self.skin[at] = self.skin[at].min(depth),
                    Shown::Cloth => self.cloth[at] = self.cloth[at].min(depth),
                    Shown::Other => {}
                }
            }
        }
    }
}

/// A mesh, what outfits do to it, and where its vertices are.
type Part<'a> = (&'a Mesh, &'a [Tailoring], Vec<Vec3>);

/// Pixels of skin through cloth over the phases of a gait, of all outfits and directions.
fn found(emotion: Emotion, sex: walker::Sex, number: u32, phases: u32) -> usize {
    let body = if sex == walker::Sex::Female { Sex::Female } else { Sex::Male };
    let gait = walker::person(emotion, sex, 1, number).unwrap();
    let mut walker = Walker::new(gait, generated(body), 1.0);
    let avatar = walker.avatar.clone();
    let clothes = &avatar.wardrobe.as_ref().unwrap().levels[0];
    let mut sum = 0;
    for phase in 0..phases {
        walker.store.stance[0].phase = ((phase << 16) / phases) << 16;
        walker.draw();
        let joints = walker.joints();
        let palette: Vec<Mat4> =
            joints.iter().zip(&avatar.joints).map(|(world, rest)| *world * rest.joint_from_mesh).collect();
        let place = |v: &Vertex| -> Vec3 {
            let joints = v.driven_joints().into_iter().zip(v.weights);
            joints
                .map(|(joint, weight)| palette[usize::from(joint)].transform_point3(v.position) * weight)
                .sum()
        };
        let posed = |mesh: &Mesh| mesh.vertices.iter().map(place).collect::<Vec<_>>();
        let own = &avatar.levels[0];
        let parts = [
            (own, clothes.own.as_slice(), posed(own)),
            (&clothes.others, clothes.of_others.as_slice(), posed(&clothes.others)),
        ];
        for outfit in outfits(body) {
            for view in 0..VIEWS {
                let turn = std::f32::consts::TAU * f32::from(view) / f32::from(VIEWS);
                let mut picture = Picture::new();
                parts.iter().for_each(|part| picture.draw(part, &outfit, turn));
                sum += picture.through_cloth();
            }
        }
    }
    sum
}

fn is_whole(individuals: u32, phases: u32) {
    let sexes = [walker::Sex::Female, walker::Sex::Male];
    let all: Vec<_> = Emotion::ALL
        .into_iter()
        .flat_map(|emotion| sexes.map(|sex| (emotion, sex)))
        .flat_map(|(emotion, sex)| (0..individuals).map(move |number| (emotion, sex, number)))
        .collect();
    let counts: Vec<usize> = all
        .par_iter()
        .map(|(emotion, sex, number)| {
            let found = found(*emotion, *sex, *number, phases);
            if found > 0 {
                println!("{emotion}, {sex:?} {number}: {found} pixels");
            }
            found
        })
        .collect();
    assert_eq!(counts.iter().sum::<usize>(), 0, "pixels of skin through cloth in {} gaits", all.len());
}

#[test]
fn no_skin_comes_through_cloth_in_64_phases_of_24_gaits() {
    is_whole(3, 64);
}

#[test]
fn skin_right_before_cloth_is_found_and_a_leg_before_the_other_is_none() {
    let square = |picture: &mut Picture, depth: f32, kind: Shown| {
        let at = |x: f32, y: f32| Vec3::new(x, y, depth);
        picture.triangle([at(10.0, 10.0), at(10.0, 30.0), at(30.0, 10.0)], kind);
    };
    for (before, is_through) in [(0.01, true), (0.1, false), (-0.01, false)] {
        let mut picture = Picture::new();
        square(&mut picture, 1.0, Shown::Cloth);
        square(&mut picture, 1.0 - before, Shown::Skin);
        assert_eq!(picture.through_cloth() > 100, is_through, "{before} m before the cloth");
    }
}
