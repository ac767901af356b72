//! Any log or session as another file: `cargo run -q --release -p buslens-analyst --example convert -- FORMAT < LOG > FILE`.
//! FORMAT is json, csv, hex, text, pcap or session. Wireshark's console shows a capture:
//! `... convert -- pcap < LOG | tshark -r - -V`.

use std::io::{self, Read, Write};
use std::process::ExitCode;

use buslens_analyst::Desk;
use buslens_analyst::message::Format;

fn main() -> ExitCode {
    let format = match std::env::args().nth(1).as_deref() {
        Some("json") => Format::JsonLines,
        Some("csv") => Format::Csv,
        Some("hex") => Format::Hex,
        Some("text") => Format::Text,
        Some("pcap") => Format::Pcap,
        Some("session") => Format::Session,
        _ => {
            eprintln!("usage: convert json|csv|hex|text|pcap|session < LOG > FILE");
            return ExitCode::from(2);
        }
    };
    match convert(format) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn convert(format: Format) -> io::Result<()> {
    let mut log = Vec::new();
    io::stdin().read_to_end(&mut log)?;
    let log = String::from_utf8_lossy(&log);
    let mut desk = Desk::new();
    desk.begin(1, None, 0);
    desk.push(&log, 0);
    desk.finish();
    while desk.work(usize::MAX) {}
    for fault in desk.progress().faults {
        eprintln!("{fault}");
    }
    let mut out = io::stdout().lock();
    let mut written = Ok(());
    desk.export(format, |part| {
        if written.is_ok() {
            written = out.write_all(part);
        }
    });
    written.and_then(|()| out.flush())
}
