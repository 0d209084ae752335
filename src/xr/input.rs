//! Hands, sticks and buttons.

use super::error::{Error, call};
use super::joints::{Seen, Trackers};
use super::rig::Walk;
use super::runtime::Runtime;
use super::views::Pose;
use glam::Vec2;
use openxr as xr;

/// What was read in one frame; hands are in the room.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Reading {
    pub(super) walk: Walk,
    /// Where the left and the right one point, while they are tracked: controllers, or palms.
    pub(super) hands: [Option<Pose>; 2],
    /// How they are held, likewise.
    pub(super) grips: [Option<Pose>; 2],
    /// Hands that are seen.
    pub(super) seen: [Option<Seen>; 2],
    pub(super) answer: Buttons,
}

/// What answers a panel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Buttons {
    /// Whether the triggers of the left and the right hand are pulled.
    pub(super) triggers: [bool; 2],
    /// Left and right of the stick that is pushed farther, -1 to 1.
    pub(super) stick: f32,
    /// Whether the button A is pressed.
    pub(super) confirms: bool,
}

/// Which actions count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Active {
    /// Those that move the user.
    Walk,
    /// Those that answer a panel.
    Answer,
    /// None but the hands.
    Hands,
}

/// The actions, bound to whatever controllers the runtime has. All sets are attached, which is possible once a session. That of
/// the hands is always active, of the others one at a time.
pub(super) struct Input {
    hands: xr::ActionSet,
    walking: xr::ActionSet,
    answering: Answers,
    walk: xr::Action<xr::Vector2f>,
    turn: xr::Action<xr::Vector2f>,
    teleport: xr::Action<bool>,
    recentre: xr::Action<bool>,
    /// Of aiming and of holding; left and right.
    spaces: [[xr::Space; 2]; 2],
    trackers: Option<Trackers>,
}

/// The actions that answer a panel.
struct Answers {
    set: xr::ActionSet,
    /// Of the left and the right hand.
    hands: [xr::Path; 2],
    choose: xr::Action<bool>,
    step: xr::Action<xr::Vector2f>,
    confirm: xr::Action<bool>,
}

/// Which of our inputs a controller has, below `/user/hand/`.
#[derive(Debug, Clone, Copy)]
struct Bindings {
    /// Sticks or pads that walk and turn.
    sticks: Option<[&'static str; 2]>,
    teleport: &'static str,
    recentre: Option<&'static str>,
    /// What chooses what a hand points at, below `left/input/` and `right/input/`.
    trigger: &'static str,
    /// What chooses what a stick went to.
    confirms: &'static [&'static str],
}

/// Sticks on both controllers, and a button A on the right one.
const STICKS: Bindings = Bindings {
    sticks: Some(["left/input/thumbstick", "right/input/thumbstick"]),
    teleport: "right/input/a/click",
    recentre: Some("left/input/thumbstick/click"),
    trigger: "trigger/value",
    confirms: &["right/input/a/click", "left/input/x/click"],
};

/// Interaction profiles that every runtime knows.
const PROFILES: [(&str, Bindings); 5] = [
    ("oculus/touch_controller", STICKS),
    (
        "valve/index_controller",
        Bindings { confirms: &["right/input/a/click", "left/input/a/click"], ..STICKS },
    ),
    (
        "microsoft/motion_controller",
        Bindings {
            teleport: "right/input/trackpad/click",
            confirms: &["right/input/trackpad/click", "left/input/trackpad/click"],
            ..STICKS
        },
    ),
    (
        "htc/vive_controller",
        Bindings {
            sticks: Some(["left/input/trackpad", "right/input/trackpad"]),
            teleport: "right/input/trigger/click",
            recentre: Some("left/input/menu/click"),
            trigger: "trigger/click",
            confirms: &["right/input/trackpad/click", "left/input/trackpad/click"],
        },
    ),
    (
        "khr/simple_controller",
        Bindings {
            sticks: None,
            teleport: "right/input/select/click",
            recentre: Some("left/input/menu/click"),
            trigger: "select/click",
            confirms: &[],
        },
    ),
];

