//! Writes functions of one coordinate as OpenSim's objects.

use contrapposto::math::Function;

use super::xml::{Xml, number, numbers};

/// Writes a function as an object of that name, if any; false for one that OpenSim has not, and then nothing is written.
pub(super) fn write(xml: &mut Xml, name: Option<&str>, function: &Function) -> bool {
    let named: Vec<(&str, &str)> = name.map(|name| ("name", name)).into_iter().collect();
    match function {
        Function::Constant(value) => {
            xml.open("Constant", &named);
            xml.value("value", &number(*value));
        }
        Function::Linear { slope, intercept } => {
            xml.open("LinearFunction", &named);
            xml.value("coefficients", &numbers([slope, intercept]));
        }
        Function::Polynomial(coefficients) => {
            xml.open("PolynomialFunction", &named);
            xml.value("coefficients", &numbers(coefficients.iter().rev()));
        }
        Function::Sine { amplitude, omega, phase, offset } => {
            xml.open("Sine", &named);
            for (tag, value) in [("amplitude", amplitude), ("omega", omega), ("phase", phase), ("offset", offset)] {
                xml.value(tag, &number(*value));
            }
        }
        Function::Spline(spline) => {
            let (x, y): (Vec<f64>, Vec<f64>) = spline.points().unzip();
            xml.open(if spline.is_straight() { "PiecewiseLinearFunction" } else { "SimmSpline" }, &named);
            xml.value("x", &numbers(&x));
            xml.value("y", &numbers(&y));
        }
        Function::NaturalSpline(spline) => {
            let (x, y): (Vec<f64>, Vec<f64>) = spline.points().unzip();
            xml.open("GCVSpline", &named);
            for (tag, numbers) in [("x", numbers(&x)), ("weights", numbers(&vec![1.0; x.len()])), ("y", numbers(&y))] {
                xml.value(tag, &numbers);
            }
            xml.value("half_order", "2");
            xml.value("error_variance", "0");
        }
        _ => return false,
    }
    xml.close();
    true
}
