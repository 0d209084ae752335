//! ORCA as its paper states it (van den Berg, Guy, Lin, Manocha 2011), in 64 bits and without a linear program: the nearest
//! point of a velocity obstacle's boundary is looked for on each of its three parts, and the best velocity among all
//! candidates. Slow, and nothing in common with the kernel but the paper.

use glam::DVec2;

/// Slack of comparisons, m/s.
const SLACK: f64 = 1e-9;

/// The velocities `v` with `(v - point) . normal >= 0`; the normal is a unit vector.
#[derive(Debug, Clone, Copy)]
pub(super) struct HalfPlane {
    pub(super) point: DVec2,
    pub(super) normal: DVec2,
}

impl HalfPlane {
    /// How far a velocity is outside, m/s; negative inside.
    pub(super) fn violation(&self, velocity: DVec2) -> f64 {
        (self.point - velocity).dot(self.normal)
    }

    fn along(&self) -> DVec2 {
        -self.normal.perp()
    }
}

/// A disc that moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Disc {
    pub(super) position: DVec2,
    pub(super) velocity: DVec2,
}

/// The velocities that `own` may have for `other` (equations 2 to 5 of the paper): half of the smallest change of the relative
/// velocity that brings it to the boundary of the velocity obstacle of the horizon `tau`, or of one step for discs that
/// overlap. `radius` is the sum of both.
pub(super) fn half_plane(own: Disc, other: Disc, radius: f64, tau: f64, time_step: f64) -> HalfPlane {
    let (to, relative) = (other.position - own.position, own.velocity - other.velocity);
    let distance = to.length();
    let (nearest, normal) = if distance <= radius {
        on_arc(to, relative, radius, time_step)
    } else {
        // the cone's legs touch the disc; the arc of the disc of `tau` lies between the points where they touch that
        let leg = (distance * distance - radius * radius).sqrt();
        let parts = [1.0, -1.0].map(|side: f64| {
            let direction = DVec2::new(leg, side * radius).rotate(to) / (distance * distance);
            let outward = direction.perp() * side;
            let at = relative.dot(direction).max(leg / tau);
            (direction * at, outward)
        });
        let (arc, out) = on_arc(to, relative, radius, tau);
        // the arc counts where it faces the origin, between the legs
        let is_facing = (arc - to / tau).dot(to) < -radius / tau * radius;
        let nearer = |a: (DVec2, DVec2), b: (DVec2, DVec2)| {
            if a.0.distance(relative) <= b.0.distance(relative) { a } else { b }
        };
        let legs = nearer(parts[0], parts[1]);
        if is_facing { nearer((arc, out), legs) } else { legs }
    };
    HalfPlane { point: own.velocity + 0.5 * (nearest - relative), normal }
}

/// The nearest point of the circle about `to / tau`, and its normal.
fn on_arc(to: DVec2, relative: DVec2, radius: f64, tau: f64) -> (DVec2, DVec2) {
    let normal = (relative - to / tau).normalize_or(DVec2::X);
    (to / tau + normal * (radius / tau), normal)
}

/// The velocity that an agent takes (equation 6, and section 5.3 where no velocity satisfies all).
#[derive(Debug, Clone, Copy)]
pub(super) struct Choice {
    pub(super) velocity: DVec2,
    /// The most that it violates any half-plane, m/s; 0 where all can be satisfied.
    pub(super) violation: f64,
}

