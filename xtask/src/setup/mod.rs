//! Makes a machine able to run shaders and tests: installs what is missing where that needs no password, and says in one
//! sentence what is missing where it cannot.

mod needs;
mod readers;

use std::io::{self, Write};

use crate::host::{Host, on_path};
use crate::vulkan::{self, Found};
pub use needs::browser;
use needs::{DRIVER, FOR_TESTS, Need, OPENGL, TRANSLATOR};
pub use readers::{Packages, prepare_packages};

/// How apt-get can be run as the administrator.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Rights {
    Root,
    Sudo,
    None,
}

/// Installs what the lanes of a usual run need, as far as it is missing and permitted. Whatever happens, the run goes on:
/// it reports a lane that is absent itself.
pub fn prepare_lanes(host: &mut dyn Host, messages: &mut dyn Write) -> io::Result<()> {
    prepare(host, messages)?;
    prepare_translator(host, messages)?;
    prepare_opengl(host, messages)
}

/// Installs what single tests need beside the lanes; whether all of it is there.
pub fn prepare_tests(host: &mut dyn Host, messages: &mut dyn Write) -> io::Result<bool> {
    let mut all = true;
    for (missing, need) in &FOR_TESTS {
        all &= (need.there)(host) || provide(host, messages, need, missing)?;
    }
    Ok(all)
}

/// Installs a Vulkan driver when there is none.
fn prepare(host: &mut dyn Host, messages: &mut dyn Write) -> io::Result<()> {
    let found = vulkan::find(host);
    if !cfg!(target_os = "linux") || found.complete() {
        return Ok(());
    }
    if let (Some(name), true) = (found.pinned_by, found.driver.is_none()) {
        // Installing would not help: the variable hides whatever is installed.
        return writeln!(
            messages,
            "xtask: {name} names no usable Vulkan driver, so no shader can run on the lane `vulkan`: unset it or point it to a manifest"
        );
    }
    provide(host, messages, &DRIVER, missing(&found)).map(drop)
}

/// The same for the translator that the lane `vulkan-glslang` runs.
fn prepare_translator(host: &mut dyn Host, messages: &mut dyn Write) -> io::Result<()> {
    if !cfg!(target_os = "linux") || (TRANSLATOR.there)(host) {
        return Ok(());
    }
    provide(host, messages, &TRANSLATOR, "glslangValidator").map(drop)
}

/// The same for the drivers of the lanes `opengl`, `opengl-softpipe` and `opengl-zink`.
fn prepare_opengl(host: &mut dyn Host, messages: &mut dyn Write) -> io::Result<()> {
    if !cfg!(target_os = "linux") || (OPENGL.there)(host) {
        return Ok(());
    }
    provide(host, messages, &OPENGL, "Mesa's OpenGL").map(drop)
}

/// Installs it; whether it is there now.
fn provide(host: &mut dyn Host, messages: &mut dyn Write, need: &Need, missing: &str) -> io::Result<bool> {
    let apt = on_path(host, "apt-get").is_some();
    let rights = if apt { rights(host) } else { Rights::None };
    let forbidden = host.var("SHADERCHECK_NO_INSTALL").is_some_and(|value| value != "0");
    let failure = match rights {
        _ if forbidden => Some("SHADERCHECK_NO_INSTALL forbids to install it".to_owned()),
        Rights::None if apt => Some("installing needs a password".to_owned()),
        Rights::None => None,
        Rights::Root | Rights::Sudo => {
            writeln!(messages, "xtask: {missing} is missing: installing {} with apt-get", need.packages.join(" and "))?;
            match install(host, rights, need.packages) {
                Ok(()) if (need.there)(host) => {
                    writeln!(messages, "xtask: installed; {}", need.ready)?;
                    return Ok(true);
                }
                Ok(()) => Some("apt-get reported success and it is still not found".to_owned()),
                Err(failure) => Some(failure),
            }
        }
    };
    let because = failure.map(|failure| format!(" ({failure})")).unwrap_or_default();
    writeln!(
        messages,
        "xtask: {missing} is missing{because}, so {}: {}",
        need.without,
        advice(host, apt, rights, need)
    )?;
    Ok(false)
}

