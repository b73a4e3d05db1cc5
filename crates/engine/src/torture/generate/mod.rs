//! Programs from a seed: typed by construction, and with values that the languages define, as far as guards reach.

mod expressions;
mod statements;

use property::{Stream, mix};

use super::program::{Expression, Form, Helper, Input, Kind, Language, Program, Scalar, Statement, Type, Variable};

/// What is asked of programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wish {
    /// Only in this language.
    pub language: Option<Language>,
}

/// The program of a seed with this number: the same on every machine.
pub fn generate(seed: u64, index: u64, wish: Wish) -> Program {
    let mut stream = Stream::new(mix(mix(seed, 0x70_72_6f_67), index));
    let both = Language::ALL[stream.below(2)];
    let language = wish.language.unwrap_or(both);
    let form = match stream.below(8) {
        0 | 1 => Form::Vertex,
        2 => Form::Fragment,
        3 => Form::Compute,
        _ => Form::Function,
    };
    let folds = stream.one_in(3);
    let program = Program {
        language,
        form,
        structures: Vec::new(),
        helpers: Vec::new(),
        inputs: Vec::new(),
        body: Vec::new(),
        results: Vec::new(),
    };
    let mut maker = Maker { stream, program, scope: Vec::new(), next: 0, folds, calls: 0 };
    maker.whole();
    super::shrink::unused_inputs(&mut maker.program);
    maker.program
}

/// What can be read or written in a place.
#[derive(Clone, Debug)]
struct KnownVariable {
    variable: Variable,
    ty: Type,
    /// Counters and inputs are not written.
    writable: bool,
}

struct Maker {
    stream: Stream,
    program: Program,
    scope: Vec<KnownVariable>,
    /// Number of the next local variable.
    next: u32,
    /// Whether floats are computed of constants alone: what drivers fold, and readers of translations.
    folds: bool,
    /// Calls of helpers so far: each enlarges what is run.
    calls: usize,
}

impl Maker {
    fn whole(&mut self) {
        for _ in 0..self.stream.below(3) {
            let members = 1 + self.stream.below(3);
            let members = (0..members).map(|_| self.member()).collect();
            self.program.structures.push(members);
        }
        for _ in 0..self.stream.below(3) {
            self.helper();
        }
        self.inputs();
        let statements = 1 + self.stream.below(5);
        let body = self.top(statements);
        self.program.body = body;
        let results = if self.program.form == Form::Function { 1 } else { 1 + self.stream.below(3) };
        let types: Vec<Type> = (0..results).map(|_| self.result_type()).collect();
        self.program.results = types.iter().map(|ty| self.expression(ty, 3)).collect();
        self.early();
    }

    /// A way out before the end, behind everything that invocations do together.
    fn early(&mut self) {
        if !self.stream.one_in(3) {
            return;
        }
        let types: Vec<Type> = self.program.results.iter().map(|result| result.ty.clone()).collect();
        let together = |s: &Statement| matches!(s, Statement::Exchange { .. } | Statement::Total { .. });
        let condition = self.expression(&Type::BOOL, 2);
        let results = types.iter().map(|ty| self.expression(ty, 2)).collect();
        let then = vec![Statement::Finish { results }];
        // What comes before may read what is declared before alone: at the end everything is.
        debug_assert!(self.program.body.iter().rposition(together).is_none_or(|last| last < self.program.body.len()));
        self.program.body.push(Statement::If { condition, then, otherwise: Vec::new() });
    }

    fn member(&mut self) -> Type {
        match self.stream.below(8) {
            0 => Type::Array(Box::new(Type::FLOAT), 2 + self.stream.below(3) as u8),
            1 => self.matrix(),
            2 if !self.program.structures.is_empty() => Type::Structure(0),
            _ => self.value(),
        }
    }

    fn matrix(&mut self) -> Type {
        Type::Matrix(2 + self.stream.below(3) as u8, 2 + self.stream.below(3) as u8)
    }

    /// A number or vector that is no truth value.
    fn value(&mut self) -> Type {
        let scalar = match self.stream.below(8) {
            0 | 1 => Scalar::Int,
            2 => Scalar::Uint,
            _ => Scalar::Float,
        };
        Type::Value(scalar, 1 + self.stream.below(4) as u8)
    }

