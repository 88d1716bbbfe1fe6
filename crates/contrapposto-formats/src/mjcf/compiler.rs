//! Reads `<compiler>` and `<option>`: units and conventions of the file, and gravity.

use super::error::{MjcfError, MjcfRule, Unsupported};
use super::item::Item;
use super::schema;
use super::value::{Value, check};
use nalgebra::Vector3;

/// Source of a body's mass.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum MassFrom {
    Inertial,
    Geoms,
    InertialOrGeoms,
}

/// Settings of all `<compiler>` and `<option>` elements together.
pub(super) struct Settings {
    degrees: bool,
    pub(super) automatic_limits: bool,
    pub(super) euler_sequence: [u8; 3],
    pub(super) mass_from: MassFrom,
    /// Geoms of these groups have mass.
    pub(super) groups: (f64, f64),
    pub(super) least_mass: f64,
    pub(super) least_inertia: f64,
    pub(super) balance: bool,
    /// Total mass to which all masses are scaled, if positive.
    pub(super) total_mass: f64,
    pub(super) gravity: Vector3<f64>,
    pub(super) springs: bool,
    pub(super) limits: bool,
    pub(super) equality: bool,
}

impl Settings {
    pub(super) fn read(root: Item<'_>) -> Result<Self, MjcfError> {
        let mut settings = Self {
            degrees: true,
            automatic_limits: true,
            euler_sequence: *b"xyz",
            mass_from: MassFrom::InertialOrGeoms,
            groups: (0.0, 5.0),
            least_mass: 0.0,
            least_inertia: 0.0,
            balance: false,
            total_mass: -1.0,
            gravity: Vector3::new(0.0, 0.0, -9.81),
            springs: true,
            limits: true,
            equality: true,
        };
        let mut options = vec![];
        for section in root.children() {
            match section.name() {
                "compiler" => settings.compiler(section)?,
                "option" => options.push(section),
                _ => {}
            }
        }
        settings.options(&options)?;
        Ok(settings)
    }

    /// An angle of the file in rad.
    pub(super) fn angle(&self, value: f64) -> f64 {
        if self.degrees { value.to_radians() } else { value }
    }

    fn compiler(&mut self, item: Item<'_>) -> Result<(), MjcfError> {
        check(item, schema::COMPILER)?;
        for (name, _) in item.attributes() {
            let Some(value) = Value::of(item, name) else { continue };
            match name {
                "angle" => self.degrees = value.keyword(&["radian", "degree"])? == 1,
                "autolimits" => self.automatic_limits = value.flag()?,
                "balanceinertia" => self.balance = value.flag()?,
                "boundmass" => self.least_mass = value.number()?,
                "boundinertia" => self.least_inertia = value.number()?,
                "settotalmass" => self.total_mass = value.number()?,
                "inertiafromgeom" => {
                    self.mass_from = match value.keyword(&["false", "true", "auto"])? {
                        0 => MassFrom::Inertial,
                        1 => MassFrom::Geoms,
                        _ => MassFrom::InertialOrGeoms,
                    }
                }
                "inertiagrouprange" => {
                    let [from, to] = value.numbers()?;
                    if from.fract() != 0.0 || to.fract() != 0.0 {
                        return Err(value.invalid(MjcfRule::Whole));
                    }
                    self.groups = (from, to);
                }
                "coordinate" if value.keyword(&["local", "global"])? == 1 => {
                    return Err(Unsupported::GlobalCoordinates.at_attribute(item, name));
                }
                "alignfree" if value.flag()? => return Err(Unsupported::AlignFree.at_attribute(item, name)),
                "eulerseq" => match *value.text.as_bytes() {
                    [a, b, c] if [a, b, c].iter().all(|l| b"xyzXYZ".contains(l)) => self.euler_sequence = [a, b, c],
                    _ => return Err(value.invalid(MjcfRule::EulerSequence)),
                },
                _ => {} // meshes, saving, speed
            }
        }
        Ok(())
    }

    fn options(&mut self, options: &[Item<'_>]) -> Result<(), MjcfError> {
        let (mut wind, mut density, mut viscosity) = (None, 0.0, 0.0);
        let (mut has_gravity, mut constraints) = (true, true);
        for &option in options {
            if let Some(value) = Value::of(option, "gravity") {
                self.gravity = Vector3::from(value.numbers::<3>()?);
            }
            if let Some(value) = Value::of(option, "wind") {
                wind = Some(option).filter(|_| value.numbers::<3>().is_ok_and(|w| w != [0.0; 3]));
                value.numbers::<3>()?;
            }
            density = Value::of(option, "density").map_or(Ok(density), |v| v.number())?;
            viscosity = Value::of(option, "viscosity").map_or(Ok(viscosity), |v| v.number())?;
            for flag in option.children().into_iter().filter(|c| c.name() == "flag") {
                for (name, _) in flag.attributes() {
                    let Some(value) = Value::of(flag, name) else { continue };
                    let setting = match name {
                        "gravity" => &mut has_gravity,
                        "spring" | "passive" => &mut self.springs, // `passive`: springs and dampers, in older files
                        "limit" => &mut self.limits,
                        "equality" => &mut self.equality,
                        "constraint" => &mut constraints,
                        _ => continue,
                    };
                    *setting = value.keyword(&["disable", "enable"])? == 1;
                }
            }
        }
        if let Some(item) = wind
            && (density != 0.0 || viscosity != 0.0)
        {
            return Err(Unsupported::Wind.at_attribute(item, "wind"));
        }
        self.limits &= constraints;
        self.equality &= constraints;
        if !has_gravity {
            self.gravity = Vector3::zeros();
        }
        Ok(())
    }
}
