//! Kernels as words, to hand them to another process: the modules of naga as they are, with every bit of their
//! constants, and without the places of the author's text, which no lane asks for.
//!
//! naga can write its modules by serde. That feature would have half of all libraries compiled with serde, and text
//! has no NaN; these lists are checked by the compiler: a new variant of naga is an error here.

mod basic;
mod ir;
mod job;

pub use basic::{Reader, Wire, Writer};

/// Lists the variants of an enum, or the fields of a structure, by which its values are written and read. Variants
/// behind `refused` are named, and not written.
macro_rules! wire {
    (enum $name:ty {
        $($variant:ident $( ( $($item:ident),* ) )? $( { $($field:ident),* } )?),* $(,)?
    } refused { $($refused:ident),* $(,)? }) => {
        impl Wire for $name {
            fn put(&self, to: &mut Writer) {
                match self {
                    $(Self::$variant $( ( $($item),* ) )? $( { $($field),* } )? => {
                        to.word(tag(stringify!($variant)));
                        $( $( $item.put(to); )* )?
                        $( $( $field.put(to); )* )?
                    })*
                    $(Self::$refused { .. } => to.refuse(stringify!($refused)),)*
                }
            }

            fn take(from: &mut Reader<'_>) -> Option<Self> {
                let found = from.word()?;
                $(if found == tag(stringify!($variant)) {
                    return Some(Self::$variant
                        $( ( $( { let $item = Wire::take(from)?; $item } ),* ) )?
                        $( { $( $field: Wire::take(from)? ),* } )?);
                })*
                None
            }
        }
    };
    (enum $name:ty { $($list:tt)* }) => { wire! { enum $name { $($list)* } refused {} } };
    (struct $name:ty { $($field:ident),* $(,)? }) => {
        impl Wire for $name {
            fn put(&self, to: &mut Writer) {
                let Self { $($field),* } = self;
                $( $field.put(to); )*
            }

            fn take(from: &mut Reader<'_>) -> Option<Self> {
                Some(Self { $($field: Wire::take(from)?),* })
            }
        }
    };
}
use wire;

/// The word that stands for a variant.
const fn tag(name: &str) -> u32 {
    let (bytes, mut hash, mut at) = (name.as_bytes(), 0x811c_9dc5_u32, 0);
    while at < bytes.len() {
        hash = (hash ^ bytes[at] as u32).wrapping_mul(0x0100_0193);
        at += 1;
    }
    hash
}
