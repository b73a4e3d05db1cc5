//! Expressions (WGSL, section 8). Operators bind as in C, which WGSL takes where parentheses say the same; where they
//! are missing, the grammar refuses the text, and this says so.

use super::super::ast::{BinaryOp, Callee, ExprId, ExprKind, Ident, Literal, UnaryOp};
use super::super::types::ScalarType;
use super::super::{TokenKind, errors};
use super::nowhere;
use super::parser::{DEEPEST, Parser, Read, Unread};
use base::diagnostic::message;
use base::text::Span;

/// Operators by how they bind, the loosest first.
const LEVELS: &[&[(&str, BinaryOp)]] = &[
    &[("||", BinaryOp::Or)],
    &[("&&", BinaryOp::And)],
    &[("|", BinaryOp::BitOr)],
    &[("^", BinaryOp::BitXor)],
    &[("&", BinaryOp::BitAnd)],
    &[("==", BinaryOp::Equal), ("!=", BinaryOp::NotEqual)],
    &[("<", BinaryOp::Less), (">", BinaryOp::Greater), ("<=", BinaryOp::LessEqual), (">=", BinaryOp::GreaterEqual)],
    &[("<<", BinaryOp::Shl), (">>", BinaryOp::Shr)],
    &[("+", BinaryOp::Add), ("-", BinaryOp::Sub)],
    &[("*", BinaryOp::Mul), ("/", BinaryOp::Div), ("%", BinaryOp::Rem)],
];

/// The level of sums, which arguments of types are.
const SUM: usize = 8;

/// Groups of operators that the grammar tells apart.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Group {
    Logic,
    Bits,
    Comparison,
    Shift,
    Arithmetic,
}

fn group(op: BinaryOp) -> Group {
    match op {
        BinaryOp::And | BinaryOp::Or | BinaryOp::Xor => Group::Logic,
        BinaryOp::BitAnd | BinaryOp::BitOr | BinaryOp::BitXor => Group::Bits,
        BinaryOp::Equal
        | BinaryOp::NotEqual
        | BinaryOp::Less
        | BinaryOp::Greater
        | BinaryOp::LessEqual
        | BinaryOp::GreaterEqual => Group::Comparison,
        BinaryOp::Shl | BinaryOp::Shr => Group::Shift,
        BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div | BinaryOp::Rem => Group::Arithmetic,
    }
}

/// True where `inner` may be an operand of `outer` without parentheses (WGSL, section 8.19).
fn may_stand(outer: BinaryOp, inner: BinaryOp, left: bool) -> bool {
    match (group(outer), group(inner)) {
        (Group::Logic | Group::Bits, a) if a == group(outer) => left && outer == inner,
        (Group::Logic, inner) => inner != Group::Bits,
        (Group::Bits | Group::Shift, _) => false,
        (Group::Comparison, inner) => matches!(inner, Group::Arithmetic | Group::Shift),
        (Group::Arithmetic, inner) => inner == Group::Arithmetic,
    }
}

