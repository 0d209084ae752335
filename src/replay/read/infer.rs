//! Inference of what a text does not state, from its data: the person's column, the frame rate, the unit.

use super::columns::Columns;
use super::{Error, Format, Found, Options, Row, syntax, unusable};
use std::path::Path;

/// Customary samples a second in data sets for the prediction of ways (ETH, UCY, TrajNet, SGAN).
const CUSTOM: f64 = 2.5;
/// Frames between two of their samples: at 15, 25 and 30 frames a second.
const CUSTOMARY_STEPS: [f64; 3] = [6.0, 10.0, 12.0];
/// Length of a step between two such samples, m; samples of faster cameras are closer.
const CUSTOMARY_LENGTH: [f64; 2] = [0.4, 0.8];
/// Rates of cameras and simulations, frames a second.
const USUAL_RATES: [f64; 14] = [1.0, 2.0, 2.5, 4.0, 5.0, 8.0, 10.0, 12.5, 15.0, 16.0, 20.0, 30.0, 50.0, 60.0];
/// Median speeds of walking people lie below, m/s.
const BRISK: f64 = 2.5;
/// A crowd measured in centimetres has coordinates beyond this.
const CENTIMETRES: f64 = 150.0;
/// Shorter ways between two samples count as jitter, in units of the file.
const STILL: f64 = 1e-3;

/// Sorts by person and frame.
pub(super) fn sort(rows: &mut [Row]) {
    // stable: the first of duplicates stays first
    rows.sort_by(|a, b| a.id.cmp(&b.id).then(a.frame.total_cmp(&b.frame)));
}

/// Whether the rows stand in the file by person and frame, or by frame and person.
pub(super) fn is_in_order(rows: &mut [Row]) -> bool {
    rows.sort_by_key(|row| row.line);
    rows.is_sorted_by(|a, b| (a.id, a.frame) <= (b.id, b.frame))
        || rows.is_sorted_by(|a, b| (a.frame, a.id) <= (b.frame, b.id))
}

/// Successive samples of one person.
pub(super) fn pairs(rows: &[Row]) -> impl Iterator<Item = (&Row, &Row)> {
    rows.windows(2).map(|two| (&two[0], &two[1])).filter(|(a, b)| a.id == b.id && b.frame > a.frame)
}

pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Disorder of successive rows of one person: the median distance between them, in units of the file, times the relative
/// change of velocity from one to the next. The relative change is about 0.1 for walking people and 1 for unrelated places.
/// Below 0.1 it does not discriminate: a row of people in line is as smooth. `None` where no person has two rows.
fn disorder(rows: &[Row]) -> Option<f64> {
    let distance = median(pairs(rows).map(|(a, b)| a.place.distance(b.place)).collect())?;
    let (mut change, mut speed) = (0.0, 0.0);
    for three in rows.windows(3) {
        let [a, b, c] = three else { continue };
        if a.id == b.id && b.id == c.id && a.frame < b.frame && b.frame < c.frame {
            let before = (b.place - a.place) / (b.frame - a.frame);
            let after = (c.place - b.place) / (c.frame - b.frame);
            change += before.distance(after);
            speed += before.length() + after.length();
        }
    }
    let share: f64 = if speed > 0.0 { change / speed } else { 1.0 };
    Some(distance * share.max(0.1))
}

/// Whether the first column is the person and the second the frame, as in the archive, or the other way round.
pub(super) fn order(found: &mut Found) {
    let exchange = |rows: &mut [Row]| {
        for row in rows.iter_mut() {
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_precision_loss,
                reason = "whole, of 53 bits"
            )]
            let (id, frame) = (row.frame as i64, row.id as f64);
            (row.id, row.frame) = (id, frame);
        }
        sort(rows);
    };
    sort(&mut found.rows);
    let as_is = disorder(&found.rows);
    exchange(&mut found.rows);
    let is_exchanged = match (as_is, disorder(&found.rows)) {
        (Some(as_is), Some(exchanged)) => exchanged < 0.6 * as_is,
        (as_is, exchanged) => as_is.is_none() && exchanged.is_some(),
    };
    if !is_exchanged {
        exchange(&mut found.rows);
        return;
    }
    found.format = Format::Columns;
    if let Some((Columns(columns), _)) = &mut found.columns {
        columns.swap(0, 1);
    }
}

