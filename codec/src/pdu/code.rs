use serde::{Deserialize, Serialize};

use super::PduError;

/// Why a device refuses (clause 7).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(from = "u8", into = "u8")]
pub enum ExceptionCode {
    /// 01
    IllegalFunction,
    /// 02
    IllegalDataAddress,
    /// 03
    IllegalDataValue,
    /// 04
    ServerDeviceFailure,
    /// 05
    Acknowledge,
    /// 06
    ServerDeviceBusy,
    /// 08
    MemoryParityError,
    /// 0A
    GatewayPathUnavailable,
    /// 0B
    GatewayTargetFailedToRespond,
    /// A code that the standard does not name.
    Other(u8),
}

impl From<u8> for ExceptionCode {
    fn from(code: u8) -> Self {
        match code {
            1 => Self::IllegalFunction,
            2 => Self::IllegalDataAddress,
            3 => Self::IllegalDataValue,
            4 => Self::ServerDeviceFailure,
            5 => Self::Acknowledge,
            6 => Self::ServerDeviceBusy,
            8 => Self::MemoryParityError,
            10 => Self::GatewayPathUnavailable,
            11 => Self::GatewayTargetFailedToRespond,
            other => Self::Other(other),
        }
    }
}

impl From<ExceptionCode> for u8 {
    fn from(code: ExceptionCode) -> Self {
        code.code()
    }
}

impl ExceptionCode {
    /// The code on the wire.
    pub const fn code(self) -> u8 {
        match self {
            Self::IllegalFunction => 1,
            Self::IllegalDataAddress => 2,
            Self::IllegalDataValue => 3,
            Self::ServerDeviceFailure => 4,
            Self::Acknowledge => 5,
            Self::ServerDeviceBusy => 6,
            Self::MemoryParityError => 8,
            Self::GatewayPathUnavailable => 10,
            Self::GatewayTargetFailedToRespond => 11,
            Self::Other(code) => code,
        }
    }
}

/// A diagnostic of function 08 (clause 6.8.1). Codes without a name here are reserved and stay what they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SubFunction(pub u16);

impl SubFunction {
    /// The device sends the data back.
    pub const RETURN_QUERY_DATA: Self = Self(0);
    /// The device restarts its port and leaves the listen only mode; data FF00 clears the event log too.
    pub const RESTART_COMMUNICATIONS: Self = Self(1);
    /// The device's diagnostic register.
    pub const RETURN_DIAGNOSTIC_REGISTER: Self = Self(2);
    /// Sets the last character of ASCII frames; the data's first byte is the character.
    pub const CHANGE_ASCII_DELIMITER: Self = Self(3);
    /// The device goes silent; this itself is not answered.
    pub const FORCE_LISTEN_ONLY: Self = Self(4);
    /// Clears the counters and the diagnostic register.
    pub const CLEAR_COUNTERS: Self = Self(10);
    /// Messages seen on the bus.
    pub const BUS_MESSAGE_COUNT: Self = Self(11);
    /// Messages with a wrong check.
    pub const BUS_COMMUNICATION_ERROR_COUNT: Self = Self(12);
    /// Exceptions answered.
    pub const BUS_EXCEPTION_ERROR_COUNT: Self = Self(13);
    /// Messages addressed to the device, broadcasts included.
    pub const SERVER_MESSAGE_COUNT: Self = Self(14);
    /// Messages that the device did not answer.
    pub const SERVER_NO_RESPONSE_COUNT: Self = Self(15);
    /// Negative acknowledgements answered.
    pub const SERVER_NAK_COUNT: Self = Self(16);
    /// Busy exceptions answered.
    pub const SERVER_BUSY_COUNT: Self = Self(17);
    /// Messages lost because characters came too fast.
    pub const BUS_CHARACTER_OVERRUN_COUNT: Self = Self(18);
    /// Clears the overrun counter and its flag.
    pub const CLEAR_OVERRUN_COUNTER: Self = Self(20);

    /// Whether the standard names it.
    pub const fn is_known(self) -> bool {
        matches!(self.0, 0..=4 | 10..=18 | 20)
    }

    /// Whether the normal reply is the request again.
    pub const fn is_echoed(self) -> bool {
        matches!(
            self,
            Self::RETURN_QUERY_DATA
                | Self::RESTART_COMMUNICATIONS
                | Self::CHANGE_ASCII_DELIMITER
                | Self::CLEAR_COUNTERS
                | Self::CLEAR_OVERRUN_COUNTER
        )
    }

    /// Whether it leaves the device as it is. Reserved codes may change something.
    pub const fn only_reads(self) -> bool {
        matches!(self.0, 0 | 2 | 11..=18)
    }
}

/// Which identification of a device is asked for (clause 6.21).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DeviceIdCode {
    /// 01: vendor, product, revision, as a stream.
    Basic,
    /// 02: basic and the standard's optional objects, as a stream.
    Regular,
    /// 03: regular and the vendor's own objects, as a stream.
    Extended,
    /// 04: one object.
    Specific,
}

impl DeviceIdCode {
    /// The code on the wire.
    pub const fn code(self) -> u8 {
        match self {
            Self::Basic => 1,
            Self::Regular => 2,
            Self::Extended => 3,
            Self::Specific => 4,
        }
    }
}

impl TryFrom<u8> for DeviceIdCode {
    type Error = PduError;

    fn try_from(code: u8) -> Result<Self, PduError> {
        match code {
            1 => Ok(Self::Basic),
            2 => Ok(Self::Regular),
            3 => Ok(Self::Extended),
            4 => Ok(Self::Specific),
            found => Err(PduError::DeviceIdCode { found }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_survive_their_trip() {
        for code in 0..=u8::MAX {
            assert_eq!(ExceptionCode::from(code).code(), code);
            match DeviceIdCode::try_from(code) {
                Ok(known) => assert!((1..=4).contains(&code) && known.code() == code),
                Err(error) => assert_eq!(error, PduError::DeviceIdCode { found: code }),
            }
        }
    }

    #[test]
    fn what_is_echoed_or_only_reads_has_a_name() {
        for code in 0..=40 {
            let sub_function = SubFunction(code);
            assert!(sub_function.is_known() || !(sub_function.is_echoed() || sub_function.only_reads()), "{code}");
        }
        assert_eq!((0..=u16::MAX).filter(|code| SubFunction(*code).is_known()).count(), 15);
    }
}
