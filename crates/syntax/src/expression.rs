//! Macro statements and expressions, as trees with the place of every part.
//!
//! In: the text of a statement or expression. Out: a [`Statement`] or [`Expression`], or the fault and its
//! place. Values, variables' contents and control flow are the interpreter's business.

use std::ops::Range;

/// Deepest nesting of brackets and functions that is read; controls take five.
pub const EXPRESSION_DEPTH_MAX: usize = 32;

/// An operator between two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinaryOperator {
    /// `+`
    Add,
    /// `-`
    Subtract,
    /// `*`
    Multiply,
    /// `/`
    Divide,
    /// `MOD`
    Modulo,
    /// `AND`
    And,
    /// `OR`
    Or,
    /// `XOR`
    ExclusiveOr,
    /// A comparison.
    Compare(Comparison),
}

/// A comparison of two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Comparison {
    /// `EQ`, `==`
    Equal,
    /// `NE`, `<>`
    NotEqual,
    /// `GT`, `>`
    Greater,
    /// `LT`, `<`
    Less,
    /// `GE`, `>=`
    GreaterOrEqual,
    /// `LE`, `<=`
    LessOrEqual,
}

/// A function of one or two arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names are the documentation")]
pub enum Function {
    Sin,
    Cos,
    Tan,
    ArcSin,
    ArcCos,
    ArcTan,
    SquareRoot,
    Absolute,
    Logarithm,
    Exponential,
    Round,
    RoundDown,
    RoundUp,
    ToBinary,
    ToDecimal,
    Power,
    AddPoint,
    Random,
    RandomBetween,
}

const FUNCTIONS: [(&[u8], Function); 19] = [
    (b"SIN", Function::Sin),
    (b"COS", Function::Cos),
    (b"TAN", Function::Tan),
    (b"ASIN", Function::ArcSin),
    (b"ACOS", Function::ArcCos),
    (b"ATAN", Function::ArcTan),
    (b"SQRT", Function::SquareRoot),
    (b"ABS", Function::Absolute),
    (b"LN", Function::Logarithm),
    (b"EXP", Function::Exponential),
    (b"ROUND", Function::Round),
    (b"FIX", Function::RoundDown),
    (b"FUP", Function::RoundUp),
    (b"BIN", Function::ToBinary),
    (b"BCD", Function::ToDecimal),
    (b"POW", Function::Power),
    (b"ADP", Function::AddPoint),
    (b"RAND", Function::Random),
    (b"SRAND", Function::RandomBetween),
];

/// Longest name of a system variable.
pub const VARIABLE_NAME_MAX: usize = 8;

/// One part of an expression; numbers name other nodes of the same [`Expression`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Node {
    /// A number.
    Number(f64),
    /// The content of the variable whose number is the node.
    Variable(usize),
    /// The negative of the node.
    Negate(usize),
    /// A function of one node, or two.
    Call(Function, usize, Option<usize>),
    /// Two nodes and the operator between them.
    Binary(BinaryOperator, usize, usize),
    /// The number of the variable with a name, zeros behind it, and its subscript.
    Named([u8; VARIABLE_NAME_MAX], Option<usize>),
    /// `PRM[number]`, `PRM[number,bit]`, `PRM[…]/[axis]`.
    Parameter {
        /// The number of the parameter.
        number: usize,
        /// One of its bits.
        bit: Option<usize>,
        /// The number of an axis.
        axis: Option<usize>,
    },
    /// `AXNUM[X]`: the number of the axis with a letter.
    AxisNumber(u8),
}

/// An expression: nodes in the order they were completed, with their places; the last is the whole.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Expression {
    nodes: Vec<(Node, Range<u32>)>,
    brackets: u8,
    bare_argument: Option<Range<u32>>,
}

impl Expression {
    /// Index of the node that is the whole expression.
    pub fn root(&self) -> usize {
        self.nodes.len().saturating_sub(1)
    }

