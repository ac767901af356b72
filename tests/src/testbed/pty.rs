//! A pseudo-terminal: the browser opens one end as a serial port, the line holds the other.

use std::fs::File;
use std::os::fd::{AsFd, OwnedFd};
use std::path::{Path, PathBuf};

use buslens_codec::line::{DataBits, LineSettings, Parity, StopBits};
use nix::fcntl::{FcntlArg, FdFlag, fcntl};
use nix::pty::openpty;
use nix::sys::termios::{
    BaudRate, ControlFlags, InputFlags, SetArg, Termios, cfgetospeed, cfmakeraw, tcgetattr, tcsetattr,
};
use nix::unistd::ttyname;

/// A pty in raw mode.
pub struct Pty {
    /// The line's end.
    pub master: File,
    /// Held open so that the line's end never reads an end of file.
    _slave: OwnedFd,
    device: PathBuf,
}

impl Pty {
    /// A new pty.
    pub fn open() -> Self {
        let pair = openpty(None, None).expect("a pty");
        // A child that held the line's end open would keep an unplugged port alive.
        for end in [&pair.master, &pair.slave] {
            fcntl(end, FcntlArg::F_SETFD(FdFlag::FD_CLOEXEC)).expect("a descriptor takes flags");
        }
        let mut settings = tcgetattr(&pair.slave).expect("a pty is a terminal");
        cfmakeraw(&mut settings);
        tcsetattr(&pair.slave, SetArg::TCSANOW, &settings).expect("a pty takes settings");
        let device = ttyname(&pair.slave).expect("a pty has a name");
        Self { master: pair.master.into(), _slave: pair.slave, device }
    }

    /// The path to open.
    pub fn device(&self) -> &Path {
        &self.device
    }

    /// The settings that whoever opened the path asked for; `None` for a baud rate that is not in the list below. A pty
    /// hides the character size and the parity's enabling bit, so data bits are always eight ([`super::Adapter`] knows what
    /// was asked for) and parity is told by the input check.
    pub fn settings(&self) -> Option<LineSettings> {
        let settings = tcgetattr(self.master.as_fd()).ok()?;
        Some(LineSettings {
            baud: baud(&settings)?,
            data_bits: DataBits::Eight,
            parity: match settings.input_flags.contains(InputFlags::INPCK) {
                false => Parity::None,
                true if settings.control_flags.contains(ControlFlags::PARODD) => Parity::Odd,
                true => Parity::Even,
            },
            stop_bits: if settings.control_flags.contains(ControlFlags::CSTOPB) {
                StopBits::Two
            } else {
                StopBits::One
            },
        })
    }
}

fn baud(settings: &Termios) -> Option<u32> {
    Some(match cfgetospeed(settings) {
        BaudRate::B1200 => 1200,
        BaudRate::B2400 => 2400,
        BaudRate::B4800 => 4800,
        BaudRate::B9600 => 9600,
        BaudRate::B19200 => 19_200,
        BaudRate::B38400 => 38_400,
        BaudRate::B57600 => 57_600,
        BaudRate::B115200 => 115_200,
        _ => return None,
    })
}
