//! Functions of time given as text, with their exact derivatives.
//!
//! A formula is evaluated in dual numbers: each operation carries a value and its rate of change by the chain rule, so
//! the rate is that of the formula to round-off. Powers bind as on paper, `-t^2 = -(t^2)` and `2^3^t = 2^(3^t)`.

use std::f64::consts::{E, PI};
use std::fmt;

/// More numbers, names and signs than any motion needs; it bounds the depth of what is nested.
const MOST_TOKENS: usize = 1000;

const ADVICE: &str = "use numbers, t, pi, e, + - * / ^, parentheses and sin, cos, tan, asin, acos, atan, sinh, cosh, \
                      tanh, exp, ln, sqrt, abs, min(a, b), max(a, b)";

/// A formula that is none: where, and what is wrong.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the formula `{text}` does not make sense at character {at}: {what}; {ADVICE}")]
pub struct FormulaError {
    /// The formula.
    pub text: String,
    /// Number of the character, from 1.
    pub at: usize,
    /// What is wrong there.
    pub what: String,
}

/// A value and its rate of change.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Dual {
    pub(super) value: f64,
    pub(super) rate: f64,
}

/// A function of time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Formula {
    text: String,
    root: Node,
}

#[derive(Clone, Debug, PartialEq)]
enum Node {
    Number(f64),
    Time,
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

/// A function of one argument with its value and its slope.
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
    /// Reads a formula in `t`.
    pub(super) fn parse(text: &str) -> Result<Self, FormulaError> {
        let mut reader = Reader { text, tokens: tokens(text)?, next: 0 };
        let root = reader.sum()?;
        match reader.peek() {
            Token::End => Ok(Self { text: text.to_owned(), root }),
            Token::Sign(')') => Err(reader.refuse("this `)` closes nothing")),
            other => Err(reader.refuse(format!("an operator is missing before {other}"))),
        }
    }

    /// The text it was read from.
    pub(super) fn text(&self) -> &str {
        &self.text
    }

    /// Value and rate at a time.
    pub(super) fn at(&self, t: f64) -> Dual {
        self.root.at(t)
    }
}

impl Node {
    fn at(&self, t: f64) -> Dual {
        match self {
            Self::Number(value) => Dual { value: *value, rate: 0.0 },
            Self::Time => Dual { value: t, rate: 1.0 },
            Self::Negated(node) => {
                let x = node.at(t);
                Dual { value: -x.value, rate: -x.rate }
            }
            Self::Binary(binary, sides) => binary.of(sides[0].at(t), sides[1].at(t)),
            Self::Call((_, value, slope), node) => {
                let x = node.at(t);
                Dual { value: value(x.value), rate: chained(x.rate, || slope(x.value)) }
            }
        }
    }
}

/// A slope times a rate. What does not change has rate zero, also where the slope is infinite.
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
            // Where both are equal, the one that is ahead a moment later.
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

fn refuse(text: &str, at: usize, what: impl Into<String>) -> FormulaError {
    FormulaError { text: text.to_owned(), at: at + 1, what: what.into() }
}

/// The tokens of a text, each with the number of its first character; the last is the end.
fn tokens(text: &str) -> Result<Vec<(usize, Token)>, FormulaError> {
    let all: Vec<char> = text.chars().collect();
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
                Token::Number(word.parse().map_err(|_| refuse(text, begin, format!("`{word}` is no number")))?)
            }
            c if c.is_alphabetic() => {
                at = run(at, |c| c.is_alphanumeric() || *c == '_');
                Token::Name(all[begin..at].iter().collect())
            }
            c if "+-*/^(),".contains(c) => {
                at += 1;
                Token::Sign(c)
            }
            c => return Err(refuse(text, begin, format!("`{c}` means nothing here"))),
        };
        tokens.push((begin, token));
        if tokens.len() > MOST_TOKENS {
            return Err(refuse(text, begin, format!("it has more than {MOST_TOKENS} numbers, names and signs")));
        }
    }
    tokens.push((all.len(), Token::End));
    Ok(tokens)
}

/// Reads tokens by recursive descent: sums of products of signed powers.
struct Reader<'a> {
    text: &'a str,
    tokens: Vec<(usize, Token)>,
    next: usize,
}

impl Reader<'_> {
    fn peek(&self) -> &Token {
        &self.tokens[self.next].1
    }

    fn take(&mut self) -> Token {
        let token = self.peek().clone();
        // The end is never passed.
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
        refuse(self.text, self.tokens[self.next].0, what)
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
        let constant = match name {
            "t" => Some(Node::Time),
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
        Formula::parse(text).unwrap_or_else(|e| panic!("{e}")).at(t)
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
    fn kinks_have_the_rate_of_what_comes() {
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
    fn what_is_wrong_is_told_with_its_place() {
        for (text, at, what) in [
            ("", 1, "missing before the end"),
            ("2t", 2, "an operator is missing before `t`"),
            ("sin t", 5, "`(` is missing before `t`"),
            ("0.1*sin(x)", 9, "`x` is not known"),
            ("t + cosh(t", 11, "`)` is missing before the end"),
            ("t)", 2, "closes nothing"),
            ("t**2", 3, "missing before `*`"),
            ("1.2.3", 1, "`1.2.3` is no number"),
            ("t > 1", 3, "`>` means nothing"),
            ("min(t)", 6, "`,` is missing"),
        ] {
            let error = Formula::parse(text).expect_err(text);
            assert_eq!(error.at, at, "{error}");
            assert!(error.to_string().contains(what), "{error}");
        }
        let deep = "(".repeat(1_000_000);
        assert!(Formula::parse(&deep).expect_err("deep").what.contains("more than 1000"));
        let nested = format!("{}t{}", "(".repeat(499), ")".repeat(499));
        assert_eq!(Formula::parse(&nested).map(|f| f.at(2.0).value), Ok(2.0));
    }
}
