//! Biovision hierarchy (BVH): a skeleton of offsets and one line of channel values per frame.
//!
//! Read with any channel order, a rotation order per joint, position channels at any joint (they replace the
//! OFFSET, component by component), End Sites and several roots. Units and up axis are not in the format and
//! are inferred. Rotations are in degrees and apply in the order listed: `Z X Y` means `Rz Rx Ry`.

use super::joint_map::{self, Sources};
use super::repair::{Unit, finish, rate_stated};
use super::text::{count, number, shown, syntax};
use super::{MAX_FRAMES, MAX_JOINTS, Options, of_file, stem};
use crate::gait::{Error, Pose, Recording};
use glam::{Quat, Vec3};

/// Fewest channels of a skeleton. (Also what keeps the frames in proportion to the text.)
const LEAST_CHANNELS: usize = 12;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Channel {
    Position(usize),
    Rotation(usize),
}

#[derive(Debug)]
struct Node {
    name: String,
    /// Index of the parent, which always stands before its children.
    parent: Option<usize>,
    offset: Vec3,
    channels: Vec<Channel>,
}

/// Words of the file with their line numbers.
struct Words<'a> {
    path: &'a str,
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    words: std::str::SplitWhitespace<'a>,
    line: usize,
}

impl<'a> Words<'a> {
    fn next(&mut self) -> Option<&'a str> {
        loop {
            if let Some(word) = self.words.next() {
                return Some(word);
            }
            let (index, line) = self.lines.next()?;
            self.line = index + 1;
            self.words = line.split_whitespace();
        }
    }

    fn error(&self, message: impl Into<String>) -> Error {
        syntax(self.path, self.line, message)
    }

    fn need(&mut self, what: &str) -> Result<&'a str, Error> {
        self.next().ok_or_else(|| self.error(format!("the file ends where {what} was expected")))
    }

    fn need_number(&mut self, what: &str) -> Result<f32, Error> {
        let word = self.need(what)?;
        number(self.path, self.line, word, what)
    }

    fn need_word(&mut self, wanted: &str) -> Result<(), Error> {
        let word = self.need(wanted)?;
        if word.eq_ignore_ascii_case(wanted) {
            Ok(())
        } else {
            Err(self.error(format!("found {}; expected {wanted}", shown(word))))
        }
    }

    /// A name up to the opening brace; names may hold spaces.
    fn need_name(&mut self) -> Result<String, Error> {
        let mut name = self.need("a joint name")?.to_owned();
        while !name.ends_with('{') {
            match self.need("\"{\"")? {
                "{" => return Ok(name),
                word => {
                    name.push(' ');
                    name.push_str(word);
                }
            }
            if name.len() > 256 {
                return Err(self.error(format!("joint name {} has no \"{{\" after it", shown(&name))));
            }
        }
        name.pop();
        Ok(name.trim_end().to_owned())
    }
}

/// Parses a BVH file. `path` names it in messages.
///
/// # Errors
/// [`Error::Syntax`] with the line of the first fault; [`Error::Unusable`] if the motion is not that of a body.
pub fn parse_bvh(text: &str, path: &str, options: &Options) -> Result<Recording, Error> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut words = Words { path, lines: text.lines().enumerate(), words: "".split_whitespace(), line: 0 };
    let nodes = hierarchy(&mut words)?;
    let names: Vec<&str> = nodes.iter().map(|node| node.name.as_str()).collect();
    let (rig, joints) =
        joint_map::choose(options.joint_map.as_ref(), &names).map_err(|message| syntax(path, 0, message))?;
    let ((rate, rate_line), poses) = motion(&mut words, &nodes, &joints, options)?;
    let report = vec![
        format!("BVH: {} joints, {} frames", nodes.len(), poses.len()),
        rate_line,
        format!("joint map: {rig}"),
    ];
    let provenance = of_file(path, "BVH");
    let missing = joints.missing();
    let take = Recording { provenance, report, missing, ..Recording::new(stem(path), rate, poses) };
    finish(take, Unit::Unstated, options)
}

fn hierarchy(words: &mut Words<'_>) -> Result<Vec<Node>, Error> {
    words.need_word("HIERARCHY")?;
    let mut nodes: Vec<Node> = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    loop {
        let word = words.need("ROOT, JOINT, \"}\" or MOTION")?;
        let parent = open.last().copied();
        match word.to_ascii_uppercase().as_str() {
            "MOTION" if open.is_empty() && !nodes.is_empty() => return Ok(nodes),
            "MOTION" if nodes.is_empty() => return Err(words.error("MOTION before any ROOT")),
            "ROOT" if open.is_empty() => begin(words, &mut nodes, &mut open, None)?,
            "JOINT" if parent.is_some() => begin(words, &mut nodes, &mut open, parent)?,
            "END" if parent.is_some() => {
                words.need_word("Site")?;
                words.need_word("{")?;
                let name = parent.map_or_else(String::new, |p| format!("{}_end", nodes[p].name));
                push(
                    words,
                    &mut nodes,
                    &mut open,
                    Node { name, parent, offset: Vec3::ZERO, channels: vec![] },
                )?;
            }
            "OFFSET" if parent.is_some() => {
                let offset = Vec3::new(
                    words.need_number("OFFSET x")?,
                    words.need_number("OFFSET y")?,
                    words.need_number("OFFSET z")?,
                );
                if let Some(node) = parent.and_then(|p| nodes.get_mut(p)) {
                    node.offset = offset;
                }
            }
            "CHANNELS" if parent.is_some() => {
                let channels = channels(words)?;
                match parent.and_then(|p| nodes.get_mut(p)) {
                    Some(node) if node.channels.is_empty() => node.channels = channels,
                    _ => return Err(words.error("a second CHANNELS for the same joint")),
                }
            }
            "}" if parent.is_some() => {
                open.pop();
            }
            _ => {
                let inside = parent.map_or("outside any joint".to_owned(), |p| {
                    format!("inside joint {}", shown(&nodes[p].name))
                });
                return Err(words.error(format!("{} does not belong {inside}", shown(word))));
            }
        }
    }
}

