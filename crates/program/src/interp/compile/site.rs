//! Places of operations, and how what stands there is done.

use naga::{Expression, Function, Handle};

use super::super::code::{Place, Register};
use super::super::domain::{Site, Unary};
use super::{Compiler, Frame};
use crate::{Grade, Manner};
use base::value::Scalar;

impl<'m> Compiler<'m> {
    /// The place of a declaration.
    pub(super) fn declared(&mut self, function: Option<Handle<Function>>, span: naga::Span) -> Site {
        let sites = &mut self.executable.sites;
        sites.push(Place { function, expression: None, span });
        Site::new(sites.len() - 1)
    }

    pub(super) fn constant_site(&mut self, handle: Handle<Expression>, span: naga::Span) -> Site {
        let sites = &mut self.executable.sites;
        *self.constant_sites.entry(handle).or_insert_with(|| {
            sites.push(Place { function: None, expression: None, span });
            Site::new(sites.len() - 1)
        })
    }

    pub(super) fn site(&mut self, frame: &Frame<'m>, expression: Handle<Expression>) -> Site {
        let arena = &frame.function.expressions;
        let mut span = arena.get_span(expression);
        if !span.is_defined() {
            span = frame.span;
        }
        let mut manner = self.manner(span);
        if self.numbers(frame, expression) == Some(naga::Scalar::F16) {
            manner.grade = Grade::Half;
        }
        let sites = &mut self.executable.sites;
        *self.sites.entry((frame.handle, expression)).or_insert_with(|| {
            sites.push(Place { function: frame.handle, expression: Some(expression), span });
            Site::new(sites.len() - 1).done(manner)
        })
    }

    /// How what stands at a place of the text is done.
    pub(super) fn manner(&self, span: naga::Span) -> Manner {
        let found = self.subject.manners.zip(super::super::source_span(span)).map(|(manners, span)| manners.at(span));
        let found = found.unwrap_or_default();
        if self.subject.lowered { found } else { Manner { grade: Grade::Full, ..found } }
    }

    /// Numbers as a variable or value of the precision of a site takes them.
    pub(super) fn narrowed(&mut self, site: Site, registers: &[Register]) -> Vec<Register> {
        let lower = site.grade() != Grade::Full;
        let narrow = |this: &mut Self, register: Register| match register.scalar {
            Scalar::F32 if lower => this.real1(site, Unary::Narrow, register),
            _ => register,
        };
        registers.iter().map(|&register| narrow(self, register)).collect()
    }

    /// The site of a variable that is written at a place, where its precision is lower.
    pub(super) fn written(&mut self, frame: &Frame<'m>, span: naga::Span) -> Option<Site> {
        let manners = self.subject.manners.filter(|_| self.subject.lowered)?;
        let grade = manners.written_at(super::super::source_span(span)?);
        (grade != Grade::Full).then(|| self.declared(frame.handle, span).done(Manner { grade, ..Manner::default() }))
    }
}
