//! The skeleton, ASF: units, root, bones, hierarchy.

use super::super::MAX_JOINTS;
use super::super::text::{number, shown, syntax};
use super::lines;
use crate::gait::Error;
use glam::{Quat, Vec3};
use std::collections::HashMap;

/// One value of a frame of the root or of a bone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Freedom {
    Translation(usize),
    Rotation(usize),
}

#[derive(Debug, Clone)]
pub(super) struct Bone {
    pub(super) name: String,
    /// Index of the parent, which stands before its children; the root is bone 0.
    pub(super) parent: usize,
    /// From the bone's begin to its end in the rest pose, file units.
    pub(super) vector: Vec3,
    /// The axis frame `C`.
    pub(super) axis: Quat,
    pub(super) freedoms: Vec<Freedom>,
    line: usize,
}

/// A skeleton read from an ASF file.
#[derive(Debug, Clone)]
pub struct Skeleton {
    /// The root, then the bones, parents first.
    pub(super) bones: Vec<Bone>,
    /// The root's rest position, file units.
    pub(super) position: Vec3,
    pub(super) metres_per_unit: f32,
    pub(super) degrees: bool,
}

impl Skeleton {
    /// Names of the root and the bones.
    pub fn names(&self) -> Vec<&str> {
        self.bones.iter().map(|bone| bone.name.as_str()).collect()
    }
}
fn vec3<'a>(
    path: &str,
    line: usize,
    words: &mut impl Iterator<Item = &'a str>,
    what: &str,
) -> Result<Vec3, Error> {
    let mut axes = [0.0; 3];
    for value in &mut axes {
        let word = words.next().ok_or_else(|| syntax(path, line, format!("{what} needs 3 numbers")))?;
        *value = number(path, line, word, what)?;
    }
    Ok(Vec3::from(axes))
}

/// `Rz Ry Rx` for "XYZ": the first letter turns first. Angles in radians, by axis in the order x, y, z.
fn euler(path: &str, line: usize, order: &str, angles: Vec3) -> Result<Quat, Error> {
    let mut rotation = Quat::IDENTITY;
    let mut seen = [false; 3];
    for letter in order.chars() {
        let axis = "XYZ".find(letter.to_ascii_uppercase()).filter(|&axis| !seen[axis]);
        let Some(axis) = axis else {
            return Err(syntax(
                path,
                line,
                format!("axis order {} is not one of XYZ, ZYX, ...", shown(order)),
            ));
        };
        seen[axis] = true;
        rotation = Quat::from_axis_angle(Vec3::AXES[axis], angles[axis]) * rotation;
    }
    Ok(rotation)
}

fn freedom(path: &str, line: usize, word: &str) -> Result<Freedom, Error> {
    Ok(match word.to_ascii_lowercase().as_str() {
        "tx" => Freedom::Translation(0),
        "ty" => Freedom::Translation(1),
        "tz" => Freedom::Translation(2),
        "rx" => Freedom::Rotation(0),
        "ry" => Freedom::Rotation(1),
        "rz" => Freedom::Rotation(2),
        _ => {
            let message = format!("unknown degree of freedom {}; known are tx ty tz rx ry rz", shown(word));
            return Err(syntax(path, line, message));
        }
    })
}

fn freedoms<'a>(
    path: &str,
    line: usize,
    words: impl Iterator<Item = &'a str>,
) -> Result<Vec<Freedom>, Error> {
    let mut freedoms = Vec::new();
    for word in words {
        let freedom = freedom(path, line, word)?;
        if freedoms.contains(&freedom) {
            return Err(syntax(path, line, format!("degree of freedom {word} twice")));
        }
        freedoms.push(freedom);
    }
    Ok(freedoms)
}

/// What an ASF file says, before the hierarchy is put in order.
struct Draft<'a> {
    path: &'a str,
    root: Bone,
    bones: Vec<Bone>,
    /// (parent name, child name, line).
    links: Vec<(&'a str, &'a str, usize)>,
    position: Vec3,
    orientation: Vec3,
    /// Axis order and raw angles of each bone's axis line; angles wait for the unit.
    root_order: String,
    length: f32,
    degrees: bool,
    sections: Vec<&'a str>,
}

