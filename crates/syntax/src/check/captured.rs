//! What transform feedback captures: buffers, offsets and strides (GLSL 4.60 specification, section 4.4.2.1), and the
//! streams of a geometry stage.

use std::collections::HashMap;

use super::super::ast::{LayoutEntry, Qualifiers};
use super::super::errors;
use super::super::interface::{Block, Interface, Storage};
use super::super::types::{ArraySize, Type};
use super::Checker;
use base::diagnostic::message;
use base::text::Span;

/// What is known of the buffers so far.
#[derive(Default)]
struct Buffers {
    /// The buffer of what states none.
    default: i64,
    /// Stride of each.
    strides: HashMap<i64, i64>,
    /// Bytes that are taken: buffer, first, behind the last, place.
    taken: Vec<(i64, i64, i64, Span)>,
}

/// Bytes that a value takes in a buffer, and whether a `double` is in it; none where that is not known.
fn size(ty: &Type) -> Option<(i64, bool)> {
    Some(match ty {
        Type::Scalar(s) | Type::Vector(s, _) | Type::Matrix(s, ..) => {
            let double = s.bits() == 64;
            (i64::try_from(ty.components()?).ok()? * i64::from(s.bits() / 8), double)
        }
        Type::Array(element, ArraySize::Known(n)) => {
            let (bytes, double) = size(element)?;
            (bytes.checked_mul(i64::from(*n))?, double)
        }
        Type::Struct(s) => {
            let (mut at, mut any) = (0i64, false);
            for field in &s.fields {
                let (bytes, double) = size(&field.ty)?;
                at = if double { at.checked_add(7)? / 8 * 8 } else { at };
                at = at.checked_add(bytes)?;
                any |= double;
            }
            (if any { at.checked_add(7)? / 8 * 8 } else { at }, any)
        }
        Type::Array(..) | Type::Void | Type::Error | Type::Opaque(_) => return None,
    })
}