/// The velocity nearest to `preferred` no faster than `most` in all half-planes; or else the one that violates none of the
/// first `hard`, and the others as little as can be.
pub(super) fn choose(planes: &[HalfPlane], hard: usize, most: f64, preferred: DVec2) -> Option<Choice> {
    let worst = |planes: &[HalfPlane], velocity: DVec2| {
        planes.iter().map(|plane| plane.violation(velocity)).fold(f64::NEG_INFINITY, f64::max)
    };
    let mut candidates = vec![preferred.clamp_length_max(most)];
    for (number, plane) in planes.iter().enumerate() {
        let foot = plane.point + plane.along() * (preferred - plane.point).dot(plane.along());
        candidates.push(foot);
        candidates.extend(on_circle(plane.point, plane.along(), most));
        candidates.extend(planes[..number].iter().filter_map(|other| meet(plane, other)));
    }
    let is_allowed = |planes: &[HalfPlane], velocity: &DVec2| {
        velocity.length() <= most + SLACK && worst(planes, *velocity) <= SLACK
    };
    let nearest = candidates
        .into_iter()
        .filter(|velocity| is_allowed(planes, velocity))
        .min_by(|a, b| a.distance_squared(preferred).total_cmp(&b.distance_squared(preferred)));
    if let Some(velocity) = nearest {
        return Some(Choice { velocity, violation: 0.0 });
    }
    // the least of a convex function: on lines where two violate alike, where these meet one another, the hard ones and the
    // circle, or at the circle's point deepest in one
    let (firm, soft) = planes.split_at(hard);
    let mut lines: Vec<HalfPlane> = firm.to_vec();
    let mut candidates: Vec<DVec2> = soft.iter().map(|plane| plane.normal * most).collect();
    for (number, a) in soft.iter().enumerate() {
        for b in &soft[..number] {
            // (p_a - v) . n_a = (p_b - v) . n_b
            let across = a.normal - b.normal;
            if across.length() > SLACK {
                let offset = a.point.dot(a.normal) - b.point.dot(b.normal);
                let normal = across.normalize();
                lines.push(HalfPlane { point: normal * (offset / across.length()), normal });
            }
        }
    }
    for (number, line) in lines.iter().enumerate() {
        candidates.extend(on_circle(line.point, line.along(), most));
        candidates.extend(lines[..number].iter().filter_map(|other| meet(line, other)));
    }
    let allowed = candidates.into_iter().filter(|velocity| is_allowed(firm, velocity));
    let least = allowed.min_by(|a, b| worst(soft, *a).total_cmp(&worst(soft, *b)))?;
    Some(Choice { velocity: least, violation: worst(soft, least) })
}

/// Where a line meets the circle of that radius about the origin.
fn on_circle(point: DVec2, along: DVec2, radius: f64) -> Vec<DVec2> {
    let middle = point - along * point.dot(along);
    let half = radius * radius - middle.length_squared();
    if half < 0.0 { Vec::new() } else { vec![middle + along * half.sqrt(), middle - along * half.sqrt()] }
}

/// Where the edges of two half-planes meet.
fn meet(a: &HalfPlane, b: &HalfPlane) -> Option<DVec2> {
    let determinant = a.along().perp_dot(b.along());
    let t = (b.point - a.point).perp_dot(b.along()) / determinant;
    (determinant.abs() > SLACK).then(|| a.point + a.along() * t)
}

/// Discs of one radius that walk to their goals.
#[derive(Debug, Clone)]
pub(super) struct Crowd {
    pub(super) discs: Vec<Disc>,
    pub(super) radius: f64,
    pub(super) max_speed: f64,
    pub(super) horizon: f64,
    pub(super) distance: f64,
    pub(super) neighbours: usize,
    pub(super) time_step: f64,
}

impl Crowd {
    /// What an agent chooses that prefers this velocity.
    pub(super) fn choice(&self, agent: usize, preferred: DVec2) -> Choice {
        let own = self.discs[agent];
        let away = |disc: &Disc| disc.position.distance(own.position);
        let mut others: Vec<Disc> = (self.discs.iter().enumerate())
            .filter(|(number, disc)| *number != agent && away(disc) < self.distance)
            .map(|(_, disc)| *disc)
            .collect();
        others.sort_by(|a, b| away(a).total_cmp(&away(b)));
        others.truncate(self.neighbours);
        let plane = |other: &Disc| half_plane(own, *other, 2.0 * self.radius, self.horizon, self.time_step);
        let planes: Vec<HalfPlane> = others.iter().map(plane).collect();
        choose(&planes, 0, self.max_speed, preferred).expect("without walls there is always a velocity")
    }

    /// One step of everyone at once.
    pub(super) fn step(&mut self, preferred: &[DVec2]) {
        let chosen: Vec<DVec2> =
            (0..self.discs.len()).map(|i| self.choice(i, preferred[i]).velocity).collect();
        for (disc, velocity) in self.discs.iter_mut().zip(chosen) {
            disc.velocity = velocity;
            disc.position += velocity * self.time_step;
        }
    }
}