/// Interaction profiles that runtimes know with an extension: PICO's controllers, those of the VIVE Focus 3, those of the
/// Reverb G2, and bare hands.
const PICO: [(&str, Bindings); 2] =
    [("bytedance/pico4_controller", STICKS), ("bytedance/pico_neo3_controller", STICKS)];
const FOCUS: [(&str, Bindings); 1] = [("htc/vive_focus3_controller", STICKS)];
const REVERB: [(&str, Bindings); 1] = [("hp/mixed_reality_controller", STICKS)];
/// A hand that pinches, or whatever else the runtime takes for choosing what it points at, teleports and answers. Nothing else
/// is bound: hands do much by chance.
const HANDS: [(&str, Bindings); 1] = [(
    "ext/hand_interaction_ext",
    Bindings {
        sticks: None,
        teleport: "right/input/aim_activate_ext/value",
        recentre: None,
        trigger: "aim_activate_ext/value",
        confirms: &[],
    },
)];

/// The extensions with which runtimes know more profiles.
pub(super) fn ask_for_profiles(useful: &mut xr::ExtensionSet) {
    useful.bd_controller_interaction = true;
    useful.htc_vive_focus3_controller_interaction = true;
    useful.ext_hp_mixed_reality_controller = true;
    useful.ext_hand_interaction = true;
}