    /// How deep square brackets nest in it, those of functions included.
    pub fn bracket_depth(&self) -> u8 {
        self.brackets
    }

    /// The first function whose argument stands without brackets (`SIN30`), which only some controls take.
    pub fn bare_argument(&self) -> Option<Range<u32>> {
        self.bare_argument.clone()
    }

    /// A node and its place in the text.
    pub fn node(&self, index: usize) -> Option<(&Node, Range<u32>)> {
        self.nodes.get(index).map(|(node, place)| (node, place.clone()))
    }
}

/// A macro statement.
#[derive(Clone, Debug, PartialEq)]
pub enum Statement {
    /// `#i = value`; the first expression is the number of the variable.
    Assign(Expression, Expression),
    /// `IF [condition] GOTO n`
    IfGoto(Expression, Expression),
    /// `IF [condition] THEN #i = value`
    IfThen(Expression, Expression, Expression),
    /// `WHILE [condition] DO m`
    While(Expression, u32),
    /// `DO m`
    Do(u32),
    /// `END m`
    End(u32),
    /// `GOTO n`
    Goto(Expression),
    /// `POPEN`, `PCLOS`, `DPRNT[…]`, `BPRNT[…]`, `SETVN…[…]`: kept as text.
    Output(Range<u32>),
}

/// What a reader of statements and expressions looked for and did not find.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Expected {
    /// A number, a variable, a bracket or a function.
    Value,
    /// A number behind `#`.
    VariableNumber,
    /// A number that can be held.
    Number,
    /// `[`
    OpeningBracket,
    /// `]`
    ClosingBracket,
    /// The comma between two arguments.
    Comma,
    /// Arguments as the function takes them.
    Arguments,
    /// The name of a function.
    Function,
    /// Fewer brackets inside brackets.
    LessNesting,
    /// The number behind `DO` or `END`.
    LoopNumber,
    /// `=`
    EqualsSign,
    /// A condition in brackets and `GOTO` or `THEN`, behind `IF`.
    IfForm,
    /// A condition in brackets and `DO`, behind `WHILE`.
    WhileForm,
    /// A statement.
    Statement,
    /// The end of the statement.
    End,
}

/// What is wrong with a statement or expression.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExpressionFault {
    /// What the reader looked for.
    pub expected: Expected,
    /// Where it looked, in bytes of the line.
    pub place: Range<u32>,
}

/// Reads the expression at `range` of a line.
///
/// # Errors
/// The first place that cannot be read.
pub fn parse_expression(line: &[u8], range: Range<u32>) -> Result<Expression, ExpressionFault> {
    let mut parser = Parser::new(line, range);
    let expression = parser.whole_expression(SUMS)?;
    parser.end()?;
    Ok(expression)
}

/// Reads the macro statement at `range` of a line.
///
/// # Errors
/// The first place that cannot be read.
pub fn parse_statement(line: &[u8], range: Range<u32>) -> Result<Statement, ExpressionFault> {
    let mut parser = Parser::new(line, range);
    let statement = parser.statement()?;
    parser.end()?;
    Ok(statement)
}

/// The level of comparisons: what stands in a condition's brackets.
const COMPARISONS: u8 = 0;
/// The level of sums: what stands behind `=` and `GOTO`.
const SUMS: u8 = 1;

struct Parser<'a> {
    line: &'a [u8],
    at: usize,
    end: usize,
    nodes: Vec<(Node, Range<u32>)>,
    /// Brackets open now, and the most that were.
    open: u8,
    deepest: u8,
    bare_argument: Option<Range<u32>>,
    /// Brackets may hold comparisons: those of `IF` and `WHILE` do.
    compares: bool,
}

impl<'a> Parser<'a> {
    fn new(line: &'a [u8], range: Range<u32>) -> Self {
        let end = (range.end as usize).min(line.len());
        Self {
            line,
            at: (range.start as usize).min(end),
            end,
            nodes: Vec::new(),
            open: 0,
            deepest: 0,
            bare_argument: None,
            compares: false,
        }
    }

