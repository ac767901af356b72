//! The parts of a bench: an adapter, the wire behind it, what answers on the wire, and a browser.

mod adapter;
mod browser;
mod chatter;
mod developer;
mod independent;
mod memory;
mod pty;
mod struck;
mod wire;

pub use adapter::{Adapter, CH340};
pub use browser::{Browser, Look};
pub use chatter::Chatter;
pub use developer::Withheld;
pub use independent::{Registers, Relay};
pub use memory::Held;
pub use pty::Pty;
pub use struck::{Strike, Struck};
pub use wire::{FarEnd, Wire};

/// Address of the built page, as served by `cargo xtask test`.
pub fn site() -> String {
    std::env::var("BUSLENS_SITE").expect("the browser tests need the built page: run `cargo xtask test --only browser`")
}

/// A browser with an adapter and a wire that is plugged in.
pub struct Bench<F: FarEnd> {
    /// What the page is seen with.
    pub browser: Browser,
    /// The line behind the adapter; `None` while it is unplugged.
    pub wire: Option<Wire<F>>,
    /// The adapter.
    pub adapter: Adapter,
}

impl<F: FarEnd> Bench<F> {
    /// Starts everything and opens the page.
    pub async fn new(far_end: F) -> Self {
        Self::with_wire(Wire::new(far_end)).await
    }

    /// The same with a wire that exists already.
    pub async fn with_wire(wire: Wire<F>) -> Self {
        Self::at(&site(), wire, Look::default()).await
    }

    /// The same for a site at an address, looked at in a certain way.
    pub async fn at(site: &str, wire: Wire<F>, look: Look) -> Self {
        let adapter = Adapter::start(CH340);
        adapter.plug(wire.device());
        let browser = Browser::start(&adapter, look).await;
        browser.open(site).await;
        Self { browser, wire: Some(wire), adapter }
    }

    /// The wire.
    pub fn wire(&self) -> &Wire<F> {
        self.wire.as_ref().expect("the adapter is plugged in")
    }

    /// Pulls the adapter out.
    pub fn unplug(&mut self) -> F {
        let far_end = self.wire.take().expect("the adapter is plugged in").take_apart();
        self.adapter.unplug();
        far_end
    }

    /// Puts a new pty behind the adapter's node without telling anybody.
    pub fn plug_silently(&mut self, far_end: F) {
        let wire = Wire::new(far_end);
        self.adapter.lead_to(wire.device());
        self.wire = Some(wire);
    }

    /// Plugs the adapter in again, with something at its other end.
    pub fn plug(&mut self, far_end: F) {
        let wire = Wire::new(far_end);
        self.adapter.plug(wire.device());
        self.wire = Some(wire);
    }
}
