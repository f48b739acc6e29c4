//! `cargo xtask docs`: API documentation, generated pages, book.

use std::process::{Command, Stdio};

use crate::process::{Outcome, cargo, root, succeeds};
use crate::tidy;

/// Flags of the task.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Open the API documentation in a browser.
    #[arg(long)]
    open: bool,
}

/// Runs the task.
pub(crate) fn run(arguments: &Arguments) -> Outcome {
    tidy::write_generated_pages()?;
    let mut rustdoc = cargo(&["doc", "--workspace", "--no-deps"]);
    if arguments.open {
        rustdoc.arg("--open");
    }
    if !succeeds(&mut rustdoc)? {
        return Ok(false);
    }
    let has_mdbook = Command::new("mdbook").arg("--version").stdout(Stdio::null()).status().is_ok();
    if !has_mdbook {
        println!(
            "mdbook is not installed, so the book is not built: run `cargo install mdbook`, or read the files in docs/src"
        );
        return Ok(true);
    }
    succeeds(Command::new("mdbook").arg("build").arg(root().join("docs")))
}
