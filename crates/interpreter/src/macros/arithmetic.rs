//! How a control computes: operators and functions of expressions, and their limits.
//!
//! In: values, null among them. Out: values, or why there is none. Which value goes where is the matter of
//! [`code`](super::code).
//!
//! Source: arithmetic and logic operations of custom macro, both families.

use turnwright_syntax::{BinaryOperator, Comparison, Function};

use super::variables::{is_null, number};

/// Why an expression has no value, or may not be written here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CodeFault {
    DivideByZero,
    /// The argument lies outside the range of the function.
    Argument,
    /// A whole number does not fit 32 bits.
    IntegerOverflow,
    /// The value is larger than the control holds.
    Overflow,
    /// Brackets nest too deep.
    Brackets,
    /// The control does not have this function.
    NoFunction,
    /// The function takes its arguments otherwise.
    Arguments,
    /// The function's argument stands without brackets.
    BareArgument,
    /// The number of a loop is not 1, 2 or 3.
    LoopNumber,
    /// Conditions are joined on a control that compares two values only.
    JoinedConditions,
    /// No variable has this name, or the name takes its subscript otherwise.
    NoName,
    /// A jump or a loop in a program that was typed in at the panel.
    FlowInMdi,
}

/// How this control computes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rules {
    /// Largest magnitude of a value.
    pub(crate) magnitude_max: f64,
    /// Values are kept to eight significant digits.
    pub(crate) keeps_eight_digits: bool,
    /// A null variable equals zero in `EQ` and `NE`.
    pub(crate) null_equals_zero: bool,
    /// `ATAN` gives -180 to 180 degrees instead of 0 to 360.
    pub(crate) arc_tangent_is_signed: bool,
    pub(crate) arc_sine: ArcSine,
    /// `MOD`, `POW`, `ADP`, `ATAN` of one argument.
    pub(crate) has_newer_functions: bool,
    pub(crate) has_random: bool,
    pub(crate) takes_bare_arguments: bool,
    /// `PRM`, `AXNUM` and variables by name.
    pub(crate) has_names: bool,
    pub(crate) joins_conditions: bool,
    pub(crate) bracket_depth_max: u8,
}

/// The range of `ASIN`, degrees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ArcSine {
    /// -90 to 90.
    Principal,
    /// 270 to 360 for the negative ones, then 0 to 90.
    Unsigned,
    /// 90 to 270.
    Obtuse,
}

/// The arithmetic of a control.
#[derive(Debug)]
pub(crate) struct Arithmetic {
    pub(crate) rules: Rules,
    random: u64,
}

impl Arithmetic {
    pub(crate) fn new(rules: Rules) -> Self {
        Self { rules, random: 0x2545_f491_4f6c_dd1d }
    }

    #[inline]
    pub(super) fn compare(&self, comparison: Comparison, left: f64, right: f64) -> f64 {
        let same = || {
            if self.rules.null_equals_zero || is_null(left) == is_null(right) {
                number(left) == number(right)
            } else {
                false
            }
        };
        let holds = match comparison {
            Comparison::Equal => same(),
            Comparison::NotEqual => !same(),
            Comparison::Greater => number(left) > number(right),
            Comparison::Less => number(left) < number(right),
            Comparison::GreaterOrEqual => number(left) >= number(right),
            Comparison::LessOrEqual => number(left) <= number(right),
        };
        f64::from(u8::from(holds))
    }

    pub(super) fn binary(&self, operator: BinaryOperator, left: f64, right: f64) -> Result<f64, CodeFault> {
        if let BinaryOperator::Compare(comparison) = operator {
            return Ok(self.compare(comparison, left, right));
        }
        let (left, right) = (number(left), number(right));
        Ok(match operator {
            BinaryOperator::Add => left + right,
            BinaryOperator::Subtract => left - right,
            BinaryOperator::Multiply => left * right,
            BinaryOperator::Divide => divide(left, right)?,
            BinaryOperator::Modulo => left - divide(left, right)?.trunc() * right,
            BinaryOperator::And => f64::from(whole(left)? & whole(right)?),
            BinaryOperator::Or => f64::from(whole(left)? | whole(right)?),
            BinaryOperator::ExclusiveOr => f64::from(whole(left)? ^ whole(right)?),
            BinaryOperator::Compare(_) => unreachable!("done above"),
        })
    }

    pub(super) fn call(&mut self, function: Function, value: f64) -> Result<f64, CodeFault> {
        Ok(match function {
            Function::Sin => sine(value),
            Function::Cos => sine(value + 90.0),
            Function::Tan => divide(sine(value), sine(value + 90.0))?,
            Function::ArcSin => self.arc_sine(value)?,
            Function::ArcCos if value.abs() <= 1.0 => value.acos().to_degrees(),
            Function::ArcTan => value.atan().to_degrees(),
            Function::SquareRoot if value >= 0.0 => value.sqrt(),
            Function::Absolute => value.abs(),
            Function::Logarithm if value > 0.0 => value.ln(),
            Function::Exponential => value.exp(),
            Function::Round => round(value),
            Function::RoundDown => value.trunc(),
            Function::RoundUp => {
                if value < 0.0 {
                    value.floor()
                } else {
                    value.ceil()
                }
            }
            Function::ToBinary => to_binary(value)?,
            Function::ToDecimal => to_decimal(value)?,
            // A number in an expression has its point already.
            Function::AddPoint => value,
            Function::Random => self.random_up_to(value),
            _ => return Err(CodeFault::Argument),
        })
    }

