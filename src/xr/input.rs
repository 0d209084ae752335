//! Hands, sticks and buttons.

use super::error::{Error, call};
use super::joints::{Seen, Trackers};
use super::rig::Walk;
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

/// Interaction profile; then paths of walking stick, turning stick, teleport button, recentre button.
const PROFILES: [(&str, [&str; 4]); 5] = [
    (
        "oculus/touch_controller",
        [
            "left/input/thumbstick",
            "right/input/thumbstick",
            "right/input/a/click",
            "left/input/thumbstick/click",
        ],
    ),
    (
        "valve/index_controller",
        [
            "left/input/thumbstick",
            "right/input/thumbstick",
            "right/input/a/click",
            "left/input/thumbstick/click",
        ],
    ),
    (
        "microsoft/motion_controller",
        [
            "left/input/thumbstick",
            "right/input/thumbstick",
            "right/input/trackpad/click",
            "left/input/thumbstick/click",
        ],
    ),
    (
        "htc/vive_controller",
        ["left/input/trackpad", "right/input/trackpad", "right/input/trigger/click", "left/input/menu/click"],
    ),
    ("khr/simple_controller", ["", "", "right/input/select/click", "left/input/menu/click"]),
];

impl Input {
    /// Makes the actions and hands them to the session; once per session.
    pub(super) fn new(
        instance: &xr::Instance,
        system: xr::SystemId,
        session: &xr::Session<xr::Vulkan>,
    ) -> Result<Self, Error> {
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
        for (profile, [walks, turns, teleports, recentres]) in PROFILES {
            let mut bindings = Vec::new();
            let hand = |rest: &str| path(&format!("/user/hand/{rest}"));
            if !walks.is_empty() {
                bindings.push(xr::Binding::new(&walk, hand(walks)?));
                bindings.push(xr::Binding::new(&turn, hand(turns)?));
            }
            bindings.push(xr::Binding::new(&teleport, hand(teleports)?));
            bindings.push(xr::Binding::new(&recentre, hand(recentres)?));
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
        let trackers = Trackers::new(instance, system, session)?;
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
