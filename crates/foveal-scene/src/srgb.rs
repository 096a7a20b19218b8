//! The sRGB transfer function, also as tables (IEC 61966-2-1).

use std::sync::OnceLock;

/// Light from 0 to 1 for a code from 0 to 1.
pub(crate) fn decode(code: f64) -> f64 {
    if code <= 0.04045 {
        code / 12.92
    } else {
        ((code + 0.055) / 1.055).powf(2.4)
    }
}

/// 16-bit light for each 8-bit code.
pub(crate) fn to_linear16() -> &'static [u16; 256] {
    static TABLE: OnceLock<[u16; 256]> = OnceLock::new();
    TABLE.get_or_init(|| {
        std::array::from_fn(|i| (decode(i as f64 / 255.0) * 65535.0).round() as u16)
    })
}

/// Light from 0 to 1 for an 8-bit code.
pub(crate) fn to_linear(code: u8) -> f32 {
    f32::from(to_linear16()[code as usize]) / 65535.0
}

/// The nearest 8-bit code for each 16-bit light.
pub(crate) fn from_linear16() -> &'static [u8; 65536] {
    static TABLE: OnceLock<Box<[u8; 65536]>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let mut table = Box::new([0; 65536]);
        let mut code = 0usize;
        for (light, entry) in table.iter_mut().enumerate() {
            // Codes change halfway between them, in code space.
            let border = |code: usize| decode((code as f64 + 0.5) / 255.0) * 65535.0;
            while code < 255 && light as f64 >= border(code) {
                code += 1;
            }
            *entry = code as u8;
        }
        table
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_survives_the_round_trip() {
        for code in 0..=255u8 {
            let light = to_linear16()[code as usize];
            assert_eq!(from_linear16()[light as usize], code);
        }
        assert_eq!(to_linear16()[255], 65535);
        // Half the light is code 188.
        assert_eq!(from_linear16()[32768], 188);
    }
}
