//! Claims about recordings of crowds: what is read, and how it is walked again.

mod data;
mod reading;
mod walking;
