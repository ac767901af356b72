//! The pages, one module each.

mod builder;
mod decoder;
mod live;

pub(crate) use builder::builder_page;
pub(crate) use decoder::{Decoder, decoder_page};
pub(crate) use live::{exchange_halves, live_page};
