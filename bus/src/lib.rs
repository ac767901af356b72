//! The bus: a sans-io master for Modbus on a serial line, and a simulated line with sensors to try it on.
//!
//! Nothing here opens a port, reads a clock or sets a timer. [`Master`] takes bytes, link events and the time, and is
//! then drained of what it wants done; hours of a line pass in milliseconds of a test.
//!
//! ```
//! use buslens_bus::{Config, Event, Job, LinkEvent, LinkOrder, Master, time::Instant};
//! use buslens_codec::{UnitId, line::{LineSettings, Mode, Parity}, pdu::Request};
//!
//! let mut now = Instant::ZERO;
//! let mut master = Master::new(Config::new(LineSettings::new(9600, Parity::Even), Mode::Rtu));
//! master.connect(now);
//! assert!(matches!(master.poll_link(), Some(LinkOrder::Open(_))));
//! master.handle_link(now, LinkEvent::Opened);
//! master.submit(now, Job::new(UnitId(1), Request::ReadHoldingRegisters { address: 0x31, quantity: 1 }));
//! now = master.poll_timeout().unwrap();
//! master.handle_timeout(now);
//! assert_eq!(master.poll_transmit().unwrap().bytes, [0x01, 0x03, 0x00, 0x31, 0x00, 0x01, 0xD5, 0xC5]);
//! master.handle_bytes(now, &[0x01, 0x03, 0x02, 0x00, 0x07, 0xF9, 0x86]);
//! while let Some(event) = master.poll_event() {
//!     if let Event::Done { exchange, .. } = event {
//!         assert!(exchange.result.is_ok());
//!     }
//! }
//! ```

mod master;
mod outcome;
pub mod record;
pub mod sim;
pub mod time;

pub use master::{Config, Content, Event, Job, JobId, LinkEvent, LinkOrder, LinkState, Master, Poll, Transmit};
pub use outcome::{Answer, Counters, Exchange, Failure, NextStep};
