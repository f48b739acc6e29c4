//! Functions of position and time given as text, with their exact derivatives in time.
//!
//! A formula is evaluated in dual numbers: each operation computes a value and its derivative in time by the chain
//! rule. The derivative is exact up to round-off. Powers bind as usual: `-t^2 = -(t^2)` and `2^3^t = 2^(3^t)`.

use std::f64::consts::{E, PI};
use std::sync::Arc;

/// Largest number of tokens (numbers, names, signs) in a formula. It bounds the depth of nesting.
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
    /// Position of the character, from 1.
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

/// A function of position and time; equal to another one if the texts are.
#[derive(Clone, Debug)]
pub struct Formula {
    text: String,
    root: Expression,
}

#[derive(Clone, Debug)]
enum Expression {
    Number(f64),
    /// Index in [`VARIABLES`].
    Variable(usize),
    Unary(Unary, Box<Expression>),
    Binary(Binary, Box<[Expression; 2]>),
    /// Absolute value. At its kink its rate is the absolute value of that of the argument.
    Absolute(Box<Expression>),
    /// Index of a variable, and rows of its values with values of the function, which is linear between rows.
    Table(usize, Arc<[[f64; 2]]>),
}

/// Value and derivative of a function of one argument.
type Unary = (fn(f64) -> f64, fn(f64) -> f64);

type Binary = fn(Dual, Dual) -> Dual;

const NEGATION: Unary = (|x| -x, |_| -1.0);

const FUNCTIONS: [(&str, Unary); 12] = [
    ("sin", (f64::sin, f64::cos)),
    ("cos", (f64::cos, |x| -x.sin())),
    ("tan", (f64::tan, |x| 1.0 + x.tan().powi(2))),
    ("asin", (f64::asin, |x| 1.0 / (1.0 - x * x).sqrt())),
    ("acos", (f64::acos, |x| -1.0 / (1.0 - x * x).sqrt())),
    ("atan", (f64::atan, |x| 1.0 / (1.0 + x * x))),
    ("sinh", (f64::sinh, f64::cosh)),
    ("cosh", (f64::cosh, f64::sinh)),
    ("tanh", (f64::tanh, |x| 1.0 - x.tanh().powi(2))),
    ("exp", (f64::exp, f64::exp)),
    ("ln", (f64::ln, |x| 1.0 / x)),
    ("sqrt", (f64::sqrt, |x| 0.5 / x.sqrt())),
];

/// Binary operators: the sign, its precedence, the least precedence of operators on its right that are applied before
/// it, and the operation.
const OPERATORS: [(&str, u8, u8, Binary); 5] = [
    ("+", 1, 2, |a, b| Dual { value: a.value + b.value, rate: a.rate + b.rate }),
    ("-", 1, 2, |a, b| Dual { value: a.value - b.value, rate: a.rate - b.rate }),
    ("*", 3, 4, |a, b| Dual { value: a.value * b.value, rate: a.rate * b.value + a.value * b.rate }),
    ("/", 3, 4, quotient),
    ("^", 6, 5, power),
];

/// Precedence from which operators on the right of a leading sign are applied before it.
const LEADING_SIGN: u8 = 5;

/// Returns a quotient. If the divisor is infinite by overflow, quotient and rate are zero: `1/(1 + exp(1000 t))` is
/// smooth. At a division by zero the rate is NaN.
fn quotient(a: Dual, b: Dual) -> Dual {
    let value = a.value / b.value;
    let is_beyond = b.value.is_infinite() && b.rate.is_infinite() && a.value.is_finite() && a.rate.is_finite();
    let rate = match b.value {
        _ if is_beyond => 0.0,
        0.0 => f64::NAN,
        _ => (a.rate - value * b.rate) / b.value,
    };
    Dual { value, rate }
}

fn power(a: Dual, b: Dual) -> Dual {
    let value = a.value.powf(b.value);
    // As in a quotient, a negative power of a number that has overflowed is constant.
    let is_beyond = b.value < 0.0 && b.rate == 0.0 && a.value.is_infinite() && a.rate.is_infinite();
    let by_base = if is_beyond { 0.0 } else { chained(a.rate, || b.value * a.value.powf(b.value - 1.0)) };
    Dual { value, rate: by_base + chained(b.rate, || value * a.value.ln()) }
}

