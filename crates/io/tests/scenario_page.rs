//! The tables of keys on the page `reference/scenario.md` are those of the declarations.
//!
//! `UPDATE_PAGES=1 cargo test -p io --test scenario_page` updates them.

use std::fmt::Write;
use std::path::Path;

use io::scenario::key::{Choice, Form, Range};
use io::scenario::{Key, Scenario, System, Units};

static ROOT: Form = Form::Table(Scenario::KEYS);

const BEGIN: &str = "<!-- keys: ";
const END: &str = "<!-- end of keys -->";

#[test]
fn the_page_has_the_declared_keys() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/src/reference/scenario.md");
    let found = std::fs::read_to_string(&path).expect("the page");
    let expected = with_tables(&found);
    if std::env::var_os("UPDATE_PAGES").is_some() {
        std::fs::write(&path, expected).expect("a writable page");
    } else {
        assert!(found == expected, "the page is out of date; run UPDATE_PAGES=1 cargo test -p io --test scenario_page");
    }
}

/// Returns the page with the tables between its markers replaced.
fn with_tables(page: &str) -> String {
    let sections: Vec<&str> = page.split(BEGIN).skip(1).filter_map(|rest| rest.split(" -->").next()).collect();
    let mut parts = page.split(BEGIN);
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (section, rest) = part.split_once(" -->").expect("a marker");
        let (_, after) = rest.split_once(END).expect("an end");
        let form = if section == "scenario" { &ROOT } else { find(&ROOT, section) };
        let outer = if section == "scenario" { "" } else { section };
        let mut table = Rows { text: String::new(), sections: &sections, outer };
        table.add("", form);
        let head = "| key | value | unit in cgs, SI | meaning |\n|---|---|---|---|\n";
        let _ = write!(out, "{BEGIN}{section} -->\n\n{head}{}\n{END}{after}", table.text);
    }
    out
}

/// Returns the type of the value at a path such as `body.shape`.
fn find(form: &'static Form, path: &str) -> &'static Form {
    let (name, rest) = path.split_once('.').unwrap_or((path, ""));
    let found = keys_of(form).into_iter().find(|key| key.name == name).unwrap_or_else(|| panic!("no key {path}"));
    if rest.is_empty() { &found.form } else { find(&found.form, rest) }
}

fn keys_of(form: &'static Form) -> Vec<&'static Key> {
    match form {
        Form::Table(keys) => keys.iter().collect(),
        Form::Choice { choices, .. } => choices.iter().flat_map(|choice| choice.keys).collect(),
        Form::List(of) | Form::Named(of) | Form::OrTable(_, of) => keys_of(of),
        _ => Vec::new(),
    }
}

struct Rows<'a> {
    text: String,
    /// Paths that have tables of their own.
    sections: &'a [&'a str],
    /// Path of this table.
    outer: &'a str,
}

impl Rows<'_> {
    fn add(&mut self, prefix: &str, form: &'static Form) {
        match form {
            Form::Table(keys) => keys.iter().for_each(|key| self.add_key(prefix, key)),
            Form::Choice { tag: Some(tag), choices } => {
                for Choice { word, about, keys } in *choices {
                    self.row(&format!("`{prefix}{tag} = \"{word}\"`"), "", "", about);
                    keys.iter().for_each(|key| self.add_key(prefix, key));
                }
            }
            Form::List(of) | Form::Named(of) | Form::OrTable(_, of) => self.add(prefix, of),
            _ => {}
        }
    }

    fn add_key(&mut self, prefix: &str, key: &'static Key) {
        let name = format!("{prefix}{}", key.name);
        let path = if self.outer.is_empty() { name.clone() } else { format!("{}.{name}", self.outer) };
        let has_section = self.sections.contains(&path.as_str());
        let mut value = match key.range {
            _ if has_section => "see below".to_owned(),
            Range::Any => key.form.to_string(),
            range => format!("{}, {range}", key.form),
        };
        match key.default {
            Some(default) if default != "{}" => value += &format!("; `{default}`"),
            _ if key.group.is_some() => value += "; alternative",
            _ if key.is_optional => value += "; optional",
            _ => {}
        }
        let mut about = key.about.trim().to_owned();
        if let Form::Choice { tag: None, choices } = key.form {
            for Choice { word, about: meaning, .. } in choices {
                let _ = write!(about, " `\"{word}\"`: {}", meaning.trim());
            }
        }
        let unit = [System::Cgs, System::Si].map(|system| Units::Plain(system).label(key.quantity));
        let unit = if unit[0] == unit[1] { unit[0].clone() } else { unit.join(", ") };
        self.row(&format!("`{name}`"), &value, &unit, &about);
        if !has_section {
            let inner = match key.form {
                Form::List(_) => format!("{name}[]."),
                Form::Named(_) => format!("{name}.NAME."),
                _ => format!("{name}."),
            };
            self.add(&inner, &key.form);
        }
    }

    fn row(&mut self, key: &str, value: &str, unit: &str, about: &str) {
        let _ = writeln!(self.text, "| {key} | {value} | {unit} | {} |", about.trim());
    }
}

#[test]
fn declarations_are_complete() {
    fn check(path: &str, form: &'static Form, n: &mut usize) {
        for key in keys_of(form) {
            let path = format!("{path}.{}", key.name);
            let about = key.about.trim();
            assert!(about.ends_with('.') && about.len() > 4, "{path} needs a sentence: {about}");
            *n += 1;
            check(&path, &key.form, n);
        }
    }
    let mut n = 0;
    check("", &ROOT, &mut n);
    assert!(n > 80, "{n} keys");
}
