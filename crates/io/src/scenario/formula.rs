//! Functions of position and time given as text, with their exact derivatives in time.
//!
//! A formula is evaluated in dual numbers: each operation carries a value and its derivative in time by the chain rule, so
//! that the derivative is exact to round-off. Powers bind as usual: `-t^2 = -(t^2)` and `2^3^t = 2^(3^t)`.

use std::f64::consts::{E, PI};
use std::fmt;

/// Largest number of numbers, names and signs in a formula; bounds the depth of nesting.
const MOST_TOKENS: usize = 1000;

/// All variables, in the order of [`Formula::at`].
const VARIABLES: [&str; 4] = ["x", "y", "z", "t"];

const ADVICE: &str = "pi, e, + - * / ^, parentheses and sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, exp, ln, \
                      sqrt, abs, min(a, b), max(a, b)";

/// Error in the text of a formula.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the formula `{text}` is wrong at character {at}: {what}; use numbers, {variables}, {ADVICE}")]
pub struct FormulaError {
    /// The formula.
    pub text: String,
    /// Number of the character, from 1.
    pub at: usize,
    /// Cause.
    pub what: String,
    /// Variables that it may contain.
    pub variables: &'static str,
}

/// A value and its derivative in time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Dual {
    pub(super) value: f64,
    pub(super) rate: f64,
}

/// A function of position and time.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    text: String,
    root: Node,
}

#[derive(Clone, Debug, PartialEq)]
enum Node {
    Number(f64),
    /// Index in [`VARIABLES`].
    Variable(usize),
    Negated(Box<Node>),
    Binary(Binary, Box<[Node; 2]>),
    Call(Function, Box<Node>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Min,
    Max,
}

/// Name, value and derivative of a function of one argument.
type Function = (&'static str, fn(f64) -> f64, fn(f64) -> f64);

const FUNCTIONS: [Function; 12] = [
    ("sin", f64::sin, f64::cos),
    ("cos", f64::cos, |x| -x.sin()),
    ("tan", f64::tan, |x| 1.0 + x.tan().powi(2)),
    ("asin", f64::asin, |x| 1.0 / (1.0 - x * x).sqrt()),
    ("acos", f64::acos, |x| -1.0 / (1.0 - x * x).sqrt()),
    ("atan", f64::atan, |x| 1.0 / (1.0 + x * x)),
    ("sinh", f64::sinh, f64::cosh),
    ("cosh", f64::cosh, f64::sinh),
    ("tanh", f64::tanh, |x| 1.0 - x.tanh().powi(2)),
    ("exp", f64::exp, f64::exp),
    ("ln", f64::ln, |x| 1.0 / x),
    ("sqrt", f64::sqrt, |x| 0.5 / x.sqrt()),
];

impl Formula {
    /// Parses a formula in the given variables, such as `x, y, t`.
    pub(super) fn parse(text: &str, variables: &'static str) -> Result<Self, FormulaError> {
        let mut reader = Reader { text, variables, tokens: Vec::new(), next: 0 };
        reader.tokens = reader.tokenize()?;
        let root = reader.sum()?;
        match reader.peek() {
            Token::End => Ok(Self { text: text.to_owned(), root }),
            Token::Sign(')') => Err(reader.refuse("there is no `(` for this `)`")),
            other => Err(reader.refuse(format!("an operator is missing before {other}"))),
        }
    }

    /// Returns a constant.
    pub(super) fn constant(value: f64) -> Self {
        Self { text: value.to_string(), root: Node::Number(value) }
    }

    /// Returns whether the formula is a number.
    pub(super) fn is_constant(&self) -> bool {
        matches!(self.root, Node::Number(_))
    }

    /// Returns the text of the formula.
    pub(super) fn text(&self) -> &str {
        &self.text
    }

    /// Computes value and rate at a point and time; absent coordinates are zero.
    pub(super) fn at(&self, x: &[f64], t: f64) -> Dual {
        let coordinate = |axis: usize| x.get(axis).copied().unwrap_or_default();
        self.root.at(&[coordinate(0), coordinate(1), coordinate(2), t])
    }
}

impl Node {
    fn at(&self, variables: &[f64; 4]) -> Dual {
        match self {
            Self::Number(value) => Dual { value: *value, rate: 0.0 },
            Self::Variable(k) => Dual { value: variables[*k], rate: if VARIABLES[*k] == "t" { 1.0 } else { 0.0 } },
            Self::Negated(node) => {
                let x = node.at(variables);
                Dual { value: -x.value, rate: -x.rate }
            }
            Self::Binary(binary, sides) => binary.of(sides[0].at(variables), sides[1].at(variables)),
            Self::Call((_, value, slope), node) => {
                let x = node.at(variables);
                Dual { value: value(x.value), rate: chained(x.rate, || slope(x.value)) }
            }
        }
    }
}

/// Returns slope times rate. A constant has rate zero, even if the slope is infinite.
fn chained(rate: f64, slope: impl FnOnce() -> f64) -> f64 {
    if rate == 0.0 { 0.0 } else { rate * slope() }
}

impl Binary {
    fn of(self, a: Dual, b: Dual) -> Dual {
        let (value, rate) = match self {
            Self::Add => (a.value + b.value, a.rate + b.rate),
            Self::Subtract => (a.value - b.value, a.rate - b.rate),
            Self::Multiply => (a.value * b.value, a.rate * b.value + a.value * b.rate),
            Self::Divide => (a.value / b.value, (a.rate - a.value / b.value * b.rate) / b.value),
            Self::Power => {
                let value = a.value.powf(b.value);
                let by_base = chained(a.rate, || b.value * a.value.powf(b.value - 1.0));
                (value, by_base + chained(b.rate, || value * a.value.ln()))
            }
            Self::Min | Self::Max if a.value.is_nan() || b.value.is_nan() => (f64::NAN, f64::NAN),
            // If the values are equal, the one that is smaller (larger) an instant later counts.
            Self::Min if (a.value, a.rate) <= (b.value, b.rate) => (a.value, a.rate),
            Self::Max if (a.value, a.rate) >= (b.value, b.rate) => (a.value, a.rate),
            Self::Min | Self::Max => (b.value, b.rate),
        };
        Dual { value, rate }
    }
}

#[derive(Clone, Debug, PartialEq)]
enum Token {
    Number(f64),
    Name(String),
    Sign(char),
    End,
}

impl fmt::Display for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(value) => write!(f, "`{value}`"),
            Self::Name(name) => write!(f, "`{name}`"),
            Self::Sign(sign) => write!(f, "`{sign}`"),
            Self::End => f.write_str("the end"),
        }
    }
}

