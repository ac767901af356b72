//! Elements, built in plain calls on Leptos's signals.
//!
//! Leptos's `view!` makes a type of its own, with its own code, of every element with everything in it. This page came
//! to 230 KB compressed that way, most of it such code. Here every element is built by the same few functions.
//!
//! What depends on signals is given as a closure (`live_...`) and follows them for as long as the reactive owner lives
//! under which it was made: a part that [`El::live`] builds anew takes everything inside it along.

use std::any::Any;

use crate::reactive::prelude::*;
use js_sys::Reflect;
use wasm_bindgen::prelude::*;
use web_sys::{Blob, BlobPropertyBag, Element, Event, EventTarget, FocusEvent, HtmlElement, KeyboardEvent, Node, Url};

use crate::ambient::Ambient;
use crate::text::Language;

const SVG: &str = "http://www.w3.org/2000/svg";

/// An element of the page.
pub(crate) struct El(Element);

/// A new HTML element.
pub(crate) fn el(tag: &str) -> El {
    made(document().create_element(tag))
}

/// A new SVG element.
pub(crate) fn svg(tag: &str) -> El {
    made(document().create_element_ns(Some(SVG), tag))
}

/// Puts an element at the end of the page.
#[allow(clippy::needless_pass_by_value)] // an element has one place
pub(crate) fn mount(element: El) {
    if let Some(body) = document().body() {
        append(&body, &element.0);
    }
}

/// Listens to an event of the window for as long as the page lives.
pub(crate) fn on_window(event: &str, act: impl FnMut(Event) + 'static) {
    listen(&window(), event, Box::new(act));
}

/// Runs `act` now and whenever a signal that it has read changes.
pub(crate) fn react(act: impl FnMut() + 'static) {
    react_boxed(Box::new(act));
}

impl El {
    /// Sets the classes.
    pub(crate) fn class(self, names: &str) -> Self {
        self.attr("class", names)
    }

    /// Names the element for the browser tests.
    pub(crate) fn test(self, name: &str) -> Self {
        self.attr("data-test", name)
    }

    /// Sets an attribute.
    pub(crate) fn attr(self, name: &str, value: &str) -> Self {
        set(&self.0, name, Some(value));
        self
    }

    /// Adds a text.
    pub(crate) fn text(self, text: &str) -> Self {
        append(&self.0, &document().create_text_node(text));
        self
    }

    /// Adds a text of the page, which follows the language.
    pub(crate) fn say(self, app: &'static Ambient, pick: fn(Language) -> &'static str) -> Self {
        self.live_text(move || pick(app.language.get()).to_owned())
    }

    /// Adds a text that follows signals.
    pub(crate) fn live_text(self, text: impl FnMut() -> String + 'static) -> Self {
        live_text_boxed(&self.0, Box::new(text));
        self
    }

    /// Sets an attribute that follows signals; `None` takes it away.
    pub(crate) fn live_attr(self, name: &'static str, value: impl FnMut() -> Option<String> + 'static) -> Self {
        live_attr_boxed(&self.0, name, Box::new(value));
        self
    }

    /// Labels the element for those who cannot see it, and by a tooltip.
    pub(crate) fn label(self, app: &'static Ambient, pick: fn(Language) -> &'static str) -> Self {
        self.live_attr("aria-label", move || Some(pick(app.language.get()).to_owned()))
    }

    /// An attribute that is there or not, such as `disabled`.
    pub(crate) fn flag(self, name: &'static str, on: impl FnMut() -> bool + 'static) -> Self {
        let mut on: Box<dyn FnMut() -> bool> = Box::new(on);
        live_attr_boxed(&self.0, name, Box::new(move || on().then(String::new)));
        self
    }

    /// An attribute that says `true` or `false`, as ARIA and the styles want it.
    pub(crate) fn state(self, name: &'static str, on: impl FnMut() -> bool + 'static) -> Self {
        let mut on: Box<dyn FnMut() -> bool> = Box::new(on);
        live_attr_boxed(&self.0, name, Box::new(move || Some(if on() { "true" } else { "false" }.to_owned())));
        self
    }

    /// A class that is there or not.
    pub(crate) fn live_class(self, name: &'static str, on: impl FnMut() -> bool + 'static) -> Self {
        live_class_boxed(&self.0, name, Box::new(on));
        self
    }

    /// Binds the value of a field both ways. Call it last: a list's options come first.
    pub(crate) fn bind(self, event: &str, value: RwSignal<String>) -> Self {
        live_value_boxed(&self.0, Box::new(move || value.get()));
        let field = self.0.clone();
        self.on(event, move |_| value.set(value_of(&field)))
    }

