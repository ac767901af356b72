//! The analyst: texts of any size become lists of frames, in a worker beside the page.
//!
//! [`Desk`] does the work and knows no browser; the program of this package gives it a worker to work in. [`message`] is
//! all that crosses between worker and window. Nothing here makes sentences: that is the page's part, in two languages.

mod audit;
pub mod configure;
mod console;
mod desk;
mod diary;
mod export;
mod facts;
mod filter;
pub mod line;
mod look;
pub mod message;
mod scale;
mod statistics;
mod sums;
mod timing;

pub use console::Console;
pub use desk::{Cursor, Desk};