/// Parses an ASF skeleton. `path` names it in messages.
///
/// # Errors
/// [`Error::Syntax`] with the line of the first fault.
pub fn parse_asf(text: &str, path: &str) -> Result<Skeleton, Error> {
    let root = Bone {
        name: "root".to_owned(),
        parent: 0,
        vector: Vec3::ZERO,
        axis: Quat::IDENTITY,
        freedoms: Vec::new(),
        line: 0,
    };
    let mut draft = Draft {
        path,
        root,
        bones: Vec::new(),
        links: Vec::new(),
        position: Vec3::ZERO,
        orientation: Vec3::ZERO,
        root_order: "XYZ".to_owned(),
        length: 1.0,
        degrees: true,
        sections: Vec::new(),
    };
    let mut rows = lines(text);
    let mut section = "";
    while let Some((line, row)) = rows.next() {
        if let Some(keyword) = row.strip_prefix(':') {
            section = keyword.split_whitespace().next().unwrap_or_default();
            draft.sections.push(section);
            continue;
        }
        match section {
            "units" => draft.units(line, row)?,
            "root" => draft.root_row(line, row)?,
            "bonedata" if row == "begin" => draft.bone(line, &mut rows)?,
            "bonedata" => {
                return Err(syntax(
                    path,
                    line,
                    format!("found {} between bones; expected begin", shown(row)),
                ));
            }
            "hierarchy" => draft.link(line, row),
            // version, name, documentation, skin: nothing we need.
            _ => {}
        }
    }
    for needed in ["root", "bonedata", "hierarchy"] {
        if !draft.sections.contains(&needed) {
            return Err(syntax(
                path,
                0,
                format!("section :{needed} is missing; is it an ASF skeleton, or cut off?"),
            ));
        }
    }
    draft.finish()
}

impl<'a> Draft<'a> {
    fn radians(&self, angles: Vec3) -> Vec3 {
        if self.degrees { angles * std::f32::consts::PI / 180.0 } else { angles }
    }

    fn units(&mut self, line: usize, row: &str) -> Result<(), Error> {
        let mut words = row.split_whitespace();
        match (words.next(), words.next()) {
            (Some("length"), Some(word)) => {
                self.length = number(self.path, line, word, "unit of length")?;
                if !(1e-4..=1e4).contains(&self.length) {
                    let message = format!("unit of length is {}; it must be from 1e-4 to 1e4", self.length);
                    return Err(syntax(self.path, line, message));
                }
            }
            (Some("angle"), Some("deg")) => self.degrees = true,
            (Some("angle"), Some("rad")) => self.degrees = false,
            (Some("angle"), other) => {
                let found = shown(other.unwrap_or_default());
                return Err(syntax(
                    self.path,
                    line,
                    format!("unit of angle is {found}; known are deg and rad"),
                ));
            }
            _ => {}
        }
        Ok(())
    }

    fn root_row(&mut self, line: usize, row: &str) -> Result<(), Error> {
        let mut words = row.split_whitespace();
        match words.next() {
            Some("order") => self.root.freedoms = freedoms(self.path, line, words)?,
            Some("axis") => self.root_order = words.next().unwrap_or("XYZ").to_owned(),
            Some("position") => self.position = vec3(self.path, line, &mut words, "root position")?,
            Some("orientation") => self.orientation = vec3(self.path, line, &mut words, "root orientation")?,
            _ => {}
        }
        self.root.line = line;
        Ok(())
    }