fn missing(found: &Found) -> &'static str {
    match (found.loader, found.driver.is_some()) {
        (false, false) => "a Vulkan driver with its loader",
        (false, true) => "the Vulkan loader libvulkan.so.1",
        (true, _) => "a Vulkan driver",
    }
}

fn advice(host: &dyn Host, apt: bool, rights: Rights, need: &Need) -> String {
    if apt {
        let sudo = if rights == Rights::Root { "" } else { "sudo " };
        return format!(
            "run `{sudo}apt-get update && {sudo}apt-get install -y --no-install-recommends {}`",
            need.packages.join(" ")
        );
    }
    let known = need.elsewhere.iter().find(|(manager, _)| on_path(host, manager).is_some());
    known.map_or_else(
        || format!("install {} with this system's package manager", need.what),
        |(_, command)| format!("run `{command}`"),
    )
}

fn rights(host: &mut dyn Host) -> Rights {
    let succeeds = |outcome: Option<crate::host::Outcome>| outcome.filter(|outcome| outcome.success);
    if succeeds(host.run(&["id", "-u"])).is_some_and(|outcome| outcome.output.trim() == "0") {
        Rights::Root
    } else if succeeds(host.run(&["sudo", "-n", "true"])).is_some() {
        Rights::Sudo
    } else {
        Rights::None
    }
}

