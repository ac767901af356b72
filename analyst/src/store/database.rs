//! The browser's own database (Indexed Database API 3.0), as tables of texts.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use buslens_analyst::configure::StoreFault;
use js_sys::{Array, Function, Object, Promise};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;

use crate::scope::options;

/// Journals by their ids.
pub(super) const JOURNALS: &str = "journals";
/// The audit log; numbers come by themselves.
pub(super) const AUDIT: &str = "audit";
/// Counts of writes by what names a device.
pub(super) const COUNTS: &str = "counts";
/// Snapshots by their numbers.
pub(super) const SNAPSHOTS: &str = "snapshots";

/// Its name among all that the browser keeps for this page.
const NAME: &str = "buslens";
/// Of its tables.
const VERSION: f64 = 1.0;

/// What names a text in a table.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Key {
    Number(u64),
    Text(String),
}

/// An open database.
pub(super) struct Database {
    handle: Handle,
    /// The browser, or another page that needs another version, has closed it.
    closed: Rc<Cell<bool>>,
    _on_close: Closure<dyn Fn()>,
}

impl Database {
    /// Opens it; makes its tables at the first time.
    pub(super) async fn open() -> Result<Self, StoreFault> {
        let factory = scope().factory().ok_or(StoreFault::Unavailable)?;
        let request = factory.open(NAME, VERSION).map_err(|_| StoreFault::Unavailable)?;
        let opening = request.clone();
        let make_tables = Closure::<dyn Fn()>::new(move || {
            let handle: Handle = opening.result().unchecked_into();
            for table in [JOURNALS, COUNTS, SNAPSHOTS] {
                // A database of this version has none of them yet.
                let _ = handle.create_object_store(table, &Object::new());
            }
            let _ = handle.create_object_store(AUDIT, &options("autoIncrement", &true.into()));
        });
        request.set_onupgradeneeded(make_tables.as_ref().unchecked_ref());
        let opened = finish(|done, failed| {
            request.set_onsuccess(done);
            request.set_onerror(failed);
            // Only an older version in another page could block, and there is none.
            request.set_onblocked(failed);
        });
        opened.await.map_err(|()| fault_of(request.error(), StoreFault::Unavailable))?;
        let handle: Handle = request.result().unchecked_into();
        let closed = Rc::new(Cell::new(false));
        let (seen, closing) = (Rc::clone(&closed), handle.clone());
        let on_close = Closure::<dyn Fn()>::new(move || {
            seen.set(true);
            closing.close();
        });
        handle.set_onclose(on_close.as_ref().unchecked_ref());
        handle.set_onversionchange(on_close.as_ref().unchecked_ref());
        Ok(Self { handle, closed, _on_close: on_close })
    }

    pub(super) fn is_open(&self) -> bool {
        !self.closed.get()
    }

    /// Puts a text under a key, or under the next number. Done when it is on the disk.
    pub(super) async fn put(&self, table: &str, key: Option<&Key>, text: &str) -> Result<(), StoreFault> {
        let change = self.begin(table, true)?;
        let put = match key {
            Some(key) => change.table(table)?.put(&text.into(), &key.js()),
            None => change.table(table)?.add(&text.into()),
        };
        put.map_err(|error| words(&error))?;
        change.complete().await
    }

    pub(super) async fn delete(&self, table: &str, key: &Key) -> Result<(), StoreFault> {
        let change = self.begin(table, true)?;
        change.table(table)?.delete(&key.js()).map_err(|error| words(&error))?;
        change.complete().await
    }

    pub(super) async fn clear(&self, table: &str) -> Result<(), StoreFault> {
        let change = self.begin(table, true)?;
        change.table(table)?.clear().map_err(|error| words(&error))?;
        change.complete().await
    }

    pub(super) async fn get(&self, table: &str, key: &Key) -> Result<Option<String>, StoreFault> {
        let look = self.begin(table, false)?;
        let request = look.table(table)?.get(&key.js()).map_err(|error| words(&error))?;
        look.complete().await?;
        Ok(request.result().as_string())
    }

    /// All texts with their keys, in the order of the keys.
    pub(super) async fn all(&self, table: &str) -> Result<Vec<(Key, String)>, StoreFault> {
        let look = self.begin(table, false)?;
        let table = look.table(table)?;
        let keys = table.get_all_keys().map_err(|error| words(&error))?;
        let texts = table.get_all().map_err(|error| words(&error))?;
        look.complete().await?;
        let (keys, texts): (Array, Array) = (keys.result().unchecked_into(), texts.result().unchecked_into());
        Ok(keys.iter().zip(texts.iter()).filter_map(|(key, text)| Some((Key::of(&key)?, text.as_string()?))).collect())
    }

    /// Changes a number, so that no other page changes it in between.
    pub(super) async fn change(
        &self,
        table: &str,
        key: &Key,
        next: impl FnOnce(Option<&str>) -> u64 + 'static,
    ) -> Result<(), StoreFault> {
        let change = self.begin(table, true)?;
        let table = change.table(table)?;
        let request = table.get(&key.js()).map_err(|error| words(&error))?;
        let (read, key) = (request.clone(), key.js());
        let put = Closure::once(move || {
            let next = next(read.result().as_string().as_deref());
            // What cannot be put fails with its transaction.
            let _ = table.put(&next.to_string().into(), &key);
        });
        request.set_onsuccess(put.as_ref().unchecked_ref());
        change.complete().await
    }

    fn begin(&self, table: &str, writes: bool) -> Result<Transaction, StoreFault> {
        let mode = if writes { "readwrite" } else { "readonly" };
        // Told only when the system says that it is on the disk.
        let options = options("durability", &"strict".into());
        self.handle.transaction(table, mode, &options).map_err(|error| {
            self.closed.set(true);
            words(&error)
        })
    }
}

