//! The last resort for a rig without preset: common words for the parts of the body.

use crate::gait::JOINT_COUNT;

/// Words for the middle joints in order of preference.
const MIDDLE_WORDS: [&[&str]; 4] = [
    &["hips", "pelvis", "hip", "root", "lowertorso"],
    &[
        "spine1",
        "chest2",
        "spine02",
        "spine",
        "chest",
        "upperback",
        "spine01",
        "torso",
        "abdomen",
        "thorax",
        "back",
    ],
    &["neck", "lowerneck", "neck1", "neck01", "neckbase"],
    &["head", "skull", "head1"],
];

/// Words for the joints of one side in order of preference: shoulder, elbow, hand, hip, knee, foot.
const SIDE_WORDS: [&[&str]; 6] = [
    &["upperarm", "uparm", "humerus", "arm", "shoulder", "shldr"],
    &["elbow", "forearm", "lowerarm", "lowarm", "radius", "farm"],
    &["hand", "wrist"],
    &["upleg", "upperleg", "thigh", "femur", "hip", "leg"],
    &["knee", "lowerleg", "lowleg", "calf", "shin", "tibia", "leg"],
    &["ankle", "foot"],
];

/// Index into `names` of each of the 16 joints, as far as the words tell.
pub(super) fn by_words<S: AsRef<str>>(names: &[S]) -> [Option<usize>; JOINT_COUNT] {
    let parts: Vec<(Side, String)> = names.iter().map(|name| part_of(name.as_ref())).collect();
    let pick = |side: Side, words: &[&str], taken: Option<usize>| {
        words.iter().find_map(|word| {
            parts.iter().enumerate().position(|(i, (s, part))| *s == side && part == word && Some(i) != taken)
        })
    };
    let mut found = [None; JOINT_COUNT];
    for (joint, words) in MIDDLE_WORDS.iter().enumerate() {
        found[joint] = pick(Side::Middle, words, None);
    }
    for (side, arm, leg) in [(Side::Left, 4, 10), (Side::Right, 7, 13)] {
        for (part, words) in SIDE_WORDS.iter().enumerate() {
            let joint = if part < 3 { arm + part } else { leg + part - 3 };
            // "leg" is the knee of one rig and the hip of another: never both.
            let taken = if part == 4 { found[leg] } else { None };
            found[joint] = pick(side, words, taken);
        }
    }
    found
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Left,
    Right,
    Middle,
}

/// Side of the body and the rest of a name, such as (left, "upperarm") of `J_Bip_L_UpperArm`.
fn part_of(name: &str) -> (Side, String) {
    let name = name.rsplit(':').next().unwrap_or(name);
    let mut words: Vec<String> = vec![String::new()];
    let mut previous = ' ';
    for c in name.chars() {
        let starts = c.is_ascii_uppercase() && !previous.is_ascii_uppercase();
        if (starts || !c.is_ascii_alphanumeric()) && words.last().is_some_and(|word| !word.is_empty()) {
            words.push(String::new());
        }
        if c.is_ascii_alphanumeric()
            && let Some(word) = words.last_mut()
        {
            word.push(c.to_ascii_lowercase());
        }
        previous = c;
    }
    let mut side = Side::Middle;
    words.retain(|word| match word.as_str() {
        "l" | "left" => {
            side = Side::Left;
            false
        }
        "r" | "right" => {
            side = Side::Right;
            false
        }
        "mixamorig" | "bip" | "bip01" | "bip001" | "j" | "c" | "joint" | "def" | "org" | "bn" | "b"
        | "jnt" | "" => false,
        _ => true,
    });
    let part = words.concat();
    if side == Side::Middle {
        for (prefix, prefix_side) in
            [("left", Side::Left), ("right", Side::Right), ("l", Side::Left), ("r", Side::Right)]
        {
            if let Some(rest) = part.strip_prefix(prefix)
                && SIDE_WORDS.iter().any(|words| words.contains(&rest))
            {
                return (prefix_side, rest.to_owned());
            }
        }
    }
    (side, part)
}
