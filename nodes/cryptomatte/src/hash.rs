//! The id of a name: MurmurHash3 for 32 bits (A. Appleby, public domain), as the bits of a float that is a usual number.

/// Bit of the exponent that is turned where a hash would be infinite, no number, zero or denormal.
const LOWEST_EXPONENT: u32 = 1 << 23;

/// The id of a name, as bits of the float that files hold; 0x00800000 for the empty name, which is nothing.
pub fn id(name: &str) -> u32 {
    let hash = murmur3(name.as_bytes());
    match (hash >> 23) & 0xff {
        0 | 0xff => hash ^ LOWEST_EXPONENT,
        _ => hash,
    }
}

/// `MurmurHash3_x86_32` with the seed 0.
fn murmur3(bytes: &[u8]) -> u32 {
    let scrambled = |block: u32| block.wrapping_mul(0xcc9e_2d51).rotate_left(15).wrapping_mul(0x1b87_3593);
    let (blocks, tail) = bytes.as_chunks::<4>();
    let mut hash = blocks.iter().fold(0u32, |hash, block| {
        let hash = hash ^ scrambled(u32::from_le_bytes(*block));
        hash.rotate_left(13).wrapping_mul(5).wrapping_add(0xe654_6b64)
    });
    let last = tail.iter().rev().fold(0u32, |word, byte| word << 8 | u32::from(*byte));
    hash ^= scrambled(last);
    // Lengths count modulo 2^32.
    hash ^= bytes.len() as u32;
    hash = (hash ^ hash >> 16).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35);
    hash ^ hash >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_those_of_published_files() {
        for (name, expected) in [
            ("bunny", 0x1385_1a76),
            ("default", 0x42c9_679f),
            ("ball_asset", 0x79b6_2f5e),
            ("/shop/mat3/standard_surface1", 0x0247_c000),
            ("name containing a \"quote\"  ", 0xaf8b_fa09),
            ("name, with, comma", 0x62fa_4db8),
            ("равнина", 0x9623_511e),
            // Hashes whose exponents are turned, 0x005694cc and 0xffb21574.
            ("thing119", 0x00d6_94cc),
            ("thing479", 0xff32_1574),
        ] {
            assert_eq!(id(name), expected, "{name}");
        }
    }

    #[test]
    fn ids_are_usual_numbers() {
        assert_eq!(id(""), LOWEST_EXPONENT);
        let mut turned = 0;
        for number in 0..20_000 {
            let name = number.to_string();
            assert!(f32::from_bits(id(&name)).is_normal(), "{name}");
            turned += u32::from(id(&name) != murmur3(name.as_bytes()));
        }
        assert!(turned > 50, "{turned}");
    }
}
