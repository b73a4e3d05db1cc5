//! Structures that are too large to be read. Whoever looks through a type looks at each member of each of its members, so
//! that a text of thirty lines whose structures double has more members than a machine can visit.
//!
//! A type never exceeds these limits, so that code that looks through a type may recurse.

use super::types::{StructField, Type};

/// Members of a structure, together with those of its members, that are read. An array counts as one of its elements.
const MOST_MEMBERS: u32 = 1 << 14;
/// Levels of structures and arrays in each other that are read.
const MOST_LEVELS: u32 = 128;

/// Why a structure of these members is not read; its members then get the type of an error, so that nothing follows from
/// them. No type is larger than the limits as long as every structure goes through here.
pub(crate) fn too_large(fields: &mut [StructField]) -> Option<String> {
    let deepest = fields.iter().map(|field| levels(&field.ty)).max().unwrap_or(0);
    let why = if deepest >= MOST_LEVELS {
        format!("types are nested in this structure in more than {MOST_LEVELS} levels")
    } else if members_of(fields) > MOST_MEMBERS {
        format!("this structure has more than {MOST_MEMBERS} members with those of its members")
    } else {
        return None;
    };
    fields.iter_mut().for_each(|field| field.ty = Type::Error);
    Some(why)
}

fn members_of(fields: &[StructField]) -> u32 {
    let mut all = 0;
    for field in fields {
        all += members(&field.ty);
        if all > MOST_MEMBERS {
            break;
        }
    }
    all
}

fn members(ty: &Type) -> u32 {
    match ty {
        Type::Struct(s) => members_of(&s.fields).max(1),
        Type::Array(element, _) => members(element),
        Type::Error | Type::Void | Type::Scalar(_) | Type::Vector(..) | Type::Matrix(..) | Type::Opaque(_) => 1,
    }
}

fn levels(ty: &Type) -> u32 {
    match ty {
        Type::Struct(s) => 1 + s.fields.iter().map(|field| levels(&field.ty)).max().unwrap_or(0),
        Type::Array(element, _) => 1 + levels(element),
        Type::Error | Type::Void | Type::Scalar(_) | Type::Vector(..) | Type::Matrix(..) | Type::Opaque(_) => 0,
    }
}
