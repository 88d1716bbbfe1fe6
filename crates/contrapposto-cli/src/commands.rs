//! One module a command: its arguments in, one call of the library, its outputs.

pub(crate) mod animation;
pub(crate) mod assess;
pub(crate) mod capacity;
pub(crate) mod compare;
pub(crate) mod convert;
pub(crate) mod figures;
pub(crate) mod inspect;
pub(crate) mod minimize;
pub(crate) mod muscles;
pub(crate) mod new;
pub(crate) mod passive;
pub(crate) mod population;
pub(crate) mod pose;
pub(crate) mod relax;
pub(crate) mod scale;
pub(crate) mod simulate;
pub(crate) mod studio;
pub(crate) mod sweep;
pub(crate) mod torques;
pub(crate) mod track;
pub(crate) mod trials;