/// Updates the lists and installs; an error says which step failed and apt-get's own reason.
fn install(host: &mut dyn Host, rights: Rights, packages: &[&str]) -> Result<(), String> {
    // A desktop's own updates may hold the lock: wait for it and do not fail at once.
    let apt = ["env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "-q", "-o", "DPkg::Lock::Timeout=120"];
    let sudo: &[&str] = if rights == Rights::Sudo { &["sudo", "-n"] } else { &[] };
    let install = [&["install", "-y", "--no-install-recommends"][..], packages].concat();
    for step in [&["update"][..], &install] {
        let name = step[0];
        let outcome = host.run(&[sudo, &apt, step].concat()).ok_or_else(|| format!("cannot start apt-get {name}"))?;
        if !outcome.success {
            let reason = outcome.output.lines().rfind(|line| line.starts_with("E: ")).unwrap_or("no reason given");
            return Err(format!("apt-get {name} failed: {}", reason.trim_start_matches("E: ").trim_end_matches('.')));
        }
    }
    Ok(())
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use crate::host::fake::Fake;

    const MANIFEST: &str = r#"{"ICD": {"library_path": "/usr/lib/libvulkan_lvp.so"}}"#;

    fn debian() -> Fake {
        Fake::default().var("PATH", "/usr/bin").file("/usr/bin/apt-get", "")
    }

    fn working_apt(mut host: Fake, start: &'static str) -> Fake {
        for (path, text) in [
            ("/usr/share/vulkan/icd.d/lvp_icd.x86_64.json", MANIFEST),
            ("/usr/lib/libvulkan_lvp.so", ""),
            ("/usr/lib/libvulkan.so.1", ""),
        ] {
            host.appear.push((start, path, text));
        }
        host.program(start, true, "")
    }

    fn prepared(host: &mut Fake) -> String {
        let mut messages = Vec::new();
        prepare(host, &mut messages).unwrap();
        String::from_utf8(messages).unwrap()
    }

    #[test]
    fn opengl_is_installed_where_it_is_missing() {
        let start = "env DEBIAN_FRONTEND=noninteractive apt-get";
        let mut host = debian().program("id -u", true, "0\n");
        let parts = ["/usr/lib/libEGL.so.1", "/usr/lib/libEGL_mesa.so.0", "/usr/lib/dri/swrast_dri.so"];
        parts.iter().for_each(|path| host.appear.push((start, path, "")));
        let prepared = |host: &mut Fake| {
            let mut messages = Vec::new();
            prepare_opengl(host, &mut messages).unwrap();
            String::from_utf8(messages).unwrap()
        };
        let text = prepared(&mut host.program(start, true, ""));
        assert!(text.ends_with("installed; OpenGL is ready\n"), "{text}");
        assert_eq!(prepared(&mut parts.iter().fold(debian(), |host, path| host.file(path, ""))), "");
        let mut host = debian().program("id -u", true, "1000\n").program("sudo -n true", false, "");
        assert!(prepared(&mut host).ends_with("--no-install-recommends libegl1 libegl-mesa0 libgl1-mesa-dri`\n"));
    }

    const COMMAND: &str = "apt-get install -y --no-install-recommends mesa-vulkan-drivers libvulkan1`\n";

    #[test]
    fn root_installs_without_sudo() {
        let mut host =
            working_apt(debian().program("id -u", true, "0\n"), "env DEBIAN_FRONTEND=noninteractive apt-get");
        assert_eq!(
            prepared(&mut host),
            "xtask: a Vulkan driver with its loader is missing: installing mesa-vulkan-drivers and libvulkan1 with \
             apt-get\nxtask: installed; Vulkan is ready\n"
        );
        assert!(host.log[1].ends_with(" update") && host.log[2].ends_with(" mesa-vulkan-drivers libvulkan1"));
    }

    #[test]
    fn a_user_with_passwordless_sudo_installs_through_it() {
        let mut host = debian().program("id -u", true, "1000\n").program("sudo -n true", true, "");
        host = working_apt(host, "sudo -n env DEBIAN_FRONTEND=noninteractive apt-get");
        assert!(prepared(&mut host).ends_with("xtask: installed; Vulkan is ready\n"));
    }

    #[test]
    fn a_user_without_rights_is_reported_the_command_in_one_sentence() {
        let mut host = debian().program("id -u", true, "1000\n").program("sudo -n true", false, "");
        let text = prepared(&mut host);
        assert!(
            text.ends_with(&format!(
                "(installing needs a password), so no shader can run on the lane `vulkan`: run `sudo apt-get update && sudo {COMMAND}"
            )),
            "{text}"
        );
        assert_eq!(text.lines().count(), 1);
        assert!(!host.log.iter().any(|line| line.contains("install")));
    }

    #[test]
    fn the_variable_forbids_to_install() {
        let mut host = debian().var("SHADERCHECK_NO_INSTALL", "1").program("id -u", true, "0\n");
        let text = prepared(&mut host);
        assert!(text.contains("SHADERCHECK_NO_INSTALL forbids to install it") && text.contains(COMMAND), "{text}");
        assert!(!host.log.iter().any(|line| line.contains("apt-get")));
    }

    #[test]
    fn the_variable_set_to_0_permits() {
        let host = debian().var("SHADERCHECK_NO_INSTALL", "0").program("id -u", true, "0\n");
        let mut host = working_apt(host, "env DEBIAN_FRONTEND=noninteractive apt-get");
        assert!(prepared(&mut host).ends_with("Vulkan is ready\n"));
    }

    #[test]
    fn a_failed_apt_get_gives_its_reason() {
        let output = "Err:1 http://deb.debian.org\nE: Unable to locate package mesa-vulkan-drivers.\n";
        let mut host = debian().program("id -u", true, "0\n").program("env DEBIAN_FRONTEND", false, output);
        let text = prepared(&mut host);
        assert!(text.contains("apt-get update failed: Unable to locate package mesa-vulkan-drivers)"), "{text}");
        assert!(text.ends_with(COMMAND), "{text}");
    }

    #[test]
    fn a_success_that_installs_nothing_is_not_believed() {
        let mut host = debian().program("id -u", true, "0\n").program("env DEBIAN_FRONTEND", true, "");
        assert!(prepared(&mut host).contains("reported success and it is still not found"));
    }

    #[test]
    fn other_distributions_get_their_own_command() {
        let text = prepared(&mut Fake::default().var("PATH", "/usr/bin").file("/usr/bin/dnf", ""));
        assert!(text.ends_with("run `sudo dnf install mesa-vulkan-drivers vulkan-loader`\n"), "{text}");
    }

    #[test]
    fn a_pinned_driver_that_is_not_there_installs_nothing() {
        let mut host = debian().var("VK_DRIVER_FILES", "/nowhere.json").program("id -u", true, "0\n");
        assert!(prepared(&mut host).starts_with("xtask: VK_DRIVER_FILES names no usable Vulkan driver"));
        assert!(host.log.is_empty());
    }

    #[test]
    fn a_complete_machine_is_left_alone_in_silence() {
        let mut host = Fake::default()
            .file("/usr/share/vulkan/icd.d/lvp_icd.x86_64.json", MANIFEST)
            .file("/usr/lib/libvulkan_lvp.so", "")
            .file("/usr/lib/libvulkan.so.1", "");
        assert_eq!(prepared(&mut host), "");
        assert!(host.log.is_empty());
    }

    #[test]
    fn a_missing_translator_is_installed_alone_and_one_that_is_there_is_left_alone() {
        let prepared = |host: &mut Fake| {
            let mut messages = Vec::new();
            prepare_translator(host, &mut messages).unwrap();
            String::from_utf8(messages).unwrap()
        };
        let start = "env DEBIAN_FRONTEND=noninteractive apt-get";
        let mut host = debian().program("id -u", true, "0\n").program(start, true, "");
        host.appear.push((start, "/usr/bin/glslangValidator", ""));
        assert!(prepared(&mut host).ends_with("with apt-get\nxtask: installed; glslangValidator is ready\n"));
        assert!(host.log.last().unwrap().ends_with("install -y --no-install-recommends glslang-tools"));
        assert_eq!(prepared(&mut debian().file("/usr/bin/glslangValidator", "")), "");
        let mut host = debian().var("SHADERCHECK_NO_INSTALL", "1");
        let text = prepared(&mut host);
        assert!(
            text.contains("glslangValidator is missing") && text.contains("the lane `vulkan-glslang`: run `"),
            "{text}"
        );
    }

    #[test]
    fn what_tests_need_is_installed_and_what_cannot_be_is_reported_once_each() {
        let start = "env DEBIAN_FRONTEND=noninteractive apt-get";
        let mut host = debian().program("id -u", true, "0\n").program(start, true, "");
        for program in ["nvim", "spirv-val", "chromium", "node", "npm", "python3", "shellcheck", "g++"] {
            host.appear.push((start, format!("/usr/bin/{program}").leak(), ""));
        }
        host.appear.push((start, "/usr/lib/python3.11/ensurepip/__init__.py", ""));
        host.appear.push((start, "/usr/lib/chromium/vk_swiftshader_icd.json", ""));
        let mut messages = Vec::new();
        assert!(prepare_tests(&mut host, &mut messages).unwrap());
        assert!(prepare_tests(&mut host, &mut messages).unwrap());
        let text = String::from_utf8(messages).unwrap();
        assert_eq!(text.matches("installed; ").count(), 1, "{text}");
        let mut messages = Vec::new();
        let mut host = debian().var("SHADERCHECK_NO_INSTALL", "1").file("/usr/bin/g++", "");
        assert!(!prepare_tests(&mut host, &mut messages).unwrap());
        let text = String::from_utf8(messages).unwrap();
        assert_eq!(text.lines().count(), FOR_TESTS.len() - 1, "{text}");
        assert!(text.contains("shellcheck is missing (SHADERCHECK_NO_INSTALL forbids"), "{text}");
    }
}