    fn blanks(&mut self) {
        while self.at < self.end && matches!(self.line[self.at], b' ' | b'\t') {
            self.at += 1;
        }
    }

    fn peek(&mut self) -> Option<u8> {
        self.blanks();
        (self.at < self.end).then(|| self.line[self.at])
    }

    fn take(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    fn take_word(&mut self, word: &[u8]) -> bool {
        self.blanks();
        let found = self.end - self.at >= word.len()
            && self.line[self.at..self.at + word.len()].eq_ignore_ascii_case(word);
        if found {
            self.at += word.len();
        }
        found
    }

    fn fault<T>(&mut self, expected: Expected) -> Result<T, ExpressionFault> {
        self.blanks();
        let end = (self.at + 1).min(self.end).max(self.at);
        Err(ExpressionFault { expected, place: self.at as u32..end as u32 })
    }

    fn end(&mut self) -> Result<(), ExpressionFault> {
        if self.peek().is_some() { self.fault(Expected::End) } else { Ok(()) }
    }

    fn add(&mut self, node: Node, start: usize) -> usize {
        self.nodes.push((node, start as u32..self.at as u32));
        self.nodes.len() - 1
    }

    fn whole_expression(&mut self, level: u8) -> Result<Expression, ExpressionFault> {
        self.begin();
        self.binary(level, 0)?;
        Ok(self.finish())
    }

    fn begin(&mut self) {
        self.nodes = Vec::new();
        (self.open, self.deepest, self.bare_argument) = (0, 0, None);
    }

    fn finish(&mut self) -> Expression {
        Expression {
            nodes: std::mem::take(&mut self.nodes),
            brackets: self.deepest,
            bare_argument: self.bare_argument.take(),
        }
    }

    /// What brackets hold.
    fn inner(&mut self, depth: usize) -> Result<usize, ExpressionFault> {
        self.binary(if self.compares { COMPARISONS } else { SUMS }, depth)
    }

    /// The bracket is closed, or what is wrong instead.
    fn expect_closing(&mut self) -> Result<(), ExpressionFault> {
        if self.close_bracket() {
            return Ok(());
        }
        let at = self.at;
        let compares = self.operator(COMPARISONS).is_some();
        self.at = at;
        self.fault(if compares { Expected::End } else { Expected::ClosingBracket })
    }

    fn open_bracket(&mut self) -> bool {
        let found = self.take(b'[');
        if found {
            self.open = self.open.saturating_add(1);
            self.deepest = self.deepest.max(self.open);
        }
        found
    }

    fn close_bracket(&mut self) -> bool {
        let found = self.take(b']');
        self.open = self.open.saturating_sub(u8::from(found));
        found
    }

    /// Level 0 compares, 1 adds, 2 multiplies; all from left to right.
    fn binary(&mut self, level: u8, depth: usize) -> Result<usize, ExpressionFault> {
        if level > 2 {
            return self.unary(depth);
        }
        self.blanks();
        let start = self.at;
        let mut left = self.binary(level + 1, depth)?;
        while let Some(operator) = self.operator(level) {
            let right = self.binary(level + 1, depth)?;
            left = self.add(Node::Binary(operator, left, right), start);
        }
        Ok(left)
    }

    fn operator(&mut self, level: u8) -> Option<BinaryOperator> {
        use BinaryOperator as B;
        use Comparison as C;
        const COMPARE: [(&[u8], B); 12] = [
            (b"EQ", B::Compare(C::Equal)),
            (b"NE", B::Compare(C::NotEqual)),
            (b"GT", B::Compare(C::Greater)),
            (b"LT", B::Compare(C::Less)),
            (b"GE", B::Compare(C::GreaterOrEqual)),
            (b"LE", B::Compare(C::LessOrEqual)),
            (b"==", B::Compare(C::Equal)),
            (b"<>", B::Compare(C::NotEqual)),
            (b">=", B::Compare(C::GreaterOrEqual)),
            (b"<=", B::Compare(C::LessOrEqual)),
            (b">", B::Compare(C::Greater)),
            (b"<", B::Compare(C::Less)),
        ];
        const ADD: [(&[u8], B); 4] =
            [(b"+", B::Add), (b"-", B::Subtract), (b"OR", B::Or), (b"XOR", B::ExclusiveOr)];
        const MULTIPLY: [(&[u8], B); 4] =
            [(b"*", B::Multiply), (b"/", B::Divide), (b"AND", B::And), (b"MOD", B::Modulo)];
        let table: &[(&[u8], B)] = match level {
            0 => &COMPARE,
            1 => &ADD,
            _ => &MULTIPLY,
        };
        table.iter().find_map(|(word, operator)| self.take_word(word).then_some(*operator))
    }

    fn unary(&mut self, depth: usize) -> Result<usize, ExpressionFault> {
        self.blanks();
        let start = self.at;
        if depth >= EXPRESSION_DEPTH_MAX {
            return self.fault(Expected::LessNesting);
        }
        if self.take(b'-') {
            let value = self.unary(depth + 1)?;
            return Ok(self.add(Node::Negate(value), start));
        }
        if self.take(b'+') {
            return self.unary(depth + 1);
        }
        match self.peek() {
            Some(b'#') => self.variable(depth),
            Some(b'[') => self.bracket(depth),
            Some(b'0'..=b'9' | b'.') => self.number(),
            Some(b'A'..=b'Z' | b'a'..=b'z') => self.call(depth),
            _ => self.fault(Expected::Value),
        }
    }

    fn variable(&mut self, depth: usize) -> Result<usize, ExpressionFault> {
        let start = self.at;
        self.at += 1;
        if depth >= EXPRESSION_DEPTH_MAX {
            return self.fault(Expected::LessNesting);
        }
        let index = match self.peek() {
            Some(b'_') if self.open > 0 => self.named(depth + 1)?,
            Some(b'#') => self.variable(depth + 1)?,
            Some(b'[') => self.bracket(depth + 1)?,
            Some(b'0'..=b'9') => self.number()?,
            _ => return Err(nameless_variable(start)),
        };
        Ok(self.add(Node::Variable(index), start))
    }

    /// `_NAME`, perhaps with a subscript.
    fn named(&mut self, depth: usize) -> Result<usize, ExpressionFault> {
        let start = self.at;
        self.at += 1;
        let length =
            self.line[self.at..self.end].iter().take_while(|byte| byte.is_ascii_alphanumeric()).count();
        let mut name = [0; VARIABLE_NAME_MAX];
        if length == 0 || length > VARIABLE_NAME_MAX {
            return Err(nameless_variable(start));
        }
        name[..length].copy_from_slice(&self.line[self.at..self.at + length]);
        self.at += length;
        let subscript = if self.peek() == Some(b'[') { Some(self.bracket(depth)?) } else { None };
        Ok(self.add(Node::Named(name, subscript), start))
    }

    /// What stands behind `PRM`.
    fn parameter(&mut self, start: usize, depth: usize) -> Result<usize, ExpressionFault> {
        if !self.open_bracket() {
            return self.fault(Expected::OpeningBracket);
        }
        let number = self.inner(depth)?;
        let bit = if self.take(b',') { Some(self.inner(depth)?) } else { None };
        self.expect_closing()?;
        let back = self.at;
        let axis =
            if self.take(b'/') && self.peek() == Some(b'[') { Some(self.bracket(depth)?) } else { None };
        if axis.is_none() {
            self.at = back;
        }
        Ok(self.add(Node::Parameter { number, bit, axis }, start))
    }

    /// What stands behind `AXNUM`.
    fn axis_number(&mut self, start: usize) -> Result<usize, ExpressionFault> {
        if !self.open_bracket() {
            return self.fault(Expected::OpeningBracket);
        }
        let Some(letter) = self.peek().filter(u8::is_ascii_alphabetic) else {
            return self.fault(Expected::Arguments);
        };
        self.at += 1;
        self.expect_closing()?;
        Ok(self.add(Node::AxisNumber(letter.to_ascii_uppercase()), start))
    }

    fn bracket(&mut self, depth: usize) -> Result<usize, ExpressionFault> {
        if !self.open_bracket() {
            return self.fault(Expected::OpeningBracket);
        }
        let inner = self.inner(depth + 1)?;
        self.expect_closing()?;
        Ok(inner)
    }

    fn number(&mut self) -> Result<usize, ExpressionFault> {
        let start = self.at;
        while self.at < self.end && matches!(self.line[self.at], b'0'..=b'9' | b'.') {
            self.at += 1;
        }
        let text = std::str::from_utf8(&self.line[start..self.at]).unwrap_or("");
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(self.add(Node::Number(value), start)),
            _ => {
                self.at = start;
                self.fault(Expected::Number)
            }
        }
    }

