//! Where journals, the audit log, counts of writes and snapshots outlive the page: a database of the browser's, and a lock
//! for each journal that somebody works on. Orders are carried out one after the other.

mod database;
mod locks;

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::rc::Rc;

use buslens_analyst::configure::{AuditRow, DeviceKey, FromStore, Hindrance, StoreFault, ToStore};
use buslens_configure::{Journal, Snapshot};
use serde::Serialize;
use serde::de::DeserializeOwned;
use wasm_bindgen_futures::spawn_local;

use database::{AUDIT, COUNTS, Database, JOURNALS, Key, SNAPSHOTS};
use locks::{Lock, News};

/// The keeper.
pub(crate) struct Store {
    orders: RefCell<VecDeque<ToStore>>,
    working: Cell<bool>,
    database: RefCell<Option<Rc<Database>>>,
    held: RefCell<Vec<(u64, Lock)>>,
    /// Journals of simulated devices, which end with the page.
    simulated: RefCell<Vec<Journal>>,
    news: News,
    /// Journals that another page holds: their end is waited for.
    awaited: RefCell<Vec<u64>>,
    /// What is told again when another page has changed it: journals and counts, the audit log, snapshots.
    watched: Cell<[bool; 3]>,
    answer: Box<dyn Fn(FromStore)>,
}

impl Store {
    /// `answer` is called with what has come of the orders.
    pub(crate) fn new(answer: impl Fn(FromStore) + 'static) -> Rc<Self> {
        let store = Rc::new(Self {
            orders: RefCell::default(),
            working: Cell::new(false),
            database: RefCell::new(None),
            held: RefCell::default(),
            simulated: RefCell::default(),
            news: News::new(),
            awaited: RefCell::default(),
            watched: Cell::default(),
            answer: Box::new(answer),
        });
        let weak = Rc::downgrade(&store);
        // Another page of this browser has changed something.
        store.news.listen(move || {
            if let Some(store) = weak.upgrade() {
                store.look_again();
            }
        });
        store
    }

    /// Carries out an order, after those before it.
    pub(crate) fn order(self: &Rc<Self>, order: ToStore) {
        self.orders.borrow_mut().push_back(order);
        if self.working.replace(true) {
            return;
        }
        let store = Rc::clone(self);
        spawn_local(async move {
            loop {
                let Some(order) = store.orders.borrow_mut().pop_front() else { break };
                if let Err(fault) = store.carry_out(order).await {
                    (store.answer)(FromStore::Failed(fault));
                }
            }
            store.working.set(false);
        });
    }

    fn look_again(self: &Rc<Self>) {
        let orders = [ToStore::Watch, ToStore::Audit, ToStore::Snapshots];
        for (order, watched) in orders.into_iter().zip(self.watched.get()) {
            if watched {
                self.order(order);
            }
        }
    }

    fn watch(&self, place: usize) {
        let mut watched = self.watched.get();
        watched.iter_mut().skip(place).take(1).for_each(|watched| *watched = true);
        self.watched.set(watched);
    }

