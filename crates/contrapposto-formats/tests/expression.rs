//! OpenSim's expressions mean here what they mean there. Values from OpenSim 4.6 (`scripts/opensim_reference.py`); slopes are
//! held to the values by central differences, of OpenSim's own grammar through ours.

use contrapposto_formats::osim::expression::{ExpressionError, MOST_DEPTH, MOST_EXPRESSION_BYTES, parse};
use serde_json::Value;

fn reference() -> Value {
    serde_json::from_str(include_str!("data/opensim_expressions.json")).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| value.as_str().unwrap().parse().unwrap())
}

#[test]
fn values_are_those_of_opensim() {
    let reference = reference();
    let angles: Vec<f64> = reference["q"].as_array().unwrap().iter().map(number).collect();
    let rows = reference["expressions"].as_array().unwrap();
    assert!(rows.len() >= 60, "{}", rows.len());
    let mut worst: f64 = 0.0;
    for row in rows {
        let text = row["text"].as_str().unwrap();
        let expression = parse(text).unwrap_or_else(|e| panic!("{text}: {e}"));
        for (&q, theirs) in angles.iter().zip(row["values"].as_array().unwrap()) {
            let (ours, theirs) = (expression.value(q), number(theirs));
            if !theirs.is_finite() {
                assert!(
                    ours == theirs || (ours.is_nan() && theirs.is_nan()),
                    "{text} at {q}: {ours}, OpenSim {theirs}"
                );
                continue;
            }
            let error = (ours - theirs).abs() / theirs.abs().max(1e-3);
            assert!(error < 1e-12, "{text} at {q}: {ours}, OpenSim {theirs}");
            worst = worst.max(error);
        }
    }
    println!("{} expressions, worst relative difference {worst:.1e}", rows.len());
}

#[test]
fn what_opensim_refuses_is_refused() {
    for text in reference()["refused"].as_array().unwrap() {
        let text = text.as_str().unwrap();
        assert!(parse(text).is_err(), "{text}");
    }
    // OpenSim reads a part of these and says nothing.
    for text in [".", "1e", "1e5.5", "1e400", "1e+"] {
        assert!(matches!(parse(text), Err(ExpressionError::Number { .. })), "{text}");
    }
}

#[test]
fn slopes_are_exact() {
    let reference = reference();
    for row in reference["expressions"].as_array().unwrap() {
        let text = row["text"].as_str().unwrap();
        let expression = parse(text).unwrap();
        for q in [0.71, -0.33, 1.97, -1.64, 0.19] {
            let (value, slope) = expression.value_and_slope(q);
            if !value.is_finite() || text.contains("delta") {
                continue;
            }
            // Richardson: error of order h^4.
            let difference = |h: f64| (expression.value(q + h) - expression.value(q - h)) / (2.0 * h);
            let (coarse, fine) = (difference(2e-4), difference(1e-4));
            let expected = (4.0 * fine - coarse) / 3.0;
            let scale = slope.abs().max(value.abs()).max(1.0);
            assert!((slope - expected).abs() < 1e-9 * scale, "{text} at {q}: slope {slope}, difference {expected}");
        }
    }
}

#[test]
fn slopes_at_special_points() {
    let slope = |text: &str, q| parse(text).unwrap().value_and_slope(q).1;
    assert_eq!(slope("q^2", 0.0), 0.0);
    assert_eq!(slope("q^1", 0.0), 1.0);
    assert_eq!(slope("abs(q)", 0.0), 0.0);
    assert_eq!(slope("max(q,0)", 0.0), 0.5);
    assert_eq!(slope("step(q)*q", 1.0), 1.0);
    assert_eq!(slope("3*qdot", 1.0), 0.0);
    assert_eq!(slope("0*log(q)", 0.0), 0.0);
    assert!((slope("q^q", 0.5) - 0.5f64.sqrt() * (1.0 + libm::log(0.5))).abs() < 1e-15);
}

#[test]
fn errors_name_the_column() {
    let error = |text: &str| parse(text).unwrap_err().to_string();
    assert!(error("q + foo").starts_with("column 5: unknown name `foo`"), "{}", error("q + foo"));
    assert!(error("2*sign(q)").starts_with("column 3: unknown function `sign`; there are sqrt"));
    assert!(error("q + ").starts_with("column 4: the expression ends here"), "{}", error("q + "));
    assert!(error("(q").starts_with("column 3: found `the end`; expected `)`"), "{}", error("(q"));
    assert!(error("q; k").starts_with("column 4: a definition has the form"));
    assert!(error("  min(q)").starts_with("column 3: `min` takes 2 argument(s), found 1"));
    assert!(error("q*1.2.3").starts_with("column 6: found `0.3`; expected an operator"), "{}", error("q*1.2.3"));
}

#[test]
fn caps_hold_at_the_cap_and_one_above() {
    for (open, close) in [("(", ")"), ("-", ""), ("2^", ""), ("sin(", ")")] {
        let nested = |n: usize| open.repeat(n) + "q" + &close.repeat(n);
        assert!(parse(&nested(MOST_DEPTH - 1)).is_ok(), "{open}");
        assert!(matches!(parse(&nested(MOST_DEPTH)), Err(ExpressionError::TooDeep { .. })), "{open}");
    }
    let long = |n: usize| "q+".repeat(n / 2 - 1) + " q";
    assert!(parse(&long(MOST_EXPRESSION_BYTES)).is_ok());
    assert!(matches!(parse(&(long(MOST_EXPRESSION_BYTES) + " ")), Err(ExpressionError::TooLong { .. })));
}

/// Definitions that double each other would be 2^60 operations if they were pasted into each other.
#[test]
fn definitions_are_shared_and_evaluation_is_linear() {
    let chain: Vec<String> = (0..60).map(|i| format!("x{i}=x{0}+x{0}", i + 1)).collect();
    let text = format!("x0;{};x60=q", chain.join(";"));
    let (value, slope) = parse(&text).unwrap().value_and_slope(0.5);
    assert_eq!((value, slope), (2f64.powi(59), 2f64.powi(60)));
}

#[test]
fn any_text_gives_a_formula_or_an_error() {
    let pieces = [
        "q", "+", "-", "*", "/", "^", "(", ")", ",", ";", "=", "1", ".5", "e", "sin(", "min(", " ", "\u{e9}", "qdot",
        "x",
    ];
    let mut state = 12345u64;
    let mut accepted = 0;
    for _ in 0..50_000 {
        let mut text = String::new();
        for _ in 0..(state >> 60) + 1 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            text.push_str(pieces[(state >> 33) as usize % pieces.len()]);
        }
        if let Ok(expression) = parse(&text) {
            accepted += 1;
            let _ = expression.value_and_slope(0.3);
        }
    }
    assert!(accepted > 500, "{accepted}");
}
