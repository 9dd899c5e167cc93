//! Limits of a size by its fit after ISO 286 (GB/T 1800), from `data/fits.toml`: `h7`, `H7`, `js6` …
//!
//! In: a nominal size up to 500 mm and a fit. Out: upper and lower deviation, mm. Small letters are shafts, capitals are
//! holes. What the tables do not have is refused by name.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::Deserialize;

/// A number for each range of sizes, micrometres.
type Row = Vec<f64>;

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Tables {
    limits_mm: Row,
    grades: BTreeMap<String, Row>,
    below: BTreeMap<String, Row>,
    above: BTreeMap<String, Row>,
    fine: Fine,
    single: BTreeMap<String, Row>,
    range: BTreeMap<String, (u8, u8)>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Fine {
    limits_mm: Row,
    r: Row,
    s: Row,
}

static TABLES: LazyLock<Tables> = LazyLock::new(|| {
    toml::from_str(include_str!("../../../data/fits.toml"))
        .unwrap_or_else(|error| unreachable!("data/fits.toml is read by a test: {error}"))
});

/// Upper and lower deviation of a fit, mm.
///
/// # Errors
/// What is wrong with it, in words.
pub fn fit_deviations_mm(nominal_mm: f64, fit: &str) -> Result<(f64, f64), String> {
    let digits = fit.find(|c: char| c.is_ascii_digit()).unwrap_or(fit.len());
    let (letter, grade_text) = fit.split_at(digits);
    let tables = &*TABLES;
    if !(nominal_mm > 0.0 && nominal_mm <= 500.0) {
        return Err(format!("{fit}: fits are known for sizes up to 500 mm, not for {nominal_mm}"));
    }
    let grade: u8 = grade_text.parse().map_err(|_| {
        format!(
            "{fit:?} is no fit that is known: write a letter and a grade, as in h7 for a shaft, H7 for a hole"
        )
    })?;
    let column = |limits: &[f64]| limits.iter().position(|limit| nominal_mm <= *limit).unwrap_or(0);
    let at = column(&tables.limits_mm);
    let of_grade = |grade: u8| tables.grades.get(&grade.to_string()).map(|row| row[at]);
    let unknown = || {
        let known: Vec<&str> = tables.range.keys().map(String::as_str).collect();
        format!("{fit}: the tables here have no such fit; known letters are j J {}", known.join(" "))
    };
    let micrometres = if let Some(row) = tables.single.get(fit) {
        let tolerance = of_grade(grade).ok_or_else(unknown)?;
        if letter == "j" { (row[at] + tolerance, row[at]) } else { (row[at], row[at] - tolerance) }
    } else {
        let (least, most) = *tables.range.get(letter).ok_or_else(unknown)?;
        if !(least..=most).contains(&grade) {
            return Err(format!("{fit}: {letter} is known in the grades {least} to {most}"));
        }
        let tolerance = of_grade(grade).ok_or_else(unknown)?;
        let shaft = letter.to_ascii_lowercase();
        if shaft == "js" {
            (tolerance / 2.0, -tolerance / 2.0)
        } else if let Some(row) = tables.below.get(&shaft) {
            if shaft == letter { (-row[at], -row[at] - tolerance) } else { (row[at] + tolerance, row[at]) }
        } else {
            let lower = match shaft.as_str() {
                "r" => tables.fine.r[column(&tables.fine.limits_mm)],
                "s" => tables.fine.s[column(&tables.fine.limits_mm)],
                "k" if shaft == letter && !(4..=7).contains(&grade) => 0.0,
                _ => tables.above.get(&shaft).ok_or_else(unknown)?[at],
            };
            if shaft == letter {
                (lower + tolerance, lower)
            } else {
                let upper = upper_of_hole(&shaft, grade, lower, nominal_mm, &of_grade);
                (upper, upper - tolerance)
            }
        }
    };
    Ok((micrometres.0 / 1e3, micrometres.1 / 1e3))
}

/// The upper limit of a hole K to S, micrometres: the shaft mirrored and higher by delta, for sizes above 3 mm and grades as
/// fine as 8 (K, M, N) or 7 (P to S). Coarser N holes have their upper limit at the nominal size.
fn upper_of_hole(
    shaft: &str,
    grade: u8,
    lower: f64,
    nominal_mm: f64,
    of_grade: &dyn Fn(u8) -> Option<f64>,
) -> f64 {
    let is_small = nominal_mm <= 3.0;
    let finest = if matches!(shaft, "k" | "m" | "n") { 8 } else { 7 };
    if is_small || grade > finest {
        return if shaft == "n" && !is_small { 0.0 } else { -lower };
    }
    // The one place where the tables leave their rule.
    if (shaft, grade) == ("m", 6) && nominal_mm > 250.0 && nominal_mm <= 315.0 {
        return -9.0;
    }
    let delta = of_grade(grade).zip(of_grade(grade - 1)).map_or(0.0, |(grade, before)| grade - before);
    delta - lower
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tables_are_whole() {
        let tables = &*TABLES;
        let rows = [&tables.grades, &tables.below, &tables.above, &tables.single];
        let coarse = rows.into_iter().flat_map(BTreeMap::values);
        assert!(coarse.clone().count() > 20 && coarse.clone().all(|row| row.len() == tables.limits_mm.len()));
        let Fine { limits_mm, r, s } = &tables.fine;
        assert!(r.len() == limits_mm.len() && s.len() == limits_mm.len());
        // Every letter in every grade at every size: the limits have a grade between them.
        for (letter, (least, most)) in &tables.range {
            for grade in *least..=*most {
                for size in limits_mm.iter().map(|limit| limit - 0.5) {
                    let fit = format!("{letter}{grade}");
                    let (upper, lower) = fit_deviations_mm(size, &fit).expect("a fit");
                    let at = tables.limits_mm.iter().position(|limit| size <= *limit).expect("a range");
                    let tolerance = tables.grades[&grade.to_string()][at] / 1e3;
                    assert!((upper - lower - tolerance).abs() < 1e-12, "{size}{fit}");
                }
            }
        }
    }

    #[test]
    fn common_fits_are_those_of_the_tables() {
        for (size, fit, upper, lower) in [
            (50.0, "h7", 0.0, -0.025),
            (20.0, "H7", 0.021, 0.0),
            (30.0, "g6", -0.007, -0.020),
            (30.000_1, "g6", -0.009, -0.025),
            (40.0, "f7", -0.025, -0.050),
            (25.0, "e8", -0.040, -0.073),
            (25.0, "d9", -0.065, -0.117),
            (100.0, "h11", 0.0, -0.220),
            (20.0, "js6", 0.0065, -0.0065),
            (100.0, "JS7", 0.0175, -0.0175),
            (50.0, "j6", 0.011, -0.005),
            (60.0, "J7", 0.018, -0.012),
            (50.0, "k6", 0.018, 0.002),
            (50.0, "k8", 0.039, 0.0),
            (20.0, "K7", 0.006, -0.015),
            (2.0, "K7", 0.0, -0.010),
            (40.0, "m6", 0.025, 0.009),
            (25.0, "M7", 0.0, -0.021),
            (300.0, "M6", -0.009, -0.041),
            (40.0, "n6", 0.033, 0.017),
            (30.0, "N7", -0.007, -0.028),
            (10.0, "N9", 0.0, -0.036),
            (2.0, "N9", -0.004, -0.029),
            (25.0, "p6", 0.035, 0.022),
            (40.0, "P7", -0.017, -0.042),
            (10.0, "P9", -0.015, -0.051),
            (60.0, "r6", 0.060, 0.041),
            (70.0, "r6", 0.062, 0.043),
            (50.0, "R7", -0.025, -0.050),
            (110.0, "s6", 0.101, 0.079),
            (80.0, "S7", -0.048, -0.078),
            (80.0, "H8", 0.046, 0.0),
            (50.0, "F8", 0.064, 0.025),
            (500.0, "h6", 0.0, -0.040),
        ] {
            let found = fit_deviations_mm(size, fit).unwrap_or_else(|why| panic!("{why}"));
            assert!(
                (found.0 - upper).abs() < 1e-12 && (found.1 - lower).abs() < 1e-12,
                "{size}{fit}: {found:?}"
            );
        }
    }

    #[test]
    fn what_the_tables_do_not_have_is_refused_by_name() {
        for (size, fit, why) in [
            (50.0, "x7", "x7"),
            (50.0, "zc7", "known letters"),
            (50.0, "h14", "grades 1 to 13"),
            (50.0, "j9", "j9"),
            (50.0, "p2", "grades 3 to 10"),
            (500.1, "h7", "up to 500 mm"),
            (50.0, "h", "write a letter and a grade"),
            (50.0, "", "write a letter and a grade"),
            (50.0, "6g", "6g"),
            (50.0, "h7x", "h7x"),
            (50.0, "h999", "h999"),
        ] {
            let fault = fit_deviations_mm(size, fit).expect_err(fit);
            assert!(fault.contains(why), "{size} {fit}: {fault}");
        }
    }
}
