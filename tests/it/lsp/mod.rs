//! The language server over its real transport: the binary, with messages on its standard input and output.

mod client;
mod commands;
mod editing;
mod neovim;
mod robust;
