//! Output, files and exit codes of the commands.

#[cfg(unix)]
mod checkpoints;
mod compare;
mod cut;
mod directories;
mod mesh;
mod run;
mod setting;
mod templates;
