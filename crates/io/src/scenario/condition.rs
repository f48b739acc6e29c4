//! Values that a scenario may give in a short and in a long form: boundary conditions and sizes.

use std::fmt;

use serde::de::value::{MapAccessDeserializer, StrDeserializer};
use serde::de::{self, Deserializer, IntoDeserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};

/// What holds on a side of the background.
#[derive(Clone, Debug, PartialEq)]
pub enum FluidCondition {
    /// `"no-slip"`, `"symmetry"` or `"free"`.
    Plain(PlainFluidCondition),
    /// `{ kind = ... }`
    Given(GivenFluidCondition),
}

/// A condition without parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlainFluidCondition {
    /// `u = 0`.
    NoSlip,
    /// `u·n = 0`, free tangential traction.
    Symmetry,
    /// Zero traction, with inflow stabilised.
    Free,
}

/// A condition with parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum GivenFluidCondition {
    /// Constant velocity.
    Velocity {
        /// Velocity, cm/s.
        value: Vec<f64>,
    },
    /// Inflow normal to the side.
    Inflow {
        /// Shape of the profile.
        profile: InflowProfile,
        /// Largest speed, cm/s.
        maximum: f64,
        /// Time over which the inflow rises smoothly from zero, s; at once if not given.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        ramp: Option<f64>,
    },
    /// Constant traction.
    Traction {
        /// Force per area on the fluid, dyn/cm².
        value: Vec<f64>,
    },
    /// Constant pressure outside: the traction `-p n`.
    Pressure {
        /// Pressure, dyn/cm².
        value: f64,
    },
}

/// Shape of an inflow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum InflowProfile {
    /// A parabola over the extent of the side, zero at its ends.
    Parabolic,
}

/// What holds on a tagged part of a body.
#[derive(Clone, Debug, PartialEq)]
pub enum BodyCondition {
    /// `"symmetry"` or `"clamped"`.
    Plain(PlainBodyCondition),
    /// `{ kind = ... }`
    Given(GivenBodyCondition),
}

/// A condition without parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlainBodyCondition {
    /// No motion normal to the side of that name.
    Symmetry,
    /// No motion.
    Clamped,
}

/// A condition with parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum GivenBodyCondition {
    /// Constant displacement.
    Displacement {
        /// Displacement, cm.
        value: Vec<f64>,
    },
    /// Constant load that keeps its direction.
    Traction {
        /// Force per reference area, dyn/cm².
        value: Vec<f64>,
    },
}

/// Size of cells: one number, or graded along an axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Size {
    /// The same size everywhere, cm.
    Uniform(f64),
    /// Fine at low, coarse at high values of a coordinate.
    Graded(GradedSize),
}

/// Fine at low, coarse at high values of a coordinate, linear in between.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GradedSize {
    /// Size from `coarse_from` on, cm.
    pub coarse: f64,
    /// Size up to `fine_until`, cm.
    pub fine: f64,
    /// Coordinate up to which cells are fine, cm.
    pub fine_until: f64,
    /// Coordinate from which on cells are coarse, cm.
    pub coarse_from: f64,
    /// The coordinate.
    pub axis: Axis,
}

/// A coordinate axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third.
    Z,
}

/// Reads a string as `P` and a table as `G`.
struct PlainOrGiven<P, G, T> {
    expecting: &'static str,
    plain: fn(P) -> T,
    given: fn(G) -> T,
}

impl<'de, P: Deserialize<'de>, G: Deserialize<'de>, T> Visitor<'de> for PlainOrGiven<P, G, T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.expecting)
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<T, E> {
        let text: StrDeserializer<'_, E> = text.into_deserializer();
        P::deserialize(text).map(self.plain)
    }

    fn visit_map<M: MapAccess<'de>>(self, map: M) -> Result<T, M::Error> {
        G::deserialize(MapAccessDeserializer::new(map)).map(self.given)
    }
}

impl<'de> Deserialize<'de> for FluidCondition {
    fn deserialize<S: Deserializer<'de>>(source: S) -> Result<Self, S::Error> {
        source.deserialize_any(PlainOrGiven {
            expecting: "\"no-slip\", \"symmetry\", \"free\" or a table with a kind",
            plain: Self::Plain,
            given: Self::Given,
        })
    }
}

impl<'de> Deserialize<'de> for BodyCondition {
    fn deserialize<S: Deserializer<'de>>(source: S) -> Result<Self, S::Error> {
        source.deserialize_any(PlainOrGiven {
            expecting: "\"symmetry\", \"clamped\" or a table with a kind",
            plain: Self::Plain,
            given: Self::Given,
        })
    }
}

impl Serialize for FluidCondition {
    fn serialize<S: Serializer>(&self, sink: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Plain(condition) => condition.serialize(sink),
            Self::Given(condition) => condition.serialize(sink),
        }
    }
}

impl Serialize for BodyCondition {
    fn serialize<S: Serializer>(&self, sink: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Plain(condition) => condition.serialize(sink),
            Self::Given(condition) => condition.serialize(sink),
        }
    }
}

impl Serialize for Size {
    fn serialize<S: Serializer>(&self, sink: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Uniform(h) => h.serialize(sink),
            Self::Graded(size) => size.serialize(sink),
        }
    }
}

impl<'de> Deserialize<'de> for Size {
    fn deserialize<S: Deserializer<'de>>(source: S) -> Result<Self, S::Error> {
        struct SizeVisitor;
        impl<'de> Visitor<'de> for SizeVisitor {
            type Value = Size;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, or a table with coarse, fine, fine_until, coarse_from and axis")
            }

            fn visit_f64<E>(self, h: f64) -> Result<Size, E> {
                Ok(Size::Uniform(h))
            }

            fn visit_i64<E>(self, h: i64) -> Result<Size, E> {
                Ok(Size::Uniform(h as f64))
            }

            fn visit_map<M: MapAccess<'de>>(self, map: M) -> Result<Size, M::Error> {
                GradedSize::deserialize(MapAccessDeserializer::new(map)).map(Size::Graded)
            }
        }
        source.deserialize_any(SizeVisitor)
    }
}

impl Axis {
    /// Number of the axis, from 0.
    pub fn index(self) -> usize {
        self as usize
    }
}
