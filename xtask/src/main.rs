//! Builds, serves and tests Buslens. `cargo xtask --help` tells how.

mod browser;
mod check;
mod headers;
mod libtest;
mod machine;
mod minify;
mod serve;
mod site;
mod toolchain;

use std::process::ExitCode;

use anyhow::{Result, bail};
use lexopt::prelude::*;

use crate::check::Step;

const HELP: &str = "\
cargo xtask <command> [options]

  build            compile the site into dist/
  serve            build, then serve dist/ on localhost
  test             check and test everything; the last line sums it up
  photos           build, then take pictures of every page into target/photos/
  bench            measure the codec beside its peers, then the page in the browser

  --debian-std     all but bench's first part: compile the wasm target's standard library from Debian's
                   packages, even where the target is installed
  --symbols        build, serve: keep function names in the wasm file, for debugging
  --quick          build, serve, photos: compile in a fraction of the time, for trying things out; the site is large
  --port <number>  serve: first port to try (8460)
  --only <step>    test: only this step; may be given several times: fmt, clippy, unit, doc, bare, browser
";

fn main() -> ExitCode {
    match Task::from_args().and_then(Task::run) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

enum Task {
    Help,
    Build(site::Options),
    Serve(site::Options, u16),
    Test(site::Options, Vec<Step>),
    Photos(site::Options),
    Bench(site::Options),
}

impl Task {
    fn from_args() -> Result<Self> {
        let mut args = lexopt::Parser::from_env();
        let mut command = None;
        let mut options = site::Options::default();
        let mut port = None;
        let mut only = Vec::new();
        while let Some(arg) = args.next()? {
            match arg {
                Short('h') | Long("help") => return Ok(Self::Help),
                Long("debian-std") => options.debian_std = true,
                Long("symbols") => options.symbols = true,
                Long("quick") => options.quick = true,
                Long("port") => port = Some(args.value()?.parse()?),
                Long("only") => only.push(args.value()?.string()?.parse()?),
                Value(name) if command.is_none() => command = Some(name.string()?),
                _ => return Err(arg.unexpected().into()),
            }
        }
        let command = command.unwrap_or_default();
        if port.is_some() && command != "serve" {
            bail!("--port belongs to serve");
        }
        if !only.is_empty() && command != "test" {
            bail!("--only belongs to test");
        }
        if options.symbols && !["build", "serve"].contains(&command.as_str()) {
            bail!("--symbols belongs to build and serve");
        }
        if options.quick && !["build", "serve", "photos"].contains(&command.as_str()) {
            bail!("--quick belongs to build, serve and photos");
        }
        match command.as_str() {
            "build" => Ok(Self::Build(options)),
            "serve" => Ok(Self::Serve(options, port.unwrap_or(serve::PORT))),
            "test" => Ok(Self::Test(options, if only.is_empty() { Step::ALL.to_vec() } else { only })),
            "photos" => Ok(Self::Photos(options)),
            "bench" => Ok(Self::Bench(options)),
            "" => Ok(Self::Help),
            other => bail!("there is no command `{other}`\n\n{HELP}"),
        }
    }

    fn run(self) -> Result<ExitCode> {
        match self {
            Self::Help => print!("{HELP}"),
            Self::Build(options) => site::build(options, &machine::root().join("dist"))?.check()?,
            Self::Serve(options, port) => {
                let door = serve::open(port)?;
                let dist = machine::root().join("dist");
                if let Err(error) = site::build(options, &dist)?.check() {
                    println!("warning: {error}");
                }
                if door.port() != port {
                    println!("port {port} is busy");
                }
                println!("serving http://localhost:{}/ (end with Ctrl-C)", door.port());
                door.serve(dist)?;
            }
            Self::Test(options, steps) => return Ok(check::run(options, &steps)),
            Self::Photos(options) => browser::photos(options)?,
            Self::Bench(options) => {
                machine::run(machine::cargo().args([
                    "bench",
                    "--locked",
                    "--package",
                    "buslens-bench",
                    "--bench",
                    "ratios",
                ]))?;
                browser::measure(options)?;
            }
        }
        Ok(ExitCode::SUCCESS)
    }
}