    /// Sets the value of a field whenever signals change.
    pub(crate) fn live_value(self, value: impl FnMut() -> String + 'static) -> Self {
        live_value_boxed(&self.0, Box::new(value));
        self
    }

    /// Ticks a box, or not, as signals say.
    pub(crate) fn live_checked(self, mut on: impl FnMut() -> bool + 'static) -> Self {
        let tick = self.0.clone();
        react(move || {
            let _ = Reflect::set(&tick, &"checked".into(), &on().into());
        });
        self
    }

    /// Listens to an event.
    pub(crate) fn on(self, event: &str, act: impl FnMut(Event) + 'static) -> Self {
        listen(&self.0, event, Box::new(act));
        self
    }

    /// Listens to a click.
    pub(crate) fn click(self, act: impl FnMut() + 'static) -> Self {
        let mut act: Box<dyn FnMut()> = Box::new(act);
        listen(&self.0, "click", Box::new(move |_| act()));
        self
    }

    /// Adds an element.
    #[allow(clippy::needless_pass_by_value)] // an element has one place
    pub(crate) fn child(self, child: El) -> Self {
        append(&self.0, &child.0);
        self
    }

    /// Adds elements.
    pub(crate) fn children(self, children: impl IntoIterator<Item = El>) -> Self {
        for child in children {
            append(&self.0, &child.0);
        }
        self
    }

    /// Adds elements that are built anew whenever signals change.
    pub(crate) fn live(self, build: impl FnMut() -> Vec<El> + 'static) -> Self {
        live_boxed(&self.0, Box::new(build));
        self
    }

    /// Adds one element or none, built anew whenever signals change.
    pub(crate) fn live_one(self, build: impl FnMut() -> Option<El> + 'static) -> Self {
        let mut build: Box<dyn FnMut() -> Option<El>> = Box::new(build);
        live_boxed(&self.0, Box::new(move || build().into_iter().collect()));
        self
    }

    /// The element itself.
    pub(crate) fn handle(&self) -> Handle {
        Handle(self.0.clone())
    }

    /// Takes it off the page.
    pub(crate) fn remove(self) {
        self.0.remove();
    }

    /// Calls `act` with the inner width and height in pixels, now and whenever a signal that it has read changes.
    pub(crate) fn live_size(self, mut act: impl FnMut(f64, f64) + 'static) -> Self {
        let element = self.0.clone();
        react(move || act(element.client_width().into(), element.client_height().into()));
        self
    }
}

/// An element as it stands on the page, for what no signal tells: where it is scrolled to, how large it is drawn.
#[derive(Clone)]
pub(crate) struct Handle(Element);

impl Handle {
    /// Sets a property of its style. The page's policy allows it here, not in an attribute.
    pub(crate) fn set_style(&self, property: &str, value: &str) {
        if let Some(element) = self.0.dyn_ref::<HtmlElement>() {
            // A property's name that is a literal is never refused.
            let _ = element.style().set_property(property, value);
        }
    }

    /// Height of what is inside its border, in pixels.
    pub(crate) fn height(&self) -> f64 {
        self.0.client_height().into()
    }

    /// How far it is scrolled down, in pixels.
    pub(crate) fn scroll_top(&self) -> f64 {
        self.0.scroll_top().into()
    }

    /// Scrolls it down so far.
    pub(crate) fn set_scroll_top(&self, pixels: f64) {
        // In the browser's range: lists are no taller.
        #[allow(clippy::cast_possible_truncation)]
        self.0.set_scroll_top(pixels as i32);
    }

    /// Closes an element that opens and closes.
    pub(crate) fn close(&self) {
        set(&self.0, "open", None);
    }

    /// Ticks a box or unticks it.
    pub(crate) fn set_checked(&self, checked: bool) {
        // A box takes either.
        let _ = Reflect::set(&self.0, &"checked".into(), &checked.into());
    }

    /// Whether a box is ticked.
    pub(crate) fn is_checked(&self) -> bool {
        Reflect::get(&self.0, &"checked".into()).is_ok_and(|checked| checked.is_truthy())
    }

    /// Whether the focus that an event takes away goes to something inside.
    pub(crate) fn holds_next_focus(&self, event: &Event) -> bool {
        let next = event.dyn_ref::<FocusEvent>().and_then(FocusEvent::related_target);
        next.and_then(|next| next.dyn_into::<Node>().ok()).is_some_and(|next| self.0.contains(Some(&next)))
    }

