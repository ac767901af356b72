//! A USB serial adapter that the browser believes in.
//!
//! umockdev redirects the browser's view of /dev, /sys and udev into a folder. Its major and minor number are those of a
//! serial driver in /proc/tty/drivers (4:64), which Chromium looks up. The device node is a link to the pty of the day.

use std::fs;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::os::unix::fs::symlink;
use std::os::unix::net::{UnixDatagram, UnixListener, UnixStream};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::thread;

use buslens_codec::line::DataBits;
use nix::libc;
use nix::sys::signal::{Signal, killpg};
use nix::unistd::Pid;

const DESCRIPTION: &str = include_str!("adapter.umockdev");
const DEVPATH: &str = "/devices/pci0000:00/0000:00:14.0/usb1/1-1/1-1:1.0/ttyUSB0/tty/ttyUSB0";

/// USB vendor and product id.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UsbId(pub u16, pub u16);

/// The most common cheap adapter.
pub const CH340: UsbId = UsbId(0x1a86, 0x7523);

/// An adapter, and the chromedriver that runs in its world.
pub struct Adapter {
    usb: UsbId,
    process: Child,
    root: PathBuf,
    /// Major and minor number as umockdev writes them down for a pty.
    number: PathBuf,
    driver_port: u16,
    port: Arc<Port>,
    _description: tempfile::TempDir,
}

/// What the system knows of the port.
#[derive(Default)]
struct Port {
    /// Another program holds it.
    is_busy: AtomicBool,
    /// The control flags of the last settings that were asked for.
    control: AtomicU32,
}