/// Frames out of times in seconds, which stand in their place: evenly spaced ones are counted, others keep their times.
pub(super) fn frames_of_times(path: &Path, found: &mut Found) -> Result<(), Error> {
    sort(&mut found.rows);
    if let Some(row) = found.rows.iter().find(|row| row.frame.abs() > 1e12) {
        return Err(syntax(path, row.line, format!("the time is {} s; at most 1e12 is read", row.frame)));
    }
    // A time that repeats is two rows of one moment, not a step.
    let Some(step) = median(pairs(&found.rows).map(|(a, b)| b.frame - a.frame).collect()) else {
        return Ok(()); // everybody is seen once: the frame is the second
    };
    let rate = (1000.0 / step).round() / 1000.0;
    let first = found.rows.iter().map(|row| row.frame).fold(f64::INFINITY, f64::min);
    let frame = |row: &Row| (row.frame - first) * rate;
    let odd = found.rows.iter().filter(|row| (frame(row) - frame(row).round()).abs() > 0.1).count();
    let is_even = odd * 100 <= found.rows.len();
    for row in &mut found.rows {
        row.frame = if is_even { frame(row).round() } else { frame(row) };
    }
    found.frame_rate = Some((rate, "times"));
    if !is_even {
        found.is_curve = true;
        found.notes.push("times are not evenly spaced; they are kept".to_owned());
    }
    Ok(())
}

/// The unit of a recording, and the origin of that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Measures {
    pub(super) rate: f64,
    pub(super) rate_from: &'static str,
    pub(super) metres: f64,
    pub(super) metres_from: &'static str,
}

/// Frame rate and unit, said or inferred. The rows must be sorted.
pub(super) fn measures(path: &Path, found: &mut Found, options: &Options) -> Result<Measures, Error> {
    let asked = |value: Option<f64>| value.map(|value| (value, "asked for"));
    let heights = median(found.heights.iter().copied().filter(|z| *z > 0.0).collect());
    let mut unit =
        asked(options.metres_per_unit).or(found.metres_per_unit).or_else(|| by_height(found, heights));
    let said = asked(options.frame_rate).or(found.frame_rate);
    let rate = said.or_else(|| by_velocities(found, &mut unit)).or_else(|| by_steps(found, unit));
    let Some((rate, rate_from)) = rate.or(found.usual_rate.map(|rate| (rate, "format"))) else {
        return Err(no_rate(path, found, unit));
    };
    if !(0.1..=1000.0).contains(&rate) {
        let message = format!("{rate} frames per second; it must be 0.1 to 1000");
        return Err(unusable(path, message, "give --fps"));
    }
    let (metres, metres_from) = unit.unwrap_or_else(|| by_speed(found, rate));
    if !(1e-4..=1e4).contains(&metres) {
        let message = format!("{metres} metres per unit; it must be 0.0001 to 10000");
        return Err(unusable(path, message, "1 is metres, 0.01 centimetres"));
    }
    Ok(Measures { rate, rate_from, metres, metres_from })
}

/// The unit by the height of people.
fn by_height(found: &mut Found, height: Option<f64>) -> Option<(f64, &'static str)> {
    let metres = match height? {
        height if (0.5..3.0).contains(&height) => 1.0,
        height if (50.0..300.0).contains(&height) => 0.01,
        height if (500.0..3000.0).contains(&height) => 0.001,
        _ => return None,
    };
    let height = height.unwrap_or_default();
    found.notes.push(format!(
        "unit inferred: {} (people are {} tall)",
        name_of_unit(metres),
        (100.0 * height).round() / 100.0
    ));
    Some((metres, "heights"))
}

/// The unit by how fast people walk.
fn by_speed(found: &mut Found, rate: f64) -> (f64, &'static str) {
    let Some(speed) = speed(&found.rows, rate) else { return (1.0, "usual") };
    // People do not walk at 10 m/s, and at 10 cm/s a crowd would stand. Places of few units, however, are no centimetres: there
    // the columns or the rate are wrong.
    let reach = found.rows.iter().map(|row| row.place.abs().max_element()).fold(0.0, f64::max);
    let metres = match speed {
        speed if speed <= 10.0 || reach < CENTIMETRES => 1.0,
        speed if speed <= 400.0 => 0.01,
        speed if speed <= 4000.0 => 0.001,
        _ => 1.0,
    };
    let name = name_of_unit(metres);
    found
        .notes
        .push(format!("unit inferred: {name} (half of the steps are faster than {speed:.2} a second)"));
    (metres, "speeds")
}

/// The usual name of a unit.
#[doc(hidden)]
pub fn name_of_unit(metres: f64) -> String {
    let names = [(1.0, "metres"), (0.01, "centimetres"), (0.001, "millimetres"), (0.3048, "feet")];
    let known = names.into_iter().find(|(unit, _)| (metres / unit - 1.0).abs() < 1e-9);
    known.map_or_else(|| format!("units of {metres} m"), |(_, name)| name.to_owned())
}

