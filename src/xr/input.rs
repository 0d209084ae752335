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
}

/// The actions, bound to whatever controllers the runtime has.
pub(super) struct Input {
    set: xr::ActionSet,
    walk: xr::Action<xr::Vector2f>,
    turn: xr::Action<xr::Vector2f>,
    teleport: xr::Action<bool>,
    recentre: xr::Action<bool>,
    /// Of aiming and of holding; left and right.
    spaces: [[xr::Space; 2]; 2],
    trackers: Option<Trackers>,
}

/// Which of our inputs a controller has, below `/user/hand/`.
#[derive(Debug, Clone, Copy)]
struct Bindings {
    /// Sticks or pads that walk and turn.
    sticks: Option<[&'static str; 2]>,
    teleport: &'static str,
    recentre: Option<&'static str>,
}

/// Sticks on both controllers, and a button A on the right one.
const STICKS: Bindings = Bindings {
    sticks: Some(["left/input/thumbstick", "right/input/thumbstick"]),
    teleport: "right/input/a/click",
    recentre: Some("left/input/thumbstick/click"),
};

/// Interaction profiles that every runtime knows.
const PROFILES: [(&str, Bindings); 5] = [
    ("oculus/touch_controller", STICKS),
    ("valve/index_controller", STICKS),
    ("microsoft/motion_controller", Bindings { teleport: "right/input/trackpad/click", ..STICKS }),
    (
        "htc/vive_controller",
        Bindings {
            sticks: Some(["left/input/trackpad", "right/input/trackpad"]),
            teleport: "right/input/trigger/click",
            recentre: Some("left/input/menu/click"),
        },
    ),
    (
        "khr/simple_controller",
        Bindings {
            sticks: None,
            teleport: "right/input/select/click",
            recentre: Some("left/input/menu/click"),
        },
    ),
];

/// Interaction profiles that runtimes know with an extension: PICO's controllers, those of the VIVE Focus 3, those of the
/// Reverb G2, and bare hands.
const PICO: [(&str, Bindings); 2] =
    [("bytedance/pico4_controller", STICKS), ("bytedance/pico_neo3_controller", STICKS)];
const FOCUS: [(&str, Bindings); 1] = [("htc/vive_focus3_controller", STICKS)];
const REVERB: [(&str, Bindings); 1] = [("hp/mixed_reality_controller", STICKS)];
/// A hand that pinches, or whatever else the runtime takes for choosing what it points at, teleports. Nothing else is bound:
/// hands do much by chance.
const HANDS: [(&str, Bindings); 1] = [(
    "ext/hand_interaction_ext",
    Bindings { sticks: None, teleport: "right/input/aim_activate_ext/value", recentre: None },
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
        let set = instance
            .create_action_set("walk", "Walking through the crowd", 0)
            .map_err(call("xrCreateActionSet"))?;
        let hands = [path("/user/hand/left")?, path("/user/hand/right")?];
        let walk = set.create_action("move", "Walk", &[]).map_err(call("xrCreateAction"))?;
        let turn = set.create_action("turn", "Turn", &[]).map_err(call("xrCreateAction"))?;
        let teleport = set.create_action("teleport", "Teleport", &[]).map_err(call("xrCreateAction"))?;
        let recentre =
            set.create_action("recentre", "Back to the start", &[]).map_err(call("xrCreateAction"))?;
        let aim: xr::Action<xr::Posef> =
            set.create_action("aim", "Point", &hands).map_err(call("xrCreateAction"))?;
        let grip: xr::Action<xr::Posef> =
            set.create_action("grip", "Hold", &hands).map_err(call("xrCreateAction"))?;
        for (profile, Bindings { sticks, teleport: teleports, recentre: recentres }) in
            profiles(&runtime.extensions)
        {
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
            let profile = path(&format!("/interaction_profiles/{profile}"))?;
            // a runtime may not know a profile; the others still count
            let _ = instance.suggest_interaction_profile_bindings(profile, &bindings);
        }
        session.attach_action_sets(&[&set]).map_err(call("xrAttachSessionActionSets"))?;
        let space = |action: &xr::Action<xr::Posef>, hand| {
            action.create_space(session, hand, xr::Posef::IDENTITY).map_err(call("xrCreateActionSpace"))
        };
        let both = |action| Ok::<_, Error>([space(action, hands[0])?, space(action, hands[1])?]);
        let spaces = [both(&aim)?, both(&grip)?];
        let trackers = Trackers::new(instance, *system, session)?;
        Ok(Self { set, walk, turn, teleport, recentre, spaces, trackers })
    }

    /// What hands and sticks do at `time`.
    pub(super) fn read(
        &self,
        session: &xr::Session<xr::Vulkan>,
        room: &xr::Space,
        time: xr::Time,
    ) -> Result<Reading, Error> {
        session.sync_actions(&[xr::ActiveActionSet::new(&self.set)]).map_err(call("xrSyncActions"))?;
        let stick = |action: &xr::Action<xr::Vector2f>| {
            let state = action.state(session, xr::Path::NULL).map_err(call("xrGetActionStateVector2f"))?;
            let value = Vec2::new(state.current_state.x, state.current_state.y);
            Ok::<_, Error>(if state.is_active && value.is_finite() { value } else { Vec2::ZERO })
        };
        let button = |action: &xr::Action<bool>| {
            action.state(session, xr::Path::NULL).map_err(call("xrGetActionStateBoolean"))
        };
        let recentre = button(&self.recentre)?;
        let walk = Walk {
            stick: stick(&self.walk)?,
            turn: stick(&self.turn)?.x,
            aims: button(&self.teleport)?.current_state,
            recentres: recentre.current_state && recentre.changed_since_last_sync,
        };
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
        Ok(Reading { walk, hands, grips, seen })
    }
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
