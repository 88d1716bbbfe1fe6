//! Reads tendons as paths of muscles. One that cannot be read is reported with its reason, and does not refuse the model.

use std::collections::BTreeMap;

use contrapposto::model::LARGEST;
use contrapposto::muscle::{Around, Location, Path, PathPoint, SidePoint, Tendon, TendonGeom, TendonPart};
use nalgebra::Vector3;

use super::built::Built;
use super::error::{MjcfError, MjcfRule};
use super::item::Item;
use super::value::{Value, check};
use crate::model_ir::{MuscleTally, near};
use crate::xml::shorten;

/// A tendon of the file.
pub(super) struct Read<'a> {
    /// "spatial" or "fixed".
    pub(super) kind: &'a str,
    /// Path of the tendon, or the reason for which there is none.
    pub(super) path: Result<Path, MjcfError>,
    /// The kinds of its elements.
    pub(super) parts: Vec<&'static str>,
    /// A muscle pulls on it.
    pub(super) used: bool,
}

/// All tendons by name; `geoms` collects the surfaces that they pass round. Tendons without a name of their own are counted only.
pub(super) fn all<'a>(
    root: Item<'a>,
    built: &Built<'a>,
    geoms: &mut Geoms<'a>,
    tally: &mut MuscleTally,
) -> BTreeMap<&'a str, Read<'a>> {
    let sections = root.children().into_iter().filter(|section| section.name() == "tendon");
    let mut tendons = BTreeMap::new();
    for item in sections.flat_map(Item::children) {
        let Some(name) = item.attribute("name").filter(|name| !name.is_empty()) else {
            tally.left_out(item.name(), "it has no name, so that no muscle pulls on it");
            continue;
        };
        if tendons.contains_key(name) {
            let (place, value) = (item.attribute_place("name"), name.to_owned());
            tally.refused(item.name(), MjcfError::DuplicateName { place, value }.to_string());
            continue;
        }
        let mut line =
            Line { built, geoms, path: Path::default(), tendon: Tendon::default(), parts: vec![], next: None };
        let read = line.read(item);
        let Line { mut path, tendon, parts, .. } = line;
        path.tendon = Some(tendon);
        tendons.insert(name, Read { kind: item.name(), path: read.map(|()| path), parts, used: false });
    }
    tendons
}

/// Surfaces that tendons pass round, each once.
#[derive(Default)]
pub(super) struct Geoms<'a> {
    pub(super) list: Vec<TendonGeom>,
    by_name: BTreeMap<&'a str, usize>,
}

/// A tendon that is being read.
struct Line<'r, 'a> {
    built: &'r Built<'a>,
    geoms: &'r mut Geoms<'a>,
    path: Path,
    tendon: Tendon,
    parts: Vec<&'static str>,
    /// The part behind the last site; none before the first.
    next: Option<TendonPart>,
}

