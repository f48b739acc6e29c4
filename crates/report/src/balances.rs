//! Balances of energy, of the forces on a body, and of volumes.

use io::HistoryTable;

use crate::html::{gallery, number, table};
use crate::{Curve, Error, Results};

/// Prefix of the columns of lost energy.
const LOST: &str = "lost_";

/// Energies, forces and volumes of a run.
pub(crate) struct Balances<'a> {
    pub(crate) results: &'a Results,
}

impl Balances<'_> {
    /// Returns the sum of a column over all bodies.
    fn of_bodies(&self, table: &HistoryTable, column: &str) -> Option<Vec<f64>> {
        let bodies = &self.results.summary.bodies;
        let columns = bodies.iter().map(|name| table.column(&format!("{}{column}", self.results.prefix(name))));
        let columns: Vec<_> = columns.collect::<Option<_>>()?;
        Some((0..table.n_rows()).map(|k| columns.iter().map(|column| column[k]).sum()).collect())
    }

    /// Returns the energies over time, and their sum.
    pub(crate) fn energies(&self) -> Result<String, Error> {
        let Results { history, diagnostics, summary, .. } = self.results;
        let units = &summary.units;
        let times = history.column("time").unwrap_or_default();
        let curve = |label: &str, values: Option<Vec<f64>>| {
            let values = values.unwrap_or_default();
            // Potential energy is known up to a constant.
            let shift = if label.starts_with("potential") { values.first().copied().unwrap_or(0.0) } else { 0.0 };
            Curve::new(label, times.iter().copied().zip(values.into_iter().map(|v| v - shift)).collect())
        };
        let energies = vec![
            curve("kinetic, bodies", self.of_bodies(history, "energy_kinetic_solid")),
            curve("elastic", self.of_bodies(history, "energy_elastic")),
            curve("potential of gravity", self.of_bodies(history, "energy_gravity")),
            curve("stored in contact", history.column("energy_contact")),
            curve("kinetic, fluid", history.column("energy_kinetic_fluid")),
        ];
        let mut each = self.results.over_time("energies", &units.energy, energies);
        each.caption = "The potential energy is zero at the first step.".to_owned();
        let sum = self.results.curve("sum of all energies", diagnostics, "total_energy");
        let mut sum = self.results.over_time("sum of all energies", &units.energy, vec![sum]);
        sum.caption = "Without work of inflow, prescribed motion or forces on the fluid it never grows: viscosity, \
                       stabilisation, open sides and the time scheme dissipate."
            .to_owned();
        Ok(gallery(&[each.html()?, sum.html()?]))
    }

    /// Returns the changes of energies and work from the last step before the first contact to its end; `None` without
    /// a contact.
    pub(crate) fn contact(&self) -> Option<String> {
        let Results { history, diagnostics, summary, .. } = self.results;
        let units = &summary.units;
        let times = history.column("time")?;
        let &(begin, end) = summary.contact_intervals.first()?;
        let first = times.iter().position(|t| *t >= begin - 1e-9)?.checked_sub(1)?;
        let last = end.map_or(times.len() - 1, |end| times.iter().position(|t| *t >= end - 1e-9).unwrap_or(first));
        let change = |values: Vec<f64>| Some(values.get(last)? - values.get(first)?);
        let work = |values: Vec<f64>| change(integral(&times, &values)?);
        let bodies_kinetic = self.of_bodies(history, "energy_kinetic_solid")?;
        let stored = history.column("energy_contact")?;
        let impact = bodies_kinetic[first];
        let largest = stored.get(first..=last)?.iter().copied().fold(0.0, f64::max);
        let kinetic = change(bodies_kinetic)?;
        let elastic = change(self.of_bodies(history, "energy_elastic")?)?;
        let gravity = change(self.of_bodies(history, "energy_gravity")?)?;
        let fluid = change(history.column("energy_kinetic_fluid")?)?;
        let by_contact = work(self.of_bodies(history, "contact_power")?)?;
        let by_fluid = work(self.of_bodies(diagnostics, "fluid_power")?)?;
        let rows = [
            ("change of the kinetic energy of the bodies", kinetic),
            ("change of the elastic energy", elastic),
            ("change of the potential energy of gravity", gravity),
            ("change of the kinetic energy of the fluid", fluid),
            ("work of the fluid on the bodies", by_fluid),
            ("work of contact on all bodies, also those of prescribed motion", by_contact),
            ("largest energy stored in the contact", largest),
        ];
        let row = |(what, value): &(&str, f64)| {
            vec![(*what).to_owned(), number(*value), format!("{} %", number((1e3 * value / impact).round() / 10.0))]
        };
        let caption = format!(
            "Energy in the first contact, from {} to {} {}, and relative to the kinetic energy of the bodies before it, \
             {} {}.",
            number(times[first]),
            number(times[last]),
            units.time,
            number(impact),
            units.energy,
        );
        let head = ["", &units.energy, "of the impact"];
        Some(table(&caption, &head, &rows.iter().map(row).collect::<Vec<_>>()))
    }

    /// Returns the energy that each part of the discrete problem removed: stacked over time, and summed before, during
    /// and after the first contact.
    pub(crate) fn losses(&self) -> Result<String, Error> {
        let Results { history, diagnostics, summary, .. } = self.results;
        let (units, times) = (&summary.units, history.column("time").unwrap_or_default());
        let contact = summary.contact_intervals.first();
        let begin = contact.map_or(f64::INFINITY, |(begin, _)| *begin);
        let end = contact.and_then(|(_, end)| *end).unwrap_or(f64::INFINITY);
        let mut stacked = vec![0.0; times.len()];
        let (mut curves, mut rows) = (Vec::new(), Vec::new());
        for name in diagnostics.bare_names().filter(|name| name.starts_with(LOST)) {
            let lost = diagnostics.column(name).unwrap_or_default();
            let sum = |from: f64, to: f64| -> f64 {
                times.iter().zip(&lost).filter(|(t, _)| from <= **t && **t < to).map(|(_, lost)| lost).sum()
            };
            if lost.iter().all(|lost| *lost == 0.0) {
                continue;
            }
            let label = name[LOST.len()..].replace('_', " ");
            let phases = [sum(f64::NEG_INFINITY, begin), sum(begin, end), sum(end, f64::INFINITY)];
            rows.push([vec![label.clone()], phases.map(number).to_vec()].concat());
            let mut so_far = 0.0;
            for (height, lost) in stacked.iter_mut().zip(&lost) {
                so_far += lost;
                *height += so_far;
            }
            curves.push(Curve::new(label, times.iter().copied().zip(stacked.iter().copied()).collect()));
        }
        let mut chart = self.results.over_time("energy lost so far, stacked", &units.energy, curves);
        chart.caption =
            "Each curve is the sum of its line and of those before it. The last one is the energy that the run lost; \
                         `defect` is the part that is in no other line."
                .to_owned();
        let caption =
            format!("Energy that each part of the discrete problem took, {}; negative: it gave energy.", units.energy);
        let head = ["", "before the first contact", "during it", "after it"];
        Ok(table(&caption, &head, &rows) + &gallery(&[chart.html()?]))
    }

    pub(crate) fn balances(&self) -> Result<String, Error> {
        Ok(gallery(&[self.forces()?, format!("<div>{}</div>", self.volumes())]))
    }

    /// Returns the vertical forces on the leading body, and their remainder; empty if its motion is prescribed.
    fn forces(&self) -> Result<String, Error> {
        let Results { diagnostics, summary, .. } = self.results;
        let units = &summary.units;
        let forces = [
            ("inertia", "force_inertia"),
            ("pressure", "force_pressure"),
            ("viscous", "force_viscous"),
            ("mortar penalty", "force_penalty"),
            ("contact", "force_contact"),
            ("gravity", "force_gravity"),
        ];
        let name = |column: &str| format!("{}{column}", self.results.leading_prefix());
        let remainder = diagnostics.column(&name("force_remainder")).unwrap_or_default();
        if !remainder.iter().any(|r| r.is_finite()) {
            return Ok(String::new());
        }
        let exchange = ("exchange of traction", "force_exchange");
        let exchanges = diagnostics.column(&name(exchange.1)).is_some_and(|forces| forces.iter().any(|f| *f != 0.0));
        let forces = forces.into_iter().chain(exchanges.then_some(exchange));
        let curves: Vec<_> =
            forces.map(|(label, column)| self.results.curve(label, diagnostics, &name(column))).collect();
        let largest = curves.iter().flat_map(|curve| &curve.points).map(|(_, f)| f.abs()).fold(0.0, f64::max);
        let error = remainder.iter().map(|r| r.abs()).fold(0.0, f64::max) / largest.max(f64::MIN_POSITIVE);
        let mut chart = self.results.over_time("vertical forces", &units.force, curves);
        chart.caption = format!("Inertia is the sum of all others, up to {} of the largest force.", number(error));
        chart.html()
    }

    fn volumes(&self) -> String {
        let Results { history, diagnostics, summary, .. } = self.results;
        let units = &summary.units;
        let largest = |column: &str| Some(history.column(column)?.iter().map(|v| v.abs()).fold(0.0, f64::max));
        let drift = |values: Option<Vec<f64>>| {
            let values = values?;
            let first = *values.first()?;
            Some(values.iter().map(|v| (v - first).abs()).fold(0.0, f64::max) / first.abs())
        };
        let net = || integral(&history.column("time")?, &history.column("leak_net")?)?.last().copied();
        let volume = diagnostics.column(&format!("{}volume", self.results.leading_prefix()));
        let smallest = |values: Vec<f64>| values.into_iter().fold(1.0, f64::min);
        let relative_leak = summary.max_interface_leak;
        let rows = [
            ("largest net leak through the interface", largest("leak_net"), units.flow.as_str()),
            ("largest absolute leak", largest("leak_absolute"), &units.flow),
            ("largest absolute leak, relative to the flow that the bodies displace", relative_leak, ""),
            ("fluid gained through the interface over the whole run", net(), &units.volume),
            ("largest relative change of the volume of the fluid", drift(diagnostics.column("fluid_volume")), ""),
            ("largest relative change of the volume of the leading body", drift(volume), ""),
            (
                "smallest fluid part of a cell, relative to the cell",
                history.column("smallest_fraction").map(smallest),
                "",
            ),
        ];
        let row = |(what, value, unit): (&str, Option<f64>, &str)| {
            let value = value.filter(|value| value.is_finite())?;
            Some(vec![what.to_owned(), format!("{} {unit}", number(value))])
        };
        table("", &["", ""], &rows.into_iter().filter_map(row).collect::<Vec<_>>())
    }
}

/// Returns the integrals of a rate from the start of the run to the end of the step of each row. The rate is constant
/// over a step. `None` if the lists have different lengths.
fn integral(times: &[f64], rates: &[f64]) -> Option<Vec<f64>> {
    let (mut sum, mut begin) = (0.0, 0.0);
    let mut add = |(&end, &rate): (&f64, &f64)| {
        sum += rate * (end - begin);
        begin = end;
        sum
    };
    (times.len() == rates.len()).then(|| times.iter().zip(rates).map(&mut add).collect())
}

#[cfg(test)]
mod tests {
    use super::integral;

    #[test]
    fn a_rate_holds_over_the_step_that_ends_in_its_row() {
        assert_eq!(integral(&[0.5, 2.0], &[4.0, -1.0]), Some(vec![2.0, 0.5]));
        assert_eq!(integral(&[0.5], &[4.0, -1.0]), None);
    }
}
