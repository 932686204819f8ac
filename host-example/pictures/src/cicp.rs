//! Code points of video and PNG for colours: primaries, transfer and matrix by their numbers.
//!
//! Source: Rec. ITU-T H.273, tables 2 to 4.

use crate::meaning::Matrix;
use crate::primaries::{Chromaticities, P3, REC709, REC2020, same};
use crate::transfer::Transfer;

/// Primaries by their numbers.
const PRIMARIES: [(u8, Chromaticities); 9] = [
    (1, REC709),
    (4, [0.67, 0.33, 0.21, 0.71, 0.14, 0.08, 0.310, 0.316]),
    (5, [0.64, 0.33, 0.29, 0.60, 0.15, 0.06, 0.3127, 0.3290]),
    (6, [0.630, 0.340, 0.310, 0.595, 0.155, 0.070, 0.3127, 0.3290]),
    (7, [0.630, 0.340, 0.310, 0.595, 0.155, 0.070, 0.3127, 0.3290]),
    (9, REC2020),
    (11, [0.680, 0.320, 0.265, 0.690, 0.150, 0.060, 0.314, 0.351]),
    (12, P3),
    (22, [0.630, 0.340, 0.295, 0.605, 0.155, 0.077, 0.3127, 0.3290]),
];

/// The primaries of this number; nothing for those that are not said or not known.
pub fn primaries(code: u8) -> Option<Chromaticities> {
    PRIMARIES.iter().find(|(known, _)| *known == code).map(|(_, primaries)| *primaries)
}

/// The number of primaries.
pub fn code_of_primaries(primaries: Chromaticities) -> Option<u8> {
    PRIMARIES.iter().find(|(_, known)| same(*known, primaries)).map(|(code, _)| *code)
}

/// The transfer of this number; nothing for those that are not said or not known.
pub fn transfer(code: u8) -> Option<Transfer> {
    Some(match code {
        1 | 6 | 14 | 15 => Transfer::Rec709,
        4 => Transfer::Gamma(2.2),
        5 => Transfer::Gamma(2.8),
        8 => Transfer::Linear,
        13 => Transfer::Srgb,
        16 => Transfer::Pq,
        18 => Transfer::Hlg,
        _ => return None,
    })
}

/// The number of a transfer.
pub fn code_of_transfer(transfer: &Transfer) -> Option<u8> {
    (1..=18).find(|code| self::transfer(*code).as_ref() == Some(transfer))
}

/// The matrix of this number; nothing for those that are not said or not known.
pub fn matrix(code: u8) -> Option<Matrix> {
    Some(match code {
        0 => Matrix::Rgb,
        1 => Matrix::Bt709,
        5 | 6 => Matrix::Bt601,
        7 => Matrix::Smpte240m,
        9 => Matrix::Bt2020,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_lead_there_and_back() {
        for (code, known) in PRIMARIES {
            // Two numbers stand for the same.
            assert_eq!(primaries(code_of_primaries(known).unwrap()), Some(known), "{code}");
        }
        for code in [1, 4, 5, 8, 13, 16, 18] {
            assert_eq!(code_of_transfer(&transfer(code).unwrap()), Some(code));
        }
        assert_eq!((primaries(2), transfer(2), matrix(2)), (None, None, None));
        assert_eq!(code_of_transfer(&Transfer::Gamma(1.8)), None);
    }
}
