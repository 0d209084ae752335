//! Studies with people (S-03, S-04, S-26 to S-30): what a study asks, who gets what, what page comes next.
//!
//! ```text
//!  study.toml ─► file ─► check ─► plan ─► protocol ─► pages, in a browser or a headset
//!                words   errors   who     (plan, events) -> page
//!                        minutes  gets
//!                        people   what ◄─ simulate: simulated participants
//! ```
//!
//! ```
//! use gaitway::study::plan::Plan;
//! use gaitway::study::protocol::{Content, Entry, Event, page};
//! use gaitway::study::{Materials, Study};
//!
//! # fn main() -> Result<(), gaitway::study::Error> {
//! let study = Study::builtin("eva-gaits")?;
//! let walks: Vec<String> = (1..=342).map(|number| format!("walk {number}")).collect();
//! let materials = Materials::default().with_gaits("library.glb", walks);
//! let plan = Plan::of(&study.file, &materials)?;
//! // nothing has happened yet: consent comes first
//! assert!(matches!(page(&plan, &[]).content, Content::Consent { .. }));
//! let agreed = Entry { at: 0, event: Event::Consented { text: "hash of the text".to_owned() } };
//! assert_eq!(page(&plan, &[agreed]).id, "about-you");
//! # Ok(())
//! # }
//! ```
//!
//! Times are UTC milliseconds, and always an argument: nothing here asks a clock, a disk or a network.

pub mod analyse;
mod asked;
pub mod check;
mod error;
pub mod export;
pub mod file;
#[cfg(feature = "xr")]
pub mod headset;
pub mod instrument;
pub mod lab;
mod load;
mod materials;
pub mod plan;
pub mod protocol;
pub mod register;
#[cfg(feature = "study")]
pub mod rehearse;
#[cfg(feature = "study")]
pub mod serve;
pub mod simulate;
#[cfg(feature = "study")]
pub mod store;
pub mod tables;
pub mod theatre;
mod words;

pub use check::check;
pub use error::{BadValue, Error};
pub use load::{BLANK, BUILTIN, Builtin, FILE_NAME, Study};
pub use materials::Materials;
pub use words::Words;
