//! Real time for a sans-io line: a thread that carries bytes between the pty and what answers at its far end.

use std::io::{ErrorKind, Read, Write};
use std::os::fd::AsFd;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, LazyLock, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant as Clock};

use buslens_bus::sim::{Device, Line};
use buslens_bus::time::Instant;
use buslens_codec::line::LineSettings;
use nix::errno::Errno;
use nix::fcntl::{FcntlArg, OFlag, fcntl};
use nix::poll::{PollFd, PollFlags, ppoll};
use nix::sys::time::TimeSpec;

use super::pty::Pty;

/// Time until a pty that was full is tried again.
const LOOK_AGAIN: Duration = Duration::from_millis(5);

/// What is at the other end of the wire; sans-io like everything below the page.
pub trait FarEnd: Send + 'static {
    /// The browser's port is now set to `settings`.
    fn handle_settings(&mut self, now: Instant, settings: LineSettings);
    /// The browser hands over bytes.
    fn handle_bytes(&mut self, now: Instant, bytes: &[u8]);
    /// Time has passed.
    fn handle_timeout(&mut self, now: Instant);
    /// When time matters next.
    fn poll_timeout(&self) -> Option<Instant>;
    /// Bytes that reach the browser now. Not asked for while the browser has not taken what came before.
    fn poll_transmit(&mut self) -> Option<Vec<u8>>;
}

impl<D: Device + 'static> FarEnd for Line<D> {
    fn handle_settings(&mut self, now: Instant, settings: LineSettings) {
        Line::handle_settings(self, now, settings);
    }

    fn handle_bytes(&mut self, now: Instant, bytes: &[u8]) {
        Line::handle_bytes(self, now, bytes);
    }

    fn handle_timeout(&mut self, now: Instant) {
        Line::handle_timeout(self, now);
    }

    fn poll_timeout(&self) -> Option<Instant> {
        Line::poll_timeout(self)
    }

    fn poll_transmit(&mut self) -> Option<Vec<u8>> {
        Line::poll_transmit(self)
    }
}

/// A pty with a far end, alive until it is taken apart.
pub struct Wire<F: FarEnd> {
    shared: Arc<Shared<F>>,
    device: PathBuf,
    waker: UnixStream,
    thread: Option<JoinHandle<()>>,
}

struct Shared<F> {
    state: Mutex<State<F>>,
    changed: Condvar,
}

struct State<F> {
    far_end: Option<F>,
    stopping: bool,
    settings: Option<LineSettings>,
    /// Everything that the browser sent.
    sent: Vec<u8>,
    /// Bytes to reach the browser out of nowhere.
    injected: Vec<u8>,
    /// Bytes that the browser has had no room for yet.
    unsent: Vec<u8>,
    /// Everything that has reached the browser, from when it was asked for.
    delivered: Option<Vec<u8>>,
}

impl<F> Shared<F> {
    fn lock(&self) -> MutexGuard<'_, State<F>> {
        // A test that has failed with the lock held shall say its own words.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The time on every wire: what answers on one goes on on another.
fn clock() -> Instant {
    static ORIGIN: LazyLock<Clock> = LazyLock::new(Clock::now);
    Instant::ZERO + ORIGIN.elapsed()
}

impl<F: FarEnd> Wire<F> {
    /// A new wire.
    pub fn new(far_end: F) -> Self {
        let pty = Pty::open();
        // Who talks faster than the browser listens waits; the wire itself never does.
        fcntl(&pty.master, FcntlArg::F_SETFL(OFlag::O_NONBLOCK)).expect("a descriptor takes flags");
        let device = pty.device().to_owned();
        let state = State {
            far_end: Some(far_end),
            stopping: false,
            settings: None,
            sent: Vec::new(),
            injected: Vec::new(),
            unsent: Vec::new(),
            delivered: None,
        };
        let shared = Arc::new(Shared { state: Mutex::new(state), changed: Condvar::new() });
        let (waker, bell) = UnixStream::pair().expect("a socket pair");
        waker.set_nonblocking(true).expect("a socket");
        bell.set_nonblocking(true).expect("a socket");
        let thread = thread::spawn({
            let shared = Arc::clone(&shared);
            move || carry(&pty, &bell, &shared)
        });
        Self { shared, device, waker, thread: Some(thread) }
    }

    /// The path that the adapter's node leads to.
    pub fn device(&self) -> &Path {
        &self.device
    }

    /// Does something to the far end, such as switching a fault on.
    pub fn with<T>(&self, act: impl FnOnce(&mut F, Instant) -> T) -> T {
        let result = {
            let mut state = self.shared.lock();
            act(state.far_end.as_mut().expect("a whole wire has a far end"), clock())
        };
        self.wake();
        result
    }

    /// Bytes that come to the browser out of nowhere.
    pub fn inject(&self, bytes: &[u8]) {
        self.shared.lock().injected.extend_from_slice(bytes);
        self.wake();
    }

    /// Wakes the wire's thread: something outside has changed.
    pub(super) fn waker(&self) -> UnixStream {
        self.waker.try_clone().expect("a socket")
    }

    /// The settings that the browser asked for last.
    pub fn settings(&self) -> Option<LineSettings> {
        self.shared.lock().settings
    }