    fn any(&mut self) -> Type {
        match self.stream.below(12) {
            0 => self.matrix(),
            1 => {
                let of = match self.stream.below(4) {
                    0 if !self.program.structures.is_empty() => Type::Structure(0),
                    1 => Type::Array(Box::new(self.value()), 2),
                    _ => self.value(),
                };
                Type::Array(Box::new(of), 2 + self.stream.below(3) as u8)
            }
            2 | 3 if !self.program.structures.is_empty() => {
                Type::Structure(self.stream.below(self.program.structures.len()))
            }
            4 => Type::Value(Scalar::Bool, 1 + self.stream.below(4) as u8),
            _ => self.value(),
        }
    }

    fn result_type(&mut self) -> Type {
        match self.program.form {
            Form::Function if self.stream.one_in(10) => self.matrix(),
            _ => self.value(),
        }
    }

    fn inputs(&mut self) {
        let count = 1 + self.stream.below(3);
        for index in 0..count {
            let may = self.program.form != Form::Function;
            let uniform = may && index > 0 && self.stream.one_in(3);
            let matrix = (uniform || self.program.form == Form::Function) && self.stream.one_in(6);
            let ty = if matrix { self.matrix() } else { self.value() };
            self.scope.push(KnownVariable { variable: Variable::Input(index), ty: ty.clone(), writable: false });
            self.program.inputs.push(Input { ty, uniform });
        }
    }

    fn helper(&mut self) {
        let scope = std::mem::take(&mut self.scope);
        let target = self.stream.one_in(2).then(|| self.any());
        let count = 1 + self.stream.below(2);
        let parameters: Vec<Type> = (0..count).map(|_| self.value()).collect();
        for (index, ty) in parameters.iter().enumerate() {
            self.scope.push(KnownVariable { variable: Variable::Parameter(index), ty: ty.clone(), writable: false });
        }
        if let Some(ty) = &target {
            self.scope.push(KnownVariable { variable: Variable::Target, ty: ty.clone(), writable: true });
        }
        let statements = self.stream.below(3);
        let mut body = self.helper_block(statements);
        let ty = target.clone().unwrap_or_else(|| self.result_type());
        let result = self.expression(&ty, 2);
        if target.is_none() && self.stream.one_in(3) {
            let condition = self.expression(&Type::BOOL, 1);
            let results = vec![self.expression(&ty, 1)];
            body.push(Statement::If { condition, then: vec![Statement::Finish { results }], otherwise: Vec::new() });
        }
        self.program.helpers.push(Helper { target, parameters, body, result });
        self.scope = scope;
    }

    /// A new local variable.
    fn declare(&mut self, ty: Type, writable: bool) -> u32 {
        let id = self.next;
        self.next += 1;
        self.scope.push(KnownVariable { variable: Variable::Local(id), ty, writable });
        id
    }

    fn in_language(&self, language: Language) -> bool {
        self.program.language == language
    }

    /// A number between 0 and `end - 1` as an index of a type that the language takes.
    fn index(&mut self, end: u8, depth: usize) -> Expression {
        if depth == 0 || self.stream.one_in(2) {
            return Expression::int(self.stream.below(usize::from(end)) as i32);
        }
        let inner = self.expression(&Type::INT, depth - 1);
        // A mask where the size is a power of two, and what is left of a division elsewhere.
        if end.is_power_of_two() {
            return self.named("& of int", vec![inner, Expression::int(i32::from(end) - 1)], Type::INT);
        }
        let positive = self.named("& of int", vec![inner, Expression::int(1023)], Type::INT);
        self.named("% of int", vec![positive, Expression::int(i32::from(end))], Type::INT)
    }

    /// A row of the table by its name.
    fn named(&self, name: &str, arguments: Vec<Expression>, ty: Type) -> Expression {
        let row = super::operations::OPERATIONS.iter().position(|row| row.name == name && row.giving(&ty).is_some());
        match row {
            Some(row) => Expression { ty, kind: Kind::Operation(row, arguments) },
            None => arguments.into_iter().next().unwrap_or_else(|| Expression::int(0)),
        }
    }
}
