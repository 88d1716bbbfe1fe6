//! Reads functions of one coordinate.

use super::attributes::Reader;
use super::error::OsimProblem;
use crate::model_ir::{Function, Spline, SplineError};
use crate::xml::Node;

const ACCEPTED_FUNCTIONS: &str = "Constant, LinearFunction, PolynomialFunction, SimmSpline (natCubicSpline, NaturalCubicSpline), \
                        GCVSpline (half_order 2, error_variance 0), PiecewiseLinearFunction, Sine, MultiplierFunction";

/// Whether an element's name is that of a function, supported or not.
pub(super) fn is_function(name: &str) -> bool {
    name.ends_with("Function") || name.ends_with("Spline") || matches!(name, "Constant" | "Sine")
}

/// Coefficients of a `LinearFunction` of `variables` variables: one slope each, then the constant.
pub(super) fn linear<'a>(reader: &Reader<'a>, node: Node<'a>, variables: usize) -> Result<Vec<f64>, OsimProblem> {
    let coefficients = reader.list(node, "coefficients")?.unwrap_or_else(|| vec![1.0, 0.0]);
    if coefficients.len() != variables + 1 {
        let problem = format!("{} coefficients are needed for {variables} coordinate(s)", variables + 1);
        return Err(OsimProblem::invalid(node.place(), &format!("{} coefficients", coefficients.len()), problem));
    }
    Ok(coefficients)
}

/// A function of one variable.
pub(super) fn read<'a>(reader: &Reader<'a>, node: Node<'a>) -> Result<Function, OsimProblem> {
    match node.name() {
        "Constant" => Ok(Function::Constant(reader.number(node, "value", Some(0.0))?)),
        "LinearFunction" => {
            let coefficients = linear(reader, node, 1)?;
            Ok(Function::Linear { slope: coefficients[0], intercept: coefficients[1] })
        }
        "PolynomialFunction" => {
            let mut coefficients = reader.list(node, "coefficients")?.unwrap_or_else(|| vec![1.0]);
            if coefficients.is_empty() {
                return Err(OsimProblem::Missing { place: node.place(), what: "a coefficient".to_owned() });
            }
            coefficients.reverse();
            Ok(Function::Polynomial(coefficients))
        }
        "SimmSpline" | "natCubicSpline" | "NaturalCubicSpline" => {
            points(reader, node, Spline::simm).map(Function::Spline)
        }
        "PiecewiseLinearFunction" => points(reader, node, Spline::piecewise_linear).map(Function::Spline),
        "GCVSpline" => {
            // Its weights say how closely it passes points, and without error variance it meets them all.
            for (property, default, accepted) in [("half_order", 0.0, 2.0), ("error_variance", 0.0, 0.0)] {
                let found = reader.number(node, property, Some(default))?;
                if found != accepted {
                    let what = format!("GCVSpline with {property} {found}");
                    return Err(OsimProblem::unsupported(node.place(), &what, ACCEPTED_FUNCTIONS));
                }
            }
            points(reader, node, Spline::natural).map(Function::NaturalSpline)
        }
        "Sine" => Ok(Function::Sine {
            amplitude: reader.number(node, "amplitude", Some(1.0))?,
            omega: reader.number(node, "omega", Some(1.0))?,
            phase: reader.number(node, "phase", Some(0.0))?,
            offset: reader.number(node, "offset", Some(0.0))?,
        }),
        "MultiplierFunction" => {
            let Some(inner) = reader.object(node, "function", is_function) else {
                return Err(OsimProblem::Missing {
                    place: node.place(),
                    what: "the <function> to multiply".to_owned(),
                });
            };
            Ok(read(reader, inner)?.scaled(reader.number(node, "scale", Some(1.0))?))
        }
        other => Err(OsimProblem::unsupported(node.place(), &format!("function {other}"), ACCEPTED_FUNCTIONS)),
    }
}

fn points<'a>(
    reader: &Reader<'a>,
    node: Node<'a>,
    make: impl Fn(&[f64], &[f64]) -> Result<Spline, SplineError>,
) -> Result<Spline, OsimProblem> {
    let list = |name| Ok::<_, OsimProblem>(reader.list(node, name)?.unwrap_or_default());
    make(&list("x")?, &list("y")?).map_err(|problem| OsimProblem::Spline { place: node.place(), problem })
}
