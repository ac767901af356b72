//! Page objects: what a user can do on a page and see there, so that tests speak of sensors and not of elements.

mod builder;
mod configure;
mod console;
mod decoder;
mod fleet;
mod handling;
mod help;
mod live;
mod profiles;
mod sequence;

pub use builder::BuilderPage;
pub use configure::ConfigurePage;
pub use console::ConsolePage;
pub use decoder::DecoderPage;
pub use fleet::{FleetPage, SensorRow};
pub use handling::{Handling, is_read_only, set_read_only};
pub use help::HelpSheet;
pub use live::{Figures, LivePage, State};
pub use profiles::ProfilesPage;