/// Functions of two arguments. If the values are equal, the rate is that of the minimum (maximum) an
/// instant later.
const BINARY_FUNCTIONS: [(&str, Binary); 2] =
    [("min", |a, b| chosen(a, b, (a.value, a.rate) <= (b.value, b.rate))), ("max", maximum)];

fn maximum(a: Dual, b: Dual) -> Dual {
    chosen(a, b, (a.value, a.rate) >= (b.value, b.rate))
}

fn chosen(a: Dual, b: Dual, is_first: bool) -> Dual {
    if a.value.is_nan() || b.value.is_nan() {
        return Dual { value: f64::NAN, rate: f64::NAN };
    }
    if is_first { a } else { b }
}

/// Returns slope times rate. A constant has rate zero, even if the slope is infinite.
fn chained(rate: f64, slope: impl FnOnce() -> f64) -> f64 {
    if rate == 0.0 { 0.0 } else { rate * slope() }
}

impl PartialEq for Formula {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
    }
}

impl Formula {
    /// Parses a formula in the given variables, such as `x, y, t`.
    pub(super) fn parse(text: &str, variables: &'static str) -> Result<Self, FormulaError> {
        let mut reader = Reader { text, variables, at: 0, token: "", n_tokens: 0 };
        reader.advance()?;
        let root = reader.expression(0)?;
        match reader.token {
            "" => Ok(Self { text: text.to_owned(), root: root.folded() }),
            ")" => Err(reader.refuse("there is no `(` for this `)`")),
            _ => Err(reader.refuse(format!("an operator is missing before {}", reader.shown()))),
        }
    }

    pub(super) fn constant(value: f64) -> Self {
        Self { text: value.to_string(), root: Expression::Number(value) }
    }

    /// Creates the function that is linear between rows of variable and value, and constant before the first and after
    /// the last row.
    pub(super) fn through(variable: &str, rows: Vec<[f64; 2]>) -> Self {
        let index = VARIABLES.iter().position(|known| *known == variable).unwrap_or_default();
        Self { text: format!("table over {variable}: {rows:?}"), root: Expression::Table(index, rows.into()) }
    }

    pub(super) fn is_constant(&self) -> bool {
        matches!(self.root, Expression::Number(_))
    }

    /// Returns the text for a message; the middle of a long one is left out.
    pub(super) fn text(&self) -> String {
        shortened(&self.text)
    }

    /// Computes value and rate at a point and time; absent coordinates are zero.
    pub(super) fn at(&self, x: &[f64], t: f64) -> Dual {
        let coordinate = |axis: usize| x.get(axis).copied().unwrap_or_default();
        self.root.at(&[coordinate(0), coordinate(1), coordinate(2), t])
    }
}

/// Longest text that messages repeat as a whole, characters.
const LONGEST: usize = 120;

/// Returns a text for a message without the middle if it is long.
fn shortened(text: &str) -> String {
    let n = text.chars().count();
    if n <= LONGEST {
        return text.to_owned();
    }
    let half = LONGEST / 2;
    let [begin, end]: [String; 2] = [text.chars().take(half).collect(), text.chars().skip(n - half).collect()];
    format!("{begin} ... {end}")
}

impl Expression {
    /// Returns the number that an expression without variables stands for, else the expression. One that is not finite
    /// is kept for the message.
    fn folded(self) -> Self {
        let value = self.at(&[0.0; 4]).value;
        if self.is_constant() && value.is_finite() { Self::Number(value) } else { self }
    }

    fn is_constant(&self) -> bool {
        match self {
            Self::Number(_) => true,
            Self::Variable(_) | Self::Table(..) => false,
            Self::Unary(_, node) | Self::Absolute(node) => node.is_constant(),
            Self::Binary(_, sides) => sides.iter().all(Self::is_constant),
        }
    }

    fn at(&self, variables: &[f64; 4]) -> Dual {
        match self {
            Self::Number(value) => Dual { value: *value, rate: 0.0 },
            Self::Variable(k) => Dual { value: variables[*k], rate: if VARIABLES[*k] == "t" { 1.0 } else { 0.0 } },
            Self::Unary((value, slope), node) => {
                let x = node.at(variables);
                Dual { value: value(x.value), rate: chained(x.rate, || slope(x.value)) }
            }
            Self::Absolute(node) => {
                let x = node.at(variables);
                maximum(x, Dual { value: -x.value, rate: -x.rate })
            }
            Self::Table(k, rows) => between(rows, variables[*k], VARIABLES[*k] == "t"),
            Self::Binary(operation, sides) => operation(sides[0].at(variables), sides[1].at(variables)),
        }
    }
}

