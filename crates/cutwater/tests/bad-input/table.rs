//! The table of mistakes.

use std::collections::BTreeMap;

use serde::Deserialize;

/// The table.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Table {
    /// Good scenarios by their names.
    base: BTreeMap<String, String>,
    pub(crate) section: Vec<Section>,
}

/// Mistakes of one kind.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Section {
    pub(crate) title: String,
    pub(crate) row: Vec<Row>,
}

/// A mistake and its message; the head of the table describes the keys.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Row {
    pub(crate) mistake: String,
    #[serde(default = "flow")]
    base: String,
    change: Option<[String; 2]>,
    scenario: Option<String>,
    #[serde(default)]
    pub(crate) files: BTreeMap<String, String>,
    #[serde(default)]
    pub(crate) bytes: BTreeMap<String, String>,
    #[serde(default)]
    pub(crate) folders: Vec<String>,
    #[serde(default)]
    pub(crate) before: Vec<Vec<String>>,
    #[serde(default)]
    sets: Vec<String>,
    command: Option<Vec<String>>,
    line_of: Option<String>,
    key: Option<String>,
    #[serde(default = "refused")]
    pub(crate) code: i32,
    says: Vec<String>,
}

fn flow() -> String {
    "flow".to_owned()
}

/// Returns the exit code of input that cannot be used.
fn refused() -> i32 {
    2
}

impl Table {
    pub(crate) fn read() -> Self {
        toml::from_str(include_str!("table.toml")).unwrap_or_else(|error| panic!("{error}"))
    }
}

impl Row {
    /// Returns the scenario with the mistake.
    pub(crate) fn scenario(&self, table: &Table) -> String {
        let good = self.scenario.as_ref().unwrap_or_else(|| &table.base[&self.base]);
        let Some([from, to]) = &self.change else { return good.clone() };
        assert!(good.contains(from.as_str()), "{}: the scenario does not contain {from}", self.mistake);
        good.replacen(from, to, 1)
    }

    /// Returns the arguments of the command.
    pub(crate) fn command(&self) -> Vec<String> {
        let check = || {
            let sets = self.sets.iter().flat_map(|set| ["--set", set]);
            ["check", "scenario.toml"].into_iter().chain(sets).map(str::to_owned).collect()
        };
        self.command.clone().unwrap_or_else(check)
    }

    /// Returns the place of the mistake as the message states it.
    fn place(&self, table: &Table) -> Option<String> {
        let place = match &self.sets[..] {
            [set, ..] => format!("--set {set}"),
            [] => {
                let (scenario, mark) = (self.scenario(table), self.line_of.clone());
                let mark = mark.or_else(|| Some(self.change.as_ref()?[1].clone())).unwrap_or_default();
                let begin = scenario.find(&mark).unwrap_or_else(|| panic!("{}: no line of {mark}", self.mistake));
                format!("scenario.toml:{}", scenario[..begin].matches('\n').count() + 1)
            }
        };
        match self.key.as_deref()? {
            "" => Some(format!("{place}: ")),
            key => Some(format!("{place}: {key}: ")),
        }
    }

    /// Returns the texts that the message contains.
    pub(crate) fn says(&self, table: &Table) -> Vec<String> {
        self.place(table).into_iter().chain(self.says.iter().cloned()).collect()
    }
}
