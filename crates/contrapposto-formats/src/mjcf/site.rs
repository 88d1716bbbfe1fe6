//! Reads the place of a site.

use nalgebra::{Isometry3, Point3, Vector3};

use super::attributes::Attributes;
use super::error::MjcfError;
use super::geom::middle;

/// Name and place of a site in the frame of `frame`; `None` without a name.
pub(super) fn read<'a>(
    site: &Attributes<'a, '_>,
    frame: &Isometry3<f64>,
) -> Result<Option<(&'a str, Vector3<f64>)>, MjcfError> {
    let at = match site.get("fromto") {
        Some(fromto) => middle(&fromto, site)?.0,
        None => Vector3::from(site.numbers::<3>("pos")?.unwrap_or_default()),
    };
    let name = site.item.attribute("name").filter(|name| !name.is_empty());
    Ok(name.map(|name| (name, (frame * Point3::from(at)).coords)))
}