    /// Puts it at the end of another element, if it is not in there already.
    pub(crate) fn move_into(&self, place: &Element) {
        if !place.is_same_node(self.0.parent_node().as_ref()) {
            append(place, &self.0);
        }
    }

    /// The element for the other program in the window.
    pub(crate) fn js(&self) -> &JsValue {
        &self.0
    }

    /// Adds an element at its end.
    pub(crate) fn append(&self, child: &El) {
        append(&self.0, &child.0);
    }
}

/// Lets the browser save a file.
pub(crate) fn save_file(file: &Blob, name: &str) {
    let Ok(address) = Url::create_object_url_with_blob(file) else { return };
    let link = el("a").attr("href", &address).attr("download", name);
    if let Some(link) = link.0.dyn_ref::<HtmlElement>() {
        link.click();
    }
    // The browser has taken the file up with the click.
    let _ = Url::revoke_object_url(&address);
}

/// Lets the browser save a text as a file.
pub(crate) fn save_text(text: &str, kind: &str, name: &str) {
    let options = BlobPropertyBag::new();
    options.set_type(kind);
    let parts = js_sys::Array::of1(&text.into());
    if let Ok(file) = Blob::new_with_str_sequence_and_options(&parts, &options) {
        save_file(&file, name);
    }
}

/// Whether the element of an event, one that opens and closes, is open.
pub(crate) fn is_open(event: &Event) -> bool {
    event.target().and_then(|target| Reflect::get(&target, &"open".into()).ok()).is_some_and(|open| open.is_truthy())
}

/// Whether the box that an event came from is ticked.
pub(crate) fn is_checked(event: &Event) -> bool {
    event.target().and_then(|target| Reflect::get(&target, &"checked".into()).ok()).is_some_and(|on| on.is_truthy())
}

/// An attribute of the innermost element around an event's target that has it.
pub(crate) fn attribute_around(event: &Event, name: &str) -> Option<String> {
    let target = event.target()?.dyn_into::<Element>().ok()?;
    // An attribute's name in brackets is a selector.
    target.closest(&["[", name, "]"].concat()).ok()??.get_attribute(name)
}

/// The key of a keyboard's event, as `ArrowDown`; empty for other events.
pub(crate) fn key(event: &Event) -> String {
    event.dyn_ref::<KeyboardEvent>().map(KeyboardEvent::key).unwrap_or_default()
}

/// Whether the shift key was held, of a keyboard's or a mouse's event.
pub(crate) fn is_shifted(event: &Event) -> bool {
    Reflect::get(event, &"shiftKey".into()).is_ok_and(|held| held.is_truthy())
}

/// Whether control or the command key was held.
pub(crate) fn is_commanded(event: &Event) -> bool {
    ["ctrlKey", "metaKey", "altKey"]
        .iter()
        .any(|key| Reflect::get(event, &(*key).into()).is_ok_and(|held| held.is_truthy()))
}

/// Whether an event came from something that is typed into or chosen from.
pub(crate) fn is_typing(event: &Event) -> bool {
    let target = event.target().and_then(|target| target.dyn_into::<Element>().ok());
    target.is_some_and(|target| target.closest("input,textarea,select").is_ok_and(|found| found.is_some()))
}

/// Moves the focus to the element with this id; whether there is one.
pub(crate) fn focus(id: &str) -> bool {
    element(id).is_some_and(|found| found.focus().is_ok())
}

/// Presses what has this id as a hand would: what is disabled stays as it is.
pub(crate) fn press(id: &str) {
    if let Some(found) = element(id) {
        found.click();
    }
}

/// Presses the button after the pressed one, of the group with this id.
pub(crate) fn press_next(group: &str) {
    if let Some(next) = within(group, "[aria-pressed=true] + button").or_else(|| within(group, "button")) {
        next.click();
    }
}

/// Opens the menu with this id, its first item ready to be pressed.
pub(crate) fn open_menu(id: &str) {
    if let Some(menu) = element(id) {
        let _ = menu.set_attribute("open", "");
    }
    if let Some(first) = within(id, ".menu-items button") {
        let _ = first.focus();
    }
}

fn element(id: &str) -> Option<HtmlElement> {
    document().get_element_by_id(id)?.dyn_into().ok()
}

/// The first that fits a selector inside what has this id.
fn within(id: &str, selector: &str) -> Option<HtmlElement> {
    element(id)?.query_selector(selector).ok()??.dyn_into().ok()
}

