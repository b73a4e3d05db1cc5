//! A short name for a line that stays when the line moves or is indented anew.

/// Hash of a line without regard to blanks: FNV-1a of 64 bits, the same on every machine and in every
/// version. Runs of blanks count as one, and those at the ends not at all.
pub fn fingerprint(line: &str) -> u64 {
    const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0000_0100_0000_01b3;
    let mut hash = OFFSET;
    for (at, word) in line.split_whitespace().enumerate() {
        let blank: &[u8] = if at == 0 { b"" } else { b" " };
        for &byte in blank.iter().chain(word.as_bytes()) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(PRIME);
        }
    }
    hash
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values_of_the_hash() {
        assert_eq!(fingerprint(""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fingerprint("a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fingerprint("foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn blanks_do_not_matter_and_words_do() {
        assert_eq!(fingerprint("  float  x =\t1.0;\r"), fingerprint("float x = 1.0;"));
        assert_ne!(fingerprint("float x = 1.0;"), fingerprint("floatx = 1.0;"));
        assert_ne!(fingerprint("float x = 1.0;"), fingerprint("float x = 1.1;"));
    }
}