    /// A journal is answered for by itself; anything else that fails comes back.
    async fn carry_out(self: &Rc<Self>, order: ToStore) -> Result<(), StoreFault> {
        match order {
            ToStore::Watch => {
                self.watch(0);
                self.tell_journals().await?;
                self.tell_counts().await?;
            }
            ToStore::Keep { journal, simulated } => {
                let id = journal.id;
                let kept = if simulated {
                    self.keep_simulated(*journal);
                    Ok(())
                } else {
                    self.keep(&journal).await
                };
                (self.answer)(FromStore::Kept(id, kept));
            }
            ToStore::Take(id) => {
                let taken = self.take(id).await;
                (self.answer)(FromStore::Taken(id, taken));
                self.tell_journals().await?;
            }
            ToStore::Forget(id) => self.forget(id).await?,
            ToStore::Discard(id) => {
                let is_held = self.is_held(id);
                if let Some(lock) = Lock::try_hold(id).await.filter(|_| !is_held) {
                    self.held.borrow_mut().push((id, lock));
                    self.forget(id).await?;
                }
            }
            ToStore::Release => {
                if !std::mem::take(&mut *self.held.borrow_mut()).is_empty() {
                    self.changed().await?;
                }
            }
            ToStore::Append(row) => {
                self.database().await?.put(AUDIT, None, &text(&*row)).await?;
                self.news.tell();
            }
            ToStore::Audit => {
                self.watch(1);
                let rows = self.all::<AuditRow>(AUDIT).await?.into_iter().map(|(_, row)| row).collect();
                (self.answer)(FromStore::Audit(rows));
            }
            ToStore::ClearAudit => {
                self.database().await?.clear(AUDIT).await?;
                self.news.tell();
            }
            ToStore::Count(counts) => {
                for (key, more) in counts {
                    let name = Key::Text(text(&key));
                    self.database()
                        .await?
                        .change(COUNTS, &name, move |before| count(before).saturating_add(more))
                        .await?;
                }
                self.tell_counts().await?;
            }
            ToStore::Move(before, after) => {
                let database = self.database().await?;
                let name = Key::Text(text(&before));
                let moved = count(database.get(COUNTS, &name).await?.as_deref());
                database.change(COUNTS, &Key::Text(text(&after)), move |known| count(known).max(moved)).await?;
                database.delete(COUNTS, &name).await?;
                self.tell_counts().await?;
            }
            ToStore::Snapshots => {
                self.watch(2);
                self.tell_snapshots().await?;
            }
            ToStore::KeepSnapshot(number, snapshot) => {
                self.database().await?.put(SNAPSHOTS, Some(&Key::Number(number)), &text(&*snapshot)).await?;
                self.tell_snapshots().await?;
                self.news.tell();
            }
            ToStore::ForgetSnapshot(number) => {
                self.database().await?.delete(SNAPSHOTS, &Key::Number(number)).await?;
                self.tell_snapshots().await?;
                self.news.tell();
            }
        }
        Ok(())
    }

    async fn keep(&self, journal: &Journal) -> Result<(), StoreFault> {
        if !self.is_held(journal.id) {
            // Nobody else knows of a new journal. Where the browser has no locks, there is one page only to be hoped for.
            let lock = Lock::try_hold(journal.id).await.unwrap_or_default();
            self.held.borrow_mut().push((journal.id, lock));
        }
        let database = self.database().await?;
        database.put(JOURNALS, Some(&Key::Number(journal.id)), &journal.to_json()).await
    }

    fn keep_simulated(&self, journal: Journal) {
        if !self.is_held(journal.id) {
            self.held.borrow_mut().push((journal.id, Lock::default()));
        }
        let mut all = self.simulated.borrow_mut();
        match all.iter_mut().find(|known| known.id == journal.id) {
            Some(known) => *known = journal,
            None => all.push(journal),
        }
    }

    fn is_held(&self, id: u64) -> bool {
        self.held.borrow().iter().any(|(held, _)| *held == id)
    }

    async fn forget(self: &Rc<Self>, id: u64) -> Result<(), StoreFault> {
        let known = self.simulated.borrow().len();
        self.simulated.borrow_mut().retain(|journal| journal.id != id);
        let is_simulated = self.simulated.borrow().len() < known;
        let gone = if is_simulated { Ok(()) } else { self.database().await?.delete(JOURNALS, &Key::Number(id)).await };
        self.held.borrow_mut().retain(|(held, _)| *held != id);
        gone?;
        self.changed().await
    }

    async fn take(&self, id: u64) -> Result<Box<Journal>, Hindrance> {
        let simulated = self.simulated.borrow().iter().find(|journal| journal.id == id).cloned();
        if let Some(journal) = simulated {
            self.held.borrow_mut().push((id, Lock::default()));
            return Ok(Box::new(journal));
        }
        let lock = Lock::try_hold(id).await.ok_or(Hindrance::JournalHeld)?;
        let database = self.database().await.map_err(Hindrance::Store)?;
        let kept = database.get(JOURNALS, &Key::Number(id)).await.map_err(Hindrance::Store)?;
        let journal = kept.and_then(|text| Journal::from_json(&text)).ok_or(Hindrance::JournalGone)?;
        self.held.borrow_mut().push((id, lock));
        Ok(Box::new(journal))
    }