impl Transaction {
    fn table(&self, name: &str) -> Result<Table, StoreFault> {
        self.object_store(name).map_err(|error| words(&error))
    }

    /// Waits for its end.
    async fn complete(&self) -> Result<(), StoreFault> {
        let ended = finish(|done, failed| {
            self.set_oncomplete(done);
            self.set_onabort(failed);
        });
        ended.await.map_err(|()| fault_of(self.error(), StoreFault::Other("aborted".to_owned())))
    }
}

impl Key {
    fn js(&self) -> JsValue {
        match self {
            // Microseconds of this age, and counts: below 2^53.
            #[allow(clippy::cast_precision_loss)]
            Self::Number(number) => JsValue::from_f64(*number as f64),
            Self::Text(text) => text.into(),
        }
    }

    fn of(key: &JsValue) -> Option<Self> {
        // As above.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let number = key.as_f64().map(|number| Self::Number(number as u64));
        number.or_else(|| key.as_string().map(Self::Text))
    }
}

/// Waits until one of two functions is called, which `set` gives to whom it concerns.
async fn finish(set: impl FnOnce(&Function, &Function)) -> Result<(), ()> {
    let functions = RefCell::new(None);
    let ended = Promise::new(&mut |resolve, reject| *functions.borrow_mut() = Some((resolve, reject)));
    if let Some((resolve, reject)) = functions.into_inner() {
        set(&resolve, &reject);
    }
    JsFuture::from(ended).await.map(drop).map_err(drop)
}

/// What an error of the browser's means; `unknown` if there is none.
fn fault_of(error: Option<DomException>, unknown: StoreFault) -> StoreFault {
    match error {
        Some(error) if error.name() == "QuotaExceededError" => StoreFault::Full,
        Some(error) if ["SecurityError", "InvalidStateError"].contains(&error.name().as_str()) => {
            StoreFault::Unavailable
        }
        Some(error) => StoreFault::Other([error.name(), error.message()].join(": ")),
        None => unknown,
    }
}

fn words(error: &JsValue) -> StoreFault {
    // Whatever is thrown here is one.
    fault_of(Some(error.clone().unchecked_into()), StoreFault::Unavailable)
}

fn scope() -> Scope {
    js_sys::global().unchecked_into()
}

#[wasm_bindgen]
extern "C" {
    type Scope;
    #[wasm_bindgen(method, getter, js_name = indexedDB)]
    fn factory(this: &Scope) -> Option<Factory>;

    type Factory;
    #[wasm_bindgen(method, catch)]
    fn open(this: &Factory, name: &str, version: f64) -> Result<Request, JsValue>;

    #[derive(Clone)]
    type Request;
    #[wasm_bindgen(method, getter)]
    fn result(this: &Request) -> JsValue;
    #[wasm_bindgen(method, getter)]
    fn error(this: &Request) -> Option<DomException>;
    #[wasm_bindgen(method, setter)]
    fn set_onsuccess(this: &Request, listener: &Function);
    #[wasm_bindgen(method, setter)]
    fn set_onerror(this: &Request, listener: &Function);
    #[wasm_bindgen(method, setter)]
    fn set_onblocked(this: &Request, listener: &Function);
    #[wasm_bindgen(method, setter)]
    fn set_onupgradeneeded(this: &Request, listener: &Function);

    #[derive(Clone)]
    type Handle;
    #[wasm_bindgen(method, catch, js_name = createObjectStore)]
    fn create_object_store(this: &Handle, name: &str, options: &Object) -> Result<JsValue, JsValue>;
    #[wasm_bindgen(method, catch)]
    fn transaction(this: &Handle, tables: &str, mode: &str, options: &Object) -> Result<Transaction, JsValue>;
    #[wasm_bindgen(method)]
    fn close(this: &Handle);
    #[wasm_bindgen(method, setter)]
    fn set_onclose(this: &Handle, listener: &Function);
    #[wasm_bindgen(method, setter)]
    fn set_onversionchange(this: &Handle, listener: &Function);

    type Transaction;
    #[wasm_bindgen(method, catch, js_name = objectStore)]
    fn object_store(this: &Transaction, name: &str) -> Result<Table, JsValue>;
    #[wasm_bindgen(method, getter)]
    fn error(this: &Transaction) -> Option<DomException>;
    #[wasm_bindgen(method, setter)]
    fn set_oncomplete(this: &Transaction, listener: &Function);
    #[wasm_bindgen(method, setter)]
    fn set_onabort(this: &Transaction, listener: &Function);

    type Table;
    #[wasm_bindgen(method, catch)]
    fn put(this: &Table, value: &JsValue, key: &JsValue) -> Result<Request, JsValue>;
    #[wasm_bindgen(method, catch)]
    fn add(this: &Table, value: &JsValue) -> Result<Request, JsValue>;
    #[wasm_bindgen(method, catch)]
    fn delete(this: &Table, key: &JsValue) -> Result<Request, JsValue>;
    #[wasm_bindgen(method, catch)]
    fn clear(this: &Table) -> Result<Request, JsValue>;
    #[wasm_bindgen(method, catch)]
    fn get(this: &Table, key: &JsValue) -> Result<Request, JsValue>;
    #[wasm_bindgen(method, catch, js_name = getAll)]
    fn get_all(this: &Table) -> Result<Request, JsValue>;
    #[wasm_bindgen(method, catch, js_name = getAllKeys)]
    fn get_all_keys(this: &Table) -> Result<Request, JsValue>;

    #[wasm_bindgen(js_name = DOMException)]
    type DomException;
    #[wasm_bindgen(method, getter)]
    fn name(this: &DomException) -> String;
    #[wasm_bindgen(method, getter)]
    fn message(this: &DomException) -> String;
}
