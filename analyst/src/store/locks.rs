//! Who works on which journal, and that something has changed, among all pages of this browser: Web Locks, which the
//! browser takes back when a page ends however it ends, and a channel between the pages.

use std::cell::RefCell;
use std::rc::Rc;

use js_sys::{Array, Function, Object, Promise, Reflect};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;

use crate::scope::options;

const PREFIX: &str = "buslens-journal-";

/// A journal's lock, for as long as it lives. The default is none, where the browser has no locks.
#[derive(Default)]
pub(super) struct Lock {
    release: Option<Function>,
}

impl Lock {
    /// Holds a journal unless somebody else does.
    pub(super) async fn try_hold(journal: u64) -> Option<Self> {
        let Some(locks) = locks() else { return Some(Self::default()) };
        let release = Rc::new(RefCell::new(None));
        let keep = Rc::clone(&release);
        // Tells whether it was given, and keeps it until it is let go.
        let answered = Promise::new(&mut |answer, failed| {
            let keep = Rc::clone(&keep);
            let given = Closure::once_into_js(move |lock: JsValue| {
                let is_given = !lock.is_null();
                // Calling a promise's own function does not throw.
                let _ = answer.call1(&JsValue::UNDEFINED, &is_given.into());
                if !is_given {
                    return JsValue::UNDEFINED;
                }
                JsValue::from(Promise::new(&mut |resolve, _| *keep.borrow_mut() = Some(resolve)))
            });
            let request = locks.request(&name(journal), &options("ifAvailable", &true.into()), given.unchecked_ref());
            match request {
                // Refused as a whole: by a page that is going away.
                Ok(request) => drop(
                    request.catch(
                        &Closure::once_into_js(move |_: JsValue| {
                            let _ = failed.call0(&JsValue::UNDEFINED);
                        })
                        .unchecked_into(),
                    ),
                ),
                Err(_) => {
                    let _ = failed.call0(&JsValue::UNDEFINED);
                }
            }
        });
        let is_given = JsFuture::from(answered).await.ok()?.is_truthy();
        let release = release.borrow_mut().take();
        is_given.then_some(Self { release })
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        if let Some(release) = self.release.take() {
            // Resolving a promise does not throw.
            let _ = release.call0(&JsValue::UNDEFINED);
        }
    }
}

/// The journals that somebody holds, this page among them.
pub(super) async fn held() -> Vec<u64> {
    let Some(locks) = locks() else { return Vec::new() };
    let Ok(state) = JsFuture::from(locks.query()).await else { return Vec::new() };
    let Ok(held) = Reflect::get(&state, &"held".into()) else { return Vec::new() };
    let name = |lock: JsValue| Reflect::get(&lock, &"name".into()).ok()?.as_string();
    let id = |name: String| name.strip_prefix(PREFIX)?.parse().ok();
    Array::from(&held).iter().filter_map(name).filter_map(id).collect()
}

/// Calls back once nobody holds a journal any more.
pub(super) fn when_free(journal: u64, then: impl FnOnce() + 'static) {
    let Some(locks) = locks() else { return };
    let given = Closure::once_into_js(then);
    // Shared: all pages that wait are told at once. Refused only where the page is going away.
    if let Ok(request) = locks.request(&name(journal), &options("mode", &"shared".into()), given.unchecked_ref()) {
        drop(request.catch(&Closure::once_into_js(|_: JsValue| {}).unchecked_into()));
    }
}

/// What the pages of this browser tell each other: that something was kept.
pub(super) struct News {
    channel: Channel,
    listener: RefCell<Option<Closure<dyn Fn()>>>,
}

impl News {
    pub(super) fn new() -> Self {
        Self { channel: Channel::new("buslens-kept"), listener: RefCell::new(None) }
    }

    /// Calls back whenever another page has kept something.
    pub(super) fn listen(&self, hear: impl Fn() + 'static) {
        let listener = Closure::<dyn Fn()>::new(hear);
        self.channel.set_onmessage(listener.as_ref().unchecked_ref());
        *self.listener.borrow_mut() = Some(listener);
    }

    /// Tells the other pages.
    pub(super) fn tell(&self) {
        self.channel.post_message(&JsValue::NULL);
    }
}

fn name(journal: u64) -> String {
    [PREFIX, &journal.to_string()].concat()
}

fn locks() -> Option<LockManager> {
    let scope: Scope = js_sys::global().unchecked_into();
    scope.navigator().locks()
}

#[wasm_bindgen]
extern "C" {
    type Scope;
    #[wasm_bindgen(method, getter)]
    fn navigator(this: &Scope) -> Navigator;

    type Navigator;
    #[wasm_bindgen(method, getter)]
    fn locks(this: &Navigator) -> Option<LockManager>;

    type LockManager;
    #[wasm_bindgen(method, catch)]
    fn request(this: &LockManager, name: &str, options: &Object, given: &Function) -> Result<Asked, JsValue>;
    #[wasm_bindgen(method)]
    fn query(this: &LockManager) -> Promise;

    type Asked;
    #[wasm_bindgen(method)]
    fn catch(this: &Asked, failed: &Function) -> JsValue;

    #[wasm_bindgen(js_name = BroadcastChannel)]
    type Channel;
    #[wasm_bindgen(constructor, js_class = "BroadcastChannel")]
    fn new(name: &str) -> Channel;
    #[wasm_bindgen(method, js_name = postMessage)]
    fn post_message(this: &Channel, message: &JsValue);
    #[wasm_bindgen(method, setter)]
    fn set_onmessage(this: &Channel, listener: &Function);
}
