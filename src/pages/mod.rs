//! The pages, one module each.

mod builder;
mod configure;
mod console;
mod decoder;
mod live;

pub(crate) use builder::{builder_bench, builder_page};
pub(crate) use configure::{Configure, banner, configure_page, follow_configuring};
pub(crate) use console::{Console, console_page, listen as listen_at_console};
pub(crate) use decoder::{Decoder, decoder_page};
pub(crate) use live::{connect_above, exchange_halves, live_page};
