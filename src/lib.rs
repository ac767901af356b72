//! Buslens: reads, configures and debugs RS485 sensors from a web page.
//!
//! Two programs are made of this. The first, [`run`], is all that a visitor needs to read a sensor; it has two roles: in
//! the window it draws the page, in a dedicated worker it runs the engine. The second, [`workbench`], explains and
//! builds frames; the first loads it into the same window when it is needed.

mod adapter;
mod ambient;
mod analyst;
mod anatomy;
mod app;
mod builder;
mod clipboard;
mod components;
mod configuring;
