//! The two checks of the serial line: CRC-16 in RTU mode, LRC in ASCII mode.

use crc::{CRC_16_MODBUS, Crc};

/// The small table: it costs 512 bytes of a page's download.
const CRC: Crc<u16> = Crc::<u16>::new(&CRC_16_MODBUS);

/// CRC-16 over unit id and PDU; sent low byte first (serial line guide, clause 2.5.1.2).
pub fn crc16(bytes: &[u8]) -> u16 {
    CRC.checksum(bytes)
}

/// LRC over the decoded unit id and PDU: the two's complement of their sum (serial line guide, clause 2.5.2.2).
pub fn lrc(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte)).wrapping_neg()
}
