//! Names of USB serial adapters, as their makers print them on the chips.

/// The maker's name for a USB vendor and product id, if it is a common one.
pub(crate) fn name(vendor: u16, product: u16) -> Option<&'static str> {
    Some(match (vendor, product) {
        (0x1A86, 0x7523) => "CH340",
        (0x1A86, 0x7522) => "CH340K",
        (0x1A86, 0x5523) => "CH341",
        (0x1A86, 0x55D2) => "CH342",
        (0x1A86, 0x55D3) => "CH343",
        (0x1A86, 0x55D4) => "CH9102",
        (0x1A86, 0x55D5) => "CH344",
        (0x1A86, 0x55D8) => "CH9101",
        (0x1A86, _) => "WCH",
        (0x0403, 0x6001) => "FTDI FT232R",
        (0x0403, 0x6010) => "FTDI FT2232",
        (0x0403, 0x6011) => "FTDI FT4232",
        (0x0403, 0x6014) => "FTDI FT232H",
        (0x0403, 0x6015) => "FTDI FT-X",
        (0x0403, _) => "FTDI",
        (0x10C4, 0xEA60) => "CP210x",
        (0x10C4, 0xEA61) => "CP210x (EA61)",
        (0x10C4, 0xEA70) => "CP2105",
        (0x10C4, 0xEA71) => "CP2108",
        (0x067B, 0x2303) => "PL2303",
        (0x067B, 0x2304) => "PL2303HXN",
        (0x067B, 0x23A3 | 0x23B3 | 0x23C3 | 0x23D3 | 0x23E3 | 0x23F3) => "PL2303G",
        (0x067B, _) => "Prolific",
        (0x9710, 0x7720 | 0x7840 | 0x7843) => "MosChip",
        (0x04D8, 0x00DD) => "MCP2221",
        (0x04D8, 0x00DF) => "MCP2200",
        (0x2341 | 0x2A03, _) => "Arduino",
        (0x303A, _) => "Espressif",
        (0x2E8A, _) => "Raspberry Pi Pico",
        (0x0483, 0x5740) => "STM32 USB serial",
        _ => return None,
    })
}

/// The name to show: the chip's, or the bare USB ids.
pub(crate) fn title(vendor: u16, product: u16) -> String {
    name(vendor, product).map_or_else(|| format!("USB {vendor:04x}:{product:04x}"), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_adapters_have_names_and_others_their_ids() {
        assert_eq!(title(0x1A86, 0x7523), "CH340");
        assert_eq!(title(0x10C4, 0xEA60), "CP210x");
        assert_eq!(title(0x0403, 0x1234), "FTDI");
        assert_eq!(title(0x067B, 0x23A3), "PL2303G");
        assert_eq!(title(0x1234, 0x0ABC), "USB 1234:0abc");
    }
}