impl Checker<'_> {
    /// Checks what is captured, in the order of the text.
    pub(super) fn captured(&mut self, interface: &Interface) {
        let layouts = interface.stage_layouts.iter().filter(|l| l.storage == Some(Storage::Out));
        let mut all: Vec<(usize, Option<usize>, Option<usize>)> = Vec::new();
        for (k, v) in interface.outputs.iter().enumerate() {
            all.push((v.name_span.start, Some(k), None));
        }
        for (k, b) in interface.blocks.iter().enumerate().filter(|(_, b)| b.storage == Storage::Out) {
            all.push((b.span.start, None, Some(k)));
        }
        let mut stated: Vec<_> = layouts.map(|l| (l.span.start, l)).collect();
        stated.reverse();
        all.sort_by_key(|a| a.0);
        let (mut buffers, mut stream) = (Buffers::default(), 0);
        for (at, variable, block) in all.into_iter().chain([(usize::MAX, None, None)]) {
            while let Some((_, layout)) = stated.pop_if(|(start, _)| *start < at) {
                buffers.default = self.entry_number(&layout.qualifiers, "xfb_buffer").unwrap_or(buffers.default);
                stream = self.entry_number(&layout.qualifiers, "stream").unwrap_or(stream);
                self.stride(&layout.qualifiers, buffers.default, &mut buffers);
            }
            if let Some(v) = variable.map(|k| &interface.outputs[k]) {
                let buffer = self.entry_number(&v.qualifiers, "xfb_buffer").unwrap_or(buffers.default);
                self.stride(&v.qualifiers, buffer, &mut buffers);
                if let Some(entry) = v.qualifiers.layout_entry("xfb_offset") {
                    self.capture(entry, &v.ty, (buffer, None), v.name_span, &mut buffers);
                }
            }
            if let Some(b) = block.map(|k| &interface.blocks[k]) {
                self.captured_block(b, stream, &mut buffers);
            }
        }
        for (buffer, _, end, span) in &buffers.taken {
            if buffers.strides.get(buffer).is_some_and(|stride| end > stride) {
                let message = message!("this is captured beyond `xfb_stride`", "`xfb_stride` を超えて取り込まれます");
                self.sink.error(
                    errors::LAYOUT,
                    *span,
                    message,
                    message!("ends at byte {end}", "{end} バイト目で終わります"),
                );
            }
        }
    }

    fn captured_block(&mut self, block: &Block, stream: i64, buffers: &mut Buffers) {
        for (key, default) in [("xfb_buffer", buffers.default), ("stream", stream)] {
            let own = self.entry_number(&block.qualifiers, key).unwrap_or(default);
            for member in &block.members {
                if let (Some(entry), Some(value)) =
                    (member.qualifiers.layout_entry(key), self.entry_number(&member.qualifiers, key))
                    && value != own
                {
                    self.layout_error(entry, message!("its block has {own}", "ブロックの値は {own} です"));
                }
            }
        }
        let buffer = self.entry_number(&block.qualifiers, "xfb_buffer").unwrap_or(buffers.default);
        self.stride(&block.qualifiers, buffer, buffers);
        let mut next = self.entry_number(&block.qualifiers, "xfb_offset");
        for member in &block.members {
            let own = member.qualifiers.layout_entry("xfb_offset");
            let Some(entry) = own.or_else(|| block.qualifiers.layout_entry("xfb_offset")) else { continue };
            next = self.entry_number(&member.qualifiers, "xfb_offset").or(next);
            let whole = own.is_none();
            next = self.capture(
                entry,
                &member.ty,
                (buffer, next.filter(|_| whole || own.is_some())),
                member.name.span,
                buffers,
            );
            if next.is_none() {
                return;
            }
        }
    }

    /// `xfb_stride` of a buffer, which is one number.
    fn stride(&mut self, qualifiers: &Qualifiers, buffer: i64, buffers: &mut Buffers) {
        let Some(entry) = qualifiers.layout_entry("xfb_stride") else { return };
        let Some(stride) = self.entry_number(qualifiers, "xfb_stride") else { return };
        if stride % 4 != 0 {
            return self.layout_error(entry, message!("it is a multiple of 4", "4 の倍数でなければなりません"));
        }
        if buffers.strides.insert(buffer, stride).is_some_and(|old| old != stride) {
            self.layout_error(
                entry,
                message!("buffer {buffer} has another stride", "バッファ {buffer} のストライドと違います"),
            );
        }
    }

    /// One value that is captured; gives the byte behind it.
    fn capture(
        &mut self,
        entry: &LayoutEntry,
        ty: &Type,
        (buffer, at): (i64, Option<i64>),
        span: Span,
        buffers: &mut Buffers,
    ) -> Option<i64> {
        let own = entry.value.and_then(|v| self.value_of(v)).and_then(super::super::fold::Const::as_integer);
        let mut at = at.or(own)?;
        if matches!(ty, Type::Array(_, ArraySize::Unsized)) {
            self.layout_error(
                entry,
                message!("an array without a size cannot be captured", "大きさのない配列は取り込めません"),
            );
            return None;
        }
        let (bytes, double) = size(ty)?;
        let unit = if double { 8 } else { 4 };
        if at % unit != 0 {
            if Some(at) == own {
                self.layout_error(
                    entry,
                    message!("the offset of `{ty}` is a multiple of {unit}", "`{ty}` のオフセットは {unit} の倍数です"),
                );
                return None;
            }
            at = (at + unit - 1) / unit * unit;
        }
        let end = at.checked_add(bytes)?;
        if buffers.taken.iter().any(|(b, from, to, _)| *b == buffer && at < *to && *from < end) {
            self.layout_error(
                entry,
                message!(
                    "these bytes of buffer {buffer} are taken already",
                    "バッファ {buffer} のこの範囲は既に使われています"
                ),
            );
        }
        buffers.taken.push((buffer, at, end, span));
        Some(end)
    }
}