    /// One bone, from the line after `begin` to `end`.
    fn bone(&mut self, begin: usize, rows: &mut impl Iterator<Item = (usize, &'a str)>) -> Result<(), Error> {
        let path = self.path;
        if self.bones.len() + 1 >= MAX_JOINTS {
            return Err(syntax(path, begin, format!("more than {MAX_JOINTS} bones")));
        }
        let mut bone = Bone { name: String::new(), line: begin, ..self.root.clone() };
        bone.freedoms.clear();
        let (mut direction, mut length, mut has_axis) = (None, None, false);
        loop {
            let Some((line, row)) = rows.next() else {
                return Err(syntax(path, begin, "this bone has no end; is the file cut off?"));
            };
            let mut words = row.split_whitespace();
            match words.next().unwrap_or_default() {
                "end" => break,
                "name" => words.next().unwrap_or_default().clone_into(&mut bone.name),
                "direction" => direction = Some(vec3(path, line, &mut words, "direction")?),
                "length" => {
                    length = Some(number(path, line, words.next().unwrap_or_default(), "bone length")?);
                }
                "axis" => {
                    let angles = vec3(path, line, &mut words, "axis")?;
                    bone.axis = euler(path, line, words.next().unwrap_or("XYZ"), self.radians(angles))?;
                    has_axis = true;
                }
                "dof" => bone.freedoms = freedoms(path, line, words)?,
                keyword if keyword.starts_with(':') || keyword == "begin" => {
                    return Err(syntax(
                        path,
                        line,
                        format!("{} inside the bone of line {begin}", shown(keyword)),
                    ));
                }
                // id, limits, bodymass, cofmass: nothing we need.
                _ => {}
            }
        }
        let (Some(direction), Some(length), true) = (direction, length, has_axis && !bone.name.is_empty())
        else {
            return Err(syntax(path, begin, "a bone needs a name, a direction, a length and an axis"));
        };
        if self.bones.iter().any(|other| other.name == bone.name) || bone.name == "root" {
            return Err(syntax(path, begin, format!("bone name {} twice", shown(&bone.name))));
        }
        bone.vector = direction.normalize_or_zero() * length;
        self.bones.push(bone);
        Ok(())
    }

    fn link(&mut self, line: usize, row: &'a str) {
        let mut words = row.split_whitespace();
        if let Some(parent) = words.next().filter(|&word| word != "begin" && word != "end") {
            self.links.extend(words.map(|child| (parent, child, line)));
        }
    }

    /// Puts parents before children, which also finds cycles and loose bones.
    fn finish(self) -> Result<Skeleton, Error> {
        let path = self.path;
        let index: HashMap<&str, usize> =
            self.bones.iter().enumerate().map(|(i, bone)| (bone.name.as_str(), i)).collect();
        let mut parent_of: Vec<Option<&str>> = vec![None; self.bones.len()];
        for &(parent, child, line) in &self.links {
            if parent != "root" && !index.contains_key(parent) {
                return Err(syntax(path, line, format!("no bone is named {}", shown(parent))));
            }
            let Some(&child_index) = index.get(child) else {
                return Err(syntax(path, line, format!("no bone is named {}", shown(child))));
            };
            if let Some(first) = parent_of[child_index].replace(parent) {
                let message =
                    format!("bone {} hangs on {} and on {}", shown(child), shown(first), shown(parent));
                return Err(syntax(path, line, message));
            }
        }
        let mut root = self.root.clone();
        root.axis = euler(path, root.line, &self.root_order, self.radians(self.orientation))?;
        let mut bones = vec![root];
        // Breadth first from the root; what is never reached is loose or part of a cycle.
        let mut placed = 0;
        let mut waiting: Vec<usize> = (0..self.bones.len()).collect();
        while placed < bones.len() {
            waiting.retain(|&candidate| {
                let ours = parent_of[candidate].is_some_and(|parent| parent == bones[placed].name);
                if ours {
                    bones.push(Bone { parent: placed, ..self.bones[candidate].clone() });
                }
                !ours
            });
            placed += 1;
        }
        if let Some(&loose) = waiting.first() {
            let bone = &self.bones[loose];
            let message = format!(
                "bone {} is not connected to the root (:hierarchy does not name it, or runs in a cycle)",
                shown(&bone.name)
            );
            return Err(syntax(path, bone.line, message));
        }
        let metres_per_unit = 0.0254 / self.length;
        Ok(Skeleton { bones, position: self.position, metres_per_unit, degrees: self.degrees })
    }
}
