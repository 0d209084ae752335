//! Points that the cameras lost: short gaps are bridged by cubics, and of the rest the longest whole stretch is taken.

use super::points::{Sightings, Way};
use crate::gait::Pose;
use glam::Vec3;

/// Longest gap that is bridged, s.
const BRIDGED_S: f32 = 0.2;
/// The speed at either end of a bridge is taken over this many frames; over one, noise would swing the bridge.
const SLOPE_FRAMES: usize = 3;

/// The poses of one subject in file units, from its longest stretch with all points; and a line for the report.
pub(super) fn poses(frames: &impl Sightings, way: &Way, rate: f32) -> Result<(Vec<Pose>, String), String> {
    let used = way.used();
    let longest_gap = crate::gait::stride::frames(BRIDGED_S * rate).max(1);
    // The last sighting of each point, to begin bridges from; a frame's points are whole once each is seen again.
    let mut tracks: Vec<Track> = Vec::with_capacity(used.len());
    let mut whole = vec![true; frames.frames()];
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
    if count < frames.frames() {
        line += &format!(
            "; frames {} to {} of {} taken, where no point is lost for longer",
            first + 1,
            first + count,
            frames.frames()
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
    bridge: Option<Bridge>,
}

/// A cubic over a gap, from the last sighting before it to the first after it.
#[derive(Clone, Copy)]
struct Bridge {
    begin: usize,
    end: usize,
    from: Vec3,
    to: Vec3,
    /// Movement over the length of the gap at the speed of either end.
    leaving: Vec3,
    arriving: Vec3,
}

impl Bridge {
    fn over(frames: &impl Sightings, point: usize, frame: usize) -> Option<Self> {
        let sighting = |f: usize| frames.point(f, point).map(|seen| (f, seen));
        let (begin, from) = (0..frame).rev().find_map(sighting)?;
        let (end, to) = (frame..frames.frames()).find_map(sighting)?;
        let length = (end - begin) as f32;
        let straight = to - from;
        let before = begin.checked_sub(SLOPE_FRAMES).and_then(sighting);
        let after = sighting(end + SLOPE_FRAMES).filter(|(f, _)| *f < frames.frames());
        let leaving = before.map_or(straight, |(f, seen)| (from - seen) * (length / (begin - f) as f32));
        let arriving = after.map_or(straight, |(f, seen)| (seen - to) * (length / (f - end) as f32));
        Some(Self { begin, end, from, to, leaving, arriving })
    }

    fn at(&self, frame: usize) -> Vec3 {
        let t = (frame - self.begin) as f32 / (self.end - self.begin) as f32;
        let rest = 1.0 - t;
        let along = self.from * (1.0 + 2.0 * t) * rest * rest + self.to * t * t * (3.0 - 2.0 * t);
        along + self.leaving * (t * rest * rest) - self.arriving * (t * t * rest)
    }
}

impl Track {
    fn of(frames: &impl Sightings, point: usize, longest: usize) -> Self {
        let (mut gaps, mut bridged, mut last) = (Vec::new(), 0, None);
        for frame in 0..frames.frames() {
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
        if begin < frames.frames() {
            gaps.push(begin..frames.frames());
        }
        Self { gaps, bridged, bridge: None }
    }

    /// The point at a frame; frames must come in order.
    fn at(&mut self, frames: &impl Sightings, point: usize, frame: usize) -> Vec3 {
        if let Some(seen) = frames.point(frame, point) {
            return seen;
        }
        if self.bridge.is_none_or(|bridge| bridge.end < frame) {
            self.bridge = Bridge::over(frames, point, frame);
        }
        self.bridge.map_or(Vec3::ZERO, |bridge| bridge.at(frame))
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