    fn call(&mut self, depth: usize) -> Result<usize, ExpressionFault> {
        let start = self.at;
        // A function may be written with its first two letters.
        let length = self.line[start..self.end].iter().take_while(|byte| byte.is_ascii_alphabetic()).count();
        let name = self.line[start..start + length].to_ascii_uppercase();
        match name.as_slice() {
            b"PRM" => {
                self.at += length;
                return self.parameter(start, depth + 1);
            }
            b"AXNUM" => {
                self.at += length;
                return self.axis_number(start);
            }
            _ => {}
        }
        let found = FUNCTIONS
            .iter()
            .find(|(word, _)| *word == name.as_slice())
            .or_else(|| FUNCTIONS.iter().find(|(word, _)| name.len() == 2 && word.starts_with(&name)));
        let Some((_, function)) = found else {
            let place = start as u32..(start + length) as u32;
            return Err(ExpressionFault { expected: Expected::Function, place });
        };
        self.at += length;
        let mut second = None;
        let first = if self.open_bracket() {
            let inner = self.inner(depth + 1)?;
            if self.take(b',') {
                second = Some(self.inner(depth + 1)?);
            }
            self.expect_closing()?;
            inner
        } else {
            // Some controls take `SIN30`; whether this one does is for others to say.
            let argument = self.unary(depth + 1)?;
            self.bare_argument.get_or_insert(start as u32..self.at as u32);
            argument
        };
        let divides = *function == Function::ArcTan;
        if divides && self.peek() == Some(b'/') && second.is_none() {
            let back = self.at;
            self.at += 1;
            if self.peek() == Some(b'[') {
                second = Some(self.bracket(depth + 1)?);
            } else {
                self.at = back;
            }
        }
        let takes_two = matches!(function, Function::Power | Function::RandomBetween);
        let may_take_two = takes_two || divides;
        if takes_two && second.is_none() {
            return self.fault(Expected::Comma);
        }
        if second.is_some() && !may_take_two {
            return self.fault(Expected::Arguments);
        }
        Ok(self.add(Node::Call(*function, first, second), start))
    }

