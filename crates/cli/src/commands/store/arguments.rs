//! The arguments of `sphcut store`.

use clap::{Args, Subcommand};
use std::path::PathBuf;

const HELP: &str = "\
Examples:
  sphcut store ls out/sweep/store         every result with what it took
  sphcut store verify out/sweep/store     read every file and compare it with what was written
  sphcut store gc out/sweep/store         what no sweep needs; --remove removes it";

/// Arguments of `store`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct StoreArguments {
    /// What to do.
    #[command(subcommand)]
    pub command: StoreCommand,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum StoreCommand {
    /// List results, failures and unfinished runs.
    Ls {
        /// Folder of the store.
        store: PathBuf,
        /// As JSON.
        #[arg(long)]
        json: bool,
    },
    /// Compare every file with its checksum.
    Verify(VerifyArguments),
    /// Show what no sweep needs whose output folder is still there, and remove it if asked to.
    Gc(GcArguments),
}

/// Arguments of `store verify`.
#[derive(Debug, Args)]
pub struct VerifyArguments {
    /// Folder of the store.
    pub store: PathBuf,
    /// Take damaged results out of the store.
    #[arg(long)]
    pub remove: bool,
}

/// Arguments of `store gc`.
#[derive(Debug, Args)]
pub struct GcArguments {
    /// Folder of the store.
    pub store: PathBuf,
    /// Remove it.
    #[arg(long)]
    pub remove: bool,
}