/// Interpolates between rows. At a row the rate is the slope after the row.
fn between(rows: &[[f64; 2]], x: f64, is_time: bool) -> Dual {
    let after = rows.partition_point(|[at, _]| *at <= x);
    let (Some([x0, y0]), Some([x1, y1])) = (after.checked_sub(1).map(|k| rows[k]), rows.get(after)) else {
        // Before the first row or not before the last one.
        let end = if after == 0 { rows.first() } else { rows.last() };
        return Dual { value: end.map_or(f64::NAN, |[_, y]| *y), rate: 0.0 };
    };
    let slope = (y1 - y0) / (x1 - x0);
    Dual { value: y0 + slope * (x - x0), rate: if is_time { slope } else { 0.0 } }
}

/// Parser by precedence of the operators.
struct Reader<'a> {
    text: &'a str,
    variables: &'static str,
    /// Offset of the current token.
    at: usize,
    /// The current token: a number, a name or a sign; empty at the end.
    token: &'a str,
    n_tokens: usize,
}

impl Reader<'_> {
    fn refuse(&self, what: impl Into<String>) -> FormulaError {
        let at = self.text[..self.at].chars().count() + 1;
        FormulaError { text: shortened(self.text), at, what: what.into(), variables: self.variables }
    }

    fn shown(&self) -> String {
        if self.token.is_empty() { "the end".to_owned() } else { format!("`{}`", self.token) }
    }

    fn advance(&mut self) -> Result<(), FormulaError> {
        let rest = self.text[self.at + self.token.len()..].trim_start();
        self.at = self.text.len() - rest.len();
        let length = |is: fn(char) -> bool| rest.find(|c| !is(c)).unwrap_or(rest.len());
        self.token = match rest.chars().next() {
            None => "",
            Some(c) if c.is_ascii_digit() || c == '.' => {
                let mantissa = length(|c| c.is_ascii_digit() || c == '.');
                &rest[..mantissa + exponent_length(&rest[mantissa..])]
            }
            Some(c) if c.is_alphabetic() => &rest[..length(|c| c.is_alphanumeric() || c == '_')],
            Some(c) if "+-*/^(),".contains(c) => &rest[..1],
            Some(c) => return Err(self.refuse(format!("`{c}` has no meaning here"))),
        };
        self.n_tokens += 1;
        if self.n_tokens > MOST_TOKENS {
            return Err(self.refuse(format!("it has more than {MOST_TOKENS} numbers, names and signs")));
        }
        Ok(())
    }

    fn expect(&mut self, sign: &str) -> Result<(), FormulaError> {
        if self.token != sign {
            return Err(self.refuse(format!("`{sign}` is missing before {}", self.shown())));
        }
        self.advance()
    }

    /// Reads operands, and the operators between them whose precedence is at least `least`.
    fn expression(&mut self, least: u8) -> Result<Expression, FormulaError> {
        let mut left = match self.token {
            "-" => {
                self.advance()?;
                Expression::Unary(NEGATION, Box::new(self.expression(LEADING_SIGN)?))
            }
            "+" => {
                self.advance()?;
                self.expression(LEADING_SIGN)?
            }
            _ => self.operand()?,
        };
        while let Some((.., right, operation)) =
            OPERATORS.iter().find(|(sign, binds, ..)| *sign == self.token && *binds >= least)
        {
            self.advance()?;
            left = Expression::Binary(*operation, Box::new([left, self.expression(*right)?]));
        }
        Ok(left)
    }

    fn operand(&mut self) -> Result<Expression, FormulaError> {
        match self.token.chars().next() {
            Some(c) if c.is_ascii_digit() || c == '.' => {
                let number: f64 =
                    self.token.parse().map_err(|_| self.refuse(format!("`{}` is not a number", self.token)))?;
                if !number.is_finite() {
                    return Err(self.refuse(format!("`{}` is too large for a number", self.token)));
                }
                self.advance()?;
                Ok(Expression::Number(number))
            }
            Some(c) if c.is_alphabetic() => self.named(),
            Some('(') => self.enclosed(),
            _ => Err(self.refuse(format!("a number, a name or `(` is missing before {}", self.shown()))),
        }
    }

    /// Reads a variable, a constant or a function with its arguments.
    fn named(&mut self) -> Result<Expression, FormulaError> {
        let name = self.token;
        let unknown = self.refuse(format!("`{name}` is not known"));
        self.advance()?;
        if self.variables.split(", ").any(|allowed| allowed == name) {
            return VARIABLES.iter().position(|known| *known == name).map(Expression::Variable).ok_or(unknown);
        }
        if let Some((_, function)) = FUNCTIONS.iter().find(|(known, _)| *known == name) {
            return self.enclosed().map(|x| Expression::Unary(*function, Box::new(x)));
        }
        if let Some((_, function)) = BINARY_FUNCTIONS.iter().find(|(known, _)| *known == name) {
            self.expect("(")?;
            let first = self.expression(0)?;
            self.expect(",")?;
            let second = self.expression(0)?;
            self.expect(")")?;
            return Ok(Expression::Binary(*function, Box::new([first, second])));
        }
        match name {
            "pi" | "PI" | "π" => Ok(Expression::Number(PI)),
            "e" | "E" => Ok(Expression::Number(E)),
            "abs" => self.enclosed().map(|x| Expression::Absolute(Box::new(x))),
            _ => Err(unknown),
        }
    }

    /// Reads an expression in parentheses.
    fn enclosed(&mut self) -> Result<Expression, FormulaError> {
        self.expect("(")?;
        let inner = self.expression(0)?;
        self.expect(")")?;
        Ok(inner)
    }
}

