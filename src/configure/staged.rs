//! What a user wants changed and has not sent: as typed, right or wrong, so that nothing typed is lost.

use buslens_codec::profile::{Point, Profile, Role};
use buslens_codec::value::{Encoding, Value};
use buslens_configure::{Edit, Refusal, Snapshot};

use super::{row, words};

/// Between a point's id and its text.
const GAP: char = '\t';

/// The texts typed for a device's points, in the order in which they were begun.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Staged {
    texts: Vec<(String, String)>,
}

/// What the staged texts come to against what a device holds.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Verdicts {
    /// What is right and changes something, in the profile's order.
    pub(crate) edits: Vec<Edit>,
    /// What is not taken.
    pub(crate) refused: Vec<Refusal>,
}

impl Verdicts {
    /// Whether a point's text changes something.
    pub(crate) fn changes(&self, point: &str) -> bool {
        self.edits.iter().any(|edit| edit.point == point)
    }

    /// Why a point's text is not taken.
    pub(crate) fn refusal(&self, point: &str) -> Option<&Refusal> {
        self.refused.iter().find(|refusal| refusal.point == point)
    }
}

impl Staged {
    /// The text typed for a point.
    pub(crate) fn text(&self, point: &str) -> Option<&str> {
        self.texts.iter().find(|(id, _)| id == point).map(|(_, text)| text.as_str())
    }

    /// Whether nothing was typed.
    pub(crate) fn is_empty(&self) -> bool {
        self.texts.is_empty()
    }

    /// Types a text for a point.
    pub(crate) fn put(&mut self, point: &str, text: &str) {
        match self.texts.iter_mut().find(|(id, _)| id == point) {
            Some((_, old)) => text.clone_into(old),
            None => self.texts.push((point.to_owned(), text.to_owned())),
        }
    }

    /// Takes a point's text back.
    pub(crate) fn revert(&mut self, point: &str) {
        self.texts.retain(|(id, _)| id != point);
    }

    /// Takes everything back.
    pub(crate) fn clear(&mut self) {
        self.texts.clear();
    }

    /// Stages registers, in place of whatever was typed for that point.
    pub(crate) fn put_edit(&mut self, profile: &Profile, edit: &Edit, have: &Snapshot) {
        let Some(point) = profile.point(&edit.point) else { return };
        self.put(&edit.point, &spelled(profile, point, &edit.registers, have));
    }

    /// What the texts come to. A text that says what the device holds already changes nothing.
    pub(crate) fn verdicts(&self, profile: &Profile, have: &Snapshot) -> Verdicts {
        let mut verdicts = Verdicts::default();
        for point in &profile.points {
            let Some(typed) = self.text(&point.id) else { continue };
            match Edit::parse(profile, point, typed, have) {
                Ok(edit) if is_held(point, have, &edit) => {}
                Ok(edit) => verdicts.edits.push(edit),
                Err(refusal) => verdicts.refused.push(refusal),
            }
        }
        verdicts
    }

    /// As one text, for [`Self::from_kept`].
    pub(crate) fn kept(&self) -> String {
        let lines: Vec<String> = self.texts.iter().map(|(id, text)| format!("{id}{GAP}{}", one_line(text))).collect();
        lines.join("\n")
    }

    /// What was kept. Anything else in the text is passed over.
    pub(crate) fn from_kept(text: &str) -> Self {
        let mut staged = Self::default();
        for (id, text) in text.lines().filter_map(|line| line.split_once(GAP)) {
            staged.put(id, text);
        }
        staged
    }
}

/// The edits that bring every parameter with a factory default to it.
pub(crate) fn factory_edits(profile: &Profile, have: &Snapshot) -> Vec<Edit> {
    let writable = |point: &&Point| point.role == Role::Parameter && !point.write.is_empty();
    let of_factory = |point: &Point| Some(Edit { point: point.id.clone(), registers: vec![point.factory?] });
    let edits = profile.points.iter().filter(writable).filter_map(of_factory);
    edits.filter(|edit| profile.point(&edit.point).is_some_and(|point| !is_held(point, have, edit))).collect()
}

