//! Where a text comes from: pasted, a file, or what was kept at the last visit. It is read in portions.

use js_sys::{JsString, Promise, Uint8Array};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::{JsFuture, spawn_local};

use crate::scope::{Blob, TextDecoder, options, storage};

/// The first portion is small, so that there is something to look at soon.
const FIRST: u32 = 64 << 10;
/// The other portions, in characters or bytes.
const PORTION: u32 = 256 << 10;
/// The name under which a text is kept.
const KEPT: &str = "decoder";

/// A text.
pub(crate) enum Source {
    /// Text of the page.
    Text(JsString),
    /// A file.
    File(Blob),
}

impl Source {
    /// What came with a message; with nothing, what was kept. `keep` keeps it for the next visit, as far as the browser
    /// allows.
    pub(crate) async fn find(beside: JsValue, keep: bool) -> Option<Self> {
        if beside.is_undefined() {
            return kept().await.ok().map(Self::File);
        }
        if keep {
            let text = beside.clone();
            // While it is read. Without a folder nothing is kept.
            spawn_local(async move {
                let _ = save(&text).await;
            });
        }
        Some(match beside.dyn_into::<JsString>() {
            Ok(text) => Self::Text(text),
            Err(file) => Self::File(file.unchecked_into()),
        })
    }

    /// Characters, or bytes of a file.
    pub(crate) fn size(&self) -> u64 {
        match self {
            Self::Text(text) => text.length().into(),
            // A size is a whole number below 2^53.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            Self::File(file) => file.size() as u64,
        }
    }

    /// From the beginning.
    pub(crate) fn portions(&self) -> Portions<'_> {
        Portions { source: self, at: 0, decoder: None }
    }
}

/// Goes through a source.
pub(crate) struct Portions<'a> {
    source: &'a Source,
    at: u64,
    decoder: Option<TextDecoder>,
}

impl Portions<'_> {
    /// The next portion of the text, and how much of the source's size it is; the browser's words where it cannot be read.
    pub(crate) async fn next(&mut self) -> Result<Option<(String, u64)>, String> {
        let left = self.source.size().saturating_sub(self.at);
        if left == 0 {
            return Ok(None);
        }
        let size = u64::from(if self.at == 0 { FIRST } else { PORTION }).min(left);
        let (text, size) = match self.source {
            Source::Text(text) => self.of_text(text, size),
            Source::File(file) => (self.of_file(file, size, size == left).await?, size),
        };
        self.at += size;
        Ok(Some((text, size)))
    }

    fn of_text(&self, text: &JsString, size: u64) -> (String, u64) {
        // A length of a string fits 32 bits.
        let at = u32::try_from(self.at).unwrap_or(u32::MAX);
        let mut end = at.saturating_add(u32::try_from(size).unwrap_or(u32::MAX));
        // Both halves of a surrogate pair go together.
        if end < text.length() && (0xD800..0xDC00).contains(&code_at(text, end - 1)) {
            end += 1;
        }
        (text.substring(at, end).into(), u64::from(end - at))
    }

    async fn of_file(&mut self, file: &Blob, size: u64, last: bool) -> Result<String, String> {
        #[allow(clippy::cast_precision_loss)] // sizes of files are below 2^53
        let (from, to) = (self.at as f64, (self.at + size) as f64);
        let buffer = JsFuture::from(file.slice(from, to).array_buffer()).await.map_err(|error| words(&error))?;
        let bytes = Uint8Array::new(&buffer);
        let decoder = self.decoder.get_or_insert_with(|| TextDecoder::new(encoding(&bytes.to_vec(), last)));
        Ok(decoder.decode(&bytes, &options("stream", &(!last).into())))
    }
}

/// The encoding of a text by its beginning: a byte order mark, or UTF-8 where it is that, or what Chinese tools write.
fn encoding(head: &[u8], whole: bool) -> &'static str {
    match head {
        [0xFF, 0xFE, ..] => "utf-16le",
        [0xFE, 0xFF, ..] => "utf-16be",
        _ => match std::str::from_utf8(head) {
            Ok(_) => "utf-8",
            // A character may go on behind the head.
            Err(error) if error.error_len().is_none() && !whole => "utf-8",
            Err(_) => "gb18030",
        },
    }
}

fn code_at(text: &JsString, at: u32) -> u32 {
    // NaN beyond the end, which becomes 0.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let code = text.char_code_at(at) as u32;
    code
}

fn words(error: &JsValue) -> String {
    error.dyn_ref::<js_sys::Error>().map_or_else(|| format!("{error:?}"), |error| String::from(error.message()))
}

async fn folder() -> Result<Directory, JsValue> {
    let storage = storage().ok_or(JsValue::UNDEFINED)?;
    JsFuture::from(storage.directory()?).await.map(JsCast::unchecked_into)
}

async fn kept() -> Result<Blob, JsValue> {
    let file = JsFuture::from(folder().await?.file(KEPT, &js_sys::Object::new())?).await?;
    JsFuture::from(file.unchecked_into::<FileHandle>().open()?).await.map(JsCast::unchecked_into)
}

async fn save(text: &JsValue) -> Result<(), JsValue> {
    let file = JsFuture::from(folder().await?.file(KEPT, &options("create", &true.into()))?).await?;
    let stream: Writable = JsFuture::from(file.unchecked_into::<FileHandle>().writable()?).await?.unchecked_into();
    JsFuture::from(stream.write(text)?).await?;
    JsFuture::from(stream.close()?).await?;
    Ok(())
}

/// Forgets what was kept.
pub(crate) async fn forget() {
    if let Ok(folder) = folder().await
        && let Ok(removed) = folder.remove(KEPT)
    {
        // It may not be there at all.
        let _ = JsFuture::from(removed).await;
    }
}

#[wasm_bindgen]
extern "C" {
    type Directory;
    #[wasm_bindgen(method, catch, js_name = getFileHandle)]
    fn file(this: &Directory, name: &str, options: &js_sys::Object) -> Result<Promise, JsValue>;
    #[wasm_bindgen(method, catch, js_name = removeEntry)]
    fn remove(this: &Directory, name: &str) -> Result<Promise, JsValue>;

    type FileHandle;
    #[wasm_bindgen(method, catch, js_name = getFile)]
    fn open(this: &FileHandle) -> Result<Promise, JsValue>;
    #[wasm_bindgen(method, catch, js_name = createWritable)]
    fn writable(this: &FileHandle) -> Result<Promise, JsValue>;

    type Writable;
    #[wasm_bindgen(method, catch)]
    fn write(this: &Writable, data: &JsValue) -> Result<Promise, JsValue>;
    #[wasm_bindgen(method, catch)]
    fn close(this: &Writable) -> Result<Promise, JsValue>;
}

#[cfg(test)]
mod tests {
    use super::encoding;

    #[test]
    fn encodings_are_told_by_the_beginning() {
        assert_eq!(encoding(b"TX: 01 03", true), "utf-8");
        assert_eq!(encoding("发→◇01 03 □".as_bytes(), true), "utf-8");
        assert_eq!(encoding(&"发".as_bytes()[..2], false), "utf-8");
        assert_eq!(encoding(&[0xB7, 0xA2, 0xA1, 0xFA, b'0', b'1'], true), "gb18030");
        assert_eq!(encoding(&[0xFF, 0xFE, b'0', 0], true), "utf-16le");
    }
}
