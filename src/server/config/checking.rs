//! The arguments of `toolpathd check`.

use std::path::PathBuf;

use clap::Args;

use crate::receipt::PublicKey;

/// A receipt, and what it is of.
#[derive(Debug, Clone, Args)]
pub struct Checking {
    /// The receipt, or an answer that holds it, in JSON
    pub receipt: PathBuf,

    /// The program: NC text, or the toolpath in JSON where a toolpath was verified
    pub program: PathBuf,

    /// An object in JSON with the part, the tools, the stock, the fixtures and the travel, named as in the
    /// request that was verified; that request itself will do
    pub part: PathBuf,

    /// File with the public key that has to have signed the receipt, in PEM, as `openssl pkey -pubout` writes
    /// it
    #[arg(long)]
    pub key: Option<PublicKey>,
}