impl Parser<'_> {
    /// Reads an expression with all of its operators.
    pub(super) fn expression(&mut self) -> Read<ExprId> {
        self.deeper(|p| p.level(0))
    }

    /// A sum, at most.
    pub(super) fn sum(&mut self) -> Read<ExprId> {
        self.deeper(|p| p.level(SUM))
    }

    fn level(&mut self, level: usize) -> Read<ExprId> {
        let Some(operators) = LEVELS.get(level) else { return self.unary() };
        let mut left = self.level(level + 1)?;
        while let Some((_, op)) = operators.iter().find(|(text, _)| *text == self.peek()) {
            let op_span = self.advance();
            let right = self.level(level + 1)?;
            self.operand(*op, left, true);
            self.operand(*op, right, false);
            let span = self.out.arena.get(left).span.to(self.out.arena.get(right).span);
            left = self.add(ExprKind::Binary { op: *op, op_span, left, right }, span);
            if self.out.arena.depth(left) > DEEPEST {
                let message =
                    message!("more than {DEEPEST} operators in a row", "演算子が {DEEPEST} を超えて続いています");
                let help = message!("split it into several statements", "複数の文に分けてください");
                self.report(errors::TOO_DEEP, op_span, message, help);
                return Err(Unread);
            }
        }
        Ok(left)
    }

    /// Reports an operand that needs parentheses.
    fn operand(&mut self, outer: BinaryOp, id: ExprId, left: bool) {
        let ExprKind::Binary { op, .. } = self.out.arena.get(id).kind else { return };
        if may_stand(outer, op, left) {
            return;
        }
        let (a, b) = (op.text(), outer.text());
        let span = self.out.arena.get(id).span;
        let inner = &self.text[span.range()];
        let message =
            message!("`{a}` and `{b}` stand together without parentheses", "`{a}` と `{b}` が括弧なしで並んでいます");
        let help = message!(
            "WGSL does not say which comes first: write `({inner})`, or put the parentheses where they are meant",
            "WGSL はどちらを先に計算するか定めていません。`({inner})` とするか、意図した所に括弧を付けてください"
        );
        // What is meant is open, but not how the text goes on.
        self.report(errors::PARENTHESES, span, message, help);
    }

    fn unary(&mut self) -> Read<ExprId> {
        let op = match self.peek() {
            "-" => UnaryOp::Minus,
            "!" => UnaryOp::Not,
            "~" => UnaryOp::Complement,
            "&" | "*" => {
                let address = self.peek() == "&";
                let start = self.advance();
                let inner = self.deeper(Self::unary)?;
                let span = start.to(self.before());
                let id = self.add(ExprKind::Paren(inner), span);
                if address {
                    self.out.addresses.insert(id);
                }
                return Ok(id);
            }
            // `--x` is two signs, which the lexer reads as one token.
            "--" => {
                let start = self.advance();
                let operand = self.deeper(Self::unary)?;
                let end = self.before();
                let second = Span::new(start.start + 1, start.end);
                let inner = ExprKind::Unary { op: UnaryOp::Minus, op_span: second, operand };
                let operand = self.add(inner, second.to(end));
                let outer =
                    ExprKind::Unary { op: UnaryOp::Minus, op_span: Span::new(start.start, start.start + 1), operand };
                return Ok(self.add(outer, start.to(end)));
            }
            _ => return self.postfix(),
        };
        let op_span = self.advance();
        let operand = self.deeper(Self::unary)?;
        let span = op_span.to(self.before());
        Ok(self.add(ExprKind::Unary { op, op_span, operand }, span))
    }

    /// A primary expression with what stands behind it.
    pub(super) fn postfix(&mut self) -> Read<ExprId> {
        let mut base = self.primary()?;
        loop {
            let start = self.out.arena.get(base).span;
            if self.take("[").is_some() {
                let index = self.expression()?;
                let span = start.to(self.expect("]")?);
                base = self.add(ExprKind::Index { base, index }, span);
            } else if self.take(".").is_some() {
                let field = self.ident()?;
                let span = start.to(field.span);
                base = self.add(ExprKind::Field { base, field }, span);
            } else {
                return Ok(base);
            }
            if self.out.arena.depth(base) > DEEPEST {
                return Err(self.expected("fewer levels"));
            }
        }
    }

    fn primary(&mut self) -> Read<ExprId> {
        let start = self.span();
        match self.kind() {
            Some(TokenKind::Number) => {
                let text = self.peek();
                self.advance();
                let literal = literal(text).unwrap_or_else(|| {
                    let message =
                        message!("`{text}` is no number that WGSL has", "`{text}` は WGSL の数値ではありません");
                    let help = message!("suffixes are `i`, `u`, `f` and `h`", "接尾辞は `i`、`u`、`f`、`h` です");
                    self.report(errors::LITERAL, start, message, help);
                    Literal::Int(0)
                });
                if has_suffix(text) {
                    self.out.suffixed.insert(start.start);
                }
                Ok(self.add(ExprKind::Literal(literal), start))
            }
            Some(TokenKind::Word) => {
                let word = self.peek();
                if word == "true" || word == "false" {
                    self.advance();
                    return Ok(self.add(ExprKind::Literal(Literal::Bool(word == "true")), start));
                }
                let name = self.ident()?;
                let ty = if self.opens_template() { Some(self.arguments(name.clone())?) } else { None };
                if self.peek() == "(" {
                    return self.call(name, ty);
                }
                let span = start.to(self.before());
                Ok(self.add(ExprKind::Name(name.name), span))
            }
            _ if self.take("(").is_some() => {
                let inner = self.expression()?;
                let span = start.to(self.expect(")")?);
                Ok(self.add(ExprKind::Paren(inner), span))
            }
            _ => Err(self.expected("an expression")),
        }
    }

    fn call(&mut self, name: Ident, ty: Option<super::syntax::TypeSyntax>) -> Read<ExprId> {
        self.expect("(")?;
        let mut args = Vec::new();
        while !matches!(self.peek(), ")" | "") {
            args.push(self.expression()?);
            if self.take(",").is_none() {
                break;
            }
        }
        let span = name.span.to(self.expect(")")?);
        // The ends that `saturate` has by itself.
        if name.name == "saturate" && args.len() == 1 {
            args.extend([0.0, 1.0].map(|end| self.add(ExprKind::Literal(Literal::Float(end)), nowhere(span))));
        }
        let builds = super::types::is_type(&name.name) && name.name != "bitcast";
        let ty = ty.or_else(|| {
            builds.then(|| super::syntax::TypeSyntax { name: name.clone(), args: Vec::new(), span: name.span })
        });
        let callee = match &ty {
            Some(ty) if builds => Callee::Type(self.specifier(Some(ty), name.span)),
            _ => Callee::Name(name),
        };
        let id = self.add(ExprKind::Call { callee, args }, span);
        if let Some(ty) = ty {
            self.out.constructed.insert(id, ty);
        }
        Ok(id)
    }
}