    pub(super) fn call_two(&mut self, function: Function, first: f64, second: f64) -> Result<f64, CodeFault> {
        let first = number(first);
        Ok(match function {
            Function::ArcTan => {
                if first == 0.0 && second == 0.0 {
                    return Err(CodeFault::Argument);
                }
                let angle = first.atan2(second).to_degrees();
                if angle < 0.0 && !self.rules.arc_tangent_is_signed { angle + 360.0 } else { angle }
            }
            Function::Power => {
                if first == 0.0 && second < 0.0 {
                    return Err(CodeFault::DivideByZero);
                }
                let power = first.powf(second);
                if power.is_nan() {
                    return Err(CodeFault::Argument);
                }
                power
            }
            Function::RandomBetween => first + self.random_up_to(second - first),
            _ => return Err(CodeFault::Arguments),
        })
    }

    fn arc_sine(&self, value: f64) -> Result<f64, CodeFault> {
        if value.abs() > 1.0 {
            return Err(CodeFault::Argument);
        }
        let angle = value.asin().to_degrees();
        Ok(match self.rules.arc_sine {
            ArcSine::Principal => angle,
            ArcSine::Unsigned if angle < 0.0 => angle + 360.0,
            ArcSine::Unsigned => angle,
            ArcSine::Obtuse => 180.0 - angle,
        })
    }

    /// The same numbers in every run: a program must do the same thing twice.
    fn random_up_to(&mut self, limit: f64) -> f64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        (self.random >> 11) as f64 / (1u64 << 53) as f64 * limit
    }

    /// A value as the control stores it.
    #[inline]
    pub(crate) fn stored(&self, value: f64) -> f64 {
        if self.rules.keeps_eight_digits && !is_null(value) { eight_digits(value) } else { value }
    }
}

pub(super) fn divide(left: f64, right: f64) -> Result<f64, CodeFault> {
    if right == 0.0 { Err(CodeFault::DivideByZero) } else { Ok(left / right) }
}

/// The sine of an angle in degrees, exact at every multiple of 90 and the same on every machine.
#[inline]
fn sine(degrees: f64) -> f64 {
    /// Adding and taking away this rounds to a whole number.
    const WHOLE: f64 = 6_755_399_441_055_744.0;
    /// Beyond, neighbouring floats are about as far apart as a quarter turn.
    const FAR: f64 = 1e15;
    let degrees = if degrees.abs() < FAR { degrees } else { degrees % 360.0 };
    let quarter = (degrees * (1.0 / 90.0) + WHOLE) - WHOLE;
    let rest = (degrees - quarter * 90.0).to_radians();
    match quarter as i64 & 3 {
        0 => libm::sin(rest),
        1 => libm::cos(rest),
        2 => -libm::sin(rest),
        _ => -libm::cos(rest),
    }
}

/// To the nearest whole number, halves away from zero.
fn round(value: f64) -> f64 {
    value.round()
}

fn whole(value: f64) -> Result<i32, CodeFault> {
    let rounded = value.round();
    if rounded >= f64::from(i32::MIN) && rounded <= f64::from(i32::MAX) {
        Ok(rounded as i32)
    } else {
        Err(CodeFault::IntegerOverflow)
    }
}

/// Largest number of eight binary coded digits.
const CODED_MAX: f64 = 99_999_999.0;

/// Binary coded decimal to binary: 0x25 (37) is 25.
fn to_binary(value: f64) -> Result<f64, CodeFault> {
    let coded = value.round();
    if !(0.0..=f64::from(u32::MAX)).contains(&coded) {
        return Err(CodeFault::Argument);
    }
    let text = format!("{:x}", coded as u32);
    text.parse::<u32>().map(f64::from).map_err(|_| CodeFault::Argument)
}

/// Binary to binary coded decimal: 25 is 0x25 (37).
fn to_decimal(value: f64) -> Result<f64, CodeFault> {
    let plain = value.round();
    if !(0.0..=CODED_MAX).contains(&plain) {
        return Err(CodeFault::Argument);
    }
    u32::from_str_radix(&format!("{}", plain as u32), 16).map(f64::from).map_err(|_| CodeFault::Argument)
}

/// Eight significant digits, and nothing below the smallest magnitude of the older controls.
fn eight_digits(value: f64) -> f64 {
    const SMALLEST: f64 = 1e-29;
    if value.abs() < SMALLEST {
        return 0.0;
    }
    let places = 7 - value.abs().log10().floor() as i32;
    if places.abs() > 300 {
        return value;
    }
    let scale = 10f64.powi(places.abs());
    if places >= 0 { (value * scale).round() / scale } else { (value / scale).round() * scale }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_are_exact_at_quarters_and_good_between() {
        for turns in -8i32..8 {
            let degrees = f64::from(turns) * 90.0;
            let exact = [0.0, 1.0, 0.0, -1.0][turns.rem_euclid(4) as usize];
            assert_eq!(sine(degrees).abs(), f64::abs(exact), "{degrees}");
        }
        for tenth in -36_000..36_000 {
            let degrees = f64::from(tenth) / 10.0;
            assert!((sine(degrees) - degrees.to_radians().sin()).abs() < 1e-13, "{degrees}");
        }
        assert!(sine(1e300).abs() <= 1.0);
    }

    #[test]
    fn coded_decimals() {
        assert_eq!(to_binary(37.0), Ok(25.0));
        assert_eq!(to_decimal(25.0), Ok(37.0));
        assert_eq!(to_binary(26.0), Err(CodeFault::Argument));
        assert_eq!(to_decimal(-1.0), Err(CodeFault::Argument));
    }

    #[test]
    fn eight_significant_digits() {
        assert_eq!(eight_digits(1.0 / 3.0), 0.333_333_33);
        assert_eq!(eight_digits(123_456_789.0), 123_456_790.0);
        assert_eq!(eight_digits(1e-30), 0.0);
    }
}
