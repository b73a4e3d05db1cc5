//! Conditions of `#if` and `#elif` (GLSL 4.60 specification, section 3.3).

use super::super::lexer::Lex;
use super::super::number;
use super::macros::Tok;
use crate::ast::Literal;
use base::text::{SourceFile, Span};

/// What is wrong with a condition, and where.
pub(crate) struct ConditionError {
    pub span: Span,
    pub message: String,
}

/// Evaluates expanded tokens. Names that are no macro count as 0, as in C.
pub(crate) fn evaluate(tokens: &[Tok], file: &SourceFile, end: Span) -> Result<bool, ConditionError> {
    let mut parser = Parser { tokens, file, end, at: 0, depth: 0 };
    let value = parser.binary(0)?;
    match parser.tokens.get(parser.at) {
        None => Ok(value != 0),
        Some(extra) => Err(ConditionError {
            span: extra.span,
            message: format!("`{}` is not expected in this condition", extra.text(file)),
        }),
    }
}

struct Parser<'a> {
    tokens: &'a [Tok],
    file: &'a SourceFile,
    end: Span,
    at: usize,
    depth: usize,
}

const DEEPEST: usize = 100;

impl Parser<'_> {
    fn peek(&self) -> Option<Lex> {
        self.tokens.get(self.at).map(|t| t.lex)
    }

    fn error<T>(&self, message: &str) -> Result<T, ConditionError> {
        let span = self.tokens.get(self.at).map_or(self.end, |t| t.span);
        Err(ConditionError { span, message: message.to_owned() })
    }

    fn binary(&mut self, least: u8) -> Result<i64, ConditionError> {
        let mut left = self.unary()?;
        while let Some((op, level)) = self.peek().and_then(|l| Some((l, level(l)?))) {
            if level < least {
                break;
            }
            self.at += 1;
            let right = self.binary(level + 1)?;
            left = match op {
                Lex::OrOr => i64::from(left != 0 || right != 0),
                Lex::AndAnd => i64::from(left != 0 && right != 0),
                Lex::Pipe => left | right,
                Lex::Caret => left ^ right,
                Lex::Amp => left & right,
                Lex::EqualEqual => i64::from(left == right),
                Lex::NotEqual => i64::from(left != right),
                Lex::Less => i64::from(left < right),
                Lex::Greater => i64::from(left > right),
                Lex::LessEqual => i64::from(left <= right),
                Lex::GreaterEqual => i64::from(left >= right),
                // Shifts by more than 63 have no value; 0 is what is left of any number.
                Lex::Shl => u32::try_from(right).ok().and_then(|r| left.checked_shl(r)).unwrap_or(0),
                Lex::Shr => u32::try_from(right).ok().and_then(|r| left.checked_shr(r)).unwrap_or(0),
                Lex::Plus => left.wrapping_add(right),
                Lex::Minus => left.wrapping_sub(right),
                Lex::Star => left.wrapping_mul(right),
                Lex::Slash | Lex::Percent if right == 0 => {
                    self.at -= 1;
                    return self.error("this condition divides by zero");
                }
                Lex::Slash => left.wrapping_div(right),
                _ => left.wrapping_rem(right),
            };
        }
        Ok(left)
    }

    fn unary(&mut self) -> Result<i64, ConditionError> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return self.error("this condition is nested too deeply");
        }
        let Some(tok) = self.tokens.get(self.at) else {
            return self.error("a value is missing at the end of this condition");
        };
        self.at += 1;
        let value = match tok.lex {
            Lex::Plus => self.unary()?,
            Lex::Minus => self.unary()?.wrapping_neg(),
            Lex::Tilde => !self.unary()?,
            Lex::Bang => i64::from(self.unary()? == 0),
            Lex::LParen => {
                let inner = self.binary(0)?;
                if self.peek() != Some(Lex::RParen) {
                    return self.error("expected `)` in this condition");
                }
                self.at += 1;
                inner
            }
            Lex::Number => match number::literal(tok.text(self.file)) {
                Ok(Literal::Int(v)) => i64::from(v),
                Ok(Literal::Uint(v)) => i64::from(v),
                Ok(
                    Literal::Bool(_) | Literal::Float(_) | Literal::Double(_) | Literal::Half(_) | Literal::Sized(..),
                )
                | Err(_) => {
                    self.at -= 1;
                    return self.error("a condition takes integers only");
                }
            },
            Lex::Word => {
                // A function-like use of a name that is no macro is 0 as a whole.
                if self.peek() == Some(Lex::LParen) {
                    return self.error("this macro is not defined, and takes no arguments in a condition");
                }
                0
            }
            _ => {
                self.at -= 1;
                return self.error("a value is missing before this in the condition");
            }
        };
        self.depth -= 1;
        Ok(value)
    }
}

fn level(lex: Lex) -> Option<u8> {
    Some(match lex {
        Lex::OrOr => 0,
        Lex::AndAnd => 1,
        Lex::Pipe => 2,
        Lex::Caret => 3,
        Lex::Amp => 4,
        Lex::EqualEqual | Lex::NotEqual => 5,
        Lex::Less | Lex::Greater | Lex::LessEqual | Lex::GreaterEqual => 6,
        Lex::Shl | Lex::Shr => 7,
        Lex::Plus | Lex::Minus => 8,
        Lex::Star | Lex::Slash | Lex::Percent => 9,
        _ => return None,
    })
}
