//! One field of the form: a control for what stands at a path of the text.

use super::super::editor::reason;
use crate::dom::{self, El, el};
use crate::profiles::patch;
use crate::profiles::tree::{Tree, join};
use crate::reactive::prelude::*;
use crate::text::{Label, Language};
use crate::workbench::Workbench;

/// What a field is for.
#[derive(Clone, Copy)]
pub(super) struct Widget {
    /// Its path, or the end of it within an entry of a list.
    pub(super) key: &'static str,
    label: Label,
    kind: Kind,
}

/// How a value is typed or chosen.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    /// Any text.
    Text,
    /// A text of a program's: an id, hexadecimal digits.
    Word,
    /// A text of a pair in both languages.
    English,
    /// The other one of the pair.
    Chinese,
    /// A number as JSON has them, or a text as `0x0030`.
    Number,
    /// One of these words, or nothing.
    Choice(&'static [(&'static str, Label)]),
    /// The id of a point, or nothing.
    Point,
    /// Any of these words or numbers.
    Checks(&'static [(&'static str, Label)]),
    /// Numbers with commas or blanks between them.
    List,
    /// True, or nothing.
    Flag,
}

impl Widget {
    pub(super) const fn new(key: &'static str, label: Label, kind: Kind) -> Self {
        Self { key, label, kind }
    }
}

/// Two fields for a text in both languages.
pub(super) fn texts(app: &'static Workbench, path: &str, label: Label) -> [El; 2] {
    let field = |end: &str, kind| widget(app, join(path, end), &Widget::new("", label, kind));
    [field("en", Kind::English), field("zh", Kind::Chinese)]
}

/// The field at a path, with its name above and, where the loader finds fault with it, the reason below.
pub(super) fn widget(app: &'static Workbench, path: String, spec: &Widget) -> El {
    let (label, kind) = (spec.label, spec.kind);
    let name = move || {
        let language = app.language.get();
        let of = match kind {
            Kind::English => language.in_english(),
            Kind::Chinese => language.in_chinese(),
            _ => return label(language).to_owned(),
        };
        [label(language), " · ", of].concat()
    };
    let control = match kind {
        Kind::Checks(words) => return group(app, &path, name, words),
        Kind::Flag => flag(app, &path),
        Kind::Choice(words) => choice(app, &path, words),
        Kind::Point => point_choice(app, &path),
        Kind::Text | Kind::Word | Kind::English | Kind::Chinese | Kind::Number | Kind::List => typed(app, &path, kind),
    };
    let class = match kind {
        Kind::Flag => "profile-field flag",
        Kind::Text | Kind::English | Kind::Chinese => "profile-field long",
        _ => "profile-field",
    };
    el("label").class(class).child(el("span").live_text(name)).child(control).child(fault_note(app, path))
}

/// Why the loader does not take what stands at this path.
pub(super) fn fault_note(app: &'static Workbench, path: String) -> El {
    let fault = is_fault(app, path);
    el("small").class("profile-wrong").live_text(move || {
        let language = app.language.get();
        let told = || app.profiles.loaded.with(|loaded| loaded.as_ref().err().map(|fault| reason(language, fault)));
        fault.get().then(told).flatten().map(|reason| language.fault_here(&reason)).unwrap_or_default()
    })
}

fn is_fault(app: &'static Workbench, path: String) -> Memo<bool> {
    Memo::new(move |_| app.profiles.fault_path.with(|fault| fault.as_deref() == Some(&path)))
}

fn typed(app: &'static Workbench, path: &str, kind: Kind) -> El {
    let fault = is_fault(app, path.to_owned());
    // What was typed stays as it was typed for as long as it means what stands in the text.
    let before = StoredValue::new(String::new());
    let (shown, changed) = (path.to_owned(), path.to_owned());
    let class = if matches!(kind, Kind::Word | Kind::Number | Kind::List) { "code" } else { "" };
    hooked(el("input").class(class), path)
        .attr("type", "text")
        .attr("autocomplete", "off")
        .attr("autocapitalize", "off")
        .attr("spellcheck", "false")
        .live_attr("aria-invalid", move || fault.get().then(|| "true".to_owned()))
        .live_value(move || {
            let there = app.profiles.tree.with(|tree| tree.as_ref().map(|tree| shown_text(tree, &shown, kind)));
            let there = there.unwrap_or_default();
            before.with_value(|typed| if meant(typed, kind) == meant(&there, kind) { typed.clone() } else { there })
        })
        .on("input", move |event| {
            let text = dom::value(&event);
            before.set_value(text.clone());
            put(app, &changed, kind, &text);
        })
}