    /// Journals have changed: both this page and the others look again.
    async fn changed(self: &Rc<Self>) -> Result<(), StoreFault> {
        self.news.tell();
        self.tell_journals().await
    }

    async fn tell_journals(self: &Rc<Self>) -> Result<(), StoreFault> {
        // Where there is no database, there are those of simulated devices.
        let all = match self.database().await {
            Ok(database) => database.all(JOURNALS).await?,
            Err(fault) => {
                (self.answer)(FromStore::Failed(fault));
                Vec::new()
            }
        };
        let held = locks::held().await;
        let mut open = self.simulated.borrow().clone();
        open.retain(|journal| !self.is_held(journal.id));
        for (_, text) in all {
            let Some(journal) = Journal::from_json(&text) else { continue };
            if self.is_held(journal.id) {
                continue;
            }
            if held.contains(&journal.id) {
                self.wait_for(journal.id);
            } else {
                open.push(journal);
            }
        }
        open.sort_by_key(|journal| journal.id);
        (self.answer)(FromStore::Journals(open));
        Ok(())
    }

    /// Looks again when whoever holds a journal has let it go: its page may be closed without a word.
    fn wait_for(self: &Rc<Self>, journal: u64) {
        if self.awaited.borrow().contains(&journal) {
            return;
        }
        self.awaited.borrow_mut().push(journal);
        let weak = Rc::downgrade(self);
        locks::when_free(journal, move || {
            if let Some(store) = weak.upgrade() {
                store.awaited.borrow_mut().retain(|awaited| *awaited != journal);
                store.order(ToStore::Watch);
            }
        });
    }

    async fn tell_counts(&self) -> Result<(), StoreFault> {
        let counts = self.database().await?.all(COUNTS).await?;
        let read = |(key, value): (Key, String)| {
            let Key::Text(key) = key else { return None };
            Some((serde_json::from_str::<DeviceKey>(&key).ok()?, count(Some(&value))))
        };
        (self.answer)(FromStore::Counts(counts.into_iter().filter_map(read).collect()));
        Ok(())
    }

    async fn tell_snapshots(&self) -> Result<(), StoreFault> {
        let all = self.all::<Snapshot>(SNAPSHOTS).await?;
        let numbered = all.into_iter().filter_map(|(key, snapshot)| match key {
            Key::Number(number) => Some((number, snapshot)),
            Key::Text(_) => None,
        });
        (self.answer)(FromStore::Snapshots(numbered.collect()));
        Ok(())
    }

    /// All that a table holds and this version can read.
    async fn all<T: DeserializeOwned>(&self, table: &str) -> Result<Vec<(Key, T)>, StoreFault> {
        let all = self.database().await?.all(table).await?;
        Ok(all.into_iter().filter_map(|(key, text)| Some((key, serde_json::from_str(&text).ok()?))).collect())
    }

    /// The database, opened if it is not. One that could not be opened is tried again with the next order.
    async fn database(&self) -> Result<Rc<Database>, StoreFault> {
        let open = self.database.borrow().clone();
        if let Some(open) = open.filter(|open| open.is_open()) {
            return Ok(open);
        }
        let opened = Rc::new(Database::open().await?);
        *self.database.borrow_mut() = Some(Rc::clone(&opened));
        Ok(opened)
    }
}

fn text(value: &impl Serialize) -> String {
    // Nothing that is kept is without a form in JSON.
    serde_json::to_string(value).unwrap_or_default()
}

fn count(kept: Option<&str>) -> u64 {
    kept.and_then(|text| text.parse().ok()).unwrap_or(0)
}
