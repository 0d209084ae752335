//! Props.

use super::ranges::{point, within};
use crate::scenario::error::Error;
use crate::scenario::file::Prop;

pub(super) fn check(index: usize, prop: &Prop) -> Result<(), Error> {
    point(&format!("environment.props[{index}].position"), prop.position)?;
    let key = format!("environment.props[{index}].heading_deg");
    within(&key, prop.heading_deg)?;
    for (i, &length) in prop.size.iter().enumerate() {
        let key = format!("environment.props[{index}].size[{i}]");
        within(&key, length)?;
    }
    Ok(())
}