/// Moves the focus to the text field with this id, and the cursor to a place in it, counted in UTF-16 units.
pub(crate) fn select(id: &str, at: u32) {
    if focus(id)
        && let Some(field) = document().get_element_by_id(id)
        && let Some(select) = Reflect::get(&field, &"setSelectionRange".into())
            .ok()
            .and_then(|select| select.dyn_into::<js_sys::Function>().ok())
    {
        // Text fields take any place.
        let _ = select.call2(&field, &at.into(), &at.into());
    }
}

/// Brings the first that fits a selector inside what has this id to the middle of what scrolls around it.
pub(crate) fn reveal(id: &str, selector: &str) {
    let center = js_sys::Object::new();
    // A plain object takes any property.
    let _ = Reflect::set(&center, &"block".into(), &"center".into());
    if let Some(found) = within(id, selector)
        && let Ok(scroll) = Reflect::get(&found, &"scrollIntoView".into())
        && let Some(scroll) = scroll.dyn_ref::<js_sys::Function>()
    {
        // Every element can be scrolled to.
        let _ = scroll.call1(&found, &center);
    }
}

/// Whether the element with this id has the focus.
pub(crate) fn has_focus(id: &str) -> bool {
    document().active_element().is_some_and(|found| found.id() == id)
}

/// The value of the field that an event came from.
pub(crate) fn value(event: &Event) -> String {
    event.target().map(|target| value_of(&target)).unwrap_or_default()
}

/// An element that could be made. A panic that told the browser's reason would cost the download a printer of any value.
fn made(element: Result<Element, JsValue>) -> El {
    let Ok(element) = element else { unreachable!("the names of elements are literals") };
    El(element)
}

fn react_boxed(mut act: Box<dyn FnMut()>) {
    keep(Box::new(RenderEffect::new(move |_: Option<()>| act())));
}

/// Keeps something for as long as the reactive owner lives.
fn keep(handle: Box<dyn Any>) {
    StoredValue::new_local(handle);
}

fn append(parent: &Node, child: &Node) {
    // A new node can always be appended to an element.
    let _ = parent.append_child(child);
}

fn set(element: &Element, name: &str, value: Option<&str>) {
    // An attribute's name that is a literal is never refused.
    let _ = match value {
        Some(value) => element.set_attribute(name, value),
        None => element.remove_attribute(name),
    };
}

fn live_text_boxed(parent: &Element, mut text: Box<dyn FnMut() -> String>) {
    let node = document().create_text_node("");
    append(parent, &node);
    let mut shown = String::new();
    react_boxed(Box::new(move || {
        let text = text();
        if text != shown {
            node.set_data(&text);
            shown = text;
        }
    }));
}

fn live_attr_boxed(element: &Element, name: &'static str, mut value: Box<dyn FnMut() -> Option<String>>) {
    let element = element.clone();
    let mut shown = None;
    react_boxed(Box::new(move || {
        let value = value();
        if value != shown {
            set(&element, name, value.as_deref());
            shown = value;
        }
    }));
}

fn live_class_boxed(element: &Element, name: &'static str, mut on: Box<dyn FnMut() -> bool>) {
    let classes = element.class_list();
    react_boxed(Box::new(move || {
        // A class name that is a literal is never refused.
        let _ = classes.toggle_with_force(name, on());
    }));
}

fn live_value_boxed(field: &Element, mut value: Box<dyn FnMut() -> String>) {
    let field = field.clone();
    react_boxed(Box::new(move || set_value(&field, &value())));
}

fn live_boxed(parent: &Element, mut build: Box<dyn FnMut() -> Vec<El>>) {
    let anchor = document().create_comment("");
    append(parent, &anchor);
    let mut shown: Vec<El> = Vec::new();
    react_boxed(Box::new(move || {
        for old in shown.drain(..) {
            old.0.remove();
        }
        shown = build();
        if let Some(parent) = anchor.parent_node() {
            for new in &shown {
                // The anchor is the parent's child.
                let _ = parent.insert_before(&new.0, Some(&anchor));
            }
        }
    }));
}

fn listen(element: &EventTarget, event: &str, act: Box<dyn FnMut(Event)>) {
    let listener = Closure::wrap(act);
    // Adding a listener to an element does not fail.
    let _ = element.add_event_listener_with_callback(event, listener.as_ref().unchecked_ref());
    keep(Box::new(listener));
}

fn value_of(field: &JsValue) -> String {
    Reflect::get(field, &"value".into()).ok().and_then(|value| value.as_string()).unwrap_or_default()
}

/// Leaves a field alone that holds the value already: the cursor would jump.
fn set_value(field: &JsValue, value: &str) {
    if value_of(field) != value {
        let _ = Reflect::set(field, &"value".into(), &value.into());
    }
}
