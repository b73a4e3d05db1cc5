//! The digest of a data set.

use std::fmt::Write;

use sha2::{Digest as _, Sha256};

/// SHA-256 of the SHA-256 of all blocks: blocks are hashed where they are made, and the file as a whole
/// has one value that no format changes.
#[derive(Clone, Default)]
pub struct Digest(Sha256);

impl Digest {
    /// The digest of a block: of the bytes of its arrays, one after the other.
    pub fn of_block(arrays: &[impl AsRef<[u8]>]) -> [u8; 32] {
        let mut hash = Sha256::new();
        arrays.iter().for_each(|array| hash.update(array.as_ref()));
        hash.finalize().into()
    }

    /// Adds the next block.
    pub fn add(&mut self, block: &[u8; 32]) {
        self.0.update(block);
    }

    /// The digest in hexadecimal digits.
    pub fn hex(self) -> String {
        hex(&self.0.finalize())
    }

    /// SHA-256 of a text.
    pub fn of_text(text: &str) -> String {
        hex(&Sha256::digest(text))
    }
}

/// A key that tells runs apart, by the document that their writers begin with.
pub fn run_key(document: &str) -> [u8; 32] {
    Sha256::digest(document).into()
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_digest_of_blocks_is_that_of_their_digests() {
        let block = Digest::of_block(&[b"ab".as_slice(), b"c"]);
        // SHA-256 of "abc" is the example of FIPS 180-4.
        assert_eq!(hex(&block), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        let mut digest = Digest::default();
        digest.add(&block);
        assert_eq!(digest.hex(), "4f8b42c22dd3729b519ba6f68d2da7cc5b2d606d05daed5ad5128cc03e6c6358");
        assert_eq!(Digest::of_text("abc"), hex(&block));
    }
}