/// A path's value as a field shows it.
fn shown_text(tree: &Tree, path: &str, kind: Kind) -> String {
    match kind {
        Kind::List => tree.list(path).join(", "),
        _ => tree.get(path).to_owned(),
    }
}

/// What was typed, as JSON; `None` takes the key away.
fn meant(typed: &str, kind: Kind) -> Option<String> {
    match kind {
        Kind::List => {
            let items = typed.split([',', ' ', '\u{FF0C}', '\u{3001}']).filter(|item| !item.is_empty());
            Some(patch::listed(items.map(patch::scalar)))
        }
        _ if typed.is_empty() => None,
        Kind::Number => Some(patch::scalar(typed)),
        _ => Some(patch::quoted(typed)),
    }
}

/// Puts what was typed into the text.
fn put(app: &'static Workbench, path: &str, kind: Kind, typed: &str) {
    let other = match kind {
        Kind::English => path.strip_suffix("en").map(|stem| [stem, "zh"].concat()),
        Kind::Chinese => path.strip_suffix("zh").map(|stem| [stem, "en"].concat()),
        _ => None,
    };
    let value = meant(typed, kind);
    app.profiles.patch(|text| {
        let changed = put_value(text, path, value.as_deref())?;
        // A profile has every text in both languages: until the other one is given words of its own, it has these.
        let tree = Tree::of(text)?;
        match other.filter(|other| tree.get(other) == tree.get(path)) {
            Some(other) => put_value(&changed, &other, value.as_deref()),
            None => Some(changed),
        }
    });
}

/// Puts JSON at a path, or takes away what stands there.
pub(super) fn put_value(text: &str, path: &str, value: Option<&str>) -> Option<String> {
    match value {
        Some(value) => patch::set(text, path, value),
        None => patch::remove(text, path),
    }
}

fn choice(app: &'static Workbench, path: &str, words: &'static [(&'static str, Label)]) -> El {
    let options = move |language| {
        words.iter().map(|(word, label)| ((*word).to_owned(), label(language).to_owned())).collect::<Vec<_>>()
    };
    select(app, path, Box::new(options))
}

fn point_choice(app: &'static Workbench, path: &str) -> El {
    let options = move |_| {
        let ids = app.profiles.tree.with(|tree| tree.as_ref().map(point_ids)).unwrap_or_default();
        ids.into_iter().map(|id| (id.clone(), id)).collect::<Vec<_>>()
    };
    select(app, path, Box::new(options))
}

/// The ids of all points.
fn point_ids(tree: &Tree) -> Vec<String> {
    let id = |at: usize| tree.get(&join(&join("points", &at.to_string()), "id")).to_owned();
    (0..tree.count("points")).map(id).filter(|id| !id.is_empty()).collect()
}

type Options = Box<dyn Fn(Language) -> Vec<(String, String)> + Send + Sync>;

/// A list to choose from. What stands in the text is among the options, be it known or not.
fn select(app: &'static Workbench, path: &str, options: Options) -> El {
    let fault = is_fault(app, path.to_owned());
    let (at, changed) = (path.to_owned(), path.to_owned());
    let value = Memo::new(move |_| {
        app.profiles.tree.with(|tree| tree.as_ref().map(|tree| tree.get(&at).to_owned())).unwrap_or_default()
    });
    let all = Memo::new(move |_| {
        let mut all = options(app.language.get());
        let there = value.get();
        if !there.is_empty() && all.iter().all(|(word, _)| *word != there) {
            all.push((there.clone(), there));
        }
        all.insert(0, (String::new(), "\u{2013}".to_owned()));
        all
    });
    hooked(el("select"), path)
        .live_attr("aria-invalid", move || fault.get().then(|| "true".to_owned()))
        .live(move || {
            all.with(|all| all.iter().map(|(word, label)| el("option").attr("value", word).text(label)).collect())
        })
        .live_value(move || {
            // New options forget what was chosen.
            all.track();
            value.get()
        })
        .on("change", move |event| {
            let word = dom::value(&event);
            let value = (!word.is_empty()).then(|| patch::quoted(&word));
            app.profiles.patch(|text| put_value(text, &changed, value.as_deref()));
        })
}

fn flag(app: &'static Workbench, path: &str) -> El {
    let at = path.to_owned();
    let on =
        Memo::new(move |_| app.profiles.tree.with(|tree| tree.as_ref().is_some_and(|tree| tree.get(&at) == "true")));
    let changed = path.to_owned();
    check_box(path, on, move |checked| {
        app.profiles.patch(|text| put_value(text, &changed, checked.then_some("true")));
    })
}

/// A box for each word of a list.
fn group(
    app: &'static Workbench,
    path: &str,
    name: impl Fn() -> String + 'static,
    words: &'static [(&'static str, Label)],
) -> El {
    let boxes = words.iter().map(|&(word, label)| {
        let (at, changed) = (path.to_owned(), path.to_owned());
        let on = Memo::new(move |_| {
            app.profiles.tree.with(|tree| tree.as_ref().is_some_and(|tree| tree.list(&at).contains(&word)))
        });
        let tick = check_box(&join(path, word), on, move |checked| {
            app.profiles.patch(|text| ticked(text, &changed, words, word, checked));
        });
        el("label").class("check").child(tick).child(el("span").say(app, label))
    });
    el("fieldset")
        .class("profile-field checks")
        .child(el("legend").live_text(name))
        .child(el("div").children(boxes))
        .child(fault_note(app, path.to_owned()))
}