/// Median speed between samples, in units of the file.
fn speed(rows: &[Row], rate: f64) -> Option<f64> {
    median(pairs(rows).map(|(a, b)| a.place.distance(b.place) * rate / (b.frame - a.frame)).collect())
}

/// The frame rate from columns of velocities: frames between two places, over the time that the velocity beside them takes.
/// Velocities may be those of the step before, the step after or both; the best fit is taken.
fn by_velocities(found: &Found, unit: &mut Option<(f64, &'static str)>) -> Option<(f64, &'static str)> {
    let mut best: Option<(f64, f64)> = None;
    for (first, second) in [(1.0, 0.0), (0.0, 1.0), (0.5, 0.5)] {
        let ratio = |(a, b): (&Row, &Row)| {
            let length = |row: &Row| row.velocity.map(|[x, y]| libm::hypot(f64::from(x), f64::from(y)));
            let speed = first * length(a)? + second * length(b)?;
            let way = a.place.distance(b.place) / (b.frame - a.frame);
            (way > STILL && speed > STILL).then_some(speed / way)
        };
        let mut ratios: Vec<f64> = pairs(&found.rows).filter_map(ratio).collect();
        if ratios.is_empty() {
            continue;
        }
        ratios.sort_by(f64::total_cmp);
        let at = |share: usize| ratios[(ratios.len() * share / 4).min(ratios.len() - 1)];
        let spread = at(3) / at(1);
        if best.is_none_or(|(_, least)| spread < least) {
            best = Some((at(2), spread));
        }
    }
    let (mut ratio, spread) = best?;
    if spread > 2.0 {
        return None; // they are no velocities of these places
    }
    if ratio < 0.5 && unit.is_none_or(|(metres, _)| (metres - 0.01).abs() < 1e-9) {
        ratio *= 100.0; // velocities in metres a second beside places in centimetres
        *unit = unit.or(Some((0.01, "velocities")));
    }
    Some((usual(ratio, usual_interval(&found.rows)), "velocities"))
}

/// The usual rate that a measured one is meant to be, given the frames between two samples.
fn usual(measured: f64, interval: f64) -> f64 {
    let off = |rate: f64| (measured / rate - 1.0).abs();
    if off(CUSTOM * interval) < 0.08 {
        return CUSTOM * interval;
    }
    let near = USUAL_RATES.into_iter().chain([24.0, 25.0, 100.0, 120.0]);
    match near.min_by(|a, b| off(*a).total_cmp(&off(*b))) {
        Some(rate) if off(rate) < 0.03 => rate,
        _ => (measured * 100.0).round() / 100.0,
    }
}

/// The frame rate by steps of 0.4 s, if that is what they are: by the frames between them, or by their length.
fn by_steps(found: &Found, unit: Option<(f64, &'static str)>) -> Option<(f64, &'static str)> {
    if found.is_curve {
        return None;
    }
    let metres = unit.map_or(1.0, |(metres, _)| metres);
    let interval = usual_interval(&found.rows);
    let rate = CUSTOM * interval;
    let speed = speed(&found.rows, rate)? * metres;
    let is_customary = CUSTOMARY_STEPS.contains(&interval) && speed < BRISK;
    let [least, most] = CUSTOMARY_LENGTH.map(|length| length * CUSTOM);
    (is_customary || (least..most).contains(&speed)).then_some((rate, "steps"))
}

/// The file says no rate, and its data tell none.
fn no_rate(path: &Path, found: &Found, unit: Option<(f64, &'static str)>) -> Error {
    let (metres, _) = unit.unwrap_or((1.0, ""));
    let walk =
        |rate: f64| speed(&found.rows, rate).map(|speed| format!("{:.2} m/s at {rate}", speed * metres));
    let speeds: Vec<String> = [10.0, 16.0, 25.0, 30.0].into_iter().filter_map(walk).collect();
    let speeds = if speeds.is_empty() { "no person moves".to_owned() } else { speeds.join(", ") };
    let hint = format!(
        "give --fps; the recordings of Juelich have 16 or 25 (half of the steps would be faster than {speeds})"
    );
    unusable(path, "the file does not say how many frames a second it has", hint)
}

/// Frames between two samples of a person: the middle value.
pub(super) fn usual_interval(rows: &[Row]) -> f64 {
    median(pairs(rows).map(|(a, b)| b.frame - a.frame).collect()).unwrap_or(1.0)
}