impl Adapter {
    /// Starts umockdev and chromedriver. No port is there yet.
    pub fn start(usb: UsbId) -> Self {
        let folder = tempfile::tempdir().expect("a folder for temporary files");
        let description = folder.path().join("adapter.umockdev");
        let (vendor, product) = (format!("{:04x}", usb.0), format!("{:04x}", usb.1));
        let text = DESCRIPTION.replace("{vendor}", &vendor).replace("{product}", &product);
        fs::write(&description, text).expect("the folder is writable");
        let mut process = Command::new("umockdev-run")
            .arg("-d")
            .arg(&description)
            .args(["--", "sh", "-c", "echo \"root $UMOCKDEV_DIR\"; exec chromedriver --port=0"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .process_group(0)
            .spawn()
            .expect("umockdev-run starts (package umockdev)");
        let mut lines = BufReader::new(process.stdout.take().expect("stdout is piped")).lines();
        let mut root = None;
        let mut driver_port = None;
        while driver_port.is_none() {
            let Some(Ok(line)) = lines.next() else { break };
            if let Some(folder) = line.strip_prefix("root ") {
                root = Some(PathBuf::from(folder));
            }
            if let Some(rest) = line.split(" successfully on port ").nth(1) {
                driver_port = rest.trim_end_matches('.').parse().ok();
            }
        }
        // Whatever chromedriver says later must not fill the pipe.
        thread::spawn(move || lines.for_each(drop));
        let root = root.expect("umockdev-run makes a world");
        let driver_port = driver_port.expect("chromedriver starts (package chromium-driver)");
        let ptymap = root.join("dev/.ptymap");
        let known = fs::read_dir(&ptymap).expect("umockdev keeps a map of ptys").next();
        let known = known.expect("umockdev made a pty for the device").expect("the map is readable");
        let number = fs::read_link(known.path()).expect("the map holds links");
        // Until something is plugged in there is no node.
        let _ = fs::remove_file(root.join("dev/ttyUSB0"));
        let port = Arc::default();
        answer_ioctls(&root.join("ioctl/dev/ttyUSB0"), &port);
        Self { usb, process, root, number, driver_port, port, _description: folder }
    }

    pub(super) fn driver_port(&self) -> u16 {
        self.driver_port
    }

    pub(super) fn process_id(&self) -> u32 {
        self.process.id()
    }

    /// Plugs the adapter in; `device` is the pty that it leads to.
    pub fn plug(&self, device: &Path) {
        self.lead_to(device);
        self.send_uevent("add");
    }

    /// Makes the adapter's node lead to `device` without telling anybody.
    pub fn lead_to(&self, device: &Path) {
        let node = self.root.join("dev/ttyUSB0");
        let _ = fs::remove_file(&node);
        symlink(device, &node).expect("umockdev's folder is writable");
        let name = device.to_string_lossy().replace('/', "_");
        let mapped = self.root.join("dev/.ptymap").join(name);
        let _ = fs::remove_file(&mapped);
        symlink(&self.number, mapped).expect("umockdev's folder is writable");
    }

    /// Another program holds the port, or lets it go: the system refuses to give it to the browser.
    pub fn set_busy(&self, busy: bool) {
        self.port.is_busy.store(busy, Ordering::Relaxed);
    }

    /// The size of a character that the browser asked the system for last, before the pty made eight bits of it.
    pub fn data_bits(&self) -> Option<DataBits> {
        match self.port.control.load(Ordering::Relaxed) & libc::CSIZE {
            libc::CS7 => Some(DataBits::Seven),
            libc::CS8 => Some(DataBits::Eight),
            _ => None,
        }
    }

    /// Pulls the adapter out.
    pub fn unplug(&self) {
        let _ = fs::remove_file(self.root.join("dev/ttyUSB0"));
        self.send_uevent("remove");
    }

    /// Tells everybody who listens to udev. umockdev gives each listener a socket `event<N>`.
    fn send_uevent(&self, action: &str) {
        let message = uevent(action, self.usb);
        let socket = UnixDatagram::unbound().expect("a socket");
        for entry in fs::read_dir(&self.root).into_iter().flatten().flatten() {
            if entry.file_name().to_string_lossy().starts_with("event") {
                // A listener that is gone has left its socket behind.
                let _ = socket.send_to(&message, entry.path());
            }
        }
    }
}

impl Drop for Adapter {
    fn drop(&mut self) {
        if let Ok(group) = i32::try_from(self.process.id()) {
            let _ = killpg(Pid::from_raw(group), Signal::SIGKILL);
        }
        let _ = self.process.wait();
        let _ = fs::remove_dir_all(&self.root);
    }
}

/// Bytes of the header of udev's messages.
const HEADER_LEN: u32 = 40;

/// A message as udev's daemon sends it to libudev's monitors: a header of eight fields, then the properties.
fn uevent(action: &str, usb: UsbId) -> Vec<u8> {
    let properties = [
        format!("ACTION={action}"),
        format!("DEVPATH={DEVPATH}"),
        "SUBSYSTEM=tty".into(),
        "SEQNUM=1".into(),
        "DEVNAME=/dev/ttyUSB0".into(),
        "MAJOR=4".into(),
        "MINOR=64".into(),
        "ID_BUS=usb".into(),
        format!("ID_VENDOR_ID={:04x}", usb.0),
        format!("ID_MODEL_ID={:04x}", usb.1),
        "ID_MODEL_ENC=USB\\x20Serial".into(),
        "ID_SERIAL_SHORT=SIM0001".into(),
    ];
    let properties: Vec<u8> = properties.iter().flat_map(|property| [property.as_bytes(), b"\0"].concat()).collect();
    let properties_len = u32::try_from(properties.len()).expect("a short list");
    let mut message = b"libudev\0".to_vec();
    message.extend(0xfeed_cafe_u32.to_be_bytes());
    for field in [HEADER_LEN, HEADER_LEN, properties_len] {
        message.extend(field.to_ne_bytes());
    }
    message.extend(subsystem_hash(b"tty").to_be_bytes());
    // Neither a device type nor tags.
    message.extend([0; 12]);
    message.extend(properties);
    message
}

/// `MurmurHash2` with its own length as the seed: libudev filters by it.
fn subsystem_hash(text: &[u8]) -> u32 {
    const MIX: u32 = 0x5bd1_e995;
    let mut hash = u32::try_from(text.len()).expect("a short name");
    let chunks = text.chunks_exact(4);
    let rest = chunks.remainder();
    for chunk in chunks {
        let mut word = u32::from_ne_bytes([chunk[0], chunk[1], chunk[2], chunk[3]]).wrapping_mul(MIX);
        word ^= word >> 24;
        hash = hash.wrapping_mul(MIX) ^ word.wrapping_mul(MIX);
    }
    if !rest.is_empty() {
        for (place, byte) in rest.iter().enumerate() {
            hash ^= u32::from(*byte) << (8 * place);
        }
        hash = hash.wrapping_mul(MIX);
    }
    hash ^= hash >> 13;
    hash = hash.wrapping_mul(MIX);
    hash ^ (hash >> 15)
}

/// umockdev asks a socket what to do about each ioctl on the device. The answer is to do it on the real pty, unless the
/// port is busy.
fn answer_ioctls(socket: &Path, port: &Arc<Port>) {
    let folder = socket.parent().expect("a socket in a folder");
    fs::create_dir_all(folder).expect("umockdev's folder is writable");
    let _ = fs::remove_file(socket);
    let listener = UnixListener::bind(socket).expect("umockdev's folder is writable");
    let port = Arc::clone(port);
    // Both threads end when the process at the other end does, or with the test.
    thread::spawn(move || {
        for stream in listener.incoming().map_while(Result::ok) {
            let port = Arc::clone(&port);
            // An error is the end of the process at the other end.
            thread::spawn(move || answer_ioctls_of(stream, &port).ok());
        }
    });
}

/// Requests and answers are three native u64: kind and two arguments.
fn answer_ioctls_of(mut stream: UnixStream, port: &Port) -> io::Result<()> {
    const RESULT: u64 = 2;
    const DONE: u64 = 3;
    const RUN: u64 = 4;
    const READ_MEMORY: u64 = 5;
    const MINUS_ONE: u64 = u64::MAX;
    const EBUSY: u64 = 16;
    loop {
        let mut request = [0; 24];
        stream.read_exact(&mut request)?;
        let word = |place: usize| {
            let bytes = request[8 * place..8 * place + 8].try_into().expect("eight bytes");
            u64::from_ne_bytes(bytes)
        };
        let (kind, ioctl, argument) = (word(0), word(1), word(2));
        let is_settings = [libc::TCSETS, libc::TCSETSW, libc::TCSETSF, libc::TCSETS2, libc::TCSETSW2, libc::TCSETSF2]
            .contains(&ioctl);
        if kind != RESULT && is_settings {
            // The flags of input, output and control come first, each an u32.
            stream.write_all(&[READ_MEMORY, argument, 12].map(u64::to_ne_bytes).concat())?;
            let mut flags = [0; 12];
            stream.read_exact(&mut flags)?;
            let control = u32::from_ne_bytes(flags[8..].try_into().expect("four bytes"));
            port.control.store(control, Ordering::Relaxed);
        }
        let answer = match kind {
            RESULT => [DONE, ioctl, argument],
            _ if port.is_busy.load(Ordering::Relaxed) => [DONE, MINUS_ONE, EBUSY],
            _ => [RUN, 0, 0],
        };
        stream.write_all(&answer.map(u64::to_ne_bytes).concat())?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_uevent_has_its_properties_where_its_header_says() {
        let message = uevent("add", CH340);
        let field = |at: usize| u32::from_ne_bytes(message[at..at + 4].try_into().unwrap());
        let (from, len) = (field(16) as usize, field(20) as usize);
        assert_eq!(field(12) as usize, from);
        assert_eq!(from + len, message.len());
        assert!(message[from..].starts_with(b"ACTION=add\0DEVPATH=/devices/"));
    }
}
