//! The model of the Fleet page: snapshots side by side, a series of devices being set up, their labels, the audit log. Nothing
//! here knows the page.

pub(crate) mod addresses;
pub(crate) mod audit;
pub(crate) mod comparison;
pub(crate) mod labels;
pub(crate) mod series;
pub(crate) mod setup;
pub(crate) mod table;
