//! Pages as HTML: pure functions of what they show. Text is escaped where it is put in; nothing needs scripts but films.

mod ended;
mod frame;
mod notice;
mod questions;
mod turn;
mod welcome;

pub(super) use frame::{Frame, Visit};
pub(super) use notice::{Notice, notice, withdrawal};
pub(super) use questions::{Filled, PREFIX};
pub(super) use turn::{Texts, turn};
pub(super) use welcome::{Welcome, welcome};
