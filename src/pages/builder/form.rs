//! What the form holds: a remembered text for each field.

use crate::reactive::prelude::*;
use buslens_codec::line::LineSettings;
use buslens_codec::profile::Point;

use crate::builder::{Draft, Slot, Way, point};
use crate::device::{self, Device};
use crate::message::Source;
use crate::settings::{BAUDS, Settings, parse_baud};
use crate::storage::kept;

/// The choice in the list of functions that stands for a typed one.
pub(super) const TYPED: &str = "typed";

/// Every field as it stands on the page.
#[derive(Clone, Copy)]
pub(super) struct Form {
    /// The line of the connection's settings when the page was opened: they are changed on another page.
    set_line: Option<LineSettings>,
    /// The device's profile id.
    pub(super) device: RwSignal<String>,
    /// `read:` or `write:` with a point's id; empty for none.
    pub(super) point: RwSignal<String>,
    /// The point's value, typed or chosen.
    pub(super) value: RwSignal<String>,
    /// `request`, `response` or `exception`.
    pub(super) way: RwSignal<String>,
    /// A function code as two digits, or [`TYPED`].
    pub(super) function: RwSignal<String>,
    /// The fields of the message, each at its slot's place.
    slots: StoredValue<[RwSignal<String>; Slot::ALL.len()]>,
    /// `yes` for a check that is wrong on purpose.
    pub(super) wrong_check: RwSignal<String>,
    /// The baud rate of the times.
    pub(super) baud: RwSignal<String>,
    /// `rtu` or `ascii`: which frame is spelled.
    pub(super) spelled: RwSignal<String>,
}

impl Form {
    /// What was remembered.
    pub(super) fn remembered() -> Self {
        let settings = Settings::remembered();
        let baud = settings.baud.get_untracked();
        let listed = parse_baud(&baud).is_some_and(|baud| BAUDS.contains(&baud));
        Self {
            set_line: settings.connection(Source::Simulator).map(|connection| connection.line),
            device: kept("builder-device", device::first().id()),
            point: kept("builder-point", ""),
            value: kept("builder-point-value", ""),
            way: kept("builder-way", "request"),
            function: kept("builder-function", "03"),
            slots: StoredValue::new(Slot::ALL.map(|slot| kept(slot.key(), slot.default()))),
            wrong_check: kept("builder-wrong-check", ""),
            baud: kept("builder-baud", if listed { &baud } else { "9600" }),
            spelled: kept("builder-spelled", "rtu"),
        }
    }

    /// The text of a field.
    pub(super) fn slot(&self, slot: Slot) -> RwSignal<String> {
        self.slots.with_value(|slots| slots[slot.index()])
    }

    /// The chosen device.
    pub(super) fn device(&self) -> &'static Device {
        self.device.with(|id| device::find(id))
    }

    /// The chosen point, and whether it is written.
    pub(super) fn point(&self) -> Option<(&'static Point, bool)> {
        let profile = self.device().profile();
        self.point.with(|key| {
            let (kind, id) = key.split_once(':')?;
            Some((profile.point(id)?, kind == "write"))
        })
    }

    /// Fills the fields with what the chosen point needs.
    pub(super) fn take_point(&self) {
        let Some((chosen, write)) = self.point() else { return };
        let Some(template) = point::template(chosen, write) else { return };
        self.function.set(crate::format::hex(template.function));
        for (slot, text) in template.texts {
            self.slot(slot).set(text);
        }
        self.read_value(&self.draft());
    }

    /// The fields are no longer those of the chosen point.
    pub(super) fn leave_point(&self) {
        self.point.set(String::new());
    }

    /// Puts what was typed as the point's value into the registers, if it is one.
    pub(super) fn write_value(&self) {
        let Some((chosen, _)) = self.point() else { return };
        if let Some((_, registers)) = self.value.with_untracked(|text| point::registers_of(chosen, text)) {
            for (slot, text) in point::texts(&registers) {
                self.slot(slot).set(text);
            }
        }
    }

    /// Puts what the registers hold into the point's value, if it is one.
    pub(super) fn read_value(&self, draft: &Draft) {
        let Some((chosen, _)) = self.point() else { return };
        let registers = point::registers_in(draft, chosen);
        if let Some(text) = registers.and_then(|registers| point::text_of(chosen, &registers)) {
            self.value.set(text);
        }
    }

    /// What is built.
    pub(super) fn way(&self) -> Way {
        self.way.with(|way| match way.as_str() {
            "response" => Way::Response,
            "exception" => Way::Exception,
            _ => Way::Request,
        })
    }

    /// What the fields make.
    pub(super) fn draft(&self) -> Draft {
        self.draft_of(self.way())
    }

    /// What the fields would make as another kind of message.
    pub(super) fn draft_of(&self, way: Way) -> Draft {
        let function = self.function.with(|code| u8::from_str_radix(code, 16).ok());
        Draft::of(way, function, &|slot| self.slot(slot).get())
    }

    /// Whether the check is to be wrong.
    pub(super) fn is_spoiled(&self) -> bool {
        self.wrong_check.with(|text| !text.is_empty())
    }

    /// The line that the times are those of: the format of the connection's settings at the chosen rate.
    pub(super) fn line(&self) -> LineSettings {
        let line = self.set_line.unwrap_or_else(|| self.device().line());
        LineSettings { baud: self.baud.with(|baud| parse_baud(baud)).unwrap_or(line.baud), ..line }
    }
}