impl<'a> Line<'_, 'a> {
    fn read(&mut self, item: Item<'a>) -> Result<(), MjcfError> {
        let children = item.children();
        let sites = children.iter().filter(|child| child.name() == "site").count();
        let mut divisor = 1.0;
        for (number, &child) in children.iter().enumerate() {
            let kind = |at: Option<usize>| at.and_then(|at| children.get(at)).map(|item| item.name());
            let neighbours = [kind(number.checked_sub(1)), kind(Some(number + 1))];
            match (item.name(), child.name()) {
                ("spatial", "site") => self.site(child, 1.0 / divisor)?,
                ("spatial", "geom") if neighbours == [Some("site"); 2] => self.geom(child)?,
                ("spatial", "pulley") if neighbours == [Some("site"); 2] => {
                    divisor = pulley(child)?;
                    self.next = Some(TendonPart { weight: 0.0, around: None });
                    self.parts.push("pulley of a tendon");
                }
                ("spatial", "geom" | "pulley") => {
                    return Err(MjcfError::invalid(child, "geom", MjcfRule::BetweenSites));
                }
                ("fixed", "joint") => self.joint(child)?,
                ("fixed", _) => return Err(MjcfError::unknown_element(child, &["joint"])),
                _ => return Err(MjcfError::unknown_element(child, &["site", "geom", "pulley"])),
            }
        }
        if children.is_empty() || item.name() == "spatial" && sites < 2 {
            return Err(MjcfError::invalid(item, "name", MjcfRule::TwoSites));
        }
        Ok(())
    }

    fn site(&mut self, item: Item<'a>, weight: f64) -> Result<(), MjcfError> {
        check(item, &["site"])?;
        let (segment, place) = self.place(item, "site")?;
        self.tendon.parts.extend(self.next.replace(TendonPart { weight, around: None }));
        self.path.points.push(PathPoint { segment, location: Location::Fixed(place) });
        self.parts.push("site of a tendon");
        Ok(())
    }

    /// A site's segment and place.
    fn place(&self, item: Item<'a>, attribute: &'static str) -> Result<(Option<usize>, Vector3<f64>), MjcfError> {
        let sites = &self.built.sites;
        let (segment, place) = named(item, attribute, "site", sites)?;
        if place.amax() > LARGEST {
            return Err(MjcfError::invalid(item, attribute, MjcfRule::TooFar));
        }
        Ok((*segment, *place))
    }

    fn geom(&mut self, item: Item<'a>) -> Result<(), MjcfError> {
        check(item, &["geom", "sidesite"])?;
        let geom = named(item, "geom", "geom", &self.built.geoms)?.clone()?;
        if geom.pose.translation.vector.amax() > LARGEST || geom.radius > LARGEST {
            return Err(MjcfError::invalid(item, "geom", MjcfRule::TooFar));
        }
        let side = item.attribute("sidesite").map(|_| self.place(item, "sidesite")).transpose()?;
        let side = side.map(|(segment, place)| SidePoint { segment, place });
        let kind = match (side.is_some(), geom.shape) {
            (false, contrapposto::muscle::RoundShape::Sphere) => "sphere of a tendon",
            (false, contrapposto::muscle::RoundShape::Cylinder) => "cylinder of a tendon",
            (true, contrapposto::muscle::RoundShape::Sphere) => "sphere of a tendon with a side site",
            (true, contrapposto::muscle::RoundShape::Cylinder) => "cylinder of a tendon with a side site",
        };
        let Geoms { list, by_name } = &mut *self.geoms;
        let index = *by_name.entry(item.attribute("geom").unwrap_or_default()).or_insert_with(|| {
            list.push(geom);
            list.len() - 1
        });
        self.next.iter_mut().for_each(|part| part.around = Some(Around { geom: index, side }));
        self.parts.push(kind);
        Ok(())
    }

    fn joint(&mut self, item: Item<'a>) -> Result<(), MjcfError> {
        check(item, &["joint", "coef"])?;
        let (coordinate, _) = *named(item, "joint", "hinge or slide joint", &self.built.joints)?;
        let coef = Value::of(item, "coef").ok_or_else(|| MjcfError::Missing { place: item.attribute_place("coef") })?;
        let factor = coef.number()?;
        if factor.abs() > LARGEST {
            return Err(coef.invalid(MjcfRule::TooFar));
        }
        self.tendon.coordinates.push((coordinate, factor));
        self.parts.push("joint of a tendon");
        Ok(())
    }
}

fn pulley(item: Item<'_>) -> Result<f64, MjcfError> {
    check(item, &["divisor"])?;
    let value =
        Value::of(item, "divisor").ok_or_else(|| MjcfError::Missing { place: item.attribute_place("divisor") })?;
    let divisor = value.number()?;
    if (1.0 / LARGEST..=LARGEST).contains(&divisor) { Ok(divisor) } else { Err(value.invalid(MjcfRule::Divisor)) }
}

/// The thing that an attribute names.
pub(super) fn named<'r, 'a, T>(
    item: Item<'a>,
    attribute: &'static str,
    kind: &'static str,
    things: &'r BTreeMap<&'a str, T>,
) -> Result<&'r T, MjcfError> {
    let place = item.attribute_place(attribute);
    let Some(name) = item.attribute(attribute) else { return Err(MjcfError::Missing { place }) };
    things.get(name).ok_or_else(|| MjcfError::UnknownName {
        place,
        kind,
        value: shorten(name),
        nearest: near(name, things.keys().copied()),
    })
}
