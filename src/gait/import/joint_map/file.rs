//! A joint map as a TOML file.

use super::super::text::{shown, syntax};
use super::{JointMap, places};
use crate::file;
use crate::gait::{Error, Joint};
use std::path::Path;
use toml::de::{DeTable, DeValue};

/// Largest joint map read, bytes.
const MAX_MAP_BYTES: u64 = 1 << 20;

impl JointMap {
    /// Reads a joint map from a TOML file.
    ///
    /// # Errors
    /// [`Error::Read`], or [`Error::Syntax`] with file and line.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let read = |source| Error::Read { path: path.to_owned(), source };
        Self::parse(&file::read_text(path, MAX_MAP_BYTES).map_err(read)?, &path.display().to_string())
    }

    /// A joint map from the text of a TOML file, which `origin` names in messages. The layout is in the documentation
    /// of this module.
    ///
    /// # Errors
    /// [`Error::Syntax`] with the line of what is not TOML, of an unknown key or of a value that is not a place; and
    /// for joints that are missing.
    pub fn parse(text: &str, origin: &str) -> Result<Self, Error> {
        let line_of = |offset: usize| 1 + text.bytes().take(offset).filter(|&byte| byte == b'\n').count();
        let document = DeTable::parse(text).map_err(|error| {
            let line = line_of(error.span().map_or(0, |span| span.start));
            syntax(origin, line, error.message().replace('\n', " "))
        })?;
        let mut rig = None;
        let mut base: Option<Self> = None;
        let mut names: [Option<Vec<(String, f32)>>; crate::gait::JOINT_COUNT] = Default::default();
        for (key, value) in document.get_ref() {
            let (key, line) = (key.get_ref().as_ref(), line_of(key.span().start));
            let DeValue::String(value) = value.get_ref() else {
                let message =
                    format!("{key} must be text, such as \"Hips\", \"LWRA + LWRB\" or \"0.6*a + 0.4*b\"");
                return Err(syntax(origin, line, message));
            };
            match key {
                "rig" => rig = Some(value.chars().take(200).collect::<String>()),
                "like" => {
                    base = Some(Self::named(value).ok_or_else(|| {
                        let known = Self::known().join(", ");
                        syntax(origin, line, format!("like: no rig {}; known are {known}", shown(value)))
                    })?);
                }
                _ => {
                    let Some(joint) = Joint::ALL.into_iter().find(|joint| joint.name() == key) else {
                        let known = Joint::ALL.map(Joint::name).join(", ");
                        let message = format!("unknown key {}; known are rig, like, {known}", shown(key));
                        return Err(syntax(origin, line, message));
                    };
                    let parts =
                        places(value).map_err(|message| syntax(origin, line, format!("{key}: {message}")))?;
                    names[joint as usize] = Some(parts);
                }
            }
        }
        let mut missing = Vec::new();
        let names = Joint::ALL.map(|joint| {
            let own = names[joint as usize].take();
            own.or_else(|| base.as_ref().map(|base| base.names[joint as usize].clone())).unwrap_or_else(
                || {
                    missing.push(joint.name());
                    Vec::new()
                },
            )
        });
        if !missing.is_empty() {
            let message =
                format!("joints not named: {}; name them, or say like = \"Mixamo\"", missing.join(", "));
            return Err(syntax(origin, 0, message));
        }
        let rig = rig.or_else(|| base.map(|base| base.rig)).unwrap_or_else(|| origin.to_owned());
        Ok(Self { rig, names })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_takes_the_rest_from_a_known_rig() {
        let text = "rig = \"mine\"\nlike = \"mixamo\"\nhead = \"Skull\"\nleft_hand = \"LWRA + LWRB\"\n\
                    spine = \"0.6*Pelvis + 0.4*Sternum\"\n";
        let map = JointMap::parse(text, "map.toml").unwrap();
        assert_eq!(map.rig, "mine");
        assert_eq!(map.names[Joint::Head as usize], [("Skull".to_owned(), 1.0)]);
        assert_eq!(map.names[Joint::LeftHand as usize], [("LWRA".to_owned(), 0.5), ("LWRB".to_owned(), 0.5)]);
        assert_eq!(map.names[Joint::Spine as usize][1], ("Sternum".to_owned(), 0.4));
        assert_eq!(map.names[Joint::LeftKnee as usize][0].0, "leftleg");
    }

    #[test]
    fn faults_of_a_map_are_named_with_their_line() {
        for (text, line, expected) in [
            ("rig = \"x\"\nheads = \"Head\"\n", 2, "unknown key \"heads\""),
            ("like = \"mixamo\"\n\nhead = 3\n", 3, "head must be text"),
            ("like = \"Mixmo\"\n", 1, "CMU BVH"),
            ("rig = \"x\"\nhead", 2, ""),
            ("like = \"mixamo\"\nhead = \"0.6*a + 0.6*b\"", 2, "add up to 1.2"),
            ("like = \"mixamo\"\nhead = \"x*a + 0.6*b\"", 2, "weight \"x\""),
            ("like = \"mixamo\"\nhead = \"a + \"", 2, "empty name"),
            ("like = \"mixamo\"\nhead = \"NaN*a + 1*b\"", 2, "weight \"NaN\""),
            ("head = \"Head\"", 0, "left_knee"),
        ] {
            let message = JointMap::parse(text, "map.toml").unwrap_err().to_string();
            assert!(message.starts_with(&format!("map.toml:{line}: ")), "{message}");
            assert!(message.contains(expected), "{message} should say {expected}");
        }
    }
}
