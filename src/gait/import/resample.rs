//! Takes at another frame rate, so that what depends on the rate (speeds, jerks, A-23) can be compared.

use super::text::frame_rate;
use crate::gait::stride::{frames, low_pass, pose_at};
use crate::gait::{Error, JOINT_COUNT, Pose, Recording};
use glam::Vec3;

/// A take is given at most this many times its frames.
const MAX_GROWTH: f32 = 8.0;
/// Movements faster than this share of the new rate are taken out before frames are.
const CUTOFF_SHARE: f32 = 0.4;
/// Repetitions of a cycle around the one that is kept, so that filter and spline see what comes before and after.
const REPEATS: usize = 3;

impl Recording {
    /// The same motion at `hertz` frames per second: low-passed first if frames are taken out, then by splines.
    ///
    /// A cyclic recording keeps its duration, so that its rate is the nearest that gives whole frames. Leaves a line
    /// in the report.
    ///
    /// # Errors
    /// [`Error::Syntax`] for a rate outside 1 to 2000 Hz, [`Error::Unusable`] for one beyond 8 times the recording's.
    pub fn resampled(mut self, hertz: f32) -> Result<Self, Error> {
        let hertz = frame_rate(&self.name, 0, hertz)?;
        let rate = self.frame_rate;
        if hertz > MAX_GROWTH * rate {
            let message =
                format!("resampling {rate} Hz to {hertz} Hz; up to {} Hz is possible", MAX_GROWTH * rate);
            return Err(Error::Unusable { name: self.name, message });
        }
        let count = self.poses.len();
        if (hertz / rate - 1.0).abs() < 1e-4 || count < 2 {
            self.report.push(format!("resampling: none, {rate:.2} Hz as it was"));
            return Ok(self);
        }
        let mut poses = self.poses;
        if self.cyclic {
            poses = std::iter::repeat_n(&poses, REPEATS).flatten().copied().collect();
        }
        if hertz < rate {
            smooth(&mut poses, rate, CUTOFF_SHARE * hertz);
        }
        let (first, duration) = if self.cyclic { (count, count as f32) } else { (0, (count - 1) as f32) };
        let whole = duration / rate * hertz;
        // A millionth of a frame is rounding; a take of whole seconds keeps its last frame.
        let total = if self.cyclic { frames(whole.round()).max(2) } else { frames(whole + 1e-3) + 1 };
        let step = if self.cyclic { duration / total as f32 } else { rate / hertz };
        self.poses = (0..total).map(|i| pose_at(&poses, first as f32 + i as f32 * step)).collect();
        self.frame_rate = rate / step;
        self.report.push(format!("resampling: {rate:.2} Hz to {:.2} Hz, {total} frames", self.frame_rate));
        Ok(self)
    }
}

fn smooth(poses: &mut [Pose], rate: f32, cutoff: f32) {
    for joint in 0..JOINT_COUNT {
        let axes = [0, 1, 2].map(|axis| {
            let signal: Vec<f32> = poses.iter().map(|pose| pose[joint][axis]).collect();
            low_pass(&signal, rate, cutoff)
        });
        for (frame, pose) in poses.iter_mut().enumerate() {
            pose[joint] = Vec3::from_array(axes.each_ref().map(|axis| axis[frame]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::TAU;

    fn swing(hz: f32, rate: f32, count: usize) -> Recording {
        let pose =
            |i: usize| [Vec3::new((TAU * hz * i as f32 / rate).sin(), i as f32 / rate, 0.0); JOINT_COUNT];
        Recording::new("swing", rate, (0..count).map(pose).collect())
    }

    #[test]
    fn slow_movements_stay_where_they_are_in_time() {
        for (from, to) in [(120.0, 60.0), (100.0, 60.0), (30.0, 60.0), (60.0, 50.0)] {
            let take = swing(1.0, from, 401).resampled(to).unwrap();
            assert!((take.frame_rate - to).abs() < 1e-3);
            let seconds = 400.0 / from;
            assert!((take.poses.len() as f32 - 1.0 - seconds * to).abs() < 1.0, "{}", take.poses.len());
            for (i, pose) in take.poses.iter().enumerate() {
                let t = i as f32 / to;
                let off = (pose[3].x - (TAU * t).sin()).abs();
                let inside = t > 0.2 && t < seconds - 0.2;
                assert!(!inside || off < 0.004, "{from} to {to}: off by {off} at {t}");
                assert!(!inside || (pose[3].y - t).abs() < 2e-3, "{from} to {to}: {} at {t}", pose[3].y);
            }
        }
    }

    #[test]
    fn what_the_new_rate_cannot_carry_is_taken_out() {
        let take = swing(50.0, 240.0, 960).resampled(60.0).unwrap();
        let largest = take.poses[30..200].iter().map(|pose| pose[0].x.abs()).fold(0.0, f32::max);
        assert!(largest < 0.08, "a 50 Hz shake shows as {largest} at 60 Hz");
    }

    #[test]
    fn a_cycle_keeps_its_duration_and_stays_closed() {
        let mut take = swing(1.0, 30.0, 30);
        for pose in &mut take.poses {
            pose.iter_mut().for_each(|point| point.y = 0.0);
        }
        take.cyclic = true;
        let take = take.resampled(60.0).unwrap();
        assert_eq!(take.poses.len(), 60);
        for (i, pose) in take.poses.iter().enumerate() {
            assert!((pose[0].x - (TAU * i as f32 / 60.0).sin()).abs() < 0.004, "{i}");
        }
    }

    #[test]
    fn rates_out_of_reach_are_refused() {
        assert!(swing(1.0, 30.0, 30).resampled(0.5).unwrap_err().to_string().contains("1 to 2000"));
        assert!(swing(1.0, 30.0, 30).resampled(500.0).unwrap_err().to_string().contains("240"));
        assert!(swing(1.0, 30.0, 30).resampled(f32::NAN).is_err());
    }
}
