//! The page of the book with the errors of devices, out of the profiles that `shadercheck calibrate` wrote, and the same as a
//! file for programs.

mod json;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use toml::{Table, Value};

/// A device: its profile, and what was measured of each operation.
struct Device {
    name: String,
    driver: String,
    date: String,
    operations: Vec<(String, Measured)>,
}

struct Measured {
    promise: String,
    worst_ulp: f64,
    worst_abs: f64,
    exhaustive: bool,
    verdict: String,
}

/// The page, and the file for programs, of all profiles of a folder that name a device.
///
/// # Errors
/// When a profile cannot be read, or none names a device.
pub fn pages(profiles: &Path) -> Result<(String, String)> {
    let mut devices = Vec::new();
    let entries = fs::read_dir(profiles).with_context(|| format!("cannot list {}", profiles.display()))?;
    let mut files: Vec<_> = entries.map(|entry| Ok(entry?.path())).collect::<Result<_>>()?;
    files.sort();
    let mut tables = Vec::new();
    for file in files.iter().filter(|file| file.extension().is_some_and(|ending| ending == "toml")) {
        let text = fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()))?;
        let table: Table = text.parse().with_context(|| format!("{} is not TOML", file.display()))?;
        devices.extend(device(&table).with_context(|| format!("{} is no profile", file.display()))?);
        tables.push(table);
    }
    ensure!(!devices.is_empty(), "no profile of {} names a device", profiles.display());
    Ok((written(&devices), json::table(tables.iter())?))
}

/// What a profile says of its device; nothing for one of a specification.
fn device(profile: &Table) -> Result<Option<Device>> {
    let Some(device) = profile.get("device") else { return Ok(None) };
    let text = |value: &Value, key: &str| value.get(key).and_then(Value::as_str).map(str::to_owned);
    let number = |value: &Value, key: &str| {
        let value = value.get(key)?;
        value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
    };
    let operations = profile.get("operations").and_then(Value::as_table).context("it has no operations")?;
    // Those that were not measured have a rule in place of a table.
    let measured = operations.iter().filter(|(_, value)| value.get("worst_ulp").is_some());
    let measured = measured.map(|(name, value)| {
        let read = || {
            Some(Measured {
                promise: text(value, "promise")?,
                worst_ulp: number(value, "worst_ulp")?,
                worst_abs: number(value, "worst_abs")?,
                exhaustive: value.get("exhaustive")?.as_bool()?,
                verdict: text(value, "verdict")?,
            })
        };
        Ok((name.clone(), read().with_context(|| format!("`{name}` lacks something"))?))
    });
    Ok(Some(Device {
        name: profile.get("name").and_then(Value::as_str).context("it has no name")?.to_owned(),
        driver: text(device, "driver").context("the device has no driver")?,
        date: text(device, "date").context("the device has no date")?,
        operations: measured.collect::<Result<_>>()?,
    }))
}

fn written(devices: &[Device]) -> String {
    let mut page = "# How exact devices are\n\n\
        The largest error that `shadercheck calibrate` met in each operation, in units in the last place of binary32, beside what \
        Vulkan promises. Made from the profiles that ship. An asterisk marks operations for which all 2^32 arguments were tried; \
        the others were sampled in every binade. *outside* means farther off than promised, *conformance only* that the promise \
        is broken and the conformance suite of Vulkan does not see it. [accuracy.json](accuracy.json) has the same for programs, \
        with the arguments of the errors.\n\n"
        .to_owned();
    for device in devices {
        // Writing into a String does not fail.
        let _ = writeln!(page, "- `{}`: {}, measured {}", device.name, device.driver, device.date);
    }
    let mut rows: BTreeMap<&str, (&str, Vec<String>)> = BTreeMap::new();
    for (at, device) in devices.iter().enumerate() {
        for (name, measured) in &device.operations {
            let (_, cells) =
                rows.entry(name).or_insert_with(|| (&measured.promise, vec![String::new(); devices.len()]));
            cells[at] = cell(measured);
        }
    }
    let heads: Vec<String> = devices.iter().map(|device| format!(" {} |", device.name)).collect();
    let _ = write!(page, "\n| Operation | Promise |{}\n|---|---|{}\n", heads.concat(), "---|".repeat(devices.len()));
    for (name, (promise, cells)) in rows {
        let _ = writeln!(page, "| `{name}` | {} | {} |", promise.replace('|', "\\|"), cells.join(" | "));
    }
    page
}

/// The error of an operation as a cell. Next to zero, a unit in the last place says little: the absolute error is told as well.
fn cell(measured: &Measured) -> String {
    let mut text = match measured.worst_ulp {
        ulp if ulp < 100.0 => format!("{}", (ulp * 100.0).round() / 100.0),
        ulp if ulp < 1e5 => format!("{ulp:.0}"),
        ulp => format!("{ulp:.1e}, at most {:.1e}", measured.worst_abs),
    };
    if measured.exhaustive {
        text.push('*');
    }
    match measured.verdict.as_str() {
        "inside" => {}
        "inside the conformance rule only" => text += ", *conformance only*",
        verdict => text += &format!(", *{verdict}*"),
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_device_that_ships_is_a_column() {
        let profiles = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/judge/profiles");
        let (page, _) = pages(&profiles).unwrap();
        for name in [
            "llvmpipe-22.3.6",
            "softpipe-22.3.6",
            "swiftshader-subzero-5.0",
            "nvidia-h200-580.159.04",
            "nvidia-h200-opengl-580.159.04",
        ] {
            assert!(page.contains(&format!("\n- `{name}`: ")), "{page}");
        }
        let sine = page.lines().find(|line| line.starts_with("| `sin` |")).unwrap();
        assert_eq!(sine.matches(" | ").count(), 6, "{sine}");
        assert!(page.contains("| `add` | rounded | 0.5 | 0.5 | 0.5 | 0.5 | 0.5 |\n"), "{page}");
        assert!(page.contains(", *outside*"), "{page}");
    }

    #[test]
    fn a_profile_that_lacks_a_number_is_refused_and_one_of_a_specification_is_passed_over() {
        assert!(device(&"name = \"a\"\n[operations]\nadd = \"rounded\"\n".parse().unwrap()).unwrap().is_none());
        let text = "name = \"a\"\n[device]\ndriver = \"d\"\ndate = \"2026\"\n[operations.add]\nworst_ulp = 1\n";
        let error = device(&text.parse().unwrap()).err().unwrap();
        assert_eq!(error.to_string(), "`add` lacks something");
    }
}