fn begin(
    words: &mut Words<'_>,
    nodes: &mut Vec<Node>,
    open: &mut Vec<usize>,
    parent: Option<usize>,
) -> Result<(), Error> {
    let name = words.need_name()?;
    push(words, nodes, open, Node { name, parent, offset: Vec3::ZERO, channels: vec![] })
}

fn push(words: &Words<'_>, nodes: &mut Vec<Node>, open: &mut Vec<usize>, node: Node) -> Result<(), Error> {
    if nodes.len() == MAX_JOINTS {
        return Err(words.error(format!("more than {MAX_JOINTS} joints")));
    }
    open.push(nodes.len());
    nodes.push(node);
    Ok(())
}

fn channels(words: &mut Words<'_>) -> Result<Vec<Channel>, Error> {
    let word = words.need("the number of channels")?;
    let channel_count = count(words.path, words.line, word, "the number of channels", 6)?;
    let mut channels = Vec::with_capacity(channel_count);
    for _ in 0..channel_count {
        let word = words.need("a channel name")?;
        let channel = match word.to_ascii_lowercase().as_str() {
            "xposition" => Channel::Position(0),
            "yposition" => Channel::Position(1),
            "zposition" => Channel::Position(2),
            "xrotation" => Channel::Rotation(0),
            "yrotation" => Channel::Rotation(1),
            "zrotation" => Channel::Rotation(2),
            _ => {
                let known = "Xposition, Yposition, Zposition, Xrotation, Yrotation, Zrotation";
                return Err(words.error(format!("unknown channel {}; known are {known}", shown(word))));
            }
        };
        if channels.contains(&channel) {
            return Err(words.error(format!("channel {word} twice for the same joint")));
        }
        channels.push(channel);
    }
    Ok(channels)
}

/// Reads the MOTION section: frame rate in Hz with its line for the report, and the poses in file units.
fn motion(
    words: &mut Words<'_>,
    nodes: &[Node],
    joints: &Sources,
    options: &Options,
) -> Result<((f32, String), Vec<Pose>), Error> {
    words.need_word("Frames:")?;
    let word = words.need("the number of frames")?;
    let frames = count(words.path, words.line, word, "Frames", MAX_FRAMES)?;
    words.need_word("Frame")?;
    words.need_word("Time:")?;
    let seconds = words.need_number("Frame Time")?;
    let rate = rate_stated(options, words.path, words.line, 1.0 / seconds)?;
    let channel_count: usize = nodes.iter().map(|node| node.channels.len()).sum();
    if channel_count < LEAST_CHANNELS {
        let message =
            format!("{channel_count} channels in all; a body that walks has at least {LEAST_CHANNELS}");
        return Err(words.error(message));
    }

    let mut values = vec![0.0_f32; channel_count];
    let mut world = vec![(Quat::IDENTITY, Vec3::ZERO); nodes.len()];
    let mut poses: Vec<Pose> = Vec::new();
    while let Some(first) = words.next() {
        if poses.len() == frames {
            return Err(words.error(format!("Frames says {frames}, but more lines follow")));
        }
        let line = words.line;
        let mut found = 0;
        // A frame is one line: whatever stands on it is counted before anything else is read.
        for word in std::iter::once(first).chain(words.words.by_ref()) {
            if let Some(value) = values.get_mut(found) {
                *value = number(words.path, line, word, "a channel value")?;
            }
            found += 1;
        }
        if found != channel_count {
            let frame = poses.len() + 1;
            let message = format!("frame {frame} has {found} values; the channels ask for {channel_count}");
            return Err(syntax(words.path, line, message));
        }
        place(nodes, &values, &mut world);
        poses.push(joints.pose(|node| world[node].1));
    }
    if poses.len() < frames {
        let message = format!("the file ends after {} of {frames} frames; is it cut off?", poses.len());
        return Err(words.error(message));
    }
    Ok((rate, poses))
}

/// Forward kinematics of one frame: rotation and position of each node in the world.
fn place(nodes: &[Node], values: &[f32], world: &mut [(Quat, Vec3)]) {
    let mut values = values.iter().copied();
    for (index, node) in nodes.iter().enumerate() {
        let mut translation = node.offset;
        let mut rotation = Quat::IDENTITY;
        for channel in &node.channels {
            let value = values.next().unwrap_or(0.0);
            match *channel {
                Channel::Position(axis) => translation[axis] = value,
                Channel::Rotation(axis) => {
                    rotation *= Quat::from_axis_angle(Vec3::AXES[axis], value.to_radians());
                }
            }
        }
        let (parent_rotation, parent_position) =
            node.parent.and_then(|p| world.get(p).copied()).unwrap_or((Quat::IDENTITY, Vec3::ZERO));
        world[index] =
            ((parent_rotation * rotation).normalize(), parent_position + parent_rotation * translation);
    }
}
