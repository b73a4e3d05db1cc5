//! The page of `--report-dir`: what it holds, and what a browser makes of it.

mod browser;

use std::fs;
use std::path::Path;

use serde_json::Value;
use test_record::not_run;

use crate::binary::{Ran, command, root};
use browser::Browser;

/// A folder with the sphere as it should be, the sphere with a turn that is too long, and a function.
fn project() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let read = |path: &str| fs::read_to_string(root().join(path)).unwrap();
    let suite = read("shaders/chapter9/sphere.suite.toml").replace("samples = 65536", "samples = 2048");
    let suite = suite.split("\n[floors]").next().unwrap().to_owned();
    let wrong = suite.replace("suite = \"sphere\"", "suite = \"turned\"").replace("sphere.vert", "turned.vert");
    write("sphere.suite.toml", &suite);
    write("sphere.vert", &read("shaders/chapter9/sphere.vert"));
    write(
        "turned.suite.toml",
        &wrong.replace("Points of the unit sphere", "</script><script>document.title='got in'</script>"),
    );
    let comment =
        "// </script><script>document.title = 'got in'</script><img src=x onerror=\"document.title='got in'\">\n";
    let shader = read("fixtures/alarms/sphere_turn.vert");
    let (version, rest) = shader.split_once('\n').unwrap();
    write("turned.vert", &format!("{version}\n{comment}{rest}"));
    write("half.glsl", "float half_of(float x) { return x * 0.5; }\n");
    write(
        "half.suite.toml",
        "suite = \"half\"\nshader = \"half.glsl\"\nstage = \"function\"\nentry = \"half_of\"\nsamples = 256\n\
         relations = [{ kind = \"odd\", inputs = [\"x\"] }]\n[[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\n\
         range = [-2.0, 2.0]\n",
    );
    folder
}

fn run(folder: &Path, more: &str) -> (Ran, String) {
    let ran: Ran =
        command(folder, &format!("check . --lane embedded --report-dir out {more}")).output().unwrap().into();
    let page = fs::read_to_string(folder.join("out/index.html")).unwrap_or_else(|e| panic!("{e}\n{ran:?}"));
    (ran, page)
}

#[test]
fn the_page_needs_nothing_outside_of_itself_and_lets_no_text_become_markup() {
    let folder = project();
    let (ran, page) = run(folder.path(), "");
    ran.expect(1);
    assert_eq!(page.matches("<script").count(), 2, "the data and the script of the page");
    assert!(page.contains("&lt;/script&gt;&lt;script&gt;document.title"), "the title of a suite is shown as it is");
    assert!(!page.contains("<img") && !page.contains("<link") && !page.contains("@import"), "nothing is loaded");
    let addresses: Vec<&str> =
        page.split("http").skip(1).map(|rest| rest.split(['"', ' ', '<']).next().unwrap()).collect();
    let named = |a: &&str| !a.starts_with("://www.w3.org/2000/svg") && !a.starts_with("-equiv=");
    assert_eq!(addresses.into_iter().filter(named).collect::<Vec<_>>(), [""; 0]);
    for part in ["1 of 3 suites fails", "The shader", "turned.vert:11:14", "<mark>6.28381362571030366</mark>", "odd"] {
        assert!(page.contains(part), "{part}");
    }
    let (_, again) = run(folder.path(), "");
    let cut = |page: &str| page.split("<h2 id=\"suites\">").next().unwrap().to_owned();
    // The second time saved cases run first; the rest is the same.
    assert_eq!(cut(&page).len(), cut(&again).len());
    fs::remove_file(folder.path().join("turned.regressions")).unwrap();
    assert_eq!(run(folder.path(), "").1, page, "the same run gives the same page");
}

#[test]
fn charts_are_files_beside_the_page() {
    let folder = project();
    run(folder.path(), "");
    let plots = folder.path().join("out/plots");
    for name in ["sphere-embedded-compute-errors", "sphere-embedded-compute-bounds", "turned-embedded-compute-map"] {
        let svg = fs::read_to_string(plots.join(format!("{name}.svg"))).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(svg.starts_with("<svg ") && svg.contains("</text>"), "{name}");
        let file = fs::File::open(plots.join(format!("{name}.png"))).unwrap();
        let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        let red = pixels.chunks(3).filter(|p| **p == [0xc6, 0x2f, 0x2f]).count();
        assert_eq!(red > 1000, name.starts_with("turned"), "{name}: {red} pixels tell of a deviation");
    }
}

#[test]
fn results_of_mutation_testing_are_shown() {
    let folder = project();
    let results = r#"{"suites": [{"suite": "sphere<b>", "score": {"mutants": 5, "killed": 3, "survived": 1, "unmoved": 1, "share": 0.75},
        "mutants": [{"operator": "sign", "what": "`+` becomes `-`", "line": 3, "outcome": "survived", "diff": "-a\n+b<i>"}]}]}"#;
    fs::write(folder.path().join("m.json"), results).unwrap();
    let (ran, page) = run(folder.path(), "--mutations m.json");
    ran.expect(1);
    for part in ["sphere&lt;b&gt;", "75.0 %", "1 not noticed by", "+b&lt;i&gt;"] {
        assert!(page.contains(part), "{part}");
    }
    fs::write(folder.path().join("m.json"), "{}").unwrap();
    let ran: Ran =
        command(folder.path(), "check . --lane embedded --report-dir out --mutations m.json").output().unwrap().into();
    assert!(ran.expect(2).err.contains("holds no results of `shadercheck mutate"));
}

