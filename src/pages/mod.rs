//! The pages, one module each.

mod decoder;
mod live;

pub(crate) use decoder::{Desk, decoder_page};
pub(crate) use live::live_page;
