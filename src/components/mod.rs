//! Parts of the page that several places use.

pub(crate) mod alert;
pub(crate) mod bring;
pub(crate) mod button;
pub(crate) mod bytes;
pub(crate) mod desk;
pub(crate) mod field;
pub(crate) mod icon;
pub(crate) mod list;
pub(crate) mod sheet;
pub(crate) mod shell;
pub(crate) mod tabs;
