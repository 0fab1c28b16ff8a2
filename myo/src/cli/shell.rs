//! `myo completions` and `myo man`: what a shell and a reader of manuals want to know, from the declarations of the commands.

use std::path::{Path, PathBuf};

use clap::{Args, CommandFactory};
use clap_complete::Shell;
use clap_mangen::Man;
use myo::train::write_whole;

use super::Cli;
use super::failure::{Failure, Result};
use super::output::print_file;

/// Arguments of `myo completions`.
#[derive(Args)]
#[command(after_help = "Examples:
  myo completions bash > ~/.local/share/bash-completion/completions/myo
  myo completions zsh > ~/.zfunc/_myo                 a folder in $fpath
  myo completions fish > ~/.config/fish/completions/myo.fish")]
pub struct Completions {
    /// Shell that completes
    #[arg(value_enum)]
    shell: Shell,
}

/// Arguments of `myo man`.
#[derive(Args)]
#[command(after_help = "Examples:
  myo man | man -l -
  myo man task check | man -l -
  myo man --out ~/.local/share/man/man1           the pages of all commands")]
pub struct Manual {
    /// Command to print the page of, such as `train` or `task check` [default: the program]
    #[arg(value_name = "COMMAND")]
    command: Vec<String>,

    /// Existing folder to write the pages of all commands into instead
    #[arg(long, value_name = "DIR", conflicts_with = "command")]
    out: Option<PathBuf>,
}

/// Runs `myo completions`.
pub fn completions(args: &Completions) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "myo", &mut script);
    print_file(&String::from_utf8(script)?)
}

/// Runs `myo man`.
pub fn manual(args: &Manual) -> Result<()> {
    let program = program();
    match &args.out {
        Some(folder) => write_pages(&program, folder),
        None => print_file(&page(find(&program, &args.command)?)?),
    }
}

/// The program with everything that its commands inherit from it.
fn program() -> clap::Command {
    let mut program = Cli::command().disable_help_subcommand(true);
    program.build();
    program
}

fn find<'a>(program: &'a clap::Command, words: &[String]) -> Result<&'a clap::Command> {
    words.iter().try_fold(program, |command, word| {
        command.find_subcommand(word).ok_or_else(|| {
            let known: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
            let known =
                if known.is_empty() { "it has no commands".into() } else { format!("there are {}", known.join(", ")) };
            Failure::sentence(format!("`{}` has no command `{word}`; {known}", command.get_bin_name().unwrap_or("myo")))
        })
    })
}

fn page(command: &clap::Command) -> Result<String> {
    let mut page = Vec::new();
    Man::new(command.clone()).manual("Myo").render(&mut page)?;
    // What stands below the options of `--help`: examples, and what the output means.
    Ok(String::from_utf8(page)?.replace(".SH EXTRA\n", ".SH NOTES\n"))
}

fn write_pages(command: &clap::Command, folder: &Path) -> Result<()> {
    let name = command.get_display_name().unwrap_or_else(|| command.get_name());
    write_whole(&folder.join(format!("{name}.1")), page(command)?.as_bytes())?;
    command.get_subcommands().try_for_each(|command| write_pages(command, folder))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All commands below one, itself included, with the words that lead there.
    fn all<'a>(command: &'a clap::Command, words: &[&'a str]) -> Vec<(Vec<&'a str>, &'a clap::Command)> {
        let below = command.get_subcommands().flat_map(|sub| all(sub, &[words, &[sub.get_name()]].concat()));
        [(words.to_vec(), command)].into_iter().chain(below).collect()
    }

    fn options(command: &clap::Command) -> impl Iterator<Item = &str> {
        command.get_arguments().filter_map(clap::Arg::get_long)
    }

    #[test]
    fn every_command_has_a_page_with_its_options() {
        let program = program();
        let commands = all(&program, &[]);
        assert!(commands.len() > 15);
        for (words, command) in commands {
            let words: Vec<String> = words.into_iter().map(String::from).collect();
            // Hyphens are escaped, so that they can be copied from the page.
            let page = page(find(&program, &words).unwrap()).unwrap().replace(r"\-", "-");
            assert!(page.contains(".SH NAME") && page.contains(".SH SYNOPSIS"), "{words:?}");
            for option in options(command) {
                assert!(page.contains(&format!("--{option}")), "{words:?} --{option}: {page}");
            }
            let is_leaf = command.get_subcommands().next().is_none();
            assert!(!is_leaf || page.contains(".SH NOTES\nExample"), "{words:?}: {page}");
        }
    }

    #[test]
    fn every_shell_knows_every_command_and_option() {
        use clap::ValueEnum;
        for &shell in Shell::value_variants() {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "myo", &mut script);
            let script = String::from_utf8(script).unwrap();
            for (words, command) in all(&program(), &[]) {
                let names = words.into_iter().chain(options(command));
                let missing: Vec<_> = names.filter(|name| !script.contains(name)).collect();
                assert!(missing.is_empty(), "{shell}: {missing:?}");
            }
        }
    }
}
