//! Buslens: reads, configures and debugs RS485 sensors from a web page.
//!
//! Three programs are made of this. The first, [`run`], is all that a visitor needs to read a sensor; it has two roles: in
//! the window it draws the page, in a dedicated worker it runs the engine. The second, [`workbench`], explains and
//! builds frames; the first loads it into the same window when it is needed. The third, [`simulator`], is the line of a
//! demonstration; the engine loads it into its worker when somebody connects to it.

mod adapter;
mod ambient;
mod analyst;
mod anatomy;
mod app;
mod builder;
mod clipboard;
mod components;
mod configure;
mod configuring;
mod console;
mod crash;
mod device;
mod diagnosis;
mod dom;
mod engine;
mod fleet;
mod format;
mod history;
mod link;
mod loader;
mod message;
mod pages;
mod ports;
mod profiles;
mod reactive;
mod route;
mod serial;
mod settings;
pub mod simulator;
mod storage;
mod text;
mod theme;
mod trend;
pub mod workbench;
mod worker;

/// Runs the first program in the role that its place asks for.
pub fn run() {
    if web_sys::window().is_none() {
        engine::run();
    } else {
        app::start();
    }
}