/// The value of a number. Without a suffix it is abstract, which the text says and not the value.
fn literal(text: &str) -> Option<Literal> {
    // `li`, `lu` and `lf` are what naga has of 64 bits.
    if let Some((digits, suffix @ ("i" | "u" | "f"))) = text.split_once('l') {
        let ty = match suffix {
            "i" => ScalarType::Int64,
            "u" => ScalarType::Uint64,
            _ => return literal(digits),
        };
        let value = hexadecimals(digits).map_or_else(|| digits.parse(), |digits| u64::from_str_radix(digits, 16));
        return value.ok().map(|value| Literal::Sized(value, ty));
    }
    let hex = hexadecimals(text);
    let floating = match hex {
        Some(hex) => hex.contains(['.', 'p', 'P']),
        None => text.contains(['.', 'e', 'E']) || text.ends_with(['f', 'h']),
    };
    if floating {
        let digits = text.trim_end_matches(['f', 'h']);
        return match hex {
            Some(_) => hexadecimal(&digits[2..]).map(Literal::Float),
            None => digits.parse().ok().map(Literal::Float),
        };
    }
    let (digits, radix) = hex.map_or((text, 10), |h| (h, 16));
    let value = |digits: &str| i64::from_str_radix(digits, radix).ok();
    if let Some(digits) = digits.strip_suffix('u') {
        return u32::try_from(value(digits)?).ok().map(Literal::Uint);
    }
    let signed = digits.strip_suffix('i');
    let value = value(signed.unwrap_or(digits))?;
    match i32::try_from(value) {
        Ok(value) => Some(Literal::Int(value)),
        // An abstract integer has 64 bits; as `u32` is how one that does not fit `i32` is used.
        Err(_) if signed.is_none() =>
        {
            #[expect(clippy::cast_precision_loss, reason = "no value of 32 bits is that large")]
            Some(u32::try_from(value).map_or(Literal::Float(value as f64), Literal::Uint))
        }
        Err(_) => None,
    }
}

/// A hexadecimal number without its prefix.
fn hexadecimals(text: &str) -> Option<&str> {
    text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"))
}

/// True for a number that says its type.
fn has_suffix(text: &str) -> bool {
    let hex = text.starts_with("0x") || text.starts_with("0X");
    text.ends_with(['i', 'u', 'h']) || (text.ends_with('f') && (!hex || text.contains(['p', 'P'])))
}

/// `1.8p3` without the prefix.
fn hexadecimal(text: &str) -> Option<f64> {
    let (digits, exponent) = text.split_once(['p', 'P']).unwrap_or((text, "0"));
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let mut value = 0.0;
    for c in whole.chars().chain(fraction.chars()) {
        value = value * 16.0 + f64::from(c.to_digit(16)?);
    }
    let scale: i32 = exponent.parse().ok()?;
    Some(value * 2f64.powi(scale) * 16f64.powi(-i32::try_from(fraction.len()).ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_values_of_their_digits() {
        assert_eq!(literal("12"), Some(Literal::Int(12)));
        assert_eq!(literal("0xffu"), Some(Literal::Uint(255)));
        assert_eq!(literal("0x1.8p1"), Some(Literal::Float(3.0)));
        assert_eq!(literal("1f"), Some(Literal::Float(1.0)));
        assert_eq!(literal("1.5e-1h"), Some(Literal::Float(0.15)));
        assert_eq!(literal("4294967295"), Some(Literal::Uint(u32::MAX)));
        assert_eq!((literal("4294967296u"), literal("3000000000i")), (None, None));
    }
}