/// The function that is twice as much as it should be, and expectations with these lines.
fn with_expectations(expectations: &str) -> (Ran, String) {
    let folder = project();
    fs::remove_file(folder.path().join("turned.suite.toml")).unwrap();
    fs::write(folder.path().join("right.glsl"), "float half_of(float x) { return x * 0.5; }\n").unwrap();
    fs::write(folder.path().join("half.glsl"), "float half_of(float x) { return x; }\n").unwrap();
    let suite = fs::read_to_string(folder.path().join("half.suite.toml")).unwrap();
    let suite = suite.replace("samples = 256", "samples = 256\nreference = \"right.glsl\"");
    fs::write(folder.path().join("half.suite.toml"), suite).unwrap();
    fs::write(folder.path().join("expectations.toml"), expectations).unwrap();
    run(folder.path(), "")
}

#[test]
fn failures_that_are_expected_are_shown_with_their_reason() {
    let expectations = "[[expected]]\nlane = \"embedded\"\nsuite = \"half\"\nkind = \"deviation\"\n\
                  reason = \"half is <b>not</b> ready\"\nlink = \"LINK\"\n";
    let (ran, page) = with_expectations(&expectations.replace("LINK", "https://example.org/1?a=1&b=2"));
    ran.expect(0);
    for part in [
        "All 2 suites pass",
        "<summary>1 known failure</summary>",
        "half is &lt;b&gt;not&lt;/b&gt; ready",
        "<a href=\"https://example.org/1?a=1&amp;b=2\" rel=\"noreferrer\">",
        "<span class=\"mark\">≈</span><b>1 known failure</b>",
        "passes with 1 known failure",
        "Smallest inputs that show it",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("What is wrong"), "what is expected is not told as wrong");
    // What is no address is text.
    let (_, page) = with_expectations(&expectations.replace("LINK", "javascript:alert(1)"));
    assert!(page.contains(", javascript:alert(1))") && !page.contains("href=\"javascript"));
    // Without the expectations it is wrong, and the cell tells whose fault it is.
    let (ran, page) = with_expectations("");
    ran.expect(1);
    assert!(page.contains("What is wrong") && !page.contains("known failure</"), "{page}");
    assert!(page.contains("<span class=\"rest\">fault: the shader</span>"));
}

/// What the page is asked in a browser.
const QUESTIONS: &str = include_str!("questions.js");

/// More than axes and numbers.
fn is_drawn(picture: &Value) -> bool {
    let [inked, pixels] = ["inked", "pixels"].map(|key| picture[key].as_u64().unwrap());
    inked * 10 > pixels
}

#[test]
fn a_browser_shows_pictures_filters_and_takes_keys() {
    let Some(browser) = Browser::find() else {
        return not_run(
            "no browser is on PATH (chromium, google-chrome): the page of a report was not looked at in a browser",
        );
    };
    let folder = project();
    let (_, page) = run(folder.path(), "");
    let answers: Value = browser.ask(&page, QUESTIONS);
    assert_eq!(answers["errors"], serde_json::json!([]), "{answers:#}");
    assert_eq!(answers["title"], "shadercheck failed", "no text of a shader is run");
    assert_eq!(answers["rows"], serde_json::json!({ "all": 3, "failing": 1, "searched": 1, "none": 0, "lane": 3 }));
    let pictures = answers["pictures"].as_array().unwrap();
    assert!(pictures.len() >= 5, "{answers:#}");
    for picture in pictures {
        assert!(is_drawn(picture), "a picture is blank: {picture}");
        let red = picture["red"].as_u64().unwrap();
        assert_eq!(red > 300, picture["suite"] == "suite-turned", "{picture}");
    }
    for key in ["turned_by_key", "turned_by_mouse", "larger", "map_tells", "theme", "copied", "opened_by_link"] {
        assert_eq!(answers[key], true, "{key}: {answers:#}");
    }
}

#[test]
fn a_fault_in_the_script_is_seen() {
    let Some(browser) = Browser::find() else {
        return not_run(
            "no browser is on PATH (chromium, google-chrome): faults planted in a page were not looked for in a browser",
        );
    };
    let folder = project();
    let (_, page) = run(folder.path(), "");
    let broken = page.replace("page.begin();", "page.begin(); page.missing();");
    assert_ne!(broken, page);
    let answers = browser.ask(&broken, QUESTIONS);
    assert!(answers["errors"].to_string().contains("page.missing is not a function"), "{answers:#}");
    let blank = page.replace("pen.fill();", "").replace("pen.stroke();", "").replace("pen.fillRect(", "void (");
    let answers = browser.ask(&blank, QUESTIONS);
    assert!(!answers["pictures"].as_array().unwrap().iter().any(is_drawn), "{answers:#}");
}
