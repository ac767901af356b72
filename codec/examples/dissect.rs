//! Reads pasted text from standard input and writes what it holds as JSON Lines: an object for each frame and each stretch
//! of noise. Places that cannot be read are named on standard error.

use std::env;
use std::io::{self, Read, Write};
use std::process::ExitCode;

use buslens_codec::intake;
use buslens_codec::json::Lines;
use buslens_codec::profile::{BUILT_IN, Profile};
use buslens_codec::transcript::Transcript;

/// Nothing could be read.
const NOTHING: u8 = 1;
/// The arguments are wrong.
const USAGE: u8 = 2;
/// Characters that are collected before they are written.
const PORTION: usize = 1 << 16;

fn main() -> ExitCode {
    let arguments: Vec<String> =
        env::args_os().skip(1).map(|argument| argument.to_string_lossy().into_owned()).collect();
    let (mut out, mut notes) = (io::stdout().lock(), io::stderr().lock());
    match run(&arguments, &mut io::stdin().lock(), &mut out, &mut notes) {
        Ok(code) => ExitCode::from(code),
        // Whoever reads has seen enough.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(notes, "{error}");
            ExitCode::FAILURE
        }
    }
}

/// The whole program: 0, or why it did not work.
pub(crate) fn run(
    arguments: &[String],
    input: &mut impl Read,
    out: &mut impl Write,
    notes: &mut impl Write,
) -> io::Result<u8> {
    let profiles: Vec<Profile> = BUILT_IN.iter().filter_map(|text| Profile::from_json(text).ok()).collect();
    let chosen = match arguments {
        [] => Choice::Auto,
        [option, name] if option == "--profile" => match profiles.iter().find(|profile| profile.id == *name) {
            Some(profile) => Choice::Named(profile),
            None if name == "auto" => Choice::Auto,
            None => return usage(&profiles, notes),
        },
        _ => return usage(&profiles, notes),
    };
    let mut bytes = Vec::new();
    input.read_to_end(&mut bytes)?;
    let (transcript, faults) = read(&String::from_utf8_lossy(&bytes), notes)?;
    if transcript.stream_len() == 0 {
        if faults == 0 {
            writeln!(notes, "no bytes in this text")?;
        }
        return Ok(NOTHING);
    }
    let profile = match chosen {
        Choice::Auto => transcript.most_explaining(&profiles),
        Choice::Named(profile) => Some(profile),
    };
    let mut lines = Lines::new(&transcript, profile);
    let mut text = String::new();
    while lines.write_next(&mut text) {
        if text.len() >= PORTION {
            out.write_all(text.as_bytes())?;
            text.clear();
        }
    }
    out.write_all(text.as_bytes())?;
    out.flush()?;
    Ok(0)
}

enum Choice<'a> {
    Auto,
    Named(&'a Profile),
}

fn usage(profiles: &[Profile], notes: &mut impl Write) -> io::Result<u8> {
    let names: Vec<&str> = profiles.iter().map(|profile| profile.id.as_str()).collect();
    writeln!(notes, "usage: dissect [--profile {}|auto] < TEXT", names.join("|"))?;
    Ok(USAGE)
}

/// What the text holds, and how many places could not be read.
fn read(text: &str, notes: &mut impl Write) -> io::Result<(Transcript, usize)> {
    let found = intake::read(text);
    for fault in &found.faults {
        writeln!(notes, "{fault}")?;
    }
    if found.fault_count > found.faults.len() {
        writeln!(notes, "and {} more", found.fault_count - found.faults.len())?;
    }
    let mut transcript = Transcript::new();
    transcript.push(&found.bytes, &found.segments);
    transcript.finish();
    Ok((transcript, found.fault_count))
}
