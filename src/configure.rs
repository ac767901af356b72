//! The model of the Configure page: what is staged, what the table says, all of it in words. Nothing here knows the page.

pub(crate) mod ending;
pub(crate) mod report;
pub(crate) mod row;
pub(crate) mod staged;
pub(crate) mod words;