/// The profiles that a runtime with these extensions knows.
fn profiles(known: &xr::ExtensionSet) -> Vec<(&'static str, Bindings)> {
    let mut found = PROFILES.to_vec();
    let mut extend = |is_known: bool, more: &[(&'static str, Bindings)]| {
        found.extend(more.iter().filter(|_| is_known));
    };
    extend(known.bd_controller_interaction, &PICO);
    extend(known.htc_vive_focus3_controller_interaction, &FOCUS);
    extend(known.ext_hp_mixed_reality_controller, &REVERB);
    extend(known.ext_hand_interaction, &HANDS);
    found
}

impl Input {
    /// Makes the actions and hands them to the session; once per session.
    pub(super) fn new(runtime: &Runtime, session: &xr::Session<xr::Vulkan>) -> Result<Self, Error> {
        let Runtime { instance, system, .. } = runtime;
        let path = |text: &str| instance.string_to_path(text).map_err(call("xrStringToPath"));
        let set = |name: &str, title: &str| {
            instance.create_action_set(name, title, 0).map_err(call("xrCreateActionSet"))
        };
        let (of_hands, walking) = (set("hands", "Hands")?, set("walk", "Walking through the crowd")?);
        let hands = [path("/user/hand/left")?, path("/user/hand/right")?];
        let walk = walking.create_action("move", "Walk", &[]).map_err(call("xrCreateAction"))?;
        let turn = walking.create_action("turn", "Turn", &[]).map_err(call("xrCreateAction"))?;
        let teleport = walking.create_action("teleport", "Teleport", &[]).map_err(call("xrCreateAction"))?;
        let recentre =
            walking.create_action("recentre", "Back to the start", &[]).map_err(call("xrCreateAction"))?;
        let aim: xr::Action<xr::Posef> =
            of_hands.create_action("aim", "Point", &hands).map_err(call("xrCreateAction"))?;
        let grip: xr::Action<xr::Posef> =
            of_hands.create_action("grip", "Hold", &hands).map_err(call("xrCreateAction"))?;
        let answering = Answers::new(set("answer", "Answering")?, hands)?;
        for (profile, named) in profiles(&runtime.extensions) {
            let Bindings { sticks, teleport: teleports, recentre: recentres, .. } = named;
            let mut bindings = Vec::new();
            let hand = |rest: &str| path(&format!("/user/hand/{rest}"));
            if let Some([walks, turns]) = sticks {
                bindings.push(xr::Binding::new(&walk, hand(walks)?));
                bindings.push(xr::Binding::new(&turn, hand(turns)?));
            }
            bindings.push(xr::Binding::new(&teleport, hand(teleports)?));
            if let Some(recentres) = recentres {
                bindings.push(xr::Binding::new(&recentre, hand(recentres)?));
            }
            bindings.push(xr::Binding::new(&aim, hand("left/input/aim/pose")?));
            bindings.push(xr::Binding::new(&aim, hand("right/input/aim/pose")?));
            bindings.push(xr::Binding::new(&grip, hand("left/input/grip/pose")?));
            bindings.push(xr::Binding::new(&grip, hand("right/input/grip/pose")?));
            answering.bind(&named, hand, &mut bindings)?;
            let profile = path(&format!("/interaction_profiles/{profile}"))?;
            // a runtime may not know a profile; the others still count
            let _ = instance.suggest_interaction_profile_bindings(profile, &bindings);
        }
        let sets = [&of_hands, &walking, &answering.set];
        session.attach_action_sets(&sets).map_err(call("xrAttachSessionActionSets"))?;
        let space = |action: &xr::Action<xr::Posef>, hand| {
            action.create_space(session, hand, xr::Posef::IDENTITY).map_err(call("xrCreateActionSpace"))
        };
        let both = |action| Ok::<_, Error>([space(action, hands[0])?, space(action, hands[1])?]);
        let spaces = [both(&aim)?, both(&grip)?];
        let trackers = Trackers::new(instance, *system, session)?;
        Ok(Self { hands: of_hands, walking, answering, walk, turn, teleport, recentre, spaces, trackers })
    }

    /// What hands and sticks do at `time`.
    pub(super) fn read(
        &self,
        session: &xr::Session<xr::Vulkan>,
        room: &xr::Space,
        time: xr::Time,
        active: Active,
    ) -> Result<Reading, Error> {
        let mut sets = vec![xr::ActiveActionSet::new(&self.hands)];
        match active {
            Active::Walk => sets.push(xr::ActiveActionSet::new(&self.walking)),
            Active::Answer => sets.push(xr::ActiveActionSet::new(&self.answering.set)),
            Active::Hands => {}
        }
        session.sync_actions(&sets).map_err(call("xrSyncActions"))?;
        let walk = if active == Active::Walk { self.walk(session)? } else { Walk::default() };
        let answer =
            if active == Active::Answer { self.answering.read(session)? } else { Buttons::default() };
        let mut poses = [[None; 2]; 2];
        for (hand, space) in poses.iter_mut().flatten().zip(self.spaces.iter().flatten()) {
            let found = space.locate(room, time).map_err(call("xrLocateSpace"))?;
            let known = xr::SpaceLocationFlags::ORIENTATION_VALID | xr::SpaceLocationFlags::POSITION_VALID;
            *hand = found.location_flags.contains(known).then(|| Pose::from_xr(found.pose)).flatten();
        }
        let [mut hands, grips] = poses;
        let seen = self.trackers.as_ref().map_or(Ok([None; 2]), |trackers| trackers.read(room, time))?;
        for (hand, seen) in hands.iter_mut().zip(&seen) {
            *hand = hand.or(seen.map(|seen| seen.palm));
        }
        Ok(Reading { walk, hands, grips, seen, answer })
    }

    /// What sticks and buttons say of walking.
    fn walk(&self, session: &xr::Session<xr::Vulkan>) -> Result<Walk, Error> {
        let recentre = button(session, &self.recentre, xr::Path::NULL)?;
        Ok(Walk {
            stick: stick(session, &self.walk, xr::Path::NULL)?,
            turn: stick(session, &self.turn, xr::Path::NULL)?.x,
            aims: button(session, &self.teleport, xr::Path::NULL)?.current_state,
            recentres: recentre.current_state && recentre.changed_since_last_sync,
        })
    }
}

impl Answers {
    fn new(set: xr::ActionSet, hands: [xr::Path; 2]) -> Result<Self, Error> {
        let choose = set.create_action("choose", "Choose", &hands).map_err(call("xrCreateAction"))?;
        let step = set.create_action("step", "To the next one", &hands).map_err(call("xrCreateAction"))?;
        let confirm = set.create_action("confirm", "Confirm", &[]).map_err(call("xrCreateAction"))?;
        Ok(Self { set, hands, choose, step, confirm })
    }

    /// Adds the bindings of a profile.
    fn bind<'a>(
        &'a self,
        named: &Bindings,
        hand: impl Fn(&str) -> Result<xr::Path, Error>,
        bindings: &mut Vec<xr::Binding<'a>>,
    ) -> Result<(), Error> {
        for side in ["left", "right"] {
            bindings.push(xr::Binding::new(&self.choose, hand(&format!("{side}/input/{}", named.trigger))?));
        }
        for stick in named.sticks.iter().flatten() {
            bindings.push(xr::Binding::new(&self.step, hand(stick)?));
        }
        for confirms in named.confirms {
            bindings.push(xr::Binding::new(&self.confirm, hand(confirms)?));
        }
        Ok(())
    }

    fn read(&self, session: &xr::Session<xr::Vulkan>) -> Result<Buttons, Error> {
        let [left, right] = self.hands;
        let pulled = |hand| Ok::<_, Error>(button(session, &self.choose, hand)?.current_state);
        let sticks = [stick(session, &self.step, left)?.x, stick(session, &self.step, right)?.x];
        let [one, other] = sticks;
        Ok(Buttons {
            triggers: [pulled(left)?, pulled(right)?],
            stick: if one.abs() > other.abs() { one } else { other },
            confirms: button(session, &self.confirm, xr::Path::NULL)?.current_state,
        })
    }
}

