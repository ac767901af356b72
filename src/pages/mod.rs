//! The pages, one module each.

mod builder;
mod configure;
mod console;
mod decoder;
mod fleet;
mod handling;
mod help;
mod live;
mod profiles;

pub(crate) use builder::{builder_bench, builder_page};
pub(crate) use configure::{Configure, banner, configure_page, follow_configuring};
pub(crate) use console::{Console, console_page, listen as listen_at_console};
pub(crate) use decoder::{Decoder, decoder_page};
pub(crate) use fleet::{Fleet, fleet_page, follow_fleet};
pub(crate) use handling::{Handling, handling, marks};
pub(crate) use help::{help_sheet, open_help};
pub(crate) use live::{connect_above, exchange_halves, exchange_of, live_page};
pub(crate) use profiles::{Profiles, listen as listen_at_profiles, profiles_page};