    /// What `IF` and `WHILE` ask: a comparison in brackets, or comparisons joined by `AND`, `OR`, `XOR`.
    fn condition(&mut self, form: Expected) -> Result<Expression, ExpressionFault> {
        self.begin();
        if self.peek() != Some(b'[') {
            return self.fault(form);
        }
        self.compares = true;
        let whole = self.bracket(0);
        self.compares = false;
        whole?;
        let expression = self.finish();
        use BinaryOperator as B;
        match expression.node(expression.root()) {
            Some((Node::Binary(B::Compare(_) | B::And | B::Or | B::ExclusiveOr, ..), _)) => Ok(expression),
            _ => self.fault(form),
        }
    }

    fn loop_number(&mut self) -> Result<u32, ExpressionFault> {
        self.blanks();
        let start = self.at;
        while self.at < self.end && self.line[self.at].is_ascii_digit() {
            self.at += 1;
        }
        let text = std::str::from_utf8(&self.line[start..self.at]).unwrap_or("");
        match text.parse() {
            Ok(number) => Ok(number),
            Err(_) => {
                self.at = start;
                self.fault(Expected::LoopNumber)
            }
        }
    }

    fn statement(&mut self) -> Result<Statement, ExpressionFault> {
        self.blanks();
        let start = self.at;
        for word in [&b"POPEN"[..], b"PCLOS", b"DPRNT", b"BPRNT", b"SETVN"] {
            if self.take_word(word) {
                self.at = self.end;
                return Ok(Statement::Output(start as u32..self.end as u32));
            }
        }
        if self.take_word(b"IF") {
            let condition = self.condition(Expected::IfForm)?;
            if self.take_word(b"GOTO") {
                return Ok(Statement::IfGoto(condition, self.whole_expression(SUMS)?));
            }
            if !self.take_word(b"THEN") {
                return self.fault(Expected::IfForm);
            }
            self.blanks();
            let then = self.at;
            // A second IF is not read: a line of nothing else would go as deep as it is long.
            if !self.take_word(b"IF")
                && let Statement::Assign(target, value) = self.statement()?
            {
                return Ok(Statement::IfThen(condition, target, value));
            }
            let place = then as u32..self.at as u32;
            return Err(ExpressionFault { expected: Expected::IfForm, place });
        }
        if self.take_word(b"WHILE") {
            let condition = self.condition(Expected::WhileForm)?;
            if self.take_word(b"DO") {
                return Ok(Statement::While(condition, self.loop_number()?));
            }
            return self.fault(Expected::WhileForm);
        }
        if self.take_word(b"GOTO") {
            return Ok(Statement::Goto(self.whole_expression(SUMS)?));
        }
        if self.take_word(b"DO") {
            return Ok(Statement::Do(self.loop_number()?));
        }
        if self.take_word(b"END") {
            return Ok(Statement::End(self.loop_number()?));
        }
        self.blanks();
        let variable = self.at;
        if self.line[self.at..self.end].starts_with(b"[#_") {
            self.begin();
            self.open_bracket();
            self.at += 1;
            self.named(0)?;
            self.expect_closing()?;
            return self.assignment(variable);
        }
        if self.take(b'#') {
            self.begin();
            match self.peek() {
                Some(b'#') => self.variable(0)?,
                Some(b'[') => self.bracket(0)?,
                Some(b'0'..=b'9') => self.number()?,
                _ => return Err(nameless_variable(variable)),
            };
            return self.assignment(variable);
        }
        self.fault(Expected::Statement)
    }