/// Where a stick is; at rest while it is not there.
fn stick(
    session: &xr::Session<xr::Vulkan>,
    action: &xr::Action<xr::Vector2f>,
    hand: xr::Path,
) -> Result<Vec2, Error> {
    let state = action.state(session, hand).map_err(call("xrGetActionStateVector2f"))?;
    let value = Vec2::new(state.current_state.x, state.current_state.y);
    Ok(if state.is_active && value.is_finite() { value } else { Vec2::ZERO })
}

fn button(
    session: &xr::Session<xr::Vulkan>,
    action: &xr::Action<bool>,
    hand: xr::Path,
) -> Result<xr::ActionState<bool>, Error> {
    action.state(session, hand).map_err(call("xrGetActionStateBoolean"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_profile_is_suggested_where_its_extension_is_there() {
        let names = |known: &xr::ExtensionSet| -> Vec<&str> {
            profiles(known).into_iter().map(|(name, _)| name).collect()
        };
        let core = names(&xr::ExtensionSet::default());
        assert_eq!(core, PROFILES.map(|(name, _)| name));
        type Choose = fn(&mut xr::ExtensionSet);
        let extensions: [(Choose, &[&str]); 4] = [
            (
                |known| known.bd_controller_interaction = true,
                &["bytedance/pico4_controller", "bytedance/pico_neo3_controller"],
            ),
            (|known| known.htc_vive_focus3_controller_interaction = true, &["htc/vive_focus3_controller"]),
            (|known| known.ext_hp_mixed_reality_controller = true, &["hp/mixed_reality_controller"]),
            (|known| known.ext_hand_interaction = true, &["ext/hand_interaction_ext"]),
        ];
        let mut all = xr::ExtensionSet::default();
        ask_for_profiles(&mut all);
        for (choose, more) in extensions {
            let mut known = xr::ExtensionSet::default();
            choose(&mut known);
            assert_eq!(names(&known)[core.len()..], *more);
            assert!(more.iter().all(|name| names(&all).contains(name)), "{more:?} is asked for");
        }
    }
}
