//! Where the energy goes in a contact, what the forces on a body add up to, and how well volumes are kept.

use super::html::{chart, gallery, number, table};
use crate::Error;
use crate::history::HistoryTable;
use crate::plot::{Curve, Panel, column_curve};
use crate::summary::Summary;

/// What history and diagnostics of a run say about energy, forces and volumes of its leading body.
pub(super) struct Ledger<'a> {
    pub(super) history: &'a HistoryTable,
    pub(super) diagnostics: &'a HistoryTable,
    pub(super) summary: &'a Summary,
    /// Prefix of the columns of the leading body.
    pub(super) prefix: &'a str,
    /// Prefixes of all bodies.
    pub(super) prefixes: &'a [String],
}

impl Ledger<'_> {
    fn of_body(&self, column: &str) -> Option<Vec<f64>> {
        self.history.column(&format!("{}{column}", self.prefix))
    }

    /// Sum of a column over all bodies.
    fn of_bodies(&self, table: &HistoryTable, column: &str) -> Option<Vec<f64>> {
        let columns: Option<Vec<_>> = self.prefixes.iter().map(|p| table.column(&format!("{p}{column}"))).collect();
        let columns = columns?;
        Some((0..table.len()).map(|k| columns.iter().map(|column| column[k]).sum()).collect())
    }

    /// The energies over time.
    pub(super) fn energies(&self) -> Result<String, Error> {
        let times = self.history.column("time").unwrap_or_default();
        let curve = |label: &str, colour: usize, values: Option<Vec<f64>>| {
            let values = values.unwrap_or_default();
            let first = values.first().copied().unwrap_or(0.0);
            // Potentials are known up to a constant.
            let shift = if label == "gravity" { first } else { 0.0 };
            let points = times.iter().copied().zip(values.into_iter().map(|v| v - shift)).collect();
            Curve { label: label.to_owned(), colour, points, dots: false }
        };
        let energies = vec![
            curve("kinetic, bodies", 0, self.of_bodies(self.history, "energy_kinetic_solid")),
            curve("elastic", 1, self.of_bodies(self.history, "energy_elastic")),
            curve("kinetic, fluid", 2, self.history.column("energy_kinetic_fluid")),
            curve("contact", 3, self.history.column("energy_contact")),
            curve("gravity", 4, self.of_bodies(self.history, "energy_gravity")),
        ];
        let sum = Curve { points: column_curve(self.diagnostics, "total_energy"), ..Curve::default() };
        let figures = [
            chart(
                &Panel::over_time("energies [erg/cm]", energies),
                "Energies over time; that of gravity is zero at the first step.",
            )?,
            chart(
                &Panel::over_time("sum of all energies [erg/cm]", vec![sum]),
                "Their sum: it must never grow. What it loses is taken by viscosity, stabilisation, open sides and \
                 implicit Euler.",
            )?,
        ];
        Ok(gallery(&figures))
    }

    /// Who gives and takes energy from the last step before the first contact to its end; empty without a contact.
    pub(super) fn contact(&self) -> Option<String> {
        let times = self.history.column("time")?;
        let &(begin, end) = self.summary.contact_intervals.first()?;
        let first = times.iter().position(|t| *t >= begin - 1e-9)?.checked_sub(1)?;
        let last = end.map_or(times.len() - 1, |end| times.iter().position(|t| *t >= end - 1e-9).unwrap_or(first));
        let change = |values: &[f64]| values.get(last).zip(values.get(first)).map(|(b, a)| b - a);
        let work = |values: &[f64]| Some(integral(&times, values)?[last] - integral(&times, values)?[first]);
        let kinetic = change(&self.of_bodies(self.history, "energy_kinetic_solid")?)?;
        let elastic = change(&self.of_bodies(self.history, "energy_elastic")?)?;
        let gravity = change(&self.of_bodies(self.history, "energy_gravity")?)?;
        let fluid = change(&self.history.column("energy_kinetic_fluid")?)?;
        let stored = self.history.column("energy_contact")?;
        let released = change(&stored)?;
        let by_contact = work(&self.of_bodies(self.history, "contact_power")?)?;
        let by_fluid = work(&self.of_bodies(self.diagnostics, "fluid_power")?)?;
        let impact = self.of_bodies(self.history, "energy_kinetic_solid")?[first];
        let largest = stored.get(first..=last)?.iter().copied().fold(0.0, f64::max);
        let taken_from_bodies = by_fluid + by_contact - (kinetic + elastic + gravity);
        let rows = [
            ("change of the kinetic energy of the bodies", kinetic),
            ("change of the elastic energy", elastic),
            ("change of the potential energy of gravity", gravity),
            ("change of the kinetic energy of the fluid", fluid),
            ("work of the fluid on the bodies", by_fluid),
            ("work of contact on the bodies", by_contact),
            ("taken from the bodies by implicit Euler", taken_from_bodies),
            ("taken from the contact by implicit Euler", -by_contact - released),
            ("taken from the fluid: viscosity, stabilisation, implicit Euler, open sides", -by_fluid - fluid),
            ("most that the contact stored", largest),
        ];
        let row = |(what, value): &(&str, f64)| {
            vec![(*what).to_owned(), number(*value), format!("{} %", number((1e3 * value / impact).round() / 10.0))]
        };
        let caption = format!(
            "Energy ledger of the first contact, {} to {} s, in erg/cm and relative to the kinetic energy of the bodies \
             before it, {} erg/cm. What implicit Euler takes is what is missing between work and energies.",
            number(times[first]),
            number(times[last]),
            number(impact)
        );
        let head = ["", "erg/cm", "of the impact"];
        Some(table(&caption, &head, &rows.iter().map(row).collect::<Vec<_>>()))
    }

    /// The vertical forces on the body, and how well they balance.
    pub(super) fn forces(&self) -> Result<Option<String>, Error> {
        let forces = [
            ("inertia", "force_inertia", 0),
            ("pressure", "force_pressure", 1),
            ("contact", "force_contact", 3),
            ("gravity", "force_gravity", 4),
            ("mortar penalty", "force_penalty", 2),
            ("viscous", "force_viscous", 5),
        ];
        let name = |column: &str| format!("{}{column}", self.prefix);
        let remainder = self.diagnostics.column(&name("force_remainder"));
        // A body of prescribed motion has no balance.
        let Some(remainder) = remainder.filter(|r| r.iter().any(|r| r.is_finite())) else { return Ok(None) };
        let mut largest = 0.0_f64;
        let mut curves = Vec::new();
        for (label, column, colour) in forces {
            let points = column_curve(self.diagnostics, &name(column));
            largest = points.iter().map(|(_, f)| f.abs()).filter(|f| f.is_finite()).fold(largest, f64::max);
            curves.push(Curve { label: label.to_owned(), colour, points, dots: false });
        }
        let error = remainder.iter().map(|r| r.abs()).fold(0.0, f64::max) / largest.max(f64::MIN_POSITIVE);
        let caption = format!(
            "Vertical forces on the body. Inertia is the sum of all others up to {} of the largest force.",
            number(error)
        );
        Ok(Some(chart(&Panel::over_time("vertical forces [dyn/cm]", curves), &caption)?))
    }

    /// Leaks and volumes.
    pub(super) fn volumes(&self) -> String {
        let mut rows = Vec::new();
        let mut add = |what: &str, value: Option<f64>, unit: &str| {
            if let Some(value) = value {
                rows.push(vec![what.to_owned(), format!("{} {unit}", number(value))]);
            }
        };
        let largest = |column: &str| {
            let values = self.history.column(column)?;
            Some(values.iter().map(|v| v.abs()).fold(0.0, f64::max))
        };
        let drift = |values: Option<Vec<f64>>| {
            let values = values?;
            let first = *values.first()?;
            Some(values.iter().map(|v| (v - first).abs()).fold(0.0, f64::max) / first.abs())
        };
        add("largest net leak through the interface", largest("leak_net"), "cm²/s");
        add("largest absolute leak", largest("leak_absolute"), "cm²/s");
        add("largest net leak over the flow that the bodies displace", Some(self.summary.max_interface_leak), "");
        let times = self.history.column("time");
        let net = times.zip(self.history.column("leak_net")).and_then(|(t, v)| integral(&t, &v)?.last().copied());
        add("fluid gained through the interface over the whole run", net, "cm²");
        add("largest relative change of the fluid's volume", drift(self.diagnostics.column("fluid_volume")), "");
        let volume = self.diagnostics.column(&format!("{}volume", self.prefix));
        add("largest relative change of the body's volume (it is compressible)", drift(volume), "");
        let fraction = self.history.column("smallest_fraction");
        add("smallest fraction of a cell that a cut left", fraction.map(|v| v.into_iter().fold(1.0, f64::min)), "");
        add(
            "largest vertical velocity of the centre",
            self.of_body("centre_velocity").map(|v| v.iter().map(|v| v.abs()).fold(0.0, f64::max)),
            "cm/s",
        );
        table("What is lost and what is kept", &["", ""], &rows)
    }
}

/// Integrals of a rate from the start to the end of each row's step, over which it holds; `None` if a row is missing.
fn integral(times: &[f64], rates: &[f64]) -> Option<Vec<f64>> {
    let (mut sum, mut begin) = (0.0, 0.0);
    let mut add = |(&end, &rate): (&f64, &f64)| {
        sum += rate * (end - begin);
        begin = end;
        sum
    };
    (times.len() == rates.len()).then(|| times.iter().zip(rates).map(&mut add).collect())
}