/// Returns the length of the exponent at the start of a text; zero for a letter without digits, which is a name.
fn exponent_length(text: &str) -> usize {
    let Some(exponent) = text.strip_prefix(['e', 'E']) else { return 0 };
    let digits = exponent.strip_prefix(['+', '-']).unwrap_or(exponent);
    let n_digits = digits.find(|c: char| !c.is_ascii_digit()).unwrap_or(digits.len());
    if n_digits == 0 { 0 } else { text.len() - digits.len() + n_digits }
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
    fn expressions_without_variables_are_numbers() {
        let is_constant = |text: &str| Formula::parse(text, "t").expect(text).is_constant();
        assert!(is_constant("-9.81") && is_constant("2*pi - abs(-1)"));
        assert!(!is_constant("0*t") && !is_constant("1/0"));
    }

    #[test]
    fn absolute_values_may_be_nested() {
        let depth = 300;
        let text = format!("{}t - 1{}", "abs(".repeat(depth), ")".repeat(depth));
        for (t, value, rate) in [(0.0, 1.0, -1.0), (1.0, 0.0, 1.0), (3.0, 2.0, 1.0)] {
            assert_eq!(at(&text, t), Dual { value, rate });
        }
    }

    #[test]
    fn smooth_steps_have_rates_and_poles_have_none() {
        for text in ["1/(1 + exp(-(t - 0.2)*1e4))", "(1 + exp(-(t - 0.2)*1e4))^-1"] {
            for (t, value) in [(0.0, 0.0), (0.1, 0.0), (0.2, 0.5), (0.3, 1.0), (1.0, 1.0)] {
                let found = at(text, t);
                assert!((found.value - value).abs() < 1e-12 && found.rate.is_finite(), "{text} at {t}: {found:?}");
            }
            assert!((at(text, 0.2).rate - 2500.0).abs() < 1e-9);
        }
        assert!(!at("1/t", 0.0).rate.is_finite() && !at("1/(1/t)", 0.0).rate.is_finite());
    }

    #[test]
    fn tables_are_straight_between_rows_and_constant_outside() {
        let rows = vec![[0.0, 1.0], [2.0, 5.0], [3.0, 4.0]];
        let of_time = Formula::through("t", rows.clone());
        for (t, value, rate) in
            [(-1.0, 1.0, 0.0), (0.0, 1.0, 2.0), (0.5, 2.0, 2.0), (2.0, 5.0, -1.0), (3.0, 4.0, 0.0), (9.0, 4.0, 0.0)]
        {
            assert_eq!(of_time.at(&[], t), Dual { value, rate });
        }
        assert_eq!(Formula::through("y", rows).at(&[7.0, 0.5], 9.0), Dual { value: 2.0, rate: 0.0 });
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
