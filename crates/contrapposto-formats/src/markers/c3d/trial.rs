//! Opens a C3D file: parameters, layout, whole frames, unit, and the upward axis of its laboratory.

use nalgebra::{Matrix3, Vector3};

use super::layout::Layout;
use super::parameters::Parameters;
use super::refusal::C3dError;
use crate::markers::trc::MarkerUnit;
use crate::xml::shorten;

/// Second byte of every C3D file.
pub(super) const KEY: u8 = 0x50;

/// Parameters and layout of a file, and the bytes of its whole frames.
pub(super) fn trial<'a>(
    bytes: &'a [u8],
    unit: Option<MarkerUnit>,
    warnings: &mut Vec<String>,
) -> Result<(Parameters<'a>, Layout, &'a [u8]), C3dError> {
    let Some(header) = bytes.first_chunk().filter(|header| header[1] == KEY) else {
        let message = "the file is no C3D file";
        return Err(C3dError::at(0, message, "its header has 512 bytes, the second is 0x50"));
    };
    let parameters = Parameters::read(bytes)?;
    let unit = read_unit(&parameters, unit)?;
    let layout = Layout::new((header, bytes.len()), &parameters, unit, warnings)?;
    let data = bytes.get(layout.start..).unwrap_or_default();
    let there = layout.frames.min(data.len() / layout.frame.max(1));
    if there == 0 {
        let (message, frames) = (format!("the file holds no whole frame of {} bytes", layout.frame), layout.frames);
        return Err(C3dError::at(layout.start, message, format!("the header says {frames} frames; was it cut off?")));
    }
    if there < layout.frames {
        let frames = layout.frames;
        warnings.push(format!(
            "the header says {frames} frames, but there are {there}, which are read; was the file cut off?"
        ));
    }
    let data = &data[..there * layout.frame];
    Ok((parameters, layout, data))
}

/// The unit of places: the given one, or that of the file.
pub(super) fn read_unit(parameters: &Parameters<'_>, given: Option<MarkerUnit>) -> Result<MarkerUnit, C3dError> {
    // Some programs name the unit of every point.
    let word = parameters.texts("POINT:UNITS", 1).and_then(|words| words.into_iter().next()).unwrap_or_default();
    given.or_else(|| MarkerUnit::named(&word)).ok_or_else(|| {
        let message = format!("the unit of the points (POINT:UNITS) is `{}`", shorten(&word));
        let accepted =
            "mm, cm and m are known units; --units mm, --units cm or --units m says it, whatever the file says";
        C3dError::at(parameters.byte("POINT:UNITS"), message, accepted)
    })
}

/// The axis of the laboratory that points up: along the normal of the first force plate, or else that which is drawn upwards on a screen.
pub(super) fn up(parameters: &Parameters<'_>) -> Option<Vector3<f64>> {
    let corners = parameters.list("FORCE_PLATFORM:CORNERS", true, 12).unwrap_or_default();
    let plates = parameters.number("FORCE_PLATFORM:USED").is_some_and(|count| count > 0.0);
    let corner = |at: usize| Vector3::from_column_slice(&corners[at..at + 3]);
    let corners = (plates && corners.len() >= 12).then(|| [0, 3, 6, 9].map(corner));
    if let Some(axes) = corners.as_ref().and_then(axes) {
        let axis = axes.column(2).iamax();
        return Some(Vector3::from_fn(|i, _| f64::from(u8::from(i == axis))));
    }
    let word = parameters.texts("POINT:Y_SCREEN", 1)?.into_iter().next()?;
    match word.as_str() {
        "+X" => Some(Vector3::x()),
        "+Y" => Some(Vector3::y()),
        "+Z" => Some(Vector3::z()),
        _ => None,
    }
}

/// Axes of a plate in the laboratory, as columns; `None` of corners that span no area.
pub(super) fn axes(corners: &[Vector3<f64>; 4]) -> Option<Matrix3<f64>> {
    let (x, y) = (corners[0] - corners[1], corners[0] - corners[3]);
    let z = x.cross(&y).try_normalize(1e-12)?;
    let x = x.try_normalize(1e-9)?;
    Some(Matrix3::from_columns(&[x, z.cross(&x), z]))
}
