//! Variables of the environment that keep graphics drivers quiet.

/// Starts the program anew with a place for sockets where the environment names none. Mesa's layer that orders devices
/// looks there for Wayland's, and complains on standard error when it does not know where to look.
#[cfg(target_os = "linux")]
pub fn keep_quiet() {
    use std::env;
    use std::os::unix::process::CommandExt;
    use std::path::Path;
    use std::process::Command;

    /// Names an absolute path, and is empty or missing where nobody is logged in.
    const SOCKETS: &str = "XDG_RUNTIME_DIR";

    if env::var_os(SOCKETS).is_some_and(|place| Path::new(&place).is_absolute()) {
        return;
    }
    let mut arguments = env::args_os();
    let (Some(name), Ok(program)) = (arguments.next(), env::current_exe()) else { return };
    // Under the dynamic linker or an interpreter the running program is another than the one that was named.
    if Path::new(&name).file_name() != program.file_name() {
        return;
    }
    // Variables cannot be changed safely in a running program. This returns only where it fails, and then the
    // complaint is the lesser evil.
    let _ = Command::new(program).arg0(name).args(arguments).env(SOCKETS, "/").exec();
}

/// Nothing complains.
#[cfg(not(target_os = "linux"))]
pub const fn keep_quiet() {}
