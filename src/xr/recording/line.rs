//! The lines of a recording's table: the user in one step.

use super::{FIRST_VERSION, UserState};
use glam::Vec2;

/// The columns.
pub(super) const COLUMNS: &str = "step,x_m,z_m,y_m,vx,vz,head_x,head_y,head_z,head_qx,head_qy,head_qz,head_qw,left_x,left_y,left_z,\
                       left_qx,left_qy,left_qz,left_qw,right_x,right_y,right_z,right_qx,right_qy,right_qz,right_qw,\
                       walk_x,walk_y,turn";
/// The height of the floor among them, which format 1 does not have.
const HEIGHT: usize = 3;

/// The line of a step.
pub(super) fn written(step: u32, user: &UserState) -> String {
    let mut line = step.to_string();
    let ([x, z], [vx, vz]) = (user.place.to_array(), user.velocity.to_array());
    for value in [x, z, user.elevation, vx, vz] {
        line += &format!(",{value}");
    }
    for pose in [user.head, user.hands[0], user.hands[1]] {
        match pose {
            Some(pose) => pose.iter().for_each(|value| line += &format!(",{value}")),
            None => line += ",,,,,,,",
        }
    }
    user.sticks.iter().for_each(|value| line += &format!(",{value}"));
    line += "\n";
    line
}

/// One line of the table, which must be that of step `step`.
pub(super) fn user_state(line: &str, step: usize, format: u32) -> Result<UserState, String> {
    let mut fields: Vec<&str> = line.split(',').collect();
    let is_first = format == FIRST_VERSION;
    let wanted = COLUMNS.split(',').count() - usize::from(is_first);
    if fields.len() != wanted {
        return Err(format!("{} fields; there must be {wanted}", fields.len()));
    }
    if is_first {
        fields.insert(HEIGHT, "0");
    }
    if fields[0].parse() != Ok(step) {
        return Err(format!("step {:?}; it should be {step}", fields[0]));
    }
    let number = |field: usize| match fields[field].parse::<f32>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("field {}: {:?} is not a finite number", field + 1, fields[field])),
    };
    let pose = |first: usize| {
        if fields[first..first + 7].iter().all(|field| field.is_empty()) {
            return Ok(None);
        }
        let mut values = [0.0; 7];
        for (place, value) in values.iter_mut().enumerate() {
            *value = number(first + place)?;
        }
        Ok::<_, String>(Some(values))
    };
    Ok(UserState {
        place: Vec2::new(number(1)?, number(2)?),
        elevation: number(3)?,
        velocity: Vec2::new(number(4)?, number(5)?),
        head: pose(6)?,
        hands: [pose(13)?, pose(20)?],
        sticks: [number(27)?, number(28)?, number(29)?],
    })
}
