//! The `shadercheck` command.

use std::process::ExitCode;

use shadercheck::cli::{Cli, run};

#[cfg(feature = "drivers")]
#[global_allocator]
static GLOBAL: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    let cli = Cli::read().unwrap_or_else(|error| error.exit());
    #[cfg(feature = "drivers")]
    devices(&cli.command);
    run(&cli).into()
}

/// What has to be set before a device is opened.
#[cfg(feature = "drivers")]
fn devices(command: &shadercheck::cli::Command) {
    use shadercheck::cli::{Command, node, worker};
    if let Some(program) = std::env::current_exe().ok().and_then(worker::program) {
        lanes::worker::set_program(program);
    }
    #[cfg(unix)]
    if let Command::Worker(_) = command {
        end_with_the_parent();
    }
    if command.opens_devices() {
        #[cfg(unix)]
        quiet_loader();
        lanes::webgpu::set_folder(node::package());
    }
}

/// A layer of Mesa's Vulkan loader asks for a Wayland display and prints an error line when
/// `XDG_RUNTIME_DIR` is not set, which is usual in CI. The variable must be there before the process
/// starts, so the process is started again with it, once.
#[cfg(all(unix, feature = "drivers"))]
fn quiet_loader() {
    use std::os::unix::process::CommandExt;
    const VARIABLE: &str = "XDG_RUNTIME_DIR";
    if std::env::var_os(VARIABLE).is_some() {
        return;
    }
    let Ok(this) = std::env::current_exe() else { return };
    // Only returns when it fails; then the line is printed, and nothing else changes.
    let _ =
        std::process::Command::new(this).args(std::env::args_os().skip(1)).env(VARIABLE, std::env::temp_dir()).exec();
}

/// A shader that does not end would keep this process busy after the one that sent it has gone.
#[cfg(all(unix, feature = "drivers"))]
fn end_with_the_parent() {
    use std::os::unix::process::parent_id;
    let parent = parent_id();
    std::thread::spawn(move || {
        loop {
            std::thread::sleep(std::time::Duration::from_secs(1));
            if parent_id() != parent {
                std::process::exit(2);
            }
        }
    });
}