/// A list with a word put in or taken out: in the order of the boxes, what they do not know last.
fn ticked(text: &str, path: &str, words: &[(&str, Label)], word: &str, checked: bool) -> Option<String> {
    let tree = Tree::of(text)?;
    let mut kept: Vec<&str> = tree.list(path).into_iter().filter(|other| *other != word).collect();
    if checked {
        kept.push(word);
    }
    kept.sort_by_key(|word| words.iter().position(|(known, _)| known == word).unwrap_or(words.len()));
    let value = patch::listed(kept.into_iter().map(patch::scalar));
    put_value(text, path, (value != "[]").then_some(value.as_str()))
}

fn check_box(path: &str, on: Memo<bool>, take: impl Fn(bool) + 'static) -> El {
    let tick = hooked(el("input"), path).attr("type", "checkbox");
    let (shown, ticked) = (tick.handle(), tick.handle());
    dom::react(move || shown.set_checked(on.get()));
    tick.on("change", move |_| take(ticked.is_checked()))
}

/// Named for the tests by its path.
fn hooked(control: El, path: &str) -> El {
    control.test(&["field-", path].concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_typed_means_json() {
        assert_eq!(meant("9600, 19200\u{FF0C}0x10", Kind::List).as_deref(), Some("[9600, 19200, \"0x10\"]"));
        assert_eq!(meant("", Kind::List).as_deref(), Some("[]"));
        assert_eq!(meant("9600,", Kind::List), meant("9600", Kind::List));
        assert_eq!((meant("", Kind::Number), meant("0x1", Kind::Number)), (None, Some("\"0x1\"".to_owned())));
        assert_eq!(meant("5", Kind::Word).as_deref(), Some("\"5\""));
    }

    #[test]
    fn boxes_keep_their_order_and_what_they_do_not_know() {
        const WORDS: &[(&str, Label)] = &[("3", |_| "3"), ("4", |_| "4")];
        let text = "{ \"read\": [4, 9] }";
        assert_eq!(ticked(text, "read", WORDS, "3", true).unwrap(), "{ \"read\": [3, 4, 9] }");
        assert_eq!(ticked(text, "read", WORDS, "4", false).unwrap(), "{ \"read\": [9] }");
        assert_eq!(ticked("{ \"read\": [4], \"a\": 1 }", "read", WORDS, "4", false).unwrap(), "{ \"a\": 1 }");
    }
}
