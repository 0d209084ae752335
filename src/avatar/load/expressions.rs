//! VRM's expressions: what they move of a face, as our numbers of a face move it.

use super::super::FaceVertex;
use super::super::body_model::UNSEEN;
use super::accessor::{self, Buffer};
use crate::emotion::Emotion;
use crate::kernels::eyes::{BY_MOUTH_CORNER, BY_MOUTH_OPEN};
use glam::Vec3;
use serde_json::Value;

/// Which of VRM's expressions, by their names in VRM 1.0 and 0.x.
const NAMES: [[&str; 2]; 5] =
    [["happy", "joy"], ["angry", "angry"], ["sad", "sorrow"], ["aa", "a"], ["blink", "blink"]];

/// How far a vertex goes with each of them, m: the happy, angry and sad face, the open mouth, shut eyes.
pub(super) type Ways = [Vec3; NAMES.len()];

/// A share of a morph target of a mesh.
#[derive(Debug, Clone, Copy)]
struct Bind {
    mesh: usize,
    target: usize,
    weight: f32,
}

/// The expressions of a file, in the order of [`NAMES`].
#[derive(Debug, Clone, Default)]
pub(super) struct Expressions([Vec<Bind>; NAMES.len()]);

impl Expressions {
    /// Those of a document; nothing in a file that is no VRM.
    pub(super) fn of(json: &Value) -> Self {
        let mut all = Self::default();
        let presets = &json["extensions"]["VRMC_vrm"]["expressions"]["preset"];
        let groups = &json["extensions"]["VRM"]["blendShapeMaster"]["blendShapeGroups"];
        for (binds, [name, old_name]) in all.0.iter_mut().zip(NAMES) {
            for bind in list(&presets[name]["morphTargetBinds"]) {
                let mesh = number(&bind["node"]).and_then(|node| number(&json["nodes"][node]["mesh"]));
                binds.extend(Bind::of(mesh, bind, 1.0));
            }
            let is_wanted = |group: &&Value| {
                group["presetName"].as_str().is_some_and(|own| own.eq_ignore_ascii_case(old_name))
            };
            for bind in list(groups).iter().filter(is_wanted).flat_map(|group| list(&group["binds"])) {
                binds.extend(Bind::of(number(&bind["mesh"]), bind, 0.01));
            }
        }
        all
    }

    /// How far they move the vertices of a primitive, file space; nothing where they do not move it.
    ///
    /// # Errors
    /// A message where the file does not have what an expression names.
    pub(super) fn ways(
        &self,
        primitive: &gltf::Primitive<'_>,
        mesh: usize,
        count: usize,
        buffers: &[Buffer],
    ) -> Result<Vec<Ways>, String> {
        let own = |bind: &&Bind| bind.mesh == mesh && bind.weight != 0.0;
        if !self.0.iter().flatten().any(|bind| own(&bind)) {
            return Ok(Vec::new());
        }
        let targets: Vec<_> = primitive.morph_targets().collect();
        if targets.is_empty() {
            return Ok(Vec::new());
        }
        let mut ways = vec![Ways::default(); count];
        for (which, binds) in self.0.iter().enumerate() {
            for bind in binds.iter().filter(own) {
                let target = targets.get(bind.target).ok_or_else(|| {
                    let [name, _] = NAMES[which];
                    format!(
                        "has {} morph targets, but the expression {name} names number {}",
                        targets.len(),
                        bind.target
                    )
                })?;
                let Some(places) = target.positions() else { continue };
                let moved = accessor::vec3(&places, buffers)?;
                if moved.len() != count {
                    return Err(format!(
                        "has {count} positions but {} in morph target {}",
                        moved.len(),
                        bind.target
                    ));
                }
                ways.iter_mut().zip(moved).for_each(|(way, moved)| way[which] += moved * bind.weight);
            }
        }
        Ok(ways)
    }

    pub(super) fn are_any(&self) -> bool {
        self.0.iter().any(|binds| !binds.is_empty())
    }

    /// The names of those that the file has.
    pub(super) fn names(&self) -> Vec<&'static str> {
        let used = self.0.iter().zip(NAMES).filter(|(binds, _)| !binds.is_empty());
        used.map(|(_, [name, _])| name).collect()
    }
}

impl Bind {
    /// `full`: what one of the document's units of weight is.
    fn of(mesh: Option<usize>, json: &Value, full: f32) -> Option<Self> {
        #[allow(clippy::cast_possible_truncation, reason = "a share")]
        let weight = (json["weight"].as_f64()? as f32 * full).clamp(0.0, 1.0);
        Some(Self { mesh: mesh?, target: number(&json["index"])?, weight })
    }
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn number(value: &Value) -> Option<usize> {
    value.as_u64().and_then(|number| usize::try_from(number).ok())
}

/// What the numbers of a face move of a vertex, so that a happy, angry or sad face at full strength is the file's: mouths of
/// several of them move with one number, so each is without its share of the other. VRM names no brows: they move with the
/// mouth's numbers. Nothing where no movement is seen.
pub(super) fn face_vertex(vertex: u32, ways: &Ways) -> Option<FaceVertex> {
    if ways.iter().all(|way| way.length() < UNSEEN) {
        return None;
    }
    let [happy, angry, sad, opened, blink] = *ways;
    let by = |numbers: [f32; 4], emotion: Emotion| numbers[emotion.index()];
    let (drooping, open) = (-by(BY_MOUTH_CORNER, Emotion::Angry), by(BY_MOUTH_OPEN, Emotion::Happy));
    let pressing = -by(BY_MOUTH_OPEN, Emotion::Sad);
    // angry = pressed + drooping * down, sad = down + pressing * pressed
    let pressed = (angry - sad * drooping) / (1.0 - drooping * pressing);
    Some(FaceVertex {
        vertex,
        corners_up: happy - opened * open,
        corners_down: sad - pressed * pressing,
        opened,
        pressed,
        blink,
        ..FaceVertex::default()
    })
}
