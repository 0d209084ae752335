//! Points that the cameras lost: short gaps are bridged, and of the rest the longest whole stretch is taken.

use super::{Frames, Way};
use crate::gait::Pose;
use glam::Vec3;

/// Longest gap that is bridged by a straight line, s.
const BRIDGED_S: f32 = 0.2;

/// The poses of one subject in file units, from its longest stretch with all points; and a line for the report.
pub(super) fn poses(frames: &Frames<'_>, way: &Way, rate: f32) -> Result<(Vec<Pose>, String), String> {
    let used = way.used();
    let longest_gap = crate::gait::stride::frames(BRIDGED_S * rate).max(1);
    // The last sighting of each point, to begin bridges from; a frame's points are whole once each is seen again.
    let mut tracks: Vec<Track> = Vec::with_capacity(used.len());
    let mut whole = vec![true; frames.count];
    for &point in &used {
        let track = Track::of(frames, point, longest_gap);
        for gap in &track.gaps {
            whole.get_mut(gap.clone()).into_iter().flatten().for_each(|frame| *frame = false);
        }
        tracks.push(track);
    }
    let (first, count) = longest_run(&whole);
    if count == 0 {
        return Err(format!("no frame has all {} points that are needed", used.len()));
    }
    let bridged: usize = tracks.iter().map(|track| track.bridged).sum();
    let mut points = vec![Vec3::ZERO; used.last().map_or(0, |last| last + 1)];
    let mut poses = Vec::with_capacity(count);
    for frame in first..first + count {
        for (track, &point) in tracks.iter_mut().zip(&used) {
            points[point] = track.at(frames, point, frame);
        }
        poses.push(way.pose(|point| points[point]));
    }
    let mut line = match bridged {
        0 => "gaps: none".to_owned(),
        _ => format!("gaps: {bridged} positions bridged, each gap up to {BRIDGED_S} s"),
    };
    if count < frames.count {
        line += &format!(
            "; frames {} to {} of {} taken, where no point is lost for longer",
            first + 1,
            first + count,
            frames.count
        );
    }
    Ok((poses, line))
}

/// Where one point is lost.
struct Track {
    /// Gaps too long to bridge, and the ends of the take where the point was never seen.
    gaps: Vec<std::ops::Range<usize>>,
    /// Frames bridged.
    bridged: usize,
    /// The bridge in use: its first and last frame are sightings.
    bridge: Option<(usize, Vec3, usize, Vec3)>,
}

impl Track {
    fn of(frames: &Frames<'_>, point: usize, longest: usize) -> Self {
        let (mut gaps, mut bridged, mut last) = (Vec::new(), 0, None);
        for frame in 0..frames.count {
            if frames.point(frame, point).is_none() {
                continue;
            }
            let begin = last.map_or(0, |last: usize| last + 1);
            if frame > begin {
                if last.is_some() && frame - begin <= longest {
                    bridged += frame - begin;
                } else {
                    gaps.push(begin..frame);
                }
            }
            last = Some(frame);
        }
        let begin = last.map_or(0, |last| last + 1);
        if begin < frames.count {
            gaps.push(begin..frames.count);
        }
        Self { gaps, bridged, bridge: None }
    }

    /// The point at a frame; frames must come in order.
    fn at(&mut self, frames: &Frames<'_>, point: usize, frame: usize) -> Vec3 {
        if let Some(seen) = frames.point(frame, point) {
            return seen;
        }
        if self.bridge.is_none_or(|(_, _, end, _)| end < frame) {
            let before = (0..frame).rev().find_map(|f| frames.point(f, point).map(|seen| (f, seen)));
            let after = (frame..frames.count).find_map(|f| frames.point(f, point).map(|seen| (f, seen)));
            self.bridge = before.zip(after).map(|((a, from), (b, to))| (a, from, b, to));
        }
        self.bridge.map_or(Vec3::ZERO, |(a, from, b, to)| from.lerp(to, (frame - a) as f32 / (b - a) as f32))
    }
}

/// First frame and length of the longest run; of equal ones the first.
fn longest_run(whole: &[bool]) -> (usize, usize) {
    let (mut best, mut begin) = ((0, 0), 0);
    for (frame, &is_whole) in whole.iter().enumerate() {
        if !is_whole {
            begin = frame + 1;
        } else if frame + 1 - begin > best.1 {
            best = (begin, frame + 1 - begin);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_run_is_found() {
        let whole = |text: &str| text.chars().map(|c| c == '1').collect::<Vec<_>>();
        assert_eq!(longest_run(&whole("0110111011")), (4, 3));
        assert_eq!(longest_run(&whole("11011")), (0, 2));
        assert_eq!(longest_run(&whole("000")), (0, 0));
        assert_eq!(longest_run(&[]), (0, 0));
    }
}