    /// `= value`, behind the variable that begins at `variable`.
    fn assignment(&mut self, variable: usize) -> Result<Statement, ExpressionFault> {
        // Whoever refuses the variable means all of it.
        if let Some((_, place)) = self.nodes.last_mut() {
            place.start = variable as u32;
            place.end = self.at as u32;
        }
        let target = self.finish();
        if !self.take(b'=') {
            return self.fault(Expected::EqualsSign);
        }
        Ok(Statement::Assign(target, self.whole_expression(SUMS)?))
    }
}

/// A `#` without a number behind it.
fn nameless_variable(at: usize) -> ExpressionFault {
    ExpressionFault { expected: Expected::VariableNumber, place: at as u32..at as u32 + 1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn show(expression: &Expression, index: usize) -> String {
        match expression.node(index).expect("node").0 {
            Node::Number(value) => format!("{value}"),
            Node::Variable(inner) => format!("#{}", show(expression, *inner)),
            Node::Negate(inner) => format!("-{}", show(expression, *inner)),
            Node::Call(function, first, second) => {
                let second = second.map_or(String::new(), |s| format!(",{}", show(expression, s)));
                format!("{function:?}({}{second})", show(expression, *first))
            }
            Node::Binary(operator, left, right) => {
                format!("({} {operator:?} {})", show(expression, *left), show(expression, *right))
            }
            Node::Named(name, subscript) => {
                let subscript = subscript.map_or(String::new(), |s| format!("[{}]", show(expression, s)));
                format!("{}{subscript}", String::from_utf8_lossy(name).trim_end_matches('\0'))
            }
            Node::Parameter { number, bit, axis } => {
                let part = |part: Option<usize>| part.map_or("-".to_string(), |part| show(expression, part));
                format!("PRM({},{},{})", show(expression, *number), part(*bit), part(*axis))
            }
            Node::AxisNumber(letter) => format!("AXNUM({})", char::from(*letter)),
        }
    }

    fn expression(text: &str) -> String {
        match parse_expression(text.as_bytes(), 0..text.len() as u32) {
            Ok(tree) => show(&tree, tree.root()),
            Err(fault) => format!("expected {:?} at {}", fault.expected, fault.place.start),
        }
    }

    #[test]
    fn names_parameters_and_axes() {
        assert_eq!(expression("[#_ABSIO[AXNUM[z]]]+1"), "(#ABSIO[AXNUM(Z)] Add 1)");
        assert_eq!(expression("[#_DATE]"), "#DATE");
        assert_eq!(expression("#_DATE"), "expected VariableNumber at 0");
        assert_eq!(expression("[#_]"), "expected VariableNumber at 2");
        assert_eq!(expression("PRM[1320]/[2]/2"), "(PRM(1320,-,2) Divide 2)");
        assert_eq!(expression("PRM[#1,3]"), "PRM(#1,3,-)");
        assert_eq!(expression("PRM[#1,3]/[#2]"), "PRM(#1,3,#2)");
        assert_eq!(expression("PRM 1320"), "expected OpeningBracket at 4");
        assert_eq!(expression("AXNUM[1]"), "expected Arguments at 6");
    }

    #[test]
    fn precedence_is_functions_then_products_then_sums() {
        assert_eq!(expression("#1+2*SIN[30]"), "(#1 Add (2 Multiply Sin(30)))");
        assert_eq!(expression("1-2-3"), "((1 Subtract 2) Subtract 3)");
        assert_eq!(expression("ATAN[#1]/[#2]"), "ArcTan(#1,#2)");
        assert_eq!(expression("RO[##2]"), "Round(##2)");
        assert_eq!(expression("-[#3 AND 7]"), "-(#3 And 7)");
    }

    #[test]
    fn faults_name_what_was_expected_and_where() {
        assert_eq!(expression("#1+"), "expected Value at 3");
        assert_eq!(expression("[#1"), "expected ClosingBracket at 3");
        assert_eq!(expression("FOO[1]"), "expected Function at 0");
        assert_eq!(expression("1 2"), "expected End at 2");
        assert!(expression(&"[".repeat(100_000)).starts_with("expected LessNesting"));
        assert!(expression(&"#".repeat(100_000)).starts_with("expected LessNesting"));
        assert!(expression(&"-".repeat(100_000)).starts_with("expected LessNesting"));
    }

    #[test]
    fn statements() {
        let read = |text: &str| parse_statement(text.as_bytes(), 0..text.len() as u32);
        assert!(matches!(read("#100=#4+1"), Ok(Statement::Assign(..))));
        assert!(matches!(read("IF[#103GT0]GOTO80"), Ok(Statement::IfGoto(..))));
        assert!(matches!(read("IF [#1 EQ #0] THEN #1=5"), Ok(Statement::IfThen(..))));
        assert!(matches!(read("WHILE[#1 LT 10]DO1"), Ok(Statement::While(_, 1))));
        assert!(matches!(read("END1"), Ok(Statement::End(1))));
        assert!(matches!(read("#1 5"), Err(ExpressionFault { expected: Expected::EqualsSign, .. })));
    }
}