/// Registers as they are typed: exact, whatever the language is.
fn spelled(profile: &Profile, point: &Point, registers: &[u16], have: &Snapshot) -> String {
    if let Ok(Value::Code(code)) = point.encoding.decode(registers) {
        return row::typed_code(code);
    }
    let words: Vec<String> = registers.iter().map(|word| format!("{word:04X}")).collect();
    let hexadecimal = format!("0x{}", words.concat());
    // A number is written as people write it, if that comes back as the same registers.
    let shown = words::shown(profile, point, registers, have, |texts| &texts.en);
    let same = |text: &String| Edit::parse(profile, point, text, have).is_ok_and(|edit| edit.registers == registers);
    shown.and_then(|shown| shown.text).filter(same).unwrap_or(hexadecimal)
}

/// Whether the device holds this already.
fn is_held(point: &Point, have: &Snapshot, edit: &Edit) -> bool {
    let mask = match point.encoding {
        Encoding::Bits { mask, .. } => mask,
        _ => u16::MAX,
    };
    have.registers(&point.id).is_some_and(|held| {
        held.len() == edit.registers.len()
            && held.iter().zip(&edit.registers).all(|(old, new)| old & mask == new & mask)
    })
}

fn one_line(text: &str) -> String {
    text.replace(['\n', '\r', GAP], " ")
}

#[cfg(test)]
mod tests {
    use buslens_configure::{Datum, Reach, Read, Unfit};

    use super::*;
    use crate::device;

    fn profile() -> &'static Profile {
        device::find("lvdt").profile()
    }

    /// As it leaves the factory, but for the rate of samples.
    fn held() -> Snapshot {
        let mut have = Snapshot::empty(profile(), Reach::of_factory(profile()));
        for (point, register) in [("address", 1), ("baud", 3), ("parity", 2), ("sample_rate", 6)] {
            have.data.push(Datum { point: point.to_owned(), read: Read::Registers(vec![register]) });
        }
        have
    }

    #[test]
    fn what_is_typed_is_kept_right_or_wrong() {
        let mut staged = Staged::default();
        staged.put("baud", "0x0007");
        staged.put("address", " 300\tx ");
        staged.put("baud", "115200");
        let kept = Staged::from_kept(&staged.kept());
        assert_eq!((kept.text("baud"), kept.text("address")), (Some("115200"), Some(" 300 x ")));
        assert_eq!(Staged::from_kept("no gap\n"), Staged::default());
    }

    #[test]
    fn texts_are_edits_refusals_or_nothing() {
        let mut staged = Staged::default();
        staged.put("baud", "115200");
        staged.put("parity", "even");
        staged.put("address", "300");
        let verdicts = staged.verdicts(profile(), &held());
        assert_eq!(verdicts.edits, [Edit { point: "baud".to_owned(), registers: vec![7] }]);
        let why = verdicts.refusal("address").map(|refusal| &refusal.why);
        assert!(matches!(why, Some(Unfit::OutOfRange { .. })), "{why:?}");
        assert!(verdicts.changes("baud") && !verdicts.changes("parity"));
        assert_eq!((verdicts.edits.len(), verdicts.refused.len()), (1, 1));
    }

    #[test]
    fn the_factorys_values_are_those_that_differ() {
        let have = held();
        let edits = factory_edits(profile(), &have);
        let of = |point: &str| edits.iter().find(|edit| edit.point == point).map(|edit| edit.registers.clone());
        assert_eq!(of("sample_rate"), Some(vec![4]));
        assert_eq!((of("baud"), of("parity"), of("address")), (None, None, None));
        let mut staged = Staged::default();
        for edit in &edits {
            staged.put_edit(profile(), edit, &have);
        }
        assert_eq!(staged.verdicts(profile(), &have).edits, edits);
    }
}