/// Recursive-descent parser: sums of products of signed powers.
struct Reader<'a> {
    text: &'a str,
    variables: &'static str,
    tokens: Vec<(usize, Token)>,
    next: usize,
}

impl Reader<'_> {
    fn error(&self, at: usize, what: impl Into<String>) -> FormulaError {
        FormulaError { text: self.text.to_owned(), at: at + 1, what: what.into(), variables: self.variables }
    }

    /// Returns the tokens of the text, each with the number of its first character; the last is the end.
    fn tokenize(&self) -> Result<Vec<(usize, Token)>, FormulaError> {
        let all: Vec<char> = self.text.chars().collect();
        let mut tokens = Vec::new();
        let mut at = 0;
        while let Some(&first) = all.get(at) {
            let begin = at;
            let run = |from: usize, is: fn(&char) -> bool| from + all[from..].iter().take_while(|c| is(c)).count();
            let token = match first {
                c if c.is_whitespace() => {
                    at += 1;
                    continue;
                }
                c if c.is_ascii_digit() || c == '.' => {
                    at = run(at, |c| c.is_ascii_digit() || *c == '.');
                    if matches!(all.get(at), Some('e' | 'E')) {
                        let digits = at + 1 + usize::from(matches!(all.get(at + 1), Some('+' | '-')));
                        // Else the letter is a name of its own.
                        if all.get(digits).is_some_and(char::is_ascii_digit) {
                            at = run(digits, char::is_ascii_digit);
                        }
                    }
                    let word: String = all[begin..at].iter().collect();
                    Token::Number(word.parse().map_err(|_| self.error(begin, format!("`{word}` is not a number")))?)
                }
                c if c.is_alphabetic() => {
                    at = run(at, |c| c.is_alphanumeric() || *c == '_');
                    Token::Name(all[begin..at].iter().collect())
                }
                c if "+-*/^(),".contains(c) => {
                    at += 1;
                    Token::Sign(c)
                }
                c => return Err(self.error(begin, format!("`{c}` has no meaning here"))),
            };
            tokens.push((begin, token));
            if tokens.len() > MOST_TOKENS {
                return Err(self.error(begin, format!("it has more than {MOST_TOKENS} numbers, names and signs")));
            }
        }
        tokens.push((all.len(), Token::End));
        Ok(tokens)
    }

    fn peek(&self) -> &Token {
        &self.tokens[self.next].1
    }

    fn take(&mut self) -> Token {
        let token = self.peek().clone();
        // The position never exceeds the end.
        self.next = (self.next + 1).min(self.tokens.len() - 1);
        token
    }

    fn takes(&mut self, sign: char) -> bool {
        let is_it = *self.peek() == Token::Sign(sign);
        if is_it {
            self.take();
        }
        is_it
    }

    fn refuse(&self, what: impl Into<String>) -> FormulaError {
        self.error(self.tokens[self.next].0, what)
    }

    fn expect(&mut self, sign: char) -> Result<(), FormulaError> {
        if self.takes(sign) { Ok(()) } else { Err(self.refuse(format!("`{sign}` is missing before {}", self.peek()))) }
    }

    fn sum(&mut self) -> Result<Node, FormulaError> {
        let mut left = self.product()?;
        loop {
            let binary = match self.peek() {
                Token::Sign('+') => Binary::Add,
                Token::Sign('-') => Binary::Subtract,
                _ => return Ok(left),
            };
            self.take();
            left = Node::Binary(binary, Box::new([left, self.product()?]));
        }
    }

    fn product(&mut self) -> Result<Node, FormulaError> {
        let mut left = self.signed()?;
        loop {
            let binary = match self.peek() {
                Token::Sign('*') => Binary::Multiply,
                Token::Sign('/') => Binary::Divide,
                _ => return Ok(left),
            };
            self.take();
            left = Node::Binary(binary, Box::new([left, self.signed()?]));
        }
    }

    fn signed(&mut self) -> Result<Node, FormulaError> {
        if self.takes('-') {
            return Ok(Node::Negated(Box::new(self.signed()?)));
        }
        if self.takes('+') { self.signed() } else { self.power() }
    }

    fn power(&mut self) -> Result<Node, FormulaError> {
        let base = self.single()?;
        if self.takes('^') { Ok(Node::Binary(Binary::Power, Box::new([base, self.signed()?]))) } else { Ok(base) }
    }

    fn single(&mut self) -> Result<Node, FormulaError> {
        match self.peek().clone() {
            Token::Number(value) => {
                self.take();
                Ok(Node::Number(value))
            }
            Token::Name(name) => self.named(&name),
            Token::Sign('(') => {
                self.take();
                let inner = self.sum()?;
                self.expect(')')?;
                Ok(inner)
            }
            other => Err(self.refuse(format!("a number, a name or `(` is missing before {other}"))),
        }
    }

    fn named(&mut self, name: &str) -> Result<Node, FormulaError> {
        let variable = VARIABLES.iter().position(|known| *known == name);
        let is_allowed = self.variables.split(", ").any(|allowed| allowed == name);
        let constant = match name {
            _ if is_allowed => variable.map(Node::Variable),
            "pi" | "PI" | "π" => Some(Node::Number(PI)),
            "e" | "E" => Some(Node::Number(E)),
            _ => None,
        };
        if let Some(node) = constant {
            self.take();
            return Ok(node);
        }
        let binary = match name {
            "min" => Some(Binary::Min),
            "max" => Some(Binary::Max),
            _ => None,
        };
        let function = FUNCTIONS.iter().find(|(known, ..)| *known == name);
        if binary.is_none() && function.is_none() && name != "abs" {
            return Err(self.refuse(format!("`{name}` is not known")));
        }
        self.take();
        self.expect('(')?;
        let first = self.sum()?;
        let node = match (binary, function) {
            (Some(binary), _) => {
                self.expect(',')?;
                Node::Binary(binary, Box::new([first, self.sum()?]))
            }
            (None, Some(function)) => Node::Call(*function, Box::new(first)),
            // |x| = max(x, -x), at its kink as well.
            (None, None) => Node::Binary(Binary::Max, Box::new([first.clone(), Node::Negated(Box::new(first))])),
        };
        self.expect(')')?;
        Ok(node)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str, t: f64) -> Dual {
        Formula::parse(text, "t").unwrap_or_else(|e| panic!("{e}")).at(&[], t)
    }

    #[test]
    fn operators_bind_as_on_paper() {
        for (text, value) in [
            ("-t^2", -9.0),
            ("2^-t", 0.125),
            ("2^t^2", 512.0),
            ("2 - 3 - t", -4.0),
            ("12 / 2 / t", 2.0),
            ("-sin(0)^2 + 2*(t - 1)", 4.0),
            ("1e-1 * 1.5E+1 + .5", 2.0),
            ("min(t, 2) + max(t, 7)", 9.0),
            ("3*e", 3.0 * E),
            ("pi + PI - 2*π", 0.0),
            ("- -t + +1", 4.0),
        ] {
            assert!((at(text, 3.0).value - value).abs() < 1e-14, "{text}: {}", at(text, 3.0).value);
        }
    }

    #[test]
    fn coordinates_are_constant_in_time() {
        let formula = Formula::parse("x*y^2 + z*t", "x, y, z, t").unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(formula.at(&[2.0, 3.0, 5.0], 0.5), Dual { value: 20.5, rate: 5.0 });
        assert_eq!(formula.at(&[2.0, 3.0], 0.5), Dual { value: 18.0, rate: 0.0 });
        let error = Formula::parse("x + z", "x, y, t").expect_err("no such variable").to_string();
        assert!(error.contains("`z` is not known") && error.contains("numbers, x, y, t, pi"), "{error}");
    }

    #[test]
    fn rates_are_those_of_finite_differences() {
        for text in [
            "0.25*sin(2*pi*0.25*t)",
            "t^3 - 2*t + 1/(1 + t^2)",
            "exp(-t)*cos(3*t)/(2 + tan(0.3*t))",
            "(t - 2)^3 + (t - 2)^-2",
            "t^t + 2^(t*t) + sqrt(1 + t)^1.5",
            "tanh(4*(t - 0.7)) + sinh(t)/cosh(2*t)",
            "asin(t/2) + acos(t/3)*atan(t) + ln(1 + t)",
            "abs(t - 0.9) + min(t, 0.3)*max(0.2, t^2) - -t",
        ] {
            for t in [0.11, 0.52, 0.97, 1.31] {
                // Central differences of fourth order.
                let h = 1e-3;
                let f = |k: f64| at(text, t + k * h).value;
                let difference = (8.0 * (f(1.0) - f(-1.0)) - (f(2.0) - f(-2.0))) / (12.0 * h);
                let rate = at(text, t).rate;
                assert!((rate - difference).abs() < 1e-8 * (1.0 + rate.abs()), "{text} at {t}: {rate} {difference}");
            }
        }
    }

    #[test]
    fn kinks_have_the_rate_to_the_right() {
        assert_eq!(at("max(0, t - 1)", 1.0).rate, 1.0);
        assert_eq!(at("min(t, 1)", 1.0).rate, 0.0);
        assert_eq!(at("max(0, t - 1)^2", 1.0).rate, 0.0);
        assert_eq!(at("abs(t)", 0.0).rate, 1.0);
        assert_eq!(at("abs(1 - t)", 1.0).rate, 1.0);
        assert_eq!((at("abs(t)", -2.0).value, at("abs(t)", -2.0).rate), (2.0, -1.0));
        for unknown in ["max(0, sqrt(t - 1))", "max(sqrt(t - 1), 0)", "min(sqrt(t - 1), 0)"] {
            assert!(at(unknown, 0.0).value.is_nan());
        }
        assert_eq!(at("sqrt(0)*t", 1.0), Dual::default());
        assert!(at("sqrt(t)", 0.0).rate.is_infinite() && at("ln(-t)", 1.0).value.is_nan());
    }

    #[test]
    fn errors_name_the_character() {
        for (text, at, what) in [
            ("", 1, "missing before the end"),
            ("2t", 2, "an operator is missing before `t`"),
            ("sin t", 5, "`(` is missing before `t`"),
            ("0.1*sin(x)", 9, "`x` is not known"),
            ("t + cosh(t", 11, "`)` is missing before the end"),
            ("t)", 2, "there is no `(`"),
            ("t**2", 3, "missing before `*`"),
            ("1.2.3", 1, "`1.2.3` is not a number"),
            ("t > 1", 3, "`>` has no meaning"),
            ("min(t)", 6, "`,` is missing"),
        ] {
            let error = Formula::parse(text, "t").expect_err(text);
            assert_eq!(error.at, at, "{error}");
            assert!(error.to_string().contains(what), "{error}");
        }
        let deep = "(".repeat(1_000_000);
        assert!(Formula::parse(&deep, "t").expect_err("deep").what.contains("more than 1000"));
        let nested = format!("{}t{}", "(".repeat(499), ")".repeat(499));
        assert_eq!(Formula::parse(&nested, "t").map(|f| f.at(&[], 2.0).value), Ok(2.0));
    }
}
