//! Buslens: reads, configures and debugs RS485 sensors from a web page.
//!
//! One program, two roles: in the window it draws the page, in a dedicated worker it runs the engine.

mod adapter;
mod analyst;
mod anatomy;
mod app;
mod builder;
mod clipboard;
mod components;
mod crash;
mod device;
mod diagnosis;
mod dom;
mod engine;
mod format;
mod history;
mod link;
mod message;
mod pages;
mod ports;
mod reactive;
mod route;
mod serial;
mod settings;
mod storage;
mod text;
mod theme;
mod trend;

fn main() {
    if web_sys::window().is_none() {
        engine::run();
    } else {
        crash::watch_panics();
        app::start();
    }
}