    /// Waits until the browser has asked for these settings.
    pub fn wait_for_settings(&self, wanted: LineSettings, limit: Duration) {
        let give_up = Clock::now() + limit;
        // Nothing tells of a change of a pty's settings: look whenever a moment has passed.
        while self.settings() != Some(wanted) {
            assert!(Clock::now() < give_up, "the browser asked for {:?}, not {wanted}", self.settings());
            self.wake();
            let state = self.shared.lock();
            drop(self.shared.changed.wait_timeout(state, Duration::from_millis(5)));
        }
    }

    /// Everything that the browser has sent.
    pub fn sent(&self) -> Vec<u8> {
        self.shared.lock().sent.clone()
    }

    /// From now on keeps what reaches the browser.
    pub fn keep_delivered(&self) {
        self.shared.lock().delivered = Some(Vec::new());
    }

    /// Everything that has reached the browser since [`Self::keep_delivered`].
    pub fn delivered(&self) -> Vec<u8> {
        self.shared.lock().delivered.clone().unwrap_or_default()
    }

    /// Waits until what the browser has sent since byte `from` fulfils `wanted`.
    pub fn wait_for_sent(&self, from: usize, limit: Duration, wanted: impl Fn(&[u8]) -> bool) {
        let locked = self.shared.lock();
        let end = self.shared.changed.wait_timeout_while(locked, limit, |state| !wanted(&state.sent[from..]));
        let (state, wait) = end.unwrap_or_else(PoisonError::into_inner);
        assert!(!wait.timed_out(), "the browser sent only {:02X?}", &state.sent[from..]);
    }

    /// Waits until something has come of what the browser has sent.
    pub fn wait_until(&self, limit: Duration, wanted: impl Fn(&F) -> bool) {
        let locked = self.shared.lock();
        let is_so = |state: &mut State<F>| state.far_end.as_ref().is_some_and(&wanted);
        let end = self.shared.changed.wait_timeout_while(locked, limit, |state| !is_so(state));
        let (state, wait) = end.unwrap_or_else(PoisonError::into_inner);
        assert!(!wait.timed_out(), "the browser has not brought it about; it sent {:02X?}", state.sent);
    }

    /// Cuts the wire: the browser's port is gone. Gives the far end back.
    pub fn take_apart(mut self) -> F {
        self.stop();
        self.shared.lock().far_end.take().expect("a whole wire has a far end")
    }

    fn stop(&mut self) {
        self.shared.lock().stopping = true;
        self.wake();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }

    fn wake(&self) {
        // A full pipe wakes as well.
        let _ = (&self.waker).write(&[0]);
    }
}

impl<F: FarEnd> Drop for Wire<F> {
    fn drop(&mut self) {
        self.stop();
    }
}

/// Runs until the wire stops. The pty closes with it; no other thread reads it.
fn carry<F: FarEnd>(pty: &Pty, bell: &UnixStream, shared: &Shared<F>) {
    let mut buffer = [0; 4096];
    loop {
        let due = {
            let mut state = shared.lock();
            if state.stopping {
                return;
            }
            let now = clock();
            advance(&mut state, pty, now);
            let due = state.far_end.as_ref().and_then(FarEnd::poll_timeout);
            let due = due.map(|due| due.saturating_since(clock()));
            // A pty does not tell when there is room again.
            let look_again = (!state.unsent.is_empty()).then_some(LOOK_AGAIN);
            due.into_iter().chain(look_again).min()
        };
        let mut ready =
            [PollFd::new(pty.master.as_fd(), PollFlags::POLLIN), PollFd::new(bell.as_fd(), PollFlags::POLLIN)];
        match ppoll(&mut ready, due.map(TimeSpec::from_duration), None) {
            Ok(_) | Err(Errno::EINTR) => {}
            Err(_) => return,
        }
        let readable = |fd: &PollFd<'_>| fd.revents().is_some_and(|events| events.contains(PollFlags::POLLIN));
        let (bytes_came, was_woken) = (readable(&ready[0]), readable(&ready[1]));
        if was_woken {
            while matches!((&*bell).read(&mut buffer), Ok(count) if count > 0) {}
        }
        if bytes_came {
            let Ok(count) = (&pty.master).read(&mut buffer) else { continue };
            let mut state = shared.lock();
            let now = clock();
            notice_settings(&mut state, pty, now);
            state.sent.extend_from_slice(&buffer[..count]);
            if let Some(far_end) = &mut state.far_end {
                far_end.handle_bytes(now, &buffer[..count]);
            }
            shared.changed.notify_all();
        }
    }
}

fn advance<F: FarEnd>(state: &mut State<F>, pty: &Pty, now: Instant) {
    notice_settings(state, pty, now);
    state.unsent.append(&mut state.injected);
    if let Some(far_end) = &mut state.far_end {
        far_end.handle_timeout(now);
        if state.unsent.is_empty() {
            state.unsent.extend(std::iter::from_fn(|| far_end.poll_transmit()).flatten());
        }
    }
    if !state.unsent.is_empty() {
        match (&pty.master).write(&state.unsent) {
            Ok(count) => {
                let written = state.unsent.drain(..count);
                if let Some(delivered) = &mut state.delivered {
                    delivered.extend(written);
                }
            }
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {}
            // With nobody at the other end the bytes are lost, as on a line.
            Err(_) => state.unsent.clear(),
        }
    }
}

fn notice_settings<F: FarEnd>(state: &mut State<F>, pty: &Pty, now: Instant) {
    let settings = pty.settings();
    if settings != state.settings {
        state.settings = settings;
        if let (Some(far_end), Some(settings)) = (&mut state.far_end, settings) {
            far_end.handle_settings(now, settings);
        }
    }
}
