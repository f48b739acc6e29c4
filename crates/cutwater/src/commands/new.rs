//! `cutwater new`

use std::fs::File;
use std::io::{ErrorKind, Write as _};

use cutwater::io::Error;

use super::print;
use crate::{NewArguments, Template};

impl Template {
    fn text(self) -> &'static str {
        match self {
            Self::Fall => include_str!("../../templates/fall.toml"),
            Self::Flow => include_str!("../../templates/flow.toml"),
            Self::Impact => include_str!("../../templates/impact.toml"),
        }
    }
}

/// Writes a commented scenario that runs as it is, under a name that does not exist yet.
pub(crate) fn new(arguments: &NewArguments) -> Result<(), Error> {
    let path = arguments.file.with_extension("toml");
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    // Quotes and backslashes of a name are escaped in TOML as they are in Rust.
    let text = arguments.template.text().replace("\"NAME\"", &format!("{name:?}")).replace("NAME", &name);
    let written = |source| Error::Write { path: path.clone(), source };
    if arguments.file.file_name().is_none() {
        let source = std::io::Error::new(ErrorKind::InvalidInput, "it has no file name; give one, such as fall.toml");
        return Err(written(source));
    }
    if !cutwater::io::scenario::is_name(&name) {
        let problem = "its name is that of the results: use letters, digits, -, _ and dots inside";
        return Err(written(std::io::Error::new(ErrorKind::InvalidInput, problem)));
    }
    let mut file = File::create_new(&path).map_err(|source| match source.kind() {
        ErrorKind::AlreadyExists => {
            written(std::io::Error::new(source.kind(), "it exists; choose another name, or remove it"))
        }
        _ => written(source),
    })?;
    file.write_all(text.as_bytes()).map_err(written)?;
    let shown = path.display();
    print(&format!("{shown} is written; change it, then `cutwater check {shown}` and `cutwater run {shown}`"))
}
